"""Events inside a step of the integration: angles passed, standstills, kinks of friction."""

from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from math import ceil, copysign, floor, inf
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..mechanism.closed import TURN
from ..mechanism.messages import Message, amount, named
from ..support import roots
from .checks import SMALL
from .equations import Law, state_of
from .friction import JAMS_AT, Contact, Rubbing
from .model import Model
from .result import DONE, JAMS, LIMIT, NO_INERTIA

Array = NDArray[np.float64]
INSIDE = (0.25, 0.5, 0.75)  # of a step: where events are looked for besides its ends
SHORT = 2e-3  # of q: so far from a limit angle S keeps ten digits
NEAR = 1e-9  # rad: an angle that a stretch starts from is not reached at once
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
JAMMED = Mark("friction jams", 0.0, status=JAMS)


class IntegrationStep(NamedTuple):
    """A step just made: its law, start, state there, interpolant and end."""

    law: Law
    t: float
    y: Array
    inside: Callable[[Any], Array]
    end: float


class Crossing(NamedTuple):
    """An event inside a step: when, what, and the coordinate with the value that it has there."""

    t: float
    mark: Mark
    place: int = -1
    value: float = 0.0


class Samples(NamedTuple):
    """Instants of a step and the states there, one a row."""

    t: list[float]
    y: Array


def angles_of(model: Model, until: Sequence[float]) -> list[Mark]:
    """The angles that end a motion, and the dead centres."""
    centres = model.dead_centres().items()
    return [
        *(Mark("angle", angle, status=DONE) for angle in until),
        *(Mark("dead centre", angle, which, TURN) for which, angle in centres),
    ]


def marks_of(model: Model, until: Sequence[float]) -> list[Mark]:
    """All angles to watch for."""
    marks = angles_of(model, until)
    for which, angle in model.vanishing().items():  # its two sides, so near that nothing is lost
        marks += [Mark("no inertia", angle + s * SMALL, which, TURN, NO_INERTIA) for s in (-1.0, 1.0)]
    first, last = model.coordinate.first, model.coordinate.last
    if first > -inf:
        marks += [Mark("limit", first, "first", status=LIMIT), Mark("limit", last, "last", status=LIMIT)]
    for held in model.drive.held:
        kinks = held.kinks(model.lengths, int(model.sign))
        marks += [Mark(KINK, angle, every=period) for angle, period in kinks]
    return marks


def events_in(
    step: IntegrationStep, model: Model, marks: list[Mark], left: float, heed: Callable[[], None]
) -> list[Crossing]:
    """All events of a step, in order; `left` is the angle that the stretch started from.

    `heed` is called for each passage: it raises where the time for the simulation is over.
    """
    samples = _sampled(step, [step.t + part * (step.end - step.t) for part in (0.0, *INSIDE)] + [step.end])
    stops = _changes(step, V, samples)
    if stops:  # what lies beyond one may be reached twice
        samples = _sampled(step, sorted([*samples.t, *stops]))
    found = [Crossing(stop, STANDSTILL, V) for stop in stops]
    thetas = [model.coordinate.place(q)[0] for q in samples.y[:, Q].tolist()]
    for mark in marks:
        for passage in _passages(step, model, mark, samples, thetas, left):
            heed()
            found.append(passage)
        if mark.kind == "limit" and model.coordinate.half:
            found += _just_ahead(step, model, mark)
    if isinstance(step.law, Rubbing):
        found += _kinks(step, step.law, model, samples)
    return sorted(found, key=lambda event: event.t)


def _sampled(step: IntegrationStep, instants: list[float]) -> Samples:
    return Samples(instants, step.inside(np.array(instants)).T)


def _passages(
    step: IntegrationStep, model: Model, mark: Mark, samples: Samples, thetas: list[float], left: float
) -> Iterator[Crossing]:
    """The events at which the crank passes an angle; a limit angle is detected in the coordinate."""
    coordinate = model.coordinate
    limit = mark.kind == "limit"
    rows = samples.y[:, Q].tolist() if limit else thetas
    value = coordinate.ends[mark.which == "last"] if limit else mark.angle
    for k, ((a, b), times) in enumerate(zip(pairwise(rows), pairwise(samples.t), strict=True)):
        for angle in _between(a, b, value, mark.every):
            if k == 0 and abs(angle - left) <= NEAR and not limit:
                continue
            q = angle if limit else coordinate.q(angle)
            t = root(lambda t, there: float(step.inside(t)[Q]) - there, *times, q)
            yield Crossing(t, mark, Q, q)


def _just_ahead(step: IntegrationStep, model: Model, mark: Mark) -> Iterator[Crossing]:
    """A limit angle so close ahead of a step that none can start there: it is read off the interpolant."""
    end = model.coordinate.ends[mark.which == "last"]
    before, now = (float(step.inside(t)[Q]) for t in (step.end - 1e-3 * (step.end - step.t), step.end))
    gap = end - now
    if not 0.0 < gap * copysign(1.0, end) < SHORT or gap * (now - before) <= 0.0:
        return
    far = step.end + 2e-3 * (step.end - step.t) * gap / (now - before)
    if (end - float(step.inside(far)[Q])) * gap < 0.0:
        yield Crossing(root(lambda t: float(step.inside(t)[Q]) - end, step.end, far), mark, Q, end)


def _between(a: float, b: float, angle: float, every: float) -> list[float]:
    """The angles that a passage from a to b reaches; the one that it starts from is not among them."""
    if not every:
        return [angle] if a < angle <= b or b <= angle < a else []
    low, high = sorted((a, b))
    counts = range(ceil((low - angle) / every), floor((high - angle) / every) + 1)
    return [value for value in (angle + every * k for k in counts) if value != a]


def _changes(step: IntegrationStep, place: int, samples: Samples) -> list[float]:
    """The events at which a coordinate changes its sign."""
    pairs = zip(pairwise(samples.y[:, place].tolist()), pairwise(samples.t), strict=True)
    return [root(lambda t: float(step.inside(t)[place]), *times) for (a, b), times in pairs if a * b < 0.0]


def _kinks(step: IntegrationStep, law: Rubbing, model: Model, samples: Samples) -> Iterator[Crossing]:
    """The first event at which the normal force changes sign or the friction jams."""

    def guide(t: float) -> Contact:
        q, v, _ = step.inside(t).tolist()
        theta, omega, branch = state_of(model, q, v)
        return law.at(t, theta, branch, omega)

    def beyond(t: float, way: float) -> float:
        """The excess of K sign(N) above 1 (no solution) or, for way -1, below -1 (two solutions)."""
        return way * law.pressed * guide(t).wedge - JAMS_AT

    contacts = [guide(t) for t in samples.t]
    for (a, b), times in zip(pairwise(contacts), pairwise(samples.t), strict=True):
        if law.pressed * b.normal_free < -b.noise:
            within = law.pressed * a.normal_free > 0.0
            yield Crossing(root(lambda t: guide(t).normal_free, *times) if within else times[0], LOST)
            return
        for way in (1.0, -1.0):
            if way * law.pressed * b.wedge > JAMS_AT >= way * law.pressed * a.wedge:
                yield Crossing(root(beyond, *times, way), JAMMED)
                return


def root(function: Callable[..., float], a: float, b: float, *more: float) -> float:
    """The root in a bracket, to the last digits; where there is no change of sign, the end nearer to one."""
    at_a, at_b = function(a, *more), function(b, *more)
    if at_a * at_b >= 0.0:
        return a if abs(at_a) < abs(at_b) else b
    return roots.root(lambda t: function(t, *more), a, b)


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
