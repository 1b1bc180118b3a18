"""A panel of time in plain loops, which are compiled (`advance`): Newton's method for the state at its nodes.

The matrix is made at the first guess, and again only where the iteration is slow.

table    places of the nodes; running integrals; the series of an integral; the last two terms of a series;
         values at both ends; the series of values; the running integrals, transposed
scales   relative tolerance, largest |v| so far, the latter with this panel
"""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

from numpy import empty, int64

from ...compiler.llvm.loops import apart
from .law import HALF, Q_BY_Q, Q_BY_V, RATE_Q, RATE_V, SLOPE, TIME, V_BY_Q, V_BY_V, law_at

if TYPE_CHECKING:
    from typing import Any

RUNNING, SERIES, TAILS, ENDS, POINTS, ACROSS = 1, 17, 34, 36, 38, 54  # rows of the table
ITERATIONS = 14
SLOW = 0.1  # of the step before: then the matrix is made anew
SMALL_PIVOT = 0.5  # of a matrix that differs from 1 by the length of a panel: below it rows are exchanged
BLUR = 4e-16  # over cos(q)^2: the rounding of the rates next to a limit angle
ROUNDING = 4e-15  # of the size of a coordinate
DEVIATES = 30.0  # tolerances: by so much a rate differs where nodes have missed a jump
TAIL = 30.0  # tolerances: the last terms of the rates, over the panel; its inside is far more exact


def product(row: Any, values: Any) -> float:
    """The sum of 16 products."""
    a, b, c, d = 0.0, 0.0, 0.0, 0.0
    for i in range(0, 16, 4):
        a += row[i] * values[i]
        b += row[i + 1] * values[i + 1]
        c += row[i + 2] * values[i + 2]
        d += row[i + 3] * values[i + 3]
    return float((a + b) + (c + d))


def fill_matrix(h: float, rows: Any, table: Any, matrix: Any) -> None:
    """Newton's matrix, transposed."""
    apart()
    for j in range(16):
        qq, qv, vq, vv = rows[Q_BY_Q, j], rows[Q_BY_V, j], rows[V_BY_Q, j], rows[V_BY_V, j]
        for i in range(16):
            share = -h * table[ACROSS + j, i]
            matrix[j, i], matrix[16 + j, i] = share * qq, share * qv
            matrix[j, 16 + i], matrix[16 + j, 16 + i] = share * vq, share * vv
    for i in range(32):
        matrix[i, i] += 1.0


def subtract(row: Any, share: float, other: Any, first: Any) -> None:
    """Subtract a multiple of a row from another, in one half of the columns."""
    apart()
    for j in range(16):
        row[first + j] -= share * other[first + j]


def factor(matrix: Any, lower: Any, order: Any) -> bool:
    """The triangular factors of a matrix and the order of its rows; False if it has none.

    The upper one takes its memory, whose other half is left behind: whole vectors are faster than no work.
    """
    for k in range(32):
        best = k
        if abs(matrix[k, k]) < SMALL_PIVOT:
            for i in range(k + 1, 32):
                if abs(matrix[i, k]) > abs(matrix[best, k]):
                    best = i
        order[k] = best
        if best != k:
            for j in range(32):
                matrix[k, j], matrix[best, j] = matrix[best, j], matrix[k, j]
                lower[k, j], lower[best, j] = lower[best, j], lower[k, j]
        if not 0.0 < abs(matrix[k, k]) < inf:
            return False
        inverse = 1.0 / matrix[k, k]
        lower[k, k] = inverse
        for i in range(k + 1, 32):
            share = matrix[i, k] * inverse
            lower[i, k] = share
            if k < 16:
                subtract(matrix[i], share, matrix[k], int64(0))
            subtract(matrix[i], share, matrix[k], int64(16))
    return True


def solve(upper: Any, lower: Any, order: Any, x: Any) -> None:
    """Solve for a right-hand side, in its memory, with the factors of the transposed matrix."""
    y: Any = empty(32)
    for k in range(32):
        y[k] = x[k] * lower[k, k]
        if k < 16:
            subtract(x, y[k], upper[k], int64(0))
        subtract(x, y[k], upper[k], int64(16))
    for n in range(32):
        k = 31 - n
        x[k] = y[k]
        subtract(y, x[k], lower[k], int64(0))
        if k > 15:
            subtract(y, x[k], lower[k], int64(16))
    for n in range(32):
        k = 31 - n
        best = int64(order[k])
        x[k], x[best] = x[best], x[k]


def newton(
    t: float, h: float, y: Any, state: Any, scales: Any, law: Any, data: Any, table: Any, rows: Any,
    matrix: Any, series: Any,
) -> float:  # fmt: skip
    """Solve a panel, whose state is a guess: the error of its inside, -1 where there is none, -2 to stop."""
    order: Any = empty(32)
    miss: Any = empty(32)
    lower: Any = empty((32, 32))
    aim, before, made = max(0.02 * scales[0], ROUNDING), inf, False
    radian = max(1.0, abs(y[0]))
    for i in range(16):
        rows[TIME, i] = t + h * table[0, i]
    for _ in range(ITERATIONS):
        code = law_at(state, law, data, rows, 0 if made else 1)
        if code != 0:
            return -float(code)
        for i in range(16):
            miss[i] = y[0] - state[i] + h * product(table[RUNNING + i], rows[RATE_Q])
            miss[16 + i] = y[1] - state[16 + i] + h * product(table[RUNNING + i], rows[RATE_V])
        if not made:
            made = True
            fill_matrix(h, rows, table, matrix)
            if not factor(matrix, lower, order):
                return -1.0
        solve(matrix, lower, order, miss)
        top, far, fast, total = scales[1], 0.0, 0.0, 0.0
        for i in range(16):
            top = max(top, abs(state[16 + i]))
            far, fast = max(far, abs(miss[i])), max(fast, abs(miss[16 + i]))
            total += miss[i] + miss[16 + i]
        size = max(far / radian, fast / top if top > 0.0 else 0.0)
        if not (abs(total) < inf and size < inf):
            return -1.0
        if size <= aim or (size <= 100.0 * aim and size > 0.5 * before):
            scales[2] = top
            return finish(h, scales, law, table, rows, series)
        for i in range(32):
            state[i] += miss[i]
        if size > SLOW * before:
            if size > 2.0 * before and size > 1.0:
                return -1.0
            made = False
        before = size
    return -1.0


def finish(h: float, scales: Any, law: Any, table: Any, rows: Any, series: Any) -> float:
    """The series of a solved panel and the error of its inside, in tolerances; -1 where it is not finite."""
    steepest, total = 0.0, 0.0
    if law[HALF] > 0.0:
        for i in range(16):
            steepest = max(steepest, law[HALF] / rows[SLOPE, i] * (law[HALF] / rows[SLOPE, i]))
    for k in range(3):
        for j in range(17):
            series[k, j] = h * product(table[SERIES + j], rows[RATE_Q + k])
            total += series[k, j]
    if not abs(total) < inf:
        return -1.0
    q = max(abs(product(table[TAILS], rows[RATE_Q])), abs(product(table[TAILS + 1], rows[RATE_Q])))
    v = max(abs(product(table[TAILS], rows[RATE_V])), abs(product(table[TAILS + 1], rows[RATE_V])))
    error = max(h * q, h * v / scales[2] if scales[2] > 0.0 else 0.0)
    return float(error / (TAIL * max(scales[0], BLUR * steepest)))
