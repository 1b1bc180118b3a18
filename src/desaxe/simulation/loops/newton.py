"""A panel of time in plain loops, which are compiled (`advance`): the law at its nodes, and Newton's method.

The matrix is made at the first guess, and again only where the iteration is slow.

law      numbers: addresses of the executor's kernel (0 where the law has no closed form) and of the function
         that answers otherwise, half of the arc (see `coordinate`), limit angles; TORQUE and FORCE: kind and
         coefficients of the piece (see `closed_form` of a curve); 1 where friction may change at any time
data     the packed inputs of the kernel
state    q at the nodes, then v
rows     values at the nodes, in the order below; the first six are the kernel's
table    places of the nodes; running integrals; the series of an integral; the last two terms of a series
scales   relative tolerance, largest |v| so far, the latter with this panel
"""

from __future__ import annotations

from math import cos, inf, nan, pi, sin, sqrt
from typing import TYPE_CHECKING

from numpy import empty, int64, zeros

from ...compiler.llvm.loops import address, apart, call
from .state import reduced

if TYPE_CHECKING:
    from typing import Any

KERNEL, ANSWER, HALF, FIRST, LAST, TORQUE, FORCE, RUBS, NUMBERS = 0, 1, 2, 3, 4, 5, 12, 19, 20
INERTIA, INERTIA_SLOPE, GRAVITY, GRAVITY_SLOPE, TRAVEL, BEND = range(6)
TIME, ANGLE, SLOPE, RATE_Q, RATE_V, RATE_W, SPEED = range(6, 13)
Q_BY_Q, Q_BY_V, V_BY_Q, V_BY_V, CURVED, ROWS = range(13, 19)
RUNNING, SERIES, TAILS = 1, 17, 34  # rows of the table
NONE, STOP = 1, 2  # the law has no value; an exception ends the motion
EDGE = 1e-13  # rad: see `coordinate`
ITERATIONS = 14
SLOW = 0.1  # of the step before: then the matrix is made anew
BLUR = 4e-16  # over cos(q)^2: the rounding of the rates next to a limit angle
ROUNDING = 4e-15  # of the size of a coordinate
TAIL = 30.0  # tolerances: the last terms of the rates, over the panel; its inside is far more exact


def piece(c: Any, theta: float, omega: float) -> Any:
    """A torque or force, and its derivatives by theta and omega."""
    if c[0] == 0.0:
        return c[1], 0.0, 0.0
    if c[0] == 3.0:  # Kloss's formula
        u = (1.0 - c[4] * omega / c[3]) / c[2]
        square = u * u
        bend = 2.0 * (1.0 - square) / ((1.0 + square) * (1.0 + square))
        return c[1] * 2.0 * u / (1.0 + square), 0.0, c[1] * bend * (-c[4] / (c[3] * c[2]))
    s = (theta if c[0] == 1.0 else omega) - c[1]
    value = c[2] + s * (c[3] + s * (c[4] + s * c[5]))
    slope = c[3] + s * (2.0 * c[4] + s * (3.0 * c[5]))
    return value, slope if c[0] == 1.0 else 0.0, slope if c[0] == 2.0 else 0.0


def places(state: Any, law: Any, rows: Any) -> None:
    """Angles and dtheta/dq, NaN beyond a limit angle at which the inertia grows."""
    half, middle = law[HALF], 0.5 * (law[FIRST] + law[LAST])
    for i in range(16):
        q = state[i]
        if half > 0.0:
            rows[ANGLE, i] = middle + half * sin(q)
            rows[SLOPE, i] = half * cos(q) if abs(q) < 0.5 * pi else nan
        else:
            rows[ANGLE, i] = min(max(q, law[FIRST] + EDGE), law[LAST] - EDGE)
            rows[SLOPE, i] = 1.0


def mechanism(law: Any, data: Any, rows: Any) -> int:
    """Fill in what depends on the angle alone; not 0 where the kernel leaves a point to its caller."""
    words: Any = zeros(17, int64)
    angles: Any = empty(16)
    for i in range(16):
        angles[i] = reduced(rows[ANGLE, i])
    words[0], words[7] = address(angles), 16
    for k in range(6):
        words[1 + k] = address(rows[k])
    for k in range(7):
        words[8 + k] = 8
    return call(int64(law[KERNEL]), words, words[7:], words[8:], data)


