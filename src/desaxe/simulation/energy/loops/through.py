"""Derivatives of time and energy through whole panels, and through many turns at once, in plain loops.

On a whole panel dt/du L of a parameter (see `varied`) is a M_p/M - b (e + what e has grown by there), with
a = dt/du / 2 and b = a/E, the same for all parameters. Over turns that pass by whole, a and b of a node are
summed first; e grows by the same in each turn.

work    a row per parameter: the integral of Q_p up to each node; by how much e grows through the panel; from
        17 on M_p/M and from 33 on by how much e has grown at each node, in the way of the motion. In a last
        row the same of E, and M in place of the ratio
state   a row per parameter: tau, e, and the shift of a standstill
lanes   a row per parameter: what is still to be added up to tau
"""

from __future__ import annotations

from math import sqrt
from typing import TYPE_CHECKING

from .pieces import combined, tail
from .turns import in_block, node_of

if TYPE_CHECKING:
    from typing import Any

    from ....compiler.llvm.loops import apart


def total_of(values: Any, weights: Any) -> float:
    """The integral of values at the nodes from -1 to 1."""
    a, b, c, d = 0.0, 0.0, 0.0, 0.0
    for k in range(4):
        a += weights[k] * values[k]
        b += weights[k + 4] * values[k + 4]
        c += weights[k + 8] * values[k + 8]
        d += weights[k + 12] * values[k + 12]
    return (a + b) + (c + d)


def grown(push: Any, half: float, way: float, tables: Any, own: Any) -> None:
    """Fill in how an energy grows through a panel, from its torque."""
    combined(push, tables[3], own)
    total = total_of(push, tables[1])
    own[16] = way * half * total
    for k in range(16):
        own[33 + k] = half * own[k] if way > 0.0 else half * (own[15 - k] - total)


def prepare_panel(
    fields: Any, by: Any, M: Any, Q: Any, start: Any, half: float, way: float, scale: Any, tolerance: float,
    tables: Any, work: Any,
) -> bool:  # fmt: skip
    """Fill in what a motion through a whole panel needs; whether M_p and Q_p are resolved on it."""
    fine, count, side = True, len(by), 1 if way > 0.0 else 2
    grown(Q, half, way, tables, work[count])
    for k in range(16):
        work[count, 17 + k] = M[k if way > 0.0 else 15 - k]
    for p in range(count):
        own = work[p]
        inertia, push = fields[by[p, 0], start : start + 16], fields[by[p, side], start : start + 16]
        if scale[p, 1] != 0.0:
            grown(push, half, way, tables, own)
            fine = fine and tail(push, tables[2]) <= tolerance * scale[p, 1]
        else:
            for k in range(49):
                own[k] = 0.0
        if scale[p, 0] != 0.0:
            fine = fine and tail(inertia, tables[2]) <= tolerance * scale[p, 0]
            for k in range(16):
                own[17 + k] = inertia[k if way > 0.0 else 15 - k] / work[count, 17 + k]
        else:
            for k in range(16):
                own[17 + k] = 0.0
    return fine


def factors(rate: Any, M: Any, half: float, weights: Any, rows: Any) -> None:
    """The factors a and b on a panel from dt/du and M, in rows 0 and 1, and with weights in 2 and 3."""
    apart()
    for k in range(len(rate)):
        rows[0, k], rows[1, k] = 0.5 * rate[k], rate[k] * rate[k] * rate[k] / (half * half * M[k])
        rows[2, k], rows[3, k] = weights[k] * rows[0, k], weights[k] * rows[1, k]


def add_factors(
    half: float, energy: float, turn: float, weights: Any, M: Any, growth: Any, a: Any, b: Any, later: Any
) -> None:
    """Add the factors of a panel in a turn, and the second times the number of turns before."""
    apart()
    for k in range(len(M)):
        slow = 1.0 / (energy + growth[k])
        own = 0.5 * half * weights[k] * sqrt(0.5 * M[k] * slow)
        a[k] += own
        b[k] += own * slow
        later[k] += turn * own * slow


def add_lanes_of(a: Any, b: Any, ratio: Any, growth: Any, e: float, lanes: Any) -> None:
    """Add what a whole panel adds to tau, for each node by itself."""
    apart()
    for k in range(len(lanes)):
        lanes[k] += a[k] * ratio[k] - b[k] * (growth[k] + e)


def through(work: Any, a: Any, b: Any, state: Any, lanes: Any) -> None:
    """Go through a whole panel with all parameters."""
    for p in range(len(state)):
        add_lanes_of(a, b, work[p, 17:33], work[p, 33:49], state[p, 1], lanes[p])
        state[p, 1] += work[p, 16]


def settle(state: Any, lanes: Any) -> None:
    """Add up tau."""
    for p in range(len(state)):
        a, b = 0.0, 0.0
        for k in range(8):
            a, b = a + lanes[p, k], b + lanes[p, k + 8]
            lanes[p, k], lanes[p, k + 8] = 0.0, 0.0
        state[p, 0] += a + b


def add_turn(
    share: float, energy: float, turn: float, way: float, edges: Any, work: Any, weights: Any, sums: Any
) -> None:
    """Add the factors of a turn that stands for several, after some others."""
    panels, count = len(edges) - 1, work.shape[1] - 1
    for i in range(panels):
        panel = i if way > 0.0 else panels - 1 - i
        half, own, to = 0.5 * (edges[panel + 1] - edges[panel]), work[panel, count], sums[panel]
        if half > 0.0:
            add_factors(half * share, energy, turn, weights, own[17:33], own[33:49], to[0], to[1], to[2])
            energy += own[16]


def through_turns(
    passed: Any, way: float, edges: Any, work: Any, jumps: Any, tables: Any, sums: Any, entry: Any,
    state: Any, lanes: Any,
) -> None:  # fmt: skip
    """Go through whole turns with all parameters, each of which begins with some e.

    passed   their number, the energy before, its gain in a turn, how much lower it is within one
    jumps    of e before each panel
    """
    turns, energy, gain, deepest = passed[0], passed[1], passed[2], passed[3]
    count, panels = len(state), len(edges) - 1
    sums[:, :, :] = 0.0
    done = 0.0
    while done < turns:
        start, size = energy + done * gain, in_block(turns - done, energy + done * gain + deepest, gain)
        for j in range(1 if size == 1.0 else tables[5].shape[1]):
            place, share = (0.0, 1.0) if size == 1.0 else node_of(tables[5], j, size)
            add_turn(share, start + place * gain, done + place, way, edges, work, tables[1], sums)
        done += size
    for p in range(count):
        entry[p] = state[p, 1]
    later = 0.0
    for i in range(panels):
        panel = i if way > 0.0 else panels - 1 - i
        for p in range(count):
            state[p, 1] += way * jumps[p, panel if way > 0.0 else (panel + 1) % panels]
        if edges[panel + 1] > edges[panel]:
            through(work[panel], sums[panel, 0], sums[panel, 1], state, lanes)
        for k in range(16):
            later += sums[panel, 2, k]
    for p in range(count):
        more = state[p, 1] - entry[p]
        state[p, 0] -= more * later
        state[p, 1] = entry[p] + turns * more
