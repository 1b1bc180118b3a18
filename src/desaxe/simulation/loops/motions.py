"""Motions of designs, one after the other, in plain loops, which are compiled (`compiled`).

A crank that turns fully goes by panels of the crank angle (`panel`) where its speed lets it; all others, and
where these fail, by panels of time (`advance`).

how      relative tolerance, t_end, most steps
tables   of panels of time (`newton`) and of the angle (`nodes`)
history  rows of angles, speeds and accelerations
"""

from __future__ import annotations

from math import inf, nan
from typing import TYPE_CHECKING

from numpy import empty, int64, zeros

from .advance import BEYOND, SHARP, T_END, WISH, T, motion, one, value
from .inside_panel import over_panel
from .newton import RATE_V, ROWS
from .panel import by_panel
from .picard import MOBILITY
from .picard import ROWS as PICARD
from .state import (
    FIRST,
    FUNCTION,
    HALF,
    INERTIA,
    OUTPUTS,
    THETA0,
    TORQUE,
    account,
    at_angle,
    energy_of,
    limits_of,
    start,
    tell,
)  # fmt: skip

if TYPE_CHECKING:
    from typing import Any

COLUMNS = int64(24)  # of the room of a panel
CROWD, NARROW, BESIDE = 64, 0.1, 0.005  # so many panels, rad that they turn, of a speed on either side of it
SHARPEST = 3e-11  # of a radian: a limit angle cannot be told better


def told(status: Any, t: float, steps: Any, y: Any, law: Any, data: Any, sums: Any, numbers: Any) -> Any:
    """The numbers of a motion; the status of its end."""
    residual = sums[4] if status == 2 else sums[3]  # at a limit angle Y has half its digits
    if status < 0:
        first, last = limits_of(law)
        out: Any = empty((OUTPUTS, 1))
        at_angle(law[THETA0], law, data, out)
        # a load on a massless slider grows without bound at a limit angle
        near = min(last - y[0], y[0] - first) < 1e-3
        status = 2 if near else 5 if sums[6] < 1e-8 * out[INERTIA, 0] else 4
    scale = max(sums[1], sums[2])
    numbers[0], numbers[2] = t, y[2]
    if scale > 0.0:
        numbers[1], numbers[3] = residual / scale, 2e-17 * steps * (1.0 + sums[5] / scale)  # see `residual`
    else:
        numbers[1], numbers[3] = 0.0, inf
    return status


def part_within(y: Any, law: Any, series: Any, new: Any) -> float:
    """The part of a panel, or a little beyond it, at which it reaches a limit angle; the state there.

    2 where it reaches none; then the state is that at the end.
    """
    last = value(series[0], y[0], BEYOND if law[HALF] > 0.0 else 1.0)
    low, high = limits_of(law)
    part, found = 1.0, not low < last < high
    if found:
        bound, a, b = high if last >= high else low, 0.0, BEYOND if law[HALF] > 0.0 else 1.0
        for _ in range(60):
            part = 0.5 * (a + b)
            if (value(series[0], y[0], part) < bound) == (y[0] < bound):
                a = part
            else:
                b = part
    for k in range(3):
        new[k] = value(series[k], y[k], part)
    return part if found else 2.0


def slides(t: float, y: Any, law: Any, data: Any) -> bool:
    """True if a torque that jumps at a speed drives the crank back to it from either side: it chatters."""
    rows, still, trial = empty((ROWS, 16)), empty(32), empty(3)
    for k in range(3):
        trial[k] = y[k]
    low, high = y[1] - BESIDE * abs(y[1]), y[1] + BESIDE * abs(y[1])
    trial[1] = low
    below = rows[RATE_V, 0] if motion(t, trial, law, data, rows, still) == 0 else nan
    trial[1] = high
    above = rows[RATE_V, 0] if motion(t, trial, law, data, rows, still) == 0 else nan
    gap = below - above
    for _ in range(64):  # to the half with the larger part of the difference
        trial[1] = 0.5 * (low + high)
        here = rows[RATE_V, 0] if motion(t, trial, law, data, rows, still) == 0 else nan
        if below - here > here - above:
            high, above = trial[1], here
        else:
            low, below = trial[1], here
    return bool(gap > 0.0 and below - above > 0.5 * gap)


