"""From the pieces of a motion to its histories: angle, speed, acceleration, quantities, energy."""

from collections.abc import Callable, Mapping, Sequence
from math import copysign, nan
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..evaluation.evaluate import evaluate
from .equations import Law, State, state_of
from .events import Q, W
from .held import Held
from .model import Model
from .one_design import MotionRun, Piece
from .residual import energy_residual, told_of
from .result import FAILED, LIMIT, REST, SENSITIVITIES, Event, Simulation

Array = NDArray[np.float64]
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
    told = told_of(ended.residual, ended.rounded, ended.rtol, ended.method)
    return Simulation(
        result, events=ended.events, status=ended.status, message=ended.message + told,
        energy_residual=ended.residual, work=ended.work, t_last=ended.t, method=ended.method,
        solution=Solution(ended.states, ended.t),
    )  # fmt: skip


def add_slopes(
    result: Simulation,
    wrt: Sequence[str],
    slopes: Sequence[Array],
    of_events: Sequence[Array],
    notes: Sequence[str],
) -> None:
    """Add theta_wrt_<p>, omega_wrt_<p>, t_last_wrt_<p> and work_wrt_<p>, and `wrt` of each event.

    slopes   of the histories of angle and speed, a row for each p; of the end and the work
    notes    say where there is no derivative
    """
    theta, omega, ended, work = slopes
    for k, p in enumerate(wrt):
        result[f"theta_wrt_{p}"], result[f"omega_wrt_{p}"] = theta[k].copy(), omega[k].copy()
        result[f"t_last_wrt_{p}"], result[f"work_wrt_{p}"] = float(ended[k]), float(work[k])
    result["events"] = [
        event._replace(wrt=dict(zip(wrt, own.tolist(), strict=True)))
        for event, own in zip(result["events"], of_events, strict=True)
    ]
    if not notes and not (np.isfinite(theta).all() and np.isfinite([ended, work]).all()):
        notes = ["NaN where the forces have no derivatives, or none is known"]
    if notes:
        result["message"] += SENSITIVITIES + "; ".join(dict.fromkeys(notes))


def instants_of(times: Any, end: float) -> Array:
    """The instants of histories, up to the end of a motion."""
    return np.asarray(np.linspace(0.0, end, SAMPLES) if times is None else times[times <= end])


def integrated(run: MotionRun, names: Sequence[str], times: Any, given: Mapping[str, Any]) -> Simulation:
    """The result of a motion of the integrator."""
    t = instants_of(times, run.t)
    motion = Motion(run.model, run.pieces, run.events, run.status, run.t)
    theta, omega, alpha = motion.histories(t)
    loads = {name: _along(given[name], t, theta, omega) for name in ("F_X", "F_Y") if name in given}
    accepted = run.accepted[:-1] if run.status == LIMIT else run.accepted  # there Y has half its digits
    residual, how = energy_residual(run.model, accepted), run.tolerance
    told = run.t, run.status, run.message, run.events, how.method, how.rtol, *residual, float(run.y[W])
    return result_of(t, (theta, omega, alpha), Ended(*told, motion.states), names, {**given, **loads})


class Motion(NamedTuple):
    """The record of a run: enough to compute the state at any instant, and to be pickled."""

    model: Model
    pieces: list[Piece]
    events: list[Event]
    status: int
    t: float

    def histories(self, t: Array, without_alpha: bool = False) -> tuple[Array, Array, Array]:
        """Angle, speed and acceleration at many instants."""
        theta, omega, alpha = (np.full(t.shape, nan) for _ in range(3))
        which = np.searchsorted([piece.stop for piece in self.pieces[:-1]], t)
        for number in sorted(set(which.tolist())):
            piece = self.pieces[number]
            rows = np.flatnonzero(which == number)
            for row, (q, v, _) in zip(rows.tolist(), piece.state(t[rows]).T.tolist(), strict=True):
                state = state_of(self.model, q, v)
                theta[row], omega[row] = state.theta, state.omega
                if not without_alpha:
                    alpha[row] = _acceleration(piece.law, float(t[row]), state)
        if self.events and self.events[-1].t == self.t and self.status != FAILED:
            _set_end(self, t, theta, omega, alpha)
        return theta, omega, alpha

    def states(self, t: Array) -> tuple[Array, Array]:
        """Angle and speed at many instants."""
        theta, omega, _ = self.histories(t, without_alpha=True)
        return theta, omega


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


def _acceleration(law: Law, t: float, state: State) -> float:
    """The crank's acceleration; at rest under the load of the way in which it starts."""
    alpha = law.alpha(t, state.theta, state.omega or 0.0)
    return law.alpha(t, state.theta, -0.0) if alpha < 0.0 and not state.omega else alpha


def _set_end(run: Motion, t: Array, theta: Array, omega: Array, alpha: Array) -> None:
    """Set the end of the histories to the event that ends the motion, not to the interpolant.

    At a limit angle itself M_eff is infinite: there theta'' = -half sin(q) q'^2. What rests
    has no acceleration.
    """
    ends = np.flatnonzero(t >= run.t)
    if run.status == REST:
        alpha[ends] = 0.0
    theta[ends], omega[ends] = run.events[-1].theta, run.events[-1].omega
    if run.status == LIMIT and run.model.coordinate.half:
        last = run.pieces[-1]
        step = 1e-4 * (last.stop - last.start)
        q, before = last.state(np.array([run.t, run.t - step]))[Q]
        alpha[ends] = -run.model.coordinate.half * copysign(1.0, q) * ((q - before) / step) ** 2


def _along(load: Any, t: Array, theta: Array, omega: Array) -> Any:
    """A load at every instant of a history."""
    if isinstance(load, Held):
        return load.load  # `evaluate` knows its slope
    if not callable(load):
        return load
    now = zip(t.tolist(), theta.tolist(), omega.tolist(), strict=True)
    return np.array([load(*instant) for instant in now])
