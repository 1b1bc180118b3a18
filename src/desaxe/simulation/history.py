"""From the panels of a motion to its histories: angle, speed, acceleration, quantities, energy."""

from collections.abc import Callable, Mapping, Sequence
from math import copysign
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..evaluation.evaluate import evaluate
from .drive import LOADED, ConstantCurve, Curve
from .events import Q, W
from .law import Law, state_of
from .march import RESTING, March
from .panel import NODES, basis
from .residual import energy_residual, told_of
from .result import FAILED, LIMIT, REST, Event, Simulation

Array = NDArray[np.float64]
FORCES = ("F_X", "F_Y")
PANELS = "panels"
SAMPLES = 1001  # instants of the histories by default


class Ended(NamedTuple):
    """The facts of a motion besides its histories.

    residual, rounded   the energy residual, and that of rounding alone
    states              angle and speed at instants
    """

    t: float
    status: int
    message: str
    events: list[Event]
    method: str
    rtol: float
    residual: float
    rounded: float
    work: float
    states: Callable[[Array], tuple[Array, Array]]


def result_of(
    t: Array, histories: Sequence[Array], ended: Ended, names: Sequence[str], given: Mapping[str, Any]
) -> Simulation:
    """The result of a motion; histories: angle, speed and acceleration; given: its inputs, for `names`."""
    motion: dict[str, Any] = dict(zip(("theta", "omega", "alpha"), histories, strict=True))
    result = Simulation({"t": t, **motion})
    if names:
        result |= evaluate(list(names), **motion, **given)
    told = told_of(ended.residual, ended.rounded, ended.rtol)
    return Simulation(
        result, events=ended.events, status=ended.status, message=ended.message + told,
        energy_residual=ended.residual, work=ended.work, t_last=ended.t, method=ended.method,
        solution=Solution(ended.states, ended.t),
    )  # fmt: skip


def instants_of(times: Any, end: float) -> Array:
    """The instants of histories, up to the end of a motion."""
    return np.asarray(np.linspace(0.0, end, SAMPLES) if times is None else times[times <= end])


def integrated(run: March, names: Sequence[str], times: Any, given: Mapping[str, Any]) -> Simulation:
    """The result of a motion by panels of time."""
    t = instants_of(times, run.t)
    motion = Motion(run)
    theta, omega, alpha = motion.histories(t, run.law_of)
    curves = () if "sliders" in given else zip(FORCES, run.model.drive[1:], strict=True)
    loads = {name: _along(curve, t, theta, omega) for name, curve in curves}
    residual = energy_residual(run)
    told = run.t, run.status, run.message, run.events, PANELS, run.settings.rtol, *residual, float(run.y[W])
    return result_of(t, (theta, omega, alpha), Ended(*told, motion.states), names, {**given, **loads})


class Motion:
    """The record of a motion: enough to compute the state at any instant, and to be pickled."""

    def __init__(self, run: March) -> None:
        self.model, self.events, self.status, self.t, self.record = (
            run.model, run.events, run.status, run.t, run.record,
        )  # fmt: skip
        heads = self.record.heads
        self.begin = run.start
        self.start, self.h, self.stop = heads[:, 0], heads[:, 1], heads[:, 6]

    def at(self, t: Array) -> tuple[NDArray[np.intp], Array]:
        """The panels of instants, and q, v and W there."""
        which = np.searchsorted(self.stop[:-1], t)
        s = (t - self.start[which]) / np.where(self.h[which] > 0.0, self.h[which], 1.0)
        rows = basis(2.0 * s - 1.0, NODES)
        moved = np.einsum("kt,tik->it", rows, self.record.series[which]) * (s != 0.0)
        return which, self.record.y[which].T + moved

    def histories(self, t: Array, law_of: Callable[[int], Law]) -> tuple[Array, Array, Array]:
        """Angle, speed and acceleration at instants; law_of: a panel."""
        theta, omega = self.states(t)
        which, ends = np.searchsorted(self.stop[:-1], t), self.record.ends
        law = Law(self.model, self.model.drive, *ends[which, 2:].T)
        alpha = np.where(ends[which, 0] == RESTING, 0.0, law.alpha(t, theta, omega))
        for k in np.flatnonzero((t == self.start[which]) | (t == self.stop[which])).tolist():
            alpha[k] = law_of(int(which[k])).alpha(t[k], theta[k], omega[k])  # pieces may meet there
        if self._at_event:
            _set_end(self, t, alpha)
        return theta, omega, alpha

    def states(self, t: Array) -> tuple[Array, Array]:
        """Angle and speed at instants."""
        state = state_of(self.model, *self.at(t)[1][:W])
        theta, omega = state.theta.copy(), state.omega.copy()
        theta[t == 0.0], omega[t == 0.0] = self.begin
        if self._at_event:
            ends = t >= self.t
            theta[ends], omega[ends] = self.events[-1].theta, self.events[-1].omega
        return theta, omega

    @property
    def _at_event(self) -> bool:
        """True where an event ends the motion: its angle and speed are exact."""
        return bool(self.events) and self.events[-1].t == self.t and self.status != FAILED


class Solution:
    """The motion at any instant: callable t [s] -> dict of theta [rad] and omega [rad/s]."""

    def __init__(self, states: Callable[[Array], tuple[Array, Array]], t_last: float) -> None:
        self.states, self.t_last = states, t_last

    def __call__(self, t: Any) -> dict[str, Any]:
        """Angle and speed; t may be an array."""
        instants = np.asarray(t, dtype=np.float64)
        if not ((instants >= 0.0) & (instants <= self.t_last)).all():
            raise ValueError(f"solution: t must be from 0 to {self.t_last:.17g}, where the motion ends")
        theta, omega = self.states(instants.reshape(-1))
        if not instants.ndim:
            return {"theta": float(theta[0]), "omega": float(omega[0])}
        return {"theta": theta.reshape(instants.shape), "omega": omega.reshape(instants.shape)}

    def __repr__(self) -> str:
        return f"solution(t) -> theta, omega; t from 0 to {self.t_last:.6g} s"


def _set_end(motion: Motion, t: Array, alpha: Array) -> None:
    """Set the acceleration at the event that ends a motion.

    At a limit angle itself M_eff is infinite: there theta'' = -half sin(q) q'^2. What rests has none.
    """
    ends = np.flatnonzero(t >= motion.t)
    if motion.status == REST:
        alpha[ends] = 0.0
    half = motion.model.coordinate.half
    if motion.status == LIMIT and half:
        step = 1e-4 * float(motion.stop[-1] - motion.start[-1])
        q, before = motion.at(np.array([motion.t, motion.t - step]))[1][Q]
        alpha[ends] = -half * copysign(1.0, q) * ((q - before) / step) ** 2


def _along(curve: Curve, t: Array, theta: Array, omega: Array) -> Any:
    """A load at every instant of a history; one that `evaluate` knows as it is, with its slope."""
    if isinstance(curve, LOADED):
        return curve.load
    return curve.value if isinstance(curve, ConstantCurve) else curve.at(t, theta, omega)
