"""Sine and cosine to twice the digits; the sine and 1 - |sine| to a third word."""

import math
import random
from functools import cache

import mpmath
import pytest

from desaxe.compiler.passes.double_angles import rotated_sin
from desaxe.compiler.passes.expansions import Expansions, Pair
from desaxe.compiler.program import Program
from desaxe.mechanism.constants import double_constants
from tests.compiler.programs import in_doubles

QUARTER = math.pi / 2
THIRD = 2.0**-128
END = 2.0**-143


@cache
def written(part):
    """The program of the words of `sin`, `cos` or `complement` of x."""
    writer = Expansions()
    words = getattr(rotated_sin(writer, Pair("x"), double_constants()), part)
    return Program(("x",), tuple(writer.lines), tuple(words), {})


def found(part, x):
    return sum(map(mpmath.mpf, in_doubles(written(part), {"x": x}).values()))


def angles(kind, count=150):
    rng = random.Random(kind)
    limit = math.floor(double_constants().limit / QUARTER) - 1
    for _ in range(count):
        side = rng.choice((-1, 1))
        if kind == "a turn":
            yield rng.uniform(-7, 7)
        elif kind == "far":
            yield side * 10 ** rng.uniform(1, 9.2)
        elif kind == "tiny":
            yield side * 10 ** rng.uniform(-140, -3)
        elif kind == "next to an eighth":
            yield math.nextafter(rng.randrange(-8, 9, 2) * math.pi / 4 + math.pi / 4, side * 9)
        else:
            quarters = rng.choice((rng.randrange(1, 5), rng.randrange(1, limit)))
            near = side * quarters * QUARTER
            yield near + rng.choice((0.0, 10 ** rng.uniform(-12, -1))) * rng.choice((-1, 1))


KINDS = ("a turn", "far", "tiny", "next to an eighth", "next to a quarter")


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("part", ["sin", "complement"])
def test_three_words(part, kind):
    """An error below 2^-128, and relative where the value is small."""
    for x in angles(kind):
        with mpmath.workdps(80):
            sine = mpmath.sin(mpmath.mpf(x))
            exact = sine if part == "sin" else 1 - abs(sine)
            # The words of pi/2 end at some 2^-144, however near to a quarter the angle is.
            far = abs(x) * END if part == "sin" else abs(x) * END * mpmath.sqrt(2 * exact)
            assert abs(found(part, x) - exact) <= THIRD * abs(exact) + far, x


@pytest.mark.parametrize("kind", KINDS)
def test_the_cosine_to_twice_the_digits(kind):
    for x in angles(kind):
        with mpmath.workdps(80):
            exact = mpmath.cos(mpmath.mpf(x))
            assert abs(found("cos", x) - exact) <= 2.0**-104 * abs(exact) + abs(x) * END, x


@pytest.mark.parametrize("x", [0.0, -0.0])
def test_at_nothing(x):
    assert (found("sin", x), found("cos", x), found("complement", x)) == (0, 1, 1)


@pytest.mark.parametrize("x", [math.nan, math.inf])
def test_what_is_no_angle(x):
    assert all(math.isnan(word) for word in in_doubles(written("sin"), {"x": x}).values())