def follow(
    law: Any, data: Any, times: Any, how: Any, table: Any, panels: Any, history: Any, numbers: Any
) -> Any:
    """The motion of one design: its status."""
    y, new, scales, clock, sums, memory = empty(3), empty(3), zeros(3), zeros(4), zeros(7), zeros(4)
    head, last, kinks, still, room = empty(6), zeros(6), empty((0, 2)), empty(32), empty((PICARD, COLUMNS))
    rows, matrix, series, before = empty((ROWS, 16)), empty((32, 32)), empty((3, 17)), empty((3, 17))
    history[:] = nan
    if not start(law, data, how[1], y, scales):
        return 6
    scales[0], clock[T_END], clock[SHARP], memory[0], sums[6] = how[0], how[1], SHARPEST, 0.5, inf
    crowd, begin = 0, inf
    row, t, status, steps, turns = 0, 0.0, -1, 0, law[FIRST] == -inf
    while row < len(times) and times[row] <= 0.0:
        tell(0.0, y[0], y[1], law, data, history, row)
        row += 1
    sums[0], sums[2] = energy_of(y, law, data, sums), 0.5 * y[1] * y[1]
    sums[5] = abs(sums[0])
    while status < 0 and steps < how[2]:
        push = 0.0
        if turns and y[1] == 0.0 and motion(t, y, law, data, rows, still) == 0:
            push = rows[RATE_V, 0]
        end = by_panel(t, y, push, law, data, how, panels, room, memory, new) if turns else -1.0
        if end > t:
            end, row = over_panel(t, end, y, new, times, row, law, data, how, panels, room, memory, history)
        if end > t:
            clock[WISH], last[1] = 0.1 * (end - t), 0.0
            for i in range(16):
                sums[6] = min(sums[6], 1.0 / room[MOBILITY, i])
        else:
            clock[T] = t
            if one(y, clock, scales, kinks, law, data, table, rows, matrix, last, before, head, series) != 0:
                break
            part = part_within(y, law, series, new)
            end = t + head[1] * (1.0 if part == 2.0 else part)
            if part != 2.0 and end <= how[1]:
                status = 2
            elif part != 2.0 and end > how[1]:  # the end of the motion comes before
                end = t + head[1]
                for k in range(3):
                    new[k] = value(series[k], y[k], 1.0)
            end = how[1] if how[1] * (1.0 - 1e-15) <= end else end
            memory[2] = abs(new[0] - y[0])
            while row < len(times) and times[row] <= end:
                s = (times[row] - t) / head[1]
                tell(
                    times[row], value(series[0], y[0], s), value(series[1], y[1], s), law, data, history, row
                )
                row += 1
            for k in range(6):
                last[k] = head[k]
            for k in range(3):
                for j in range(17):
                    before[k, j] = series[k, j]
        account(y, new, law, data, sums)
        scales[1] = max(scales[1], abs(y[1]))
        t, steps = end, steps + 1
        status = 0 if status < 0 and t >= how[1] else status
        crowd += 1
        if law[TORQUE] == FUNCTION and crowd == CROWD:
            if status < 0 and abs(y[0] - begin) < NARROW and slides(t, y, law, data):
                break
            crowd, begin = 0, y[0]
    return told(status, t, steps, y, law, data, sums, numbers)


def designs(
    law: Any, data: Any, times: Any, how: Any, table: Any, panels: Any, history: Any, status: Any,
    numbers: Any,
) -> None:  # fmt: skip
    """Every design: histories, status, and end, energy residual, work and its rounding as numbers."""
    for n in range(len(law)):
        if status[n] < 0:
            for k in range(4):
                numbers[n, k] = nan
            status[n] = follow(law[n], data[n], times, how, table, panels, history[n], numbers[n])
