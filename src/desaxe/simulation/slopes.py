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
from numpy.polynomial import legendre
from numpy.typing import NDArray

from .events import Q, V
from .history import Motion
from .law import alpha_of
from .loops.compiled import NODES
from .loops.law import DIRECTION, PRESSED, RATE_W, SIDE
from .march import March
from .panel import INTEGRAL, PLACES, RUNNING, SERIES, basis
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
        self.motion = Motion(run)
        self.ends_at_limit = run.status == LIMIT and bool(run.model.coordinate.half)
        self.record = run.record
        self.number, self.start, self.stop = self._stretches()
        self.shifts = Shifts(run, self.tangents, self.number)
        self.course = self._resolved()

    # ---- panels -----------------------------------------------------------------------------

    def _resolved(self) -> Trajectories:
        """The course on the panels of the motion, halved where the derivatives bend more than it does."""
        piece, start = np.arange(self.number.size), self.start
        h, new = self.stop - start, ~self.record.rests[self.number]
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
            piece, local = np.repeat(piece, several), np.repeat(local, several, axis=0)
            start = np.repeat(start, several) + h * second
            self.shifts.notes.clear()
        return course

    def _stretches(self) -> tuple[NDArray[np.intp], Array, Array]:
        """The panels of the motion; with friction those next to a limit angle at its end as one."""
        record = self.record
        number = np.flatnonzero(record.heads[:, 6] > record.heads[:, 0])
        number = number if number.size else np.zeros(1, np.intp)
        stop = record.heads[number, 6]
        if self.ends_at_limit and self.run.model.mu:
            end, law = copysign(0.5 * pi, self.run.y[Q]), record.stretches[number]
            one = (law == law[-1]) & (np.abs(end - record.y[number, Q]) < WELL_BEFORE)
            first = min(int(np.argmin(one[::-1])) if not one.all() else one.size, one.size - 1)
            keep = number.size - max(first, 1)
            number, stop = number[: keep + 1], np.append(stop[:keep], stop[-1])
        return number, record.heads[number, 0], stop

    def _nodes(self, start: Array, h: Array) -> tuple[Array, Array, Array]:
        """Instants, q and v at the nodes of panels."""
        t = start[:, None] + h[:, None] * PLACES
        q, v, _ = self.motion.at(t.reshape(-1))[1]
        return t, q.reshape(t.shape), v.reshape(t.shape)

    def _local(self, piece: NDArray[np.intp], start: Array, h: Array) -> Array:
        """The series on panels for the starts (1, 0) and (0, 1) and for each parameter."""
        laws, nodes = self.record.laws[self.number[piece]], self._nodes(start, h)
        signs = np.stack([laws[:, DIRECTION] * laws[:, SIDE], laws[:, PRESSED]])
        alpha = None
        if self.tangents.several:
            t, q, v = (part.reshape(-1) for part in nodes)
            rows = self.run.law.at(t, q, v, laws, np.arange(piece.size).repeat(NODES))
            alpha = alpha_of(rows).reshape(nodes[0].shape)
        rates = self.tangents.rates(*nodes, signs[:, :, None], alpha)
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
        y, before, law = self._start(), 0, self.record.stretches
        ends, begin = local.sum(axis=2), np.empty((start.size, 2, len(self.wrt)))  # polynomials are 1 there
        rows = zip(self.number[piece].tolist(), ends[..., :2], ends[..., 2:], strict=True)
        for row, (k, gain, forced) in enumerate(rows):
            if law[k] != law[before] and row:
                y = y + self.shifts.jump(before, k, y)
            if self.shifts.rests[k] and self.record.heads[k, 6] > self.record.heads[k, 0]:
                y = y * [[1.0], [0.0]]  # it has not only stopped where it started
            before, begin[row] = k, y
            y = y + gain @ y + forced
        return Trajectories(start, h, begin, local[..., 2:] + local[..., :2] @ begin[:, None])

    def _start(self) -> Array:
        """q_p and v_p at the start."""
        q, v, _ = self.record.y[self.number[0]]
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
            return self.shifts.standstill(event, int(self.number[np.searchsorted(self.stop, event.t)]), y)
        if event.kind == "break-away":
            return self._break_away(event, theta)
        self.shifts.notes.append(f"NaN of {event.kind} at t = {event.t:.6g} s")
        return np.full(len(self.wrt), nan)

    def _rate_at_limit(self) -> float:
        """dq/dt at a limit angle."""
        start, h = self.record.heads[-1, :2]
        s = 2.0 * (self.run.t - start) / h - 1.0
        return float(2.0 / h * legendre.legval(s, legendre.legder(self.record.series[-1, Q])))

    def _break_away(self, event: Event, theta: Array) -> Array:
        """dt/dp of the instant from which the torque moves the crank: T = T_in at barely a speed."""
        torque, row = self.run.model.drive.torque, int(np.searchsorted(self.start, event.t))
        by_time = torque.by_time(event.t, event.theta, 0.0)
        if row == self.start.size or by_time != by_time:
            self.shifts.notes.append(
                f"NaN of break-away at t = {event.t:.6g} s, but for a derivative= that returns dT/dt, too"
            )
            return np.full(len(self.wrt), nan)
        law = self.record.laws[self.number[row]]
        if self.shifts.accelerates(self.run.law.alpha(event.t, event.theta, 0.0, law)):
            return np.zeros(len(self.wrt))  # the torque jumps at an instant of its own
        middle = np.array([0.5 * (self.start[row] + self.stop[row])])
        direction = copysign(BARELY, self.motion.at(middle)[1][V, 0])
        names = [f"T_in_wrt_{p}" for p in ("theta", *self.tangents.of_design)]
        known = self.tangents.values(names, event.theta, direction, mu=self.run.model.friction)
        t, angle, omega = (np.array([number]) for number in (event.t, event.theta, 0.0))
        by_theta = np.ravel(torque.slopes(t, angle, omega)[1])[0] - known["T_in_wrt_theta"]
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
        power = self.run.law.at(t, q, v, self.record.laws[-1])[RATE_W] * ~self.record.rests[-1]
        end = np.array([*self.tangents.energy(q, v, self.course.at(t)), power + np.zeros(t.size)])
        if self.ends_at_limit:
            s = 2.0 * (self.run.t - self.course.start[last]) / self.course.h[last] - 1.0
            end = end @ SERIES.T @ basis(s, NODES - 1)
        begin = self.record.y[self.number[0]]
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
