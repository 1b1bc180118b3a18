"""All steady states of designs: turns from many speeds, and where what a turn gains falls through 0.

P(E), the energy a turn after E, ascends; its fixed points are where the gain P(E) - E changes sign. Turns are
followed by the Radau IIA method of three stages, which a stiff motor does not upset, from speeds that the
motor's curve chooses and between which more are put where the crank only just gets round and where two fixed
points could hide. Steps that leave too much error, or in which the crank would stop, are cut into parts:
twice at first, and as often as it takes for a design that would have no stable motion.
"""

from copy import copy
from math import sqrt
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...support.panels import TO_COEFFICIENTS, Panels
from .designs import INSIDE, Coefficients, DesignRows, course_of, picked, rate

Array = NDArray[Any]
ROUNDS = 4  # of putting starts between others
CLOSE = 1e-4  # of an energy: nearer to each other no two starts are told apart
SPLIT = 6  # starts put into an interval
INTERVALS = 4  # so many of a design in a round
LIGHT = 0.5  # of the mean inertia: with less at the start, speeds and energies there are two sets of starts
BENT = 1e-3  # of an inertia, by its logarithm, or of the largest load: the last coefficients of a panel
NARROWEST = 1e-6  # rad: a panel
ROOT = sqrt(6.0)
STAGES = np.array([0.4 - 0.1 * ROOT, 0.4 + 0.1 * ROOT, 1.0])
RADAU = np.array(
    [
        [(88 - 7 * ROOT) / 360, (296 - 169 * ROOT) / 1800, (3 * ROOT - 2) / 225],
        [(296 + 169 * ROOT) / 1800, (88 + 7 * ROOT) / 360, -(3 * ROOT + 2) / 225],
        [(16 - ROOT) / 36, (16 + ROOT) / 36, 1 / 9],
    ]
)
SLOPES = np.linalg.inv(RADAU)  # of the stages, from their changes
# The slope at the start, extrapolated from those of the stages: what it misses is the error.
EXTRAPOLATED = np.linalg.solve(np.vander(STAGES, increasing=True).T, [1.0, 0.0, 0.0])
GAMMA = 0.25
PLACES = np.concatenate([[INSIDE], STAGES[:2], [1.0 - INSIDE]])  # of a step
NEWTON, SETTLED = 7, 1e-3  # steps of Newton's method, and the last one, of the energy
SHRINK = 0.1  # of the energy: what a step of Newton's method leaves of it at least
ERROR = 3e-2  # of the energy: in a step
PARTS, SHALLOW, DEEP = 4, 2, 8  # of a step with too much error, and how often they are cut again


