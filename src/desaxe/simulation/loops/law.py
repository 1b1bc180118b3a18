"""The law of a motion in plain loops, which are compiled (`compiled`): the rates of q, v and W (see `..law`).

law      numbers: addresses of the executor's kernel (0: there is none) and of what answers in its place; half
         of the arc (see `coordinate`), limit angles; under friction 1, addresses of the kernel of the guide
         and its packed inputs, mu times the signs of Y' and of the direction, the sign of the normal force,
         the branch, mu; the direction, the sign of Y', and the least Y' that has one; the distance of
         instants at which a function is compared with the panels; whether a crank at rest waits (0 for ever,
         1 to the end, 2 for a load that knows the time); 1 with functions, 2 with functions that have pieces;
         an energy that the loads suggest; theta0, omega_start; the number of terms; the terms
term     of the torque, of F_Y or of F_X: which of them, its factor; first row, rows and period of its pieces;
         the angle at which the present one ends; kind and coefficients of that (SLOTS numbers)
data     the packed inputs of the kernel
state    q at the nodes, then v
rows     values at the nodes, in the order below
"""

from __future__ import annotations

from math import asin, atan2, cos, inf, nan, pi, sin, sqrt
from typing import TYPE_CHECKING

from numpy import empty, int64, zeros

from ...compiler.llvm.loops import address, apart, call

if TYPE_CHECKING:
    from typing import Any

KERNEL, ANSWER, HALF, FIRST, LAST, RUBS, CONTACT, CONTACT_DATA, DRAG, PRESSED, LEANS, MU = range(12)
DIRECTION, SIDE, TINY, PROBE, WAITS, CALLS, ENERGY, THETA0, OMEGA_START, COUNT, TERMS = range(12, 23)
ARM, FACTOR, SHEET, PIECES, PERIOD, END, KIND = range(7)  # of a term
SLOTS = 7
TERM = KIND + SLOTS
TORQUE, FORCE, SIDEWAYS = 0.0, 1.0, 2.0  # what a term belongs to
CONSTANT, OVER_THETA, OVER_OMEGA, KLOSS, FUNCTION, OVER_Y = 0.0, 1.0, 2.0, 3.0, 4.0, 5.0  # kinds of pieces
# what the kernel gives
INERTIA, INERTIA_SLOPE, GRAVITY, GRAVITY_SLOPE, TRAVEL, BEND, POTENTIAL, POSITION = range(8)
OUTPUTS = 8
TIME, ANGLE, SPEED, PUSH = range(OUTPUTS, OUTPUTS + 4)
SLOPE, RATE_Q, RATE_V, RATE_W, Q_BY_Q, Q_BY_V, V_BY_Q, V_BY_V, CURVED = range(OUTPUTS + 4, OUTPUTS + 13)
BY_THETA, BY_OMEGA, NORMAL, WEDGE, UNSURE, BENT, PUSHED, ASIDE, ROWS = range(OUTPUTS + 13, OUTPUTS + 22)
NONE, STOP = 1, 2  # the law has no value; an exception ends the motion
REDUCED = 1e4  # rad: larger angles are reduced before the kernel takes them
EDGE = 1e-13  # rad: see `coordinate`
START = 1e-2  # of the root of the energy that start and loads suggest: the least size of v
NOISE = 1e-12  # of the terms of the normal force: below it, its sign is rounding
STEP = 1e-7  # of an angle or a speed: a difference has seven digits


def reduced(theta: float) -> float:
    """An angle of the same sine and cosine that is not too large."""
    return theta if abs(theta) <= REDUCED else atan2(sin(theta), cos(theta))


def quantities(angles: Any, law: Any, data: Any, out: Any) -> int:
    """Fill in rows of quantities at angles; not 0 where the kernel leaves a point to its caller."""
    words: Any = zeros(20, int64)
    words[0], words[1 + OUTPUTS] = address(angles), len(angles)
    for k in range(OUTPUTS):
        words[1 + k] = address(out[k])
    for k in range(1 + OUTPUTS):
        words[2 + OUTPUTS + k] = 8
    return call(int64(law[KERNEL]), words, words[1 + OUTPUTS :], words[2 + OUTPUTS :], data)


# ---- torque and forces ------------------------------------------------------------------------------


