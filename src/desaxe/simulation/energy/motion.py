"""The motion of one design in its energy form, up to its end, with all events on the way."""

from collections.abc import Callable, Mapping, Sequence
from math import copysign, isfinite, nan
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...loads.load import Load
from ...mechanism.names import LENGTHS, LOADS
from ...support.deadline import Deadline
from ...support.interrupts import stopped_early
from ..events import NEAR, STANDSTILL, Mark, angles_of, failure, time_of, words_of
from ..history import Ended, instants_of, result_of
from ..model import Model
from ..result import DONE, FAILED, LIMIT, Event, Simulation
from .many import TOO_WIDE, FollowedMotions, follow_many
from .panels import Designs
from .path import Path, path_of
from .serves import ENERGY, served

Array = NDArray[np.float64]
BRIEF = 500.0  # pieces of a motion that stays in the thread of the caller
SAME = 1e-12  # of an instant: events so close together are one


class Instants(NamedTuple):
    """Instants, which ascend, and the motion there; the last one is how far it is followed."""

    times: Array
    found: FollowedMotions


class MotionOverAngle(NamedTuple):
    """A motion over the crank angle and its end at the instant t.

    reach   how far it is followed: a limit angle is met before
    long    whether it has many pieces
    asked   where it is known up to there already
    alpha   the acceleration at a limit angle
    """

    designs: Designs
    rtol: float
    reach: float
    long: bool
    asked: Instants | None
    t: float
    status: int
    message: str
    events: list[Event]
    alpha: float = nan

    def found(self, t: Array) -> FollowedMotions:
        """The motion at instants, which ascend, and behind them at its end."""
        if self.asked and t.size < self.asked.times.size and np.array_equal(self.asked.times[: t.size], t):
            found = self.asked.found
        else:
            found = self._followed(np.append(t, self.reach))
        if self.events and self.status != FAILED and self.events[-1].t == self.t:
            ends = np.flatnonzero(t >= self.t * (1.0 - SAME))
            found.theta[0, ends], found.omega[0, ends] = self.events[-1].theta, self.events[-1].omega
            if self.status == LIMIT:
                found.alpha[0, ends] = self.alpha
        return found

    def states(self, t: Array) -> tuple[Array, Array]:
        """Angle and speed at instants."""
        order = np.argsort(t, kind="stable")
        found, theta, omega = self.found(t[order]), np.empty(t.size), np.empty(t.size)
        theta[order], omega[order] = found.theta[0, : t.size], found.omega[0, : t.size]
        return theta, omega

    def result(self, names: Sequence[str], times: Any, inputs: Mapping[str, Any]) -> Simulation:
        """The result of the motion; inputs: its own, for `names`."""
        t = instants_of(times, self.t)
        found = self.found(t)
        histories = [history[0, : t.size] for history in (found.theta, found.omega, found.alpha)]
        _, residual, work, rounded = found.numbers[0].tolist()
        facts = self.t, self.status, self.message, self.events, ENERGY, self.rtol
        return result_of(t, histories, Ended(*facts, residual, rounded, work, self.states), names, inputs)

    def _followed(self, times: Array) -> FollowedMotions:
        most = np.array([np.inf])

        def work() -> FollowedMotions:
            return follow_many(self.designs, times, self.rtol, most)

        return _heeded(work, most, Deadline("simulate", None)) if self.long else work()


