"""Whole turns without an instant, many of them at once, in plain loops.

In each turn the energy grows by the same, its gain; what a turn adds is a smooth function of the energy, so
of the number of the turn. Its sum over a block of turns comes from Gauss nodes among them.

blocks   these nodes; then the weights of their mean over a block of N turns, by powers of 1/N^2
"""

from __future__ import annotations

from math import floor, inf
from typing import TYPE_CHECKING

from numpy import int64

from .pieces import lowest, ordered, rates, tail

if TYPE_CHECKING:
    from typing import Any

FEWEST = 16.0  # turns of a block
GROWTH = 0.1  # of the lowest energy: so much it changes in a block at most
FASTER, SLOWER = 0.999, 0.94  # of the time left: what turns like the first of a block may take


def in_block(turns: float, least: float, gain: float) -> float:
    """The number of turns of the next block, 1 for one alone; least: the lowest energy in the first."""
    most = floor(GROWTH * least / abs(gain)) if abs(gain) * turns > GROWTH * least else turns
    return float(most) if most >= FEWEST else 1.0


def node_of(blocks: Any, j: Any, size: float) -> Any:
    """The place of a node among the turns of a block, and for how many turns it stands."""
    q = 1.0 / (size * size)
    mean = blocks[1, j] + q * (blocks[2, j] + q * (blocks[3, j] + q * blocks[4, j]))
    return 0.5 * size * (1.0 + blocks[0, j]) - 0.5, size * mean


def whole_turn(
    edges: Any, M: Any, work: Any, energy: float, way: float, noise: float, tolerance: float, tables: Any,
    rows: Any,
) -> Any:  # fmt: skip
    """The time of a turn in whole pieces, by the sums of `follow`, and its lowest energy; -1 if cut there.

    noise   the rounding of energies
    """
    panels, t, least = len(edges) - 1, 0.0, inf
    for i in range(panels):
        panel = i if way > 0.0 else panels - 1 - i
        half = 0.5 * (edges[panel + 1] - edges[panel])
        if half > 0.0:
            done, nodes = work[panel], 1 + 16 * panel
            left = energy - (0.0 if way > 0.0 else done[16])
            ordered(M[nodes : nodes + 16], done, left, way > 0.0, rows[1], rows[2])
            low = lowest(rows[2])
            duration = rates(int64(0), half, tables[1], rows[1], rows[2], rows[0])
            if not (low > 0.0 and tail(rows[0], tables[2]) <= max(tolerance, noise / low) * duration):
                return t, -1.0
            least, t = min(least, low), t + duration
            energy = left + (done[16] if way > 0.0 else 0.0)
    return t, least


def turns_before(
    until: float, edges: Any, M: Any, work: Any, energy: float, way: float, noise: float, tolerance: float,
    most: float, tables: Any, rows: Any,
) -> Any:  # fmt: skip
    """The turns that end before a time from now: their time, number and gain, and how many were looked at."""
    t, turns, gain, looked = 0.0, 0.0, 0.0, 0.0
    for panel in range(len(edges) - 1):
        gain += way * work[panel, 16] if edges[panel + 1] > edges[panel] else 0.0
    while looked + 9.0 <= most:
        start = energy + turns * gain
        time, least = whole_turn(edges, M, work, start, way, noise, tolerance, tables, rows)
        looked += 1.0
        if not (least > 0.0 and t + time < until):
            break
        size = in_block(floor((FASTER if gain >= 0.0 else SLOWER) * (until - t) / time), least, gain)
        if size > 1.0:
            time = 0.0
            for j in range(tables[5].shape[1]):
                place, share = node_of(tables[5], j, size)
                one, least = whole_turn(
                    edges, M, work, start + place * gain, way, noise, tolerance, tables, rows
                )
                looked += 1.0
                time += share * (one if least > 0.0 else inf)
            if not time < inf:
                break
        t, turns = t + time, turns + size
    return t, turns, gain, looked
