"""Events inside a panel: angles passed, standstills, kinks of loads and of friction, on its series."""

from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from math import ceil, copysign, floor, inf, sqrt
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from ..mechanism.closed import TURN
from ..mechanism.messages import Message, amount, named
from ..support.computed import computed_once
from ..support.roots import root, roots
from .checks import SMALL
from .coordinate import Coordinate
from .law import JAMS_AT
from .model import Model
from .panel import NODES, SERIES, Panel, basis
from .result import DONE, JAMS, LIMIT, NO_INERTIA

Array = NDArray[np.float64]
NEAR = 1e-9  # rad: an angle that a stretch starts from is not reached at once
AT_START = 1e-9  # of a panel: a root so near to a start with the value 0 is the start
BEYOND = 1.15  # of a panel: so far its series reach a limit angle, next to which S has no digits
ROUNDED = 1e-13  # of a series: less is none
SAMPLES = np.linspace(-1.0, 1.0, 33)
AT_SAMPLES = legendre.legvander(SAMPLES, NODES)
Q, V, W = range(3)
NEVER = -1  # of an event that does not end the motion


class Mark(NamedTuple):
    """A crank angle to detect, repeated at intervals of `every`; `status` is that of the end if it is one."""

    kind: str
    angle: float
    which: str = ""
    every: float = 0.0
    status: int = NEVER


KINK = "kink of a load"  # where the integration starts again: no event to report
STANDSTILL = Mark("standstill", 0.0)
LOST = Mark("normal force", 0.0)  # it changes its side: no event to report, but a kink
KNOT = Mark(KINK, 0.0, "speed")  # of a motor's table
JAMMED = Mark("friction jams", 0.0, status=JAMS)


class Crossing(NamedTuple):
    """An event inside a panel: when, what, and the coordinate with the value that it has there."""

    t: float
    mark: Mark
    place: int = -1
    value: float = 0.0


def angles_of(model: Model, until: Sequence[float]) -> list[Mark]:
    """The angles that end a motion, and the dead centres."""
    centres = model.dead_centres().items()
    return [
        *(Mark("angle", angle, status=DONE) for angle in until),
        *(Mark("dead centre", angle, which, TURN) for which, angle in centres),
    ]


class WatchedMarks(list[Mark]):
    """All angles to watch for; few of them lie in the range of a panel."""

    @computed_once
    def _columns(self) -> tuple[Array, Array, Array]:
        """Angles, periods, and which are limit angles, for these are detected in the coordinate."""
        rows = [(mark.angle, mark.every, mark.kind == "limit") for mark in self]
        angle, every, limit = np.array(rows or np.empty((0, 3)), float).T
        return angle, every, limit

    def within(self, thetas: list[float]) -> list[Mark]:
        """The marks that a passage through these angles may reach."""
        angle, every, limit = self._columns
        low, high = min(thetas), max(thetas)
        with np.errstate(divide="ignore", invalid="ignore"):
            whole = np.floor((high - angle) / every) >= np.ceil((low - angle) / every)
        reached = np.where(every == 0.0, (low <= angle) & (angle <= high), whole) | (limit != 0.0)
        return [self[k] for k in np.flatnonzero(reached).tolist()]


def marks_of(model: Model, until: Sequence[float]) -> WatchedMarks:
    """All angles to watch for."""
    marks = WatchedMarks(angles_of(model, until))
    for which, angle in model.vanishing().items():  # its two sides, so near that nothing is lost
        marks += [Mark("no inertia", angle + s * SMALL, which, TURN, NO_INERTIA) for s in (-1.0, 1.0)]
    first, last = model.coordinate.first, model.coordinate.last
    if first > -inf:
        marks += [Mark("limit", first, "first", status=LIMIT), Mark("limit", last, "last", status=LIMIT)]
    for curve in model.drive:
        kinks = curve.kinks(model.lengths, model.branch)
        marks += [Mark(KINK, angle, every=period) for angle, period in kinks]
    return marks


