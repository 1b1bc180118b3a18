"""The parts of a search under loads: designs with nodes of their own, and the tables of the loads.

They take the place of those of `search` where a load is over the slider's place: each design then has nodes
where the slider meets the ends of pieces, and all of its nodes, ascending, are a column.

tables  parts one after the other, behind the places at which each begins and the last ends: first how many
        nodes of its own a design has, and arcs of each load that jumps; then knots and coefficients of each
        load. What differs from design to design stands in rows behind its inputs: of each load that jumps
        where its arcs begin, and by how much the number of the piece changes there; then the nodes
"""

from __future__ import annotations

from math import inf, nan
from typing import TYPE_CHECKING

from numpy import empty, int64, uint64

if TYPE_CHECKING:
    from typing import Any

    def score(kind: int, value: float) -> float:
        """The objective: |value|, value or -value, to be maximised."""

    def highest(
        kind: int, width: float, per_width: float, value_a: float, value_b: float, a: float, b: float
    ) -> float:
        """At most how good an extremum between two nodes can be; NaN where none can be."""

    def inverse(width: float) -> float:
        """1 / width; 0 where nodes coincide."""


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


def node(nodes: Any, j: Any, i: Any) -> Any:
    """A node of a design."""
    return nodes[j, i]


def bound(
    kind: int, count: Any, nodes: Any, value: Any, slope: Any, best: Any, theta: Any, upper: Any
) -> None:
    """The best node of each design, and the bounds between nodes: NaN where no extremum is."""
    for i in range(uint64(count)):
        best[i], theta[i] = -inf, nan
    for j in range(nodes.shape[0]):
        here, row = nodes[j], value[j]
        for i in range(uint64(count)):
            new, place, before = score(kind, row[i]), here[i], theta[i]
            better = new > best[i]
            best[i] = new if better else best[i]
            theta[i] = place if better else before
    for j in range(1, nodes.shape[0]):
        left, right, row = nodes[j - 1], nodes[j], upper[j]
        value_a, value_b, slope_a, slope_b = value[j - 1], value[j], slope[j - 1], slope[j]
        for i in range(uint64(count)):
            width = right[i] - left[i]
            top = highest(kind, width, inverse(width), value_a[i], value_b[i], slope_a[i], slope_b[i])
            row[i] = top if width > 0.0 else nan