def piece(c: Any, theta: float, omega: float, Y: float) -> Any:
    """A torque or force, and its derivatives with respect to theta (but for Y), omega and Y."""
    if c[0] == CONSTANT:
        return c[1], 0.0, 0.0, 0.0
    if c[0] == KLOSS:
        u = (1.0 - c[4] * omega / c[3]) / c[2]
        square = u * u
        bend = 2.0 * (1.0 - square) / ((1.0 + square) * (1.0 + square))
        return c[1] * 2.0 * u / (1.0 + square), 0.0, c[1] * bend * (-c[4] / (c[3] * c[2])), 0.0
    s = (theta if c[0] == OVER_THETA else omega if c[0] == OVER_OMEGA else c[6] * Y) - c[1]
    value = c[2] + s * (c[3] + s * (c[4] + s * c[5]))
    slope = c[3] + s * (2.0 * c[4] + s * (3.0 * c[5]))
    by_theta, by_omega = 0.0, 0.0
    if c[0] == OVER_THETA:
        by_theta = slope
    elif c[0] == OVER_OMEGA:
        by_omega = slope
    return value, by_theta, by_omega, c[6] * slope if c[0] == OVER_Y else 0.0


def function_at(c: Any, rows: Any, slopes: Any, one: Any) -> int:
    """Values of a function at the nodes, and differences if asked for; it takes the ends of its piece too."""
    moved: Any = empty((5, 16))
    moved[4, 0], moved[4, 1], step = c[2], c[3], STEP
    for i in range(16):
        step = max(step, STEP * abs(rows[SPEED, i]))
    for k in range(3):
        if k > 0 and (slopes == 0 or c[3 + k] == 0.0):
            for i in range(16):
                one[k, i] = 0.0
            continue
        for i in range(16):
            moved[0, i], moved[1, i], moved[2, i] = rows[TIME, i], rows[ANGLE, i], rows[SPEED, i]
            if k == 1:
                moved[1, i] += STEP
            elif k == 2:
                moved[2, i] += step
        code = call(int64(c[1]), moved, 16, 16)
        if code != 0:
            return code
        for i in range(16):
            one[k, i] = moved[3, i]
            if k > 0:
                slope = (moved[3, i] - one[0, i]) / (STEP if k == 1 else step)
                one[k, i] = slope if abs(slope) < inf else 0.0  # beyond a limit angle there is none
    return 0


def add(arm: float, factor: float, rows: Any, one: Any) -> None:
    """Add a torque or force and its derivatives to what pushes the crank."""
    apart()
    if arm == SIDEWAYS:
        for i in range(16):
            rows[ASIDE, i] += factor * one[0, i]
    elif arm == FORCE:
        for i in range(16):
            value, travel = factor * one[0, i], rows[TRAVEL, i]
            rows[PUSHED, i] += value
            rows[PUSH, i] += value * travel
            rows[BY_THETA, i] += factor * one[1, i] * travel + value * rows[BEND, i]
            rows[BY_OMEGA, i] += factor * one[2, i] * travel
    else:
        for i in range(16):
            rows[PUSH, i] += factor * one[0, i]
            rows[BY_THETA, i] += factor * one[1, i]
            rows[BY_OMEGA, i] += factor * one[2, i]


def pushes(law: Any, rows: Any, slopes: Any) -> int:
    """Fill in the torque of all that pushes the crank at the nodes; its derivatives with those of gravity."""
    one: Any = empty((3, 16))
    for i in range(16):
        rows[PUSH, i], rows[BY_THETA, i], rows[BY_OMEGA, i] = 0.0, -rows[GRAVITY_SLOPE, i], 0.0
        rows[PUSHED, i], rows[ASIDE, i] = 0.0, 0.0
    for n in range(int64(law[COUNT])):
        at = TERMS + TERM * n
        if law[at + ARM] == SIDEWAYS and law[RUBS] == 0.0:
            continue
        c = law[at + KIND : at + TERM]
        if c[0] == FUNCTION:
            code = function_at(c, rows, slopes, one)
            if code != 0:
                return code
        else:
            for i in range(16):
                value, by_theta, by_omega, by_Y = piece(c, rows[ANGLE, i], rows[SPEED, i], rows[POSITION, i])
                one[0, i], one[1, i], one[2, i] = value, by_theta + by_Y * rows[TRAVEL, i], by_omega
        add(law[at + ARM], law[at + FACTOR], rows, one)
    return 0


