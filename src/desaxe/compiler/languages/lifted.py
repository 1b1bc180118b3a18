"""Sines and cosines of arguments as arguments of their own: an array has them computed ahead, in a loop."""

from collections.abc import Collection
from typing import NamedTuple

from ..passes.slicing import drop_unused
from ..program import Program, renamed


class Lifted(NamedTuple):
    """A Program without sines and cosines of its arguments; argument -> names of its sine and cosine."""

    program: Program
    turns: dict[str, tuple[str, str]]


def lifted(program: Program, angles: Collection[str] | None = None) -> Lifted:
    """The program with the sine and cosine of an argument, guarded or not, as arguments.

    A guarded argument is the argument or NaN; the sine of what is not finite is NaN anyway.
    """
    origin = {name: name for name in program.inputs if angles is None or name in angles}
    for line in program.lines:
        if line.op == "select" and line.args[1] in origin and repr(line.args[2]) == "nan":
            origin[line.name] = origin[str(line.args[1])]
    calls = {
        line.name: (angle, line.op)
        for line in program.lines
        if line.op in ("sin", "cos") and (angle := origin.get(str(line.args[0])))
    }
    turns = {angle: (f"sin_{angle}", f"cos_{angle}") for angle, _ in calls.values()}
    names = {name: turns[angle][op == "cos"] for name, (angle, op) in calls.items()}
    lines = tuple(line for line in program.lines if line.name not in calls)
    notes = {name: note for name, note in program.notes.items() if name not in calls}
    extra = tuple(name for pair in turns.values() for name in pair)
    bare = program._replace(inputs=program.inputs + extra, lines=lines, notes=notes)
    outputs = tuple(names.get(name, name) for name in program.outputs)
    return Lifted(drop_unused(renamed(bare, names)._replace(outputs=outputs)), turns)