def law_at(state: Any, law: Any, data: Any, rows: Any, slopes: Any) -> int:
    """The rates at the nodes, and their derivatives if asked for; TIME is known."""
    if law[KERNEL] == 0.0:
        return call(int64(law[ANSWER]), state, rows, slopes)
    places(state, law, rows)
    if mechanism(law, data, rows) != 0:
        return call(int64(law[ANSWER]), state, rows, slopes)
    half, torque, force = law[HALF], law[TORQUE:FORCE], law[FORCE:RUBS]
    for i in range(16):
        theta, slope, inertia, travel = rows[ANGLE, i], rows[SLOPE, i], rows[INERTIA, i], rows[TRAVEL, i]
        root = sqrt(inertia) if inertia >= 0.0 else nan
        omega = state[16 + i] / root
        turned, turned_theta, turned_omega = piece(torque, theta, omega)
        pushed, pushed_theta, pushed_omega = piece(force, theta, omega)
        push = turned + pushed * travel
        speed, left = omega / slope, push - rows[GRAVITY, i]
        by_theta = turned_theta + pushed_theta * travel + pushed * rows[BEND, i] - rows[GRAVITY_SLOPE, i]
        by_omega = turned_omega + pushed_omega * travel
        steeper = 0.5 * rows[INERTIA_SLOPE, i] / inertia
        rows[RATE_Q, i], rows[RATE_V, i], rows[RATE_W, i] = speed, left / root, push * omega
        rows[SPEED, i], rows[CURVED, i] = omega, left / root / (root * slope)
        rows[Q_BY_Q, i] = -omega * steeper + (speed * sin(state[i]) / cos(state[i]) if half > 0.0 else 0.0)
        rows[Q_BY_V, i], rows[V_BY_V, i] = 1.0 / (root * slope), by_omega / inertia
        rows[V_BY_Q, i] = (by_theta - by_omega * omega * steeper - left * steeper) / root * slope
    return 0


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
    """Newton's matrix."""
    apart()
    for i in range(16):
        for j in range(16):
            share = -h * table[RUNNING + i, j]
            matrix[i, j], matrix[i, 16 + j] = share * rows[Q_BY_Q, j], share * rows[Q_BY_V, j]
            matrix[16 + i, j], matrix[16 + i, 16 + j] = share * rows[V_BY_Q, j], share * rows[V_BY_V, j]
    for i in range(32):
        matrix[i, i] += 1.0


def subtract(row: Any, share: float, other: Any, first: Any) -> None:
    """Subtract a multiple of a row from another, from a column on."""
    apart()
    for j in range(first, len(row)):
        row[j] -= share * other[j]


def factor(matrix: Any, order: Any) -> bool:
    """The triangular factors of a matrix, in its memory, and the order of its rows; False if it has none."""
    size = len(matrix)
    for k in range(size):
        best = k
        for i in range(k + 1, size):
            if abs(matrix[i, k]) > abs(matrix[best, k]):
                best = i
        order[k] = best
        if best != k:
            for j in range(size):
                matrix[k, j], matrix[best, j] = matrix[best, j], matrix[k, j]
        if not 0.0 < abs(matrix[k, k]) < inf:
            return False
        for i in range(k + 1, size):
            share = matrix[i, k] / matrix[k, k]
            matrix[i, k] = share
            if share != 0.0:
                subtract(matrix[i], share, matrix[k], k + 1)
    return True


def back(matrix: Any, order: Any, x: Any) -> None:
    """Solve for a right-hand side, in its memory."""
    size = len(matrix)
    for k in range(size):
        best = int64(order[k])
        x[k], x[best] = x[best], x[k]
    for i in range(size):
        total = x[i]
        for j in range(i):
            total -= matrix[i, j] * x[j]
        x[i] = total
    for k in range(size):
        i = size - 1 - k
        total = x[i]
        for j in range(i + 1, size):
            total -= matrix[i, j] * x[j]
        x[i] = total / matrix[i, i]


def newton(
    t: float, h: float, y: Any, state: Any, scales: Any, law: Any, data: Any, table: Any, rows: Any,
    matrix: Any, series: Any,
) -> float:  # fmt: skip
    """Solve a panel, whose state is a guess: the error of its inside, -1 where there is none, -2 to stop."""
    order: Any = empty(32)
    miss: Any = empty(32)
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
            fill_matrix(h, rows, table, matrix)
            if not factor(matrix, order):
                return -1.0
            made = True
        back(matrix, order, miss)
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
