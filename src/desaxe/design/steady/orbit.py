"""Periodic motions: E(x) with E(period) = E(0), by Newton's method on panels between all kinks.

Each Newton step solves the linear equation for what is missing, exactly in the period's end: it finds stable
and unstable motions alike, and needs no turns. Kinks that hang on the state (knots of a motor's table, a
guide that changes sides) become edges of panels where the motion found passes them, until they stay.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .designs import Course, Designs, Rate, course_of, rate
from .mesh import Linear, Mesh

Array = NDArray[Any]
STEPS = 40  # of Newton's method
SETTLED = 4e-16  # of the energy: what a step may still change
ROUNDS = 12  # of moving edges
MOVED = 1e-13  # rad
RESOLVED = 3e-12  # of the largest value: the last coefficients of a panel
NOISE, PLATEAU = 1e-9, 0.05  # the same, where they are not smaller than this share of earlier ones
NARROWEST = 2.0**-40  # rad
HALVINGS = 40
PANELS = 1500
SHRINK = 0.8  # of the energy: what a step may take


class Orbit(NamedTuple):
    """Periodic motions of designs: the energy at the start and its slope at the nodes."""

    designs: Designs
    mesh: Mesh
    E0: Array
    F: Array
    course: Course
    rate: Rate
    linear: Linear
    good: Array  # where Newton's method settled

    @property
    def E(self) -> Array:
        """The kinetic energy at the nodes."""
        return energy(self.mesh, self.E0, self.F)


def energy(mesh: Mesh, E0: Array, F: Array) -> Array:
    """The energy at the nodes."""
    return np.asarray(E0[:, None, None] + mesh.running(F))


def newton(designs: Designs, mesh: Mesh, E0: Array, F: Array) -> Orbit:
    """The periodic motion near a guess."""
    course, row = course_of(designs, mesh.x), designs.row(3)
    good = np.zeros(len(E0), bool)
    before = np.full(len(E0), np.inf)
    E = energy(mesh, E0, F)
    with np.errstate(all="ignore"):
        for _ in range(STEPS):
            here = rate(course, designs.source, row, E)
            linear = Linear(mesh, np.nan_to_num(here.g))
            start, y = linear.solve(np.nan_to_num(here.f - F), mesh.integral(F))
            least = (y / E).min((1, 2))
            share = np.where(least < -SHRINK, SHRINK / np.abs(least), 1.0)
            E0 = E0 + share * start
            F = F + share[:, None, None] * (here.f + here.g * y - F)
            E = energy(mesh, E0, F)
            change = np.abs(y / E).max((1, 2))
            good |= (change <= SETTLED) | ((change <= 1e-10) & (change >= 0.5 * before))
            good &= np.isfinite(change)
            before = change
            if (good | ~np.isfinite(change)).all():
                break
        here = rate(course, designs.source, row, E)
        linear = Linear(mesh, np.nan_to_num(here.g))
    return Orbit(designs, mesh, E0, F, course, here, linear, good & (E > 0.0).all((1, 2)))


def switches(orbit: Orbit) -> Array:
    """The places where a motion passes a knot of the motor or the guide changes sides, NaN-free rows."""
    found = [np.empty((len(orbit.E0), 0))]
    found += [orbit.mesh.roots(orbit.rate.omega - knot) for knot in orbit.designs.source.knots]
    if orbit.rate.normal is not None:
        found.append(orbit.mesh.roots(orbit.rate.normal))
    return np.concatenate(found, axis=1)


def moved(orbit: Orbit, edges: Array) -> Orbit:
    """The motion on other panels."""
    mesh = Mesh(edges)
    shape = mesh.x.shape
    F = orbit.mesh.at(mesh.x.reshape(len(edges), -1), np.nan_to_num(orbit.F)).reshape(shape)
    return newton(orbit.designs, mesh, orbit.E0, F)


def between_kinks(orbit: Orbit, edges: Array) -> Orbit:
    """The motion with its own kinks as edges, besides these."""
    if not orbit.designs.source.knots and orbit.rate.normal is None:
        return orbit
    before = np.empty((len(edges), 0))
    for _ in range(ROUNDS):
        now = np.sort(switches(orbit), axis=1)
        if now.shape[1] > PANELS:
            break
        if now.shape == before.shape and (np.abs(now - before) <= MOVED).all():
            break
        orbit, before = moved(orbit, np.sort(np.concatenate([edges, now], axis=1), axis=1)), now
    return orbit


def unresolved(orbit: Orbit, more: tuple[Array, ...] = ()) -> Array:
    """The panels on which the motion, or one of `more`, is no polynomial yet.

    Small coefficients that no longer fall are rounding, which halving does not mend.
    """
    mesh, E, F = orbit.mesh, orbit.E, orbit.F
    width = 2.0 * mesh.half[..., 0]
    bad = np.zeros(width.shape, bool)
    with np.errstate(all="ignore"):
        for values in more or (F, 1.0 / orbit.rate.omega):
            tail, before = mesh.tails(values)
            size = np.abs(values).max((1, 2))[:, None]
            own = (tail > RESOLVED * size) & ((tail > NOISE * size) | (tail < PLATEAU * before))
            if values is F:
                own &= tail * width > 1e-15 * np.abs(E).min((1, 2))[:, None]
            bad |= own
    return bad & (width > NARROWEST) & orbit.good[:, None]
