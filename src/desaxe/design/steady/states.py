"""Every steady state of designs: brackets, periodic motions on panels that resolve them, figures."""

from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...support.panels import NODE, Panels
from .designs import DesignRows, picked, vanishing
from .figures import Figures, course_at_steps, figures_of
from .orbit import PANELS, Orbit, astray, besides, moved, newton, switches, unresolved
from .scan import DEEP, NARROWEST, Brackets, Scan, Turns, scan
from .slopes import OrbitSlopes

Array = NDArray[Any]
JAMS_AT = 1.0 - 1e-6  # of the wedge K: as in simulation/law.py
SAME = 1e-9  # of an energy: two motions are one
CLOSER = 14  # secant steps to a change of sign, where Newton's method did not settle from a rough one
ROUGH = 1e-4  # of the energy: a gain from which Newton's method settles
ROUNDS = 12  # of moving edges
AT_ONCE = 5_000  # panels of designs
SHARE = 0.2  # of an energy, by its logarithm: between the places from which a motion is guessed
HALVED = 12  # times, panels of a guess
REPEATS = 4  # rows of finer panels for these


class States(NamedTuple):
    """Steady states: the design of each, its figures and course; the scan that found them."""

    design: Array
    figures: Figures
    course: dict[str, Array]
    jams: Array  # where friction leaves no balance of forces, or two; or nothing has inertia
    scan: Scan


