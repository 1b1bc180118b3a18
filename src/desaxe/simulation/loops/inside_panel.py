"""The inside of a panel: Legendre series of the time and the energy, histories, the end of the motion.

Both are series in s (see `picard`).
"""

from __future__ import annotations

from math import copysign, inf, sqrt
from typing import TYPE_CHECKING

from numpy import empty, int64

from .newton import RATE_Q, ROWS
from .panel import WAIT, panel
from .panels import motion
from .picard import NODES, OF_ENERGY, OF_TIME, PACE, RATE, SERIES
from .state import tell

if TYPE_CHECKING:
    from typing import Any


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
        before, now, slower, steep = (
            now,
            ((2 * n + 1) * at * now - n * before) / (n + 1),
            steep,
            slower + (2 * n + 1) * now,
        )
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
    t: float,
    end: float,
    t_end: float,
    y: Any,
    law: Any,
    data: Any,
    rtol: float,
    panels: Any,
    room: Any,
    memory: Any,
    new: Any,
) -> float:
    """Make the series of a panel, shortened where it goes beyond the end of the motion; its end.

    A part of a panel may be less smooth than the whole; one that cannot be shortened ends where it starts.
    """
    width = memory[3]
    expand(t, abs(width), panels, room, int64(PACE), int64(OF_TIME))
    if end > t_end:
        part = part_at(t_end, (t_end - t) / (end - t), room)
        memory[3] = width * (part * part if y[1] == 0.0 else part)
        end, _ = panel(t, y, memory[3], law, data, rtol, inf, panels, room, new)
        if not end > t:
            return t
        rows, still = empty((ROWS, 16)), empty(32)
        if motion(end, new, law, data, rows, still) == 0:
            for i in range(3):
                new[i] += (t_end - end) * rows[RATE_Q + i, 0]
        expand(t, abs(memory[3]), panels, room, int64(PACE), int64(OF_TIME))
        end = t_end
    expand(0.5 * y[1] * y[1], memory[3], panels, room, int64(RATE), int64(OF_ENERGY))
    return end


def tell_inside(
    t: float,
    end: float,
    instant: float,
    y: Any,
    law: Any,
    data: Any,
    room: Any,
    memory: Any,
    history: Any,
    row: Any,
) -> None:
    """Angle, speed and acceleration at an instant inside of a panel, into the histories."""
    x = part_at(instant, (instant - t) / (end - t), room)
    energy, _ = along(x, room, int64(OF_ENERGY))
    speed = copysign(sqrt(2.0 * max(energy, 0.0)), memory[3])
    way = memory[3] * (x * x if y[1] == 0.0 else x)
    tell(instant, y[0] + way, speed, law, data, history, row)


def over_panel(
    t: float,
    end: float,
    y: Any,
    new: Any,
    times: Any,
    row: Any,
    law: Any,
    data: Any,
    how: Any,
    panels: Any,
    room: Any,
    memory: Any,
    history: Any,
) -> Any:
    """The histories inside of a panel, and its end, which is not behind that of the motion; the next row.

    Its end is its start where steps in time go on.
    """
    if end > how[1] or (row < len(times) and times[row] <= end):
        end = land(t, end, how[1], y, law, data, how[0], panels, room, memory, new)
    if not end > t:
        memory[1] = WAIT
        return end, row
    while row < len(times) and times[row] <= end:
        tell_inside(t, end, times[row], y, law, data, room, memory, history, row)
        row += 1
    return end, row