class Turns:
    """The turns of designs from any energies: the gain over a period, NaN where the crank stops."""

    def __init__(self, designs: DesignRows, edges: Array) -> None:
        self.designs = designs
        self.edges, self.course = _resolved(designs, edges)
        x = self.edges[:, :-1, None] + np.diff(self.edges)[..., None] * PLACES
        self.whole = _course_at(self.designs, self.edges, self.course, x)
        inertia = np.where(np.isfinite(self.course.inertia), self.course.inertia, 0.0)
        self.mean_inertia = Panels(self.edges).integral(inertia) / designs.period

    def rows(self, index: Array) -> "Turns":
        """The turns of some of the designs, or of one several times."""
        turns = copy(self)
        turns.designs, turns.edges = self.designs.rows(index), self.edges[index]
        turns.course, turns.whole = picked(self.course, index), picked(self.whole, index)
        turns.mean_inertia = self.mean_inertia[index]
        return turns

    def gain(self, E0: Array, cuts: int = SHALLOW) -> Array:
        """The gain of each start (designs, starts)."""
        W = np.zeros_like(E0)
        with np.errstate(all="ignore"):
            for panel in range(self.edges.shape[1] - 1):
                start, end = self.edges[:, panel, None], self.edges[:, panel + 1, None]
                W = W + self._change(
                    panel, start, end - start, E0 + W, cuts, self.whole.some(np.s_[:, panel])
                )
        return W

    def path(self, E0: Array, cuts: int = SHALLOW) -> Array:
        """The energy that one start of each design has gained at edges and middles of panels."""
        gained = [np.zeros((len(E0), 1))]
        with np.errstate(all="ignore"):
            for panel in range(self.edges.shape[1] - 1):
                start, end = self.edges[:, panel, None], self.edges[:, panel + 1, None]
                h = 0.5 * (end - start)
                for x in (start, start + h):
                    E = E0[:, None] + gained[-1]
                    gained.append(gained[-1] + self._change(panel, x, h, E, cuts))
        return np.concatenate(gained, axis=1)

    def _change(
        self, panel: int, x: Array, h: Array, E: Array, cuts: int, course: Coefficients | None = None
    ) -> Array:
        """The change of E in a step after x, NaN where the crank stops; cut into parts where it fails."""
        if course is None:
            own = self.course.some(np.s_[:, panel : panel + 1])
            course = _course_at(self.designs, self.edges[:, panel : panel + 2], own, x + h * PLACES)
        change, exact, there = self._step(course, h, E)
        bad = ~exact & (E > 0.0) & (h > 0.0)
        if not cuts:
            return np.where(bad & ~there, np.nan, change)
        if not bad.any():
            return change
        rows, at = np.nonzero(bad)
        lanes = self._of_panel(panel).rows(rows)
        part, start, W = h[rows] / PARTS, E[rows, at][:, None], np.zeros((len(rows), 1))
        for k in range(PARTS):
            W = W + lanes._change(0, x[rows] + k * part, part, start + W, cuts - 1)
        change[rows, at] = W[:, 0]
        return change

    def _of_panel(self, panel: int) -> "Turns":
        turns, at = copy(self), np.s_[:, panel : panel + 1]
        turns.edges, turns.course = self.edges[:, panel : panel + 2], self.course.some(at)
        turns.whole = self.whole.some(at)
        return turns

    def _step(self, course: Coefficients, h: Array, E: Array) -> tuple[Array, Array, Array]:
        """The change of E in a step; whether that is exact enough; whether there is one at all."""
        source, row, h, E = self.designs.source, self.designs.row(3), h[..., None], E[..., None]
        course = course.some(np.s_[:, None])._replace(way=np.reshape(course.way, (-1, 1, 1)))
        first = rate(course.some(np.s_[..., :1]), source, row, E)
        course, c = course.some(np.s_[..., 1:]), h * STAGES
        Z = np.maximum(c * first.f / (1.0 - c * np.minimum(first.g, 0.0)), (SHRINK - 1.0) * E)
        for _ in range(NEWTON):
            here = rate(course, source, row, E + Z)
            step = _solved(h * here.g, Z @ SLOPES.T - h * here.f)
            Z = np.maximum(Z - step, SHRINK * (E + Z) - E)
            moved = (np.abs(step) / (E + Z)).max(-1)
            if not (moved > SETTLED).any():
                break
        there = moved <= SETTLED
        missed = h * first.f - Z @ (SLOPES.T @ EXTRAPOLATED)[:, None]
        error = np.abs(GAMMA * missed / (1.0 - GAMMA * h * first.g))[..., 0]
        return Z[..., -1], there & (error <= ERROR * (E[..., 0] + Z[..., -1])), there


def _course_at(designs: DesignRows, edges: Array, course: Coefficients, x: Array) -> Coefficients:
    """The coefficients at any places within the edges, from those at nodes."""
    read = Panels(edges).reader(x)
    guide = None if course.guide is None else tuple(map(read, course.guide))
    three = read(course.inertia), read(course.slope), read(course.load)
    follow = tuple(one.read(read, designs.theta(x)) for one in course.follow)
    return Coefficients(designs.theta(x), course.way, *three, guide, follow)


