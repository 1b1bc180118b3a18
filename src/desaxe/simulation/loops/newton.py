"""A panel of time in plain loops, which are compiled (`advance`): the law at its nodes, and Newton's method.

The matrix is made at the first guess, and again only where the iteration is slow.

state    q at the nodes, then v
rows     values at the nodes, in the order below, behind those of the kernel (see `state`)
table    places of the nodes; running integrals; the series of an integral; the last two terms of a series;
         values at both ends; the series of values
scales   relative tolerance, largest |v| so far, the latter with this panel
"""

from __future__ import annotations

from math import cos, inf, nan, pi, sin, sqrt
from typing import TYPE_CHECKING

from numpy import empty, int64, zeros

from ...compiler.llvm.loops import address, apart, call
from .state import (
    ANSWER,
    BEND,
    CONSTANT,
    CONTACT,
    CONTACT_DATA,
    DRAG,
    EDGE,
    FIRST,
    FORCE,
    FUNCTION,
    GRAVITY,
    GRAVITY_SLOPE,
    HALF,
    INERTIA,
    INERTIA_SLOPE,
    KERNEL,
    LAST,
    LEANS,
    OUTPUTS,
    POSITION,
    PRESSED,
    RUBS,
    SIDEWAYS,
    TORQUE,
    TRAVEL,
    piece,
    quantities,
    reduced,
)

if TYPE_CHECKING:
    from typing import Any

TIME, ANGLE, SPEED, TURNED = range(OUTPUTS, OUTPUTS + 4)  # as a compiled torque takes them
SLOPE, RATE_Q, RATE_V, RATE_W, Q_BY_Q, Q_BY_V, V_BY_Q, V_BY_V, CURVED = range(OUTPUTS + 4, OUTPUTS + 13)
BY_THETA, BY_OMEGA, NORMAL, WEDGE, UNSURE, BENT, ROWS = range(OUTPUTS + 13, OUTPUTS + 20)
RUNNING, SERIES, TAILS, ENDS, POINTS, ACROSS = 1, 17, 34, 36, 38, 54  # rows of the table
NONE, STOP = 1, 2  # the law has no value; an exception ends the motion
ITERATIONS = 14
SLOW = 0.1  # of the step before: then the matrix is made anew
SMALL_PIVOT = 0.5  # of a matrix that differs from 1 by the length of a panel: below it rows are exchanged
CALM = 0.02  # of a coordinate, by a panel: then steps without a matrix do
BLUR = 4e-16  # over cos(q)^2: the rounding of the rates next to a limit angle
ROUNDING = 4e-15  # of the size of a coordinate
DEVIATES = 30.0  # tolerances: by so much a rate differs where nodes have missed a jump
TAIL = 30.0  # tolerances: the last terms of the rates, over the panel; its inside is far more exact
NOISE = 1e-12  # of the terms of the normal force: below it, its sign is rounding
STEP = 1e-7  # of an angle or a speed: a difference has seven digits


def function_at(law: Any, rows: Any, slopes: Any) -> int:
    """The torque of a compiled function at the nodes, and its differences if asked for."""
    function = int64(law[TORQUE + 1])
    code = call(function, rows[TIME], 16, 16)
    if code != 0 or slopes == 0:
        return code
    moved: Any = empty((4, 16))
    for k in range(2):
        step = STEP
        if k == 1:
            for i in range(16):
                step = max(step, STEP * abs(rows[SPEED, i]))
        for i in range(16):
            moved[0, i], moved[1, i], moved[2, i] = rows[TIME, i], rows[ANGLE, i], rows[SPEED, i]
            moved[1 + k, i] += step
        if call(function, moved[0], 16, 16) != 0:
            return NONE
        for i in range(16):
            rows[BY_THETA + k, i] = (moved[3, i] - rows[TURNED, i]) / step
    return 0


