"""Folding: what is constant is computed, factors 0 and 1 are gone, and nothing else changes."""

import math

import pytest

from desaxe.compiler.operations import OPERATIONS
from desaxe.compiler.passes.bind import bind_constants
from desaxe.compiler.passes.fold import fold_constants
from desaxe.compiler.program import Line, Program
from tests.compiler.programs import (
    POINT,
    committed,
    in_doubles,
    program_of_nested,
)

LESS = ("lt", "x", "y")
FOLDED = [
    (("add", "x", 0.0), ("copy", "x")),
    (("add", 0.0, "x"), ("copy", "x")),
    (("sub", "x", 0.0), ("copy", "x")),
    (("sub", 0.0, "x"), ("neg", "x")),
    (("mul", 0.0, "x"), ("copy", 0.0)),
    (("mul", "x", 0.0), ("copy", 0.0)),
    (("mul", "x", 1.0), ("copy", "x")),
    (("mul", -1.0, "x"), ("neg", "x")),
    (("mul_add", "x", 0.0, "y"), ("copy", "y")),
    (("mul_add", "x", "y", 0.0), ("mul", "x", "y")),
    (("mul_add", "x", 1.0, 0.0), ("copy", "x")),
    (("extended_only", LESS), ("copy", False)),
    (("div", "x", 1.0), ("copy", "x")),
    (("div", 0.0, "x"), ("copy", 0.0)),
    (("two_sum_error", "x", 0.0), ("copy", 0.0)),
    (("select", True, "x", "y"), ("copy", "x")),
    (("select", ("lt", 2.0, 1.0), "x", "y"), ("copy", "y")),
    (("select", LESS, "x", "x"), ("copy", "x")),
    (("select", LESS, ("mul", 1.0, "x"), "x"), ("copy", "x")),
    (("add", 0.1, 0.2), ("copy", 0.30000000000000004)),
    (("sqrt", ("mul", 8.0, 2.0)), ("copy", 4.0)),
    (("div", 1.0, 0.0), ("copy", math.inf)),
    (("not", ("le", 1.0, 2.0)), ("copy", False)),
    (("add", "y", ("mul", ("mul", "x", 0.0), "z")), ("copy", "y")),
]
KEPT = [
    ("add", "x", 1.0),
    ("sub", 1.0, "x"),
    ("mul", "x", 2.0),
    ("mul_add", "x", 2.0, "y"),
    ("div", 1.0, "x"),
    ("mul", math.nan, "x"),
    ("select", LESS, "x", "y"),
    ("copysign", "x", 0.0),
]


@pytest.mark.parametrize(("nested", "folded"), FOLDED)
def test_golden(nested, folded):
    assert only_line(fold_constants(program_of_nested(nested))) == folded


def only_line(program):
    (line,) = program.lines
    return line.op, *line.args


@pytest.mark.parametrize("nested", KEPT)
def test_what_is_not_neutral_stays(nested):
    assert fold_constants(program_of_nested(nested)).lines == program_of_nested(nested).lines


@pytest.mark.parametrize("op", [op for op, row in OPERATIONS.items() if set(row.signature) == {"f"}])
def test_constants_are_computed_as_they_would_be(op):
    args = (0.7, 1.3, -0.2)[: OPERATIONS[op].arity]
    folded = only_line(fold_constants(program_of_nested((op, *args))))
    assert folded == ("copy", in_doubles(program_of_nested((op, *args)), {"x": 0, "y": 0, "z": 0})["out"])


def test_an_output_that_becomes_another_stays():
    lines = (Line("u", "neg", ("x",)), Line("v", "mul", ("u", 1.0)))
    program = Program(("x",), lines, ("u", "v"), {})
    assert fold_constants(program).lines == (lines[0], Line("v", "copy", ("u",)))


def test_inputs_of_a_vanished_term_are_gone():
    assert fold_constants(program_of_nested(("add", "x", ("mul", 0.0, "y")))).inputs == ("x",)


SCENES = [{}, {"ec": 0.0}, {"alpha": 0.0}, {"ec": 0.0, "alpha": 0.0, "branch": 1.0}, {"branch": -1.0}]


@pytest.mark.parametrize("fixed", SCENES)
def test_an_infeasible_point_stays_nan(fixed):
    program = fold_constants(bind_constants(committed("Y", "V_C", "a_C", "alpha_BC", "a_C_wrt_BC"), fixed))
    assert all(math.isnan(value) for value in in_doubles(program, POINT | fixed | {"AB": 0.5}).values())
