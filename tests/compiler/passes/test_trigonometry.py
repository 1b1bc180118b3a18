"""Sine and cosine written out: within two ulp, next to multiples of pi/2 too, and shared."""

import math
import random

import mpmath
import pytest

from desaxe.compiler.languages.python import compile_python
from desaxe.compiler.passes.trigonometry import expand_trigonometry
from desaxe.compiler.passes.value_numbering import value_numbering
from desaxe.compiler.program import Line, Program, validate
from desaxe.mechanism.constants import constants
from desaxe.oracle.truth import ulp_error
from tests.compiler.coverage_set import POINTS, coverage
from tests.compiler.programs import POINT, committed, in_doubles

LINES = (Line("sine_of_x", "sin", ("x",)), Line("cosine_of_x", "cos", ("x",)))
PROGRAM = Program(("x",), LINES, ("sine_of_x", "cosine_of_x"), {})
EXPANDED = expand_trigonometry(PROGRAM, constants())
LIMIT = constants().limit


def worst(angles):
    """The largest error of sine and cosine, in ulp."""
    sine_and_cosine = compile_python(EXPANDED)
    with mpmath.workdps(60):
        pairs = ((sine_and_cosine(a), (mpmath.sin(a), mpmath.cos(a))) for a in angles)
        return max(
            ulp_error(result, want) for gots, wants in pairs for result, want in zip(gots, wants, strict=True)
        )


def next_to_quarters(count):
    """Doubles on, just before and just after multiples of pi/2."""
    for k in [*range(1, 20), *(random.Random(k).randrange(1, 2**20) for k in range(count))]:
        with mpmath.workdps(30):
            angle = float(k * mpmath.pi / 2)
        yield from (angle, -angle, math.nextafter(angle, 0), math.nextafter(-angle, -math.inf))


@pytest.mark.parametrize("largest", [1e-300, 1e-9, 1e-3, 0.7, 3.0, 100.0, LIMIT])
def test_within_two_ulp(largest):
    rng = random.Random(largest)
    assert worst([rng.uniform(-largest, largest) for _ in range(700)]) <= 2


def test_within_two_ulp_next_to_a_multiple_of_a_quarter():
    assert worst([a for a in next_to_quarters(400) if abs(a) <= LIMIT]) <= 2


@pytest.mark.parametrize("angle", [LIMIT, -LIMIT, math.nextafter(math.pi / 4, 0), math.pi / 4, 5e-324])
def test_within_two_ulp_at_the_edges(angle):
    assert worst([angle]) <= 2


def test_the_sine_of_zero_is_zero_and_its_cosine_one():
    assert compile_python(EXPANDED)(0.0) == (0.0, 1.0)


@pytest.mark.parametrize("angle", [math.nan, math.inf, -math.inf])
def test_nan_survives(angle):
    assert all(math.isnan(value) for value in compile_python(EXPANDED)(angle))


def test_sine_and_cosine_are_gone():
    assert not {"sin", "cos"} & {line.op for line in validate(EXPANDED).lines}


SINE_ALONE = expand_trigonometry(Program(("x",), LINES[:1], ("sine_of_x",), {}), constants())


def test_nothing_is_left_over():
    assert validate(SINE_ALONE).outputs == ("sine_of_x",)


def test_both_of_an_angle_share_the_work():
    assert len(EXPANDED.lines) < 1.2 * len(SINE_ALONE.lines)


def test_another_angle_has_lines_of_its_own():
    program = Program(("x", "y"), (LINES[0], Line("other", "sin", ("y",))), ("sine_of_x", "other"), {})
    assert len(expand_trigonometry(program, constants()).lines) == 2 * len(SINE_ALONE.lines)


def test_there_is_nothing_to_do_twice():
    assert expand_trigonometry(EXPANDED, constants()) == EXPANDED


def test_names_and_notes_stay():
    program = committed("Y")
    expanded = expand_trigonometry(program, constants())
    assert expanded.notes == program.notes
    assert {line.name for line in program.lines} <= {line.name for line in expanded.lines}


@pytest.mark.parametrize("point", POINTS)
def test_the_coverage_set(point):
    result, expected = (
        in_doubles(expand_trigonometry(coverage(), constants()), point),
        in_doubles(coverage(), point),
    )
    assert all(math.isclose(result[name], expected[name], rel_tol=1e-15, abs_tol=1e-15) for name in result)


def test_the_committed_program_keeps_its_values():
    program = committed("Y", "V_C", "a_C", "phi", "alpha_BC")
    expanded = value_numbering(expand_trigonometry(program, constants()))
    result, expected = in_doubles(validate(expanded), POINT), in_doubles(program, POINT)
    assert all(math.isclose(result[name], expected[name], rel_tol=4e-15) for name in result)
