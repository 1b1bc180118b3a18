"""The state of a motion in plain loops, whose text numba compiles (`compiled`): q, v and W of `equations`.

It stands in a module with the functions `still`, `moving`, `potential` and `torque` that are written from
the Program for the designs at hand.

setup    a row per design: branch, limit angles, half of the arc (see `chart`), torque, F_Y, theta0,
         omega_start, an energy that the loads suggest
scales   relative and absolute tolerances and sizes of q, v and W
"""

from __future__ import annotations

from math import asin, copysign, cos, inf, nan, pi, sin, sqrt
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from typing import Any

    def still(theta: float, branch: float, p: Any) -> tuple[float, float, float]:
        """M_eff [kg m^2], the torque of gravity [N m] and Y' [m]."""

    def moving(theta: float, branch: float, p: Any) -> tuple[float, float, float, float]:
        """M_eff, its derivative by theta, the torque of gravity and Y'."""

    def potential(theta: float, branch: float, p: Any) -> float:
        """The potential energy [J]."""

    def torque(t: float, theta: float, omega: float, number: float) -> float:
        """The torque [N m]."""


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
    inertia, weight, travel = still(theta, side * setup[0], p)
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
    """x^2: numba compiles a loop for a power."""
    return x * x


def tell(
    t: float, q: float, v: float, p: Any, setup: Any, theta: Any, omega: Any, alpha: Any, row: Any
) -> None:
    """Angle, speed and acceleration of a state, into the histories."""
    angle, _, side = place(q, setup)
    inertia, slope, weight, travel = moving(angle, side * setup[0], p)
    speed = side * v / sqrt(inertia)
    push = torque(t, angle, speed, setup[4]) + setup[5] * travel - weight
    theta[row], omega[row] = angle, speed
    alpha[row] = (push - 0.5 * slope * speed * speed) / inertia


def energy_of(y: Any, p: Any, setup: Any) -> float:
    """Kinetic and potential energy."""
    theta, _, side = place(y[0], setup)
    return float(0.5 * y[1] * y[1]) + potential(theta, side * setup[0], p)


def start(p: Any, setup: Any, rtol: float, t_end: float, y: Any, scales: Any) -> bool:
    """The state at the start and the scales; whether there is an inertia to move."""
    inertia, weight, _ = still(setup[6], setup[0], p)
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
    energy = max(0.5 * y[1] * y[1], abs(potential(setup[6], setup[0], p)), abs(weight), setup[8])
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
