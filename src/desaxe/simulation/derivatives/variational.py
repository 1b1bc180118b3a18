"""The variational equations of a motion: the derivatives of its angle and speed by parameters.

Along the motion the torque that it takes equals the torque given, T_in(theta, omega, alpha; p) = T(t, theta,
omega; p), with the loads and the friction in T_in. Differentiated by p at a fixed time that is

    T_in_alpha alpha_p = T_p - T_in_p - (T_in_theta - T_theta) theta_p - (T_in_omega - T_omega) omega_p

with alpha_p = theta_p'' and derivatives of T_in that are generated like every other quantity: a linear
equation along a motion that is known, solved on the panels of the motion (`collocation`), which are halved
where they do not resolve it. At a cut that moves with p, where the acceleration jumps, omega_p jumps by
(alpha before - alpha after) dt/dp (`cuts`).
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial.legendre import legvander
from numpy.typing import NDArray

from ...evaluation.evaluate import evaluate
from ..events import Q
from ..law import Law, state_of
from ..march import March
from ..panel import NODES, ONCE, PLACES, SERIES, Panel
from ..result import LIMIT
from .collocation import TWICE, Local, Trajectories, solve
from .cuts import Cuts
from .rubbing_slopes import Signs, rubbing_slopes
from .slopes import TorqueSlopes

Array = NDArray[np.float64]
RESOLVED = 1e-9  # of a series: its last terms, at most
HALVINGS = 10  # of a step of the motion, at most
SHORT = 0.998  # of the last panel: where the inertia grows without bound, polynomials go on from there
WELL_BEFORE = 0.1  # of q: so far from a limit angle nothing has lost its digits
STARTS = ("theta0", "omega_start")


class Along(NamedTuple):
    """The motion at the nodes of panels: arrays of the shape (panels, NODES)."""

    t: Array
    theta: Array
    omega: Array
    alpha: Array


class Variations:
    """The derivatives of one motion by parameters.

    given   the inputs of the mechanism: numbers, and loads that vary with the motion
    slopes  of the torque
    """

    def __init__(
        self, run: March, wrt: Sequence[str], given: Mapping[str, Any], slopes: TorqueSlopes
    ) -> None:
        self.run, self.wrt, self.given, self.slopes = run, tuple(wrt), given, slopes
        self.inputs = [p for p in wrt if p not in (*STARTS, "torque")]
        self.cuts = Cuts(run, self.wrt, self.values)
        self.grows = run.status == LIMIT and bool(run.model.coordinate.half)  # the inertia, without bound
        self.pieces: list[Any] = [piece for piece in run.panels if piece.stop > piece.start] or run.panels[:1]
        if self.grows:
            self.pieces = _with_long_end(self.pieces, run.model.coordinate.ends)
        self.course = self._resolved()

    def values(
        self, names: Sequence[str], theta: Any, omega: Any = 1.0, alpha: Any = 0.0, **other: float
    ) -> dict[str, Array]:
        """Quantities along the motion, by `evaluate`; `other` inputs replace those given."""
        shape = np.shape(theta)
        found = evaluate(list(names), theta=theta, omega=omega, alpha=alpha, **{**self.given, **other})
        return {name: np.broadcast_to(value, shape) for name, value in found.items()}

    # ---- panels -----------------------------------------------------------------------------

    def _resolved(self) -> Trajectories:
        """The course on the panels of the motion, halved where the derivatives bend more than it does."""
        moving = [k for k, piece in enumerate(self.pieces) if not piece.law.rests]
        piece = np.array(moving, int)
        start = np.array([self.pieces[k].start for k in moving])
        h = np.array([self.pieces[k].stop - self.pieces[k].start for k in moving])
        if self.grows:
            h[-1] *= SHORT
        for _ in range(HALVINGS):
            course = self._joined(piece, start, self._local(piece, start, h))
            bad = course.unresolved(RESOLVED)[np.searchsorted(course.start, start)]
            if self.grows:
                bad &= start < self.pieces[-1].start  # the longer the last panel, the better it goes on
            if not bad.any():
                break
            half = np.repeat(np.where(bad, 0.5 * h, h), 1 + bad)
            second = np.concatenate([[False], np.diff(np.repeat(np.arange(h.size), 1 + bad)) == 0])
            piece, start = np.repeat(piece, 1 + bad), np.repeat(start, 1 + bad) + half * second
            h = half
            self.cuts.notes.clear()
        return course

    def _local(self, piece: Array, start: Array, h: Array) -> Local:
        """The solutions on some panels."""
        along = self._along(piece, start, h)
        takes = self._taken(along, piece)
        by_theta, by_omega = self.slopes.at(along.t, along.theta, along.omega)
        mass = takes["alpha"]
        pushes = {p: -takes[p] for p in self.inputs} | {"torque": np.ones(mass.shape)}
        columns = [pushes.get(p, np.zeros(mass.shape)) / mass for p in self.wrt]
        a, b = (by_theta - takes["theta"]) / mass, (by_omega - takes["omega"]) / mass
        return solve(h, a, b, np.stack(columns, axis=-1))

    def _taken(self, along: Along, piece: Array) -> dict[str, Array]:
        """The derivatives of the torque that the motion takes, by its state and by the inputs."""
        by = ("theta", "omega", "alpha", *self.inputs)
        state, mu = (along.theta, along.omega, along.alpha), self.run.model.mu
        found = self.values([f"T_in_wrt_{q}" for q in by], *state, mu=0.0)
        slopes = {q: found[f"T_in_wrt_{q}"] for q in by}
        if mu:
            own, _ = self.rubbing(along, piece, by)
            slopes |= {q: own[q] + (slopes[q] if q != "mu" else 0.0) for q in by}
        return slopes

    def rubbing(self, along: Along, piece: Array, by: Sequence[str]) -> tuple[dict[str, Array], Array]:
        """The derivatives of the torque that friction takes, and that torque."""
        laws = [self.pieces[k].law for k in piece.tolist()]
        sides = (
            np.array([law.direction * law.side for law in laws]), np.array([law.pressed for law in laws])
        )  # fmt: skip
        model, state = self.run.model, (along.theta, along.omega, along.alpha)
        signs = Signs(*sides, float(model.branch))
        return rubbing_slopes(lambda names: self.values(names, *state, mu=0.0), model.mu, signs, by)

    def _along(self, piece: Array, start: Array, h: Array) -> Along:
        t = start[:, None] + h[:, None] * PLACES
        rows = np.empty((3, *t.shape))
        for row, k in enumerate(piece.tolist()):
            rows[:, row] = self._states(self.pieces[k], t[row])
        return Along(t, *rows)

    def _states(self, piece: Panel, t: Array) -> Array:
        """Angle, speed and acceleration at instants of a piece."""
        state = state_of(self.run.model, *piece.state(t)[:2])
        alpha = piece.law.alpha(t, *state)
        return np.stack(np.broadcast_arrays(*state, alpha))

    # ---- from the start to the end ------------------------------------------------------------

    def _joined(self, piece: Array, start: Array, local: Local) -> Trajectories:
        """The course of theta_p and omega_p through all pieces."""
        x, v = (np.array([float(p == own) for p in self.wrt]) for own in STARTS)
        rows: list[tuple[float, float, Array, Array, Array]] = []
        for k, one in enumerate(self.pieces):
            if k:
                v = v + self.cuts.jump(self.pieces[k - 1], one, x, v)
            if one.law.rests:
                v = v if one.stop == one.start else np.zeros(len(self.wrt))  # stopped where it started
                rows.append((one.start, one.stop - one.start, x, v, np.zeros((NODES, len(self.wrt)))))
                continue
            for row in np.flatnonzero(piece == k):
                h, series = local.h[row], local.series[row]
                y = h * v
                own = series[:, 2:] + series[:, :1] * x + series[:, 1:2] * y
                rows.append((start[row], h, x, y, own))
                x, v = x + y + _END_TWICE @ own, (y + _END_ONCE @ own) / h
        return Trajectories(*(np.array(column) for column in zip(*rows, strict=True)))

    # ---- along the motion ----------------------------------------------------------------------

    def at(self, piece: Panel, t: float) -> Along:
        """The motion at an instant of a piece."""
        instant = np.array([t])
        return Along(instant, *self._states(piece, instant))

    @property
    def last_panel(self) -> Along:
        """The motion at the nodes of the last panel."""
        return self._along(np.array([len(self.pieces) - 1]), self.course.start[-1:], self.course.h[-1:])

    def at_limit(self, function: Callable[[Along], Array]) -> Array:
        """A function along the motion, smooth up to a limit angle, at that, where it cannot be evaluated."""
        start, h = self.course.start[-1:], self.course.h[-1:]
        values = np.asarray(function(self.last_panel))[..., 0, :]
        end = 2.0 * (self.run.t - start) / h - 1.0
        found: Array = values @ SERIES.T @ legvander(end, NODES - 1)[0]
        return found


class _Joined(NamedTuple):
    """Panels of one law, as one."""

    law: Law
    start: float
    stop: float
    panels: Sequence[Panel]

    def state(self, t: Any) -> Array:
        """q, v and W at an instant, or a column for each of several."""
        edges = [panel.start for panel in self.panels[1:]]
        which = np.searchsorted(edges, t, side="right")
        if not np.ndim(t):
            return self.panels[int(which)].state(t)
        return np.stack([self.panels[k].state(x) for k, x in zip(which, t, strict=True)], axis=1)


def _with_long_end(pieces: Sequence[Any], ends: Sequence[float]) -> list[Any]:
    """The pieces with the last ones joined, if the motion has one law from well before its limit angle on."""

    def gap(piece: Panel) -> float:
        return min(abs(end - float(piece.y[Q])) for end in ends)

    first = len(pieces) - 1
    while first and pieces[first - 1].law is pieces[first].law and gap(pieces[first]) < WELL_BEFORE:
        first -= 1
    last = pieces[first:]
    return [*pieces[:first], _Joined(last[0].law, last[0].start, last[-1].stop, last)]


_END_ONCE, _END_TWICE = ONCE.sum(axis=0), TWICE.sum(axis=0)  # Legendre polynomials are 1 at the end
