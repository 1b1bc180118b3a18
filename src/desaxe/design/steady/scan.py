"""All steady states of designs: turns from many speeds, and where what a turn gains falls through 0.

P(E), the energy a turn after E, ascends; its fixed points are where the gain P(E) - E changes sign. Turns are
followed by the Radau IIA method of three stages, which a stiff motor does not upset, from speeds that the
motor's curve chooses and between which more are put where the crank only just gets round and where two fixed
points could hide. Steps that leave too much error, or in which the crank would stop, are cut into parts:
twice at first, and as often as it takes for a design that would have no stable motion.
"""

from math import sqrt
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...support.panels import TO_COEFFICIENTS, Panels
from .designs import Course, DesignRows, course_at, course_of, picked, rate

Array = NDArray[Any]
BALANCED = 1e-7  # of the work of the loads over a period, of either sign: what of it counts as none
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
INSIDE = 1e-5  # of a panel: so far from its ends a value belongs to it
PLACES = np.concatenate([[INSIDE], STAGES[:2], [1.0 - INSIDE]])  # of a step
NEWTON, SETTLED = 7, 1e-3  # steps of Newton's method, and the last one, of the energy
SHRINK = 0.1  # of the energy: what a step of Newton's method leaves of it at least
ERROR = 3e-2  # of the energy: in a step
PARTS, SHALLOW, DEEP = 4, 2, 8  # of a step with too much error, and how often they are cut again


class Turns(NamedTuple):
    """The turns of designs from any energies, on panels.

    course, whole   coefficients at the nodes and at PLACES; inertia: its mean
    """

    designs: DesignRows
    edges: Array
    course: Course
    whole: Course
    inertia: Array

    def walk(self, E0: Array, cuts: int = SHALLOW, parts: int = 1) -> list[Array]:
        """The energy gained up to each end of equal parts of panels, NaN where the crank stops.

        E0   of each start (designs, starts)
        """
        gained = [np.zeros_like(E0)]
        with np.errstate(all="ignore"):
            for panel in range(self.edges.shape[1] - 1):
                at = np.s_[:, panel : panel + 1]
                lanes = Lanes(self.designs, self.edges[:, panel : panel + 2], picked(self.course, at))
                whole = picked(self.whole, np.s_[:, panel]) if parts == 1 else None
                x, h = lanes.edges[:, :1], np.diff(lanes.edges) / parts
                for k in range(parts):
                    gained.append(gained[-1] + lanes.change(x + k * h, h, E0 + gained[-1], cuts, whole))
        return gained

    def gain(self, E0: Array, cuts: int = SHALLOW) -> Array:
        """The energy gained over a period."""
        return self.walk(E0, cuts)[-1]

    def path(self, E0: Array, cuts: int = SHALLOW) -> Array:
        """The energy that one start of each design has gained at edges and middles of panels."""
        return np.concatenate(self.walk(E0[:, None], cuts, 2), axis=1)


class Lanes(NamedTuple):
    """Designs on one panel of each, and the coefficients at its nodes."""

    designs: DesignRows
    edges: Array
    course: Course

    def change(self, x: Array, h: Array, E: Array, cuts: int, course: Course | None = None) -> Array:
        """The change of E in a step after x, NaN where the crank stops; cut into parts where it fails."""
        course = course or course_at(self.designs, self.edges, self.course, x + h * PLACES)
        change, exact, there = self.step(course, h, E)
        bad = ~exact & (E > 0.0) & (h > 0.0)
        if not cuts:
            return np.where(bad & ~there, np.nan, change)
        rows, at = np.nonzero(bad)
        if not len(rows):
            return change
        lanes: Lanes = picked(self, rows)
        part, start, W = h[rows] / PARTS, E[rows, at][:, None], np.zeros((len(rows), 1))
        for k in range(PARTS):
            W = W + lanes.change(x[rows] + k * part, part, start + W, cuts - 1)
        change[rows, at] = W[:, 0]
        return change

    def step(self, course: Course, h: Array, E: Array) -> tuple[Array, Array, Array]:
        """The change of E in a step; whether that is exact enough; whether there is one at all."""
        h, E, stages = h[..., None], E[..., None], picked(course, np.s_[:, None, 1:])
        first = rate(self.designs, picked(course, np.s_[:, None, :1]), E)
        c = h * STAGES
        Z = np.maximum(c * first.f / (1.0 - c * np.minimum(first.g, 0.0)), (SHRINK - 1.0) * E)
        for _ in range(NEWTON):
            here = rate(self.designs, stages, E + Z)
            step = _solved(h * here.g, Z @ SLOPES.T - h * here.f)
            Z = np.maximum(Z - step, SHRINK * (E + Z) - E)
            moved = (np.abs(step) / (E + Z)).max(-1)
            if not (moved > SETTLED).any():
                break
        there = moved <= SETTLED
        missed = h * first.f - Z @ (SLOPES.T @ EXTRAPOLATED)[:, None]
        error = np.abs(GAMMA * missed / (1.0 - GAMMA * h * first.g))[..., 0]
        return Z[..., -1], there & (error <= ERROR * (E[..., 0] + Z[..., -1])), there


