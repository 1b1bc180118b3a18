"""The variational equations of a motion: the derivatives of its angle and speed by parameters.

Along the motion the torque that it takes equals the torque given, T_in(theta, omega, alpha; p) = T(t, theta,
omega; p), with the loads and the friction in T_in. Differentiated by p at a fixed time that is

    T_in_alpha alpha_p = T_p - T_in_p - (T_in_theta - T_theta) theta_p - (T_in_omega - T_omega) omega_p

with alpha_p = theta_p'' and derivatives of T_in that are generated like every other quantity: a linear
equation along a motion that is known, solved on panels between the cuts of the motion (`collocation`), which
are halved until they resolve it. At a cut that moves with p, where the acceleration jumps, omega_p jumps by
(alpha before - alpha after) dt/dp (`cuts`).
"""

from bisect import bisect
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial.legendre import legvander
from numpy.typing import NDArray

from ...evaluation.evaluate import evaluate
from ..equations import Resting, state_of
from ..events import Q
from ..friction import Rubbing
from ..one_design import MotionRun, Piece
from ..result import LIMIT
from .collocation import NODES, ONCE, PLACES, SERIES, TWICE, Local, Trajectories, solve
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
        self, run: MotionRun, wrt: Sequence[str], given: Mapping[str, Any], slopes: TorqueSlopes
    ) -> None:
        self.run, self.wrt, self.given, self.slopes = run, tuple(wrt), given, slopes
        self.inputs = [p for p in wrt if p not in (*STARTS, "torque")]
        self.cuts = Cuts(run, self.wrt, self.values)
        self.grows = run.status == LIMIT and bool(run.model.coordinate.half)  # the inertia, without bound
        self.pieces = [piece for piece in run.pieces if piece.stop > piece.start] or run.pieces[:1]
        if self.grows:
            self.pieces = _with_long_end(self.pieces, run.model.coordinate.ends)
        self.course = self._joined(*self._solved())

    def values(
        self, names: Sequence[str], theta: Any, omega: Any = 1.0, alpha: Any = 0.0, **other: float
    ) -> dict[str, Array]:
        """Quantities along the motion, by `evaluate`; `other` inputs replace those given."""
        shape = np.shape(theta)
        found = evaluate(list(names), theta=theta, omega=omega, alpha=alpha, **{**self.given, **other})
        return {name: np.broadcast_to(value, shape) for name, value in found.items()}

    # ---- panels -----------------------------------------------------------------------------

    def _solved(self) -> tuple[Array, Array, Local]:
        """The panels, by their piece and start in order, and the solutions on them."""
        moving = [k for k, piece in enumerate(self.pieces) if not isinstance(piece.law, Resting)]
        piece = np.array(moving, int)
        start = np.array([self.pieces[k].start for k in moving])
        h = np.array([self.pieces[k].stop - self.pieces[k].start for k in moving])
        if self.grows:
            h[-1] *= SHORT
        done = []
        for halving in range(HALVINGS + 1):
            local = self._local(piece, start, h)
            bad = local.unresolved(RESOLVED) & (halving < HALVINGS)
            if self.grows:
                bad &= start < self.pieces[-1].start  # the longer the last panel, the better it goes on
            done.append((piece[~bad], start[~bad], h[~bad], local.series[~bad]))
            if not bad.any():
                break
            half = 0.5 * h[bad]
            piece, h = np.tile(piece[bad], 2), np.tile(half, 2)
            start = np.concatenate([start[bad], start[bad] + half])
        columns = [np.concatenate(column) for column in zip(*done, strict=True)]
        order = np.argsort(columns[1])
        piece, start, h, series = (column[order] for column in columns)
        return piece, start, Local(h, series)

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
        laws = [law for k in piece.tolist() if isinstance(law := self.pieces[k].law, Rubbing)]
        sides = (np.array([law.way * law.side for law in laws]), np.array([law.pressed for law in laws]))
        model, state = self.run.model, (along.theta, along.omega, along.alpha)
        signs = Signs(*sides, model.sign)
        return rubbing_slopes(lambda names: self.values(names, *state, mu=0.0), model.mu, signs, by)

    def _along(self, piece: Array, start: Array, h: Array) -> Along:
        t = start[:, None] + h[:, None] * PLACES
        rows = np.empty((3, *t.shape))
        for row, k in enumerate(piece.tolist()):
            rows[:, row] = self._states(self.pieces[k], t[row])
        return Along(t, *rows)

    def _states(self, piece: Piece, t: Array) -> Array:
        """Angle, speed and acceleration at instants of a piece."""
        self.cuts.hold(piece)
        found = np.empty((3, t.size))
        for k, (q, v, _) in enumerate(piece.state(t).T.tolist()):
            theta, omega, _ = state_of(self.run.model, q, v)
            found[:, k] = theta, omega, piece.law.alpha(float(t[k]), theta, omega)
        return found

    # ---- from the start to the end ------------------------------------------------------------

    def _joined(self, piece: Array, start: Array, local: Local) -> Trajectories:
        """The course of theta_p and omega_p through all pieces."""
        x, v = (np.array([float(p == own) for p in self.wrt]) for own in STARTS)
        rows: list[tuple[float, float, Array, Array, Array]] = []
        for k, one in enumerate(self.pieces):
            if k:
                v = v + self.cuts.jump(self.pieces[k - 1], one, x, v)
            if isinstance(one.law, Resting):
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

    def at(self, piece: Piece, t: float) -> Along:
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


def _with_long_end(pieces: Sequence[Piece], ends: Sequence[float]) -> list[Piece]:
    """The pieces with the last ones joined, if the motion has one law from well before its limit angle on."""

    def gap(piece: Piece) -> float:
        q = float(piece.state(np.array([piece.start]))[Q, 0])
        return min(abs(end - q) for end in ends)

    first = len(pieces) - 1
    while first and pieces[first - 1].law is pieces[first].law and gap(pieces[first]) < WELL_BEFORE:
        first -= 1
    last = pieces[first:]
    edges = [piece.start for piece in last[1:]]

    def state(t: Array) -> Array:
        return np.stack([last[bisect(edges, x)].state(x) for x in t.tolist()], axis=1)

    return [*pieces[:first], Piece(last[0].start, last[-1].stop, state, last[0].law)]


_END_ONCE, _END_TWICE = ONCE.sum(axis=0), TWICE.sum(axis=0)  # Legendre polynomials are 1 at the end
