"""DOP853: one step of one design, in plain loops, which are compiled (`compiled`).

The method is that of Hairer, Norsett and Wanner, "Solving Ordinary Differential Equations I", section II,
with the step control and the error norm of `stepper`: one design takes the steps that `simulate` takes for it
alone.

tables   A, B, C, E3, E5, D and the rows of A and C for the dense output; that of the panels
clock    the next step, 0 where it is not known; the length that the last one suggested; the longest; the end
         of the motion [s]; 1 where K[0] does not have the rates at the start of the step
"""

from __future__ import annotations

from math import inf, sqrt
from typing import TYPE_CHECKING

from numpy import int64, nextafter

from .state import ABSOLUTE, RELATIVE, SIZE, limits_of, rates, square

if TYPE_CHECKING:
    from typing import Any


NEXT, WISHED, LONGEST, T_END, STALE = 0, 1, 2, 3, 4  # places of the clock
OVER = 1.2e-2  # of q: a step over a limit angle


def combined(K: Any, weights: Any, count: Any, column: int) -> float:
    """The sum of the first stages by their weights."""
    total = 0.0
    for j in range(count):
        total += K[j, column] * weights[j]
    return total


def advance(y: Any, h: float, K: Any, weights: Any, count: Any, out: Any) -> None:
    """y + h times the sum of the first stages by their weights, half of which are 0."""
    q, v, w = 0.0, 0.0, 0.0
    for j in range(count):
        weight = weights[j]
        if weight != 0.0:
            q += K[j, 0] * weight
            v += K[j, 1] * weight
            w += K[j, 2] * weight
    out[0], out[1], out[2] = y[0] + h * q, y[1] + h * v, y[2] + h * w


def trial(t: float, y: Any, h: float, p: Any, setup: Any, tables: Any, K: Any, new: Any) -> None:
    """A step of order 8: its stages and its end. K[0] has the rates at its start."""
    A, B, C = tables[0], tables[1], tables[2]
    for s in range(1, 12):
        advance(y, h, K, A[s], s, new)
        rates(t + C[s] * h, new, p, setup, K[s])
    advance(y, h, K, B, int64(12), new)
    rates(t + h, new, p, setup, K[12])


def error_of(h: float, y: Any, new: Any, scales: Any, tables: Any, K: Any) -> float:
    """The error of a step relative to the tolerance: see `Dop853._error`."""
    fifth, third, cubic, tightest = 0.0, 0.0, 0.0, inf
    for i in range(3):
        largest = max(abs(y[i]), abs(new[i]))
        scale = scales[ABSOLUTE, i] + largest * scales[RELATIVE, i]
        whole = scales[SIZE, i] + (largest if i > 0 else 0.0)
        rate = combined(K, tables[3], int64(13), i)
        fifth += square(combined(K, tables[4], int64(13), i) / scale)
        third += square(rate / scale)
        cubic += square(h * rate / whole)
        tightest = min(tightest, scale / whole)
    if fifth == 0.0 and third == 0.0:
        return 0.0
    error: float = abs(h) * fifth / sqrt((fifth + 0.01 * third) * 3.0)
    return max(error, 0.1 * cubic / tightest)


def share_of(angle: float) -> float:
    """By how much the error of a step counts more in a long motion: see `Dop853._error`."""
    return min(4.0, max(1.0, angle / 100.0))


def first_step(t: float, y: Any, p: Any, setup: Any, scales: Any, clock: Any, K: Any, new: Any) -> float:
    """A first step from the sizes of state, rates and their change. K[0] has the rates."""
    d0, d1, d2 = 0.0, 0.0, 0.0
    for i in range(3):
        scale = scales[ABSOLUTE, i] + abs(y[i]) * scales[RELATIVE, i]
        d0 += square(y[i] / scale) / 3.0
        d1 += square(K[0, i] / scale) / 3.0
    d0, d1, left = sqrt(d0), sqrt(d1), clock[T_END] - t
    h = min(1e-6 if d0 < 1e-5 or d1 < 1e-5 else 0.01 * d0 / d1, left)
    for i in range(3):
        new[i] = y[i] + h * K[0, i]
    rates(t + h, new, p, setup, K[1])
    for i in range(3):
        scale = scales[ABSOLUTE, i] + abs(y[i]) * scales[RELATIVE, i]
        d2 += square((K[1, i] - K[0, i]) / scale) / 3.0
    d2 = sqrt(d2) / h
    then = max(1e-6, h * 1e-3) if d1 <= 1e-15 and d2 <= 1e-15 else (0.01 / max(d1, d2)) ** 0.125
    return float(min(100.0 * h, then, left))


def over_limit(before: float, after: float, first: float, last: float) -> float:
    """By what to change a step that ends near a limit angle, where S has lost its digits; 0 if it may stay.

    The step over a limit is a short one from a little before it, for the dense output is less exact.
    """
    way = after - before
    left = last - before if way > 0.0 else before - first
    if way == 0.0 or min(last - after, after - first) >= 2e-3:
        return 0.0
    if left > 0.5 and abs(way) < 0.5:
        return 0.0  # it comes from the limit
    if abs(way) >= left and abs(way) < OVER:
        return 0.0
    wanted = left - 5e-3 if left > 8e-3 else left + 3e-3
    return min(wanted / abs(way), 3.0)


def step(
    t: float, y: Any, p: Any, setup: Any, scales: Any, clock: Any, tables: Any, K: Any, new: Any
) -> float:
    """The end of the next step, which passes; -1 where none does. K[0] has the rates at its start."""
    first, last = limits_of(setup)
    smallest = 10.0 * (nextafter(t, inf) - t)
    h, rejected, tries = max(min(clock[NEXT], clock[LONGEST]), smallest), False, 0
    while h >= smallest:
        end = min(t + min(h, clock[LONGEST]), clock[T_END])
        h = end - t
        trial(t, y, h, p, setup, tables, K, new)
        way = abs(new[0] - y[0])
        error = error_of(h, y, new, scales, tables, K) * share_of(way / h * clock[T_END])
        beyond = new[0] >= last or new[0] <= first
        # At a limit angle the error is that of S, which has lost its digits: a short step over it may pass.
        if not error < 1.0 and not (setup[3] > 0.0 and beyond and way < OVER):
            h *= max(0.2, 0.9 * error**-0.125) if error > 0.0 else 0.2  # NaN: a trial beyond a limit
            rejected = True
            continue
        longer = over_limit(y[0], new[0], first, last) if setup[3] > 0.0 and tries < 20 else 0.0
        if longer > 0.0:
            h *= longer
            rejected, tries = True, tries + 1
            continue
        growth = min(10.0, 0.9 * error**-0.125) if error > 0.0 else 10.0
        wish = h * (min(1.0, growth) if rejected else growth)
        clock[NEXT], clock[WISHED] = min(wish, clock[WISHED]), wish
        return float(end)
    return -1.0