class SeriesOnPanel:
    """A Legendre series on a panel, as a function of the part of it from 0 to 1."""

    def __init__(self, series: Array) -> None:
        self.series: Array = series
        self.numbers: list[float] = series.tolist()

    def __call__(self, s: float) -> float:
        """The value, by Clenshaw's sum."""
        x, numbers = 2.0 * s - 1.0, self.numbers
        after, now = 0.0, numbers[-1]
        for n in range(len(numbers) - 2, 0, -1):
            after, now = now, numbers[n] + (2 * n + 1) / (n + 1) * x * now - (n + 1) / (n + 2) * after
        result: float = numbers[0] + x * now - 0.5 * after
        return result

    def roots(self, starts_at_zero: bool = False) -> list[float]:
        """The changes of sign behind the start."""
        sizes = np.abs(self.series)
        if sizes[0] > sizes[1:].sum():
            return []
        x: NDArray[Any] = SAMPLES
        values = AT_SAMPLES[:, : self.series.size] @ self.series
        if (np.abs(values[1:] + values[:-1]) < 4.0 * np.abs(np.diff(values))).any():
            found = np.sort(legendre.legroots(legendre.legtrim(self.series, sizes.max() * 1e-17)).real)
            found = found[(np.abs(found) < 1.0) & (found > -1.0 + 2.0 * AT_START * starts_at_zero)]
            x = np.sort(np.concatenate([x, found, 0.5 * (found[1:] + found[:-1])]))
            values = legendre.legval(x, self.series)
        if starts_at_zero:
            values[0] = 0.0
        places = 0.5 * (x + 1.0)
        changes = np.flatnonzero(values[1:] * values[:-1] < 0.0)
        result = [self.root(float(places[k]), float(places[k + 1])) for k in changes]
        result += places[1:][(values[1:] == 0.0) & (places[1:] > AT_START)].tolist()
        if starts_at_zero and result and abs(self(0.5 * min(result))) < ROUNDED * float(sizes.sum()):
            result.remove(min(result))  # it has not left the start yet
        return sorted(result)

    def root(self, a: float, b: float, value: float = 0.0) -> float:
        """The part at which it has a value, between two; where it does not pass it, the nearer end."""
        at_a, at_b = self(a) - value, self(b) - value
        if at_a * at_b >= 0.0:
            return a if abs(at_a) < abs(at_b) else b
        return root(lambda s: self(s) - value, a, b)


def along(panel: Panel, place: int) -> SeriesOnPanel:
    """A coordinate along a panel."""
    series = panel.series[place].copy()
    series[0] += panel.y[place]
    return SeriesOnPanel(series)


def events_in(
    panel: Panel, model: Model, marks: WatchedMarks, left: float, heed: Callable[[], None]
) -> list[Crossing]:
    """All events of a panel, in order; `left` is the angle that the stretch started from.

    `heed` is called for each passage: it raises where the time for the simulation is over.
    """
    q = along(panel, Q)
    stops = along(panel, V).roots(panel.y[V] == 0.0)
    found = [(s, STANDSTILL, V, 0.0) for s in stops]
    parts = [0.0, *stops, 1.0]  # between them the crank turns one way
    places = [float(panel.y[Q]), *map(q, parts[1:])]
    thetas = [float(model.coordinate.theta(place)) for place in places]
    for mark in marks.within(thetas):
        for passage in _passages(q, model, mark, parts, thetas, places, left):
            heed()
            found.append(passage)
        if mark.kind == "limit" and model.coordinate.half:
            ahead, end = limit_ahead(panel, model.coordinate), model.coordinate.ends[mark.which == "last"]
            if ahead is not None and q(BEYOND) * end > 0.0:
                found.append((ahead, mark, Q, end))
    found += [(s, KNOT, -1, 0.0) for s in _knots(panel, model)]
    if panel.law.rubs:
        found += _kinks(panel)
    return sorted(
        (Crossing(panel.start + s * panel.h, mark, place, value) for s, mark, place, value in found),
        key=lambda event: event.t,
    )


def events_along(
    panels: Sequence[Panel], model: Model, marks: WatchedMarks, left: float
) -> list[tuple[Crossing, Array]]:
    """The events of panels on which nothing is cut and no speed vanishes, in order, with q and v there."""
    y, series = np.array([panel.y for panel in panels]), np.array([panel.series for panel in panels])
    theta = model.coordinate.theta(np.append(y[:, Q], panels[-1].end()[Q])).tolist()
    found = [
        (k, mark, model.coordinate.q(angle))
        for mark in marks.within(theta)
        if mark.kind != "limit"
        for k, (a, b) in enumerate(pairwise(theta))
        for angle in _between(a, b, mark.angle, mark.every)
        if k or abs(angle - left) > NEAR
    ]
    if not found:
        return []
    index = np.array([k for k, _, _ in found])
    values, y, series = np.array([value for *_, value in found]), y[index, : V + 1], series[index, : V + 1]

    def state(s: Array) -> Array:
        moved: Array = np.einsum("kij,jk->ki", series, basis(2.0 * s - 1.0, NODES))
        return y + moved

    first, last = y[:, Q] - values, y[:, Q] + series[:, Q].sum(axis=1) - values
    nearer = np.where(np.abs(first) < np.abs(last), 0.0, 1.0)
    s = roots(lambda s: state(s)[:, Q] - values, np.zeros(index.size), np.ones(index.size), first, last)
    s = np.where(first * last < 0.0, s, nearer)
    rows = zip(found, s.tolist(), state(s), strict=True)
    events = [
        (Crossing(panels[k].start + part * panels[k].h, mark, Q, value), now)
        for (k, mark, value), part, now in rows
    ]
    return sorted(events, key=lambda event: event[0].t)


