"""Speeds, accelerations and energies along motions, in plain loops, from coordinates and their rates.

rate     of the coordinate; becomes omega
at       rows per design: M_eff, the torque that moves the crank, M_eff_wrt_theta, Y and potential energy
loads    a row per design: torque and force, NaN where they are tables; half of the arc
numbers  of `follow`
told     end, largest energy residual, work, and the residual that rounding makes
"""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from typing import Any

LOST_DIGITS = 0.03  # of dtheta/dx at most: of angles so near to a limit angle
ROUNDED = 2e-17  # see `residual`
ANGLE = 2.2e-16  # of an angle and of a radian: how it is rounded


def accelerations(slope: Any, at: Any, omega: Any, alpha: Any) -> None:
    """Speeds and accelerations of the crank at all instants."""
    for k in range(1, len(omega)):
        omega[k] *= slope[k]
        alpha[k] = (at[1, k] - 0.5 * at[2, k] * omega[k] * omega[k]) / at[0, k]


def work_until(k: Any, theta: Any, at: Any, loads: Any, gained: float) -> float:
    """The work of torque and force; gained: the energy, which is all that is known of that of tables."""
    if loads[0] != loads[0] or loads[1] != loads[1]:
        return gained
    work = loads[0] * (theta[k] - theta[0])
    if loads[1] != 0.0:
        work += loads[1] * (at[3, k] - at[3, 0])
    return float(work)


def angle_rounded(theta: float, inertia: float, alpha: float, load: float, Y: float) -> float:
    """Return the energy error that the rounding of theta and Y makes."""
    wide, push = ANGLE * (1.0 + abs(theta)) * abs(inertia * alpha), ANGLE * abs(load * Y)
    return (wide if wide <= inf else 0.0) + (push if push <= inf else 0.0)


def energies(
    theta: Any, slope: Any, at: Any, loads: Any, numbers: Any, omega: Any, alpha: Any, told: Any
) -> None:
    """The work of a motion and its energy residual."""
    first = 0.5 * at[0, 0] * omega[0] * omega[0]
    initial, last = first + at[4, 0], len(omega) - 1
    largest, heaviest, off, turned, before = first, abs(initial), 0.0, 0.0, 0.0
    work, tables, bits = 0.0, loads[0] != loads[0] or loads[1] != loads[1], 0.0
    for k in range(1, len(omega)):
        kinetic = 0.5 * at[0, k] * omega[k] * omega[k]
        energy = kinetic + at[4, k]
        work = work_until(k, theta, at, loads, energy - initial)
        if tables and k == last:
            work = numbers[2] - first + at[4, k] - at[4, 0]
        if energy == energy:
            largest, heaviest = max(largest, kinetic), max(heaviest, abs(energy))
            # Next to a limit angle M_eff has lost the digits that would tell.
            if abs(slope[k]) >= LOST_DIGITS * loads[2] and work == work:
                off = max(off, abs(energy - work - initial))
                bits = max(bits, angle_rounded(theta[k], at[0, k], alpha[k], loads[1], at[3, k]))
        if abs(work - before) <= inf:
            turned += abs(work - before)
        before = work
    scale = max(largest, turned)
    moves = scale > 0.0
    told[1], told[2] = off / scale if moves else 0.0, work
    told[3] = ROUNDED * numbers[5] * (1.0 + heaviest / scale) + bits / scale if moves else inf


def courses(
    theta: Any, slope: Any, at: Any, loads: Any, numbers: Any, omega: Any, alpha: Any, told: Any
) -> None:
    """All designs; the first column is the start."""
    for n in range(len(theta)):
        accelerations(slope[n], at[n], omega[n], alpha[n])
        energies(theta[n], slope[n], at[n], loads[n], numbers[n], omega[n], alpha[n], told[n])
