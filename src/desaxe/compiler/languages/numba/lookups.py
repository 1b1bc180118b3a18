"""A loop that looks tables up: three loops over a block of points.

A search in a loop keeps LLVM from making vectors of all the rest. So the first loop computes what the tables
are looked up at, the second looks up, and the third computes what hangs on that. What the third needs of the
first is kept in rooms, on the stack.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from ...kernel import Kernel
from ...program import Line, Program, names_in, reaching
from ...stages import CHEAP
from ...text import INDENT, write_lines

BLOCK = 128  # points: their rooms stay in the first-level cache
APART = 72  # numbers between rooms: at a multiple of 4096 bytes a store holds up loads from other rooms
VALUES = {"lookup": "look_up", "lookup_slope": "look_up_slope"}


class Parted(NamedTuple):
    """The innermost lines: those before all searches, the searches and what they find, those after."""

    first: Program
    kept: tuple[str, ...]
    searches: tuple[Line, ...]
    found: tuple[Line, ...]
    second: Program

    @property
    def places(self) -> list[str]:
        """The names of what is looked up: lines of the loop, or what the loop reads."""
        return [name for line in self.searches for name in names_in(line.args)]

    @property
    def rooms(self) -> list[str]:
        """The names of the rooms, which keep a value of each point of a block."""
        places = (f"{line.name}_{end}" for line in self.searches for end in ("at", "way"))
        own = (line.name for line in (*self.searches, *self.found))
        return [*self.kept, *places, *own]


def looks_up(kernel: Kernel) -> bool:
    """True if given tables are looked up in the innermost loop of one form."""
    searched = any(line.op == "lookup_piece" for line in kernel.levels[-1])
    return searched and bool(kernel.given) and kernel.close is None


def parted(program: Program) -> Parted:
    """The lines of a loop in three parts; conditions, and what is cheap, may stand in both."""
    searches = tuple(line for line in program.lines if line.op == "lookup_piece")
    pieces = {line.name for line in searches}
    found = tuple(line for line in program.lines if line.op in VALUES and line.args[2] in pieces)
    given = {line.name for line in found}
    own = {line.name for line in program.lines}
    places = {name for line in searches for name in names_in(line.args)} & own
    ahead = {line.name for line in reaching(program.lines, places)}
    wanted, kept, second = set(program.outputs), set[str](), list[Line]()
    for line in reversed(program.lines):
        if line.name not in wanted or line.name in given:
            continue
        if line.name in ahead and line.type == "f64" and line.op not in CHEAP:
            kept.add(line.name)
        else:
            second.append(line)
            wanted.update(names_in(line.args))
    outputs = tuple(line.name for line in program.lines if line.name in kept | places)
    first = program._replace(lines=reaching(program.lines, outputs), outputs=outputs)
    keep = tuple(name for name in outputs if name in kept)
    return Parted(first, keep, searches, found, program._replace(lines=tuple(reversed(second))))


def rooms(parts: Parted) -> list[str]:
    """Allocate the rooms of a block."""
    return [f"{name}_room = room({BLOCK + APART})" for name in parts.rooms]


def three_loops(
    parts: Parted, here: str, length: str, reads: Mapping[str, str], stores: Sequence[str]
) -> list[str]:
    """The text of a loop over `length` points.

    here    its index
    reads   what each point reads
    """
    place = f"{here} - start"
    points = f"for {here} in range(start, stop):"
    read = [f"{name} = {text}" for name, text in reads.items()]
    first, second = (write_lines(program, "numba") for program in (parts.first, parts.second))
    keep = [f"put({name}_room, {place}, {name})" for name in parts.kept]
    for line in parts.searches:
        x, _, way = line.args
        keep += [f"put({line.name}_at_room, {place}, {x})", f"put({line.name}_way_room, {place}, {way})"]
    again = [f"{n} = get({n}_room, {place})" for n in (*parts.kept, *(f.name for f in parts.found))]
    return [
        f"length = {length}",
        f"for start in range(uint64(0), length, uint64({BLOCK})):",
        f"{INDENT}stop = min(start + uint64({BLOCK}), length)",
        *_under(points, [*_used(read, parts.first, parts.places), *first, *keep]),
        *(INDENT + row for row in _searched(parts)),
        *_under(points, [*_used([*read, *again], parts.second), *second, *stores]),
    ]


def _searched(parts: Parted) -> list[str]:
    """Look up: the pieces first, which values and slopes share."""
    rows = []
    for line in parts.searches:
        places = f"{line.name}_at_room, {line.name}_way_room"
        rows.append(f"find_pieces(stop - start, {places}, {line.args[1]}_x, {line.name}_room)")
    at = {line.name: f"{line.name}_at_room, {line.name}_room" for line in parts.searches}
    for line in parts.found:
        table, where = str(line.args[1]), at[str(line.args[2])]
        rows.append(f"{VALUES[line.op]}(stop - start, {where}, {table}_x, {table}_c, {line.name}_room)")
    return rows


def _used(reads: Sequence[str], program: Program, more: Sequence[str] = ()) -> list[str]:
    """The reads that a program needs, and those of some names."""
    used = {name for line in program.lines for name in names_in(line.args)}.union(program.outputs, more)
    return [read for read in reads if read.partition(" ")[0] in used]


def _under(head: str, body: Sequence[str]) -> list[str]:
    return [INDENT + head, *(INDENT * 2 + row for row in body)]
