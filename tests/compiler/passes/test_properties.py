"""Properties of all passes on random programs: the meaning stays, and a second pass changes nothing."""

import math

import pytest
from hypothesis import assume, given, settings

from desaxe.compiler.interpret import run_in_doubles
from desaxe.compiler.passes.bind import bind_constants
from desaxe.compiler.passes.fold import fold_constants
from desaxe.compiler.passes.fuse import fuse_products
from desaxe.compiler.passes.guard import guard_inputs
from desaxe.compiler.passes.pipeline import optimise
from desaxe.compiler.passes.slicing import drop_unused, keep_outputs
from desaxe.compiler.passes.value_numbering import value_numbering
from desaxe.compiler.program import validate
from tests.compiler.programs import NO_JUMPS, WITH_NAN, exactly, in_doubles, points, programs, same, same_bits
from tests.effort import cases

# Passes of a program at a point: the inputs that are bound have the point's values.
EXACT = {
    "bind": lambda program, at: bind_constants(program, {"x": at["x"], "y": at["y"]}),
    "fuse": lambda program, at: fuse_products(program),
    "guard": lambda program, at: guard_inputs(program, program.inputs, {}, {}),
    "slice": lambda program, at: keep_outputs(program, program.outputs[-1:]),
}
ROUNDED = {
    "fold": lambda program, at: fold_constants(program),
    "optimise": lambda program, at: optimise(program, {"x": at["x"]}),
}
FINAL = {
    **ROUNDED,
    "bind": EXACT["bind"],
    "drop": lambda program, at: drop_unused(program),
    "number": lambda program, at: value_numbering(program),
}


@pytest.mark.sampled
@pytest.mark.parametrize("name", EXACT)
@given(program=programs(), point=points())
@settings(max_examples=cases(15, 75), deadline=None)
def test_the_exact_meaning_stays(name, program, point):
    result, whole = validate(EXACT[name](program, point)), exactly(program, point)
    assert same(exactly(result, point), {output: whole[output] for output in result.outputs})


@pytest.mark.sampled
@pytest.mark.parametrize("name", ROUNDED)
@given(program=programs(ops=NO_JUMPS), point=points())
@settings(max_examples=cases(25, 150), deadline=None)
def test_no_bit_changes_where_all_is_finite(name, program, point):
    """The sign of a zero may."""
    scope = run_in_doubles(program, point)
    assume(all(math.isfinite(scope[line.name]) for line in program.lines))
    assert same(in_doubles(ROUNDED[name](program, point), point), in_doubles(program, point))


@pytest.mark.sampled
@given(programs(WITH_NAN), points())
@settings(max_examples=cases(15, 75), deadline=None)
def test_value_numbering_changes_no_bit(program, point):
    before, after = in_doubles(program, point), in_doubles(value_numbering(program), point)
    assert all(same_bits(before[name], after[name]) for name in before)


@pytest.mark.sampled
@pytest.mark.parametrize("name", FINAL)
@given(program=programs(), point=points())
@settings(max_examples=cases(15, 100), deadline=None)
def test_the_result_is_valid_and_final(name, program, point):
    once = validate(FINAL[name](program, point))
    assert FINAL[name](once, point) == once
    assert name != "drop" or once == program
