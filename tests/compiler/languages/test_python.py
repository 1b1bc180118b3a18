"""Plain Python: one function over `math` that answers for every point and loads nothing else."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from desaxe.compiler.languages.python import compile_python, point_text
from desaxe.compiler.program import Line, Program
from tests.compiler.coverage_set import NAMES, POINTS, coverage
from tests.compiler.languages.modules import wrong_names
from tests.compiler.programs import (
    INPUTS,
    POINT,
    WITH_NAN,
    committed,
    in_doubles,
    program_of_nested,
    programs,
    same_bits,
)
from tests.effort import cases

ANY = st.floats(allow_nan=True, allow_infinity=True)


@pytest.mark.parametrize("point", POINTS)
def test_the_coverage_set_against_exact(point):
    answers = dict(zip(NAMES, compile_python(coverage())(**point), strict=True))
    assert not wrong_names(answers, point)


@pytest.mark.sampled
@given(programs(WITH_NAN), st.fixed_dictionaries(dict.fromkeys(INPUTS, ANY)))
@settings(max_examples=cases(20, 100), deadline=None)
def test_no_bit_differs_from_the_interpretation(program, point):
    expected = in_doubles(program, point)
    answers = compile_python(program)(*(point[name] for name in program.inputs))
    assert all(same_bits(a, expected[n]) for n, a in zip(program.outputs, answers, strict=True))


def test_the_committed_program():
    program = committed("Y", "V_C", "a_C_wrt_ec", "alpha_BC", "status")
    answers = compile_python(program)(*(POINT[name] for name in program.inputs))
    assert dict(zip(program.outputs, answers, strict=True)) == in_doubles(program, POINT)


def test_one_output_is_a_tuple_too():
    assert compile_python(program_of_nested(("neg", "x")))(1.0, 0.0, 0.0) == (-1.0,)


def test_an_input_can_be_an_output():
    assert compile_python(Program(("x",), (), ("x", "x"), {}))(2.0) == (2.0, 2.0)


def test_golden():
    lines = (Line("u", "add", ("x", "y")), Line("v", "div", ("u", ("y"))))
    text = point_text(Program(("x", "y"), lines, ("v", "u"), {}))
    assert text == "def point(x, y):\n    u = x + y\n    v = divide(u, y)\n    return (v, u,)\n"
