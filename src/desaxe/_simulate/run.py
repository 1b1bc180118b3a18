"""The motion, step by step: what happens inside a step is found, and the integration is cut at every kink."""

from collections.abc import Callable, Iterator
from itertools import pairwise
from math import ceil, copysign, floor, inf
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import integrate
from scipy.optimize import brentq

from .border import SMALL
from .chart import TURN
from .friction import Contact, Rubbing, contact, side_ahead, ways_to_start
from .law import Law, Resting, Smooth, State, state_of
from .model import Model
from .result import DONE, FAILED, JAMS, LIMIT, NO_INERTIA, REST, Event

Array = NDArray[np.float64]
INSIDE = (0.25, 0.5, 0.75)  # of a step: where events are looked for besides its ends
WAITS = 2000  # instants at which a crank held by friction is asked whether the torque can move it
Q, V, W = range(3)
CHATTER = 20  # standstills in a row, all within a millionth of the time
NEVER = -1  # of an event that does not end the motion


class Tolerance(NamedTuple):
    """How the integration is controlled."""

    method: str
    rtol: float
    atol: Array
    max_step: float
    max_steps: int


class Piece(NamedTuple):
    """A stretch of the motion: from, to, the state as a function of time, the law that holds."""

    start: float
    stop: float
    state: Callable[[Any], Array]
    law: Law


class Mark(NamedTuple):
    """A crank angle to watch for; `turns` where it counts on every turn; `status` if it ends the motion."""

    kind: str
    angle: float
    which: str = ""
    turns: bool = False
    status: int = NEVER


class Found(NamedTuple):
    """An event inside a step: when, what, and the coordinate with the value that it has there."""

    t: float
    mark: Mark
    place: int = -1
    value: float = 0.0


class Constant:
    """The state of a crank that rests."""

    def __init__(self, y: Array) -> None:
        self.y = y

    def __call__(self, t: Any) -> Array:
        """The same at every instant."""
        return np.multiply.outer(self.y, np.ones(np.shape(t)))


STANDSTILL = Mark("standstill", 0.0)
LOST = Mark("normal force", 0.0)  # it changes its side: no event to tell, but a kink
JAMMED = Mark("friction jams", 0.0, status=JAMS)


