"""The pipeline: the passes in order, what each saved, and how few operations are left."""

import pytest

from desaxe.compiler.passes.pipeline import PASSES, optimise, optimise_in_steps
from desaxe.mechanism.program import Variant, program_of
from tests.compiler.programs import (
    POINT,
    committed,
    exactly,
)

CONCENTRIC = {"ec": 0.0, "alpha": 0.0, "branch": 1.0}


def test_the_operations_after_each_pass():
    program, steps = optimise_in_steps(committed("a_C"), CONCENTRIC)
    assert [name for name, _ in steps] == ["sliced", *PASSES]
    assert steps[0][1] == len(committed("a_C").lines) > steps[1][1]
    assert steps[-1][1] == len(program.lines) == len(optimise(committed("a_C"), CONCENTRIC).lines)


@pytest.mark.parametrize("fixed", [{}, CONCENTRIC, {"branch": -1.0}, {"AB": 0.0}])
def test_the_committed_program_keeps_its_meaning(fixed):
    program = committed("s", "V_C", "j_C", "alpha_BC_wrt_theta", "a_C_wrt_ec_AB", "status")
    result, expected = exactly(optimise(program, fixed), POINT | fixed), exactly(program, POINT | fixed)
    assert all(abs(result[name] - expected[name]) <= 1e-45 * abs(expected[name]) for name in expected)


def operations(*names, state=False, **fixed):
    """The number of operations of a request at a point."""
    return len(optimise(program_of(names, Variant(state)), fixed).lines)


def test_operations_of_a_sine():
    assert operations("V_B_X", alpha=0.0) == 3  # cos, AB cos, AB cos omega


COUNTS = [
    (("Y",), {"branch": 1.0}, 50),
    (("V_C",), {"branch": 1.0}, 82),
    (("V_C",), CONCENTRIC, 53),
    (("a_C",), {"branch": 1.0}, 93),
    (("a_C",), CONCENTRIC, 57),
    (("Y", "V_C", "a_C"), {"branch": 1.0}, 99),
    (("margin",), {}, 9),
    (("margin",), {"ec": 0.0}, 4),
]


@pytest.mark.parametrize(("names", "fixed", "count"), COUNTS)
def test_operations(names, fixed, count):
    assert operations(*names, **fixed) == count


def test_a_state_costs_less_than_the_law():
    assert operations("a_C", state=True, branch=1.0) < operations("a_C", branch=1.0)


def test_a_concentric_mechanism_needs_no_eccentricity():
    program = optimise(committed("V_C", "a_C", "alpha_BC"), CONCENTRIC)
    assert program.inputs == ("theta", "AB", "BC", "omega0")
    assert not any("ec" in line.name.split("_") for line in program.lines)
