"""The stages of a stable form: together they are the program, and the first has its sines and cosines."""

import pytest

from desaxe.compiler.interpret import run_in_doubles
from desaxe.compiler.lowering import for_loops
from desaxe.compiler.stages import TURNS, staged
from desaxe.mechanism.constants import constants
from desaxe.mechanism.program import Variant
from desaxe.runtime.specialise import specialise

FIXED = (("branch", 1.0), ("alpha", 0.0))
POINT = {"theta": 1.4, "ec": 0.02, "AB": 0.125, "BC": 0.15, "omega0": 150.0}


def lowered(*names):
    return for_loops(specialise(names, Variant(), FIXED), constants())


@pytest.mark.parametrize("names", [("V_C", "a_C"), ("status", "a_C_wrt_ec"), ("sin_theta", "margin")])
def test_the_stages_together_are_the_program(names):
    program = lowered(*names)
    first, second = staged(program)
    between = run_in_doubles(first, POINT)
    kept = {name: between[name] for name in first.outputs}
    found = run_in_doubles(second, POINT | kept)
    whole = run_in_doubles(program, POINT)
    assert [found.get(name, kept.get(name)) for name in program.outputs] == [whole[name] for name in names]


def test_the_second_stage_has_no_angle_to_reduce():
    first, second = staged(lowered("V_C", "a_C"))
    assert {line.op for line in first.lines} >= TURNS
    assert not TURNS & {line.op for line in second.lines}
    assert {line.op for line in second.lines} >= {"sqrt", "div"}
    assert len(first.outputs) <= 5


def test_what_has_no_angle_has_one_stage():
    assert staged(lowered("margin")) is None
    assert staged(specialise(("V_C",), Variant(), FIXED)) is None  # its sine and cosine are calls
