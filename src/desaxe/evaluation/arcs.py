"""Arcs of crank angles on which one piece of a load over Y holds, for many designs.

An arc begins at the double nearest to its angle. Whoever holds its piece has the limits on both sides of a
jump, whichever side a rounded position may be on.
"""

from collections.abc import Mapping
from math import inf, nextafter
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..loads.angles import crossings
from ..loads.load import OverY, ahead
from ..loads.resolve import way_of
from ..loads.table import SAME
from ..mechanism.closed.angles import dead_centres, limit_angles, repeated
from ..mechanism.names import LENGTHS
from .values import values

Array = NDArray[np.float64]
BESIDE = 1e-6  # rad: more than what is rounded of an angle next to a dead centre


class Arcs(NamedTuple):
    """The arcs of a load: a row a design, empty places at the end.

    starts  the first angle of each arc, ascending, inf in empty places; the first lies before the range
    pieces  the piece that holds on each
    leaps   whether the load jumps where it begins
    turns   whether that is a dead centre, else a position
    """

    starts: Array
    pieces: NDArray[np.intp]
    leaps: NDArray[np.bool_]
    turns: NDArray[np.bool_]

    def at(self, rows: NDArray[np.intp], theta: Array) -> NDArray[np.intp]:
        """The pieces of the arcs of some angles, of the designs `rows`."""
        places = np.full(np.broadcast_shapes(theta.shape, rows.shape), -1)
        for starts in self.starts.T:
            places += starts[rows] <= theta
        result: NDArray[np.intp] = self.pieces[rows, places]
        return result


def arcs_of(
    load: OverY,
    columns: Mapping[str, Array],
    branch: int,
    ends: tuple[float, float],
    meeting: Array | None = None,
) -> Arcs:
    """The arcs over a range of angles and the doubles beside it; columns have a value for each design.

    Each end is an arc of its own: there the value itself counts, on whichever side of a jump it is.

    meeting   the angles in a turn at which pieces of the load meet, where they are known
    """
    low, high = ends
    lengths = [columns[name] for name in LENGTHS]
    if meeting is None:
        crossed = crossings(load, load.positions(smooth=True), lengths, branch)
        meeting = meeting_in_turn(load, crossed, dead_centres(lengths))
    starts = _starts(meeting, limit_angles(lengths), low, high)
    first = np.where(np.isfinite(starts), starts, high)
    after = np.where(np.isfinite(starts[:, 1:]), np.nextafter(starts[:, 1:], -inf), high)
    last = np.maximum(np.append(after, first[:, -1:], axis=1), first)
    theta = (first + 0.5 * (last - first)).reshape(-1)
    way = np.broadcast_to(way_of(columns), lengths[0].shape)
    *wide, ways = (np.repeat(column, first.shape[1]) for column in (*lengths, way))
    motion = values(list(load.motion()), {**dict(zip(LENGTHS, wide, strict=True)), "theta": theta}, branch)
    pieces = load.piece(load.along(motion), ahead(motion, ways)).reshape(first.shape)
    changes = np.append(np.ones((len(pieces), 1), np.bool_), pieces[:, 1:] != pieces[:, :-1], axis=1)
    rows, numbers = np.nonzero(changes)
    here, before = pieces[rows, numbers], pieces[rows, np.maximum(numbers, 1) - 1]
    angles = starts[rows, numbers]
    own = {name: column[rows] for name, column in zip(LENGTHS, lengths, strict=True)}
    motion = values(list(load.motion()), {**own, "theta": angles}, branch)
    along = load.along(motion)
    change = load.held(along, here)[0] - load.held(along, before)[0]
    leaps, inward = (np.abs(change) > SAME * load.largest) & (numbers > 0), len(load.outward.rows)
    turns = leaps & ((here < inward) != (before < inward))
    places = rows, (np.cumsum(changes, axis=1) - 1)[rows, numbers]
    shape = len(pieces), int(places[1].max(initial=0)) + 2

    def placed(values_: NDArray[Any], empty: Any) -> NDArray[Any]:
        table = np.full(shape, empty, values_.dtype)
        table[places] = values_
        return table

    parts = placed(angles, inf), placed(here, 0), placed(leaps, False), placed(turns, False)
    return Arcs(*parts)


def meeting_in_turn(load: OverY, crossed: Array, dead: Array) -> Array:
    """The angles in a turn at which pieces of a load meet: at its positions, and where the way matters."""
    return np.append(crossed, dead, axis=1) if load.turns else crossed


def _starts(meeting: Array, limits: Array, low: float, high: float) -> Array:
    """Angles at which arcs begin: where pieces meet, limits of the rod, ends if pieces meet next to them."""
    between = repeated(np.append(meeting, limits, axis=1), low - BESIDE, high + BESIDE)
    every = between[between == between]
    beside = ((every <= low + BESIDE) | (every >= high - BESIDE)).any()
    between = np.where((between > nextafter(low, inf)) & (between < high), between, inf)
    ends = (low, nextafter(low, inf), high, nextafter(high, inf)) if beside else ()
    ends = nextafter(low, -inf), *ends, inf
    starts = np.sort(np.append(between, np.tile(ends, (len(between), 1)), axis=1), axis=1)
    starts = starts[:, : np.isfinite(starts).sum(axis=1).max() + 1]
    if (starts[:, 1:] <= starts[:, :-1]).any():
        for k in range(1, starts.shape[1]):  # a position that is only just reached has two equal ones
            starts[:, k] = np.maximum(starts[:, k], np.nextafter(starts[:, k - 1], inf))
    return starts
