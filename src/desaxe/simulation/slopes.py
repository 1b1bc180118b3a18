"""The derivatives of a motion by parameters, on the panels of its record.

In q and v = sqrt(M) omega (see `law`) a motion is smooth up to its limit angles, and so are its derivatives
at a fixed time. With q' = omega/(dtheta/dq) and v' = Q/sqrt(M) they obey linear equations, solved like the
motion itself by collocation on each panel, for both starts and for each parameter as right-hand sides of one
matrix; panels are halved where they do not resolve them. At a cut that moves with a parameter, v_p jumps
(`shifts`).
"""

from collections.abc import Mapping, Sequence
from math import copysign, nan, pi
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .events import Q, V
from .history import Motion
from .march import March
from .panel import INTEGRAL, NODES, PLACES, RUNNING, SERIES, Panel, basis
from .result import FAILED, JAMS, LIMIT, SENSITIVITIES, Event, Simulation
from .shifts import Shifts
from .tangents import STARTS, Tangents

Array = NDArray[np.float64]
BARELY = 1e-30  # rad/s: turning, for friction; without an effect of its own
RESOLVED = 1e-8  # of a series: its last terms, at most
LEAST = 1e-12  # of a column's largest coefficient: a panel with less need not resolve it
AT_ONCE = 300  # panels whose matrices stay in the processor's cache
HALVINGS = 10  # of a panel of the motion, at most
WELL_BEFORE = 0.1  # of q: so far from a limit angle the friction has its digits
SHORT, LONG = 0.95, 0.99  # of the last panel before a limit angle, and of several: their nodes have digits
ENDS = ("angle", "standstill", "limit", "no inertia")


class Trajectories(NamedTuple):
    """q_p and v_p (axis 1) of each parameter (the last axis) on consecutive panels, each from its start."""

    start: Array
    h: Array
    y: Array  # panels, 2, parameters
    series: Array  # panels, 2, NODES + 1, parameters: of what is added to y

    def at(self, t: Array) -> Array:
        """Both at instants: 2, parameters, instants; where two panels meet, at the end of the first."""
        panel = np.searchsorted(self.start[1:], t)
        s = (t - self.start[panel]) / np.where(self.h[panel] > 0.0, self.h[panel], 1.0)
        rows = basis(2.0 * s - 1.0, NODES) * (s != 0.0)  # at a start nothing is rounded
        moved = np.einsum("jt,tijp->ipt", rows, self.series[panel])
        return np.asarray(np.moveaxis(self.y[panel], 0, -1) + moved)

    def unresolved(self) -> NDArray[np.bool_]:
        """The panels on which the last terms of a series are too large a share of what it is added to."""
        tail = np.abs(self.series[:, :, -2:]).max(axis=2)
        size = np.abs(self.y) + np.abs(self.series).max(axis=2)
        least = LEAST * np.nanmax(size, axis=0, initial=0.0)
        return np.asarray((tail > RESOLVED * np.maximum(size, least)).any(axis=(1, 2)))


