"""Hoisting: every line runs in the outermost loop that has what it needs, and nowhere else."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from desaxe.compiler.kernel import hoist, tabulate
from desaxe.compiler.passes.pipeline import optimise
from desaxe.compiler.program import Line, Program, names_in
from desaxe.runtime.executor import CompiledKernel
from tests.compiler.programs import INPUTS, committed, depends_on, programs
from tests.effort import cases

AXES = 3
GRID = {"BC": 0, "ec": 1, "theta": 2, "AB": None, "omega0": None, "alpha": None, "branch": None}


def level_of(kernel):
    return {line.name: depth for depth, lines in enumerate(kernel.levels) for line in lines}


def placements():
    return st.fixed_dictionaries({name: st.sampled_from([None, 0, 1, 2]) for name in INPUTS})


@pytest.mark.sampled
@given(programs(), placements())
@settings(max_examples=cases(25, 150), deadline=None)
def test_each_line_stands_once_after_what_it_uses_in_the_outermost_loop_possible(program, axis_of):
    levels = hoist(program, axis_of, AXES).levels
    lines, known = sum(levels, ()), set(program.inputs)
    assert sorted(line.op for line in lines) == sorted(line.op for line in program.lines)
    for line in lines:
        assert known.issuperset(names_in(line.args))
        assert line.name not in known
        known.add(line.name)
    needs = depends_on(Program(program.inputs, lines, program.outputs, {}))
    for depth, level in enumerate(levels):
        for line in level:
            axes = [axis_of[name] for name in needs[line.name] if axis_of[name] is not None]
            assert max(axes, default=-1) + 1 == depth


def test_types_and_notes_come_along():
    program = committed("Y", "status")
    kernel = hoist(program, {name: GRID[name] for name in program.inputs}, AXES)
    assert kernel.types["status"] == "i64"
    assert kernel.notes == program.notes


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
    outs = [np.zeros([values[name].size for name in order]) for _ in kernel.outputs]
    CompiledKernel(kernel).run(values, outs)
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
