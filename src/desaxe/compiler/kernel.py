"""The Kernel: a loop nest whose bodies are straight lines of a Program.

`hoist` places every line in the outermost loop that has all it depends on: what depends on no axis
runs once, before the loops. Only a Kernel is turned into numba.
"""

from collections.abc import Mapping
from typing import NamedTuple

from .program import Line, Note, Program, names_in
from .text import with_short_temporaries


class Kernel(NamedTuple):
    """A loop nest over `axes` loops.

    `inputs` maps an input to its axis (0 is the outermost loop), or to None for a scalar.
    `levels[k]` has the lines inside k loops.
    """

    axes: int
    inputs: Mapping[str, int | None]
    levels: tuple[tuple[Line, ...], ...]
    outputs: tuple[str, ...]
    types: Mapping[str, str]
    notes: Mapping[str, Note]


def hoist(program: Program, axis_of: Mapping[str, int | None], axes: int) -> Kernel:
    """The kernel that runs the program over the axes its inputs vary along.

    Precondition: `axis_of` names every input. Postcondition: each line stands in the loop of the
    innermost axis that it depends on; the order of lines is kept inside a level.
    """
    program = with_short_temporaries(program)
    depth = {name: -1 if axis is None else axis for name, axis in axis_of.items()}
    levels: list[list[Line]] = [[] for _ in range(axes + 1)]
    for line in program.lines:
        depth[line.name] = max((depth[name] for name in names_in(line.args)), default=-1)
        levels[depth[line.name] + 1].append(line)
    inputs = {name: axis_of[name] for name in program.inputs}
    types = {line.name: line.type for line in program.lines}
    return Kernel(axes, inputs, tuple(map(tuple, levels)), program.outputs, types, program.notes)


def level_program(kernel: Kernel, level: int) -> Program:
    """One level as a program of its own: its outputs are what deeper levels and the result need."""
    own = {line.name for line in kernel.levels[level]}
    deeper = {name for lines in kernel.levels[level + 1 :] for line in lines for name in names_in(line.args)}
    needed = [line.name for line in kernel.levels[level] if line.name in deeper]
    outputs = tuple(needed + [name for name in kernel.outputs if name in own and name not in deeper])
    return Program((), kernel.levels[level], outputs, kernel.notes)