class Run:
    """One motion, from its start to its end."""

    def __init__(
        self, model: Model, y: Array, t_end: float, until: tuple[float, ...], tolerance: Tolerance
    ) -> None:
        self.model, self.t_end, self.tolerance = model, t_end, tolerance
        self.t, self.y = 0.0, y
        self.status = NEVER
        self.message = ""
        self.pieces: list[Piece] = []
        self.accepted: list[tuple[float, Array]] = [(0.0, y)]
        self.events: list[Event] = []
        self.left = model.chart.place(y[Q])[0]  # an angle that the motion starts from is not reached again
        self.next_step: float | None = None
        self.steps = 0
        self.pressed: float | None = None  # the side of the guide after a change of side
        self.marks = _marks(model, until)

    def to_the_end(self) -> "Run":
        """Run until the end time, or what comes before it."""
        while self.status == NEVER:
            law = self._law()
            if law is not None:
                self._follow(law)
        if not self.pieces:  # stopped where it started
            self._keep_still(0.0)
        return self

    def stop(self, status: int, message: str) -> None:
        """End the motion."""
        self.status, self.message = status, message

    def tell(self, kind: str, state: State, which: str = "") -> None:
        """Note an event, now."""
        self.events.append(Event(kind, self.t, state.theta, state.omega, which))

    @property
    def state(self) -> State:
        """The crank, now."""
        return state_of(self.model, float(self.y[Q]), float(self.y[V]))

    # ---- which law holds ----------------------------------------------------------------------

    def _law(self) -> Law | None:
        """The law from here on; None where the motion has been stopped, or waits."""
        if self.model.mu == 0.0:
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
        """The sign of the normal force just after it has vanished: the motion without friction tells."""
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
        where = f"at t = {self.t:.6g} s, theta = {state.theta:.6g} rad"
        self.stop(JAMS, f"the friction jams {where}: {which}")

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
        if self.model.drive.steady:
            self.stop(REST, f"at rest from t = {self.t:.6g} s on: the torque cannot move the crank there")
            return

        def excess(t: float) -> float:
            """How far the torque is beyond what friction holds: the acceleration that it would start."""
            ways = (1.0, -1.0)
            sides = (side_ahead(self.model, theta, branch, way) for way in ways)
            here = (
                contact(self.model, t, theta, branch, 0.0, w, s) for w, s in zip(ways, sides, strict=True)
            )
            return max(w * c.alpha if c.solutions == 1 else -inf for w, c in zip(ways, here, strict=True))

        start, self.next_step = self.t, None
        for before, after in pairwise(np.linspace(start, self.t_end, WAITS + 1).tolist()):
            if excess(after) > 0.0:
                self.t = _last_positive(excess, before, after)
                self._keep_still(start)
                self.tell("break-away", self.state)
                return
        self.t = self.t_end
        self._keep_still(start)
        self.stop(DONE, f"reached t_end = {self.t_end:g} s, at rest from t = {start:.6g} s on")

    def _keep_still(self, start: float) -> None:
        self.pieces.append(Piece(start, self.t, Constant(self.y), Resting()))
        self.accepted.append((self.t, self.y))

    # ---- in motion ----------------------------------------------------------------------------

    def _solver(self, law: Law, t: float, y: Array, t_bound: float) -> Any:
        how = self.tolerance
        first = None if self.next_step is None else min(self.next_step, t_bound - t)
        # An angle counts absolutely, however many turns it has made; implicit methods take one rtol only.
        rtol = how.rtol if how.method in ("Radau", "BDF") else np.array([3e-14, how.rtol, how.rtol])
        return getattr(integrate, how.method)(
            law.rate, t, y, t_bound, rtol=rtol, atol=how.atol, max_step=how.max_step, first_step=first
        )

    def _follow(self, law: Law) -> None:
        """Integrate to the next kink, or the end."""
        solver = self._solver(law, self.t, self.y, self.t_end)
        while solver.status == "running":
            self.steps += 1
            with np.errstate(
                invalid="ignore", over="ignore"
            ):  # a trial beyond a limit is NaN: a smaller step
                reason = solver.step()
            if solver.status == "failed" or self.steps > self.tolerance.max_steps:
                reason = reason or f"more than {self.tolerance.max_steps} steps"
                self._fail(law, reason)
                return
            before, self.next_step = (self.t, self.y), solver.t - self.t
            inside = solver.dense_output()
            for found in self._events(law, inside, solver.t):
                if self._meet(found, law, before, inside, solver.t):
                    return
            self._accept(Piece(before[0], solver.t, inside, law), solver.y.copy())
            self.left = inf
        self.stop(DONE, f"reached t_end = {self.t_end:g} s")

    def _accept(self, piece: Piece, y: Array) -> None:
        self.pieces.append(piece)
        self.t, self.y = piece.stop, y
        self.accepted.append((self.t, y))

    def _fail(self, law: Law, reason: str) -> None:
        state = self.state
        if isinstance(law, Rubbing):
            here = law.at(self.t, state.theta, state.branch, state.omega)
            if here.solutions != 1 or 1.0 - law.pressed * here.wedge < 1e-3:
                self._jam(0)
                return
        where = f"at t = {self.t:.6g} s, theta = {state.theta:.6g}, omega = {state.omega:.6g}"
        self.stop(FAILED, f"the integration failed {where}: {reason}")

    def _meet(self, found: Found, law: Law, before: tuple[float, Array], inside: Any, after: float) -> bool:
        """Note an event; whether the motion is cut there."""
        mark = found.mark
        kink = isinstance(law, Rubbing)
        if mark.status == NEVER and not kink:
            y = inside(found.t)
            state = state_of(self.model, float(y[Q]), float(y[V]))
            self.events.append(_event(mark, found, state, self.model))
            return mark is STANDSTILL and self._chatters()
        t, y = self._cut(found, law, before, inside, after)
        self._accept(Piece(before[0], t, inside, law), y)
        self.left = self.model.chart.place(found.value)[0] if found.place == Q else inf
        if mark is JAMMED and isinstance(law, Rubbing):
            self._jam(0 if law.at(t, *_swapped(self.state)).wedge * law.pressed > 0.0 else 2)
        elif mark is LOST and isinstance(law, Rubbing):
            self.pressed = -law.pressed
        else:
            here = self.state if mark.kind != "limit" else State(mark.angle, self._speed_at_limit(), 1.0)
            self.events.append(_event(mark, found._replace(t=t), here, self.model))
            if mark.status != NEVER:
                self.stop(mark.status, _words(mark, t))
        return True

    def _chatters(self) -> bool:
        """Whether the crank turns round again and again at once: a torque that jumps with its speed."""
        last = self.events[-CHATTER:]
        kinds = {event.kind for event in last}
        if len(last) < CHATTER or kinds != {"standstill"} or last[-1].t - last[0].t > 1e-6 * self.t_end:
            return False
        self.stop(
            FAILED,
            f"the crank chatters at standstill from t = {last[0].t:.6g} s on: torque or load jumps where "
            "omega changes its sign; let it change over a small range of omega",
        )
        return True

    def _speed_at_limit(self) -> float:
        """0 with a massive rod or slider; else the crank runs into the limit."""
        return 0.0 if self.model.chart.half else self.state.omega

    def _cut(
        self, found: Found, law: Law, before: tuple[float, Array], inside: Any, after: float
    ) -> tuple[float, Array]:
        """The instant of an event and the state there, integrated to, not interpolated."""
        t, y = found.t, inside(found.t)
        if found.mark.kind != "limit":  # next to a limit angle the rates are less exact than the interpolant
            for _ in range(2):
                y = self._step_to(law, before, t)
                if found.place < 0:
                    break
                slope = law.rate(t, y)[found.place]
                miss = (found.value - y[found.place]) / slope if slope else 0.0
                t = min(max(t + miss, before[0]), after)
        if found.place >= 0:
            y[found.place] = found.value
        return t, y

    def _step_to(self, law: Law, before: tuple[float, Array], t: float) -> Array:
        if t - before[0] <= 1e-15 * abs(t):
            return before[1].copy()
        solver = self._solver(law, *before, t)
        while solver.status == "running":
            solver.step()
        y: Array = solver.y.copy()
        return y

    # ---- what happens inside a step -----------------------------------------------------------

    def _events(self, law: Law, inside: Any, t: float) -> list[Found]:
        """All events of the step just made, in order."""
        instants = [self.t, *(self.t + part * (t - self.t) for part in INSIDE), t]
        states = inside(np.array(instants)).T
        found: list[Found] = []
        stops = _changes(inside, V, instants, states)
        found += [Found(stop, STANDSTILL, V) for stop in stops]
        if stops:  # what lies beyond may be reached twice
            instants = sorted([*instants, *stops])
            states = inside(np.array(instants)).T
        chart = self.model.chart
        thetas = [chart.place(q)[0] for q in states[:, Q].tolist()]
        for mark in self.marks:
            found += self._passages(mark, inside, instants, states, thetas)
        if isinstance(law, Rubbing):
            found += self._kinks(law, inside, instants, states)
        return sorted(found, key=lambda event: event.t)

    def _passages(
        self, mark: Mark, inside: Any, instants: list[float], states: Array, thetas: list[float]
    ) -> Iterator[Found]:
        """Where the crank passes an angle."""
        chart = self.model.chart
        limit = mark.kind == "limit"
        rows = states[:, Q].tolist() if limit else thetas
        value = chart.ends[mark.which == "last"] if limit else mark.angle
        for k, ((a, b), (t_a, t_b)) in enumerate(zip(pairwise(rows), pairwise(instants), strict=True)):
            for angle in _between(a, b, value, mark.turns):
                if k == 0 and abs(angle - self.left) <= 1e-9 and not limit:
                    continue
                q = angle if limit else chart.q(angle)
                yield Found(_root(lambda t, there: float(inside(t)[Q]) - there, t_a, t_b, q), mark, Q, q)

    def _kinks(self, law: Rubbing, inside: Any, instants: list[float], states: Array) -> Iterator[Found]:
        """Where the normal force changes its side, and where the friction jams."""

        def guide(t: float) -> Contact:
            q, v, _ = inside(t).tolist()
            return law.at(t, *_swapped(state_of(self.model, q, v)))

        contacts = [guide(t) for t in instants]
        for (a, b), (t_a, t_b) in zip(pairwise(contacts), pairwise(instants), strict=True):
            if law.pressed * b.normal_free < -b.noise:
                if law.pressed * a.normal_free > 0.0:
                    yield Found(_root(lambda t: guide(t).normal_free, t_a, t_b), LOST)
                else:
                    yield Found(t_a, LOST)
                return
            for bound in (1.0, -1.0):  # K sign(N): none above 1, two below -1
                if bound * law.pressed * b.wedge > 1.0 >= bound * law.pressed * a.wedge:
                    jammed = _root(lambda t, way: way * law.pressed * guide(t).wedge - 1.0, t_a, t_b, bound)
                    yield Found(jammed, JAMMED)
                    return