Passage = tuple[float, Mark, int, float]


def _passages(
    q: SeriesOnPanel,
    model: Model,
    mark: Mark,
    parts: list[float],
    thetas: list[float],
    places: list[float],
    left: float,
) -> Iterator[Passage]:
    """The events at which the crank passes an angle; a limit angle is detected in the coordinate."""
    coordinate = model.coordinate
    limit = mark.kind == "limit"
    rows = places if limit else thetas
    value = coordinate.ends[mark.which == "last"] if limit else mark.angle
    for k, ((a, b), span) in enumerate(zip(pairwise(rows), pairwise(parts), strict=True)):
        for angle in _between(a, b, value, mark.every):
            if k == 0 and abs(angle - left) <= NEAR and not limit:
                continue
            place = angle if limit else coordinate.q(angle)
            yield q.root(*span, place), mark, Q, place


def limit_ahead(panel: Panel, coordinate: Coordinate) -> float | None:
    """The part of a panel, a little beyond it, at which its series reach a limit angle."""
    q = along(panel, Q)
    end = copysign(coordinate.ends[1], q(BEYOND) - q(1.0))
    return q.root(1.0, BEYOND, end) if (q(1.0) - end) * (q(BEYOND) - end) < 0.0 else None


def growth(s: float) -> float:
    """By how much the last terms of a series grow beyond its panel."""
    x = 2.0 * s - 1.0
    return float((x + sqrt(x * x - 1.0)) ** NODES)


def _between(a: float, b: float, angle: float, every: float) -> list[float]:
    """The angles that a passage from a to b reaches; the one that it starts from is not among them."""
    if not every:
        return [angle] if a < angle <= b or b <= angle < a else []
    low, high = sorted((a, b))
    counts = range(ceil((low - angle) / every), floor((high - angle) / every) + 1)
    return [value for value in (angle + every * k for k in counts) if value != a]


def _knots(panel: Panel, model: Model) -> Iterator[float]:
    """The parts of a panel at which the speed passes a knot of the motor's table."""
    knots = model.drive.knots
    if not knots or panel.rates is None:
        return
    series = SERIES @ panel.rates.omega
    size = max(map(abs, knots))
    start = float(series[::2].sum() - series[1::2].sum())
    for knot in knots:
        own = series.copy()
        own[0] -= knot
        yield from SeriesOnPanel(own).roots(abs(start - knot) <= 1e-7 * size)


def _kinks(panel: Panel) -> Iterator[Passage]:
    """The first event at which the normal force changes sign or the friction jams."""
    guide = panel.rates and panel.rates.guide
    assert guide is not None
    normal = SeriesOnPanel(SERIES @ guide.normal)
    values = AT_SAMPLES[:, :NODES] @ normal.series
    lost = np.flatnonzero(values[1:] < -float(np.max(guide.noise)))  # at the start its sign is rounding
    if lost.size:
        before, parts = int(lost[0]), 0.5 * (SAMPLES + 1.0)
        passed = values[before] > 0.0
        part = normal.root(float(parts[before]), float(parts[before + 1])) if passed else float(parts[before])
        yield part, LOST, -1, 0.0
    for side in (1.0, -1.0):
        series = SERIES @ (side * guide.wedge)
        series[0] -= JAMS_AT
        beyond = SeriesOnPanel(series).roots()
        if beyond and beyond[0] > 0.0:
            yield beyond[0], JAMMED, -1, 0.0
            return


# ---- in words -------------------------------------------------------------------------------------


def time_of(t: float) -> Message:
    """An instant with its unit."""
    return amount("t", t, ".6g", says_unit=True)


def angle_of(theta: float) -> Message:
    """A crank angle with its unit."""
    return amount("theta", theta, ".6g", says_unit=True)


def words_of(mark: Mark, t: float) -> Message:
    """The message of a motion that ends at a mark."""
    if mark.status == DONE:
        return "reached the angle " + angle_of(mark.angle) + " at t = " + time_of(t)
    if mark.status == LIMIT:
        where = "reached the limit angle " + angle_of(mark.angle) + " (S = 0) at t = " + time_of(t)
        return where + ": beyond it there is no mechanism, or, at a change point, either branch"
    why = (
        f"the effective inertia vanishes at the {mark.which} dead centre: without m_crank and I_crank the "
        "crank has no speed there (M_eff -> 0); stopped "
    )
    return why + angle_of(SMALL) + " before it at t = " + time_of(t)


def failure(t: float, theta: float, omega: float, reason: str) -> Message:
    """The message of a motion that could not be followed to its end."""
    state = named("theta", theta, ".6g") + ", " + named("omega", omega, ".6g")
    return "the integration failed at t = " + time_of(t) + ", " + state + f": {reason}"
