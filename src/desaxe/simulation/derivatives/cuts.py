"""Cuts of a motion that move with the parameters: by how much the sensitivities jump there, and dt/dp.

A cut at the angle theta_c(p) comes at dt/dp = (theta_c,p - theta_p)/omega, a standstill at -omega_p/alpha.
Where the acceleration jumps there, omega_p jumps by (alpha before - alpha after) dt/dp. Where the motion only
touches the angle or the standstill there is no such derivative: NaN.
"""

from collections.abc import Callable, Mapping, Sequence
from math import copysign, cos, nan, sin
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...mechanism.names import LENGTHS
from ..drive import Curve, PositionCurve
from ..events import V
from ..law import State, state_of
from ..march import March
from ..panel import Panel

Array = NDArray[np.float64]
SAME = 1e-9  # of the accelerations: a jump by less is rounding
TOUCHED = 1e-6  # of the largest speed, or of its change in the motion's time: less is none
Values = Callable[..., Mapping[str, Any]]


class Cuts:
    """The cuts of a motion; `notes` say where derivatives end.

    values  quantities of the design at an angle
    """

    def __init__(self, run: March, wrt: Sequence[str], values: Values) -> None:
        self.run, self.wrt, self.values = run, wrt, values
        self.model = run.model
        self.notes: list[str] = []
        ends = np.array([*(panel.y for panel in run.panels), run.y]).T
        self.fastest = float(np.nanmax(np.abs(state_of(self.model, *ends[: V + 1]).omega)))

    def state(self, piece: Panel, t: float) -> State:
        """The state of the crank at an instant of a piece."""
        q, v, _ = piece.state(t).tolist()
        return state_of(self.model, q, v)

    # ---- jumps ------------------------------------------------------------------------------

    def jump(self, before: Panel, after: Panel, x: Array, v: Array) -> Array:
        """By how much omega_p jumps from one piece to the next; x, v: theta_p, omega_p before."""
        none = np.zeros(len(self.wrt))
        if before.law is after.law:
            return none  # the next panel of the same stretch
        if before.law.rests:
            return none  # it breaks away without a jump of alpha, or at an instant of its own
        if after.law.rests:
            return -v
        theta, omega = self.state(after, after.start)
        place = after.start, theta, omega
        left, right = (float(piece.law.alpha(*place)) for piece in (before, after))
        least = SAME * (abs(left) + abs(right))
        if abs(left - right) <= least:
            return none
        if omega == 0.0:
            return (left - right) * self.standstill(after.start, left, v)
        shares: dict[Curve, float] = {}
        last, drive = left, before.law.drive
        for name, curve in after.law.drive._asdict().items():
            drive = drive._replace(**{name: curve})
            now = float(before.law.with_drive(drive).alpha(*place))
            if abs(now - last) > least:
                shares[curve] = last - now
            last = now
        if not shares:
            return none  # the guide only changes sides, where it does not press: alpha differs by rounding
        shifts = {curve: self.kink(curve, theta) for curve in shares}
        first = next(iter(shifts))
        if all((shift == shifts[first]).all() for shift in shifts.values()):
            shares = {first: left - right}  # with what friction makes of it on the other side of the guide
        elif abs(last - right) > least:
            self.notes.append(
                f"NaN from t = {after.start:.6g} s on, where the friction jumps with several loads"
            )
            return none + nan
        passages = [
            share * self.passage(after.start, omega, shifts[curve], x) for curve, share in shares.items()
        ]
        total: Array = np.sum(passages, axis=0)
        return total

    def passage(self, t: float, omega: float, shift: Array, x: Array) -> Array:
        """dt/dp where the crank passes an angle that moves by `shift`; NaN where it only touches it."""
        if abs(omega) <= TOUCHED * self.fastest:
            self.notes.append(f"NaN where an angle is only touched, at t = {t:.6g} s")
            return np.full(len(self.wrt), nan)
        found: Array = (shift - x) / omega
        return found

    def standstill(self, t: float, alpha: float, v: Array) -> Array:
        """dt/dp of a standstill; NaN where the crank only touches it."""
        if abs(alpha) * self.run.t <= TOUCHED * self.fastest:
            self.notes.append(f"NaN where a standstill is only touched, at t = {t:.6g} s")
            return np.full(len(self.wrt), nan)
        return -v / alpha

    # ---- angles that move ----------------------------------------------------------------------

    def _by_lengths(self, slopes: Mapping[str, float]) -> Array:
        return np.array([slopes.get(p, 0.0) for p in self.wrt])

    def kink(self, curve: Curve, theta: float) -> Array:
        """The shift of a kink of a load by each parameter: one over the slider moves with the lengths."""
        if not isinstance(curve, PositionCurve):
            return self._by_lengths({})
        load = curve.load
        found = self.values(load.motion(("theta", *LENGTHS)), theta)
        found = {name: float(value) for name, value in found.items()}
        along = float(load.moved("theta", found))
        return self._by_lengths({p: -float(load.moved(p, found)) / along for p in LENGTHS})

    def dead_centre(self, theta: float) -> Array:
        """The shift of a dead centre by each parameter."""
        found = self.values(("Y_wrt_theta_theta", *(f"Y_wrt_theta_{p}" for p in LENGTHS)), theta)
        bend = float(found["Y_wrt_theta_theta"])
        return self._by_lengths({p: -float(found[f"Y_wrt_theta_{p}"]) / bend for p in LENGTHS})

    def limit(self, theta: float) -> Array:
        """The shift of a limit angle, at which ec + AB sin(theta) = BC or -BC; NaN at a change point."""
        ec, AB, _ = self.model.lengths
        side, arm = copysign(1.0, ec + AB * sin(theta)), AB * cos(theta)
        if abs(arm) <= TOUCHED * AB:
            return self._by_lengths(dict.fromkeys(LENGTHS, nan))
        return self._by_lengths({"ec": -1.0 / arm, "AB": -sin(theta) / arm, "BC": side / arm})
