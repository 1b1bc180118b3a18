"""The motion of one design: compiled loops make its panels up to each cut, here it rests, fails and ends."""

from collections.abc import Callable
from contextlib import suppress
from ctypes import CFUNCTYPE, c_double, c_int64, c_void_p, cast
from math import copysign, inf, sqrt
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..mechanism.messages import Message, named
from ..support.computed import computed_once
from ..support.deadline import Deadline
from .drive import FunctionCurve
from .events import (
    JAM,
    KINK,
    NEVER,
    STANDSTILL,
    Mark,
    Q,
    V,
    angle_of,
    failure,
    marks_of,
    passages,
    time_of,
    words_of,
)
from .law import Law, Resting, State, state_of
from .loops import march, newton, panels, state
from .loops.compiled import panels as compiled_panels
from .loops.cuts import JAMMED, LIMIT
from .loops.cuts import KINK as AT_ANGLE
from .loops.cuts import STANDSTILL as STILL
from .loops.motions import BESIDE, CROWD, NARROW
from .model import Model
from .panel import NODES, TABLE, Panel, Record, basis
from .pieces import LawNumbers
from .result import DONE, FAILED, JAMS, REST, Event

Array = NDArray[np.float64]
NEXT_TO = 1e-9  # rad: so near to a limit a load on a massless slider has grown without bound
SHARP = 3e-11  # of a radian: a limit angle cannot be told better
CHATTER = 6  # standstills in a row, all within a millionth of the time
FLOOR = 0.01  # of the root of the energy that start and loads suggest: the least size of v
BRIEF = 64  # panels of a call, which neither an interrupt nor a deadline stops
HEAD = 7  # numbers of a panel (see `loops.panels`)
_CALLED = CFUNCTYPE(c_int64, c_int64, c_int64, c_int64)


class Settings(NamedTuple):
    """The relative tolerance, and how many panels are a failure."""

    rtol: float
    max_steps: int


