"""Each row of the operation table: all its spellings mean the same, at ordinary points and at the edges."""

import itertools
import math
import operator
import random
import string
from fractions import Fraction
from functools import cache

import mpmath
import numpy as np
import pytest

from desaxe.compiler.interpret import ieee
from desaxe.compiler.kernel import hoist
from desaxe.compiler.languages.numba.language import Numba
from desaxe.compiler.operations import OPERATIONS, result_type
from desaxe.compiler.program import Line, Program
from desaxe.oracle.truth import ulp_error
from desaxe.runtime.executor import CompiledKernel
from tests.compiler.languages.modules import module
from tests.compiler.programs import same_bits

TINY, LEAST, MOST = 5e-324, 2.2250738585072014e-308, 1.7976931348623157e308
EDGES = (0.0, 1.0, 0.5, 2.5, 1e16, TINY, LEAST, MOST, math.inf, math.nan)
FLOATS = (*EDGES, *(-edge for edge in EDGES[:-1]))
BOOLS = (True, False)
OPS = [op for op, row in OPERATIONS.items() if "t" not in row.signature]  # for tables see test_tables
REFERENCE = {
    "copy": lambda a: a, "add": np.add, "sub": np.subtract, "mul": np.multiply, "div": np.divide,
    "neg": np.negative, "abs": np.abs, "sqrt": np.sqrt, "sin": np.sin, "cos": np.cos, "atan2": np.arctan2,
    "floor": np.floor, "copysign": np.copysign, "lt": np.less, "le": np.less_equal, "eq": np.equal,
    "exp": np.exp, "log": np.log, "pow": lambda a, b: np.power(np.array([a, a]), np.array([b, 1.0]))[0],
    "and": np.logical_and, "or": np.logical_or, "not": np.logical_not, "select": np.where,
}  # fmt: skip
REFERENCE["mul_add"] = lambda a, b, c: np.add(np.multiply(a, b), c)
REFERENCE["hypot"] = lambda a, b: np.nan if a != a or b != b else np.hypot(a, b)
REFERENCE["power_of_two"] = lambda a: np.exp2(np.ceil(np.log2(np.fmax(np.fmin(a, 2.0**960), 2.0**-960))))
REFERENCE["rounding"] = lambda a: np.multiply(2.0**-51, np.abs(a))
REFERENCE["two_sum_error"] = lambda a, b: lost(operator.add, a, b)
REFERENCE["two_product_error"] = lambda a, b: lost(operator.mul, a, b)
REFERENCE["rotated_sin"] = lambda sine, cosine, quarters: (sine, cosine, -sine, -cosine)[int(quarters) % 4]
REFERENCE["rotated_cos"] = lambda sine, cosine, quarters: (cosine, -sine, -cosine, sine)[int(quarters) % 4]
REFERENCE["extended_only"] = lambda a: False
ERRORS = ("two_sum_error", "two_product_error", "rounding")  # exactly 0 over the reals
CALLED = ("sin", "cos", "atan2", "hypot", "exp", "log", "pow")  # each library rounds these in its own way
WHOLE = ("rotated_sin", "rotated_cos")  # their last argument is a whole number


def lost(function, a, b):
    """The error of a rounded sum or product of doubles, by fractions."""
    if not all(map(math.isfinite, (a, b, function(a, b)))):
        return math.nan
    return float(function(Fraction(a), Fraction(b)) - Fraction(function(a, b)))


def arguments(op):
    """All combinations of edge values for the arguments of an operation.

    What a product rounds away is a double only where neither it nor a half of a factor over- or underflows;
    there too, a sum that is rounded once may be finite where one that is rounded twice is not.
    """
    extreme = (TINY, LEAST, MOST) if op in ("two_product_error", "mul_add") else ()
    floats = [value for value in FLOATS if abs(value) not in extreme]
    choices = [BOOLS if letter == "b" else floats for letter in OPERATIONS[op].signature[:-1]]
    if op in WHOLE:
        choices[-1] = [-6.0, -5.0, -4.0, -3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 1e6]
    return itertools.product(*choices)