def _resolved(designs: DesignRows, edges: Array) -> tuple[Array, Coefficients]:
    """Edges of panels on which inertia and loads are nearly polynomials, and their coefficients there."""
    while True:
        mesh = Panels(edges)
        course = course_of(designs, mesh.x)
        with np.errstate(all="ignore"):
            bad = _tail(np.log(course.inertia)) > BENT
            bad |= _tail(course.load) > BENT * np.abs(course.load).max((1, 2))[:, None]
        bad &= 2.0 * mesh.half[..., 0] > NARROWEST
        if not bad.any():
            return edges, course
        edges = mesh.refined(bad, edges)


def _tail(values: Array) -> Array:
    return np.asarray(np.abs(values @ TO_COEFFICIENTS[-2:].T).max(-1))


def _solved(a: Array, b: Array) -> Array:
    """The solutions y of (S - diag(a)) y = b by Cramer's rule, S the slopes of the stages."""
    (_, s01, s02), (s10, _, s12), (s20, s21, _) = SLOPES.tolist()
    p, q, r = (SLOPES[k, k] - a[..., k] for k in range(3))
    b0, b1, b2 = (b[..., k] for k in range(3))
    qr, pr, pq = q * r - s12 * s21, p * r - s02 * s20, p * q - s01 * s10
    c01, c02 = s12 * s20 - s10 * r, s10 * s21 - s20 * q
    y = np.empty(b.shape)
    y[..., 0] = qr * b0 + (s02 * s21 - s01 * r) * b1 + (s01 * s12 - s02 * q) * b2
    y[..., 1] = c01 * b0 + pr * b1 + (s02 * s10 - s12 * p) * b2
    y[..., 2] = c02 * b0 + (s01 * s20 - s21 * p) * b1 + pq * b2
    y /= (p * qr + s01 * c01 + s02 * c02)[..., None]
    return y


class Brackets(NamedTuple):
    """Changes of the sign of gains: the design of each, an energy at the start, and the bracket around it."""

    design: Array
    E0: Array
    low: Array
    high: Array


class Scan(NamedTuple):
    """Starts in ascending order and the gain of each."""

    turns: Turns
    starts: Array
    gains: Array

    def found(self) -> Brackets:
        """The brackets in which gains fall through 0: of stable motions."""
        return self._changes(1.0)

    def rises(self) -> Brackets:
        """The brackets in which they rise through 0: of unstable motions."""
        return self._changes(-1.0)

    def _changes(self, before: float) -> Brackets:
        with np.errstate(invalid="ignore"):
            sign = before * np.sign(self.gains)
            design, at = np.nonzero((sign[:, :-1] > 0.0) & (sign[:, 1:] < 0.0))
        low, high = self.starts[design, at], self.starts[design, at + 1]
        below, above = self.gains[design, at], self.gains[design, at + 1]
        return Brackets(design, low + (high - low) * below / (below - above), low, high)


def scan(designs: DesignRows, edges: Array) -> Scan:
    """The gains of all starts that are needed to see every change of sign."""
    turns = Turns(designs, edges)
    starts = _starts(turns)
    gains = turns.gain(starts)
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
    none = np.setdiff1d(np.arange(designs.size), Scan(turns, starts, gains).found().design)
    if len(none):
        gains[none] = turns.rows(none).gain(starts[none], cuts=DEEP)
    return Scan(turns, starts, gains)


def _starts(turns: Turns) -> Array:
    """The energies of the motor's speeds: in the mean, and of a light crank at the start, too."""
    designs = turns.designs
    speeds = np.maximum(designs.source.speeds(designs.motor) * designs.way[:, None], 0.0)
    first = designs.values(["M_eff"], turns.edges[:, :1])["M_eff"] + designs.J[:, None]
    light = first < LIGHT * turns.mean_inertia[:, None]
    with np.errstate(over="ignore", invalid="ignore"):
        every = [0.5 * turns.mean_inertia[:, None] * speeds**2]
        if light.any():
            every.append(np.where(light, 0.5 * first * speeds**2, np.nan))
    starts = np.sort(np.concatenate(every, axis=1), axis=1)
    return np.where(starts > 0.0, starts, np.nan)


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
