"""`flywheel`: torque ripple, and the inertia that keeps the speed within a required fluctuation.

A constant drive torque, the mean of what the loads take over a turn, leaves the energy

    (J + M_eff(theta)) omega(theta)^2/2 = C + W(theta),   W = integral of (mean - T_load) dtheta

in crank, flywheel (J) and mechanism. J is the least for which (fastest - slowest)/mean speed is as wanted,
the mean speed being (fastest + slowest)/2. The textbook's first order, J = (max - min of the integral of T_in
- mean)/(fluctuation omega0^2) at constant speed, is told beside it.
"""

from math import inf, isinf, pi
from typing import Any, NamedTuple

import numpy as np

from ...peaks.peak import peak
from ...support.answer import answering
from ...support.roots import root
from .turn import Array, Turn, extreme

POINTS = 16384
MOST_TURNS = 4  # after which the loads must repeat; two in a four-stroke engine


@answering
def flywheel(*, fluctuation: float, branch: int = 1, **inputs: Any) -> dict[str, Any]:
    """Torque ripple over a turn, and the flywheel for a required fluctuation of speed.

    fluctuation  (fastest - slowest)/mean speed that is allowed, such as 0.02
    inputs       of one design with masses and loads, as in `evaluate`; omega0 is the mean speed. F_X and
                 F_Y may vary with the motion, over one turn or up to four: what is told is then of all

    Gives a dict:

    mean_torque, max_torque, min_torque   that the drive applies at constant speed [N m], the last two at
                                          `theta_max_torque` and `theta_min_torque` [rad]
    ripple                 largest less smallest torque [N m]
    energy_fluctuation     what a flywheel must store at constant speed [J]
    inertia                of the flywheel, added to the crank [kg m2]: the least with which the speed
                           fluctuates as wanted under a constant torque; 0 if none is needed. With friction
                           that of first order
    inertia_first_order    energy_fluctuation/(fluctuation omega0^2) [kg m2], the textbook's estimate
    fluctuation_without    the fluctuation without a flywheel; infinite if the crank would stop, NaN with
                           friction
    theta_fastest, theta_slowest   where the crank turns fastest and slowest with it [rad]

    At 16384 equal steps of the turn and by parabolas between them, integrals by the fast Fourier transform.
    Raises as `harmonics` does, and ValueError for a crank at rest.

        >>> import desaxe as dx
        >>> found = dx.flywheel(fluctuation=0.02, ec=0, AB=0.05, BC=0.2, omega0=100.0, m_slider=0.4)
        >>> round(found["inertia"], 5), round(found["inertia_first_order"], 5)
        (0.02604, 0.02657)
    """
    if not (isinstance(fluctuation, (int, float)) and 0.0 < fluctuation < 2.0):
        raise ValueError(
            f"fluctuation = {fluctuation!r}: a number above 0 and below 2, where the crank stops"
        )
    turn = Turn("flywheel", inputs, branch, MOST_TURNS)
    speed = turn.numbers.get("omega0")
    if not speed:
        raise ValueError("flywheel: omega0, the mean speed, is missing or 0")
    told = turn.values(["T_in", "M_eff"], POINTS)
    torque = told["T_in"]
    stored = turn.turns * _integral(torque)
    energy = extreme(stored, 1.0)[0] - extreme(stored, -1.0)[0]
    (highest, theta_highest), (lowest, theta_lowest) = _extremes(turn, torque)
    estimate = energy / (fluctuation * speed**2)
    result = {
        "mean_torque": float(torque.mean()),
        "max_torque": highest,
        "min_torque": lowest,
        "theta_max_torque": theta_highest,
        "theta_min_torque": theta_lowest,
        "ripple": highest - lowest,
        "energy_fluctuation": energy,
    }
    if turn.numbers.get("mu"):
        inertia, without, speeds = estimate, float("nan"), -stored * np.sign(speed)
    else:
        # At rest the drive carries the loads alone.
        loads = turn.values(["T_in"], POINTS, omega0=0.0)["T_in"]
        machine = Machine(told["M_eff"], -turn.turns * _integral(loads), abs(speed))
        without = machine.fluctuation(0.0)
        inertia = machine.inertia(fluctuation, estimate)
        speeds = machine.speeds(inertia)
    return {
        **result,
        "inertia": inertia,
        "inertia_first_order": estimate,
        "fluctuation_without": without,
        "theta_fastest": turn.turns * extreme(speeds, 1.0)[1],
        "theta_slowest": turn.turns * extreme(speeds, -1.0)[1],
    }


def _extremes(turn: Turn, torque: Array) -> list[tuple[float, float]]:
    """The largest and smallest torque and their angles; under loads, which may jump, by `peak`."""
    if not turn.loads or turn.numbers.get("mu"):
        found = [extreme(torque, sign) for sign in (1.0, -1.0)]
        return [(value, turn.turns * theta) for value, theta in found]
    ends = (0.0, 2.0 * pi * turn.turns)
    inputs: dict[str, Any] = {**turn.numbers, **turn.loads, "branch": turn.branch}
    peaks = [peak("T_in", kind=kind, theta=ends, **inputs) for kind in ("max", "min")]
    return [(found["value"], found["theta"]) for found in peaks]


def _integral(torque: Array) -> Array:
    """The integral over theta of the deviation from the mean, with mean 0."""
    c = np.fft.rfft(torque)
    c[0] = 0.0
    c[1:] /= 1j * np.arange(1, len(c))
    c[-1] = 0.0
    return np.fft.irfft(c, torque.size)


class Machine(NamedTuple):
    """The effective inertia and the work of loads and drive over a turn, and the mean speed."""

    effective: Array
    work: Array
    speed: float

    def speeds(self, J: float) -> Array:
        """omega(theta) with this flywheel, at the energy of the required mean speed."""

        def at(energy: float) -> Array:
            return np.sqrt(2.0 * np.maximum(energy + self.work, 0.0) / np.maximum(J + self.effective, 1e-300))

        def excess(energy: float) -> float:
            omega = at(energy)
            return (extreme(omega, 1.0)[0] + extreme(omega, -1.0)[0]) / 2.0 - self.speed

        if not (J + self.effective).any():
            return np.full_like(self.work, self.speed)  # without inertia there is nothing to store
        low = -float(self.work.min())
        if excess(low) > 0.0:
            return at(low)  # it stops, and is faster than wanted elsewhere
        high = low + float(np.max(J + self.effective)) * self.speed**2
        while excess(high) < 0.0:
            high = low + 2.0 * (high - low)
        return at(root(excess, low, high))

    def fluctuation(self, J: float) -> float:
        """(fastest - slowest)/mean; infinite where it stops, or nothing has inertia."""
        if not self.effective.any() and not self.work.any():
            return 0.0  # neither inertia nor load: any speed is constant
        if J + float(self.effective.min()) <= 0.0:
            return inf
        omega = self.speeds(J)
        slowest, fastest = extreme(omega, -1.0)[0], extreme(omega, 1.0)[0]
        if float(omega.min()) <= 0.0 or slowest <= 0.0 or isinf(fastest):
            return inf
        return (fastest - slowest) / (0.5 * (fastest + slowest))

    def inertia(self, wanted: float, estimate: float) -> float:
        """The smallest flywheel that keeps the required fluctuation of speed."""
        if self.fluctuation(0.0) <= wanted:
            return 0.0
        high = max(estimate, 1e-300)
        while self.fluctuation(high) > wanted:
            high *= 2.0
        return root(lambda J: min(self.fluctuation(J), 1e3) - wanted, 0.0, high)