def places(state: Any, law: Any, rows: Any) -> None:
    """Angles and dtheta/dq, NaN beyond a limit angle at which the inertia grows."""
    half, middle = law[HALF], 0.5 * (law[FIRST] + law[LAST])
    for i in range(16):
        q = state[i]
        if half > 0.0:
            rows[ANGLE, i] = middle + half * sin(q)
            rows[SLOPE, i] = half * cos(q) if abs(q) < 0.5 * pi else nan
            rows[BENT, i] = sin(q) / cos(q)
        else:
            rows[ANGLE, i] = min(max(q, law[FIRST] + EDGE), law[LAST] - EDGE)
            rows[SLOPE, i] = 1.0


def pushes(law: Any, rows: Any, slopes: Any) -> int:
    """The torque at the nodes and that of the force and of gravity, with their derivatives."""
    if law[TORQUE] == FUNCTION:
        code = function_at(law, rows, slopes)
        if code != 0:
            return code
    pushed = law[FORCE] != CONSTANT or law[FORCE + 1] != 0.0
    for i in range(16):
        theta, omega, Y, travel = rows[ANGLE, i], rows[SPEED, i], rows[POSITION, i], rows[TRAVEL, i]
        if law[TORQUE] != FUNCTION:
            value, by_theta, by_omega, by_Y = piece(law[TORQUE:FORCE], theta, omega, Y)
            rows[TURNED, i], rows[BY_THETA, i], rows[BY_OMEGA, i] = value, by_theta + by_Y * travel, by_omega
        if pushed:
            value, by_theta, by_omega, by_Y = piece(law[FORCE:SIDEWAYS], theta, omega, Y)
            rows[TURNED, i] += value * travel
            rows[BY_THETA, i] += (by_theta + by_Y * travel) * travel + value * rows[BEND, i]
            rows[BY_OMEGA, i] += by_omega * travel
        rows[BY_THETA, i] -= rows[GRAVITY_SLOPE, i]
    return 0


def law_at(state: Any, law: Any, data: Any, rows: Any, slopes: Any) -> int:
    """The rates at the nodes, and their derivatives if asked for; TIME is known."""
    if law[KERNEL] == 0.0:
        return call(int64(law[ANSWER]), state, rows, slopes)
    angles: Any = empty(16)
    places(state, law, rows)
    for i in range(16):
        angles[i] = reduced(rows[ANGLE, i])
    if quantities(angles, law, data, rows) != 0 and law[ANSWER] != 0.0:
        return call(int64(law[ANSWER]), state, rows, slopes)
    for i in range(16):
        rows[SPEED, i] = state[16 + i] / (sqrt(rows[INERTIA, i]) if rows[INERTIA, i] >= 0.0 else nan)
    code = pushes(law, rows, slopes)
    if law[RUBS] > 0.0 and code == 0:
        guide: Any = empty((4, 16))
        if guide_at(angles, law, rows, guide) != 0:
            return call(int64(law[ANSWER]), state, rows, slopes)
        rub(law, rows, guide)
    if code == 0:
        fill_rates(law, rows)
    return code


def guide_at(angles: Any, law: Any, rows: Any, guide: Any) -> int:
    """The normal force without friction at alpha = 0, its derivatives by alpha and omega, and phi: rows."""
    words: Any = zeros(20, int64)
    forces: Any = empty((2, 16))
    for i in range(16):
        theta, omega, Y = rows[ANGLE, i], rows[SPEED, i], rows[POSITION, i]
        forces[0, i] = piece(law[SIDEWAYS:RUBS], theta, omega, Y)[0]
        forces[1, i] = piece(law[FORCE:SIDEWAYS], theta, omega, Y)[0]
    words[0], words[1] = address(angles), address(rows[SPEED])
    words[2], words[3], words[8] = address(forces[0]), address(forces[1]), 16
    for k in range(4):
        words[4 + k] = address(guide[k])
    for k in range(8):
        words[9 + k] = 8
    return call(int64(law[CONTACT]), words, words[8:], words[9:], int64(law[CONTACT_DATA]))