def _swapped(state: State) -> tuple[float, float, float]:
    """theta, branch, omega."""
    return state.theta, state.branch, state.omega


def _marks(model: Model, until: tuple[float, ...]) -> list[Mark]:
    """All angles to watch for."""
    marks = [Mark("angle", angle, status=DONE) for angle in until]
    vanishing = model.vanishing()
    for which, angle in model.dead_centres().items():
        marks.append(Mark("dead centre", angle, which, turns=True))
        if which in vanishing:  # its two sides, so near that nothing is lost
            marks += [Mark("no inertia", angle + s * SMALL, which, True, NO_INERTIA) for s in (-1.0, 1.0)]
    first, last = model.chart.first, model.chart.last
    if first > -inf:
        marks += [Mark("limit", first, "first", status=LIMIT), Mark("limit", last, "last", status=LIMIT)]
    return marks


def _between(a: float, b: float, angle: float, turns: bool) -> list[float]:
    """The angles that a passage from a to b reaches; the one that it starts from is not among them."""
    if not turns:
        return [angle] if a < angle <= b or b <= angle < a else []
    low, high = sorted((a, b))
    counts = range(ceil((low - angle) / TURN), floor((high - angle) / TURN) + 1)
    return [value for value in (angle + TURN * k for k in counts) if value != a]


