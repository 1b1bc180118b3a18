"""Arcs of crank angles on which one piece of a load over Y holds, for many designs.

Where an arc begins is rounded; which piece holds on it is not. So whoever holds the piece of an arc is on the
right side of a jump, and can ask for the double next to it.
"""

from collections.abc import Callable, Mapping
from math import inf, isfinite, nextafter, ulp
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..loads.angles import crossings, dead_centres, limit_angles, repeated
from ..loads.load import OverY
from ..loads.pieces import Place, piece_at, pieces_at, settled_pieces
from ..loads.resolve import way_of
from ..loads.table import SAME
from ..mechanism.names import LENGTHS
from .values import values

Array = NDArray[np.float64]
NEXT = 3  # doubles on either side of a rounded angle, among which the exact one mostly is


class Arcs(NamedTuple):
    """The arcs of a load: a row a design, empty places at the end.

    load    the load
    end     the last angle of all
    starts  the first angle of each arc, ascending, inf in empty places; the first lies before the range
    pieces  the piece that holds on each
    leaps   whether the load jumps where it begins
    turns   whether that is a dead centre, else a position
    """

    load: OverY
    end: float
    starts: Array
    pieces: NDArray[np.intp]
    leaps: NDArray[np.bool_]
    turns: NDArray[np.bool_]

    def at(self, rows: NDArray[np.intp], theta: Array) -> NDArray[np.intp]:
        """The pieces of the arcs of some angles, of the designs `rows`."""
        places = (self.starts[rows] <= theta[:, None]).sum(axis=1) - 1
        found: NDArray[np.intp] = self.pieces[rows, places]
        return found

    def first_angles(self, place: Place, rows: NDArray[np.intp], numbers: NDArray[np.intp]) -> Array:
        """The first doubles of arcs that begin at jumps, exactly; `place` is that of the designs `rows`."""
        starts, pieces = self.starts[rows, numbers], self.pieces[rows, numbers]
        theta = starts + np.arange(-NEXT, NEXT + 1.0)[:, None] * np.spacing(starts)
        known = settled_pieces(self.load, place._replace(theta=theta))
        holds = known == pieces
        found: Array = theta[holds.argmax(axis=0), np.arange(rows.size)]
        begins = ~holds[0] & holds[-1] & (np.diff(holds, axis=0).sum(axis=0) == 1) & (known >= 0).all(axis=0)
        for k in np.flatnonzero(~begins).tolist():
            one = Place(0.0, [float(side[k]) for side in place.lengths], float(place.way[k]), place.branch)
            found[k] = self.first_angle(one, int(rows[k]), int(numbers[k]))
        return found

    def first_angle(self, place: Place, row: int, number: int) -> float:
        """The first double of an arc that begins at a jump, exactly; `place` is the design's."""
        piece = int(self.pieces[row, number])

        def holds(theta: float) -> bool:
            return piece_at(self.load, place._replace(theta=theta)) == piece

        before, inside = self._middle(row, number - 1), self._middle(row, number)
        return _first(holds, before, float(self.starts[row, number]), inside)

    def _middle(self, row: int, number: int) -> float:
        first, after = map(float, self.starts[row, number : number + 2])
        return first + 0.5 * ((nextafter(after, -inf) if isfinite(after) else self.end) - first)


def arcs_of(load: OverY, columns: Mapping[str, Array], branch: int, low: float, high: float) -> Arcs:
    """The arcs over a range of angles and the doubles beside it; columns have a value for each design.

    Each end is an arc of its own: there the value itself counts, on whichever side of a jump it is.
    """
    starts = _starts(load, [columns[name] for name in LENGTHS], branch, low, high)
    first = np.where(np.isfinite(starts), starts, high)
    after = np.where(np.isfinite(starts[:, 1:]), np.nextafter(starts[:, 1:], -inf), first[:, :-1])
    last = np.maximum(np.append(after, first[:, -1:], axis=1), first)
    wide = {name: column[:, None] for name, column in columns.items()}
    lengths, way = {name: wide[name] for name in LENGTHS}, way_of(wide)
    theta = np.stack([first, first + 0.5 * (last - first)])
    motion = values(list(load.motion()), {**lengths, "theta": theta}, branch)
    place = Place(theta[1], tuple(lengths.values()), way, branch)
    pieces = pieces_at(load, place, {name: found[1] for name, found in motion.items()})
    before, along = np.roll(pieces, 1, axis=1), load.along({name: found[0] for name, found in motion.items()})
    change = load.held(along, pieces)[0] - load.held(along, before)[0]
    leaps, inward = np.abs(change) > SAME * load.largest, len(load.outward.rows)
    turns = leaps & ((pieces < inward) != (before < inward))
    same = pieces == before
    same[:, 0] = leaps[:, 0] = turns[:, 0] = False
    order = np.argsort(np.where(same, inf, starts), axis=1, kind="stable")
    parts = (np.where(same, inf, starts), pieces, leaps & np.isfinite(starts), turns & np.isfinite(starts))
    return Arcs(load, nextafter(high, inf), *(np.take_along_axis(part, order, axis=1) for part in parts))


def _starts(load: OverY, lengths: list[Array], branch: int, low: float, high: float) -> Array:
    """Angles at which arcs begin: knots, dead centres if the way matters, limits of the rod, ends."""
    angles = [crossings(load, load.positions(smooth=True), lengths, branch), limit_angles(lengths)]
    angles += [dead_centres(lengths)] if load.turns else []
    between = repeated(np.concatenate(angles, axis=1), low, high)
    between = np.where((between > nextafter(low, inf)) & (between < high), between, inf)
    ends = nextafter(low, -inf), low, nextafter(low, inf), high, nextafter(high, inf), inf
    starts = np.sort(np.append(between, np.tile(ends, (len(between), 1)), axis=1), axis=1)
    starts = starts[:, : np.isfinite(starts).sum(axis=1).max() + 1]
    for k in range(1, starts.shape[1]):  # a position that is only just reached has two equal ones
        starts[:, k] = np.maximum(starts[:, k], np.nextafter(starts[:, k - 1], inf))
    return starts


def _first(holds: Callable[[float], bool], before: float, start: float, inside: float) -> float:
    """The first double that holds, next to `start`; no double up to `before` does, and `inside` does."""
    bad, good, step = before, inside, ulp(start)
    here = holds(start)
    bad, good = (bad, start) if here else (start, good)
    while bad < (there := start + (-step if here else step)) < good:
        if holds(there) != here:
            return _between(holds, *((there, good) if here else (bad, there)))
        bad, good, step = (bad, there, 2.0 * step) if here else (there, good, 2.0 * step)
    return _between(holds, bad, good)


def _between(holds: Callable[[float], bool], bad: float, good: float) -> float:
    while bad < (there := bad + 0.5 * (good - bad)) < good:
        bad, good = (bad, there) if holds(there) else (there, good)
    return good
