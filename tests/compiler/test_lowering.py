"""The stages between a request and a language: what holds after each, on the committed programs."""

import math
from pathlib import Path

import pytest

import desaxe.compiler.passes as passes
from desaxe.compiler.interpret import run_in_doubles
from desaxe.compiler.kernel import Kernel
from desaxe.compiler.lowering import (
    Limits,
    for_loops,
    guarded_for_loops,
    guarded_pairs,
    nest,
    nest_of_two_forms,
)
from desaxe.compiler.program import Program, validate
from desaxe.mechanism.constants import constants, double_constants
from desaxe.mechanism.inputs import LEAST
from desaxe.mechanism.program import Variant
from desaxe.runtime.specialise import plain_form, specialise

NAMES = ("a_C", "V_C_wrt_ec")
FIXED = (("branch", 1.0), ("alpha", 0.0))
POINT = {"theta": 1.1, "ec": 0.01, "AB": 0.125, "BC": 0.35, "omega0": 150.0}


@pytest.fixture(scope="module")
def stable():
    return specialise(NAMES, Variant(), FIXED)


def values(program, point=POINT):
    result = run_in_doubles(program, {name: point[name] for name in program.inputs})
    return [result[name] for name in program.outputs]


def test_loops_have_no_calls_and_mean_the_same(stable):
    lowered = validate(for_loops(stable, constants()))
    assert {"sin", "cos"} <= {line.op for line in stable.lines}
    assert not {"sin", "cos"} & {line.op for line in lowered.lines}
    assert lowered.outputs == stable.outputs
    for a, b in zip(values(lowered), values(stable), strict=True):
        assert a == pytest.approx(b, rel=1e-13)


def test_without_coefficients_the_calls_stay(stable):
    assert {"sin", "cos"} <= {line.op for line in for_loops(stable, None).lines}


@pytest.mark.parametrize("bad", [math.nan, math.inf, -1.0])
def test_a_bad_element_is_nan(stable, bad):
    guarded = guarded_for_loops(stable, stable.inputs, Limits(LEAST), constants())
    assert all(math.isnan(value) for value in values(guarded, {**POINT, "BC": bad}))


def test_pairs_are_nearer_than_doubles(stable):
    wide = validate(guarded_pairs(stable, stable.inputs, Limits(LEAST), double_constants()))
    assert len(wide.lines) > 3 * len(stable.lines)
    for a, b in zip(values(wide), values(stable), strict=True):
        assert a == pytest.approx(b, rel=1e-13)


def test_a_nest_has_its_lines_where_they_belong(stable):
    kernel = nest(for_loops(stable, constants()), {"ec": 0, "theta": 1}, 2)
    assert isinstance(kernel, Kernel)
    assert kernel.inputs["AB"] is None
    names = [line.name for level in kernel.levels for line in level]
    assert len(names) == len(set(names))
    inside = {line.name for line in kernel.levels[-1]}
    assert "a_C" in inside
    assert not inside & {line.name for line in kernel.levels[0]}


def test_two_forms_keep_the_outputs(stable):
    plain = plain_form(NAMES, Variant(), FIXED)
    test = specialise(("wide_margins",), Variant(), FIXED)
    kernel = nest_of_two_forms(
        for_loops(plain, constants(), plain=True), for_loops(stable, constants()), test, 2, {"theta": 0}, 1
    )
    assert kernel.close is not None
    assert len(kernel.outputs) == 2


def test_every_pass_stands_in_the_catalogue_once():
    listed = [line.split()[0] for line in passes.__doc__.splitlines() if line[:1].isalpha() and "  " in line]
    parts = {"pipeline", "expansions", "pairs", "double_angles"}
    files = {path.stem for path in Path(passes.__file__).parent.glob("*.py")} - {"__init__"} - parts
    assert sorted(listed) == sorted([*files, "pass"])


def test_a_program_without_varying_inputs_is_not_guarded():
    program = specialise(("margin",), Variant(), ())
    assert isinstance(guarded_for_loops(program, (), Limits(LEAST), constants()), Program)
