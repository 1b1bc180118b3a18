"""Value numbering: the same value gets the same name."""

from ..operations import OPERATIONS
from ..program import Argument, Line, Program
from .slicing import drop_unused


def value_numbering(program: Program) -> Program:
    """Merge lines that compute the same operation on the same values.

    Precondition: canonical form. Effect: equal values are computed once, where the first of them
    was, under the first name that is no temporary; an output of the same value is a copy of it.
    `a + b` equals `b + a`; nothing is reassociated, so no result changes by a bit.
    """
    leader = _leaders(program)
    groups: dict[str, list[str]] = {}
    for line in program.lines:
        groups.setdefault(leader[line.name], []).append(line.name)
    best = {first: _best_name(names, program) for first, names in groups.items()}
    lines: list[Line] = []
    for line in program.lines:
        first = leader[line.name]
        args = tuple(best[leader[a]] if a in leader else a for a in line.args)
        if line.name == first:
            lines.append(Line(best[first], line.op, args, line.type))
        elif line.name in program.outputs and line.name != best[first]:
            lines.append(line._replace(op="copy", args=(best[first],)))
    return drop_unused(program._replace(lines=tuple(lines)))


def _leaders(program: Program) -> dict[str, str]:
    """For each line the first line that holds the same value."""
    leader: dict[str, str] = {}
    seen: dict[tuple[str, tuple[str, ...]], str] = {}
    for line in program.lines:
        if line.op == "copy":  # of a line: its value; of a constant or an input: itself
            leader[line.name] = leader.get(str(line.args[0]), line.name)
            continue
        args = tuple(_key(a, leader) for a in line.args)
        if OPERATIONS[line.op].commutes:
            args = tuple(sorted(args))
        leader[line.name] = seen.setdefault((line.op, args), line.name)
    return leader


def _key(argument: Argument, leader: dict[str, str]) -> str:
    """A key that distinguishes values, also 1.0, 1 and True."""
    if isinstance(argument, str):
        return leader.get(argument, argument)
    return f"{type(argument).__name__}:{argument!r}"


def _best_name(names: list[str], program: Program) -> str:
    """The first name that is no temporary; the first name if all are."""
    return next((name for name in names if name in program.notes or name in program.outputs), names[0])