class March:
    """One motion, from its start to its end."""

    def __init__(
        self,
        model: Model,
        start: tuple[float, float],
        t_end: float,
        until: tuple[float, ...],
        settings: Settings,
        deadline: Deadline,
    ) -> None:
        self.model, self.t_end, self.settings, self.deadline = model, t_end, settings, deadline
        self.start, self.status, self.message = start, NEVER, ""
        v = start[1] * sqrt(model.inertia(start[0]))
        self.y = np.array([model.coordinate.q(start[0]), v, 0.0])
        self.events: list[Event] = []
        self.steps, self.stills = 0, list[float]()
        self.marks = marks_of(model, until)
        self.error: BaseException | None = None
        self.stops = False
        self.clock = np.zeros(7)
        self.clock[[panels.T_END, panels.SHARP, panels.LEFT]] = t_end, SHARP, 1.0
        self._law: Law = Law(model, model.drive, 1.0)
        self._kept: list[tuple[Array, ...]] = []
        self._laws = self._as_numbers()
        self.numbers = self._laws.law[0]
        self.cutting = [mark for mark in self.marks if self._cuts(mark)]
        self.kinks = np.array([(m.angle, m.every or inf, m.status) for m in self.cutting]).reshape(-1, 3)
        self.rows, self.matrix = np.zeros((newton.ROWS, NODES)), np.empty((2 * NODES, 2 * NODES))

    def _cuts(self, mark: Mark) -> bool:
        """True where the motion ends, or friction or a function has a kink: pieces end where they end."""
        if mark.kind == KINK:
            return bool(self.numbers[state.CHOOSE])
        return mark.kind in ("angle", "no inertia") or (mark.kind == "dead centre" and self.model.mu != 0.0)

    @property
    def t(self) -> float:
        """The current instant."""
        return float(self.clock[panels.T])

    @property
    def state(self) -> State:
        """The current state of the crank."""
        return state_of(self.model, float(self.y[Q]), float(self.y[V]))

    def to_the_end(self) -> "March":
        """Run until the end time, or what comes before it."""
        try:
            self.scales = np.array([self.settings.rtol, FLOOR * sqrt(self._energy()), 0.0])
            if self.scales[1] == inf:
                self._fail("the energy of the start is beyond every double")
            while self.status == NEVER:
                self._go_on()
        except TimeoutError:  # of a load, or of the search for events
            if not self.deadline.over:
                raise
            reason = f"not done within timeout = {self.deadline.seconds:g} s, after {self.steps} steps"
            self.deadline.lift()
            self._fail(reason)
        self.deadline.lift()
        if not self._kept:  # stopped where it started
            head, ends = (
                np.array([[0.0, 0.0, 0.0, *self.y, 0.0]]),
                np.array([[march.RESTING, 0.0, 0.0, 0.0, 0.0]]),
            )
            self._kept.append((head, np.zeros((1, 3, NODES + 1)), np.zeros((1, 7, NODES)), ends))
        passed = passages(self.model, self.marks, self.record)
        self.events = sorted([*passed, *self.events], key=lambda event: event.t)
        return self

    def _energy(self) -> float:
        """An energy [J] of the size that the motion will have.

        Of the start, of gravity, of what torque and load do in a radian and a crank length; where all are
        nothing, that of a turn in t_end.
        """
        theta, omega = self.state
        still, drive = self.model.still(theta), self.model.drive
        t = np.linspace(0.0, self.t_end, 9)
        sizes = [0.5 * self.y[V] ** 2, abs(self.model.potential(theta)), abs(still.weight)]
        for curve, arm in ((drive.torque, 1.0), (drive.F_Y, self.model.values["AB"])):
            with suppress(ValueError, TimeoutError):  # the motion tells, if it gets there
                sizes.append(arm * float(np.max(np.abs(curve.at(t, theta, omega)))))
        largest = max(float(size) for size in sizes if size == size)
        return largest or float(still.inertia) / self.t_end**2

    # ---- panels -----------------------------------------------------------------------------

    def _go_on(self) -> None:
        """Some panels, and what comes after them."""
        self.deadline.check()
        left = self.settings.max_steps - self.steps
        if left <= 0:
            self._fail(f"more than {self.settings.max_steps} steps")
            return
        most = min(left, BRIEF) + 1
        heads, records, count = np.zeros((most, HEAD)), np.empty((most, 3, NODES + 1)), np.zeros(1)
        rates, ends = np.empty((most, 7, NODES)), np.empty((most, 5))
        if self._kept:
            count[0], heads[0], records[0] = 1.0, self._kept[-1][0][-1], self._kept[-1][1][-1]
        self.error = None
        knots = np.array(self.model.drive.knots, np.float64)
        pieces = self._laws.sheets[0]
        known = self.kinks, knots, pieces, self.numbers, self._laws.data[0], TABLE, self.rows, self.matrix
        code = compiled_panels()(self.y, self.clock, self.scales, *known, heads, records, rates, ends, count)
        made = slice(1, 1 + int(count[0]))
        self.steps += made.stop - 1
        if made.stop > 1:
            self._kept.append((heads[made], records[made], rates[made], ends[made]))
            for start, _, _, q, _, _, stop in heads[made][ends[made, 0] == march.RESTING].tolist():
                if start < stop < self.t_end:
                    angle = float(self.model.coordinate.theta(q))
                    self.events.append(Event("break-away", stop, angle, 0.0))
        if self.error is not None and (self.stops or code in (panels.FAILED, panels.STOPPED)):
            raise self.error
        self._after(code)

    def _after(self, code: int) -> None:
        """Go by what the loops have ended with."""
        if code == panels.FAILED:
            self._fail("no panel of time resolves it, however short")
        elif code == march.RESTS:
            why = " on: the torque cannot move the crank there"
            self.stop(REST, "at rest from t = " + time_of(self.t) + why)
        elif code in (march.NO_BALANCE, march.TWO_BALANCES):
            self._jam(0 if code == march.NO_BALANCE else 2)
        elif code == march.CUT:
            self._cut(*self._kept[-1][3][-1, :2])
        elif self.t >= self.t_end:
            last, rests = self._kept[-1], Message("")
            if last[3][-1, 0] == march.RESTING:
                rests = ", at rest from t = " + time_of(last[0][-1, 0]) + " on"
            self.stop(DONE, "reached t_end = " + time_of(self.t_end) + rests)
        elif self.numbers[state.KERNEL] == 0.0 or self.numbers[state.TORQUE] == state.FUNCTION:
            self._slides()

    def _cut(self, kind: float, row: float) -> None:
        """Record the event at which a panel is cut, and stop if the motion ends with it."""
        if kind == STILL:
            self.tell(STANDSTILL, self.state._replace(omega=0.0))
            self.stills = [t for t in self.stills[1 - CHATTER :] if self.t - t < 1e-6 * self.t_end] + [self.t]
            if len(self.stills) == CHATTER:
                self._chatters()
        elif kind == JAMMED:
            self._jam(0 if row > 0.0 else 2)
        elif kind == LIMIT:
            limits = [mark for mark in self.marks if mark.kind == "limit"]
            self._end_at(limits[int(row)])
        elif kind == AT_ANGLE:
            self._end_at(self.cutting[int(row)])

    def _end_at(self, mark: Mark) -> None:
        limit = mark.kind == "limit"
        omega = 0.0 if limit and self.model.coordinate.half else self.state.omega
        theta = self.state.theta if mark.every else mark.angle
        self.tell(mark.kind, State(theta, omega), "" if limit else mark.which)
        self.stop(mark.status, words_of(mark, self.t))

    def stop(self, status: int, message: str) -> None:
        """End the motion."""
        self.status, self.message = status, message

    def tell(self, kind: str, now: State, which: str = "") -> None:
        """Record an event at the current instant."""
        self.events.append(Event(kind, self.t, now.theta, now.omega, which))

    @computed_once
    def record(self) -> Record:
        """All panels of the motion, which has ended."""
        heads, series, rates, ends = map(np.concatenate, zip(*self._kept, strict=True))
        return Record(heads, series, rates, ends, self.y)

    def law_of(self, k: int) -> Law:
        """The law of the stretch of a panel."""
        stretches = self.record.stretches
        return self._laws_from(np.searchsorted(stretches, stretches[k : k + 1]))[0]

    def _laws_from(self, panels: NDArray[np.intp]) -> list[Law]:
        """The laws of stretches from their first panels, with the pieces that hold in the middle of these."""
        record, model = self.record, self.model
        start, h, stop = record.heads[panels][:, [0, 1, 6]].T
        middle = np.where(h > 0.0, (stop - start) / np.where(h > 0.0, h, 1.0) - 1.0, 0.0)
        moved = np.einsum("kt,tik->it", basis(middle, NODES), record.series[panels])
        theta, omega = state_of(model, *(record.y[panels].T + moved)[: V + 1])
        rows = zip(theta.tolist(), omega.tolist(), record.ends[panels].tolist(), strict=True)
        return [
            Resting(model, model.drive)
            if end[0] == march.RESTING
            else Law(model, model.drive.ahead(angle, speed, end[2]), *end[2:])
            for angle, speed, end in rows
        ]

    @computed_once
    def panels(self) -> list[Panel]:
        """The panels of the motion, which has ended."""
        record = self.record
        stretches = record.stretches
        laws = self._laws_from(np.flatnonzero(np.diff(stretches, prepend=-1)))
        rows = zip(stretches.tolist(), record.heads.tolist(), strict=True)
        return [Panel(laws[n], start, stop, (q, v, work)) for n, (start, _, _, q, v, work, stop) in rows]

    @property
    def law_at_end(self) -> Law:
        """The law of the last panel."""
        direction, side, pressed = self.numbers[[state.DIRECTION, state.SIDE, state.PRESSED]].tolist()
        drive = self.model.drive.ahead(*self.state, direction)
        return Law(self.model, drive, direction, side, pressed)

    # ---- the end ------------------------------------------------------------------------------

    def _jam(self, solutions: int) -> None:
        now = self.state
        which = "no forces balance" if solutions == 0 else "two sets of forces balance"
        self.tell(JAM, now, which)
        where = "at t = " + time_of(self.t) + ", theta = " + angle_of(now.theta)
        self.stop(JAMS, "the friction jams " + where + f": {which}")

    def _fail(self, reason: str) -> None:
        now, law = self.state, self.law_at_end
        if law.rubs and law.side:
            here = law.contact(self.t, *now)
            if here.solutions != 1 or 1.0 - law.pressed * here.wedge < 1e-3:
                self._jam(0)
                return
        for mark in self.marks:
            if mark.kind == "limit" and abs(mark.angle - now.theta) < NEXT_TO:
                self._end_at(mark)
                return
        if not self._chatters():
            self.stop(FAILED, failure(self.t, now.theta, now.omega, reason))

    def _chatters(self) -> bool:
        """True if a torque that jumps with the sign of the speed holds the crank at standstill."""
        now, law = self.state, self.law_at_end
        small = 1e-6 * self.scales[1] / sqrt(self.model.inertia(now.theta))
        if not abs(now.omega) <= small:
            return False
        above, below = (law.alpha(self.t, now.theta, omega) for omega in (small, -small))
        if not above < 0.0 < below:
            return False
        why = " on: torque or load jumps where omega changes its sign; let it change over a range of omega"
        self.stop(FAILED, "the crank chatters at standstill from t = " + time_of(self.t) + why)
        return True

    def _slides(self) -> None:
        """End the motion if a torque that jumps at a speed drives the crank back to it from either side."""
        last, (theta, omega), law = self._kept[-1][0], self.state, self.law_at_end
        if len(last) < CROWD or abs(float(self.y[Q] - last[0, 3])) > NARROW:
            return
        low, high = omega - BESIDE * abs(omega), omega + BESIDE * abs(omega)
        below, above = (float(law.alpha(self.t, theta, speed)) for speed in (low, high))
        if not above < 0.0 < below:
            return
        while low < (middle := 0.5 * (low + high)) < high:
            low, high = (middle, high) if law.alpha(self.t, theta, middle) >= 0.0 else (low, middle)
        if law.alpha(self.t, theta, low) - law.alpha(self.t, theta, high) < 0.5 * (below - above):
            return  # it is steep there, without a jump
        across = " on: torque or load jumps back and forth across " + named("omega", high, ".6g")
        remedy = "; let it change over a range of omega"
        self.stop(FAILED, "the crank chatters from t = " + time_of(self.t) + across + remedy)

    # ---- the law as numbers -------------------------------------------------------------------

    def _as_numbers(self) -> LawNumbers:
        """The law for compiled loops, with functions that answer where it has no closed form."""
        model, drive = self.model, self.model.drive
        torque = drive.torque
        called = torque if isinstance(torque, FunctionCurve) and not torque.follows_the_slider else None
        closed = called is not None or torque.form is not None
        closed = closed and drive.F_Y.form is not None and drive.F_X.form is not None
        flat = {name: np.array([x]) for name, x in {**model.values, "mu": model.mu}.items()}
        arc = np.array([[model.coordinate.half, model.coordinate.first, model.coordinate.last]])
        laws = LawNumbers(flat, model.branch, arc, model.family() if closed else None)
        numbers = laws.law[0]
        self._callbacks = [self._guarded(self._answer), self._guarded(self._choose)]
        numbers[state.ANSWER], numbers[state.CHOOSE] = _address(self._callbacks[0]), 0.0
        if not closed:
            numbers[state.CHOOSE] = _address(self._callbacks[1])
        for k, curve in enumerate((torque, drive.F_Y, drive.F_X) if closed else ()):
            if curve.form is not None:
                laws.add(k, curve.form)
        if called:
            self._callbacks.append(self._guarded(_torques(called)))
            laws.add_function(0, _address(self._callbacks[2]))
        timed = any(curve.depends_on_time for curve in drive)
        numbers[state.WAITS] = 0.0 if drive.steady else 2.0 if timed else 1.0
        numbers[state.PROBE] = self.t_end / march.PROBES if timed else 0.0
        return laws

    def _guarded(self, work: Callable[[int, int, int], None]) -> Any:
        """A function for the loops; they go on after an error of a load, and stop after all others."""

        def guarded(first: int, second: int, third: int) -> int:
            if self.stops:
                return newton.STOP
            try:
                work(first, second, third)
            except (ValueError, ArithmeticError) as raised:  # a load has no value: the panel may be shorter
                self.error = raised
                return newton.NONE
            except BaseException as raised:
                self.error, self.stops = raised, True
                return newton.STOP
            self.error = None
            return 0

        return _CALLED(guarded)

    def _choose(self, choice: int, _: int, __: int) -> None:
        """Choose the pieces of loads that compiled loops do not know."""
        _, theta, omega, direction, growing = _memory(choice, 5).tolist()
        self._law = Law(self.model, self.model.drive.ahead(theta, omega, direction, growing))

    def _answer(self, state_at: int, rows_at: int, slopes: int) -> None:
        """The law at the nodes, where the loops have no closed form."""
        q, v = _memory(state_at, 2 * NODES).reshape(2, NODES)
        rows = _memory(rows_at, newton.ROWS * NODES).reshape(newton.ROWS, NODES)
        direction, side, pressed = self.numbers[[state.DIRECTION, state.SIDE, state.PRESSED]].tolist()
        drive, times = self._law.drive, rows[newton.TIME]
        if self.numbers[state.KERNEL]:
            now = state_of(self.model, float(q[0]), float(v[0]))
            drive = self.model.drive.ahead(*now, direction or 1.0, copysign(1.0, v[-1] - v[0]))
        law = Law(self.model, drive, direction, side, pressed)
        if times[0] == times[-1]:  # an instant
            times, q, v = times[:1], q[:1], v[:1]
        here = law.here(times, q, v)
        rates, still = here.rates, here.still
        rows[newton.ANGLE], rows[newton.SLOPE], rows[newton.SPEED] = here.theta, here.slope, here.omega
        rows[newton.RATE_Q], rows[newton.RATE_V], rows[newton.RATE_W] = rates[:3]
        rows[newton.CURVED] = rates.v / (here.root * here.slope)
        rows[state.INERTIA], rows[state.INERTIA_SLOPE] = still.inertia, still.inertia_slope
        rows[state.TRAVEL] = still.travel
        if rates.guide is not None:
            rows[newton.NORMAL], rows[newton.WEDGE], rows[newton.UNSURE] = rates.guide
        if slopes:
            jacobian = law.jacobian(here, q)
            for k, row in enumerate((newton.Q_BY_Q, newton.Q_BY_V, newton.V_BY_Q, newton.V_BY_V)):
                rows[row] = jacobian[k]


def _torques(curve: FunctionCurve) -> Callable[[int, int, int], None]:
    """A user's torque as the loops call it: rows of t, theta and omega, and one to fill in."""

    def torques(rows_at: int, apart: int, count: int) -> None:
        rows = _memory(rows_at, 3 * apart + count)
        columns = [rows[k * apart : k * apart + count] for k in range(3)]
        if all(column[0] == column[-1] for column in columns):  # an instant
            columns = [column[:1] for column in columns]
        rows[3 * apart :] = curve.at(*columns)

    return torques


def _memory(start: int, size: int) -> Array:
    memory: Any = (c_double * size).from_address(start)
    return np.frombuffer(memory)


def _address(function: Any) -> int:
    return cast(function, c_void_p).value or 0
