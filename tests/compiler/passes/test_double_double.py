"""Twice the digits: every operation and sine and cosine to about 2^-100, next to cancellation too."""

import math
import random

import mpmath
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from desaxe.compiler.passes import double_double as module
from desaxe.compiler.passes.double_double import double_double
from desaxe.compiler.passes.fold import fold_constants
from desaxe.compiler.passes.slicing import keep_outputs
from desaxe.compiler.program import Line, Program, validate
from desaxe.mechanism.constants import double_constants
from desaxe.oracle.truth import ulp_error
from tests.compiler.coverage_set import POINTS, coverage
from tests.compiler.programs import in_doubles
from tests.effort import cases

DIGITS = 2.0**-100


def in_pairs(lines, point):
    """The last line in pairs, as one exact number."""
    program = Program(tuple(point), tuple(lines), (lines[-1].name,), {})
    writer = module._Writer(program, double_constants())
    for line in lines:
        writer.assign(line)
    pair = writer.pairs[lines[-1].name]
    parts = [part for part in pair if isinstance(part, str)]
    result = in_doubles(Program(tuple(point), tuple(writer.lines), tuple(parts), {}), point)
    return sum(mpmath.mpf(result[part]) for part in parts)


def exactly(lines, point):
    from tests.compiler.programs import run_exactly

    program = Program(tuple(point), tuple(lines), (lines[-1].name,), {})
    return run_exactly(program, mpmath.mp, point)[lines[-1].name]


def error(lines, point):
    with mpmath.workdps(90):
        exact = exactly(lines, point)
        return abs(in_pairs(lines, point) / exact - 1) if exact else abs(in_pairs(lines, point))


def chain(*ops):
    """Lines that make pairs of x, y, z (their square roots) and then use the operations on them."""
    roots = [Line(f"root_{name}", "sqrt", (name,)) for name in "xyz"]
    lines = [*roots, Line("product", "mul", ("root_x", "root_y")), Line("sum", "add", ("product", "root_z"))]
    lines += [Line("third", "div", ("sum", 3.0)), Line("difference", "sub", ("third", "root_x"))]
    return [*lines, *(Line(f"r{n}", op, args) for n, (op, args) in enumerate(ops))]


OPERATIONS = {
    "add": ("add", ("third", "product")),
    "sub that cancels": ("sub", ("third", "root_x")),
    "mul": ("mul", ("third", "difference")),
    "mul by a double": ("mul", ("x", "third")),
    "mul_add": ("mul_add", ("third", "product", "x")),
    "mul by a power of 2": ("mul", (-0.25, "third")),
    "div": ("div", ("third", "difference")),
    "div of a double": ("div", ("x", "third")),
    "div by a double": ("div", ("third", "y")),
    "doubles": ("div", ("x", "y")),
    "sqrt": ("sqrt", ("third",)),
    "neg": ("neg", ("difference",)),
    "abs": ("abs", ("difference",)),
    "copysign": ("copysign", ("third", "difference")),
    "sin": ("sin", ("x",)),
    "cos": ("cos", ("y",)),
    "atan2": ("atan2", ("difference", "third")),
    "atan2 behind": ("atan2", ("third", "difference")),
}


@pytest.mark.parametrize("name", OPERATIONS)
def test_an_operation_keeps_twice_the_digits(name):
    rng = random.Random(name)
    for _ in range(200):
        point = {key: rng.uniform(0.1, 5.0) for key in "xyz"}
        lines = chain(OPERATIONS[name])
        with mpmath.workdps(60):  # what cancelled before is not this operation's fault
            before = abs(exactly(chain()[:-1], point)) / abs(exactly(chain(), point))
        assert error(lines, point) < DIGITS * (1 + before), point


def test_a_sum_that_cancels_loses_nothing():
    for tiny in (2.0**-40, 2.0**-52, 3 * 2.0**-60):
        lines = [
            Line("near", "add", ("x", "y")),
            Line("left", "sub", ("near", "x")),
            Line("r", "sub", ("left", "z")),
        ]
        assert error(lines, {"x": 1.0, "y": tiny, "z": tiny / 3}) < DIGITS


@pytest.mark.parametrize("op", ["sin", "cos"])
@pytest.mark.parametrize("size", [1e-300, 1e-5, 1.0, 100.0, 1e6, 1e8])
def test_sine_and_cosine_of_angles_of_any_size(op, size):
    rng = random.Random(f"{op} {size}")
    for _ in range(60):
        assert error([Line("r", op, ("x",))], {"x": rng.uniform(-size, size)}) < DIGITS


@pytest.mark.parametrize("op", ["sin", "cos"])
def test_next_to_a_multiple_of_a_quarter(op):
    """The absolute error is far below what a double can show of the crank there."""
    rng = random.Random(op)
    for k in [*range(1, 12), *(rng.randrange(1, 2**26) for _ in range(60))]:
        with mpmath.workdps(40):
            angle = float(k * mpmath.pi / 2)
        for x in (angle, -angle, math.nextafter(angle, 0.0)):
            assert error([Line("r", op, ("x",))], {"x": x}) < 2.0**-64


