"""Guarding: a bad element becomes NaN where it is used, and 4 in the status; a good one is untouched."""

import math

import pytest

from desaxe.compiler.passes.guard import BAD_INPUT, guard_inputs
from desaxe.compiler.passes.slicing import keep_outputs
from desaxe.compiler.program import Line, Program, validate
from desaxe.mechanism.inputs import INPUTS, LEAST
from tests.compiler.programs import (
    POINT,
    committed,
    depends_on,
    exactly,
    in_doubles,
    same,
)

LINES = (Line("less", "lt", ("x", 0.0), "bool"), Line("u", "mul", ("x", "y")))
STATUS = Line("status", "select", ("less", 1, 0), "i64")
PROGRAM = Program(("x", "y"), (*LINES, STATUS), ("u", "status"), {})
LEAST_Y, LARGEST_X = {"y": 2.0}, {"x": 1e6}


def guarded(x, y, inputs=("x", "y"), largest=()):
    program = validate(guard_inputs(PROGRAM, inputs, LEAST_Y, dict(largest)))
    return in_doubles(program, {"x": x, "y": y})


@pytest.mark.parametrize(("x", "status"), [(3.0, 0), (-3.0, 1), (0.0, 0), (1.7e308, 0), (5e-324, 0)])
def test_a_good_element_is_untouched(x, status):
    assert guarded(x, 2.0) == {"u": x * 2.0, "status": status}


@pytest.mark.parametrize(
    ("x", "y"), [(math.nan, 3), (math.inf, 3), (-math.inf, 3), (3, 1.9), (3, -5), (3, math.inf)]
)
def test_a_bad_element_is_nan_with_its_status(x, y):
    result = guarded(float(x), float(y))
    assert math.isnan(result["u"])
    assert result["status"] == BAD_INPUT


@pytest.mark.parametrize(
    ("x", "status"), [(1e6, 0), (-1e6, 1), (1000001.0, BAD_INPUT), (math.nan, BAD_INPUT)]
)
def test_an_element_too_large_is_bad(x, status):
    assert guarded(x, 2.0, largest=LARGEST_X)["status"] == status


def test_only_the_inputs_named_are_guarded():
    assert guarded(3.0, 1.0, inputs=("x",)) == {"u": 3.0, "status": 0}


def test_an_input_that_is_not_there_is_passed_over():
    assert guard_inputs(PROGRAM, ["z"], {}, {}) == PROGRAM


def test_nothing_is_added_for_a_status_that_is_not_asked_for():
    program = guard_inputs(keep_outputs(PROGRAM, ["u"]), ["x"], {}, {})
    assert [line.name for line in program.lines] == ["x_size", "x_is_finite", "x_good", "u"]


def test_an_input_that_is_an_output_is_nan_where_bad():
    program = Program(("x",), (Line("u", "neg", ("x",)),), ("u", "x"), {})
    result = in_doubles(validate(guard_inputs(program, ["x"], {}, {})), {"x": math.inf})
    assert len(result) == 2
    assert all(map(math.isnan, result.values()))


NAMES = ("Y", "phi", "V_C", "j_C", "alpha_BC", "a_C_wrt_ec", "omega", "V_B", "margin", "status")


def test_the_committed_program_keeps_its_meaning():
    program = committed(*NAMES)
    whole = validate(guard_inputs(program, INPUTS, LEAST, {}))
    assert same(exactly(whole, POINT), exactly(program, POINT))


BAD = {"theta": math.inf, "ec": -math.inf, "AB": -0.125, "BC": 0.0, "omega0": math.inf, "alpha": math.nan}


@pytest.mark.parametrize("name", BAD)
@pytest.mark.parametrize("alpha", [0.0, -3.0])
def test_every_quantity_that_needs_a_bad_input_is_nan(name, alpha):
    program = committed(*NAMES)
    needs = depends_on(program)
    result = in_doubles(
        guard_inputs(program, INPUTS, LEAST, {}), POINT | {"alpha": alpha} | {name: BAD[name]}
    )
    assert result.pop("status") == BAD_INPUT
    assert [q for q, value in result.items() if math.isnan(value)] == [q for q in result if name in needs[q]]
