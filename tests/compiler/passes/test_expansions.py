"""Sums and products of up to three doubles lose nothing but what is below the third word."""

import random
from fractions import Fraction

import pytest

from desaxe.compiler.passes.expansions import Expansions
from desaxe.compiler.program import Program
from tests.compiler.programs import in_doubles

NAMES = tuple("abcdef")
THIRD = Fraction(2) ** -152  # a third word ends some bits above 3 x 53


def value(build, values):
    """The exact value of the words that `build(writer)` gives at these inputs."""
    writer = Expansions()
    words = [word for word in build(writer) if isinstance(word, str)]
    program = Program(NAMES, tuple(writer.lines), tuple(words), {})
    return sum((Fraction(word) for word in in_doubles(program, values).values()), Fraction(0))


def three_words(rng):
    """A number of three doubles, each within half an ulp of the one before."""
    first = rng.uniform(0.1, 4.0) * rng.choice((-1, 1))
    second = first * 2.0**-53 * rng.uniform(-1, 1)
    return first, second, second * 2.0**-53 * rng.uniform(-1, 1)


def points(name, count=300):
    rng = random.Random(name)
    for _ in range(count):
        yield dict(zip(NAMES, (*three_words(rng), *three_words(rng)), strict=True))


def exact(point, names):
    return sum(Fraction(point[name]) for name in names)


def test_a_sum():
    for point in points("sum"):
        result = value(lambda w: w.sum_of(tuple("abc"), tuple("def")), point)
        assert abs(result - exact(point, "abcdef")) <= THIRD * (abs(exact(point, "abc")) + 4)


def test_a_product():
    for point in points("product"):
        result, expected = value(lambda w: w.product(tuple("abc"), tuple("def")), point), exact(point, "abc")
        expected *= exact(point, "def")
        assert abs(result - expected) <= 4 * THIRD * abs(expected)


@pytest.mark.parametrize("build", [Expansions.ordered, Expansions.after_cancelling])
def test_words_that_do_not_overlap(build):
    for point in points("order"):
        result = value(lambda w: build(w, tuple("abc"))[:2], point)
        assert abs(result - exact(point, "abc")) <= Fraction(2) ** -104 * abs(exact(point, "abc"))


def test_a_difference_of_which_two_words_cancel():
    """What is left keeps the digits that three words have of it, whichever word it is in."""
    for point in points("cancel"):
        near = point | {"d": -point["a"], "e": -point["b"]}
        result = value(lambda w: w.after_cancelling(w.sum_of(tuple("abc"), tuple("def"))), near)
        assert result == Fraction(near["c"] + near["f"])
        near = point | {"d": -point["a"]}
        result = value(lambda w: w.after_cancelling(w.sum_of(tuple("abc"), tuple("def"))), near)
        assert abs(result - exact(near, "bcef")) <= 2 * THIRD


def test_exact_ones_are_exact():
    for point in points("exact"):
        assert value(lambda w: w.two_sum("a", "d"), point) == exact(point, "ad")
        assert value(lambda w: w.two_product("a", "d"), point) == exact(point, "a") * exact(point, "d")
        assert value(lambda w: w.quick("a", "b"), point) == exact(point, "ab")
        assert value(lambda w: w.negative(tuple("abc")), point) == -exact(point, "abc")


def test_a_choice():
    for point in points("choice", 20):
        chosen = value(
            lambda w: w.chosen(w.line("lt", "a", "d", kind="bool"), tuple("abc"), tuple("de")), point
        )
        assert chosen == (exact(point, "abc") if point["a"] < point["d"] else exact(point, "de"))
