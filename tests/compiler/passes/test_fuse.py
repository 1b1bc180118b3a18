"""Fused multiply-add: each free product goes into its sum, none that something else looks at."""

import pytest

from desaxe.compiler.passes.fuse import fuse_products
from desaxe.compiler.program import Line, Note, Program, validate
from tests.compiler.programs import committed

PRODUCT = Line("p", "mul", ("x", "y"))


def fused(*lines, outputs=("out",), notes=None):
    return fuse_products(Program(("x", "y", "z"), (PRODUCT, *lines), outputs, notes or {}))


@pytest.mark.parametrize(
    ("op", "args", "expected"),
    [
        ("add", ("p", "z"), [("mul_add", ("x", "y", "z"))]),
        ("add", ("z", "p"), [("mul_add", ("x", "y", "z"))]),
        ("sub", ("p", "z"), [("neg", ("z",)), ("mul_add", ("x", "y", "out_term"))]),
        ("sub", ("z", "p"), [("neg", ("x",)), ("mul_add", ("out_factor", "y", "z"))]),
        ("sub", ("p", 2.0), [("mul_add", ("x", "y", -2.0))]),
    ],
)
def test_a_product_goes_into_its_sum(op, args, expected):
    assert [(line.op, line.args) for line in fused(Line("out", op, args)).lines] == expected


@pytest.mark.parametrize(
    ("op", "args", "expected"),
    [
        ("add", ("n", "z"), [("neg", ("x",)), ("mul_add", ("out_factor", "y", "z"))]),
        ("sub", ("n", "z"), [("neg", ("x",)), ("neg", ("z",)), ("mul_add", ("out_factor", "y", "out_term"))]),
        ("sub", ("z", "n"), [("mul_add", ("x", "y", "z"))]),
    ],
)
def test_minus_a_product_goes_into_its_sum(op, args, expected):
    lines = fused(Line("n", "neg", ("p",)), Line("out", op, args)).lines
    assert [(line.op, line.args) for line in lines] == expected


def test_a_product_that_is_used_twice_stays():
    lines = (Line("s", "add", ("p", "z")), Line("out", "mul", ("s", "p")))
    assert fused(*lines).lines == (PRODUCT, *lines)


def test_the_error_of_a_sum_and_the_sum_see_the_same_product():
    lines = (
        Line("e", "two_sum_error", ("p", "z")),
        Line("s", "add", ("p", "z")),
        Line("out", "add", ("s", "e")),
    )
    assert fused(*lines).lines == (PRODUCT, *lines)


def test_a_product_whose_rounding_is_added_back_stays():
    lines = (
        Line("e", "two_product_error", ("y", "x")),
        Line("s", "add", ("p", "z")),
        Line("out", "add", ("s", "e")),
    )
    assert fused(*lines).lines == (PRODUCT, *lines)


def test_a_product_with_a_name_of_its_own_stays():
    line = Line("out", "add", ("p", "z"))
    assert fused(line, notes={"p": Note("m", "a length")}).lines == (PRODUCT, line)


def test_an_output_stays():
    line = Line("out", "add", ("p", "z"))
    assert fused(line, outputs=("p", "out")).lines == (PRODUCT, line)


def test_the_committed_program_has_fewer_operations():
    program = committed("V_C", "a_C", "a_C_wrt_ec")
    assert len(validate(fuse_products(program)).lines) < len(program.lines)


def test_there_is_nothing_to_do_twice():
    once = fuse_products(committed("V_C", "a_C"))
    assert fuse_products(once) == once
