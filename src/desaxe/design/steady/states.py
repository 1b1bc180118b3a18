"""Every steady state of designs: brackets, periodic motions on panels that resolve them, figures."""

from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...support.panels import NODE, Panels
from ..drive.inertia import storing
from .designs import DesignRows, course_of, picked, vanishing
from .figures import figures_of
from .orbit import PANELS, Orbit, newton, settle
from .scan import DEEP, NARROWEST, Brackets, Scan, Turns, scan, turns_of

Array = NDArray[Any]
SAME = 1e-9  # of an energy: two motions are one
SECTIONS, CLOSER = 32, 3  # parts of a bracket, and how often it is divided, where Newton's method went astray
AT_ONCE = 5_000  # panels of designs
SHARE = 0.2  # of an energy, by its logarithm: between the places from which a motion is guessed
HALVED = 12  # times, panels of a guess
REPEATS = 4  # rows of finer panels for these


class States(NamedTuple):
    """Steady states: the design and the figures of each, as `figures_of` has them; the scan behind them.

    jams   where friction leaves no balance of forces, or two; or nothing has inertia
    """

    design: Array
    figures: dict[Any, Array]
    scan: Scan

    def fastest(self) -> Array:
        """The row of the stable motion at the highest speed of each design; -1 where there is none."""
        best = np.full(self.scan.turns.designs.size, -1)
        if len(self.design):
            order = np.argsort(np.abs(self.figures["omega_mean"]), kind="stable")
            order = order[(self.figures["stable"] & ~self.figures["jams"])[order]]
            best[self.design[order]] = order
        return best