# ---- the guide --------------------------------------------------------------------------------------


def guide_at(angles: Any, law: Any, rows: Any, guide: Any) -> int:
    """The normal force without friction at alpha = 0, its derivatives, and phi: rows."""
    words: Any = zeros(20, int64)
    words[0], words[1] = address(angles), address(rows[SPEED])
    words[2], words[3], words[8] = address(rows[ASIDE]), address(rows[PUSHED]), 16
    for k in range(4):
        words[4 + k] = address(guide[k])
    for k in range(8):
        words[9 + k] = 8
    return call(int64(law[CONTACT]), words, words[8:], words[9:], int64(law[CONTACT_DATA]))


def rub(law: Any, rows: Any, guide: Any) -> None:
    """Subtract the torque of friction at the nodes from the push; fill in the normal force without it.

    Derivatives are of its torque by alpha and omega alone: good enough for an iteration.
    """
    for i in range(16):
        inertia, omega = rows[INERTIA, i], rows[SPEED, i]
        by_alpha, bent = guide[1, i] / inertia, 0.5 * rows[INERTIA_SLOPE, i] * omega * omega
        moved = by_alpha * (rows[PUSH, i] - rows[GRAVITY, i] - bent)
        free = guide[0, i] + moved
        rows[UNSURE, i] = NOISE * (abs(guide[0, i]) + abs(moved))
        arm = law[DRAG] * rows[TRAVEL, i]
        lean = law[LEANS] * sin(guide[3, i]) / cos(guide[3, i])
        wedge = lean * law[DRAG] - arm * by_alpha
        rows[NORMAL, i], rows[WEDGE, i] = law[PRESSED] * free, law[PRESSED] * wedge
        share = arm * law[PRESSED] / (1.0 - law[PRESSED] * wedge)
        rows[PUSH, i] -= share * free
        by_omega = rows[BY_OMEGA, i]
        rows[BY_THETA, i] *= 1.0 - share * by_alpha
        rows[BY_OMEGA, i] -= share * (guide[2, i] + (by_omega - rows[INERTIA_SLOPE, i] * omega) * by_alpha)


# ---- the rates --------------------------------------------------------------------------------------


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


def still_at(state: Any, law: Any, data: Any, rows: Any, angles: Any) -> int:
    """The quantities at the nodes; not 0 where they have none."""
    places(state, law, rows)
    for i in range(16):
        angles[i] = reduced(rows[ANGLE, i])
    code = NONE if law[KERNEL] == 0.0 else quantities(angles, law, data, rows)
    return call(int64(law[ANSWER]), rows, 0, 0) if code != 0 and law[ANSWER] != 0.0 else 0


def law_at(state: Any, law: Any, data: Any, rows: Any, slopes: Any) -> int:
    """The rates at the nodes, and their derivatives if asked for; TIME is known."""
    angles: Any = empty(16)
    code = still_at(state, law, data, rows, angles)
    if code != 0:
        return code
    for i in range(16):
        rows[SPEED, i] = state[16 + i] / (sqrt(rows[INERTIA, i]) if rows[INERTIA, i] >= 0.0 else nan)
    code = pushes(law, rows, slopes)
    if law[RUBS] > 0.0 and code == 0:
        guide: Any = empty((4, 16))
        if guide_at(angles, law, rows, guide) != 0:
            code = call(int64(law[ANSWER]), rows, guide, 0)
        rub(law, rows, guide)
    if code == 0:
        fill_rates(law, rows)
    return code


def fill_rates(law: Any, rows: Any) -> None:
    """The rates at the nodes and their derivatives, from inertia and push."""
    apart()
    for i in range(16):
        slope, inertia, omega = rows[SLOPE, i], rows[INERTIA, i], rows[SPEED, i]
        root, left, by_omega = sqrt(max(inertia, 0.0)), rows[PUSH, i] - rows[GRAVITY, i], rows[BY_OMEGA, i]
        gain, speed, steeper = 1.0 / (root * slope), omega / slope, 0.5 * rows[INERTIA_SLOPE, i] / inertia
        rows[RATE_Q, i], rows[RATE_V, i], rows[RATE_W, i] = speed, left / root, rows[PUSH, i] * omega
        rows[CURVED, i] = left / root * gain
        rows[Q_BY_Q, i], rows[Q_BY_V, i], rows[V_BY_V, i] = -omega * steeper, gain, by_omega / inertia
        rows[V_BY_Q, i] = (rows[BY_THETA, i] - (by_omega * omega + left) * steeper) * slope / root
    if law[HALF] > 0.0:
        for i in range(16):
            rows[Q_BY_Q, i] += rows[RATE_Q, i] * rows[BENT, i]


