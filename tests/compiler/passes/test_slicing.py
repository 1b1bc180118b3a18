"""Slicing: only the lines that the requested outputs need stay, unchanged and in order."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from desaxe.compiler.passes.slicing import drop_unused, keep_outputs
from desaxe.compiler.program import Line, Note, Program, ProgramError, validate
from tests.compiler.programs import POINT, committed, exactly, points, programs, same
from tests.effort import cases

U, V, W = Line("u", "add", ("x", "y")), Line("v", "neg", ("u",)), Line("w", "neg", ("z",))
NOTES = {"u": Note("m", "a length"), "w": Note("m", "another")}
PROGRAM = Program(("x", "y", "z"), (U, V, W), ("v", "w"), NOTES)


def test_unreached_lines_inputs_and_notes_are_gone():
    assert keep_outputs(PROGRAM, ["v"]) == Program(("x", "y"), (U, V), ("v",), {"u": NOTES["u"]})


def test_the_outputs_have_the_order_asked_for():
    assert keep_outputs(PROGRAM, ["w", "u"]).outputs == ("w", "u")


def test_an_input_can_be_an_output():
    assert keep_outputs(PROGRAM, ["z"]) == Program(("z",), (), ("z",), {})


def test_an_unknown_output_is_refused():
    with pytest.raises(ProgramError, match="no line 'nowhere' to keep"):
        keep_outputs(PROGRAM, ["nowhere"])


@pytest.mark.sampled
@given(programs(), st.data())
@settings(max_examples=cases(15, 75), deadline=None)
def test_a_slice_is_valid(program, data):
    wanted = data.draw(st.sampled_from(program.lines)).name
    assert validate(keep_outputs(program, [wanted])).outputs == (wanted,)


@pytest.mark.sampled
@given(programs(), points())
@settings(max_examples=cases(15, 75), deadline=None)
def test_a_slice_keeps_the_meaning(program, point):
    whole = exactly(program, point)
    for name in program.outputs:
        assert same(exactly(keep_outputs(program, [name]), point), {name: whole[name]})


@pytest.mark.sampled
@given(programs())
@settings(max_examples=cases(15, 50), deadline=None)
def test_nothing_is_unused_after_dropping(program):
    assert drop_unused(program) == program


def test_a_quantity_means_the_same_in_any_company():
    together = exactly(committed("Y", "V_C", "a_C_wrt_ec", "status"), POINT)
    alone = {name: exactly(committed(name), POINT)[name] for name in together}
    assert same(alone, together)