def test_the_coverage_set_is_rounded_once():
    program = coverage()  # but for exp, log and pow, which have no form in pairs
    program = keep_outputs(program, [name for name in program.outputs if name != "grown"])
    wide = validate(double_double(program, double_constants()))
    for point in POINTS:
        result = in_doubles(wide, point)
        from tests.compiler.programs import run_exactly

        with mpmath.workdps(60):
            exact = run_exactly(program, mpmath.mp, point)
            for name in program.outputs:
                if isinstance(result[name], float):
                    assert ulp_error(result[name], mpmath.mpf(exact[name])) <= 0.5 + 1e-9, name
                else:
                    assert result[name] == exact[name]


@pytest.mark.sampled
@given(st.floats(), st.floats())
@settings(max_examples=cases(40, 200), deadline=None)
def test_nothing_raises_and_comparisons_are_those_of_doubles(x, y):
    lines = (Line("less", "lt", ("x", "y"), "bool"), Line("r", "select", ("less", 1.0, 2.0)))
    wide = double_double(Program(("x", "y"), lines, ("r",), {}), double_constants())
    assert in_doubles(wide, {"x": x, "y": y})["r"] == (1.0 if x < y else 2.0)


def test_what_is_a_double_stays_one():
    """Scaling by a power of 2, signs and choices of doubles cost no low parts."""
    lines = (Line("twice", "mul", (2.0, "x")), Line("size", "abs", ("twice",)), Line("r", "neg", ("size",)))
    wide = double_double(Program(("x",), lines, ("r",), {}), double_constants())
    assert [line.op for line in wide.lines] == ["mul", "abs", "neg"]


SINE = [Line("sine", "sin", ("x",)), Line("by", "mul", ("a", "sine"))]
COMPLEMENT = [
    *SINE[:1],
    *(Line("cosine", "cos", ("x",)), Line("square", "mul", ("cosine", "cosine"))),
    *(Line("size", "abs", ("sine",)), Line("whole", "add", ("size", 1.0))),
    *(Line("eps", "div", ("square", "whole")), Line("by", "mul", ("a", "eps"))),
]
GAP = [Line("near", "sub", ("y", "z")), Line("less", "sub", ("near", "by"))]


@pytest.mark.parametrize("terms", [SINE, COMPLEMENT])
def test_a_gap_keeps_twice_the_digits_where_all_but_the_last_bits_cancel(terms):
    """(y - z) - a sin(x), with y - z so near to a sin(x) that two words of either have nothing left."""
    rng = random.Random("gap")
    for _ in range(100):
        point = {"x": rng.uniform(-7, 7), "a": rng.uniform(0.1, 50.0), "y": 0.0, "z": 0.0}
        for cut in (53, 80, 105):
            with mpmath.workdps(90):
                product = exactly(terms, point)
                point["y"] = float(product)
                rest = mpmath.ldexp(mpmath.floor(mpmath.ldexp(point["y"] - product, cut)), -cut)
                point["z"] = float(rest)
                exact = exactly([*terms, *GAP], point)
                lost = abs(in_pairs([*terms, *GAP], point) - exact)
                assert lost <= abs(product) * 2.0**-126 + abs(exact) * 2.0**-100, point


def test_other_differences_keep_two_words():
    """The third word is for the gap alone: any other name costs, and keeps, no more than a pair."""
    plain = [*SINE, *GAP[:1], GAP[1]._replace(name="other")]
    lines = [*SINE, *GAP]
    made = [
        double_double(Program(("x", "a", "y", "z"), tuple(some), (some[-1].name,), {}), double_constants())
        for some in (plain, lines)
    ]
    assert len(made[0].lines) < len(made[1].lines)


def test_finer_forms_are_taken_before_folding():
    lines = (
        Line("less", "lt", ("x", "y"), "bool"),
        Line("fine", "extended_only", ("less",), "bool"),
        Line("r", "select", ("fine", "x", "y")),
    )
    program = Program(("x", "y"), lines, ("r",), {})
    fine, plain = module.with_extended_only_forms(program), fold_constants(program)
    for x, y in ((1.0, 2.0), (2.0, 1.0)):
        assert in_doubles(fine, {"x": x, "y": y})["r"] == min(x, y)
        assert in_doubles(plain, {"x": x, "y": y})["r"] == y


def test_a_sign_costs_no_rounding():
    lines = (
        Line("sign", "copysign", (1.0, "y")),
        Line("rotated_sin", "select", (True, "sign", -1.0)),
        Line("r", "mul", ("rotated_sin", "x")),
    )
    wide = double_double(Program(("x", "y"), lines, ("r",), {}), double_constants())
    assert [line.op for line in wide.lines] == ["copysign", "mul"]


def test_an_infeasible_point_stays_nan():
    lines = (Line("r", "sqrt", ("x",)),)
    wide = double_double(Program(("x",), lines, ("r",), {}), double_constants())
    assert math.isnan(in_doubles(wide, {"x": -1.0})["r"])
    assert in_doubles(wide, {"x": 0.0})["r"] == 0.0