def motion(t: float, y: Any, law: Any, data: Any, rows: Any, still: Any) -> int:
    """The rates at an instant, at every node of `rows`."""
    for i in range(16):
        rows[TIME, i], still[i], still[16 + i] = t, y[0], y[1]
    return law_at(still, law, data, rows, 0)


def acceleration(rows: Any, i: Any) -> float:
    """The acceleration of the crank at a node."""
    inertia, omega = rows[INERTIA, i], rows[SPEED, i]
    bent = 0.5 * rows[INERTIA_SLOPE, i] * omega * omega
    return float((rows[RATE_V, i] * sqrt(inertia) - bent) / inertia)


def values(laws: Any, which: Any, t: Any, q: Any, v: Any, data: Any, out: Any) -> int:
    """The rows of states at instants, each under one of several laws; STOP where an exception ends it all."""
    state, rows = empty(32), empty((ROWS, 16))
    first, count = 0, len(t)
    while first < count:
        last = first + 1
        while last < count and last < first + 16 and which[last] == which[first]:
            last += 1
        for i in range(16):
            k = first + i if first + i < last else last - 1
            rows[TIME, i], state[i], state[16 + i] = t[k], q[k], v[k]
        code = law_at(state, laws[int64(which[first])], data, rows, 0)
        if code == STOP:
            return STOP
        for j in range(ROWS):
            for k in range(first, last):
                out[j, k] = rows[j, k - first] if code == 0 else nan
        first = last
    return 0


# ---- coordinates ------------------------------------------------------------------------------------


def place(q: float, law: Any) -> float:
    """The crank angle at a coordinate."""
    if law[HALF] > 0.0:
        return float(0.5 * (law[FIRST] + law[LAST]) + law[HALF] * sin(q))
    return float(min(max(q, law[FIRST] + EDGE), law[LAST] - EDGE))


def coordinate(theta: float, law: Any) -> float:
    """The coordinate of an angle; measured from the nearer limit, so that no digit is lost."""
    half = law[HALF]
    if half == 0.0:
        return theta
    lower = theta < 0.5 * (law[FIRST] + law[LAST])
    gap = theta - law[FIRST] if lower else law[LAST] - theta
    quarter = pi / 2 - 2.0 * asin(sqrt(max(gap, 0.0) / (2.0 * half)))
    return -quarter if lower else quarter


def start(law: Any, data: Any, t_end: float, y: Any, scales: Any, rows: Any) -> int:
    """The state at the start, and the least size of v, from the energy [J] that the motion will have.

    That of the start, of gravity, of what torque and load do in a radian and a crank length; where all are
    nothing, that of a turn in t_end. Not 0 without an inertia to move.
    """
    state, angles = empty(32), empty(16)
    y[0], y[1], y[2] = coordinate(law[THETA0], law), 0.0, 0.0
    for i in range(16):
        rows[TIME, i], state[i] = t_end * min(i, 8) / 8, y[0]
    code = still_at(state, law, data, rows, angles)
    inertia = rows[INERTIA, 0]
    if code != 0 or not (0.0 < inertia < inf):
        return max(code, NONE)
    y[1] = law[OMEGA_START] * sqrt(inertia)
    for i in range(16):
        state[16 + i] = y[1]
    energy = max(0.5 * y[1] * y[1], abs(rows[POTENTIAL, 0]), abs(rows[GRAVITY, 0]), law[ENERGY])
    code = law_at(state, law, data, rows, 0)
    if code == STOP:
        return STOP
    for i in range(9):
        force = abs(rows[PUSHED, i])
        here = max(abs(rows[PUSH, i]) - force * abs(rows[TRAVEL, i]), force * 1e9 * law[TINY])
        if code == 0 and here < inf:
            energy = max(energy, here)
    if energy == 0.0:
        energy = inertia / (t_end * t_end)
    scales[1] = START * sqrt(energy)
    return 0
