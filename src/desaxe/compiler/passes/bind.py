"""Fix inputs or conditions to constants, or replace lines by others."""

from collections.abc import Mapping

from ..program import Program, names_in, renamed
from .slicing import drop_unused


def bind_constants(program: Program, constants: Mapping[str, float]) -> Program:
    """The program with some inputs fixed.

    Effect: every use of the input becomes the constant, and the input is gone. `fold` then
    computes what has become constant.
    """
    lines = [
        line._replace(args=tuple(float(constants[a]) if a in fixed else a for a in line.args))
        if (fixed := constants.keys() & names_in(line.args))
        else line
        for line in program.lines
    ]
    inputs = tuple(name for name in program.inputs if name not in constants)
    return program._replace(inputs=inputs, lines=tuple(lines))


def overlay(program: Program, other: Program) -> Program:
    """Replace lines and inputs of a program by the lines of `other` with the same names.

    Precondition: `other` needs nothing that the program computes. Effect: its lines come first;
    its inputs join the program's; an input of `other` that the program computes is no longer
    computed. What becomes unused is dropped.
    """
    # Temporaries of one program must not meet those of the other.
    kept = set(other.notes) | set(other.outputs)
    fresh = renamed(other, {line.name: f"_{line.name}" for line in other.lines if line.name not in kept})
    replaced = {line.name for line in fresh.lines} | set(other.inputs)
    lines = fresh.lines + tuple(line for line in program.lines if line.name not in replaced)
    inputs = tuple(name for name in program.inputs if name not in replaced - set(other.inputs))
    inputs += tuple(name for name in other.inputs if name not in inputs)
    notes = {**program.notes, **other.notes}
    return drop_unused(program._replace(inputs=inputs, lines=lines, notes=notes))


def assume(program: Program, facts: Mapping[str, bool]) -> Program:
    """Replace conditions by known truth values; their selects reduce to the branch taken.

    A temporary that is the side taken of a named line gets its name. An output that is such a condition
    stays as it is.
    """
    facts = {name: known for name, known in facts.items() if name not in program.outputs}
    taken: dict[str, str] = {}  # named line -> the temporary that holds its value
    lines = []
    for line in program.lines:
        if line.op != "select" or line.args[0] not in facts:
            lines.append(line)
            continue
        side = line.args[1 if facts[str(line.args[0])] else 2]
        if isinstance(side, str) and _is_temporary(side, program) and side not in taken.values():
            taken[line.name] = side
        else:
            lines.append(line._replace(op="copy", args=(side,)))
    named = renamed(program._replace(lines=tuple(lines)), {side: name for name, side in taken.items()})
    return drop_unused(named)


def _is_temporary(name: str, program: Program) -> bool:
    return name not in program.notes and name not in program.outputs and name not in program.inputs
