"""Value numbering: equal values are computed once, and no bit changes."""

from desaxe.compiler.passes.value_numbering import value_numbering
from desaxe.compiler.program import Line, Note, Program
from tests.compiler.programs import (
    POINT,
    committed,
    exactly,
    lines_of,
    same,
)


def numbered(*nested):
    """The lines after numbering a product of these."""
    sides = [lines_of(side) for side in nested]
    lines = [
        line._replace(name=f"s{i}_{line.name}", args=own(line, i)) for i, s in enumerate(sides) for line in s
    ]
    product = Line("product", "atan2", tuple(f"s{i}_out" for i in range(2)))
    return value_numbering(Program(("x", "y", "z"), (*lines, product), ("product",), {})).lines


def own(line, side):
    return tuple(f"s{side}_{a}" if isinstance(a, str) and a not in "xyz" else a for a in line.args)


def test_the_same_operation_is_done_once():
    assert len(numbered(("sub", "x", "y"), ("sub", "x", "y"))) == 2


def test_the_same_nested_value_is_computed_once():
    assert len(numbered(("sin", ("sub", "x", "y")), ("sin", ("sub", "x", "y")))) == 3


def test_what_commutes_is_merged():
    assert len(numbered(("add", "x", "y"), ("add", "y", "x"))) == 2


def test_what_does_not_commute_is_not():
    assert len(numbered(("sub", "x", "y"), ("sub", "y", "x"))) == 3


def test_nothing_is_reassociated():
    assert len(numbered(("add", ("add", "x", "y"), "z"), ("add", "x", ("add", "y", "z")))) == 5


def test_constants_of_two_types_are_two_values():
    lines = (
        Line("less", "lt", ("x", "y"), "bool"),
        Line("u", "select", ("less", 1.0, 0.0)),
        Line("n", "select", ("less", 1, 0), "i64"),
    )
    program = Program(("x", "y"), lines, ("u", "n"), {})
    assert value_numbering(program) == program


def test_zeros_of_two_signs_are_two_values():
    lines = (Line("u", "copysign", ("x", 0.0)), Line("v", "copysign", ("x", -0.0)))
    program = Program(("x",), lines, ("u", "v"), {})
    assert value_numbering(program) == program


def test_a_name_with_a_meaning_is_kept():
    lines = (Line("_1", "neg", ("x",)), Line("u", "neg", ("x",)), Line("v", "sub", ("_1", "u")))
    program = value_numbering(Program(("x",), lines, ("v",), {"u": Note("m", "a length")}))
    assert program.lines == (Line("u", "neg", ("x",)), Line("v", "sub", ("u", "u")))


def test_two_outputs_of_one_value_stay():
    lines = (Line("u", "neg", ("x",)), Line("v", "neg", ("x",)))
    program = value_numbering(Program(("x",), lines, ("u", "v"), {}))
    assert program.lines == (Line("u", "neg", ("x",)), Line("v", "copy", ("u",)))


def test_a_copy_of_a_line_is_that_line():
    lines = (Line("u", "neg", ("x",)), Line("_1", "copy", ("u",)), Line("v", "sin", ("_1",)))
    program = value_numbering(Program(("x",), lines, ("v",), {}))
    assert program.lines == (Line("u", "neg", ("x",)), Line("v", "sin", ("u",)))


def test_the_committed_program_has_nothing_left_to_merge():
    program = committed("a_C_wrt_theta", "alpha_BC_wrt_ec")
    assert value_numbering(program) == program
    assert same(exactly(value_numbering(program), POINT), exactly(program, POINT))
