"""Both interpretations: exact over mpmath, and in doubles, where nothing raises."""

import mpmath
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from desaxe.compiler.interpret import run_in_doubles
from desaxe.compiler.program import Line, Program
from desaxe.oracle.truth import relative_error, truth
from tests.compiler.programs import (
    INPUTS,
    POINT,
    committed,
    exactly,
    in_doubles,
    program_of_nested,
    programs,
    run_exactly,
)
from tests.effort import cases

ANY = st.floats(allow_nan=True, allow_infinity=True)


def test_every_name_has_a_value():
    program = program_of_nested(("sub", ("mul", "x", "y"), "z"))
    assert run_in_doubles(program, {"x": 2.0, "y": 3.0, "z": 1.0}) == {
        "x": 2.0, "y": 3.0, "z": 1.0, "_0": 6.0, "out": 5.0,
    }  # fmt: skip


def test_the_exact_sum_of_doubles_is_not_rounded():
    program = program_of_nested(("sub", ("add", 1.0, 1e-30), 1.0))
    assert exactly(program, dict.fromkeys(INPUTS, 0))["out"] == mpmath.mpf(1e-30)
    assert in_doubles(program, {})["out"] == 0


def test_a_constant_is_the_double_that_is_written():
    program = program_of_nested(("sub", 0.1, ("div", 1.0, 10.0)))
    with mpmath.workdps(50):
        assert exactly(program, dict.fromkeys(INPUTS, 0))["out"] == mpmath.mpf(0.1) - mpmath.mpf(1) / 10


def test_exact_inputs_may_be_exact_numbers():
    program = program_of_nested(("mul", "x", 3.0))
    with mpmath.workdps(50):
        third = mpmath.mpf(1) / 3
        assert abs(run_exactly(program, mpmath.mp, {"x": third, "y": 0, "z": 0})["out"] - 1) < 1e-49


def test_whole_numbers_and_truth_values_stay():
    lines = (Line("less", "lt", ("x", "y"), "bool"), Line("out", "select", ("less", 3, 0), "i64"))
    program = Program(("x", "y"), lines, ("out", "less"), {})
    assert exactly(program, {"x": 1, "y": 2}) == {"out": 3, "less": True}


@pytest.mark.sampled
@given(programs(), st.fixed_dictionaries(dict.fromkeys(INPUTS, ANY)))
@settings(max_examples=cases(20, 100), deadline=None)
def test_nothing_raises_in_doubles(program, point):
    assert in_doubles(program, point).keys() == set(program.outputs)


@pytest.mark.parametrize("name", ["Y", "phi", "j_C", "alpha_BC_wrt_BC", "a_C_wrt_theta_ec"])
def test_the_committed_program_is_the_truth(name):
    """Interpreted exactly, the stable form is the loop closure's own value."""
    mechanism = {key: value for key, value in POINT.items() if key != "branch"}
    with mpmath.workdps(50):
        assert relative_error(1.0, exactly(committed(name), POINT)[name] / truth(name, **mechanism)) < 1e-40