class MotionSlopes:
    """The derivatives of one motion by parameters; inputs: of the mechanism, for `tangents`."""

    def __init__(self, run: March, wrt: Sequence[str], inputs: Mapping[str, Any]) -> None:
        self.run, self.wrt, self.tangents = run, tuple(wrt), Tangents(run.model, wrt, inputs)
        self.shifts = Shifts(run, self.tangents)
        self.motion = Motion(run)
        self.ends_at_limit = run.status == LIMIT and bool(run.model.coordinate.half)
        self.pieces = self._stretches()
        self.course = self._resolved()

    # ---- panels -----------------------------------------------------------------------------

    def _resolved(self) -> Trajectories:
        """The course on the panels of the motion, halved where the derivatives bend more than it does."""
        piece = np.arange(len(self.pieces))
        start, stop = (np.array([getattr(one, name) for one in self.pieces]) for name in ("start", "stop"))
        h, new = stop - start, ~np.array([one.law.rests for one in self.pieces])
        local = np.zeros((piece.size, 2, NODES + 1, 2 + len(self.wrt)))
        if self.ends_at_limit:
            h[-1] *= LONG if self.run.model.mu else SHORT
        for _ in range(HALVINGS):
            for rows in np.array_split(np.flatnonzero(new), new.sum() // AT_ONCE + 1):
                if rows.size:
                    local[rows] = self._local(piece[rows], start[rows], h[rows])
            course = self._joined(piece, start, h, local)
            bad = course.unresolved()
            if self.ends_at_limit:
                bad[-1] = False  # the longer the last panel, the better it goes on
            if not bad.any():
                break
            several, new = 1 + bad, np.repeat(bad, 1 + bad)
            second = new & (np.cumsum(new) % 2 == 0)
            h = np.repeat(np.where(bad, 0.5 * h, h), several)
            piece, start, local = (np.repeat(part, several, axis=0) for part in (piece, start, local))
            start = start + h * second
            self.shifts.notes.clear()
        return course

    def _stretches(self) -> list[Panel]:
        """The panels of the motion; with friction those next to a limit angle at its end as one."""
        panels = self.run.panels
        pieces = [panel for panel in panels if panel.stop > panel.start] or panels[:1]
        last = pieces.pop()
        if self.ends_at_limit and self.run.model.mu:
            end = copysign(0.5 * pi, self.run.y[Q])
            while pieces and pieces[-1].law is last.law and abs(end - last.y[Q]) < WELL_BEFORE:
                last = pieces.pop()._replace(stop=last.stop)
        return [*pieces, last]

    def _nodes(self, start: Array, h: Array) -> tuple[Array, Array, Array]:
        """Instants, q and v at the nodes of panels."""
        t = start[:, None] + h[:, None] * PLACES
        q, v, _ = self.motion.at(t.reshape(-1))[1]
        return t, q.reshape(t.shape), v.reshape(t.shape)

    def _local(self, piece: NDArray[np.intp], start: Array, h: Array) -> Array:
        """The series on panels for the starts (1, 0) and (0, 1) and for each parameter."""
        laws = [self.pieces[k].law for k in piece.tolist()]
        signs = np.array([[law.direction * law.side, law.pressed] for law in laws]).reshape(-1, 2)
        rates = self.tangents.rates(*self._nodes(start, h), signs.T[:, :, None])
        jacobian, forcing = rates[:, :2].transpose(2, 0, 1, 3), rates[:, 2:].transpose(2, 0, 3, 1)
        width = h[:, None, None, None]
        matrix = -width[..., None] * RUNNING[:, None, :] * jacobian[:, :, None]
        square = matrix.reshape(-1, 2 * NODES, 2 * NODES)
        square[:, range(2 * NODES), range(2 * NODES)] += 1.0
        right = np.zeros((h.size, 2, NODES, 2 + len(self.wrt)))
        right[:, 0, :, 0] = right[:, 1, :, 1] = 1.0
        right[..., 2:] = width * (RUNNING @ forcing)
        state = np.linalg.solve(square, right.reshape(h.size, 2 * NODES, 2 + len(self.wrt))).reshape(
            right.shape
        )
        slopes = np.einsum("neik,nikp->nekp", jacobian, state)
        slopes[..., 2:] += forcing
        return np.asarray(width * (INTEGRAL @ slopes))

    def _joined(self, piece: NDArray[np.intp], start: Array, h: Array, local: Array) -> Trajectories:
        """The course through all pieces."""
        y, before = self._start(), self.pieces[0]
        ends, begin = local.sum(axis=2), np.empty((start.size, 2, len(self.wrt)))  # polynomials are 1 there
        rows = zip(piece.tolist(), ends[..., :2], ends[..., 2:], strict=True)
        for row, (k, gain, forced) in enumerate(rows):
            own = self.pieces[k]
            if own.law is not before.law:
                y = y + self.shifts.jump(before, own, y)
            if own.law.rests and own.stop > own.start:  # it has not only stopped where it started
                y = y * [[1.0], [0.0]]
            before, begin[row] = own, y
            y = y + gain @ y + forced
        return Trajectories(start, h, begin, local[..., 2:] + local[..., :2] @ begin[:, None])

    def _start(self) -> Array:
        """q_p and v_p at the start."""
        q, v, _ = np.array(self.pieces[0].y)
        by_theta, by_omega = self.tangents.speeds(q, v)
        theta, omega = (self.tangents.flags(name) for name in STARTS)
        of_q = (theta - by_theta[2:]) / by_theta[0]
        return np.stack([of_q, (omega - by_omega[0] * of_q - by_omega[2:]) / by_omega[1]])

    # ---- results ---------------------------------------------------------------------------------

    def histories(self, t: Array, q: Array, v: Array) -> tuple[Array, Array]:
        """theta_p and omega_p at instants, a row for each parameter."""
        y = self.course.at(t)
        theta, omega = (rows[0] * y[0] + rows[1] * y[1] + rows[2:] for rows in self.tangents.speeds(q, v))
        return theta, omega

    def of_events(self) -> list[Array]:
        """dt/dp of each event, from the side it is met from."""
        t = np.array([event.t for event in self.run.events])
        y, q = np.moveaxis(self.course.at(t), -1, 0), self.motion.at(t)[1][Q]
        return list(map(self._of_event, self.run.events, q, y))

    def _of_event(self, event: Event, q: float, y: Array) -> Array:
        theta = self.tangents.angle(q, y)
        if event.kind in ("dead centre", "no inertia"):
            return self.shifts.passage(event.t, event.omega, self.shifts.dead_centre(event), theta)
        if event.kind == "limit" and self.ends_at_limit:
            return np.asarray(-y[0] / self._rate_at_limit())
        if event.kind in ("angle", "limit"):
            last = event.kind == "limit"
            shift = self.tangents.limit(event.theta) if last else np.zeros(len(self.wrt))
            return self.shifts.passage(event.t, event.omega, shift, theta)
        if event.kind == "standstill":
            piece = next(one for one in self.pieces if one.stop >= event.t)
            return self.shifts.standstill(event, piece, y)
        if event.kind == "break-away":
            return self._break_away(event, theta)
        self.shifts.notes.append(f"NaN of {event.kind} at t = {event.t:.6g} s")
        return np.full(len(self.wrt), nan)

    def _rate_at_limit(self) -> float:
        """dq/dt at a limit angle."""
        record = self.run.record
        start, h = record.heads[-1, :2]
        s = np.array([2.0 * (self.run.t - start) / h - 1.0])
        return float(record.rates[-1, Q] @ SERIES.T @ basis(s, NODES - 1)[:, 0])

    def _break_away(self, event: Event, theta: Array) -> Array:
        """dt/dp of the instant from which the torque moves the crank: T = T_in at barely a speed."""
        torque, after = (
            self.run.model.drive.torque,
            next((p for p in self.pieces if p.start >= event.t), None),
        )
        by_time = torque.by_time(event.t, event.theta, 0.0)
        if after is None or by_time != by_time:
            self.shifts.notes.append(
                f"NaN of break-away at t = {event.t:.6g} s, but for a derivative= that returns dT/dt, too"
            )
            return np.full(len(self.wrt), nan)
        if self.shifts.accelerates(float(after.law.alpha(event.t, event.theta, 0.0))):
            return np.zeros(len(self.wrt))  # the torque jumps at an instant of its own
        middle = np.array([0.5 * (after.start + after.stop)])
        direction = copysign(BARELY, self.motion.at(middle)[1][V, 0])
        names = [f"T_in_wrt_{p}" for p in ("theta", *self.tangents.of_design)]
        known = self.tangents.values(names, event.theta, direction, mu=self.run.model.friction)
        t, angle, omega = (np.array([number]) for number in (event.t, event.theta, 0.0))
        by_theta = np.ravel(torque.slopes(t, angle, omega).theta)[0] - known["T_in_wrt_theta"]
        pushes = [float(p == "torque") - known.get(f"T_in_wrt_{p}", 0.0) for p in self.wrt]
        return np.asarray(-(by_theta * theta + np.array(pushes)) / by_time)

    def of_end(self, of_events: Sequence[Array]) -> Array:
        """The derivative of the instant at which the motion ends."""
        run = self.run
        if run.status in (FAILED, JAMS):
            return np.full(len(self.wrt), nan)
        ended = run.events and run.events[-1].t == run.t and run.events[-1].kind in ENDS
        return of_events[-1] if ended else np.zeros(len(self.wrt))

    def of_work(self, of_end: Array) -> Array:
        """The derivative of the work, which is the change of both energies, up to the end.

        Next to a limit angle derivatives of the potential energy have no digits: from the nodes of the last
        panel a series goes on.
        """
        t, (q, v, _), last = np.array([self.run.t]), self.run.y[:, None], slice(-1, None)
        if self.ends_at_limit:
            t, q, v = (rows[0] for rows in self._nodes(self.course.start[last], self.course.h[last]))
        power = self.pieces[-1].law.rates(t, q, v).work
        end = np.array([*self.tangents.energy(q, v, self.course.at(t)), power + np.zeros(t.size)])
        if self.ends_at_limit:
            s = 2.0 * (self.run.t - self.course.start[last]) / self.course.h[last] - 1.0
            end = end @ SERIES.T @ basis(s, NODES - 1)
        begin = self.pieces[0].y
        return np.asarray(
            end[:-1, 0] + end[-1, 0] * of_end - self.tangents.energy(begin[Q], begin[V], self.course.y[0])
        )


def add_slopes(result: Simulation, run: March, wrt: Sequence[str], inputs: Mapping[str, Any]) -> None:
    """Add theta_wrt_<p>, omega_wrt_<p>, t_last_wrt_<p> and work_wrt_<p>, and `wrt` of each event."""
    t = result["t"]
    with np.errstate(all="ignore"):
        slopes = MotionSlopes(run, wrt, inputs)
        of_events = slopes.of_events()
        ended = slopes.of_end(of_events)
        work = slopes.of_work(ended)
        theta, omega = slopes.histories(t, *slopes.motion.at(t)[1][:2])
        if slopes.ends_at_limit:
            omega[:, t >= run.t] = -result["alpha"][t >= run.t] * ended[:, None]
    for k, p in enumerate(wrt):
        result[f"theta_wrt_{p}"], result[f"omega_wrt_{p}"] = theta[k].copy(), omega[k].copy()
        result[f"t_last_wrt_{p}"], result[f"work_wrt_{p}"] = float(ended[k]), float(work[k])
    result["events"] = [
        event._replace(wrt=dict(zip(wrt, own.tolist(), strict=True)))
        for event, own in zip(result["events"], of_events, strict=True)
    ]
    notes = slopes.shifts.notes
    if not notes and not (np.isfinite(theta).all() and np.isfinite([ended, work]).all()):
        notes = ["NaN where the forces have no derivatives, or none is known"]
    if notes:
        result["message"] += SENSITIVITIES + "; ".join(dict.fromkeys(notes))
