"""A panel of the crank angle: its end, the error inside of it, and the width of the next one.

Gauss nodes make the end of a panel far more exact than its inside, by which its width is chosen.

memory   the width of the next panel [rad], steps in time to wait before it is tried, how far the step in time
         before went [rad], the width of this panel with its sign
"""

from __future__ import annotations

from math import copysign, inf, sqrt
from typing import TYPE_CHECKING

from numpy import int64

from .picard import (
    LAST,
    LOAD,
    MOBILITY,
    NODES,
    NOW,
    PACE,
    RATE,
    SHARE,
    SLOWNESS,
    TORQUE,
    ask,
    course,
    furnish,
    guess,
    still_at_nodes,
    sweep,
)
from .state import DIRECTION, torque

if TYPE_CHECKING:
    from typing import Any


TRIALS = int64(8)
FAR = 1e5  # rad: beyond, an angle has lost digits that the tolerance asks for
WIDEST, LEAST = 2.5, 0.02  # rad
INSIDE = 3.0  # of rtol: the error inside of a panel
WAIT = 8.0  # steps in time after a panel that failed
AIM = 0.3  # of the largest error
TOO_WIDE = 1.2  # times the largest error, with a torque that is not quite right yet


def sums(table: Any, room: Any) -> Any:
    """Over the whole of a panel, for each radian of it: gain of energy, work, time."""
    gain, work, time = 0.0, 0.0, 0.0
    for i in range(NODES):
        share = table[i, SHARE]
        gain += share * room[RATE, i]
        work += share * (room[TORQUE, i] + room[LOAD, i])
        time += share * room[PACE, i]
    return gain, work, time


def error_inside(width: float, least: float, table: Any, room: Any) -> float:
    """The error inside of a panel: of the speed, relative, or of the angle [rad]."""
    a, b, c, d, quickest = 0.0, 0.0, 0.0, 0.0, inf
    for i in range(NODES):
        first, last, rate, pace = table[i, LAST], table[i, LAST + 1], room[RATE, i], room[PACE, i]
        a += first * rate
        b += last * rate
        c += first * pace
        d += last * pace
        quickest = min(quickest, room[SLOWNESS, i])
    return abs(width) * max(0.5 * (abs(a) + abs(b)) / least, (abs(c) + abs(d)) / quickest)


def jumps(outside: float, room: Any, at: Any, way: Any) -> bool:
    """True where the torque jumps between an end of a panel and the node next to it, which no node sees."""
    a, b, c = room[NOW, at], room[NOW, at + way], room[NOW, at + 2 * way]
    return bool(abs(outside - a) > 2.0 * (abs(a - b) + abs(b - c)) + 1e-6 * abs(a))


def panel(
    t: float,
    y: Any,
    width: float,
    law: Any,
    data: Any,
    rtol: float,
    too_wide: float,
    table: Any,
    room: Any,
    new: Any,
) -> Any:
    """The state and the time at the end of a panel, the error inside of it as a multiple of rtol.

    The time stays as it is where there is none, and where the error with the first torques is too wide.
    """
    energy = 0.5 * y[1] * y[1]
    furnish(energy == 0.0, table, room)
    still_at_nodes(y[0], width, law, data, room)
    begin = copysign(sqrt(2.0 * energy * room[MOBILITY, 0]), width)
    first = torque(t, y[0], begin, 0.0, law)
    guess(t, energy, first, width, room)
    ask(law, room)
    least = course(t, energy, width, table, room)
    if not least > 0.0:
        return t, inf
    error = error_inside(width, least, table, room) / (INSIDE * rtol)
    if not error < too_wide:  # the torque will not mend that
        return t, error
    least = sweep(t, energy, least, width, law, rtol, table, room)
    if not least > 0.0:
        return t, inf
    gain, work, time = sums(table, room)
    after = energy + width * gain
    if not after > 0.0:
        return t, inf
    new[0] = y[0] + width
    new[1] = copysign(sqrt(2.0 * after), width)
    new[2] = y[2] + width * work
    end = t + abs(width) * time
    omega = copysign(1.0 / room[SLOWNESS, 15], width)
    last = torque(end, new[0], omega, 0.0, law)
    if jumps(first, room, 0, 1) or jumps(last, room, 15, -1):
        return end, inf
    return end, error_inside(width, least, table, room) / (INSIDE * rtol)


def by_panel(
    t: float,
    y: Any,
    gap: float,
    law: Any,
    data: Any,
    how: Any,
    table: Any,
    room: Any,
    memory: Any,
    new: Any,
) -> float:
    """The end of the next panel, which goes no farther than a gap; -1 where steps in time go on."""
    if memory[1] > 0.0 or abs(y[0]) > FAR:
        memory[0], memory[1] = max(0.5, 3.0 * memory[2]), memory[1] - 1.0
        return -1.0
    width, way = memory[0], law[DIRECTION]
    for _ in range(TRIALS):
        if width < max(LEAST, 1.5 * memory[2]):
            break
        memory[3] = copysign(min(width, gap), way)
        end, error = panel(t, y, memory[3], law, data, how[0], TOO_WIDE, table, room, new)
        factor = min(2.0, max(0.25, (AIM / error) ** 0.0625)) if error > 0.0 else 2.0
        if error <= 1.0:
            memory[0] = min(width * factor, WIDEST) if width < gap else width
            return float(end)
        width = min(width, gap) * min(factor, 0.8)
    memory[1] = WAIT
    return -1.0
