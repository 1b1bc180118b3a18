"""The motion of one design: compiled loops make its panels up to each cut, here it rests, fails and ends."""

from math import inf, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..mechanism.messages import named
from ..support.computed import computed_once
from ..support.deadline import Deadline
from .drive import TorqueDerivative
from .events import (
    JAM,
    MOST_PASSAGES,
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
)  # fmt: skip
from .law import Law, State, state_of
from .loops import law as at
from .loops import march, panels
from .loops.compiled import BRIEF, NODES, records_of, run
from .loops.cuts import JAMMED, LIMIT
from .loops.cuts import KINK as AT_ANGLE
from .loops.cuts import STANDSTILL as STILL
from .loops.motions import PANELS, SHARPEST, single
from .model import Model
from .panel import TABLE, Record
from .result import DONE, FAILED, JAMS, REST, Event

Array = NDArray[np.float64]
SMALL = 1e-6  # rad
NEXT_TO = 1e-9  # rad: so near to a limit a load on a massless slider has grown without bound
CHATTER = 6  # standstills in a row, all within a millionth of the time
RECORDED = ("heads", "records", "ends", "laws")


class Ask(NamedTuple):
    """The part of a request that all motions of a call share."""

    t_end: float
    names: tuple[str, ...]
    branch: int
    rtol: float
    max_steps: int
    deadline: Deadline
    wrt: tuple[str, ...]
    derivative: TorqueDerivative | None
    until: tuple[float, ...]
    knots: tuple[float, ...]


