"""A straight program in two stages, each a loop of its own over a block of points.

A point is one long chain: the angle's polynomials, then roots and divisions that wait for each other. A
processor that looks some hundred operations ahead sees hardly more than one point of the stable form, or with
narrow vectors of the plain one, and waits. In two loops it sees several, and its units have work.
"""

from typing import NamedTuple

from .program import Program, names_in, reaching

TURNS = frozenset(("rotated_sin", "rotated_cos"))  # what the sines and cosines of angles end in
CHEAP = frozenset(("abs", "neg"))  # computed again rather than kept


class Stages(NamedTuple):
    """The program of what depends on angles alone, whose outputs the second stage reads; the second stage."""

    first: Program
    second: Program


def staged(program: Program) -> Stages | None:
    """The stages of a program; None if it has no sine and cosine written out.

    Precondition: what the program reads and does not assign are values of the point or of outer loops.
    Postcondition: the stages together compute each output by the same lines; a condition, and what is cheap,
    may stand in both.
    """
    needs = _needs(program)
    angles = frozenset().union(*(needs[line.name] for line in program.lines if line.op in TURNS))
    if not angles:
        return None
    alone = {
        line.name
        for line in program.lines
        if needs[line.name] <= angles and line.type == "f64" and line.op not in CHEAP
    }
    wanted, kept, second = set(program.outputs), set(), []
    for line in reversed(program.lines):
        if line.name in wanted and line.name in alone:
            kept.add(line.name)
        elif line.name in wanted:
            second.append(line)
            wanted.update(names_in(line.args))
    outputs = tuple(line.name for line in program.lines if line.name in kept)
    return Stages(
        program._replace(lines=reaching(program.lines, kept), outputs=outputs),
        program._replace(lines=tuple(reversed(second))),
    )


def _needs(program: Program) -> dict[str, frozenset[str]]:
    """Map each line to the values from outside the program that it depends on."""
    needs: dict[str, frozenset[str]] = {}
    for line in program.lines:
        parts = (needs.get(name, frozenset([name])) for name in names_in(line.args))
        needs[line.name] = frozenset().union(*parts)
    return needs
