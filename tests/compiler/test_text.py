"""The text form: what is written reads back as the same program, in few parentheses but enough."""

import math

import pytest
from hypothesis import given, settings

from desaxe.compiler.program import Line, Note, Program, ProgramError
from desaxe.compiler.text import (
    ProgramText,
    read_function,
    with_short_temporaries,
    write_function,
    write_lines,
)
from tests.compiler.programs import WITH_NAN, program_of_nested, programs, tree
from tests.effort import cases

LESS, MORE = ("lt", "x", "y"), ("le", "y", "z")
GOLDEN = [
    (("sub", "x", ("sub", "y", "z")), "x - (y - z)"),
    (("sub", ("sub", "x", "y"), "z"), "x - y - z"),
    (("add", "x", ("add", "y", "z")), "x + (y + z)"),
    (("sub", "x", ("mul", "y", "z")), "x - y * z"),
    (("mul", ("sub", "x", "y"), "z"), "(x - y) * z"),
    (("div", "x", ("div", "y", "z")), "x / (y / z)"),
    (("div", ("div", "x", "y"), "z"), "x / y / z"),
    (("mul", "x", ("div", "y", "z")), "x * (y / z)"),
    (("div", "x", ("mul", "y", "z")), "x / (y * z)"),
    (("neg", ("add", "x", "y")), "-(x + y)"),
    (("neg", ("mul", "x", "y")), "-(x * y)"),
    (("mul", ("neg", "x"), "y"), "-x * y"),
    (("neg", ("neg", "x")), "-(-x)"),
    (("sub", "x", ("neg", "y")), "x - -y"),
    (("sub", "x", -2.0), "x - -2.0"),
    (("mul", -2.0, "x"), "-2.0 * x"),
    (("neg", -2.0), "-(-2.0)"),
    (("copy", -2.0), "-2.0"),
    (("copy", math.nan), "nan"),
    (("sqrt", ("add", "x", "y")), "sqrt(x + y)"),
    (("atan2", ("neg", "x"), ("select", LESS, "x", "y")), "atan2(-x, x if x < y else y)"),
    (("select", LESS, "x", ("select", MORE, "y", "z")), "x if x < y else (y if y <= z else z)"),
    (
        ("select", ("lt", ("select", LESS, "x", "y"), "z"), 1.0, 0.0),
        "1.0 if (x if x < y else y) < z else 0.0",
    ),
    (("select", LESS, ("neg", "x"), ("add", "x", 1.0)), "-x if x < y else x + 1.0"),
    (("add", ("select", LESS, "x", "y"), 1.0), "(x if x < y else y) + 1.0"),
    (("select", LESS, 3, 0), "3 if x < y else 0"),
    (("lt", ("add", "x", "y"), ("mul", "y", "z")), "x + y < y * z"),
    (("and", ("or", LESS, MORE), LESS), "(x < y or y <= z) and x < y"),
    (("or", ("and", LESS, MORE), LESS), "x < y and y <= z or x < y"),
    (("not", LESS), "not x < y"),
    (("not", ("and", LESS, MORE)), "not (x < y and y <= z)"),
    (("and", ("not", LESS), MORE), "not x < y and y <= z"),
    (("not", ("not", LESS)), "not (not x < y)"),
]
OTHER_COLUMNS = [
    ("python", ("sub", "x", ("div", "y", ("add", "x", "z"))), "x - divide(y, x + z)"),
    ("python", ("neg", ("sqrt", ("mul", "x", "y"))), "-root(x * y)"),
    ("numba", ("and", LESS, MORE), "(x < y) & (y <= z)"),
    ("numba", ("or", ("and", LESS, MORE), LESS), "((x < y) & (y <= z)) | (x < y)"),
    ("numba", ("not", ("and", LESS, MORE)), "not (x < y) & (y <= z)"),
    ("numba", ("and", ("not", LESS), MORE), "(not x < y) & (y <= z)"),
    ("numba", ("select", ("or", LESS, MORE), "x", "y"), "x if (x < y) | (y <= z) else y"),
]


