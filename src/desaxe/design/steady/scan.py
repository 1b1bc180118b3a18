"""All steady states of designs: turns from many speeds, and the changes of sign of what a turn gains.

P(E), the energy a turn after E, ascends; its fixed points are where the gain P(E) - E changes sign. Turns
are followed roughly, by the exponential Runge-Kutta method of order 4 of S. M. Cox and P. C. Matthews (J.
Comput. Phys. 176, 2002), which a stiff motor does not upset, from speeds that the motor's curve chooses and
between which more are put where the crank only just gets round and where two fixed points could hide.
"""

from copy import copy
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .designs import INSIDE, Coefficients, DesignRows, course_of, picked, rate

Array = NDArray[Any]
PLACES = np.array([INSIDE, 0.25, 0.5, 0.75, 1.0 - INSIDE])  # of a panel: two steps
ROUNDS = 4  # of putting starts between others
CLOSE = 1e-4  # of an energy: nearer to each other no two starts are told apart
SPLIT = 6  # starts put into an interval
INTERVALS = 4  # so many of a design in a round
LARGEST = 30.0  # exponent
SERIES = 1e-2  # below it they are series


class Turns:
    """The turns of designs from any energies: the gain over a period, NaN where the crank stops."""

    def __init__(self, designs: DesignRows, edges: Array) -> None:
        self.designs, self.edges = designs, edges
        self.width = np.diff(edges)
        x = edges[:, :-1, None] + self.width[..., None] * PLACES
        self.course = course_of(designs, x)
        self.row = designs.row(2)
        weight = self.width[..., None] / PLACES.size
        inertia = np.where(np.isfinite(self.course.inertia), self.course.inertia, 0.0)
        self.mean_inertia = (inertia * weight).sum((1, 2)) / designs.period

    def rows(self, index: Array) -> "Turns":
        """The turns of some of the designs, or of one several times."""
        found = copy(self)
        found.designs, found.row = self.designs.rows(index), self.designs.rows(index).row(2)
        found.edges, found.width = self.edges[index], self.width[index]
        found.course, found.mean_inertia = picked(self.course, index), self.mean_inertia[index]
        return found

    def gain(self, E0: Array, path: list[Array] | None = None) -> Array:
        """The gain of each start (designs, starts); those at edges and middles of panels go into `path`."""
        W = np.zeros_like(E0)
        with np.errstate(all="ignore"):
            for k in range(self.width.shape[1]):
                h = 0.5 * self.width[:, k, None]
                for first in (0, 2):
                    courses = [self.course.part((slice(None), k, first + j)) for j in range(3)]
                    W = W + self._step(courses, h, E0 + W)
                    if path is not None:
                        path.append(W)
        return W

    def _step(self, courses: list[Coefficients], h: Array, E: Array) -> Array:
        """The change of E over a step."""
        source, row = self.designs.source, self.row
        start = rate(courses[0], source, row, E)
        c = np.clip(h * start.g, -1e6, LARGEST)
        half = 0.5 * h * _one(0.5 * c)
        phi1, phi2, phi3 = _phi(c)
        g = c / np.where(h > 0.0, h, 1.0)
        a = half * start.f
        at_a = rate(courses[1], source, row, E + a).f - g * a
        b = half * at_a
        at_b = rate(courses[1], source, row, E + b).f - g * b
        d = np.exp(0.5 * c) * a + half * (2.0 * at_b - start.f)
        at_d = rate(courses[2], source, row, E + d).f - g * d
        return np.asarray(
            h
            * (
                (phi1 - 3.0 * phi2 + 4.0 * phi3) * start.f
                + (2.0 * phi2 - 4.0 * phi3) * (at_a + at_b)
                + (4.0 * phi3 - phi2) * at_d
            )
        )


def _one(c: Array) -> Array:
    """(exp(c) - 1)/c."""
    far = np.abs(c) > SERIES
    return np.where(far, np.expm1(c) / np.where(far, c, 1.0), 1.0 + c * (0.5 + c / 6.0))


