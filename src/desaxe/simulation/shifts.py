"""Cuts of a motion that move with the parameters: by how much its derivatives jump there, and dt/dp.

A cut at the angle theta_c(p) comes at dt/dp = (theta_c,p - theta_p)/omega, a standstill at -omega_p/alpha.
Where the acceleration jumps there, omega_p jumps by (alpha before - alpha after) dt/dp. Where the motion only
touches the angle or the standstill there is no such derivative: NaN.
"""

from math import nan, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..loads.angles import shift
from ..mechanism.names import LENGTHS, sensitivity
from .drive import Curve, PositionCurve, SumCurve
from .events import Q, V
from .law import Law, state_of
from .march import March
from .result import Event
from .tangents import Tangents

Array = NDArray[np.float64]
SAME = 1e-9  # of the accelerations: a jump by less is rounding
AT_KINK = 1e-7  # rad: an angle so near to a kink is at the kink
TOUCHED = 1e-6  # of the largest speed, or of its change in the motion's time: less is none


class Shifts:
    """The shifts of cuts by parameters; `notes` say where derivatives end."""

    def __init__(self, run: March, tangents: Tangents) -> None:
        self.model, self.duration, self.tangents, self.wrt = run.model, run.t, tangents, tangents.wrt
        self.notes: list[str] = []
        self.of_centres: dict[str, Array] = {}
        ends = np.vstack([run.record.y, run.record.last]).T
        theta, omega = state_of(self.model, *ends[: V + 1])
        self.fastest = float(np.nanmax(np.abs(omega)))
        starts = run.record.heads[:, 0].tolist()
        self.states = dict(zip(starts, zip(theta.tolist(), omega.tolist(), strict=True), strict=False))

    # ---- jumps ------------------------------------------------------------------------------

    def jump(self, before: Any, after: Any, y: Array) -> Array:
        """By how much q_p and v_p (y: before) jump from one piece to the next."""
        none = np.zeros(y.shape)
        if before.law.rests:
            return none  # it breaks away without a jump of alpha, or at an instant of its own
        if after.law.rests:
            return y * [[0.0], [-1.0]]
        theta, omega = self.states[after.start]
        instant = after.start, theta, omega
        if before.law.direction == after.law.direction and not _jumps(before.law, after.law, instant):
            return none  # a load bends, or the guide changes sides, where it does not press
        left, right = (float(piece.law.alpha(*instant)) for piece in (before, after))
        least = SAME * (abs(left) + abs(right))
        if abs(left - right) <= least:
            return none
        root = sqrt(float(self.model.inertia(theta)))
        if omega == 0.0:
            return np.stack([none[0], (left - right) * root * self._turn(after.start, left, y[1] / root)])
        shares, last = self._shares(before, after, instant, left)
        if not shares:
            return none  # the guide only changes sides, where it does not press: alpha differs by rounding
        shifts = {curve: self.kink(curve, theta) for curve in shares}
        first = next(iter(shifts))
        if all((one == shifts[first]).all() for one in shifts.values()):
            shares = {first: left - right}  # with what friction makes of it on the other side of the guide
        elif abs(last - right) > least:
            self.notes.append(
                f"NaN from t = {after.start:.6g} s on, where the friction jumps with several loads"
            )
            return none + nan
        theta_p = self.tangents.angle(after.y[Q], y)
        times = [share * self.passage(after.start, omega, shifts[c], theta_p) for c, share in shares.items()]
        return np.stack([none[0], root * np.sum(times, axis=0)])

    def _shares(
        self, before: Any, after: Any, instant: tuple[float, float, float], left: float
    ) -> tuple[dict[Curve, float], float]:
        """By how much each load that changes lowers alpha, and alpha with all of them."""
        shares: dict[Curve, float] = {}
        last, drive = left, before.law.drive
        for name, curve in after.law.drive._asdict().items():
            drive = drive._replace(**{name: curve})
            alpha = float(before.law.with_drive(drive).alpha(*instant))
            if abs(alpha - last) > SAME * (abs(left) + abs(alpha)):
                shares[curve] = last - alpha
            last = alpha
        return shares, last

    def passage(self, t: float, omega: float, moved: Array, theta_p: Array) -> Array:
        """dt/dp where the crank passes an angle that moves by `moved`; NaN where it only touches it."""
        if abs(omega) <= TOUCHED * self.fastest:
            self.notes.append(f"NaN where an angle is only touched, at t = {t:.6g} s")
            return np.full(len(self.wrt), nan)
        return np.asarray((moved - theta_p) / omega)

    def standstill(self, event: Event, piece: Any, y: Array) -> Array:
        """dt/dp of a standstill on a piece."""
        root = sqrt(float(self.model.inertia(event.theta)))
        return self._turn(event.t, float(piece.law.alpha(event.t, event.theta, 0.0)), y[1] / root)

    def _turn(self, t: float, alpha: float, omega_p: Array) -> Array:
        """dt/dp of a standstill; NaN where the crank only touches it."""
        if not self.accelerates(alpha):
            self.notes.append(f"NaN where a standstill is only touched, at t = {t:.6g} s")
            return np.full(len(self.wrt), nan)
        return -omega_p / alpha

    def accelerates(self, alpha: float) -> bool:
        """True for an acceleration that changes the speed within the motion's time."""
        return abs(alpha) * self.duration > TOUCHED * self.fastest

    # ---- angles that move ----------------------------------------------------------------------

    def kink(self, curve: Curve, theta: float) -> Array:
        """The shift of a kink of a load by each parameter: one over the slider moves with the lengths."""
        if isinstance(curve, SumCurve):
            shifts = [self.kink(part, theta) for part in curve.members if self._bends(part, theta)]
            if not shifts or all((one == shifts[0]).all() for one in shifts):
                return shifts[0] if shifts else self.tangents.by_lengths({})
            self.notes.append(f"NaN where loads of a sum jump at one angle, theta = {theta:.6g}")
            return np.full(len(self.wrt), nan)
        if isinstance(curve, PositionCurve):
            return self._by_lengths(curve.load.needs, theta)
        return self.tangents.by_lengths(curve.moves(theta))

    def _bends(self, curve: Curve, theta: float) -> bool:
        """True if a curve has a kink at an angle."""
        gaps = [
            (abs(theta - angle) % period, period)
            for angle, period in curve.kinks(self.model.lengths, self.model.branch)
        ]
        return any(min(gap, period - gap) < AT_KINK for gap, period in gaps)

    def dead_centre(self, event: Event) -> Array:
        """The shift of a dead centre by each parameter: the same in every turn."""
        if event.which not in self.of_centres:
            self.of_centres[event.which] = self._by_lengths(("Y_wrt_theta",), event.theta)
        return self.of_centres[event.which]

    def _by_lengths(self, kept: tuple[str, ...], theta: float) -> Array:
        """The shift of an angle at which quantities keep their value or difference."""
        names = [sensitivity(kept[0], "theta"), *(sensitivity(n, p) for n in kept for p in LENGTHS)]
        known = self.tangents.values(names, theta)
        return self.tangents.by_lengths({p: float(shift(kept, p, known)) for p in LENGTHS})


def _jumps(before: Law, after: Law, instant: tuple[float, float, float]) -> bool:
    """True where a load that changes has another value."""
    changes = [pair for pair in zip(before.drive, after.drive, strict=True) if pair[0] is not pair[1]]
    values = [(float(old.at(*instant)), float(new.at(*instant))) for old, new in changes]
    return any(abs(old - new) > SAME * (abs(old) + abs(new)) for old, new in values)
