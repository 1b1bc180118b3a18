"""Motions of designs, one after the other, in plain loops, which are compiled (`compiled`).

how      relative tolerance, t_end, most steps
history  rows of angles, speeds and accelerations
"""

from __future__ import annotations

from math import inf, nan
from typing import TYPE_CHECKING

from numpy import empty, int64, zeros

from .cuts import JAMMED, KIND, KINK, LIMIT, ROW
from .march import CUT, RESTS, acceleration, choose, step, wait
from .newton import ANGLE, RATE_V, ROWS, SPEED
from .panels import CHOSEN, GOES_ON, LEFT, SHARP, T_END, T, motion, value
from .state import (
    FIRST,
    FUNCTION,
    LAST,
    OMEGA_START,
    RUBS,
    THETA0,
    TORQUE,
    WAITS,
    account,
    energy_of,
    place,
    start,
    tell,
)

if TYPE_CHECKING:
    from typing import Any

CROWD, NARROW, BESIDE = 64, 0.1, 0.005  # so many panels, rad that they turn, of a speed on either side of it
SHARPEST = 3e-11  # of a radian: a limit angle cannot be told better


def told(status: Any, t: float, steps: Any, y: Any, law: Any, sums: Any, numbers: Any) -> Any:
    """The numbers of a motion; the status of its end."""
    residual = sums[4] if status == 2 else sums[3]  # at a limit angle Y has half its digits
    if status < 0:
        theta = place(y[0], law)
        # a load on a massless slider grows without bound at a limit angle
        status = 2 if min(law[LAST] - theta, theta - law[FIRST]) < 1e-3 else 4
    scale = max(sums[1], sums[2])
    numbers[0], numbers[2] = t, y[2]
    if scale > 0.0:
        numbers[1], numbers[3] = residual / scale, 2e-17 * steps * (1.0 + sums[5] / scale)  # see `residual`
    else:
        numbers[1], numbers[3] = 0.0, inf
    return status


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


def tell_at(t: float, q: float, v: float, law: Any, data: Any, history: Any, row: Any) -> None:
    """Angle, speed and acceleration of a state, under friction too, into rows of histories."""
    if law[RUBS] == 0.0:
        tell(t, q, v, law, data, history, row)
        return
    rows, still, y = empty((ROWS, 16)), empty(32), empty(3)
    y[0], y[1], y[2] = q, v, 0.0
    motion(t, y, law, data, rows, still)
    history[0, row], history[1, row], history[2, row] = rows[ANGLE, 0], rows[SPEED, 0], acceleration(rows)


def end_of(code: Any, cut: Any, kinks: Any) -> Any:
    """The status of a motion after a panel, or without one; -1 where it goes on, -2 where it fails."""
    if code == RESTS:
        return 1
    if code > RESTS and code < CUT:
        return 3
    if code == CUT:
        if cut[KIND] == KINK:
            return int64(kinks[int64(cut[ROW]), 2]) if cut[ROW] >= 0.0 else -1
        return 2 if cut[KIND] == LIMIT else 3 if cut[KIND] == JAMMED else -1
    return -1 if code == GOES_ON else -2


def follow(
    law: Any, data: Any, kinks: Any, knots: Any, sheets: Any, times: Any, how: Any, table: Any, history: Any,
    numbers: Any,
) -> Any:  # fmt: skip
    """The motion of one design: its status."""
    y, new, scales, clock, sums = empty(3), empty(3), zeros(3), zeros(7), zeros(6)
    head, last, cut, still = zeros(7), zeros(7), zeros(6), empty(32)
    rows, matrix, series, before = zeros((ROWS, 16)), empty((32, 32)), empty((3, 17)), empty((3, 17))
    history[:] = nan
    if not start(law, data, how[1], y, scales):
        return 6
    scales[0], clock[T_END], clock[SHARP] = how[0], how[1], SHARPEST
    clock[LEFT] = 1.0
    crowd, begin, row, t, steps = 0, inf, 0, 0.0, 0
    status: Any = -1
    sums[0], sums[2] = energy_of(y, law, data), 0.5 * y[1] * y[1]
    sums[5] = abs(sums[0])
    while status == -1 and steps < how[2]:
        code = GOES_ON
        if clock[CHOSEN] == 0.0:
            code = choose(y, clock, knots, sheets, law, data, rows, still)
        if code == RESTS and law[WAITS] > 0.0:
            code = wait(y, clock, knots, sheets, law, data, rows, head)
            while row < len(times) and times[row] <= clock[T]:
                history[0, row], history[1, row], history[2, row] = place(y[0], law), 0.0, 0.0
                row += 1
            t, last[1] = clock[T], 0.0
            if t >= how[1]:
                status = 0
                break
            continue
        while code == GOES_ON and row < len(times) and times[row] <= t:
            tell_at(t, y[0], y[1], law, data, history, row)
            if t == 0.0:
                history[0, row], history[1, row] = law[THETA0], law[OMEGA_START]
            row += 1
        if code == GOES_ON:
            code = step(
                y, clock, scales, kinks, knots, sheets, law, data, table, rows, matrix, last, before, head,
                series, cut, new,
            )  # fmt: skip
        status = end_of(code, cut, kinks)
        if code != GOES_ON and code != CUT:
            break
        end = clock[T]
        while row < len(times) and times[row] <= end:
            s = (times[row] - t) / head[1]
            q, v = value(series[0], y[0], s), value(series[1], y[1], s)
            tell_at(times[row], q, v, law, data, history, row)
            row += 1
        for k in range(7):
            last[k] = head[k]
        for k in range(3):
            for j in range(17):
                before[k, j] = series[k, j]
        account(y, new, law, data, sums)
        scales[1] = max(scales[1], abs(y[1]))
        t, steps = end, steps + 1
        status = 0 if status == -1 and t >= how[1] else status
        crowd += 1
        if law[TORQUE] == FUNCTION and crowd == CROWD:
            if status == -1 and abs(y[0] - begin) < NARROW and slides(t, y, law, data):
                break
            crowd, begin = 0, y[0]
    return told(status, t, steps, y, law, sums, numbers)


def designs(
    law: Any, data: Any, kinks: Any, knots: Any, sheets: Any, times: Any, how: Any, table: Any, history: Any,
    status: Any, numbers: Any,
) -> None:  # fmt: skip
    """Every design: histories, status, and end, energy residual, work and its rounding as numbers."""
    for n in range(len(law)):
        if status[n] < 0:
            for k in range(4):
                numbers[n, k] = nan
            status[n] = follow(
                law[n], data[n], kinks[n], knots, sheets[n], times, how, table, history[n], numbers[n]
            )
