"""Periodic motions: E(x) with E(period) = E(0), by Newton's method on panels between all kinks.

Each Newton step solves the linear equation for what is missing, exactly in the period's end: it finds stable
and unstable motions alike, and needs no turns. Kinks that hang on the state (knots of a motor's table, a
guide that changes sides) become edges of panels where the motion found passes them, until they stay.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...support.panels import TO_COEFFICIENTS, Panels, padded
from .designs import Coefficients, DesignRows, Rate, course_of, picked, rate
from .linear import Linear

Array = NDArray[Any]
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


class Orbit(NamedTuple):
    """Periodic motions of designs: the energy at the start and its slope at the nodes."""

    designs: DesignRows
    mesh: Panels
    E0: Array
    F: Array
    course: Coefficients
    rate: Rate
    log_multiplier: Array
    good: Array  # where Newton's method settled

    @property
    def E(self) -> Array:
        """The kinetic energy at the nodes."""
        return energy(self.mesh, self.E0, self.F)


def energy(mesh: Panels, E0: Array, F: Array) -> Array:
    """The energy at the nodes."""
    return np.asarray(E0[:, None, None] + mesh.running(F))


class _Lanes(NamedTuple):
    """Designs that Newton's method has not settled yet, their edges and courses."""

    designs: DesignRows
    edges: Array
    course: Coefficients

    def rows(self, index: Array) -> "_Lanes":
        return _Lanes(self.designs.rows(index), self.edges[index], picked(self.course, index))

    def step(self, E0: Array, F: Array) -> tuple[Array, Array, Array]:
        """Energy and slope after a step of Newton's method, and the relative change that it wants."""
        mesh = Panels(self.edges)
        E = energy(mesh, E0, F)
        here = rate(self.course, self.designs.source, self.designs.row(3), E)
        linear = Linear(mesh, np.nan_to_num(here.g))
        start, y = linear.solve(np.nan_to_num(here.f - F), mesh.integral(F))
        wanted = y / E
        least = wanted.min((1, 2))
        share = np.where(least < -SHRINK, SHRINK / np.abs(least), 1.0)
        F = F + share[:, None, None] * (here.f + here.g * y - F)
        return E0 + share * start, F, np.abs(wanted).max((1, 2))


def newton(designs: DesignRows, mesh: Panels, E0: Array, F: Array, rough: bool = False) -> Orbit:
    """The periodic motion near a guess; a rough one shows where it switches."""
    course = course_of(designs, mesh.x)
    left, lanes = np.arange(len(E0)), _Lanes(designs, mesh.edges, course)
    E0, F, good = E0.copy(), F.copy(), np.zeros(len(E0), bool)
    before = np.full(len(E0), np.inf)
    with np.errstate(all="ignore"):
        for _ in range(STEPS):
            if not len(left):
                break
            E0[left], F[left], change = lanes.step(E0[left], F[left])
            done = change <= (ROUGH if rough else NEXT_SETTLED)
            done |= (change * change <= EXTRAPOLATED * before) & np.isfinite(before)
            good[left] = done
            go = np.flatnonzero(~done & np.isfinite(change))
            before = change[go]
            if len(go) < len(left):
                left, lanes = left[go], lanes.rows(go)
        E = energy(mesh, E0, F)
        here = rate(course, designs.source, designs.row(3), E)
    grown = mesh.integral(np.nan_to_num(here.g))
    return Orbit(designs, mesh, E0, F, course, here, grown, good & (E > 0.0).all((1, 2)))


def switches(orbit: Orbit) -> Array:
    """The places where a motion passes a knot of the motor or the guide changes sides, in padded rows."""
    mesh = orbit.mesh
    found = [mesh.roots(orbit.rate.omega - knot) for knot in orbit.designs.source.knots]
    if orbit.designs.speeds:
        (one, *_) = orbit.course.follow
        found += [mesh.roots(one.travel * orbit.rate.omega - speed) for speed in orbit.designs.speeds]
    if orbit.rate.normal is not None:
        found.append(mesh.roots(orbit.rate.normal))
    every = np.sort(np.concatenate([mesh.edges[:, :1], *found], axis=1), axis=1)
    own = np.diff(every, axis=1, prepend=-1.0) > MOVED  # each side of an edge may find the root that is there
    row, at = np.nonzero(own)
    return padded(row, every[row, at], len(every), every[:, 0])


def moved(orbit: Orbit, edges: Array) -> Orbit:
    """The motion on other panels."""
    mesh = Panels(edges)
    shape = mesh.x.shape
    F = orbit.mesh.at(mesh.x.reshape(len(edges), -1), np.nan_to_num(orbit.F)).reshape(shape)
    return newton(orbit.designs, mesh, orbit.E0, F)


def astray(orbit: Orbit, switched: Array) -> Array:
    """True for motions that switch at places which are no edges yet."""
    return np.asarray((_away(switched, orbit.mesh.edges) > MOVED).any(1) & (switched.shape[1] <= PANELS))


def besides(edges: Array, switched: Array) -> Array:
    """Edges and the places between them where a motion switches."""
    other = np.where(_away(switched, edges) > MOVED, switched, edges[:, :1])
    return np.sort(np.concatenate([edges, other[:, (other != edges[:, :1]).any(0)]], axis=1), axis=1)


def _away(places: Array, edges: Array) -> Array:
    return np.asarray(np.abs(places[..., None] - edges[:, None, :]).min(-1))


def unresolved(orbit: Orbit, more: tuple[Array, ...] = ()) -> Array:
    """The panels on which the motion, or one of `more`, is no polynomial yet.

    Small coefficients that no longer fall are rounding, which halving does not mend.
    """
    mesh, E, F = orbit.mesh, orbit.E, orbit.F
    width = 2.0 * mesh.half[..., 0]
    bad = np.zeros(width.shape, bool)
    with np.errstate(all="ignore"):
        for values in more or (F, 1.0 / orbit.rate.omega):
            tail, before = tails(values)
            size = np.abs(values).max((1, 2))[:, None]
            own = (tail > RESOLVED * size) & ((tail > NOISE * size) | (tail < PLATEAU * before))
            if values is F:
                own &= tail * width > FLAT * np.abs(E).min((1, 2))[:, None]
            bad |= own
    return bad & (width > NARROWEST) & orbit.good[:, None]


def tails(values: Array) -> tuple[Array, Array]:
    """The last two Legendre coefficients of each panel, and two before them: the larger magnitudes."""
    four = np.abs(values @ TO_COEFFICIENTS[[10, 11, -2, -1]].T)
    return four[..., 2:].max(-1), four[..., :2].max(-1)
