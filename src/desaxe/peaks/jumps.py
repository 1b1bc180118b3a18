"""Extrema next to a jump or at a kink of a load: their side, the nearest double, the whole gradient.

A kink of a load over Y moves with the design: the gradient of an extreme value that is reached there is that
at a fixed angle, and the slope over theta times the kink's derivative.
"""

from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..mechanism.names import LENGTHS, sensitivity
from .course import BESIDE, CROSSING, FROM_INNER, FROM_OUTER, ROUNDED, TURNING
from .loaded import Rows, Values
from .nodes import Array
from .special import AT_KINK

EQUAL = 2.0**-40  # of a value: limits that differ by less are equal
APART = 1e-9  # of a value: what friction of the other side changes is more
# What keeps its value at a kink that moves with the lengths: a quantity, or the difference of two.
KEPT = {
    CROSSING: ("Y",),
    TURNING: ("Y_wrt_theta",),
    FROM_OUTER: ("Y", "Y_outer"),
    FROM_INNER: ("Y", "Y_inner"),
}


class Jump(NamedTuple):
    """A jump next to an extremum: the first angle after it, the extremum's side, what keeps its place."""

    start: float
    side: int
    kind: int


def at_jumps(
    values: Values, kind: int, usable: NDArray[np.bool_], theta: Array, out: Array
) -> NDArray[np.int8]:
    """The side of each extremum: -1 or 1 where it is a limit at a jump, else 0.

    Completes in place: of an extremum at a jump its angle, the nearest double, with value and gradient there;
    of others at a kink the gradient.

    kind    0 for the largest magnitude
    out     rows: signed value, slope, gradient (of the magnitude for kind 0)
    """
    side = np.zeros(theta.size, np.int8)
    jumps = _jumps(values, np.where(usable, theta, np.nan))
    rows = np.array(sorted(jumps), np.intp)
    if rows.size:
        found = [jumps[row] for row in rows]
        side[rows] = [jump.side for jump in found]
        pieces = values.course.pieces(rows, theta[rows])
        theta[rows] = np.clip(_nearest(values, rows, found), *values.designs.theta)
        turning = np.array([jump.kind == TURNING for jump in found])
        if values.designs.rubs and turning.any():
            some = {name: own[turning] for name, own in pieces.items()}
            theta[rows[turning]] = _certain(
                values, rows[turning], theta[rows[turning]], side[rows[turning]], some
            )
        new = np.array(values.at(len(out), rows, theta[rows], pieces))
        out[:2, rows] = new[:2]
        out[2:, rows] = np.where((kind == 0) & (new[0] < 0.0), -new[2:], new[2:])
        for what in KEPT:
            _move(values, kind, what, rows[np.array([jump.kind == what for jump in found])], theta, out)
    angles, kinds = values.course.kinks
    for what in KEPT:
        near = (np.abs(angles[:, kinds == what] - theta[:, None]) <= AT_KINK).any(axis=1) & (side == 0)
        _move(values, kind, what, np.flatnonzero(near), theta, out)
    return side


def _jumps(values: Values, theta: Array) -> dict[int, Jump]:
    """The jumps next to extrema, by the number of the design; of an angle between two the one before it."""
    angles, kinds = values.course.jumps
    with np.errstate(invalid="ignore"):
        room = BESIDE * np.spacing(np.maximum(np.abs(theta[:, None]), np.abs(angles)))
        if values.designs.rubs:  # there `Course.aside` makes more angles equal
            room[:, kinds == TURNING] = 1.5 * ROUNDED * np.spacing(1.0 + np.abs(theta[:, None]))
        rows, places = np.nonzero(np.abs(theta[:, None] - angles) <= room)
    if not rows.size:
        return {}
    starts = angles[rows, places]
    both = values.at(2, np.tile(rows, 2), np.append(np.nextafter(starts, -inf), starts))
    before, after = np.split(np.array(both), 2, axis=1)
    value, slope = np.maximum(np.abs(before), np.abs(after))
    apart = ~(np.abs(before - after)[0] <= EQUAL * value + slope * ROUNDED * np.spacing(1.0 + np.abs(starts)))
    found: dict[int, dict[int, Jump]] = {}
    for row, place, start in zip(rows[apart].tolist(), places[apart], starts[apart].tolist(), strict=True):
        jump = Jump(start, -1 if theta[row] < start else 1, int(kinds[place]))
        found.setdefault(row, {})[jump.side] = jump
    return {row: own.get(1) or own[-1] for row, own in found.items()}


def _nearest(values: Values, rows: Rows, jumps: list[Jump]) -> Array:
    """The doubles that are nearest to jumps on a side, of the designs `rows`."""
    starts, after = np.array([jump.start for jump in jumps]), np.array([jump.side > 0 for jump in jumps])
    first, last = np.full((2, rows.size), np.nan)
    for arcs in values.course.arcs.values():
        here, numbers = np.nonzero((arcs.starts[rows] == starts[:, None]) & arcs.leaps[rows])
        own = rows[here]
        angles = arcs.first_angles(values.designs.part(own).places(), own, numbers)
        np.fmin.at(first, here, angles)
        np.fmax.at(last, here, angles)
    nearest = np.where(after, last, np.nextafter(first, -inf))
    return np.where(np.isnan(first), np.where(after, starts, np.nextafter(starts, -inf)), nearest)


def _certain(values: Values, rows: Rows, theta: Array, side: Array, pieces: dict[str, Rows]) -> Array:
    """The nearest angles to dead centres from which on rounding takes the friction of their own side."""
    steps = np.arange(ROUNDED + 1.0) * np.spacing(np.abs(theta) + 1.0)[:, None]
    angles = theta[:, None] + side[:, None] * steps
    designs, name = values.designs.part(rows), values.curve[0]
    numbers = np.repeat(np.arange(rows.size), angles.shape[1])
    found = designs.values((name,), numbers, angles.reshape(-1))[name].reshape(angles.shape)
    wrong = ~(np.abs(found - found[:, -1:]) <= APART * np.abs(found[:, -1:]))
    count = np.where(wrong.any(axis=1), angles.shape[1] - wrong[:, ::-1].argmax(axis=1), 0)
    found = angles[np.arange(rows.size), np.minimum(count, angles.shape[1] - 1)]
    return np.asarray(found)


def _move(values: Values, kind: int, what: int, rows: Rows, theta: Array, out: Array) -> None:
    """Complete gradients of extrema at kinks, where a quantity of the motion keeps its value."""
    parameters = values.search.parameters
    if not rows.size:
        return
    kept, *centre = KEPT[what]
    names = [sensitivity(kept, "theta"), *(sensitivity(n, q) for n in (kept, *centre) for q in LENGTHS)]
    designs = values.designs.part(rows)._replace(loads={})
    found = designs.values(tuple(names), np.arange(rows.size), theta[rows])
    sign = np.where(out[0, rows] < 0.0, -1.0, 1.0) if kind == 0 else 1.0
    for length in LENGTHS:
        if length in parameters:
            with np.errstate(all="ignore"):
                by = found[sensitivity(kept, length)] - sum(found[sensitivity(n, length)] for n in centre)
                out[2 + parameters.index(length), rows] -= sign * out[1, rows] * by / found[names[0]]