@pytest.mark.parametrize(("nested", "text"), GOLDEN)
def test_golden(nested, text):
    assert write_lines(program_of_nested(nested)) == [f"out = {text}"]


@pytest.mark.parametrize(("column", "nested", "text"), OTHER_COLUMNS)
def test_golden_of_a_language(column, nested, text):
    assert write_lines(program_of_nested(nested), column) == [f"out = {text}"]


@pytest.mark.parametrize(("nested", "text"), GOLDEN)
def test_golden_reads_back(nested, text):
    program = read_function(f"def f(x, y, z):\n    out = {text}\n    return out\n")
    assert tree(program) == tree(program_of_nested(nested))


@pytest.mark.sampled
@given(programs(WITH_NAN))
@settings(max_examples=cases(30, 150), deadline=None)
def test_what_is_written_reads_back(program):
    again = read_function(write_function(program, "f", "It."))
    assert tree(again) == tree(program)
    assert again.notes == program.notes


@pytest.mark.sampled
@given(programs(WITH_NAN))
@settings(max_examples=cases(15, 75), deadline=None)
def test_what_is_read_is_written_alike(program):
    text = write_function(program, "f", "It.")
    assert write_function(read_function(text), "f", "It.") == text


def test_a_negative_constant_is_read_as_a_constant():
    program = read_function("def f():\n    out = -2.0\n    return out\n")
    assert program.lines == (Line("out", "copy", (-2.0,)),)


def test_a_temporary_used_twice_keeps_its_line():
    lines = (Line("_0", "add", ("x", "y")), Line("out", "mul", ("_0", "_0")))
    program = Program(("x", "y"), lines, ("out",), {})
    assert write_lines(with_short_temporaries(program)) == ["t0 = x + y", "out = t0 * t0"]


NOTES = [
    Note("m", "a length"),
    Note("m/s^2", "an acceleration", "A (19)"),
    Note("1", "|sin(theta)|"),
    Note("", "NaN where bad"),
    Note("rad", "an angle", ""),
]


@pytest.mark.parametrize("note", NOTES)
def test_a_note_survives(note):
    program = Program(("x",), (Line("out", "neg", ("x",)),), ("out",), {"out": note})
    assert read_function(write_function(program, "f", "It.")).notes == {"out": note}


TEXT = '''def f(x, y, z):
    """It."""
    u = x + y  # m | a length
    broken = ) not Python at all
    v = u * u
    return u, broken, v
'''


def test_only_the_wanted_lines_are_parsed():
    program = ProgramText(TEXT).read(["v"])
    assert [line.name for line in program.lines] == ["u", "v"]


def test_only_the_inputs_that_are_used_remain():
    assert ProgramText(TEXT).read(["v"]).inputs == ("x", "y")


def test_the_outputs_are_those_returned():
    assert ProgramText(TEXT).outputs() == ("u", "broken", "v")


def test_the_outputs_keep_the_order_asked_for():
    assert ProgramText(TEXT).read(["v", "x", "u"]).outputs == ("v", "x", "u")


def test_a_name_without_a_line_is_no_name():
    with pytest.raises(KeyError, match="nowhere"):
        ProgramText(TEXT).read(["nowhere"])


def test_a_name_is_not_found_inside_another():
    text = TEXT.replace("    v = u * u", "    my_v = u - u\n    v = u * u")
    assert ProgramText(text).read(["v"]).lines[-1] == Line("v", "mul", ("u", "u"))


@pytest.mark.parametrize("text", ["x ** y", "power(x, y)", "x < y < z", "x[0]", "x != y", "x + (y < z)"])
def test_what_is_no_operation_cannot_be_read(text):
    with pytest.raises(ProgramError):
        read_function(f"def f(x, y, z):\n    out = {text}\n    return out\n")