def states_of(designs: DesignRows) -> States:
    """All steady states of designs."""
    scanned = scan(designs, designs.edges())
    edges = scanned.turns.edges
    found = scanned.found()
    solved = _Solved(designs.rows(found.design))
    many = max(1, AT_ONCE // edges.shape[1])
    for first in range(0, designs.size, many):
        lanes = np.arange(*np.searchsorted(found.design, [first, first + many]))
        if len(lanes):
            _settle(solved, edges[found.design[lanes]], scanned.turns, found, lanes)
    solved.jams |= vanishing(designs)[found.design]
    stable = solved.values.get("stable", solved.good) | solved.jams
    good = np.flatnonzero(solved.good & stable & _first_of_each(found.design, solved.E0))
    return States(
        found.design[good],
        Figures(
            {k: v[good] for k, v in solved.values.items()},
            {k: {p: v[good] for p, v in by.items()} for k, by in solved.gradient.items()},
        ),
        {k: v[good] for k, v in solved.course.items()},
        solved.jams[good],
        scanned,
    )


def _settle(solved: "_Solved", edges: Array, turns: Turns, found: Brackets, lanes: Array) -> None:
    """The motions of some of the lanes; from finer turns where they do not lead to their own motions."""
    found = picked(found, lanes)
    first = _from_turns(turns.rows(found.design), found.E0)
    stable = first.log_multiplier < 0.0
    lost = ~first.good | ~stable | ~_first_of_each(found.design, first.E0)
    kept = np.flatnonzero(~lost)
    solved.settle(lanes[kept], edges[kept], _rows(first, kept))
    again = np.flatnonzero(lost | ~solved.good[lanes])
    if len(again):
        fine = _finer(edges[again])
        closer = Turns(solved.lanes.rows(lanes[again]), fine)
        there, E0 = _closer(closer, found.low[again], found.high[again])
        if len(there):
            closer = _following(closer.rows(there), E0)
            solved.settle(lanes[again][there], closer.edges, _from_turns(closer, E0))


class _Solved:
    """The results of lanes, filled as their panels resolve them."""

    def __init__(self, lanes: DesignRows) -> None:
        self.lanes = lanes
        self.good, self.jams = np.zeros(lanes.size, bool), np.zeros(lanes.size, bool)
        self.E0 = np.full(lanes.size, np.nan)
        self.values: dict[str, Array] = {}
        self.course: dict[str, Array] = {}
        self.gradient: dict[str, dict[str, Array]] = {}

    def settle(self, index: Array, edges: Array, orbit: Orbit) -> None:
        """Edges where motions switch, panels halved until motion and derivatives are polynomials."""
        moves, rough = np.zeros(len(index), int), self.lanes.switches
        while len(index):
            switched = switches(orbit)
            away = (astray(orbit, switched) & (moves < ROUNDS) | rough) & orbit.good
            bad = unresolved(orbit) & ~(jammed(orbit) | away)[:, None]
            bad &= orbit.mesh.edges.shape[1] <= PANELS
            done = np.flatnonzero(~(away | bad.any(1)) & orbit.good)
            if len(done):
                bad[done] = self._finish(index[done], _rows(orbit, done))
            rest = np.flatnonzero(away | bad.any(1))
            if not len(rest):
                return
            edges, moves = orbit.mesh.refined(bad, edges)[rest], np.where(away, moves + 1, 0)[rest]
            index, rough, orbit = (
                index[rest],
                False,
                moved(_rows(orbit, rest), besides(edges, switched[rest])),
            )

    def _finish(self, index: Array, orbit: Orbit) -> Array:
        """Take the motions whose derivatives are polynomials, too; the panels on which others are not."""
        slopes = OrbitSlopes(orbit)
        bad = unresolved(orbit, tuple(slopes.forcing[name] for name in slopes.names))
        bad &= ~jammed(orbit)[:, None] & (orbit.mesh.edges.shape[1] <= PANELS)
        done = np.flatnonzero(~bad.any(1))
        if len(done) == len(index):
            self._take(index, orbit, slopes)
        elif len(done):
            orbit = _rows(orbit, done)
            self._take(index[done], orbit, OrbitSlopes(orbit))
        return bad

    def _take(self, index: Array, orbit: Orbit, slopes: OrbitSlopes) -> None:
        figures = figures_of(orbit, slopes)
        count = self.lanes.size
        self.good[index], self.E0[index] = orbit.good, orbit.E0
        self.jams[index] = jammed(orbit)
        _put(self.values, index, figures.values, count)
        _put(self.course, index, course_at_steps(orbit), count)
        for key, by in figures.gradient.items():
            _put(self.gradient.setdefault(key, {}), index, by, count)


def jammed(orbit: Orbit) -> Array:
    """True where friction leaves no balance of forces somewhere on the turn, or two."""
    wedge = orbit.rate.wedge
    if wedge is None:
        return np.zeros(len(orbit.E0), bool)
    return np.asarray(((wedge >= JAMS_AT) | (wedge < -1.0)).any((1, 2)))


def _put(into: dict[str, Array], index: Array, rows: dict[str, Array], count: int) -> None:
    for name, values in rows.items():
        if name not in into:
            into[name] = np.zeros((count, *values.shape[1:]), values.dtype)
        into[name][index] = values


def _rows(orbit: Orbit, rows: Array) -> Orbit:
    """Some of the motions."""
    if len(rows) == len(orbit.E0):
        return orbit

    return Orbit(
        orbit.designs.rows(rows), Panels(orbit.mesh.edges[rows]), orbit.E0[rows], orbit.F[rows],
        picked(orbit.course, rows), picked(orbit.rate, rows), orbit.log_multiplier[rows], orbit.good[rows],
    )  # fmt: skip


def _from_turns(turns: Turns, E0: Array) -> Orbit:
    """The motions near rough turns from an energy each."""
    W, mesh = turns.path(E0), Panels(turns.edges)
    first, middle, last = W[:, :-1:2, None], W[:, 1::2, None], W[:, 2::2, None]
    with np.errstate(all="ignore"):
        slope = (0.5 * (last - first) + NODE * (first - 2.0 * middle + last)) / mesh.half
        slope = np.where(mesh.half > 0.0, slope, 0.0)
    return newton(turns.designs, mesh, E0, np.nan_to_num(slope), turns.designs.switches)


def _following(turns: Turns, E0: Array) -> Turns:
    """Turns on panels cut until the energy changes by a small share in each half."""
    for _ in range(HALVED):
        with np.errstate(all="ignore"):
            E = np.log(E0[:, None] + turns.path(E0, DEEP))
            change = np.abs(np.diff(E)).reshape(len(E), -1, 2).max(-1)
        bad = (change > SHARE) & (np.diff(turns.edges) > NARROWEST)
        if not bad.any() or turns.edges.shape[1] > PANELS:
            break
        turns = Turns(turns.designs, Panels(turns.edges).refined(bad, turns.edges))
    return turns


def _finer(edges: Array) -> Array:
    """Each panel in REPEATS."""
    share = np.arange(REPEATS) / REPEATS
    inner = edges[:, :-1, None] + np.diff(edges)[..., None] * share
    return np.concatenate([inner.reshape(len(edges), -1), edges[:, -1:]], axis=1)


def _closer(turns: Turns, low: Array, high: Array) -> tuple[Array, Array]:
    """The lanes whose gain changes its sign in or next to a bracket, and where, by Illinois steps."""
    low, high = np.maximum(2.0 * low - high, 0.5 * low), 2.0 * high - low
    below, above = turns.gain(np.stack([low, high], axis=1)).T
    there = np.flatnonzero(~(np.sign(below) == np.sign(above)))
    low, high, below, above = (values[there] for values in (low, high, below, above))
    turns = turns.rows(there)
    for _ in range(CLOSER if len(there) else 0):
        with np.errstate(all="ignore"):
            middle = high - above * (high - low) / (above - below)
        middle = np.where((middle > low) & (middle < high), middle, 0.5 * (low + high))
        here = turns.gain(middle[:, None])[:, 0]
        same = np.sign(here) == np.sign(above)
        low, below = np.where(same, low, middle), np.where(same, 0.5 * below, here)
        high, above = np.where(same, middle, high), np.where(same, here, 0.5 * above)
        if (np.abs(here) <= ROUGH * np.abs(middle)).all():
            break
    return there, np.where(np.abs(below) < np.abs(above), low, high)


def _first_of_each(design: Array, E0: Array) -> Array:
    """False for a motion that another of the same design has led to."""
    keep = np.ones(len(E0), bool)
    order = np.lexsort((E0, design))
    for one, other in pairwise(order.tolist()):
        if design[one] == design[other] and abs(E0[other] - E0[one]) <= SAME * abs(E0[one]):
            keep[other] = False
    return keep


def main_of(states: States, count: int) -> Array:
    """The row of the stable motion at the highest speed of each design; -1 where there is none."""
    found = np.full(count, -1)
    values = states.figures.values
    speed = np.abs(values["omega_mean"]) if values else np.empty(0)
    for row in np.argsort(speed, kind="stable"):
        if values["stable"][row] and not states.jams[row]:
            found[states.design[row]] = row
    return found
