"""The motion of one design, step by step: cut at every kink, at rest while friction holds the crank."""

from collections.abc import Callable
from math import copysign, inf
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..mechanism.closed import TURN
from ..support.deadline import Deadline
from ..support.extras import needed
from .checks import LEAST_RTOL
from .equations import Law, Resting, Smooth, State, state_of
from .events import (
    JAMMED,
    KINK,
    LOST,
    NEVER,
    SHORT,
    STANDSTILL,
    Crossing,
    IntegrationStep,
    Mark,
    Q,
    V,
    angle_of,
    events_in,
    failure,
    marks_of,
    root,
    time_of,
    words_of,
)
from .friction import Contact, Rubbing, breaks_away, contact, hold, side_ahead, ways_to_start
from .model import Model
from .result import DONE, FAILED, JAMS, REST, Event
from .stepper import Dop853

Array = NDArray[np.float64]
SAME = 1e-9  # of a step: events so close together are one instant
MOST_TURNS = 100_000  # in one step
AT_LIMIT = 1e-9  # rad: so near to a limit a load on a massless slider has grown without bound
ROUNDING = 1e-16  # of an angle
CHATTER = 20  # standstills in a row, all within a millionth of the time


class StepControl(NamedTuple):
    """The control of the integration: method, tolerances, sizes of (q, v, W), limits of steps."""

    method: str
    rtol: float
    atol: Array
    size: Array
    max_step: float
    max_steps: int


class Piece(NamedTuple):
    """A stretch of the motion: start, stop, the state as a function of time, the equations in force."""

    start: float
    stop: float
    state: Callable[[Any], Array]
    law: Law


class AtRest:
    """The state of a crank that rests."""

    def __init__(self, y: Array) -> None:
        self.y = y

    def __call__(self, t: Any) -> Array:
        """The state at each instant: it does not change."""
        return np.multiply.outer(self.y, np.ones(np.shape(t)))


