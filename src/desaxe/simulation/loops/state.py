"""The state of a motion in plain loops, which are compiled (`compiled`): q, v and W of `..law`.

law      numbers: addresses of the executor's kernel (0 where the law has no closed form) and of the function
         that answers otherwise, half of the arc (see `coordinate`), limit angles; TORQUE, FORCE and
         SIDEWAYS (of F_X): kind and coefficients of the piece, of which FUNCTION has the address of a
         compiled function of t, theta and omega; under friction 1, addresses of the kernel of the guide and
         its packed inputs, mu times the signs of Y' and of the direction, the sign of the normal force, the
         branch, mu; the direction, the sign of Y', and the least Y' that has one; SHEETS: first row, rows
         and period of the pieces of each load; the address of a function that chooses pieces otherwise; the
         distance of instants at which a function is compared with the panels; NEXT: the angles at which the
         pieces end; whether a crank at rest waits (0 for ever, 1 to the end, 2 for a load that knows the
         time); of one of many designs theta0, omega_start; an energy that the loads suggest
data     the packed inputs of the kernel
"""

from __future__ import annotations

from math import asin, atan2, cos, inf, nan, pi, sin, sqrt
from typing import TYPE_CHECKING

from numpy import empty, int64, zeros

from ...compiler.llvm.loops import address, call

if TYPE_CHECKING:
    from typing import Any

KERNEL, ANSWER, HALF, FIRST, LAST, TORQUE, FORCE, SIDEWAYS = 0, 1, 2, 3, 4, 5, 12, 19
RUBS, CONTACT, CONTACT_DATA, DRAG, PRESSED, LEANS, MU, DIRECTION, SIDE, TINY = range(26, 36)
SHEETS, CHOOSE, PROBE, NEXT, WAITS, NUMBERS = 36, 45, 46, 47, 50, 51
THETA0, OMEGA_START, ENERGY = NUMBERS, NUMBERS + 1, NUMBERS + 2
SLOTS = 7  # numbers of a piece
CONSTANT, OVER_THETA, OVER_OMEGA, KLOSS, FUNCTION, OVER_Y = 0.0, 1.0, 2.0, 3.0, 4.0, 5.0  # kinds of pieces
# what the kernel gives
INERTIA, INERTIA_SLOPE, GRAVITY, GRAVITY_SLOPE, TRAVEL, BEND, POTENTIAL, POSITION = range(8)
OUTPUTS = 8
REDUCED = 1e4  # rad: larger angles are reduced before the kernel takes them
EDGE = 1e-13  # rad: see `coordinate`
START = 1e-2  # of the root of the energy that start and loads suggest: the least size of v


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


def at_angle(theta: float, law: Any, data: Any, out: Any) -> None:
    """Fill in the quantities at one angle."""
    angle: Any = empty(1)
    angle[0] = reduced(theta)
    quantities(angle, law, data, out)


def piece(c: Any, theta: float, omega: float, Y: float) -> Any:
    """A torque or force, and its derivatives by theta (but for Y), omega and Y."""
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


def torque(t: float, theta: float, omega: float, Y: float, law: Any) -> float:
    """The torque [N m]; NaN where a function has none."""
    if law[TORQUE] != FUNCTION:
        return float(piece(law[TORQUE:FORCE], theta, omega, Y)[0])
    rows: Any = empty(4)
    rows[0], rows[1], rows[2] = t, theta, omega
    return float(rows[3]) if call(int64(law[TORQUE + 1]), rows, 1, 1) == 0 else nan


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


def tell(t: float, q: float, v: float, law: Any, data: Any, history: Any, row: Any) -> None:
    """Angle, speed and acceleration of a state, into rows of histories."""
    out: Any = empty((OUTPUTS, 1))
    angle = place(q, law)
    at_angle(angle, law, data, out)
    inertia = out[INERTIA, 0]
    speed = v / sqrt(inertia)
    Y = out[POSITION, 0]
    load = piece(law[FORCE:SIDEWAYS], angle, speed, Y)[0] * out[TRAVEL, 0]
    push = torque(t, angle, speed, Y, law) + load - out[GRAVITY, 0]
    history[0, row], history[1, row] = angle, speed
    history[2, row] = (push - 0.5 * out[INERTIA_SLOPE, 0] * speed * speed) / inertia


def start(law: Any, data: Any, t_end: float, y: Any, scales: Any) -> bool:
    """The state at the start and the least size of v; whether there is an inertia to move."""
    out: Any = empty((OUTPUTS, 1))
    theta = law[THETA0]
    at_angle(theta, law, data, out)
    inertia = out[INERTIA, 0]
    if not (0.0 < inertia < inf):
        return False
    y[0] = coordinate(theta, law)
    y[1] = law[OMEGA_START] * sqrt(inertia)
    y[2] = 0.0
    energy = max(0.5 * y[1] * y[1], abs(out[POTENTIAL, 0]), abs(out[GRAVITY, 0]), law[ENERGY])
    for k in range(9):
        here = abs(torque(t_end * k / 8, theta, law[OMEGA_START], out[POSITION, 0], law))
        if here < inf:
            energy = max(energy, here)
    if energy == 0.0:
        energy = inertia / (t_end * t_end)
    scales[1] = START * sqrt(energy)
    return True


def energy_of(y: Any, law: Any, data: Any) -> float:
    """Kinetic and potential energy."""
    out: Any = empty((OUTPUTS, 1))
    at_angle(place(y[0], law), law, data, out)
    return float(0.5 * y[1] * y[1] + out[POTENTIAL, 0])


def account(y: Any, new: Any, law: Any, data: Any, sums: Any) -> None:
    """Take a step into account, and make it.

    sums: first energy, work done either way, largest kinetic energy, residual now and before, largest energy.
    """
    energy = energy_of(new, law, data)
    off = abs(energy - new[2] - sums[0])
    sums[1] += abs(new[2] - y[2])
    sums[2] = max(sums[2], 0.5 * new[1] * new[1])
    sums[4] = sums[3]
    sums[3] = max(sums[3], off) if off == off else sums[3]
    sums[5] = max(sums[5], abs(energy))
    for i in range(3):
        y[i] = new[i]
