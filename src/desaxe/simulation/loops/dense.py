"""Over a step of DOP853: a polynomial of its inside, where it passes a limit angle, histories in it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from numpy import empty, int64

from .dop853 import NEXT, STALE, advance, combined, first_step, step
from .state import limits_of, rates, tell

if TYPE_CHECKING:
    from typing import Any


def dense(t: float, y: Any, h: float, new: Any, p: Any, setup: Any, tables: Any, K: Any, F: Any) -> None:
    """The polynomial of a step: its coefficients, from three more stages."""
    D, A, C = tables[5], tables[6], tables[7]
    state = empty(3)
    for s in range(3):
        advance(y, h, K, A[s], 13 + s, state)
        rates(t + C[s] * h, state, p, setup, K[13 + s])
    for i in range(3):
        change = new[i] - y[i]
        F[0, i] = change
        F[1, i] = h * K[0, i] - change
        F[2, i] = 2.0 * change - h * (K[12, i] + K[0, i])
        for row in range(4):
            F[3 + row, i] = h * combined(K, D[row], int64(16), i)


def inside(x: float, y: Any, F: Any, i: Any) -> float:
    """A coordinate at the part x of a step."""
    total, even = 0.0, True
    for k in range(7):
        total = (total + F[6 - k, i]) * (x if even else 1.0 - x)
        even = not even
    return float(total + y[i])


def crossing(y: Any, F: Any, bound: float) -> float:
    """The part of a step at which q passes a bound, by halving."""
    low, high = 0.0, 1.0
    before = y[0] < bound
    for _ in range(60):
        x = 0.5 * (low + high)
        if (inside(x, y, F, int64(0)) < bound) == before:
            low = x
        else:
            high = x
    return 0.5 * (low + high)


def over_step(
    t: float,
    y: Any,
    new: Any,
    times: Any,
    row: Any,
    p: Any,
    setup: Any,
    scales: Any,
    clock: Any,
    tables: Any,
    theta: Any,
    omega: Any,
    alpha: Any,
    K: Any,
    F: Any,
) -> Any:
    """A step, which ends at a limit angle if it meets one; its end, the next row, whether it met one."""
    if clock[STALE] > 0.0:
        rates(t, y, p, setup, K[0])
        clock[STALE] = 0.0
    if clock[NEXT] == 0.0:
        clock[NEXT] = first_step(t, y, p, setup, scales, clock, K, new)
    end = step(t, y, p, setup, scales, clock, tables, K, new)
    if end < 0.0:
        return end, row, False
    first, last = limits_of(setup)
    beyond, h = new[0] >= last or new[0] <= first, end - t
    if beyond or (row < len(times) and times[row] <= end):
        dense(t, y, h, new, p, setup, tables, K, F)
    if beyond:
        stop = crossing(y, F, last if new[0] >= last else first)
        end = t + stop * h
        for i in range(3):
            new[i] = inside(stop, y, F, i)
    while row < len(times) and times[row] <= end:
        x = (times[row] - t) / h
        q, v = inside(x, y, F, int64(0)), inside(x, y, F, int64(1))
        tell(times[row], q, v, p, setup, theta, omega, alpha, row)
        row += 1
    for i in range(3):
        K[0, i] = K[12, i]
    return end, row, beyond