def turns_of(designs: DesignRows, edges: Array) -> Turns:
    """Turns on panels on which inertia and loads are nearly polynomials."""
    while True:
        mesh = Panels(edges)
        course = course_of(designs, mesh.x)
        with np.errstate(all="ignore"):
            bad = _tail(np.log(course["inertia"])) > BENT
            bad |= _tail(course["load"]) > BENT * np.abs(course["load"]).max((1, 2))[:, None]
        bad &= 2.0 * mesh.half[..., 0] > NARROWEST
        if not bad.any():
            break
        edges = mesh.refined(bad, edges)
    x = edges[:, :-1, None] + np.diff(edges)[..., None] * PLACES
    inertia = mesh.integral(np.nan_to_num(course["inertia"], posinf=0.0)) / designs.period
    return Turns(designs, edges, course, course_at(designs, edges, course, x), inertia)


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

    def brackets(self, sign: float = 1.0) -> Brackets:
        """The brackets in which gains fall through 0, of stable motions; rise (sign -1), of others."""
        with np.errstate(invalid="ignore"):
            signs = sign * np.sign(self.gains)
            design, at = np.nonzero((signs[:, :-1] > 0.0) & (signs[:, 1:] < 0.0))
        low, high = self.starts[design, at], self.starts[design, at + 1]
        below, above = self.gains[design, at], self.gains[design, at + 1]
        return Brackets(design, low + (high - low) * below / (below - above), low, high)


def scan(designs: DesignRows) -> Scan:
    """The gains of all starts that are needed to see every change of sign."""
    turns = turns_of(designs, designs.edges())
    starts = _starts(turns)
    gains = turns.gain(starts)
    for _ in range(ROUNDS):
        score = _scores(starts, gains)
        rows = np.flatnonzero(score.any(1))
        if not len(rows):
            break
        more = _between(starts[rows], score[rows])
        extra = np.full((2, len(starts), more.shape[1]), np.nan)
        extra[:, rows] = more, picked(turns, rows).gain(more)
        both = np.concatenate([np.stack([starts, gains]), extra], axis=2)
        starts, gains = np.take_along_axis(both, np.argsort(both[:1], axis=2), axis=2)
    least = BALANCED * Panels(turns.edges).integral(np.abs(turns.course["load"]))[:, None]
    gains[np.abs(gains) <= least] = 0.0
    none = np.setdiff1d(np.arange(designs.size), Scan(turns, starts, gains).brackets().design)
    if len(none):
        deep = picked(turns, none).gain(starts[none], cuts=DEEP)
        gains[none] = np.where(np.abs(deep) <= least[none], 0.0, deep)
    return Scan(turns, starts, gains)


def _starts(turns: Turns) -> Array:
    """The energies of the motor's speeds: in the mean, and of a light crank at the start, too."""
    designs, mean = turns.designs, turns.inertia[:, None]
    speeds = np.maximum(designs.source.speeds(designs.motor) * designs.way[:, None], 0.0)
    first = designs.values(["M_eff"], turns.edges[:, :1])["M_eff"] + designs.J[:, None]
    with np.errstate(over="ignore", invalid="ignore"):
        every = [0.5 * mean * speeds**2, np.where(first < LIGHT * mean, 0.5 * first * speeds**2, np.nan)]
    starts = np.concatenate(every, axis=1)
    starts = np.sort(np.where(starts > 0.0, starts, np.nan), axis=1)
    return np.append(np.full_like(first, np.nan), starts[:, np.isfinite(starts).any(0)], axis=1)


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
    result: Array = (a[..., None] + (b - a)[..., None] * share).reshape(len(starts), -1)
    return result
