"""Compute what depends on a sign for both signs, so that it leaves the loop over the angle.

`side` is -1 or 1, by the sign of sin(theta). The margin towards it depends on the crank angle through
nothing else: over a grid, both margins of a design are computed once, and the angle picks one.
"""

from collections.abc import Collection

from ..operations import OPERATIONS
from ..program import Argument, Line, Program, names_in, reached
from .fold import fold_constants
from .slicing import drop_unused

SIGN = "side"
LEAST = 6.0  # what a value must cost to be computed twice and chosen, in additions


def both_ways(program: Program, outside: Collection[str]) -> Program:
    """The program in which what needs `side` and inputs of `outside` alone is computed for both signs.

    Precondition: `side` is a select of two constants. Effect: such lines come twice, under the names
    of the signs, and a select picks; no value changes by a bit.
    """
    line = next((line for line in program.lines if line.name == SIGN and line.op == "select"), None)
    if line is None:
        return program
    condition, low, high = line.args
    ours = _worthy(program, _two_valued(program, set(outside)))
    if not ours or isinstance(low, str) or isinstance(high, str):
        return program
    lines: list[Line] = []
    used = _used_by_others(program, ours)
    for each in program.lines:
        if each.name not in ours:
            lines.append(each)
            continue
        lines += [_way(each, ours, "minus", low), _way(each, ours, "plus", high)]
        if each.name in used:
            picked = (condition, f"{each.name}_minus", f"{each.name}_plus")
            lines.append(Line(each.name, "select", picked, each.type))
    return fold_constants(drop_unused(program._replace(lines=tuple(lines))))


def _two_valued(program: Program, outside: set[str]) -> set[str]:
    """The lines that need `side`, some input of `outside`, and nothing else that varies."""
    needs: dict[str, frozenset[str]] = {name: frozenset([name]) for name in program.inputs}
    for line in program.lines:
        own = frozenset([SIGN]) if line.name == SIGN else frozenset()
        needs[line.name] = own or frozenset().union(*(needs[name] for name in names_in(line.args)))
    return {
        line.name
        for line in program.lines
        if SIGN in needs[line.name] and frozenset([SIGN]) < needs[line.name] <= outside | {SIGN}
    }


def _worthy(program: Program, ours: set[str]) -> set[str]:
    """Those that a value needs which costs more than choosing between two."""
    lines = {line.name: line for line in program.lines if line.name in ours}
    found: set[str] = set()
    for name in _used_by_others(program, ours):
        cone = reached(Program((), tuple(lines.values()), (name,), {})) & ours
        if sum(OPERATIONS[lines[each].op].cost for each in cone) > LEAST:
            found |= cone
    return found


def _used_by_others(program: Program, ours: set[str]) -> set[str]:
    others = {name for line in program.lines if line.name not in ours for name in names_in(line.args)}
    return ours & (others | set(program.outputs))


def _way(line: Line, ours: set[str], way: str, sign: Argument) -> Line:
    """The line for one sign."""

    def renamed(argument: Argument) -> Argument:
        if argument == SIGN:
            return sign
        return f"{argument}_{way}" if argument in ours else argument

    return line._replace(name=f"{line.name}_{way}", args=tuple(map(renamed, line.args)))
