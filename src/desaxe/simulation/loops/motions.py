"""Motions of designs, one after the other, in plain loops, which are compiled (`compiled`).

A crank that turns fully goes by panels of the crank angle (`panel`) where its speed lets it; all others, and
where panels fail, by steps in time (`dop853`).

how   relative tolerance, t_end, longest step, most steps, whether panels may be taken
"""

from __future__ import annotations

from math import inf, nan
from typing import TYPE_CHECKING

from numpy import empty, int64, zeros

from .dense import over_step
from .dop853 import LONGEST, T_END, WISHED
from .inside_panel import over_panel
from .panel import by_panel
from .picard import MOBILITY, ROWS
from .state import account, energy_of, limits_of, place, rates, start, still, tell

if TYPE_CHECKING:
    from typing import Any

COLUMNS = int64(24)  # of the room of a panel


def told(
    status: Any, t: float, steps: Any, y: Any, p: Any, setup: Any, least: float, sums: Any, made: Any
) -> Any:
    """The status of the end and the numbers of a motion."""
    residual = sums[4] if status == 2 else sums[3]  # at a limit angle Y has half its digits
    if status < 0:
        first, last = limits_of(setup)
        # a load on a massless slider grows without bound at a limit angle
        near = min(last - y[0], y[0] - first) < 1e-3
        status = 2 if near else 5 if least < 1e-8 * still(setup[6], 1.0, p, setup)[0] else 4
    scale = max(sums[1], sums[2])
    if not scale > 0.0:
        return status, t, 0.0, y[2], inf, made
    rounded = 2e-17 * steps * (1.0 + sums[5] / scale)  # `residual.ROUNDED`
    return status, t, residual / scale, y[2], rounded, made


def follow(
    p: Any,
    setup: Any,
    times: Any,
    how: Any,
    tables: Any,
    theta: Any,
    omega: Any,
    alpha: Any,
    K: Any,
    F: Any,
) -> Any:
    """The motion of one design: status, end, energy residual, work, its rounding, number of panels."""
    y, new, scales, clock, sums, memory = empty(3), empty(3), empty((3, 3)), zeros(5), zeros(6), zeros(4)
    theta[:], omega[:], alpha[:] = nan, nan, nan
    if not start(p, setup, how[0], how[1], y, scales):
        return 6, nan, nan, nan, nan, 0
    t, row, panels, room = 0.0, int64(0), tables[8], empty((ROWS, COLUMNS))
    while row < len(times) and times[row] <= 0.0:
        tell(0.0, y[0], y[1], p, setup, theta, omega, alpha, row)
        row += 1
    rates(0.0, y, p, setup, K[0])
    clock[WISHED], clock[T_END], clock[LONGEST], memory[0] = inf, how[1], how[2], 0.5
    sums[0], sums[2] = energy_of(y, p, setup), 0.5 * y[1] * y[1]
    sums[5] = abs(sums[0])
    status, steps, made, least, turns = -1, 0, 0, inf, how[4] > 0.0 and setup[1] == -inf
    while status < 0 and steps < how[3]:
        end = by_panel(t, y, K[0, 1], p, setup, how, panels, room, memory, new) if turns else -1.0
        if end > t:
            end, row = over_panel(
                t, end, y, new, times, row, p, setup, how, clock, panels, room, memory, K, theta, omega, alpha
            )
        if end > t:
            made += 1
            for i in range(16):
                least = min(least, 1.0 / room[MOBILITY, i])
        else:
            end, row, beyond = over_step(
                t, y, new, times, row, p, setup, scales, clock, tables, theta, omega, alpha, K, F
            )
            if end < 0.0:
                break
            status, memory[2] = 2 if beyond else -1, abs(new[0] - y[0])
            least = min(least, still(place(new[0], setup)[0], 1.0, p, setup)[0])
        account(y, new, p, setup, sums)
        t, steps = end, steps + 1
        status = 0 if status < 0 and t >= how[1] else status
    return told(status, t, steps, y, p, setup, least, sums, made)


def designs(
    p: Any,
    setup: Any,
    times: Any,
    how: Any,
    A: Any,
    B: Any,
    C: Any,
    E3: Any,
    E5: Any,
    D: Any,
    A_more: Any,
    C_more: Any,
    panels: Any,
    theta: Any,
    omega: Any,
    alpha: Any,
    status: Any,
    numbers: Any,
) -> None:
    """Every design: histories, status, and end, energy residual, work, rounding and panels as numbers."""
    K, F = empty((16, 3)), empty((7, 3))
    tables = (A, B, C, E3, E5, D, A_more, C_more, panels)
    for n in range(len(setup)):
        if status[n] < 0:
            told = follow(p[n], setup[n], times, how, tables, theta[n], omega[n], alpha[n], K, F)
            status[n] = told[0]
            numbers[n, 0], numbers[n, 1], numbers[n, 2], numbers[n, 3] = told[1], told[2], told[3], told[4]
            numbers[n, 4] = told[5]
