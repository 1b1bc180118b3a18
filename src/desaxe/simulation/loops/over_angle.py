"""A panel of the crank angle: its end, the error inside of it, the width of the next one, and its histories.

The crank angle is a good variable where a crank turns fully without friction, and away from standstills.
Gauss nodes make the end of a panel far more exact than its inside, by which its width is chosen.

memory   the width of the next panel [rad], steps in time to wait before it is tried, how far the step in time
         before went [rad], the width of this panel with its sign
"""

from __future__ import annotations

from math import copysign, inf, sqrt
from typing import TYPE_CHECKING

from numpy import empty, int64

from .newton import RATE_Q
from .newton import ROWS as RATES
from .panels import motion
from .picard import (
    LAST,
    LOAD,
    MOBILITY,
    NODES,
    NOW,
    OF_ENERGY,
    OF_TIME,
    RATE,
    SERIES,
    SHARE,
    SLOWNESS,
    TORQUE,
    ask,
    course,
    guess,
    still_at_nodes,
    sweep,
)  # fmt: skip
from .state import DIRECTION, tell, torque

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
        time += share * room[SLOWNESS, i]
    return gain, work, time


def error_inside(width: float, least: float, table: Any, room: Any) -> float:
    """The error inside of a panel: of the speed, relative, or of the angle [rad]."""
    a, b, c, d, quickest = 0.0, 0.0, 0.0, 0.0, inf
    for i in range(NODES):
        first, last, rate, pace = table[i, LAST], table[i, LAST + 1], room[RATE, i], room[SLOWNESS, i]
        a += first * rate
        b += last * rate
        c += first * pace
        d += last * pace
        quickest = min(quickest, pace)
    return abs(width) * max(0.5 * (abs(a) + abs(b)) / least, (abs(c) + abs(d)) / quickest)


def jumps(outside: float, room: Any, at: Any, way: Any) -> bool:
    """True where the torque jumps between an end of a panel and the node next to it, which no node sees."""
    a, b, c = room[NOW, at], room[NOW, at + way], room[NOW, at + 2 * way]
    return bool(abs(outside - a) > 2.0 * (abs(a - b) + abs(b - c)) + 1e-6 * abs(a))


def panel(
    t: float, y: Any, width: float, law: Any, data: Any, rtol: float, too_wide: float, table: Any, room: Any,
    new: Any,
) -> Any:  # fmt: skip
    """The state and the time at the end of a panel, the error inside of it as a multiple of rtol.

    The time stays as it is where there is none, and where the error with the first torques is too wide.
    """
    energy = 0.5 * y[1] * y[1]
    still_at_nodes(y[0], width, law, data, table, room)
    begin = copysign(sqrt(2.0 * energy * room[MOBILITY, 0]), width)
    first = torque(t, y[0], begin, 0.0, law)
    guess(t, energy, first, width, table, room)
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
    t: float, y: Any, gap: float, law: Any, data: Any, how: Any, table: Any, room: Any, memory: Any, new: Any
) -> float:
    """The end of the next panel, which goes no farther than a gap; -1 where steps in time go on."""
    if memory[1] > 0.0 or abs(y[0]) > FAR or y[1] == 0.0:
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


# ---- the inside of a panel: Legendre series of time and energy in its part ----------------------------


def expand(start: float, width: float, table: Any, room: Any, rate: Any, out: Any) -> None:
    """The Legendre series of the integral of a rate over a panel."""
    for k in range(NODES + 1):
        room[out, k] = 0.0
        for j in range(NODES):
            room[out, k] += width * table[j, SERIES + k] * room[rate, j]
    room[out, 0] += start


def along(x: float, room: Any, row: Any) -> Any:
    """A series and its derivative at the part x of a panel."""
    at = 2.0 * x - 1.0
    value, slope = room[row, 0] + room[row, 1] * at, room[row, 1]
    before, now, slower, steep = 1.0, at, 0.0, 1.0
    for n in range(1, NODES):
        before, now = now, ((2 * n + 1) * at * now - n * before) / (n + 1)
        slower, steep = steep, slower + (2 * n + 1) * before
        value += room[row, n + 1] * now
        slope += room[row, n + 1] * steep
    return value, 2.0 * slope


def part_at(instant: float, x: float, room: Any) -> float:
    """The part of a panel at which the time is given, by Newton's method; x is a guess."""
    for _ in range(8):
        now, slope = along(x, room, int64(OF_TIME))
        step = (instant - now) / slope
        x = min(max(x + step, 0.0), 1.0)
        if not abs(step) > 1e-14:
            break
    return x


def land(
    t: float, end: float, t_end: float, y: Any, law: Any, data: Any, rtol: float, panels: Any, room: Any,
    memory: Any, new: Any,
) -> float:  # fmt: skip
    """Make the series of a panel, shortened where it goes beyond the end of the motion; its end.

    A part of a panel may be less smooth than the whole; one that cannot be shortened ends where it starts.
    """
    expand(t, abs(memory[3]), panels, room, int64(SLOWNESS), int64(OF_TIME))
    if end > t_end:
        memory[3] *= part_at(t_end, (t_end - t) / (end - t), room)
        end, _ = panel(t, y, memory[3], law, data, rtol, inf, panels, room, new)
        if not end > t:
            return t
        rows, still = empty((RATES, 16)), empty(32)
        if motion(end, new, law, data, rows, still) == 0:
            for i in range(3):
                new[i] += (t_end - end) * rows[RATE_Q + i, 0]
        expand(t, abs(memory[3]), panels, room, int64(SLOWNESS), int64(OF_TIME))
        end = t_end
    expand(0.5 * y[1] * y[1], memory[3], panels, room, int64(RATE), int64(OF_ENERGY))
    return end


def over_panel(
    t: float, end: float, y: Any, new: Any, times: Any, row: Any, law: Any, data: Any, how: Any, panels: Any,
    room: Any, memory: Any, history: Any,
) -> Any:  # fmt: skip
    """The histories inside of a panel, and its end, which is not behind that of the motion; the next row.

    Its end is its start where steps in time go on.
    """
    if end > how[1] or (row < len(times) and times[row] <= end):
        end = land(t, end, how[1], y, law, data, how[0], panels, room, memory, new)
    if not end > t:
        memory[1] = WAIT
        return end, row
    while row < len(times) and times[row] <= end:
        x = part_at(times[row], (times[row] - t) / (end - t), room)
        energy, _ = along(x, room, int64(OF_ENERGY))
        speed = copysign(sqrt(2.0 * max(energy, 0.0)), memory[3])
        tell(times[row], y[0] + memory[3] * x, speed, law, data, history, row)
        row += 1
    return end, row
