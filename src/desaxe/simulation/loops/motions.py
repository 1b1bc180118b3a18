"""Motions of designs, one after the other, in compiled loops; the entries of all loops.

how      relative tolerance, t_end, most steps, knots of time
history  rows of angles, speeds and accelerations
"""

from __future__ import annotations

from math import nan
from typing import TYPE_CHECKING

from numpy import empty, int64, zeros

from . import law as layout
from .cuts import JAMMED, KINK, LIMIT
from .law import acceleration, law_at, place, values
from .march import CUT, RESTING, RESTS, SUMS, UNMOVED, advance, pause
from .panels import GOES_ON, LEFT, SHARP, T_END, T, value

if TYPE_CHECKING:
    from typing import Any

PANELS, LAW = 0.0, 1.0  # what the entry for one motion does
KNOTS = 3  # the first of them in `how`
SUMMED = 3  # of the numbers of a design: the first of its sums
SHARPEST = 3e-11  # of a radian: a limit angle cannot be told better


def tell(
    head: Any, series: Any, resting: bool, times: Any, row: Any, law: Any, data: Any, rows: Any, history: Any
) -> Any:  # fmt: skip
    """Angle, speed and acceleration at the instants of a panel, sixteen at a time; the next instant."""
    state: Any = empty(32)
    h = head[1] if head[1] > 0.0 else 1.0
    while row < len(times) and times[row] <= head[6]:
        last = row
        while last + 1 < len(times) and last < row + 15 and times[last + 1] <= head[6]:
            last += 1
        for i in range(16):
            rows[layout.TIME, i] = times[row + i if row + i < last else last]
            s = (rows[layout.TIME, i] - head[0]) / h
            state[i], state[16 + i] = value(series[0], head[3], s), value(series[1], head[4], s)
        law_at(state, law, data, rows, 0)
        for k in range(row, last + 1):
            history[0, k], history[1, k] = rows[layout.ANGLE, k - row], rows[layout.SPEED, k - row]
            history[2, k] = 0.0 if resting else acceleration(rows, k - row)
        row = last + 1
    return row


def end_of(code: Any, cut: Any, kinks: Any) -> Any:
    """The status of a motion after some panels; -1 where it goes on, -2 where it fails."""
    if code == RESTS:
        return 1
    if code > RESTS and code < CUT:
        return 3
    if code == CUT:
        if cut[0] == KINK:
            return int64(kinks[int64(cut[1]), 2]) if cut[1] >= 0.0 else -1
        return 2 if cut[0] == LIMIT else 3 if cut[0] == JAMMED else -1
    return 6 if code == UNMOVED else -1 if code == GOES_ON else -2


def follow(
    law: Any, data: Any, kinks: Any, knots: Any, sheets: Any, times: Any, how: Any, table: Any, heads: Any,
    records: Any, ends: Any, laws: Any, history: Any, numbers: Any,
) -> Any:  # fmt: skip
    """The motion of one design: its status."""
    y, scales, clock, sums, count = empty(3), zeros(3), zeros(8), zeros(SUMS), zeros(1)
    rows, matrix = zeros((layout.ROWS, 16)), empty((32, 32))
    history[:] = nan
    scales[0], clock[T_END], clock[SHARP], clock[LEFT] = how[0], how[1], SHARPEST, 1.0
    row: Any = 0
    steps: Any = 0
    status: Any = -1
    while status == -1 and steps < how[2]:
        most = int64(min(len(heads) * 1.0, how[2] - steps + 1.0))
        pause(clock, how, KNOTS)
        code = advance(
            y, clock, scales, kinks, knots, sheets, law, data, table, rows, matrix, heads[0:most], records,
            ends, laws, count, sums,
        )  # fmt: skip
        made = int64(count[0])
        for k in range(1, made + 1):
            row = tell(heads[k], records[k], ends[k, 0] == RESTING, times, row, laws[k], data, rows, history)
        steps += made
        status = end_of(code, ends[made], kinks)
        if status == -1 and clock[T] >= how[1]:
            status = 0
        for k in range(7):
            heads[0, k] = heads[made, k]
        for k in range(3):
            for j in range(17):
                records[0, k, j] = records[made, k, j]
        count[0] = 1.0
    for k in range(len(times)):
        if times[k] == 0.0 and row > 0:
            history[0, k], history[1, k] = law[layout.THETA0], law[layout.OMEGA_START]
    if status < 0:  # a load on a massless slider grows without bound at a limit angle
        theta = place(y[0], law)
        status = 2 if min(law[layout.LAST] - theta, theta - law[layout.FIRST]) < 1e-3 else 4
    if status != 6:
        numbers[0], numbers[1], numbers[2] = clock[T], y[2], steps
        for k in range(SUMS):
            numbers[SUMMED + k] = sums[k]
    return status


def single(
    work: float, law: Any, data: Any, kinks: Any, knots: Any, sheets: Any, table: Any, y: Any, clock: Any,
    scales: Any, rows: Any, matrix: Any, heads: Any, records: Any, ends: Any, laws: Any, count: Any,
    sums: Any, which: Any, t: Any, q: Any, v: Any, out: Any,
) -> int:  # fmt: skip
    """Panels of one motion, or the law at instants of it."""
    if work == PANELS:
        return advance(
            y, clock, scales, kinks[0], knots, sheets[0], law[0], data[0], table, rows, matrix, heads,
            records, ends, laws, count, sums,
        )  # fmt: skip
    return values(laws, which, t, q, v, data[0], out)


def designs(
    law: Any, data: Any, kinks: Any, knots: Any, sheets: Any, table: Any, heads: Any, records: Any, ends: Any,
    laws: Any, times: Any, how: Any, history: Any, status: Any, numbers: Any,
) -> None:  # fmt: skip
    """Every design: histories, status, and numbers: instant of the end, work, panels, sums (see `march`)."""
    for n in range(len(law)):
        if status[n] < 0:
            numbers[n, :] = nan
            status[n] = follow(
                law[n], data[n], kinks[n], knots, sheets[n], times, how, table, heads, records, ends, laws,
                history[n], numbers[n],
            )  # fmt: skip
