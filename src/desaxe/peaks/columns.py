"""The parts of a search under loads: designs with nodes of their own, and the tables of the loads.

They take the place of those of `search` where a load is over the slider's place: each design then has nodes
where the slider meets the ends of pieces, and all of its nodes, ascending, are a column.

tables  parts one after the other, behind the places at which each begins and the last ends: first how many
        nodes of its own a design has, and arcs of each load that jumps; then knots and coefficients of each
        load. What differs from design to design stands in rows behind its inputs: of each load that jumps
        where its arcs begin, and by how much the number of the piece changes there; then the nodes
"""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

from numpy import empty, int64

if TYPE_CHECKING:
    from typing import Any


def part_of(tables: Any, number: int) -> Any:
    """A part of the tables."""
    return tables[int64(tables[number]) : int64(tables[number + 1])]


def own_nodes(tables: Any) -> Any:
    """The number of nodes that each design has of its own."""
    return int64(part_of(tables, 0)[0])


def nodes_of(count: Any, shared: Any, block: Any, tables: Any) -> Any:
    """The nodes of designs, a column each: those of their group and their own, ascending."""
    more = own_nodes(tables)
    first, size = block.shape[0] - more, shared.size
    found, own = empty((size + more, count)), empty(more + 1)
    for i in range(count):
        for k in range(more):
            new, place = block[first + k, i], k
            while place > 0 and own[place - 1] > new:
                own[place] = own[place - 1]
                place -= 1
            own[place] = new
        own[more] = inf
        k, j = 0, 0
        for place in range(size + more):
            if j < size and shared[j] <= own[k]:
                found[place, i] = shared[j]
                j += 1
            else:
                found[place, i] = own[k]
                k += 1
    return found


def one(here: Any, i: Any) -> Any:
    """The node of a design, of a row of nodes."""
    return here[i]
