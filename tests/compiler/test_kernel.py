"""Hoisting: every line runs in the outermost loop that has what it needs, and nowhere else."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from desaxe.compiler.kernel import hoist, level_program, tabulate
from desaxe.compiler.languages.numba.module import emit_numba
from desaxe.compiler.passes.pipeline import optimise
from desaxe.compiler.program import Line, Note, Program, names_in
from tests.compiler.programs import INPUTS, committed, depends_on, programs
from tests.effort import cases

AXES = 3
GRID = {"BC": 0, "ec": 1, "theta": 2, "AB": None, "omega0": None, "alpha": None, "branch": None}
KINEMATICS = ("Y", "V_C", "a_C")


def level_of(kernel):
    return {line.name: depth for depth, lines in enumerate(kernel.levels) for line in lines}


def placements():
    return st.fixed_dictionaries({name: st.sampled_from([None, 0, 1, 2]) for name in INPUTS})


@pytest.mark.sampled
@given(programs(), placements())
@settings(max_examples=cases(15, 75), deadline=None)
def test_every_line_is_in_the_outermost_loop_possible(program, axis_of):
    kernel = hoist(program, axis_of, AXES)
    program = Program(program.inputs, sum(kernel.levels, ()), program.outputs, {})
    for name, needs in depends_on(program).items():
        if name not in program.inputs:
            axes = [axis_of[n] for n in needs if axis_of[n] is not None]
            assert level_of(kernel)[name] == max(axes, default=-1) + 1


@pytest.mark.sampled
@given(programs(), placements())
@settings(max_examples=cases(15, 50), deadline=None)
def test_no_line_is_lost_or_doubled(program, axis_of):
    kernel = hoist(program, axis_of, AXES)
    assert sorted(line.op for lines in kernel.levels for line in lines) == sorted(
        line.op for line in program.lines
    )
    assert len(level_of(kernel)) == len(program.lines)


@pytest.mark.sampled
@given(programs(), placements())
@settings(max_examples=cases(15, 50), deadline=None)
def test_a_line_comes_after_what_it_uses(program, axis_of):
    kernel = hoist(program, axis_of, AXES)
    known = set(program.inputs)
    for line in sum(kernel.levels, ()):
        assert known.issuperset(names_in(line.args))
        known.add(line.name)


def kernel_of(*names, **axis_of):
    program = committed(*names)
    placed = GRID | axis_of
    return hoist(program, {name: placed[name] for name in program.inputs}, AXES)


def test_what_needs_only_the_angle_stays_out_of_the_inner_loops():
    kernel = kernel_of(*KINEMATICS, theta=0, ec=1, BC=2)
    levels = level_of(kernel)
    assert {levels[name] for name in ("sin_theta", "cos_theta", "abs_sin", "eps", "omega", "turn")} <= {0, 1}
    assert not {"sin", "cos"} & {line.op for line in (*kernel.levels[2], *kernel.levels[3])}


def test_the_inner_loop_uses_its_axis():
    kernel = kernel_of(*KINEMATICS, theta=0, ec=1, BC=2)
    needs = depends_on(Program(tuple(kernel.inputs), sum(kernel.levels, ()), (), {}))
    assert all("BC" in needs[line.name] for line in kernel.levels[3])


def test_what_needs_no_axis_runs_once():
    levels = level_of(kernel_of(*KINEMATICS))
    assert levels["turn"] == 0


def test_the_margin_of_a_design_is_outside_the_angles():
    levels = level_of(kernel_of("margin", "Y"))
    assert levels["margin"] == 2
    assert levels["sin_theta"] == 3


def test_types_and_notes_come_along():
    kernel = kernel_of("Y", "status")
    assert kernel.types["status"] == "i64"
    assert kernel.notes == committed("Y", "status").notes


LINES = (
    Line("u", "neg", ("x",)),
    Line("v", "mul", ("u", "y")),
    Line("w", "mul", ("v", "z")),
    Line("only_x", "sin", ("u",)),
)
SMALL = Program(INPUTS, LINES, ("w", "only_x", "v"), {"u": Note("1", "a step")})


@pytest.mark.parametrize(("level", "outputs"), [(0, ()), (1, ("u", "only_x")), (2, ("v",)), (3, ("w",))])
def test_a_level_gives_what_the_others_need(level, outputs):
    """`u` and `v` go deeper; `only_x` and `w` go to the outputs."""
    assert level_program(hoist(SMALL, {"x": 0, "y": 1, "z": 2}, AXES), level).outputs == outputs


def test_a_constant_runs_once():
    program = Program(("x",), (Line("u", "copy", (2.0,)), Line("v", "mul", ("u", "x"))), ("u", "v"), {})
    assert level_of(hoist(program, {"x": 0}, 1)) == {"u": 0, "v": 1}


ORDERS = [("theta", "ec", "AB", "BC"), ("ec", "AB", "BC", "theta"), ("AB", "theta", "BC", "ec")]
FIXED = {"branch": 1.0, "omega0": 50.0, "alpha": 0.0}


def placed(order):
    program = optimise(committed("Y", "a_C", "a_C_wrt_BC"), FIXED)
    return program, {name: order.index(name) for name in program.inputs}


def filled(kernel, order):
    """The outputs of the kernel over a small grid."""
    values = {"theta": np.linspace(0, 7, 9), "ec": np.linspace(-0.1, 0.3, 4)}
    values |= {"AB": np.linspace(0.1, 0.2, 3), "BC": np.linspace(0.3, 0.4, 5)}
    scope = {}
    exec(emit_numba(kernel, "a grid"), scope)
    outs = [np.zeros([values[name].size for name in order]) for _ in kernel.outputs]
    scope["kernel"](*(values[name] for name in kernel.inputs), *outs)
    return outs


@pytest.mark.thorough
@pytest.mark.parametrize("order", ORDERS)
def test_tables_change_no_bit(order):
    program, axis_of = placed(order)
    plain, tabled = hoist(program, axis_of, 4), tabulate(program, axis_of, 4)
    assert bool(tabled.tables) == (order[-1] != "BC")
    for with_tables, without in zip(filled(tabled, order), filled(plain, order), strict=True):
        assert np.array_equal(with_tables, without, equal_nan=True)


@pytest.mark.parametrize("order", ORDERS)
def test_a_table_has_what_lacks_an_outer_axis_and_the_loops_have_it_no_more(order):
    program, axis_of = placed(order)
    kernel = tabulate(program, axis_of, 4)
    named = [name for table in kernel.tables for name in table.kernel.outputs]
    assert len(set(named)) == len(named)
    assert not set(named) & {line.name for lines in kernel.levels for line in lines}
    for table in kernel.tables:
        assert len(table.along) <= max(table.along)
        assert {axis_of[name] for name in table.kernel.inputs} == set(table.along)


def test_sine_and_cosine_are_in_a_table_where_the_angle_is_the_innermost_axis():
    program, axis_of = placed(("ec", "AB", "BC", "theta"))
    kernel = tabulate(program, axis_of, 4)
    assert not {"sin", "cos"} & {line.op for lines in kernel.levels for line in lines}


def test_prefixes_of_the_axes_need_no_table():
    program, axis_of = placed(("theta", "ec", "AB", "BC"))
    along = [table.along for table in tabulate(program, axis_of, 4).tables]
    assert (0,) not in along
    assert (0, 1) not in along
    assert tabulate(program, dict.fromkeys(axis_of, 0), 1).tables == ()


def test_a_status_is_computed_where_it_is_needed():
    program = Program(
        ("x", "y"),
        (
            Line("low", "lt", ("y", 0.0), "bool"),
            Line("s", "select", ("low", 3, 1), "i64"),
            Line("r", "add", ("x", "y")),
        ),
        ("s", "r"),
        {},
    )
    assert tabulate(program, {"x": 0, "y": 1}, 2).tables == ()