def _phi(c: Array) -> tuple[Array, Array, Array]:
    """(exp(c) - 1)/c and the two functions after it."""
    far, one = np.abs(c) > SERIES, _one(c)
    safe = np.where(far, c, 1.0)
    two = np.where(far, (one - 1.0) / safe, 0.5 + c * (1.0 + 0.25 * c) / 6.0)
    return one, two, np.where(far, (two - 0.5) / safe, (1.0 + c * (0.25 + 0.05 * c)) / 6.0)


class Brackets(NamedTuple):
    """Changes of sign: the design of each, an energy at the start, and the bracket around it."""

    design: Array
    E0: Array
    low: Array
    high: Array
    falls: Array  # whether the gain falls through 0 there: then the motion is stable


class Scan(NamedTuple):
    """Starts in ascending order and the gain of each."""

    turns: Turns
    starts: Array
    gains: Array

    def found(self) -> Brackets:
        """All changes of sign, and where in between the gain vanishes."""
        with np.errstate(invalid="ignore"):
            sign = np.sign(self.gains)
            design, at = np.nonzero(sign[:, 1:] * sign[:, :-1] < 0.0)
        low, high = self.starts[design, at], self.starts[design, at + 1]
        below, above = self.gains[design, at], self.gains[design, at + 1]
        return Brackets(design, low + (high - low) * below / (below - above), low, high, below > 0.0)


def scan(designs: DesignRows, edges: Array) -> Scan:
    """The gains of all starts that are needed to see every change of sign."""
    turns = Turns(designs, edges)
    speeds = np.maximum(designs.source.speeds(designs.motor) * designs.way[:, None], 0.0)
    with np.errstate(over="ignore"):
        starts = np.sort(0.5 * turns.mean_inertia[:, None] * speeds**2, axis=1)
    gains = turns.gain(np.where(starts > 0.0, starts, np.nan))
    for _ in range(ROUNDS):
        score = _scores(starts, gains)
        rows = np.flatnonzero(score.any(1))
        if not len(rows):
            break
        more = _between(starts[rows], score[rows])
        gained = turns.rows(rows).gain(more)
        extra, extra_gain = (np.full((len(starts), more.shape[1]), np.nan) for _ in range(2))
        extra[rows], extra_gain[rows] = more, gained
        starts, gains = np.concatenate([starts, extra], 1), np.concatenate([gains, extra_gain], 1)
        order = np.argsort(starts, axis=1)
        starts, gains = np.take_along_axis(starts, order, 1), np.take_along_axis(gains, order, 1)
    return Scan(turns, starts, gains)


def _scores(starts: Array, gains: Array) -> Array:
    """The need of each interval for more starts: 0 for none."""
    stops = np.isnan(gains)
    size = np.where(stops, np.inf, np.abs(gains))
    with np.errstate(invalid="ignore"):
        changes = np.sign(gains[:, 1:]) * np.sign(gains[:, :-1]) < 0.0
        near = np.zeros(gains.shape, bool)  # comes near 0 and turns back
        left, here, right = size[:, :-2], size[:, 1:-1], size[:, 2:]
        near[:, 1:-1] = (here <= left) & (here <= right) & (np.maximum(left, right) > 2.0 * here)
    score = np.where((near[:, 1:] | near[:, :-1]) & ~changes, 1.0, 0.0)
    score = np.where(stops[:, :-1] & ~stops[:, 1:], 2.0, score)
    return np.where(starts[:, 1:] > starts[:, :-1] * (1.0 + CLOSE), score, 0.0)


def _between(starts: Array, score: Array) -> Array:
    """More starts, in the intervals of each design that need them most."""
    many = min(INTERVALS, int((score > 0.0).sum(1).max()))
    chosen = np.argsort(-score, axis=1, kind="stable")[:, :many]
    a, b = np.take_along_axis(starts, chosen, 1), np.take_along_axis(starts, chosen + 1, 1)
    share = np.arange(1, SPLIT + 1) / (SPLIT + 1.0)
    found: Array = (a[..., None] + (b - a)[..., None] * share).reshape(len(starts), -1)
    return found
