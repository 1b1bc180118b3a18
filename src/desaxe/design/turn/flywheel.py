"""`flywheel`: torque ripple, and the inertia that keeps the speed within a required fluctuation.

A constant drive torque, the mean of what the loads take over a turn, leaves the energy

    (J + M_eff(theta)) omega(theta)^2/2 = C + W(theta),   W = integral of (mean - T_load) dtheta

in crank, flywheel (J) and mechanism. J is the least for which (fastest - slowest)/mean speed is as wanted,
the mean speed being (fastest + slowest)/2. The textbook's first order, J = (max - min of the integral of T_in
- mean)/(fluctuation omega0^2) at constant speed, is told beside it.
"""

from collections.abc import Callable
from math import inf, isinf, pi, sqrt
from typing import Any, NamedTuple

import numpy as np
from numpy.fft import irfft, rfft

from ...peaks.peak import peak
from ...support.answer import answering
from ...support.roots import root
from ..drive.drive import check_fluctuation
from ..drive.panels import Panels
from .turn import AT_REST, Array, Turn, extreme

POINTS = 16384
MOST_TURNS = 4  # after which the loads must repeat; two in a four-stroke engine


@answering
def flywheel(*, fluctuation: float, branch: int = 1, **inputs: Any) -> dict[str, Any]:
    """Torque ripple over a turn, and the flywheel for a required fluctuation of speed.

    fluctuation  (fastest - slowest)/mean speed that is allowed, such as 0.02
    inputs       of one design with masses and loads, as in `evaluate`; omega0 is the mean speed. F_X and
                 F_Y may vary with the motion, over one turn or up to four: the results are then of all

    Returns a dict:

    mean_torque, max_torque, min_torque   that the drive applies at constant speed [N m], the last two at
                                          `theta_max_torque` and `theta_min_torque` [rad]
    ripple                 largest less smallest torque [N m]
    energy_fluctuation     what a flywheel must store at constant speed [J]
    inertia                of the flywheel, added to the crank [kg m2]: the smallest that keeps the
                           required fluctuation under a constant torque; 0 if none is needed. With
                           friction that of first order
    inertia_first_order    energy_fluctuation/(fluctuation omega0^2) [kg m2], the textbook's estimate
    fluctuation_without    the fluctuation without a flywheel; infinite if the crank would stop, NaN with
                           friction
    theta_fastest, theta_slowest   where the crank turns fastest and slowest with it [rad]

    At 16384 equal steps of the turn and by parabolas between them, integrals by the fast Fourier transform;
    under a table of a load in panels between its kinks and jumps, to rounding.
    Raises as `harmonics` does, and ValueError for a crank at rest.

        >>> import desaxe as dx
        >>> found = dx.flywheel(fluctuation=0.02, ec=0, AB=0.05, BC=0.2, omega0=100.0, m_slider=0.4)
        >>> round(found["inertia"], 5), round(found["inertia_first_order"], 5)
        (0.02604, 0.02657)
    """
    check_fluctuation(fluctuation)
    turn = Turn("flywheel", inputs, branch, MOST_TURNS)
    speed = turn.numbers.get("omega0")
    if not speed:
        raise ValueError("flywheel: omega0, the mean speed, is missing or 0")
    told, over = _sampled(turn)
    torque = told["T_in"]
    mean = over.mean(torque)
    stored = over.integral(torque - mean)
    energy = over.extreme(stored, 1.0)[0] - over.extreme(stored, -1.0)[0]
    (highest, theta_highest), (lowest, theta_lowest) = _extremes(turn, torque, over)
    estimate = energy / (fluctuation * speed**2)
    result = {
        "mean_torque": mean,
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
        loads = told[f"T_in{AT_REST}"]
        machine = Machine(told["M_eff"], -over.integral(loads - over.mean(loads)), abs(speed), over.extreme)
        without = machine.fluctuation(0.0)
        inertia = machine.inertia(fluctuation, estimate)
        speeds = machine.squares(inertia)  # largest where the speed is
    return {
        **result,
        "inertia": inertia,
        "inertia_first_order": estimate,
        "fluctuation_without": without,
        "theta_fastest": over.extreme(speeds, 1.0)[1],
        "theta_slowest": over.extreme(speeds, -1.0)[1],
    }


class EqualSteps(NamedTuple):
    """Integrals and extremes of functions at equal steps of some turns."""

    turns: int

    def mean(self, values: Array) -> float:
        """The mean over the turns."""
        return float(values.mean())

    def integral(self, values: Array) -> Array:
        """The integral over theta, without a constant, of a function whose mean is 0."""
        return self.turns * _integral(values)

    def extreme(self, values: Array, sign: float) -> tuple[float, float]:
        """The largest (sign 1) or smallest (-1) value and its angle."""
        value, theta = extreme(values, sign)
        return value, self.turns * theta


class InPanels(NamedTuple):
    """Integrals and extremes of functions in panels between kinks and jumps."""

    panels: Panels

    def mean(self, values: Array) -> float:
        """The mean over the turns."""
        return self.panels.integral(values) / self.panels.edges[-1]

    def integral(self, values: Array) -> Array:
        """The integral over theta, without a constant."""
        return self.panels.running(values)

    def extreme(self, values: Array, sign: float) -> tuple[float, float]:
        """The largest (sign 1) or smallest (-1) value and its angle."""
        return self.panels.extreme(values, sign)[:2]


def _sampled(turn: Turn) -> tuple[dict[str, Array], EqualSteps | InPanels]:
    """Torque at speed and, as friction allows, at rest, and the effective inertia, over all turns."""
    if turn.kinks:
        panels = turn.panels(["T_in", "M_eff"], at_rest=[] if turn.numbers.get("mu") else ["T_in"])
        return panels.values, InPanels(panels)
    told = turn.values(["T_in", "M_eff"], POINTS)
    told[f"T_in{AT_REST}"] = turn.values(["T_in"], POINTS, omega0=0.0)["T_in"]
    return told, EqualSteps(turn.turns)


def _extremes(turn: Turn, torque: Array, over: EqualSteps | InPanels) -> list[tuple[float, float]]:
    """The largest and smallest torque and their angles; under loads, which may jump, by `peak`."""
    if not turn.loads or turn.numbers.get("mu"):
        return [over.extreme(torque, sign) for sign in (1.0, -1.0)]
    ends = (0.0, 2.0 * pi * turn.turns)
    inputs: dict[str, Any] = {**turn.numbers, **turn.loads, "branch": turn.branch}
    peaks = [peak("T_in", kind=kind, theta=ends, **inputs) for kind in ("max", "min")]
    return [(found["value"], found["theta"]) for found in peaks]


def _integral(torque: Array) -> Array:
    """The integral over theta of the deviation from the mean, with mean 0."""
    c = rfft(torque)
    c[0] = 0.0
    c[1:] /= 1j * np.arange(1, len(c))
    c[-1] = 0.0
    return irfft(c, torque.size)


class Machine(NamedTuple):
    """The effective inertia and the work of loads and drive over a turn, and the mean speed."""

    effective: Array
    work: Array
    speed: float
    extreme: Callable[[Array, float], tuple[float, float]]

    def squares(self, J: float) -> Array:
        """omega(theta)^2 with this flywheel, at the energy of the required mean speed."""

        def at(energy: float) -> Array:
            return 2.0 * np.maximum(energy + self.work, 0.0) / np.maximum(J + self.effective, 1e-300)

        def excess(energy: float) -> float:
            return sum(self._ends(at(energy))) / 2.0 - self.speed

        if not (J + self.effective).any():
            return np.full_like(self.work, self.speed**2)  # without inertia there is nothing to store
        low = -float(self.work.min())
        if excess(low) > 0.0:
            return at(low)  # it stops, and is faster than required elsewhere
        high = low + float(np.max(J + self.effective)) * self.speed**2
        while excess(high) < 0.0:
            high = low + 2.0 * (high - low)
        return at(root(excess, low, high))

    def _ends(self, squares: Array) -> tuple[float, float]:
        """The smallest and the largest speed; the squares are smooth where the crank stops, too."""
        low, high = (self.extreme(squares, sign)[0] for sign in (-1.0, 1.0))
        return sqrt(max(low, 0.0)), sqrt(max(high, 0.0))

    def fluctuation(self, J: float) -> float:
        """(fastest - slowest)/mean; infinite where it stops, or nothing has inertia."""
        if not self.effective.any() and not self.work.any():
            return 0.0  # neither inertia nor load: any speed is constant
        if J + float(self.effective.min()) <= 0.0:
            return inf
        squares = self.squares(J)
        slowest, fastest = self._ends(squares)
        if float(squares.min()) <= 0.0 or slowest <= 0.0 or isinf(fastest):
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
