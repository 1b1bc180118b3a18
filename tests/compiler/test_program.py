"""The canonical form: each way to break it is refused, by a message that names the line."""

import math

import pytest

from desaxe.compiler.program import (
    Line,
    Note,
    Program,
    ProgramError,
    reached,
    renamed_temporaries,
    type_of,
    validate,
)
from tests.compiler.programs import committed

U = Line("u", "add", ("x", "y"))
GOOD = Program(("x", "y"), (U, Line("v", "mul", ("u", 2.0))), ("v",), {})


def with_lines(*lines, outputs=("v",)):
    return GOOD._replace(lines=lines, outputs=outputs)


V = GOOD.lines[1]
BROKEN = [
    (with_lines(U, U, V), "'u' is assigned twice"),
    (with_lines(Line("x", "neg", ("y",)), U, V), "'x' is assigned twice"),
    (with_lines(U, Line("v", "power", ("u", 2.0))), "'v': unknown operation 'power'"),
    (with_lines(U, Line("v", "mul", ("u",))), "'v': mul takes 2 arguments, got 1"),
    (with_lines(V, U), "'v' uses 'u' before it is assigned"),
    (with_lines(Line("v", "neg", ("v",))), "'v' uses 'v' before it is assigned"),
    (with_lines(U, Line("v", "mul", ("u", True))), "'v': mul wants f64, got bool"),
    (with_lines(U, Line("v", "mul", ("u", 2))), "'v': mul wants f64, got i64"),
    (with_lines(U, Line("v", "select", ("u", "x", "y"))), "'v': select wants bool, got f64"),
    (with_lines(U, Line("v", "lt", ("u", "x"))), "'v' is f64, but lt gives bool"),
    (with_lines(U, V, outputs=("v", "w")), "output 'w' is never assigned"),
    (with_lines(U, V, Line("w", "neg", ("u",))), "unused lines: w"),
]


@pytest.mark.parametrize(("program", "complaint"), BROKEN)
def test_a_broken_program_is_refused(program, complaint):
    with pytest.raises(ProgramError, match=complaint):
        validate(program)


@pytest.mark.parametrize("program", [GOOD, GOOD._replace(outputs=("v", "u", "x")), Program((), (), (), {})])
def test_a_good_program_comes_back(program):
    assert validate(program) is program


def test_the_committed_program_is_canonical():
    program = committed("a_C", "alpha_BC_wrt_ec_AB", "status")
    assert validate(program) is program


@pytest.mark.parametrize(
    ("argument", "kind"), [("n", "i64"), (1.0, "f64"), (math.nan, "f64"), (1, "i64"), (True, "bool")]
)
def test_every_argument_has_a_type(argument, kind):
    assert type_of(argument, {"n": "i64"}) == kind


def test_what_the_outputs_reach():
    program = GOOD._replace(lines=(*GOOD.lines, Line("w", "neg", ("u",))))
    assert reached(program) == {"v", "u", "x", "y"}


def test_only_temporaries_are_renamed():
    lines = (
        Line("_a", "neg", ("x",)),
        Line("u", "neg", ("_a",)),
        Line("_b", "neg", ("u",)),
        Line("v", "neg", ("_b",)),
    )
    program = Program(("x",), lines, ("v",), {"u": Note("m", "a length")})
    short = renamed_temporaries(program, ["_b", "_a", "u", "v", "x"])
    assert [(line.name, line.args[0]) for line in short.lines] == [
        ("t1", "x"),
        ("u", "t1"),
        ("t0", "u"),
        ("v", "t0"),
    ]
