"""The motion of one design, panel by panel: cut at every kink, at rest while friction holds the crank."""

from contextlib import suppress
from math import copysign, inf, sqrt
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..mechanism.messages import named
from ..support.deadline import Deadline
from .collocation import BRIEF, Collocation, PanelLimits
from .drive import FunctionCurve
from .events import (
    JAMMED,
    KINK,
    LOST,
    NEVER,
    STANDSTILL,
    Crossing,
    Mark,
    Q,
    V,
    angle_of,
    events_along,
    events_in,
    failure,
    marks_of,
    time_of,
    words_of,
)
from .law import Contact, Law, Resting, State, law_ahead, rubbing, state_of
from .loops.motions import BESIDE, CROWD, NARROW
from .loops.newton import DEVIATES, TAIL
from .model import Model
from .panel import ENDS, NODES, SERIES, Panel, basis, resting
from .result import DONE, FAILED, JAMS, REST, Event

Array = NDArray[np.float64]
SAME = 1e-9  # of a panel: events so close together are one instant
AT_LIMIT = 1e-9  # rad: so near to a limit a load on a massless slider has grown without bound
EXACT = 0.02  # tolerances: a panel whose inside is so exact need not be solved again up to a cut
PROBES = 2000  # instants of a motion at which loads that depend on time are compared with the panels
SHARP = 3e-11  # of a radian: a limit angle cannot be told better
CHATTER = 6  # standstills in a row, all within a millionth of the time
FLOOR = 0.01  # of the root of the energy that start and loads suggest: the least size of v


class Settings(NamedTuple):
    """The relative tolerance, and how many panels are a failure."""

    rtol: float
    max_steps: int