class MotionRun:
    """One motion, from its start to its end."""

    def __init__(
        self,
        model: Model,
        y: Array,
        t_end: float,
        until: tuple[float, ...],
        tolerance: StepControl,
        deadline: Deadline,
    ) -> None:
        self.model, self.t_end, self.tolerance, self.deadline = model, t_end, tolerance, deadline
        self.t, self.y = 0.0, y
        self.status = NEVER
        self.message = ""
        self.pieces: list[Piece] = []
        self.accepted: list[tuple[float, Array]] = [(0.0, y)]
        self.events: list[Event] = []
        self.left = model.coordinate.place(y[Q])[
            0
        ]  # an angle that the motion starts from is not reached again
        self.next_step: float | None = None
        self.steps = 0
        self.pressed: float | None = None  # the side of the guide after a change of side
        self.marks = marks_of(model, until)

    def to_the_end(self) -> "MotionRun":
        """Run until the end time, or what comes before it."""
        while self.status == NEVER:
            try:
                self._stretch()
            except TimeoutError:  # of a load, or of the search for events
                if not self.deadline.over:
                    raise
                self._late()
        self.deadline.lift()
        for held in self.model.drive.held:
            held.release()
        if not self.pieces:  # stopped where it started
            self._keep_still(0.0)
        return self

    def _stretch(self) -> None:
        """Move on to the next kink, or the end."""
        law = self._law()
        if law is not None:
            self._follow(law)

    def _late(self) -> None:
        reason = f"not done within timeout = {self.deadline.seconds:g} s, after {self.steps} steps"
        self.deadline.lift()
        self._fail(Smooth(self.model), reason)

    def stop(self, status: int, message: str) -> None:
        """End the motion."""
        self.status, self.message = status, message

    def tell(self, kind: str, state: State, which: str = "") -> None:
        """Record an event at the current instant."""
        self.events.append(Event(kind, self.t, state.theta, state.omega, which))

    @property
    def state(self) -> State:
        """The current state of the crank."""
        return state_of(self.model, float(self.y[Q]), float(self.y[V]))

    def _starts(self) -> bool:
        """Hold each load to its piece ahead, at rest in the way that starts; False if loads oppose either."""
        theta, omega, _ = self.state
        if omega or not self.model.drive.held:
            hold(self.model, theta, copysign(1.0, omega))
            return True
        for way in (1.0, -1.0):
            hold(self.model, theta, way)
            if way * Smooth(self.model).alpha(self.t, theta, 0.0) >= 0.0:
                return True
        return False

    # ---- which law holds ----------------------------------------------------------------------

    def _law(self) -> Law | None:
        """The law from here on; None where the motion has been stopped, or waits."""
        starts = self._starts()
        if self.model.mu == 0.0 and starts:
            return Smooth(self.model)
        if self.y[V] == 0.0:
            return self._from_rest()
        theta, omega, branch = self.state
        way = copysign(1.0, omega)
        side = side_ahead(self.model, theta, branch, way)
        here = contact(self.model, self.t, theta, branch, omega, way, side)
        return self._rubbing(way, side, here)

    def _rubbing(self, way: float, side: float, here: Contact) -> Law | None:
        """The law with friction, if exactly one set of forces balances."""
        pressed, self.pressed = self.pressed or here.pressed, None
        if abs(here.normal_free) <= here.noise:
            pressed = self._pressed_soon(way, side, pressed)
        if here.solutions != 1:
            self._jam(here.solutions)
            return None
        return Rubbing(self.model, way, side, pressed)

    def _pressed_soon(self, way: float, side: float, now: float) -> float:
        """The sign of the normal force just after it has vanished, from the motion without friction."""
        y, law = self.y.copy(), Smooth(self.model)
        ahead = min(1e-6 * self.t_end, self.next_step or inf)
        y += ahead * np.array(law.rate(self.t, y))
        theta, omega, branch = state_of(self.model, float(y[Q]), float(y[V]))
        soon = contact(self.model, self.t + ahead, theta, branch, omega, way, side)
        return soon.pressed if abs(soon.normal_free) > soon.noise else now

    def _jam(self, solutions: int) -> None:
        state = self.state
        which = "no forces balance" if solutions == 0 else "two sets of forces balance"
        self.tell(JAMMED.kind, state, which)
        where = "at t = " + time_of(self.t) + ", theta = " + angle_of(state.theta)
        self.stop(JAMS, "the friction jams " + where + f": {which}")

    # ---- at rest --------------------------------------------------------------------------------

    def _from_rest(self) -> Law | None:
        """Start if the torque can move the crank, else wait for it."""
        theta, _, branch = self.state
        ways = ways_to_start(self.model, self.t, theta, branch)
        if len(ways) == 2:
            self._jam(2)
            return None
        if ways:
            way, here = ways[0]
            return self._rubbing(way, side_ahead(self.model, theta, branch, way), here)
        self._rest(theta, branch)
        return None

    def _rest(self, theta: float, branch: float) -> None:
        """Wait for the torque or load to break the crank away."""
        start, self.next_step = self.t, None
        if self.model.drive.steady:
            why = " on: the torque cannot move the crank there"
            self.stop(REST, "at rest from t = " + time_of(start) + why)
            return
        moves = breaks_away(self.model, theta, branch, start, self.t_end)
        self.t = self.t_end if moves is None else moves
        self._keep_still(start)
        if moves is None:
            rest = ", at rest from t = " + time_of(start) + " on"
            self.stop(DONE, "reached t_end = " + time_of(self.t_end) + rest)
        else:
            self.tell("break-away", self.state)

    def _keep_still(self, start: float) -> None:
        self.pieces.append(Piece(start, self.t, AtRest(self.y), Resting()))
        self.accepted.append((self.t, self.y))

    # ---- in motion ----------------------------------------------------------------------------

    def _solver(self, law: Law, t: float, y: Array, t_bound: float) -> Any:
        how = self.tolerance
        first = None if self.next_step is None else min(self.next_step, t_bound - t)
        # An angle counts absolutely, however many turns it has made; implicit methods take one rtol only.
        several = np.array([ROUNDING, how.rtol, how.rtol])
        if how.method == "DOP853":
            return Dop853(law.rate, t, y, t_bound, several, how.atol, how.size, how.max_step, first)
        several[Q] = LEAST_RTOL
        with needed(f"simulate: method={how.method}", "simulate"):
            from scipy import integrate
        rtol = how.rtol if how.method in ("Radau", "BDF") else several
        return getattr(integrate, how.method)(
            law.rate, t, y, t_bound, rtol=rtol, atol=how.atol, max_step=how.max_step, first_step=first
        )

    def _follow(self, law: Law) -> None:
        """Integrate to the next kink, or the end."""
        solver = self._solver(law, self.t, self.y, self.t_end)
        while solver.status == "running":
            self.steps += 1
            with np.errstate(invalid="ignore", over="ignore"):  # trials beyond a limit are NaN
                reason = solver.step()
            if solver.status == "failed" or self.steps > self.tolerance.max_steps:
                reason = reason or f"more than {self.tolerance.max_steps} steps"
                self._fail(law, reason)
                return
            if self.deadline.over:
                self._late()
                return
            self.next_step = solver.t - self.t
            step = IntegrationStep(law, self.t, self.y, solver.dense_output(), solver.t)
            turns = abs(float(solver.y[Q]) - float(self.y[Q])) / TURN
            if not turns <= MOST_TURNS:
                self._fail(law, f"{turns:.3g} turns in one step, at most {MOST_TURNS}: give max_step=")
                return
            if self._meet_all(step):
                return
            self._accept(Piece(step.t, step.end, step.inside, law), solver.y.copy())
            self.left = inf
        self.stop(DONE, "reached t_end = " + time_of(self.t_end))

    def _accept(self, piece: Piece, y: Array) -> None:
        self.pieces.append(piece)
        self.t, self.y = float(piece.stop), y
        self.accepted.append((self.t, y))

    def _fail(self, law: Law, reason: str) -> None:
        state = self.state
        if isinstance(law, Rubbing):
            here = law.at(self.t, state.theta, state.branch, state.omega)
            if here.solutions != 1 or 1.0 - law.pressed * here.wedge < 1e-3:
                self._jam(0)
                return
        for mark in self.marks:
            if mark.kind == "limit" and abs(mark.angle - state.theta) < AT_LIMIT:
                self._tell_end(Crossing(self.t, mark, Q, float(self.y[Q])))
                return
        self.stop(FAILED, failure(self.t, state.theta, state.omega, reason))

    def _meet_all(self, step: IntegrationStep) -> bool:
        """Record the events of a step; return True if one of them cuts the motion."""
        found = events_in(step, self.model, self.marks, self.left, self.deadline.check)
        events = [event for event in found if event.t <= self.t_end]
        place = 0
        while place < len(events):
            last = events[place].t + SAME * (step.end - step.t)
            start = place
            while place < len(events) and events[place].t <= last:
                place += 1
            now = events[start:place]
            if isinstance(step.law, Rubbing) or any(self._ends_stretch(event.mark) for event in now):
                self._cut_at(now, step)
                return True
            for event in now:
                self._note(event, step)
            if self._chatters():
                return True
        return False

    def _ends_stretch(self, mark: Mark) -> bool:
        """True where the motion ends, a load has a kink, or turns round with the slider."""
        turned = mark is STANDSTILL and any(held.turns_with_the_slider for held in self.model.drive.held)
        return mark.status != NEVER or mark.kind == KINK or turned

    def _note(self, found: Crossing, step: IntegrationStep) -> None:
        """Record an event that does not cut the motion."""
        y = step.inside(found.t)
        self._tell_of(found, state_of(self.model, float(y[Q]), float(y[V])))

    def _tell_of(self, found: Crossing, state: State) -> None:
        """Record an event with its exact angle, or with exactly zero speed."""
        mark = found.mark
        if mark.kind == KINK:
            return
        theta = self.model.coordinate.place(found.value)[0] if found.place == Q else state.theta
        theta = mark.angle if mark.kind in ("limit", "angle") else theta
        omega = 0.0 if mark is STANDSTILL else state.omega
        which = "" if mark.kind == "limit" else mark.which
        self.events.append(Event(mark.kind, float(found.t), theta, omega, which))

    def _cut_at(self, now: list[Crossing], step: IntegrationStep) -> None:
        """End this stretch at events of one instant: what ends the motion leads, then an angle."""
        leader = min(now, key=lambda event: (event.mark.status == NEVER, event.place < 0))
        t, y = self._cut(leader, step)
        for other in now:
            if other is not leader and other.mark is not LOST:
                self._note(other, step)
        self._accept(Piece(step.t, t, step.inside, step.law), y)
        self.left = self.model.coordinate.place(leader.value)[0] if leader.place == Q else inf
        if isinstance(step.law, Rubbing) and any(event.mark is LOST for event in now):
            self.pressed = -step.law.pressed
        if leader.mark is JAMMED and isinstance(step.law, Rubbing):
            state = self.state
            here = step.law.at(t, state.theta, state.branch, state.omega)
            self._jam(0 if here.wedge * step.law.pressed > 0.0 else 2)
        elif leader.mark is not LOST:
            self._tell_end(leader._replace(t=t))

    def _tell_end(self, found: Crossing) -> None:
        """Record the event at which a stretch ends, and stop if the motion ends with it."""
        mark = found.mark
        limit = mark.kind == "limit"
        self._tell_of(found, State(mark.angle, self._speed_at_limit(), 1.0) if limit else self.state)
        if mark.status != NEVER:
            self.stop(mark.status, words_of(mark, found.t))

    def _chatters(self) -> bool:
        """True if the crank chatters at standstill, due to a torque that jumps with the sign of its speed."""
        last = self.events[-CHATTER:]
        kinds = {event.kind for event in last}
        if len(last) < CHATTER or kinds != {"standstill"} or last[-1].t - last[0].t > 1e-6 * self.t_end:
            return False
        why = " on: torque or load jumps where omega changes its sign; let it change over a range of omega"
        self.stop(FAILED, "the crank chatters at standstill from t = " + time_of(last[0].t) + why)
        return True

    def _speed_at_limit(self) -> float:
        """0 with a massive rod or slider; else the crank runs into the limit."""
        return 0.0 if self.model.coordinate.half else self.state.omega

    def _cut(self, found: Crossing, step: IntegrationStep) -> tuple[float, Array]:
        """The instant of an event and the state there, integrated to, not interpolated."""
        if found.mark.kind == "limit":
            return self._cut_at_limit(found, step)
        t = found.t
        for _ in range(2):
            y = self._step_to(step, t)
            if found.place < 0:
                return t, y
            slope = step.law.rate(t, y)[found.place]
            miss = (found.value - y[found.place]) / slope if slope else 0.0
            t = min(max(t + miss, step.t), step.end)
        y[found.place] = found.value
        return t, y

    def _cut_at_limit(self, found: Crossing, step: IntegrationStep) -> tuple[float, Array]:
        """Cut at a limit angle, next to which S and the rates lose their digits.

        Integrated to a little before it; the interpolant tells what is left.
        """
        t, y = found.t, step.inside(found.t)
        short = found.value - copysign(SHORT, found.value - step.y[Q])
        if (step.y[Q] - short) * (found.value - short) < 0.0:
            near = root(lambda t: float(step.inside(t)[Q]) - short, step.t, t)
            off = self._step_to(step, near) - step.inside(near)
            t -= float(off[Q]) * (t - near) / (found.value - short)
            y += off
        y[Q] = found.value
        return t, y

    def _step_to(self, step: IntegrationStep, t: float) -> Array:
        """The state at an instant inside a step."""
        if t - step.t <= 1e-15 * abs(t):
            return step.y.copy()
        solver = self._solver(step.law, step.t, step.y, t)
        while solver.status == "running":
            solver.step()
        y: Array = solver.y.copy()
        return y
