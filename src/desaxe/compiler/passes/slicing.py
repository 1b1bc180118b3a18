"""Slicing: keep only the lines that the requested outputs need."""

from collections.abc import Sequence

from ..program import Program, ProgramError, reached


def keep_outputs(program: Program, outputs: Sequence[str]) -> Program:
    """The program of these outputs alone, in this order.

    Precondition: every output is a name of the program. Effect: lines and inputs that no wanted
    output depends on are gone; the others, and their order, stay.
    """
    known = {line.name for line in program.lines} | set(program.inputs)
    for name in outputs:
        if name not in known:
            raise ProgramError(f"no line {name!r} to keep")
    return drop_unused(program._replace(outputs=tuple(outputs)))


def drop_unused(program: Program) -> Program:
    """The program without the lines and inputs that its outputs do not reach."""
    requested = reached(program)
    lines = tuple(line for line in program.lines if line.name in requested)
    notes = {name: note for name, note in program.notes.items() if name in requested}
    inputs = tuple(name for name in program.inputs if name in requested)
    return program._replace(inputs=inputs, lines=lines, notes=notes)
