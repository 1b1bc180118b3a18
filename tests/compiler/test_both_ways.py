"""What depends on a sign alone is computed for both signs; no value changes by a bit."""

import pytest

from desaxe.compiler.passes.both_ways import both_ways
from desaxe.compiler.passes.slicing import drop_unused
from desaxe.compiler.program import Line, Program, validate
from tests.compiler.programs import POINT, committed, in_doubles, same_bits

NAMES = ("Y", "V_C", "a_C", "a_C_wrt_ec", "status")
LENGTHS = ("ec", "AB", "BC")


@pytest.mark.parametrize("theta", [1.0, -1.0, 4.0, 0.0, -0.0])
@pytest.mark.parametrize("ec", [0.02, -0.02, 0.0])
def test_no_bit_changes(theta, ec):
    program = committed(*NAMES)
    split = validate(both_ways(program, LENGTHS))
    point = POINT | {"theta": theta, "ec": ec}
    before, after = in_doubles(program, point), in_doubles(split, point)
    assert all(same_bits(after[name], before[name]) for name in NAMES)


def test_the_margins_of_both_sides_need_no_angle():
    split = both_ways(committed(*NAMES), LENGTHS)
    whole = {line.name: line for line in split.lines}
    condition, minus, plus = whole["margin_side"].args
    assert whole[condition].op == "lt"
    for name in (minus, plus):
        own = Program(split.inputs, split.lines, (name,), {})
        assert set(drop_unused(own).inputs) == set(LENGTHS)


def test_what_costs_little_is_left_alone():
    """Choosing between two sums costs as much as the sum."""
    lines = (
        Line("below", "lt", ("theta", 0.0), "bool"),
        Line("side", "select", ("below", -1.0, 1.0)),
        Line("towards", "mul", ("side", "ec")),
        Line("r", "add", ("towards", "theta")),
    )
    program = Program(("theta", "ec"), lines, ("r",), {})
    assert both_ways(program, ("ec",)) == program


def test_a_program_without_a_sign_is_left_alone():
    program = committed("margin")
    assert both_ways(program, LENGTHS) == program