def motion_of(
    model: Model, designs: Designs, until: Sequence[float], times: Array, rtol: float, most: int,
    deadline: Deadline,
) -> MotionOverAngle | None:  # fmt: skip
    """The motion of one design up to the last instant; None where it has no energy form that ends.

    times   at which it will be asked for
    """
    if not served(designs).all() or model.vanishing():
        return None
    t_end = float(times[-1])
    asked = times[-1:] if until else times
    path, found, late = _path(designs, asked, rtol, float(most), deadline)
    if path.status >= TOO_WIDE:
        return None
    events = _events(path, angles_of(model, until), path.t if path.status else t_end)
    long = len(path.pieces) > BRIEF
    known = None if asked.size == 1 or long else Instants(asked, found)
    message = "reached t_end = " + time_of(t_end)
    motion = MotionOverAngle(designs, rtol, t_end, long, known, t_end, DONE, message, [])
    last = next((k for k, (_, mark) in enumerate(events) if mark.status == DONE), None)
    if last is not None:
        return _up_to_event(motion, events, last)
    told = [event for event, _ in events]
    x, rate = path.at_end()
    if path.status == LIMIT:
        mark = Mark("limit", model.coordinate.last if x > 0.0 else model.coordinate.first, status=LIMIT)
        alpha = -copysign(model.coordinate.half * rate * rate, x)
        told.append(Event("limit", path.t, mark.angle, 0.0))
        return motion._replace(
            t=path.t, status=LIMIT, message=words_of(mark, path.t), events=told, alpha=alpha
        )
    if path.status == FAILED:
        theta, slope = designs.place(np.array([[x]]))
        message = failure(path.t, theta.item(), rate * np.ravel(slope)[0], late or f"more than {most} steps")
        motion = motion._replace(reach=path.t, asked=None, t=path.t)
        return motion._replace(status=FAILED, message=message, events=told)
    return motion._replace(events=told)


def _up_to_event(motion: MotionOverAngle, events: Sequence[tuple[Event, Mark]], last: int) -> MotionOverAngle:
    """The motion that ends with one of its events; others of the same instant come before."""
    event, mark = events[last]
    others = (other for other, _ in (*events[:last], *events[last + 1 :]))
    told = [other for other in others if other.t <= event.t * (1.0 + SAME)]
    message = words_of(mark, event.t)
    return motion._replace(reach=event.t, asked=None, t=event.t, message=message, events=[*told, event])


def design_of(
    values: Mapping[str, float], model: Model, torque: Any, force: Any, start: Sequence[float]
) -> Designs:
    """One design as the energy form takes it; torque, force: numbers or tables."""
    inputs = {
        n: v if isfinite(v) else 0.0 for n, v in values.items() if n in (*LENGTHS, *LOADS) and n != "mu"
    }
    if isinstance(force, Load):
        inputs["F_Y"] = 0.0
    arc = model.coordinate
    middle = arc.middle if arc.half else 0.0 if not isfinite(arc.first) else nan
    push, load = (v if isinstance(v, Load) else np.array([float(v)]) for v in (torque, force))
    theta0, omega, *bounds = (np.array([number]) for number in (*start, middle, arc.half))
    return Designs(inputs, model.branch, push, load, theta0, omega, bounds[0], bounds[1])


def _path(
    designs: Designs, times: Array, rtol: float, most: float, deadline: Deadline
) -> tuple[Path, FollowedMotions, str]:
    """The pieces up to the last instant, and why they end before it if the time is over."""
    brief, several = np.array([min(most, BRIEF)]), np.array([most])
    path, found = path_of(designs, times, rtol, brief)
    if path.status != FAILED or brief[0] == most:
        return path, found, ""
    done: list[tuple[Path, FollowedMotions]] = []
    late = ""
    try:
        _heeded(lambda: done.append(path_of(designs, times, rtol, several)), several, deadline)
    except TimeoutError:
        if not done:
            raise
        # Stopped on finer panels it may have begun again.
        done[0] = max((path, found), done[0], key=lambda each: len(each[0].pieces))
        late = f"not done within timeout = {deadline.seconds:g} s, after {len(done[0][0].pieces)} steps"
    return (*done[0], late)


def _heeded(work: Callable[[], Any], most: Array, deadline: Deadline) -> Any:
    """Run compiled work that an interrupt or the end of the time stops."""

    def stop() -> None:
        most[0] = 0.0

    return stopped_early(work, stop, deadline)


def _events(path: Path, marks: Sequence[Mark], end: float) -> list[tuple[Event, Mark]]:
    """All events up to an instant, in order."""
    bounds, found = path.bounds, []
    for mark in (STANDSTILL, *marks):
        stops = mark is STANDSTILL
        places = path.standstills() if stops else path.passages(mark.angle, bool(mark.every), bounds)
        for row, t, theta, omega in zip(*(column.tolist() for column in places), strict=True):
            if t <= end and (stops or row or abs(theta - bounds[0]) > NEAR):
                found.append((Event(mark.kind, t, theta, 0.0 if stops else omega, mark.which), mark))
    return sorted(found, key=lambda pair: pair[0].t)