class March:
    """One motion, from its start to its end."""

    def __init__(
        self,
        model: Model,
        y: Array,
        t_end: float,
        until: tuple[float, ...],
        settings: Settings,
        deadline: Deadline,
    ) -> None:
        self.model, self.t_end, self.settings, self.deadline = model, t_end, settings, deadline
        self.t, self.y = 0.0, y
        self.status = NEVER
        self.message = ""
        self.panels: list[Panel] = []
        self.events: list[Event] = []
        self.left = self.state.theta  # an angle that the motion starts from is not reached again
        self.h = 0.0  # the length that the last panel suggests
        self.steps = 0
        self.top = 0.0  # the largest |v| so far
        self.pressed: float | None = None  # the side of the guide after a change of side
        self.marks = marks_of(model, until)
        kinks = [(mark.angle, mark.every or inf) for mark in self.marks if self._ends_stretch(mark)]
        self.kinks = np.array(kinks or np.empty((0, 2)))
        self.timed = any(curve.depends_on_time for curve in model.drive)
        self.by_functions = any(isinstance(curve, FunctionCurve) for curve in model.drive)
        limits = PanelLimits(t_end, settings.rtol, SHARP, self.kinks, np.array(model.drive.knots, np.float64))
        self.collocation = Collocation(limits, BRIEF)

    def to_the_end(self) -> "March":
        """Run until the end time, or what comes before it."""
        try:
            self.top = FLOOR * sqrt(self._energy())
            if self.top == inf:
                self._fail(None, "the energy of the start is beyond every double")
            while self.status == NEVER:
                law = self._law()
                if law is not None:
                    self._follow(law)
        except TimeoutError:  # of a load, or of the search for events
            if not self.deadline.over:
                raise
            self._late()
        self.deadline.lift()
        if not self.panels:  # stopped where it started
            self._keep_still(0.0)
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

    def _late(self) -> None:
        reason = f"not done within timeout = {self.deadline.seconds:g} s, after {self.steps} steps"
        self.deadline.lift()
        self._fail(None, reason)

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

    # ---- which law holds ----------------------------------------------------------------------

    def _law(self) -> Law | None:
        """The law from here on; None where the motion has been stopped, or waits."""
        theta, omega = self.state
        if self.model.mu == 0.0:
            directions = [copysign(1.0, omega)] if self.y[V] else [1.0, -1.0]
            for direction in directions:
                law = law_ahead(self.model, self.t, theta, omega, direction)
                if omega or direction * law.alpha(self.t, theta, 0.0) >= 0.0:
                    return law
            return self._from_rest()  # loads oppose either way
        if self.y[V] == 0.0:
            return self._from_rest()
        law = law_ahead(self.model, self.t, theta, omega, copysign(1.0, omega))
        return self._rubbing(law, law.contact(self.t, theta, omega))

    def _rubbing(self, law: Law, here: Contact) -> Law | None:
        """The law with friction, if exactly one set of forces balances."""
        pressed, self.pressed = self.pressed or float(here.pressed), None
        if abs(here.normal_free) <= here.noise:
            pressed = self._pressed_soon(law, pressed)
        if here.solutions != 1:
            self._jam(int(here.solutions))
            return None
        return rubbing(law, pressed)

    def _pressed_soon(self, law: Law, now: float) -> float:
        """The sign of the normal force just after it has vanished, from the motion as it is."""
        ahead = min(1e-6 * self.t_end, self.h or inf)
        t, y = np.array([self.t]), self.y
        rates = rubbing(law, now).rates(t, y[Q : Q + 1], y[V : V + 1])
        q, v = y[Q] + ahead * float(rates.q[0]), y[V] + ahead * float(rates.v[0])
        soon = law.contact(self.t + ahead, *state_of(self.model, q, v))
        return float(soon.pressed) if abs(soon.normal_free) > soon.noise else now

    def _jam(self, solutions: int) -> None:
        state = self.state
        which = "no forces balance" if solutions == 0 else "two sets of forces balance"
        self.tell(JAMMED.kind, state, which)
        where = "at t = " + time_of(self.t) + ", theta = " + angle_of(state.theta)
        self.stop(JAMS, "the friction jams " + where + f": {which}")

    # ---- at rest --------------------------------------------------------------------------------

    def _from_rest(self) -> Law | None:
        """Start if the torque can move the crank, else wait for it."""
        theta = self.state.theta
        laws = []
        for direction in (1.0, -1.0):
            law = law_ahead(self.model, self.t, theta, 0.0, direction)
            here = law.contact(self.t, theta, 0.0)
            if here.starts(direction):
                laws.append((law, here))
        if len(laws) == 2:
            self._jam(2)
            return None
        if laws:
            return self._rubbing(*laws[0])
        self._rest(theta)
        return None

    def _rest(self, theta: float) -> None:
        """Wait for the torque or load to break the crank away."""
        start, self.h = self.t, 0.0
        if self.model.drive.steady:
            why = " on: the torque cannot move the crank there"
            self.stop(REST, "at rest from t = " + time_of(start) + why)
            return
        moves = self._breaks_away(theta)
        self.t = self.t_end if moves is None else moves
        self._keep_still(start)
        if moves is None:
            rest = ", at rest from t = " + time_of(start) + " on"
            self.stop(DONE, "reached t_end = " + time_of(self.t_end) + rest)
        else:
            self.tell("break-away", self.state)

    def _breaks_away(self, theta: float) -> float | None:
        """The instant at which a time-dependent torque or load moves a crank at rest; None if it never does.

        Asked at many instants: a push that is over sooner than that is not noticed.
        """
        laws = [law_ahead(self.model, self.t, theta, 0.0, direction) for direction in (1.0, -1.0)]

        def moves(t: Array) -> Array:
            forth, back = (law.contact(t, theta, 0.0).starts(law.direction) for law in laws)
            return np.broadcast_to(np.logical_or(forth, back), t.shape)

        instants: Array = np.linspace(self.t, self.t_end, PROBES + 1)
        first = np.flatnonzero(moves(instants)[1:])
        if not first.size:
            return None
        a, b = instants[first[0]], instants[first[0] + 1]
        while a < (middle := 0.5 * (a + b)) < b:
            a, b = (a, middle) if moves(np.array([middle]))[0] else (middle, b)
        return float(b)

    def _keep_still(self, start: float) -> None:
        law = Resting(self.model, self.model.drive)
        self.panels.append(resting(law, start, self.t, self.y))

    # ---- in motion ----------------------------------------------------------------------------

    def _follow(self, law: Law) -> None:
        """Follow a law to the next kink, or the end."""
        while self.t < self.t_end:
            left = self.settings.max_steps - self.steps
            if left <= 0:
                self._fail(law, f"more than {self.settings.max_steps} steps")
                return
            panels = self._panels(law, left)
            if not panels:
                self._fail(law, "no panel of time resolves it, however short")
                return
            self.steps += len(panels)
            self._accept_calm(panels[:-1])
            if self._meet_all(panels[-1]):
                return
            self._accept(panels[-1], panels[-1].end())
            self.left = inf
            if self.by_functions and self._slides(law):
                return
        self.stop(DONE, "reached t_end = " + time_of(self.t_end))

    def _accept_calm(self, panels: list[Panel]) -> None:
        """Accept panels that nothing cuts, with the events on them."""
        if not panels:
            return
        for found, y in events_along(panels, self.model, self.marks, self.left):
            self._tell_of(found, state_of(self.model, float(y[Q]), float(y[V])))
        self.panels += panels[:-1]
        self.top = max(self.top, *(abs(float(panel.y[V])) for panel in panels))
        self._accept(panels[-1], panels[-1].end())
        self.left = inf

    def _panels(self, law: Law, most: int) -> list[Panel]:
        """The next panels, of which only the last may be cut; none where the tolerance allows none."""
        before = self.panels[-1] if self.panels and not self.panels[-1].law.rests else None
        while True:
            self.deadline.check()
            panels, self.h = self.collocation.advance(law, self.t, self.y, self.h, self.top, before, most)
            good, shorter = self._resolved(panels)
            self.h = shorter or self.h
            if good or shorter is None:
                return panels[:good]

    def _resolved(self, panels: list[Panel]) -> tuple[int, float | None]:
        """Count the panels before one whose nodes have missed something; a shorter length for that one."""
        for k, panel in enumerate(panels if self.timed else ()):
            shorter = self._missed(panel)
            if shorter is not None:
                return k, shorter
        bad = self._before_jump(panels) if self.by_functions and panels else None
        return (len(panels), None) if bad is None else (bad, 0.5 * panels[bad].h)

    def _before_jump(self, panels: list[Panel]) -> int | None:
        """Count the panels before the first with a jump next to an end, unseen by nodes; None without."""
        law, starts = panels[0].law, np.array([panel.y for panel in panels])
        ends = np.array([panel.end() for panel in panels])
        times = np.array([(panel.start, panel.start + panel.h) for panel in panels])
        nodes = np.array([panel.rates.v for panel in panels if panel.rates is not None])
        y = np.concatenate([starts, ends])
        actual = law.rates(times.T.reshape(-1), y[:, Q], y[:, V]).v.reshape(2, -1)
        off = np.diff(times, axis=1).T * np.abs(actual - ENDS @ nodes.T)
        size = np.maximum(self.top, np.abs(y[:, V]).reshape(2, -1).max(axis=0))
        bad = np.flatnonzero((off > DEVIATES * TAIL * self.settings.rtol * size).any(axis=0))
        return int(bad[0]) if bad.size else None

    def _missed(self, panel: Panel) -> float | None:
        """A shorter length for a panel whose nodes have missed what a load does in time; None for none."""
        every = self.t_end / PROBES
        first, last = int(panel.start / every) + 1, int(panel.stop / every)
        probes = np.arange(first, last + 1) * every
        t: NDArray[Any] = probes[(probes > panel.start) & (probes < panel.start + panel.h)]
        if not t.size or panel.rates is None:
            return None
        y = panel.state(t)
        rates = panel.law.rates(t, y[Q], y[V])
        s = 2.0 * (t - panel.start) / panel.h - 1.0
        series = (SERIES @ panel.rates.v) @ basis(s, NODES - 1)
        size = max(self.top, float(np.abs(y[V]).max()))
        bad = np.flatnonzero(panel.h * np.abs(rates.v - series) > DEVIATES * TAIL * self.settings.rtol * size)
        if not bad.size:
            return None
        return max(float(t[bad[0]]) - panel.start - every, 0.5 * (float(t[bad[0]]) - panel.start))

    def _accept(self, panel: Panel, y: Array) -> None:
        self.panels.append(panel)
        self.t, self.y = panel.stop, y
        self.top = max(self.top, abs(float(y[V])))

    def _fail(self, law: Law | None, reason: str) -> None:
        state = self.state
        if law is not None and law.rubs:
            here = law.contact(self.t, *state)
            if here.solutions != 1 or 1.0 - law.pressed * here.wedge < 1e-3:
                self._jam(0)
                return
        for mark in self.marks:
            if mark.kind == "limit" and abs(mark.angle - state.theta) < AT_LIMIT:
                self._tell_end(Crossing(self.t, mark, Q, float(self.y[Q])))
                return
        if law is not None and self._chatters(law, state):
            return
        self.stop(FAILED, failure(self.t, state.theta, state.omega, reason))

    def _stalls(self, law: Law) -> bool:
        """True if the crank has only turned round and round again, and chatters."""
        last = self.events[-CHATTER:]
        short = len(last) == CHATTER and last[-1].t - last[0].t < 1e-6 * self.t_end
        turned = short and all(event.kind == STANDSTILL.kind for event in last)
        return turned and self._chatters(law, self.state)

    def _chatters(self, law: Law, state: State) -> bool:
        """True if a torque that jumps with the sign of the speed holds the crank at standstill."""
        small = 1e-6 * self.top / sqrt(self.model.inertia(state.theta))
        if not abs(state.omega) <= small:
            return False
        above, below = (law.alpha(self.t, state.theta, omega) for omega in (small, -small))
        if not above < 0.0 < below:
            return False
        why = " on: torque or load jumps where omega changes its sign; let it change over a range of omega"
        self.stop(FAILED, "the crank chatters at standstill from t = " + time_of(self.t) + why)
        return True

    def _slides(self, law: Law) -> bool:
        """True if a torque that jumps at a speed drives the crank back to it from either side."""
        last, (theta, omega) = self.panels[-CROWD:], self.state
        if len(last) < CROWD or abs(float(self.y[Q] - last[0].y[Q])) > NARROW:
            return False
        low, high = omega - BESIDE * abs(omega), omega + BESIDE * abs(omega)
        below, above = (float(law.alpha(self.t, theta, speed)) for speed in (low, high))
        if not above < 0.0 < below:
            return False
        while low < (middle := 0.5 * (low + high)) < high:
            low, high = (middle, high) if law.alpha(self.t, theta, middle) >= 0.0 else (low, middle)
        if law.alpha(self.t, theta, low) - law.alpha(self.t, theta, high) < 0.5 * (below - above):
            return False  # it is steep there, without a jump
        across = " on: torque or load jumps back and forth across " + named("omega", high, ".6g")
        remedy = "; let it change over a range of omega"
        self.stop(FAILED, "the crank chatters from t = " + time_of(self.t) + across + remedy)
        return True

    # ---- events ---------------------------------------------------------------------------------

    def _meet_all(self, panel: Panel) -> bool:
        """Record the events of a panel; return True if one of them cuts the motion."""
        found = events_in(panel, self.model, self.marks, self.left, self.deadline.check)
        events = [event for event in found if event.t <= self.t_end]
        place = 0
        while place < len(events):
            last = events[place].t + SAME * panel.h
            start = place
            while place < len(events) and events[place].t <= last:
                place += 1
            now = events[start:place]
            if panel.law.rubs or any(self._ends_stretch(event.mark) for event in now):
                self._cut_at(now, panel)
                return True
            for event in now:
                self._note(event, panel)
        return self._stalls(panel.law)

    def _ends_stretch(self, mark: Mark) -> bool:
        """True where the motion ends, a load has a kink, or turns round with the slider."""
        turns = any(getattr(curve, "turns_with_the_slider", False) for curve in self.model.drive)
        cuts = mark.status != NEVER or mark.kind == KINK or (mark is STANDSTILL and turns)
        return cuts or (self.model.mu != 0.0 and mark.kind == "dead centre")

    def _note(self, found: Crossing, panel: Panel) -> None:
        """Record an event that does not cut the motion."""
        y = panel.state(found.t)
        self._tell_of(found, state_of(self.model, float(y[Q]), float(y[V])))

    def _tell_of(self, found: Crossing, state: State) -> None:
        """Record an event with its exact angle, or with exactly zero speed."""
        mark = found.mark
        if mark.kind == KINK:
            return
        theta = float(self.model.coordinate.theta(found.value)) if found.place == Q else state.theta
        theta = mark.angle if mark.kind in ("limit", "angle") else theta
        omega = 0.0 if mark is STANDSTILL else state.omega
        which = "" if mark.kind == "limit" else mark.which
        self.events.append(Event(mark.kind, float(found.t), theta, omega, which))

    def _cut_at(self, now: list[Crossing], panel: Panel) -> None:
        """End this stretch at events of one instant: what ends the motion leads, then an angle."""
        leader = min(now, key=lambda event: (event.mark.status == NEVER, event.place < 0))
        panel, y = self._cut(leader, panel)
        for other in now:
            if other is not leader and other.mark is not LOST:
                self._note(other, panel)
        law = panel.law
        self._accept(panel, y)
        at_angle = leader.place == Q
        self.left = float(self.model.coordinate.theta(leader.value)) if at_angle else inf
        if law.rubs and any(event.mark is LOST for event in now):
            self.pressed = -law.pressed
        if leader.mark is JAMMED:
            here = law.contact(self.t, *self.state)
            self._jam(0 if here.wedge * law.pressed > 0.0 else 2)
        elif leader.mark is not LOST:
            self._tell_end(leader._replace(t=self.t))

    def _tell_end(self, found: Crossing) -> None:
        """Record the event at which a stretch ends, and stop if the motion ends with it."""
        mark = found.mark
        limit = mark.kind == "limit"
        self._tell_of(found, State(mark.angle, self._speed_at_limit()) if limit else self.state)
        if mark.status != NEVER:
            self.stop(mark.status, words_of(mark, found.t))

    def _speed_at_limit(self) -> float:
        """0 with a massive rod or slider; else the crank runs into the limit."""
        return 0.0 if self.model.coordinate.half else self.state.omega

    def _cut(self, found: Crossing, panel: Panel) -> tuple[Panel, Array]:
        """The panel up to an event, and the state there: solved for, not interpolated, where that differs."""
        h = found.t - panel.start
        if panel.error > EXACT and h > 1e-6 * panel.h and h <= panel.h:
            panel = self.collocation.part_of(panel, h, self.top) or panel
        t, y = found.t, panel.state(found.t)
        if found.place >= 0 and not (found.mark.kind == "limit" and self.model.coordinate.half):
            rates = panel.law.rates(np.array([t]), y[:1], y[1:2])
            slope = float((rates.q, rates.v)[found.place][0])
            miss = (found.value - y[found.place]) / slope if slope else 0.0
            t = min(max(t + miss, panel.start), self.t_end)
            y = panel.state(t)
        if found.place >= 0:
            y[found.place] = found.value
        return panel._replace(stop=float(t)), y
