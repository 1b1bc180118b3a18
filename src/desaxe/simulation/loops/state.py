"""The state of a motion in plain loops, which are compiled (`compiled`): q, v and W of `..law`.

law      numbers: addresses of the executor's kernel (0 where the law has no closed form) and of the function
         that answers otherwise, half of the arc (see `coordinate`), limit angles; TORQUE, FORCE and
         SIDEWAYS (of F_X): kind and coefficients of the piece (see `closed_form` of a curve), of which
         FUNCTION has the address of a compiled function of t, theta and omega; under friction 1, addresses of
         the kernel of the guide and its packed inputs, mu times the signs of Y' and of the direction, the
         sign of the normal force, the branch; of one of many designs also theta0, omega_start and an energy
         that the loads suggest
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
RUBS, CONTACT, CONTACT_DATA, DRAG, PRESSED, LEANS, NUMBERS = 26, 27, 28, 29, 30, 31, 32
THETA0, OMEGA_START, ENERGY = NUMBERS, NUMBERS + 1, NUMBERS + 2
CONSTANT, OVER_THETA, OVER_OMEGA, KLOSS, FUNCTION = 0.0, 1.0, 2.0, 3.0, 4.0  # kinds of pieces
INERTIA, INERTIA_SLOPE, GRAVITY, GRAVITY_SLOPE, TRAVEL, BEND, POTENTIAL = range(7)  # what the kernel gives
OUTPUTS = 7
REDUCED = 1e4  # rad: larger angles are reduced before the kernel takes them
EDGE = 1e-13  # rad: see `coordinate`
START = 1e-2  # of the root of the energy that start and loads suggest: the least size of v


def reduced(theta: float) -> float:
    """An angle of the same sine and cosine that is not too large."""
    return theta if abs(theta) <= REDUCED else atan2(sin(theta), cos(theta))


def quantities(angles: Any, law: Any, data: Any, out: Any) -> int:
    """Fill in rows of quantities at angles; not 0 where the kernel leaves a point to its caller."""
    words: Any = zeros(20, int64)
    words[0], words[8] = address(angles), len(angles)
    for k in range(OUTPUTS):
        words[1 + k] = address(out[k])
    for k in range(1 + OUTPUTS):
        words[9 + k] = 8
    return call(int64(law[KERNEL]), words, words[8:], words[9:], data)


def at_angle(theta: float, law: Any, data: Any, out: Any) -> None:
    """Fill in the quantities at one angle."""
    angle: Any = empty(1)
    angle[0] = reduced(theta)
    quantities(angle, law, data, out)


def torque(t: float, theta: float, omega: float, law: Any) -> float:
    """The torque [N m] of the function at an address; NaN where it has none."""
    rows: Any = empty(4)
    rows[0], rows[1], rows[2] = t, theta, omega
    return float(rows[3]) if call(int64(law[TORQUE + 1]), rows, 1, 1) == 0 else nan


def place(q: float, law: Any) -> float:
    """The crank angle at a coordinate."""
    if law[HALF] > 0.0:
        return float(0.5 * (law[FIRST] + law[LAST]) + law[HALF] * sin(q))
    return float(min(max(q, law[FIRST] + EDGE), law[LAST] - EDGE))


def limits_of(law: Any) -> Any:
    """The coordinates of the limit angles."""
    return (-pi / 2, pi / 2) if law[HALF] > 0.0 else (law[FIRST], law[LAST])


def square(x: float) -> float:
    """x^2."""
    return x * x


def tell(t: float, q: float, v: float, law: Any, data: Any, history: Any, row: Any) -> None:
    """Angle, speed and acceleration of a state, into rows of histories."""
    out: Any = empty((OUTPUTS, 1))
    angle = place(q, law)
    at_angle(angle, law, data, out)
    inertia = out[INERTIA, 0]
    speed = v / sqrt(inertia)
    push = torque(t, angle, speed, law) + law[FORCE + 1] * out[TRAVEL, 0] - out[GRAVITY, 0]
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
    if law[HALF] > 0.0:
        lower = theta < 0.5 * (law[FIRST] + law[LAST])
        gap = theta - law[FIRST] if lower else law[LAST] - theta
        quarter = pi / 2 - 2.0 * asin(sqrt(gap / (2.0 * law[HALF])))
        y[0] = -quarter if lower else quarter
    else:
        y[0] = theta
    y[1] = law[OMEGA_START] * sqrt(inertia)
    y[2] = 0.0
    energy = max(0.5 * y[1] * y[1], abs(out[POTENTIAL, 0]), abs(out[GRAVITY, 0]), law[ENERGY])
    for k in range(9):
        here = abs(torque(t_end * k / 8, theta, law[OMEGA_START], law))
        if here < inf:
            energy = max(energy, here)
    if energy == 0.0:
        energy = inertia / square(t_end)
    scales[1] = START * sqrt(energy)
    return True


def energy_of(y: Any, law: Any, data: Any, sums: Any) -> float:
    """Kinetic and potential energy; sums: see `account`."""
    out: Any = empty((OUTPUTS, 1))
    at_angle(place(y[0], law), law, data, out)
    sums[6] = min(sums[6], out[INERTIA, 0])
    return float(0.5 * y[1] * y[1] + out[POTENTIAL, 0])


def account(y: Any, new: Any, law: Any, data: Any, sums: Any) -> None:
    """Take a step into account, and make it.

    sums: first energy, work done either way, largest kinetic energy, residual now and before, largest energy,
    least inertia.
    """
    energy = energy_of(new, law, data, sums)
    off = abs(energy - new[2] - sums[0])
    sums[1] += abs(new[2] - y[2])
    sums[2] = max(sums[2], 0.5 * new[1] * new[1])
    sums[4] = sums[3]
    sums[3] = max(sums[3], off) if off == off else sums[3]
    sums[5] = max(sums[5], abs(energy))
    for i in range(3):
        y[i] = new[i]
