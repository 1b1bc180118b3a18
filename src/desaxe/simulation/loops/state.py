"""The state of a motion in plain loops, which are compiled (`compiled`): q, v and W of `law`.

The mechanism is a kernel of the executor, at the address KERNEL of a setup.

p        rows of a design: the packed inputs of the kernel, on its branch and on the other one
setup    a row per design: branch, limit angles, half of the arc (see `coordinate`), the address of the
         torque, F_Y, theta0, omega_start, an energy that the loads suggest, the address of the kernel
scales   relative and absolute tolerances and sizes of q, v and W
"""

from __future__ import annotations

from math import asin, atan2, copysign, cos, inf, nan, pi, sin, sqrt
from typing import TYPE_CHECKING

from numpy import empty, int64, zeros

from ...compiler.llvm.loops import address, call

if TYPE_CHECKING:
    from typing import Any

INERTIA, GRAVITY, TRAVEL, BEND, POTENTIAL = range(5)  # what the kernel gives
KERNEL = 9  # its place in a setup
REDUCED = 1e4  # rad: larger angles are reduced before the kernel takes them


def reduced(theta: float) -> float:
    """An angle of the same sine and cosine that is not too large."""
    return theta if abs(theta) <= REDUCED else atan2(sin(theta), cos(theta))


def quantities(angles: Any, side: float, p: Any, setup: Any, out: Any) -> None:
    """M_eff, the torque of gravity, Y', M_eff' and the potential energy at angles, a row each."""
    words: Any = zeros(16, int64)
    words[0], words[6] = address(angles), len(angles)
    for k in range(5):
        words[1 + k] = address(out[k])
    for k in range(6):
        words[7 + k] = 8
    call(int64(setup[KERNEL]), words, words[6:], words[7:], p[0 if side > 0.0 else 1])


def still(theta: float, side: float, p: Any, setup: Any) -> Any:
    """The quantities at one angle, in their order."""
    angle: Any = empty(1)
    out: Any = empty((5, 1))
    angle[0] = reduced(theta)
    quantities(angle, side, p, setup, out)
    return out[INERTIA, 0], out[GRAVITY, 0], out[TRAVEL, 0], out[BEND, 0], out[POTENTIAL, 0]


def torque(t: float, theta: float, omega: float, number: float) -> float:
    """The torque [N m] of the function at an address; NaN where it has none."""
    rows: Any = empty(4)
    rows[0], rows[1], rows[2] = t, theta, omega
    return float(rows[3]) if call(int64(number), rows, 1, 1) == 0 else nan


RELATIVE, ABSOLUTE, SIZE = 0, 1, 2  # rows of the scales


def place(q: float, setup: Any) -> Any:
    """theta, dtheta/dq and the branch at the coordinate q."""
    if setup[3] > 0.0:
        slope = setup[3] * cos(q)
        return 0.5 * (setup[1] + setup[2]) + setup[3] * sin(q), slope, copysign(1.0, slope)
    return min(max(q, setup[1] + 1e-13), setup[2] - 1e-13), 1.0, 1.0


def limits_of(setup: Any) -> Any:
    """The coordinates of the limit angles."""
    return (-pi / 2, pi / 2) if setup[3] > 0.0 else (setup[1], setup[2])


def rates(t: float, y: Any, p: Any, setup: Any, out: Any) -> None:
    """The rates of q, v and W: the law without friction."""
    theta, slope, side = place(y[0], setup)
    inertia, weight, travel, _, _ = still(theta, side, p, setup)
    if not (0.0 < inertia < inf) or slope == 0.0:
        out[:] = nan
        return
    root = sqrt(inertia)
    omega = side * y[1] / root
    push = torque(t, theta, omega, setup[4]) + setup[5] * travel
    out[0] = y[1] / (root * abs(slope))
    out[1] = side * (push - weight) / root
    out[2] = push * omega


def square(x: float) -> float:
    """x^2."""
    return x * x


def tell(
    t: float, q: float, v: float, p: Any, setup: Any, theta: Any, omega: Any, alpha: Any, row: Any
) -> None:
    """Angle, speed and acceleration of a state, into the histories."""
    angle, _, side = place(q, setup)
    inertia, weight, travel, slope, _ = still(angle, side, p, setup)
    speed = side * v / sqrt(inertia)
    push = torque(t, angle, speed, setup[4]) + setup[5] * travel - weight
    theta[row], omega[row] = angle, speed
    alpha[row] = (push - 0.5 * slope * speed * speed) / inertia


def energy_of(y: Any, p: Any, setup: Any) -> float:
    """Kinetic and potential energy."""
    theta, _, side = place(y[0], setup)
    return float(0.5 * y[1] * y[1] + still(theta, side, p, setup)[POTENTIAL])


def start(p: Any, setup: Any, rtol: float, t_end: float, y: Any, scales: Any) -> bool:
    """The state at the start and the scales; whether there is an inertia to move."""
    inertia, weight, _, _, potential = still(setup[6], 1.0, p, setup)
    if not (0.0 < inertia < inf):
        return False
    if setup[3] > 0.0:
        lower = setup[6] < 0.5 * (setup[1] + setup[2])
        gap = setup[6] - setup[1] if lower else setup[2] - setup[6]
        quarter = pi / 2 - 2.0 * asin(sqrt(gap / (2.0 * setup[3])))
        y[0] = -quarter if lower else quarter
    else:
        y[0] = setup[6]
    y[1] = setup[7] * sqrt(inertia)
    y[2] = 0.0
    energy = max(0.5 * y[1] * y[1], abs(potential), abs(weight), setup[8])
    for k in range(9):
        here = abs(torque(t_end * k / 8, setup[6], setup[7], setup[4]))
        if here < inf:
            energy = max(energy, here)
    if energy == 0.0:
        energy = inertia / square(t_end)
    scales[RELATIVE, 0], scales[RELATIVE, 1], scales[RELATIVE, 2] = 1e-16, rtol, rtol
    scales[SIZE, 0], scales[SIZE, 1], scales[SIZE, 2] = 1.0, sqrt(energy), energy
    for i in range(3):
        scales[ABSOLUTE, i] = (0.03 if i == 0 else 0.01) * rtol * scales[SIZE, i]
    return True


def account(y: Any, new: Any, p: Any, setup: Any, sums: Any) -> None:
    """Take a step into account, and make it.

    sums: first energy, work done either way, largest kinetic energy, residual now and before, largest energy.
    """
    energy = energy_of(new, p, setup)
    off = abs(energy - new[2] - sums[0])
    sums[1] += abs(new[2] - y[2])
    sums[2] = max(sums[2], 0.5 * new[1] * new[1])
    sums[4] = sums[3]
    sums[3] = max(sums[3], off) if off == off else sums[3]
    sums[5] = max(sums[5], abs(energy))
    for i in range(3):
        y[i] = new[i]
