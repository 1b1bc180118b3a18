"""JavaScript: one function that answers, bit for bit, as the interpretation of the program does."""

import math
import re
from inspect import getmembers, isfunction

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from desaxe.compiler import helpers
from desaxe.compiler.languages.javascript import HEADER, TABLES, emit_javascript
from desaxe.compiler.program import Line, Note, Program
from desaxe.mechanism.catalogue import quantities
from tests.compiler.coverage_set import NAMES, POINTS, coverage
from tests.compiler.javascript import in_javascript
from tests.compiler.programs import (
    ANY_OPS,
    INPUTS,
    LINKS,
    LOADS,
    POINT,
    WITH_NAN,
    committed,
    in_doubles,
    program_of_nested,
    programs,
    same_bits,
)
from tests.effort import cases

FUNCTIONS = getmembers(helpers, isfunction)
# What IEEE 754 fixes to the last bit: a sine is as good as the library that computes it.
FIXED = tuple(op for op in ANY_OPS if op not in ("sin", "cos", "atan2"))
ANY = st.floats(allow_nan=True, allow_infinity=True)


def test_the_coverage_set_against_the_interpretation():
    for point, answers in zip(POINTS, in_javascript(coverage(), POINTS), strict=True):
        expected = in_doubles(coverage(), point)
        assert {n for n in NAMES if not same_bits(answers[n], expected[n])} <= {"waves", "angle"}


@pytest.mark.sampled
@given(
    programs(WITH_NAN, FIXED),
    st.lists(st.fixed_dictionaries(dict.fromkeys(INPUTS, ANY)), min_size=8, max_size=8),
)
@settings(max_examples=cases(15, 25), deadline=None, suppress_health_check=[HealthCheck.too_slow])
def test_no_bit_differs_from_the_interpretation(program, points):
    for point, answers in zip(points, in_javascript(program, points), strict=True):
        expected = in_doubles(program, point)
        assert all(same_bits(answers[name], expected[name]) for name in program.outputs), point


def test_the_error_of_a_product_is_whole():
    """What plain Python says with fractions, JavaScript says by splitting."""
    program = program_of_nested(("two_product_error", "x", "y"))
    values = (0.1, -1 / 3, math.pi, 1e150, 2.0**-300 * 1.1, 12345.678901234567)
    points = [{"x": a, "y": b, "z": 0.0} for a in values for b in values]
    result = in_javascript(program, points)
    assert [one["out"] for one in result] == [in_doubles(program, point)["out"] for point in points]
    assert any(one["out"] for one in result)


def test_every_name_of_the_committed_program():
    """Nothing in it is a word that JavaScript keeps for itself, and all of it has the same digits."""
    program = committed(*quantities())
    point = POINT | LINKS | LOADS
    (answers,) = in_javascript(program, [point])
    expected = in_doubles(program, point)
    far = [n for n in expected if not math.isclose(answers[n], expected[n], rel_tol=1e-12, abs_tol=1e-12)]
    assert not far


@pytest.mark.parametrize(
    ("nested", "text"),
    [
        (("select", ("lt", "x", "y"), ("select", ("lt", "y", "z"), 1.0, 2.0), "z"),
         "(x < y ? (y < z ? 1.0 : 2.0) : z)"),
        (("select", ("and", ("or", ("lt", "x", "y"), ("lt", "y", "z")), ("le", "z", "x")), 1.0, "z"),
         "(((x < y || y < z) && z <= x) ? 1.0 : z)"),
        (("select", ("not", ("and", ("lt", "x", "y"), ("eq", "y", "z"))), 1.0, "z"),
         "(!((x < y && y == z)) ? 1.0 : z)"),
        (("mul", ("neg", ("neg", "x")), ("select", ("lt", "x", "y"), "x", "y")), "-(-x) * (x < y ? x : y)"),
        (("sub", "x", ("neg", "y")), "x - -y"),
    ],
)  # fmt: skip
def test_precedence(nested, text):
    assert f"  const out = {text};\n" in emit_javascript(program_of_nested(nested))


def test_golden():
    lines = (Line("u", "add", ("x", "y")), Line("v", "div", ("u", "y")))
    program = Program(("x", "y"), lines, ("v", "u"), {"u": Note("m", "their sum", "A (1)")})
    assert emit_javascript(program, "ratio") == (
        "function ratio(x, y) {\n"
        "  const u = x + y; // m | their sum | A (1)\n"
        "  const v = u / y;\n"
        "  return [v, u];\n"
        "}\n"
    )


def test_every_helper_that_is_called_is_there():
    """IEEE arithmetic needs no guards; everything else that Python calls has its own spelling."""
    guards = {"divide", "root", "sine", "cosine", "whole", "exponential", "logarithm", "power"}
    written = {*re.findall(r"^function (\w+)", HEADER + TABLES, re.MULTILINE)}
    assert written == {name for name, _ in FUNCTIONS} - guards | {"copysign"}
