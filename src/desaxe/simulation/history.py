"""From the panels of a motion to its histories: angle, speed, acceleration, quantities, energy."""

from collections.abc import Callable, Mapping, Sequence
from math import copysign, inf
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..evaluation.evaluate import evaluate
from .checks import LEAST_RTOL
from .events import Q, W
from .law import Law, alpha_of, state_of
from .loops import march
from .loops.compiled import NODES
from .march import March
from .panel import basis
from .result import FAILED, LIMIT, REST, Simulation

Array = NDArray[np.float64]
FORCES = ("F_X", "F_Y")
PANELS = "panels"
SAMPLES = 1001  # instants of the histories by default
# The usual residual, as a share of rtol: the median of many motions.
USUAL = 2e-4
ROUNDED = 2e-17  # of the largest energy in a step: what rounding alone makes
TOLD = 100.0  # times the usual
TELLS = "; energy_residual "


def integrated(run: March, names: Sequence[str], times: Any, inputs: Mapping[str, Any]) -> Simulation:
    """The result of a motion; inputs: its inputs, for `names`."""
    t = np.asarray(np.linspace(0.0, run.t, SAMPLES) if times is None else times[times <= run.t])
    motion = Motion(run)
    state = dict(zip(("theta", "omega", "alpha"), motion.histories(t, run.law), strict=True))
    result = {"t": t, **state}
    if names:
        each = () if "sliders" in inputs else zip(FORCES, run.model.drive[1:], strict=True)
        loads = {name: run.model.along(acting, t, state["theta"], state["omega"]) for name, acting in each}
        result |= evaluate(list(names), **{**state, **inputs, **loads})
    residual, rounded = map(float, energy_residual(run.sums, run.status == LIMIT, run.steps))
    told = told_of(residual, rounded, run.ask.rtol)
    return Simulation(
        result, events=run.events, status=run.status, message=run.message + told, energy_residual=residual,
        work=float(run.y[W]), t_last=run.t, method=PANELS, solution=Solution(motion.states, run.t),
    )  # fmt: skip


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

    def histories(self, t: Array, law: Law) -> tuple[Array, Array, Array]:
        """Angle, speed and acceleration at instants."""
        theta, omega = self.states(t)
        which, (q, v, _) = self.at(t)
        alpha = alpha_of(law.at(t, q, v, self.record.laws, which)) * ~self.record.rests[which]
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


# ---- the energy residual: where it is unusual, step control was deceived ----------------------------


def energy_residual(sums: Array, ends_at_limit: Any, steps: Any) -> tuple[Any, Any]:
    """The energy error relative to the total work or the largest kinetic energy, and that of rounding alone.

    max |kinetic + potential - W - initial| over the ends of panels, with the potential energy of the
    generated quantities; at a limit angle Y has half its digits. sums: see `loops.march`.
    """
    off = np.where(ends_at_limit, sums[..., march.BEFORE], sums[..., march.OFF])
    scale = np.maximum(sums[..., march.DONE], sums[..., march.KINETIC])
    with np.errstate(all="ignore"):
        rounded = ROUNDED * steps * (1.0 + sums[..., march.ENERGY] / scale)
        known = np.isfinite(sums[..., march.ENERGY])  # else beyond every double
        residual = np.where(scale > 0.0, off / scale, 0.0)
    return np.where(known, residual, inf), np.where(known, np.where(scale > 0.0, rounded, inf), 0.0)


def told_of(residual: Any, rounded: Any, rtol: float) -> str:
    """The end of a message: the largest of the residuals that are unusual at this rtol; "" if none is.

    residual, rounded   of one motion or, as arrays, of many; NaN where there is none
    """
    if rtol <= LEAST_RTOL:
        return ""
    several = np.atleast_1d(residual)
    unusual = several > TOLD * (USUAL * rtol + np.atleast_1d(rounded))
    if not unusual.any():
        return ""
    count = f" at most, in {unusual.sum()} of {several.size} designs" if np.ndim(residual) else ""
    better = float(f"{max(rtol / TOLD, LEAST_RTOL):.3g}")
    return f"{TELLS}{several[unusual].max():.2g}{count}: repeat with rtol = {better:g}"