def ordinary(op, count=50):
    """Seeded ordinary arguments, where the operation has a value."""
    rng = random.Random(op)
    signs = [1] if op in ("sqrt", "log", "pow") else [-1, 1]
    largest = 1.5 if op in ("exp", "pow") else 3  # or they overflow
    for _ in range(count):
        yield tuple(
            rng.random() < 0.5 if letter == "b" else rng.choice(signs) * 10 ** rng.uniform(-3, largest)
            for letter in OPERATIONS[op].signature[:-1]
        )


def agree(op, result, expected, point=()):
    if op in CALLED and math.isfinite(expected) and expected:
        return abs(result - expected) <= 2 * math.ulp(expected)
    if op == "mul_add" and all(map(math.isfinite, point)) and point:  # rounded once, or twice
        return abs(result - expected) <= math.ulp(point[0] * point[1]) / 2 + math.ulp(expected)
    return same_bits(result, expected)


@pytest.mark.parametrize("op", OPS)
def test_ieee_answers_are_those_of_numpy_and_fractions(op):
    """What rounding took may be 0 of either sign."""
    zero = 0.0 if op in ERRORS else -0.0
    with np.errstate(all="ignore"):
        pairs = ((a, ieee(op, *a) + zero, float(REFERENCE[op](*a)) + zero) for a in arguments(op))
        wrong = [a for a, value, reference in pairs if not agree(op, value, reference)]
    assert not wrong


def every_operation():
    """A program with an output for each operation; truth comes in as 0 < x and goes out as 1 or 0."""
    lines = [Line(f"is_{name}", "lt", (0.0, name), "bool") for name in "abc"]
    for op in OPS:
        row = OPERATIONS[op]
        names = [f"is_{x}" if kind == "b" else x for x, kind in zip("abc", row.signature[:-1], strict=False)]
        kind = "bool" if row.signature[-1] == "b" else "f64"
        lines.append(Line(f"_{op}", op, tuple(names), kind))
        lines.append(Line(f"out_{op}", "select" if kind == "bool" else "copy", shown(f"_{op}", kind)))
    return Program(("a", "b", "c"), tuple(lines), tuple(f"out_{op}" for op in OPS), {})


@cache
def numba_spellings():
    scope = {}
    made = module(every_operation())._replace(functions=False)
    exec(Numba().files(made)["made.py"], scope)
    return scope["evaluate"]


def shown(name, kind):
    return (name, 1.0, 0.0) if kind == "bool" else (name,)


def columns_of(op, points):
    columns = [np.zeros(len(points)) for _ in "abc"]
    for position, kind in enumerate(OPERATIONS[op].signature[:-1]):
        columns[position][:] = [point[position] for point in points]
        columns[position] -= 0.5 if kind == "b" else 0.0
    return columns


def by_numba(op, points):
    return numba_spellings()(*columns_of(op, points))[f"out_{op}"]


@pytest.mark.parametrize("op", OPS)
def test_the_numba_spelling_is_ieee(op):
    points = list(arguments(op))
    answers = zip(points, by_numba(op, points), strict=True)
    assert not [a for a, result in answers if not agree(op, result, float(ieee(op, *a)), a)]


@pytest.mark.parametrize("op", OPS)
def test_the_llvm_spelling_is_ieee(op):
    """And nothing that a processor fuses or not: bits as numba's."""
    points = list(arguments(op))
    columns = columns_of(op, points)
    outs = [np.empty(len(points)) for _ in OPS]
    in_llvm().run(dict(zip("abc", columns, strict=True)), outs)
    answers = zip(points, outs[OPS.index(op)], strict=True)
    assert not [a for a, result in answers if not agree(op, result, float(ieee(op, *a)), a)]


@cache
def in_llvm():
    return CompiledKernel(hoist(every_operation(), {"a": 0, "b": 0, "c": 0}, 1))


def test_quarter_turns_go_round():
    sine, cosine = 0.25, 0.75
    result = [ieee("rotated_sin", sine, cosine, float(quarters)) for quarters in range(-4, 8)]
    assert result == [sine, cosine, -sine, -cosine] * 3
    result = [ieee("rotated_cos", sine, cosine, float(quarters)) for quarters in range(-4, 8)]
    assert result == [cosine, -sine, -cosine, sine] * 3