def _changes(inside: Any, index: int, instants: list[float], states: Array) -> list[float]:
    """When a coordinate changes its sign."""
    pairs = zip(pairwise(states[:, index].tolist()), pairwise(instants), strict=True)
    return [_root(lambda t: inside(t)[index], *times) for (a, b), times in pairs if a * b < 0.0]


def _root(function: Callable[..., float], a: float, b: float, *more: float) -> float:
    """The root in a bracket, to the last digits; where there is no change of sign, the end nearer to one."""
    at_a, at_b = function(a, *more), function(b, *more)
    if at_a * at_b >= 0.0:
        return a if abs(at_a) < abs(at_b) else b
    return float(brentq(function, a, b, more, xtol=1e-15 * max(abs(b), 1e-300), rtol=1e-15))


def _last_positive(excess: Callable[[float], float], a: float, b: float) -> float:
    """Where the excess becomes positive, on its positive side."""
    while b - a > 4e-16 * b:
        middle = 0.5 * (a + b)
        if middle in (a, b):
            break
        a, b = (a, middle) if excess(middle) > 0.0 else (middle, b)
    return b


def _event(mark: Mark, found: Found, state: State, model: Model) -> Event:
    """The event to tell; it has its angle or its standstill exactly."""
    theta = model.chart.place(found.value)[0] if found.place == Q else state.theta
    theta = mark.angle if mark.kind in ("limit", "angle") else theta
    omega = 0.0 if mark is STANDSTILL else state.omega
    return Event(mark.kind, found.t, theta, omega, "" if mark.kind == "limit" else mark.which)


def _words(mark: Mark, t: float) -> str:
    if mark.status == DONE:
        return f"reached the angle {mark.angle:g} rad at t = {t:.6g} s"
    if mark.status == LIMIT:
        return (
            f"reached the limit angle {mark.angle:.6g} rad (S = 0) at t = {t:.6g} s; it cannot turn further"
        )
    return (
        f"the effective inertia vanishes at the {mark.which} dead centre: without m_crank and I_crank the "
        f"crank has no speed there (M_eff -> 0); stopped {SMALL:g} rad before it at t = {t:.6g} s"
    )
