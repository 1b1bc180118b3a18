"""Periodic motions: E(x) with E(period) = E(0), by Newton's method on panels between all kinks.

Each Newton step solves the linear equation for what is missing, exactly in the period's end: it needs no
turns. Kinks that hang on the state (knots of a motor's table, a guide that changes sides) become edges of
panels where the motion passes them, until they stay.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...support.computed import computed_once
from ...support.panels import NODES, RUNNING, TO_COEFFICIENTS, WEIGHT, Panels, padded
from .designs import Course, DesignRows, Rate, course_of, kinks_of, picked, rate

Array = NDArray[Any]

# Growth over a panel beyond which an integrating factor is no polynomial, not even a rough one: what
# that leaves is corrected by Newton's method, or by another solution.
STIFF = 6.0


class Linear:
    """The equation y' = g y + r with y(end) + jump = y(start) - defect, on a mesh; g is given once.

    Between the edges of a panel by the integrating factor exp(integral of g), which is a polynomial unless g
    is large; there the collocation equations are solved.
    """

    def __init__(self, mesh: Panels, g: Array) -> None:
        self.mesh, self.g = mesh, g
        total = (g @ WEIGHT) * mesh.half[..., 0]
        growth = np.clip(mesh.half * (g @ RUNNING.T), -STIFF, STIFF)
        self.factor = np.exp(growth)
        self.through = np.exp(np.clip(total, -STIFF, STIFF))  # a panel
        self.stiff = np.nonzero(np.abs(mesh.half * g).max(-1) * 2.0 > STIFF)
        half, steep = mesh.half[self.stiff], g[self.stiff]
        self.inverse = np.linalg.inv(np.eye(NODES) - half[..., None] * RUNNING * steep[:, None, :])
        self.free = self.inverse.sum(-1)
        self.factor[self.stiff] = self.free
        self.through[self.stiff] = 1.0 + half[..., 0] * ((steep * self.free) @ WEIGHT)
        self.log_multiplier = total.sum(-1)

    def solve(self, r: Array, defect: Array, jumps: Array | None = None) -> tuple[Array, Array]:
        """y at the start and at the nodes; `jumps` of y stand at the end of each panel."""
        half, (row, panel) = self.mesh.half, self.stiff
        inner = r / self.factor
        own = self.factor * (half * (inner @ RUNNING.T))
        last = self.through * half[..., 0] * (inner @ WEIGHT)
        if len(row):
            wide, steep = half[row, panel], r[row, panel]
            local = np.einsum("kij,kj->ki", self.inverse, wide * (steep @ RUNNING.T))
            own[row, panel] = local
            last[row, panel] = wide[:, 0] * ((steep + self.g[row, panel] * local) @ WEIGHT)
        if jumps is not None:
            last = last + jumps
        entering = np.zeros((*last.shape[:-1], last.shape[-1] + 1))
        for k in range(last.shape[-1]):
            entering[..., k + 1] = self.through[:, k] * entering[..., k] + last[..., k]
        start = (defect + entering[..., -1]) / self.less_one
        share = np.cumprod(self.through[:, :-1], axis=-1)
        entering[..., 0] += start
        entering[..., 1:-1] += share * start[..., None]
        return start, self.factor * entering[..., :-1, None] + own

    @computed_once
    def less_one(self) -> Array:
        """1 - the product over all panels, which does not cancel where that is near 1."""
        if len(self.stiff[0]):
            far = np.abs(self.log_multiplier) > STIFF
            return np.asarray(np.where(far, 1.0 - self.through.prod(-1), -np.expm1(self.log_multiplier)))
        return np.asarray(-np.expm1(self.log_multiplier))


STEPS = 40  # of Newton's method
NEXT_SETTLED = 1e-10  # of the energy: a step after which another one is below rounding
EXTRAPOLATED = 1e-17  # the same, of the step after it
ROUGH = 1e-5  # a step that leaves a rough motion
MOVED = 1e-11  # rad
RESOLVED = 3e-11  # of the largest value: the last coefficients of a panel
NOISE, PLATEAU = 1e-9, 0.05  # the same, where they are not smaller than this share of earlier ones
FLAT = 1e-13  # of the energy: what the last coefficients of its slope may add to it
NARROWEST = 2.0**-40  # rad
PANELS = 1500
SHRINK = 0.8  # of the energy: what a step may take
JAMS_AT = 1.0 - 1e-6  # of the wedge K: as in simulation/law.py
ROUNDS = 12  # of moving edges


class Orbit(NamedTuple):
    """Periodic motions of designs: the energy at the start and its slope at the nodes."""

    designs: DesignRows
    edges: Array
    E0: Array
    F: Array
    course: Course
    rate: Rate
    log_multiplier: Array
    good: Array  # where Newton's method settled

    @property
    def mesh(self) -> Panels:
        """The panels."""
        return Panels(self.edges)

    @property
    def jams(self) -> Array:
        """True where friction leaves no balance of forces somewhere on the turn, or two."""
        wedge = self.rate.wedge
        if wedge is None:
            return np.zeros(len(self.E0), bool)
        return np.asarray(((wedge >= JAMS_AT) | (wedge < -1.0)).any((1, 2)))

    @property
    def switches(self) -> Array:
        """The places where it passes a knot of the motor or the guide changes sides, in padded rows."""
        mesh = self.mesh
        marks = [mesh.roots(self.rate.omega - knot) for knot in self.designs.source.knots]
        marks += map(mesh.roots, kinks_of(self.designs, self.course, self.rate, mesh.x))
        every = np.sort(np.concatenate([mesh.edges[:, :1], *marks], axis=1), axis=1)
        # Each side of an edge may find the root that is there.
        row, at = np.nonzero(np.diff(every, axis=1, prepend=-1.0) > MOVED)
        return padded(row, every[row, at], len(every), every[:, 0])

    def unresolved(self, functions: tuple[Array, ...]) -> Array:
        """The panels on which one of these functions is no polynomial yet; F only as far as it moves E.

        Small coefficients that no longer fall are rounding, which halving does not mend.
        """
        width = np.diff(self.edges)
        bad = np.zeros(width.shape, bool)
        with np.errstate(all="ignore"):
            for values in functions:
                four = np.abs(values @ TO_COEFFICIENTS[[10, 11, -2, -1]].T)
                before, tail = four[..., :2].max(-1), four[..., 2:].max(-1)
                size = np.abs(values).max((1, 2))[:, None]
                here = (tail > RESOLVED * size) & ((tail > NOISE * size) | (tail < PLATEAU * before))
                if values is self.F:
                    E = energy(self.mesh, self.E0, self.F)
                    here &= tail * width > FLAT * np.abs(E).min((1, 2))[:, None]
                bad |= here
        wide = (width > NARROWEST) & (width.shape[1] < PANELS)
        return np.asarray(bad & wide & (self.good & ~self.jams)[:, None])


def energy(mesh: Panels, E0: Array, F: Array) -> Array:
    """The energy at the nodes."""
    return np.asarray(E0[:, None, None] + mesh.running(F))


def newton(designs: DesignRows, edges: Array, E0: Array, F: Array, rough: bool = False) -> Orbit:
    """The periodic motion near a guess; a rough one shows where it switches."""
    mesh = Panels(edges)
    course = course_of(designs, mesh.x)
    left, lanes = np.arange(len(E0)), (designs, edges, course)
    E0, F, good = E0.copy(), F.copy(), np.zeros(len(E0), bool)
    before = np.full(len(E0), np.inf)
    with np.errstate(all="ignore"):
        for _ in range(STEPS):
            if not len(left):
                break
            E0[left], F[left], change = _step(*lanes, E0[left], F[left])
            done = change <= (ROUGH if rough else NEXT_SETTLED)
            done |= (change * change <= EXTRAPOLATED * before) & np.isfinite(before)
            good[left] = done
            go = np.flatnonzero(~done & np.isfinite(change))
            before = change[go]
            if len(go) < len(left):
                left, lanes = left[go], picked(lanes, go)
        E = energy(mesh, E0, F)
        here = rate(designs, course, E)
    grown = mesh.integral(np.nan_to_num(here.g))
    return Orbit(designs, edges, E0, F, course, here, grown, good & (E > 0.0).all((1, 2)))


def _step(
    designs: DesignRows, edges: Array, course: Course, E0: Array, F: Array
) -> tuple[Array, Array, Array]:
    """Energy and slope after a step of Newton's method, and the relative change that it wants."""
    mesh = Panels(edges)
    E = energy(mesh, E0, F)
    here = rate(designs, course, E)
    start, y = Linear(mesh, np.nan_to_num(here.g)).solve(np.nan_to_num(here.f - F), mesh.integral(F))
    change = y / E
    least = change.min((1, 2))
    share = np.where(least < -SHRINK, SHRINK / np.abs(least), 1.0)
    F = F + share[:, None, None] * (here.f + here.g * y - F)
    return E0 + share * start, F, np.abs(change).max((1, 2))


