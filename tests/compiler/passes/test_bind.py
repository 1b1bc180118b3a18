"""Binding: an input becomes a constant; overlaying: a program's lines take the place of others."""

import pytest

from desaxe.compiler.passes.bind import assume, bind_constants, overlay
from desaxe.compiler.passes.slicing import keep_outputs
from desaxe.compiler.program import Line, Note, Program, validate
from desaxe.mechanism.program import Variant, program_of
from tests.compiler.programs import POINT, committed, exactly, same

PROGRAM = Program(("x", "y"), (Line("u", "add", ("x", "y")), Line("v", "mul", ("u", "x"))), ("v",), {})


def test_a_bound_input_becomes_a_constant():
    bound = bind_constants(PROGRAM, {"x": 2})
    assert bound.inputs == ("y",)
    assert bound.lines == (Line("u", "add", (2.0, "y")), Line("v", "mul", ("u", 2.0)))


def test_binding_what_is_no_input_changes_nothing():
    assert bind_constants(PROGRAM, {"omega": 1.0}) == PROGRAM


def test_the_committed_program_bound_on_a_branch():
    program = committed("Y", "alpha_BC", "a_C_wrt_BC")
    bound = validate(bind_constants(program, {"branch": -1.0}))
    assert same(exactly(bound, POINT), exactly(program, POINT | {"branch": -1.0}))


OTHER = Program(
    ("w",), (Line("_1", "neg", ("w",)), Line("u", "sin", ("_1",))), ("u",), {"u": Note("m", "new")}
)


def test_the_lines_of_the_overlay_come_instead():
    laid = validate(overlay(PROGRAM, OTHER))
    assert [(line.name, line.op) for line in laid.lines] == [("__1", "neg"), ("u", "sin"), ("v", "mul")]


def test_the_overlay_brings_its_inputs_and_notes():
    laid = overlay(PROGRAM, OTHER)
    assert laid.inputs == ("x", "w")
    assert laid.notes == {"u": Note("m", "new")}


def test_the_temporaries_of_both_are_kept_apart():
    lines = (Line("_1", "add", ("x", "y")), Line("u", "neg", ("_1",)), Line("v", "mul", ("u", "_1")))
    laid = overlay(Program(("x", "y"), lines, ("v",), {}), OTHER)
    assert validate(laid).lines[-1] == Line("v", "mul", ("u", "_1"))
    point = {"x": 2.0, "y": 3.0, "w": 0.0}
    assert exactly(laid, point)["v"] == 0


def test_an_input_of_the_overlay_is_no_longer_computed():
    by_u = Program(("u",), (Line("w", "neg", ("u",)),), ("w",), {})
    assert overlay(PROGRAM, by_u) == Program(("x", "u"), (PROGRAM.lines[1],), ("v",), {})


def test_laying_the_same_lines_twice_is_laying_them_once():
    once = overlay(PROGRAM, OTHER)
    assert overlay(once, OTHER) == once


def test_a_state_that_the_law_gives_means_the_same():
    names = ("omega", "V_C", "a_C", "j_C", "alpha_BC_wrt_ec")
    law = committed(*names)
    omega = exactly(law, POINT)["omega"]
    state = keep_outputs(validate(program_of(names, Variant(state=True))), names)
    assert "omega0" not in state.inputs
    result, expected = exactly(state, POINT | {"omega": omega}), exactly(law, POINT)
    assert all(abs(result[name] / expected[name] - 1) < 1e-45 for name in names)


CHOICE = (
    Line("wide", "lt", ("x", "y"), "bool"),
    Line("_1", "neg", ("x",)),
    Line("_2", "abs", ("y",)),
    Line("u", "select", ("wide", "_1", "_2")),
    Line("out", "mul", ("u", "u")),
)


@pytest.mark.parametrize(("known", "op"), [(True, "neg"), (False, "abs")])
def test_a_known_condition_leaves_the_side_that_is_taken_under_its_name(known, op):
    program = Program(("x", "y"), CHOICE, ("out",), {"u": Note("m", "a length")})
    result = validate(assume(program, {"wide": known}))
    assert [(line.name, line.op) for line in result.lines] == [("u", op), ("out", "mul")]
    assert result.notes == program.notes


def test_a_side_with_a_name_of_its_own_keeps_it():
    program = Program(("x", "y"), CHOICE, ("out",), {"u": Note("m", ""), "_1": Note("m", "")})
    result = validate(assume(program, {"wide": True}))
    assert [(line.name, line.op) for line in result.lines] == [("_1", "neg"), ("u", "copy"), ("out", "mul")]


def test_an_output_that_is_the_condition_stays():
    program = Program(("x", "y"), CHOICE, ("wide",), {})
    assert assume(program, {"wide": True}).lines == CHOICE[:1]