def states_of(designs: DesignRows) -> States:
    """All steady states of designs."""
    scanned = scan(designs)
    brackets, turns = scanned.brackets(), scanned.turns
    parts: list[tuple[Array, dict[Any, Array]]] = []
    many = max(1, AT_ONCE // turns.edges.shape[1])
    for first in range(0, designs.size, many):
        lanes = np.arange(*np.searchsorted(brackets.design, [first, first + many]))
        if len(lanes):
            parts += [(lanes[index], rows) for index, rows in _settled(turns, picked(brackets, lanes))]
    if not parts:
        return States(np.empty(0, int), {}, scanned)
    lane = np.concatenate([index for index, _ in parts])
    order, design = np.argsort(lane), brackets.design[np.sort(lane)]
    figures = {key: np.concatenate([rows[key] for _, rows in parts])[order] for key in parts[0][1]}
    figures["jams"] |= vanishing(designs)[design]
    good = (figures["stable"] | figures["jams"]) & _first_of_each(design, figures["E0"])
    return States(design[good], picked(figures, good), scanned)


def _settled(turns: Turns, brackets: Brackets) -> list[tuple[Array, dict[Any, Array]]]:
    """The figures of the motions in brackets, in parts; from finer turns where others went astray."""
    parts: list[tuple[Array, dict[Any, Array]]] = []

    def finish(index: Array, orbit: Orbit) -> Array:
        rows, bad = figures_of(orbit)
        fine = ~bad.any(1)
        parts.extend([(index[fine], picked(rows, fine))] if fine.any() else [])
        return bad

    first = _from_turns(picked(turns, brackets.design), brackets.E0)
    kept = first.good & (first.log_multiplier < 0.0) & _first_of_each(brackets.design, first.E0)
    settle(picked(first, kept), np.flatnonzero(kept), finish)
    again = np.setdiff1d(np.arange(len(kept)), np.concatenate([[], *(index for index, _ in parts)]))
    if len(again):
        design = brackets.design[again]
        finer = turns_of(turns.designs.rows(design), _finer(turns.edges[design]))
        there, E0 = _closer(finer, brackets.low[again], brackets.high[again])
        if len(there):
            settle(_from_turns(_following(picked(finer, there), E0), E0), again[there], finish)
    return parts


def _from_turns(turns: Turns, E0: Array) -> Orbit:
    """The motions near rough turns from an energy each."""
    W, mesh = turns.path(E0), Panels(turns.edges)
    first, middle, last = W[:, :-1:2, None], W[:, 1::2, None], W[:, 2::2, None]
    with np.errstate(all="ignore"):
        slope = (0.5 * (last - first) + NODE * (first - 2.0 * middle + last)) / mesh.half
        slope = np.where(mesh.half > 0.0, slope, 0.0)
    return newton(turns.designs, turns.edges, E0, np.nan_to_num(slope), rough=turns.designs.switches)


def _following(turns: Turns, E0: Array) -> Turns:
    """Turns on panels cut until the energy changes by a small share in each half."""
    for _ in range(HALVED):
        with np.errstate(all="ignore"):
            E = np.log(E0[:, None] + turns.path(E0, DEEP))
            change = np.abs(np.diff(E)).reshape(len(E), -1, 2).max(-1)
        bad = (change > SHARE) & (np.diff(turns.edges) > NARROWEST)
        if not bad.any() or turns.edges.shape[1] > PANELS:
            break
        turns = turns_of(turns.designs, Panels(turns.edges).refined(bad, turns.edges))
    return turns


def _finer(edges: Array) -> Array:
    """Each panel in REPEATS."""
    share = np.arange(REPEATS) / REPEATS
    inner = edges[:, :-1, None] + np.diff(edges)[..., None] * share
    return np.concatenate([inner.reshape(len(edges), -1), edges[:, -1:]], axis=1)


def _closer(turns: Turns, low: Array, high: Array) -> tuple[Array, Array]:
    """The lanes whose gain falls through 0 in or next to a bracket, and where, by sections."""
    low, high = np.maximum(2.0 * low - high, 0.5 * low), 2.0 * high - low
    there, E0 = np.arange(len(low)), low
    for _ in range(CLOSER):
        starts = np.linspace(low, high, SECTIONS + 1, axis=1)
        sections = Scan(turns, starts, turns.gain(starts)).brackets()
        rows, first = np.unique(sections.design, return_index=True)
        _, E0, low, high = picked(sections, first)
        there, turns = there[rows], picked(turns, rows)
        if not len(there):
            break
    return there, E0


def _first_of_each(design: Array, E0: Array) -> Array:
    """False for a motion that another of the same design has led to."""
    keep = np.ones(len(E0), bool)
    order = np.lexsort((E0, design))
    for one, other in pairwise(order.tolist()):
        if design[one] == design[other] and abs(E0[other] - E0[one]) <= SAME * abs(E0[one]):
            keep[other] = False
    return keep


ROUNDS = 60
SETTLED = 4e-15  # of the fluctuation
LEAST = 1e-12  # kg m2
DOUBLED = 40  # times that a heavier wheel is tried
LIGHT = 1e-4  # of the first guess: no lighter wheel is tried where there is no steady state without one
NEAR_END = 1.05  # of the wheel with which the steady states end


def with_flywheels(designs: DesignRows, required: Array) -> DesignRows:
    """The designs with the smallest flywheels that keep their required fluctuations."""
    low, high = np.zeros(designs.size), _estimate(designs, required)
    nothing = vanishing(designs._replace(J=low))  # has inertia at some angle: no motion is searched for
    at_low, _ = _fluctuation(designs, np.where(nothing, high, low))
    at_low = np.where(nothing, np.inf, at_low)
    high = np.where(at_low <= required, 0.0, high)
    for _ in range(DOUBLED):
        there, slope = _fluctuation(designs, high)
        if not (short := there > required).any():
            break
        low, at_low = np.where(short, high, low), np.where(short, there, at_low)
        high = np.where(short, 4.0 * high, high)
    J, light = high.copy(), LIGHT * high
    for _ in range(ROUNDS):
        high, low = np.where(there <= required, J, high), np.where(there > required, J, low)
        at_low = np.where(there > required, there, at_low)
        ends = np.isinf(at_low)  # lighter wheels leave no steady state: there is no root
        near = ends & (high <= np.maximum(light, NEAR_END * low))
        done = (J == 0.0) | (np.abs(there - required) <= SETTLED * required) | near
        if done.all():
            break
        with np.errstate(all="ignore"):  # 1/fluctuation is nearly straight over the inertia
            trial = J + (1.0 / required - 1.0 / there) * there**2 / -slope
        middle = np.where(ends, np.where(low < light, light, np.sqrt(low * high)), 0.5 * (low + high))
        trial = np.where((trial >= low) & (trial <= high) & ~ends, trial, middle)
        if (np.abs(trial - J)[~done] <= 2e-16 * J[~done]).all():
            break
        J = np.where(done, J, trial)
        there, slope = _fluctuation(designs, J)
    return designs._replace(J=np.where(there <= required, J, high))


def _fluctuation(designs: DesignRows, J: Array) -> tuple[Array, Array]:
    """The fluctuation of each design with a flywheel, infinite without a steady state; its slope by J."""
    states = states_of(designs._replace(J=J))
    best = states.fastest()
    there, size, slope = best >= 0, np.full(len(J), np.inf), np.full(len(J), np.nan)
    if there.any():
        for into, key in ((size, "fluctuation"), (slope, ("fluctuation", "flywheel_inertia"))):
            into[there] = states.figures[key][best[there]]
    return size, slope


def _estimate(designs: DesignRows, required: Array) -> Array:
    """The flywheel under a constant torque at a speed of the motor, twice that: a generous one."""
    panels = Panels(designs.edges())
    course = course_of(designs, panels.x)
    load = designs.each(designs.way, 3) * course["load"]
    work = panels.running((panels.integral(load) / designs.period)[:, None, None] - load)
    speeds = designs.source.speeds(designs.motor) * np.ones((designs.size, 1))
    typical = np.nanmedian(np.where(speeds * designs.way[:, None] > 0.0, np.abs(speeds), np.nan), axis=1)
    J, *_ = storing(panels, work, course["inertia"], typical, required)
    return np.asarray(np.maximum(2.0 * J, LEAST))