def settle(orbit: Orbit, index: Array, finish: Callable[[Array, Orbit], Array]) -> None:
    """Have edges where motions switch, and halve panels until the motions are polynomials.

    index    what motions are called by
    finish   takes the index of motions that are, and these; it returns the panels that are still too wide
    """
    moves, rough = np.zeros(len(index), int), orbit.designs.switches
    while len(index):
        switched = orbit.switches
        astray = (_away(switched, orbit.edges) > MOVED).any(1) & (switched.shape[1] <= PANELS)
        away = astray & (moves < ROUNDS) | rough
        bad = orbit.unresolved((orbit.F, 1.0 / orbit.rate.omega)) & ~away[:, None]
        done = np.flatnonzero(~(away | bad.any(1)) & orbit.good)
        if len(done):
            bad[done] = finish(index[done], picked(orbit, done))
        rest = np.flatnonzero((away | bad.any(1)) & orbit.good)
        edges = orbit.mesh.refined(bad, orbit.edges)[rest]
        index, moves, rough = index[rest], np.where(away, moves + 1, 0)[rest], False
        if len(index):
            orbit = _moved(picked(orbit, rest), _besides(edges, switched[rest]))


def _moved(orbit: Orbit, edges: Array) -> Orbit:
    """The motion on other panels."""
    x = Panels(edges).x
    F = orbit.mesh.at(x.reshape(len(edges), -1), np.nan_to_num(orbit.F)).reshape(x.shape)
    return newton(orbit.designs, edges, orbit.E0, F)


def _besides(edges: Array, switched: Array) -> Array:
    """Edges and the places between them where a motion switches."""
    other = np.where(_away(switched, edges) > MOVED, switched, edges[:, :1])
    return np.sort(np.concatenate([edges, other[:, (other != edges[:, :1]).any(0)]], axis=1), axis=1)


def _away(places: Array, edges: Array) -> Array:
    return np.asarray(np.abs(places[..., None] - edges[:, None, :]).min(-1))
