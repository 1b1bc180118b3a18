"""The Kernel: a loop nest whose bodies are straight lines of a Program.

`hoist` places every line in the outermost loop that has all it depends on: what depends on no axis
runs once, before the loops. What depends on some axes but not on one that lies outside of them would
run again for every value of that one: `tabulate` computes it before the loops, into a table, where
that pays. Only a Kernel is turned into numba.
"""

from collections.abc import Mapping
from typing import NamedTuple

from .operations import OPERATIONS
from .passes.slicing import drop_unused, keep_outputs
from .program import Line, Note, Program, names_in, reached
from .text import with_short_temporaries


class Kernel(NamedTuple):
    """A loop nest over `axes` loops.

    `inputs` maps an input to its axis (0 is the outermost loop), or to None for a scalar.
    `levels[k]` has the lines inside k loops. `given` are the tables of numbers whose arrays are arguments.
    """

    axes: int
    inputs: Mapping[str, int | None]
    levels: tuple[tuple[Line, ...], ...]
    outputs: tuple[str, ...]
    types: Mapping[str, str]
    notes: Mapping[str, Note]
    tables: tuple["AxisTable", ...] = ()
    close: "StableBranch | None" = None
    given: tuple[str, ...] = ()


class StableBranch(NamedTuple):
    """The stable lines, which the innermost loop runs at points that fail the test.

    `outputs` are the names that hold the kernel's outputs there. The test is a line of the innermost
    loop, which has `test_lines`, or of an outer one, which has none. Points at which `undecided` holds are
    counted: what the kernel says of them hangs on rounding.
    """

    test: str
    lines: tuple[Line, ...]
    outputs: tuple[str, ...]
    test_lines: tuple[Line, ...]
    undecided: str | None = None


class AxisTable(NamedTuple):
    """Values over some of the axes of a kernel, computed before its loops by loops of their own."""

    along: tuple[int, ...]
    kernel: Kernel


def hoist(program: Program, axis_of: Mapping[str, int | None], axes: int) -> Kernel:
    """The kernel that runs the program over the axes its inputs vary along.

    Precondition: `axis_of` names every input. Postcondition: each line stands in the loop of the
    innermost axis that it depends on; the order of lines is kept inside a level.
    """
    return _placed(with_short_temporaries(program), axis_of, axes)


def _placed(program: Program, axis_of: Mapping[str, int | None], axes: int) -> Kernel:
    depth = {name: -1 if axis is None else axis for name, axis in axis_of.items()}
    levels: list[list[Line]] = [[] for _ in range(axes + 1)]
    for line in program.lines:
        depth[line.name] = max((depth[name] for name in names_in(line.args)), default=-1)
        levels[depth[line.name] + 1].append(line)
    inputs = {name: axis_of[name] for name in program.inputs}
    types = {line.name: line.type for line in program.lines}
    return Kernel(axes, inputs, tuple(map(tuple, levels)), program.outputs, types, program.notes)


READ = 2.0  # what reading a value from a table costs, in additions


def tabulate(program: Program, axis_of: Mapping[str, int | None], axes: int) -> Kernel:
    """The kernel of `hoist`, with tables for what lacks an outer axis, where that pays.

    Precondition and postcondition as for `hoist`; no value changes by a bit.
    """
    program = with_short_temporaries(program)
    main, tables = program, []
    along_of = {name: frozenset() if axis is None else frozenset([axis]) for name, axis in axis_of.items()}
    # The widest first: what only a table needs is computed with it.
    for along in sorted(set(_axes_needed(program, along_of).values()), key=lambda a: (-len(a), sorted(a))):
        names = _worth_a_table(main, _axes_needed(main, along_of), along)
        if not names:
            continue
        order = tuple(sorted(along))
        own = keep_outputs(program, names)
        places = {axis: place for place, axis in enumerate(order)}
        inside = {name: None if (on := axis_of[name]) is None else places[on] for name in own.inputs}
        tables.append(AxisTable(order, _placed(own, inside, len(order))))
        along_of.update(dict.fromkeys(names, along))
        lines = tuple(line for line in main.lines if line.name not in names)
        main = drop_unused(main._replace(inputs=(*main.inputs, *names), lines=lines))
    deepest = {name: max(along, default=None) for name, along in along_of.items()}
    kernel = _placed(main, deepest, axes)
    inputs = {name: axis for name, axis in axis_of.items() if name in program.inputs}
    return kernel._replace(inputs=inputs, tables=tuple(tables))


def _axes_needed(program: Program, along_of: Mapping[str, frozenset[int]]) -> dict[str, frozenset[int]]:
    """The axes that each name varies along."""
    needs = dict(along_of)
    for line in program.lines:
        if line.name not in along_of:
            needs[line.name] = frozenset().union(*(needs[name] for name in names_in(line.args)))
    return needs


def _lacks_an_outer_axis(need: frozenset[int]) -> bool:
    return bool(need) and len(need) <= max(need)


def _worth_a_table(
    program: Program, needs: Mapping[str, frozenset[int]], along: frozenset[int]
) -> tuple[str, ...]:
    """Values along exactly these axes that are worth a table: reading costs less than recomputing."""
    if not _lacks_an_outer_axis(along):
        return ()
    ours = {line.name: line for line in program.lines if needs[line.name] == along and line.type == "f64"}
    used = {name for line in program.lines if line.name not in ours for name in names_in(line.args)}
    names = tuple(name for name in ours if name in used or name in program.outputs)
    behind = reached(program._replace(outputs=names))
    lines = (line for line in program.lines if line.name in behind and needs[line.name] == along)
    cost = sum(OPERATIONS[line.op].cost for line in lines)
    return names if cost > READ * len(names) else ()