def rub(law: Any, rows: Any, guide: Any) -> None:
    """What friction takes at the nodes, off the push and its derivatives; the normal force without it.

    Derivatives are of its torque by alpha and omega alone: good enough for an iteration.
    """
    for i in range(16):
        inertia, omega = rows[INERTIA, i], rows[SPEED, i]
        by_alpha, bent = guide[1, i] / inertia, 0.5 * rows[INERTIA_SLOPE, i] * omega * omega
        moved = by_alpha * (rows[TURNED, i] - rows[GRAVITY, i] - bent)
        free = guide[0, i] + moved
        rows[UNSURE, i] = NOISE * (abs(guide[0, i]) + abs(moved))
        arm = law[DRAG] * rows[TRAVEL, i]
        lean = law[LEANS] * sin(guide[3, i]) / cos(guide[3, i])
        wedge = lean * law[DRAG] - arm * by_alpha
        rows[NORMAL, i], rows[WEDGE, i] = law[PRESSED] * free, law[PRESSED] * wedge
        share = arm * law[PRESSED] / (1.0 - law[PRESSED] * wedge)
        rows[TURNED, i] -= share * free
        by_omega = rows[BY_OMEGA, i]
        rows[BY_THETA, i] *= 1.0 - share * by_alpha
        rows[BY_OMEGA, i] -= share * (guide[2, i] + (by_omega - rows[INERTIA_SLOPE, i] * omega) * by_alpha)


def fill_rates(law: Any, rows: Any) -> None:
    """The rates at the nodes and their derivatives, from inertia and push."""
    apart()
    for i in range(16):
        slope, inertia, omega = rows[SLOPE, i], rows[INERTIA, i], rows[SPEED, i]
        root, left, by_omega = sqrt(max(inertia, 0.0)), rows[TURNED, i] - rows[GRAVITY, i], rows[BY_OMEGA, i]
        gain, speed, steeper = 1.0 / (root * slope), omega / slope, 0.5 * rows[INERTIA_SLOPE, i] / inertia
        rows[RATE_Q, i], rows[RATE_V, i], rows[RATE_W, i] = speed, left / root, rows[TURNED, i] * omega
        rows[CURVED, i] = left / root * gain
        rows[Q_BY_Q, i], rows[Q_BY_V, i], rows[V_BY_V, i] = -omega * steeper, gain, by_omega / inertia
        rows[V_BY_Q, i] = (rows[BY_THETA, i] - (by_omega * omega + left) * steeper) * slope / root
    if law[HALF] > 0.0:
        for i in range(16):
            rows[Q_BY_Q, i] += rows[RATE_Q, i] * rows[BENT, i]


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


def calm(h: float, rows: Any) -> bool:
    """True where a panel is so short that what it changes hardly acts on its rates."""
    most = 0.0
    for i in range(16):
        across = h * h * abs(rows[Q_BY_V, i] * rows[V_BY_Q, i])
        most = max(most, h * abs(rows[Q_BY_Q, i]) + h * abs(rows[V_BY_V, i]) + across)
    return most < CALM


def newton(
    t: float, h: float, y: Any, state: Any, scales: Any, law: Any, data: Any, table: Any, rows: Any,
    matrix: Any, series: Any,
) -> float:  # fmt: skip
    """Solve a panel, whose state is a guess: the error of its inside, -1 where there is none, -2 to stop."""
    order: Any = empty(32)
    miss: Any = empty(32)
    lower: Any = empty((32, 32))
    aim, before, made, simple = max(0.02 * scales[0], ROUNDING), inf, False, False
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
            made, simple = True, calm(h, rows)
            if not simple:
                fill_matrix(h, rows, table, matrix)
                if not factor(matrix, lower, order):
                    return -1.0
        if not simple:
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
