"""Slicing: only the lines that the requested outputs need stay, unchanged and in order."""

import pytest

from desaxe.compiler.passes.slicing import keep_outputs
from desaxe.compiler.program import Line, Note, Program, ProgramError

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
