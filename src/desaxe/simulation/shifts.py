"""Cuts of a motion that move with the parameters: by how much its derivatives jump there, and dt/dp.

A cut at the angle theta_c(p) comes at dt/dp = (theta_c,p - theta_p)/omega, a standstill at -omega_p/alpha.
Where the acceleration jumps there, omega_p jumps by (alpha before - alpha after) dt/dp. Where the motion only
touches the angle or the standstill there is no such derivative: NaN.
"""

from itertools import pairwise
from math import nan, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..loads.angles import shift
from ..loads.load import OverY
from ..mechanism.names import LENGTHS, sensitivity
from .drive import Called
from .events import Q, V
from .law import alpha_of, state_of
from .loops.law import DIRECTION, TERM, TERMS
from .march import March
from .result import Event
from .tangents import Tangents

Array = NDArray[np.float64]
SAME = 1e-9  # of the accelerations: a jump by less is rounding
TOUCHED = 1e-6  # of the largest speed, or of its change in the motion's time: less is none


class Shifts:
    """The shifts of cuts by parameters, between panels; `notes` say where derivatives end."""

    def __init__(self, run: March, tangents: Tangents, number: NDArray[np.intp]) -> None:
        self.run, self.model, self.duration = run, run.model, run.t
        self.tangents, self.wrt = tangents, tangents.wrt
        self.notes: list[str] = []
        self.rests = run.record.rests.tolist()
        self.of_centres: dict[str, Array] = {}
        ends = np.vstack([run.record.y, run.record.last]).T
        self.theta, self.omega = state_of(self.model, *ends[: V + 1])
        self.accelerations = self._between_laws(number)
        self.fastest = float(np.nanmax(np.abs(self.omega)))

    # ---- jumps ------------------------------------------------------------------------------

    def jump(self, before: int, after: int, y: Array) -> Array:
        """By how much q_p and v_p (y: before) jump from one panel to the next."""
        none, record = np.zeros(y.shape), self.run.record
        if self.rests[before]:
            return none  # it breaks away without a jump of alpha, or at an instant of its own
        if self.rests[after]:
            return y * [[0.0], [-1.0]]
        old, new = record.laws[[before, after]]
        theta, omega = self.theta[after], self.omega[after]
        steps = [*self.accelerations[after]]
        left, right, changes = steps[0], steps.pop(), list(pairwise(steps))
        shares = {n: a - b for n, (a, b) in enumerate(changes) if abs(a - b) > SAME * (abs(left) + abs(b))}
        if old[DIRECTION] == new[DIRECTION] and not shares:
            return none  # a load bends, or the guide changes sides, where it does not press
        least = SAME * (abs(left) + abs(right))
        if abs(left - right) <= least:
            return none
        root = sqrt(float(self.model.inertia(theta)))
        if omega == 0.0:
            start = record.heads[after, 0]
            return np.stack([none[0], (left - right) * root * self._turn(start, left, y[1] / root)])
        if not shares:
            return none  # the guide only changes sides, where it does not press: alpha differs by rounding
        shifts = {n: self.kink(self.model.terms[n][2], theta) for n in shares}
        first = next(iter(shifts))
        if all((one == shifts[first]).all() for one in shifts.values()):
            shares = {first: left - right}  # with what friction makes of it on the other side of the guide
        elif abs(steps[-1] - right) > least:
            self.notes.append(
                f"NaN from t = {record.heads[after, 0]:.6g} s on, where the friction jumps with several loads"
            )
            return none + nan
        theta_p, start = self.tangents.angle(record.y[after, Q], y), record.heads[after, 0]
        times = [share * self.passage(start, omega, shifts[n], theta_p) for n, share in shares.items()]
        return np.stack([none[0], root * np.sum(times, axis=0)])

    def _between_laws(self, number: NDArray[np.intp]) -> dict[int, list[float]]:
        """The accelerations where one law follows another: terms change one after the other, then all."""
        record, law = self.run.record, self.run.record.stretches[number]
        new = law[1:] != law[:-1]
        panels = number[1:][new]
        before, after = record.laws[number[:-1][new]], record.laws[panels]
        terms = len(self.model.terms)
        laws = np.repeat(before[:, None], terms + 2, axis=1)
        laws[:, -1] = after
        for n in range(terms):
            part = slice(TERMS + TERM * n, TERMS + TERM * (n + 1))
            laws[:, n + 1 : -1, part] = after[:, None, part]
        t, q, v = np.repeat(record.heads[panels][:, [0, 3, 4]], terms + 2, axis=0).T
        alpha = alpha_of(self.run.law.at(t, q, v, laws.reshape(-1, laws.shape[-1]), np.arange(t.size)))
        return dict(zip(panels.tolist(), alpha.reshape(-1, terms + 2).tolist(), strict=True))

    def passage(self, t: float, omega: float, moved: Array, theta_p: Array) -> Array:
        """dt/dp where the crank passes an angle that moves by `moved`; NaN where it only touches it."""
        if abs(omega) <= TOUCHED * self.fastest:
            self.notes.append(f"NaN where an angle is only touched, at t = {t:.6g} s")
            return np.full(len(self.wrt), nan)
        return np.asarray((moved - theta_p) / omega)

    def standstill(self, event: Event, panel: int, y: Array) -> Array:
        """dt/dp of a standstill on a panel."""
        root = sqrt(float(self.model.inertia(event.theta)))
        alpha = self.run.law.alpha(event.t, event.theta, 0.0, self.run.record.laws[panel])
        return self._turn(event.t, alpha, y[1] / root)

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

    def kink(self, part: Any, theta: float) -> Array:
        """The shift of a kink of a load by each parameter: one over the slider moves with the lengths."""
        if isinstance(part, OverY):
            return self._by_lengths(part.needs, theta)
        return self.tangents.by_lengths(part.moves(theta) if isinstance(part, Called) else {})

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