class March:
    """One motion, from its start to its end."""

    def __init__(self, model: Model, start: tuple[float, float], ask: Ask) -> None:
        self.model, self.ask, self.t_end, self.deadline = model, ask, ask.t_end, ask.deadline
        self.start, self.status, self.message = start, NEVER, ""
        self.events: list[Event] = []
        self.steps, self.stills = 0, list[float]()
        self.marks = marks_of(model, ask.until)
        self.law = Law(model)
        self.numbers = self.law.numbers
        self.numbers[[at.THETA0, at.OMEGA_START]] = start
        self.numbers[at.PROBE] = self.t_end / march.PROBES if self.law.timed else 0.0
        self.sums = np.zeros(march.SUMS)
        self.y, self.clock, self.scales = np.zeros(3), np.zeros(8), np.array([ask.rtol, 0.0, 0.0])
        self.clock[[panels.T_END, panels.SHARP, panels.LEFT]] = self.t_end, SHARPEST, 1.0
        self.cutting = [mark for mark in self.marks if self._cuts(mark)]
        kinks = np.array([(m.angle, m.every or inf, m.status) for m in self.cutting]).reshape(1, -1, 3)
        known = self.law.known
        self._arrays = {
            "law": known.law, "data": known.data, "sheets": known.sheets, "knots": known.knots,
            "kinks": kinks, "table": TABLE, "y": self.y, "clock": self.clock, "scales": self.scales,
            "rows": np.zeros((at.ROWS, NODES)), "matrix": np.empty((2 * NODES, 2 * NODES)),
            "count": np.zeros(1), "sums": self.sums,
        }  # fmt: skip
        self._kept: list[dict[str, Array]] = []

    def _cuts(self, mark: Mark) -> bool:
        """True where the motion ends, or friction has a kink; pieces of loads end where they end."""
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
            memory = records_of(0, self.numbers.size)
            memory["heads"][0, 3:6], memory["ends"][0, 0], memory["laws"][0] = (
                self.y,
                march.RESTING,
                self.numbers,
            )
            self._kept.append(memory)
        self._break_away()
        passed, too_many = passages(self.model, self.marks, self.record)
        if too_many:
            self.message += f"; events list the first {MOST_PASSAGES} passages of each dead centre"
        self.events = sorted([*passed, *self.events], key=lambda event: event.t)
        return self

    def _break_away(self) -> None:
        """Record where the crank leaves its rest: a panel that rests ends, and the next one does not rest."""
        rests, heads = self.record.rests, self.record.heads
        for k in np.flatnonzero(rests & ~np.append(rests[1:], False)).tolist():
            start, stop = heads[k, [0, 6]].tolist()
            if start < stop < self.t_end and not (self.status == REST and k == rests.size - 1):
                angle = float(self.model.coordinate.theta(heads[k, 3]))
                self.events.append(Event("break-away", stop, angle, 0.0))

    # ---- panels -----------------------------------------------------------------------------

    def _go_on(self) -> None:
        """Some panels, and what comes after them."""
        self.deadline.check()
        left = self.ask.max_steps - self.steps
        if left <= 0:
            self._fail(f"more than {self.ask.max_steps} steps")
            return
        memory, count = records_of(min(left, BRIEF), self.numbers.size), self._arrays["count"]
        count[0] = float(bool(self._kept))
        if self._kept:
            for name in RECORDED:
                memory[name][0] = self._kept[-1][name][-1]
        self.law.error = None
        march.pause(self.clock, self.ask.knots, 0)
        code = run(single, work=PANELS, **memory, **self._arrays)
        made = {name: memory[name][1 : 1 + int(count[0])] for name in RECORDED}
        self.steps += len(made["heads"])
        if len(made["heads"]):
            self._kept.append(made)
        failed = code in (panels.FAILED, panels.STOPPED, march.UNMOVED)
        if self.law.error is not None and (self.law.stops or failed):
            raise self.law.error
        self._after(code)

    def _after(self, code: int) -> None:
        """Go by what the loops have ended with."""
        if code == panels.FAILED:
            self._fail("no panel of time resolves it, however short")
        elif code == march.UNMOVED:
            self._fail("the energy of the start is beyond every double")
        elif code == march.RESTS:
            why = " on: the torque cannot move the crank there"
            self.stop(REST, "at rest from t = " + time_of(self.t) + why)
        elif code in (march.NO_BALANCE, march.TWO_BALANCES):
            self._jam(0 if code == march.NO_BALANCE else 2)
        elif code == march.CUT:
            self._cut(*self._kept[-1]["ends"][-1].tolist())
        elif code == march.CHATTERS:
            speed = float(self.scales[2] / sqrt(self.model.inertia(self.state.theta)))
            across = " on: torque or load jumps back and forth across " + named("omega", speed, ".6g")
            remedy = "; let it change over a range of omega"
            self.stop(FAILED, "the crank chatters from t = " + time_of(self.t) + across + remedy)
        elif self.t >= self.t_end:
            reached = "reached t_end = " + time_of(self.t_end)
            rests = np.concatenate([one["ends"][:, 0] for one in self._kept]) == march.RESTING
            if rests[-1]:
                starts = np.concatenate([one["heads"][:, 0] for one in self._kept])
                since = float(starts[rests.size - np.append(~rests[::-1], True).argmax()])
                reached += ", at rest from t = " + time_of(since) + " on"
            self.stop(DONE, reached)

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
        heads, series, ends, laws = (np.concatenate([one[n] for one in self._kept]) for n in RECORDED)
        return Record(heads, series, ends, laws, self.y)

    # ---- the end ------------------------------------------------------------------------------

    def _jam(self, solutions: int) -> None:
        now = self.state
        which = "no forces balance" if solutions == 0 else "two sets of forces balance"
        self.tell(JAM, now, which)
        where = "at t = " + time_of(self.t) + ", theta = " + angle_of(now.theta)
        self.stop(JAMS, "the friction jams " + where + f": {which}")

    def _fail(self, reason: str) -> None:
        now = self.state
        if self.numbers[at.RUBS] and self.numbers[at.SIDE]:
            rows = self.law.at(self.t, self.y[Q], self.y[V], self.numbers)
            wedge, side = float(rows[at.WEDGE, 0]), float(np.sign(rows[at.NORMAL, 0]))
            if wedge > 1.0 - 1e-3 or not -1.0 <= wedge * side < march.JAMS_AT:
                self._jam(0)
                return
        if self.model.friction is None:  # of several guides
            ahead = now.theta + np.copysign(SMALL, now.omega)
            if np.isnan(self.law.alpha(self.t, ahead, now.omega, self.numbers)):
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
        now = self.state
        small = 1e-6 * self.scales[1] / sqrt(self.model.inertia(now.theta))
        if not abs(now.omega) <= small:
            return False
        sides = (self.law.alpha(self.t, now.theta, omega, self.numbers) for omega in (small, -small))
        above, below = sides
        if not above < 0.0 < below:
            return False
        why = " on: torque or load jumps where omega changes its sign; let it change over a range of omega"
        self.stop(FAILED, "the crank chatters at standstill from t = " + time_of(self.t) + why)
        return True