@pytest.mark.parametrize("op", [op for op in OPS if op not in (*ERRORS, *WHOLE)])
def test_ieee_rounds_the_exact_meaning(op):
    with mpmath.workdps(50):
        for point in ordinary(op):
            exact = OPERATIONS[op].exact(mpmath.mp, *(a if a in BOOLS else mpmath.mpf(a) for a in point))
            result = float(ieee(op, *point))
            if op == "hypot":
                assert ulp_error(result, mpmath.mpf(exact)) < 2, point
            elif op == "mul_add":
                assert abs(result - exact) <= math.ulp(point[0] * point[1]) / 2 + math.ulp(result) / 2, point
            else:
                assert ulp_error(result, mpmath.mpf(exact)) < 1, point


def test_the_error_of_a_sum_is_what_rounding_took():
    for a, b in [*ordinary("add"), (1.0, TINY), (1e16, -1.0), (0.1, 1e9), (-LEAST, TINY)]:
        assert Fraction(a) + Fraction(b) == Fraction(a + b) + Fraction(ieee("two_sum_error", a, b))


def test_the_error_of_a_product_is_what_rounding_took():
    for a, b in [*ordinary("mul"), (1e140, 1e-130), (0.1, 1e9), (1 / 3, 3.0), (1e120, 1e120)]:
        assert Fraction(a) * Fraction(b) == Fraction(a * b) + Fraction(ieee("two_product_error", a, b))


def test_numba_keeps_the_error_of_a_product():
    points = list(ordinary("mul"))
    for (a, b), error in zip(points, by_numba("two_product_error", points), strict=True):
        assert Fraction(a) * Fraction(b) == Fraction(a * b) + Fraction(float(error))


@pytest.mark.parametrize("op", ERRORS)
def test_the_error_of_rounding_is_exactly_zero_over_the_reals(op):
    numbers = [mpmath.mpf(0.1), mpmath.mpf(0.2)][: OPERATIONS[op].arity]
    assert OPERATIONS[op].exact(mpmath.mp, *numbers) == 0


@pytest.mark.parametrize("op", [op for op in OPS if OPERATIONS[op].undefined])
def test_the_exact_meaning_ends_where_the_table_says(op):
    points = [a for a in arguments(op) if all(math.isfinite(x) for x in a)]
    assert {has_value(op, a) for a in points} == {True, False}
    assert [has_value(op, a) for a in points] == [not says_undefined(op, a) for a in points]


def has_value(op, point):
    try:
        return isinstance(OPERATIONS[op].exact(mpmath.mp, *map(mpmath.mpf, point)), mpmath.mpf)
    except ZeroDivisionError:
        return False


def says_undefined(op, point):
    return eval(OPERATIONS[op].undefined.format(*(f"({value!r})" for value in point)))


@pytest.mark.parametrize("op", OPS)
@pytest.mark.parametrize("column", ["text", "python", "numba"])
def test_a_spelling_uses_each_argument(op, column):
    fields = {field for _, field, _, _ in string.Formatter().parse(getattr(OPERATIONS[op], column)) if field}
    assert fields == {str(position) for position in range(OPERATIONS[op].arity)}


@pytest.mark.parametrize("op", [op for op in OPS if OPERATIONS[op].commutes])
def test_what_commutes_does(op):
    assert all(same_bits(ieee(op, a, b), ieee(op, b, a)) for a, b in arguments(op))


def test_the_result_type_follows_the_signature():
    assert result_type(OPERATIONS["lt"], ("f64", "f64")) == "bool"
    assert result_type(OPERATIONS["select"], ("bool", "i64", "i64")) == "i64"


@pytest.mark.parametrize(
    ("op", "types", "complaint"),
    [
        ("add", ("f64", "bool"), "add wants f64, got bool"),
        ("select", ("f64", "f64", "f64"), "select wants bool, got f64"),
        ("select", ("bool", "f64", "i64"), "select wants f64, got i64"),
    ],
)
def test_wrong_argument_types_are_refused(op, types, complaint):
    with pytest.raises(TypeError, match=complaint):
        result_type(OPERATIONS[op], types)
