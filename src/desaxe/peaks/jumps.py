"""Extrema next to a jump or at a kink of a load: their side, the nearest double, the whole gradient.

A kink of a load over Y moves with the design: the gradient of an extreme value that is reached there is that
at a fixed angle, and the slope over theta times the kink's derivative.
"""

from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..loads.angles import shift
from ..mechanism.catalogue import has
from ..mechanism.names import LENGTHS, sensitivity
from .course import BESIDE, CONDITION, CROSSING, FIXED, FROM_INNER, FROM_OUTER, SPEED, TURNING
from .loaded import Rows, ValuesUnderLoads
from .nodes import Array
from .special import AT_KINK, ROUNDED

EQUAL = 2.0**-40  # of a value: limits that differ by less are equal
APART = 1e-9  # of a value: what the other side of a jump changes is more
NEARBY = 1e-9  # rad: more than any angle is rounded by
STEPS = np.append(0.0, 2.0 ** np.arange(7.0))  # last bits of an angle, up to ROUNDED
# What keeps its value at a kink that moves with the lengths: a quantity, or the difference of two.
KEPT: dict[int, tuple[str, ...]] = {
    CROSSING: ("Y",),
    TURNING: ("Y_wrt_theta",),
    FROM_OUTER: ("Y", "Y_outer"),
    FROM_INNER: ("Y", "Y_inner"),
    SPEED: ("V_C",),
}


class Jumps(NamedTuple):
    """The jumps next to extrema: designs, the first angle after each, the extremum's side, what keeps it."""

    rows: Rows
    starts: Array
    sides: NDArray[np.int8]
    kinds: NDArray[np.int8]


def at_jumps(
    values: ValuesUnderLoads, kind: int, usable: NDArray[np.bool_], theta: Array, out: Array
) -> NDArray[np.int8]:
    """The side of each extremum: -1 or 1 where it is a limit at a jump, else 0.

    Completes in place: of an extremum at a jump its angle, the nearest double, with value and gradient there;
    of others at a kink the gradient.

    kind    0 for the largest magnitude
    out     rows: signed value, slope, gradient (of the magnitude for kind 0)
    """
    side = np.zeros(theta.size, np.int8)
    jumps = _jumps(values, np.where(usable, theta, np.nan))
    if jumps is not None and jumps.rows.size:
        rows, kinds = jumps.rows, jumps.kinds
        side[rows] = jumps.sides
        _complete(values, kind, jumps, theta, out)
        for what in np.unique(kinds).tolist():
            _move(values, kind, what, rows[kinds == what], theta, out)
    angles, kinds = values.course.kinks
    near = np.abs(angles - theta[:, None]) <= AT_KINK
    near[side != 0] = False
    for what in np.unique(kinds[near.any(axis=0)]).tolist():
        _move(values, kind, what, np.flatnonzero(near[:, kinds == what].any(axis=1)), theta, out)
    _tell_sides(values, theta, out[0], side)
    return side


def _tell_sides(values: ValuesUnderLoads, theta: Array, value: Array, side: NDArray[np.int8]) -> None:
    """The side of extrema at a jump of a member of a sum of loads, by values farther off than rounding."""
    leaps = values.course.leaps
    room = ROUNDED * np.spacing(1.0 + np.abs(leaps))
    rows, places = np.nonzero((np.abs(leaps - theta[:, None]) <= room) & (side == 0)[:, None])
    if rows.size:
        starts, room = leaps[rows, places], room[rows, places]
        both = values.at(2, np.tile(rows, 2), np.append(starts - room, starts + room))
        limit, slope = (row.reshape(2, -1) for row in both)
        most = EQUAL * np.abs(limit).max(axis=0) + 2.0 * room * np.abs(slope).max(axis=0)
        before, after = np.abs(limit - value[rows])
        apart = np.abs(limit[0] - limit[1]) > most
        side[rows[apart]] = np.where(before < after, -1, 1)[apart]


def _complete(values: ValuesUnderLoads, kind: int, jumps: Jumps, theta: Array, out: Array) -> None:
    """The nearest double to each jump, with value, slope and gradient there.

    The search ends next to it: of so few doubles the slope tells what they change, and no gradient changes.
    """
    rows, before = jumps.rows, theta[jumps.rows]
    there = np.where(jumps.sides > 0, jumps.starts, np.nextafter(jumps.starts, -inf))
    there = np.clip(there, *values.designs.theta)
    moves = jumps.kinds != FIXED
    if moves.any():
        limit = out[:2, rows[moves]]
        there[moves] = _certain(values, rows[moves], there[moves], jumps.sides[moves], limit)
    # There one Program is certain of the side; another one may round to the other side, or to none.
    turning = _turns_round(jumps.kinds) & values.designs.rubs
    aside = there + np.where(turning, jumps.sides * ROUNDED * np.spacing(1.0 + np.abs(there)), 0.0)
    theta[rows] = there
    out[0, rows] += out[1, rows] * (there - before)
    far = (np.abs(there - before) > ROUNDED * np.spacing(1.0 + np.abs(before))) | values.designs.rubs
    if far.any():
        rows = rows[far]
        new = np.array(values.at(len(out), rows, aside[far], values.course.pieces(rows, before[far])))
        out[0, rows], out[1, rows] = new[0] + new[1] * (there - aside)[far], new[1]
        out[2:, rows] = np.where((kind == 0) & (new[0] < 0.0), -new[2:], new[2:])


def _jumps(values: ValuesUnderLoads, theta: Array) -> Jumps | None:
    """The jumps next to extrema; of an angle between two the one before it."""
    angles, kinds = values.course.jumps
    rows, places = np.nonzero(np.abs(theta[:, None] - angles) <= NEARBY)
    starts, there = angles[rows, places], theta[rows]
    room = BESIDE * np.spacing(np.maximum(np.abs(there), np.abs(starts)))
    if values.designs.rubs:  # there `Course.aside` makes more angles equal
        turning = _turns_round(kinds[places])
        room = np.where(turning, 1.5 * ROUNDED * np.spacing(1.0 + np.abs(there)), room)
    near = np.abs(there - starts) <= room
    rows, places = rows[near], places[near]
    if not rows.size:
        return None
    starts = angles[rows, places]
    sides = np.where(theta[rows] < starts, np.int8(-1), np.int8(1))
    both = values.at(2, np.tile(rows, 2), np.append(np.nextafter(starts, -inf), starts))
    value, slope = (row.reshape(2, -1) for row in both)
    most = EQUAL * np.abs(value).max(axis=0)
    most += np.abs(slope).max(axis=0) * ROUNDED * np.spacing(1.0 + np.abs(starts))
    apart = np.flatnonzero(~(np.abs(value[0] - value[1]) <= most))
    order = apart[np.lexsort((sides[apart], rows[apart]))]
    last = order[np.append(rows[order][1:] != rows[order][:-1], True)[: order.size]]
    return Jumps(rows[last], starts[last], sides[last], kinds[places[last]])


def _certain(
    values: ValuesUnderLoads, rows: Rows, theta: Array, side: NDArray[np.int8], limit: Array
) -> Array:
    """The nearest angles to jumps from which on rounding takes their own side; as they are where none does.

    limit   value and slope of the quantity on that side
    """
    steps = side[:, None] * STEPS * np.spacing(np.abs(theta) + 1.0)[:, None]
    angles = np.clip(theta[:, None] + steps, *values.designs.theta)
    designs, name = values.designs.part(rows), values.all[0]
    numbers = np.repeat(np.arange(rows.size), STEPS.size)
    result = designs.values((name,), numbers, angles.reshape(-1))[name].reshape(angles.shape)
    (value, slope), room = limit[:, :, None], 4.0 * ROUNDED * np.spacing(1.0 + np.abs(theta))
    good = np.abs(result - value) <= APART * np.abs(value) + np.abs(slope) * room[:, None]
    good[:, :-1] &= good[:, 1:]
    first = np.where(good.any(axis=1), good.argmax(axis=1), 0)
    nearest: Array = angles[np.arange(rows.size), first]
    return nearest


def _turns_round(kinds: NDArray[np.int8]) -> NDArray[np.bool_]:
    """True where rounding may take the other side: at dead centres and where conditions change their sign."""
    return np.asarray((kinds == TURNING) | (kinds >= CONDITION))


def _move(values: ValuesUnderLoads, kind: int, what: int, rows: Rows, theta: Array, out: Array) -> None:
    """Complete gradients of extrema at kinks, where a quantity keeps its value."""
    if not rows.size or what == FIXED:
        return
    designs, moved_by = values.designs.part(rows), values.search.parameters
    if what == SPEED:
        kept, designs = KEPT[what], designs._replace(loads={})
    elif what < CONDITION:
        kept, moved_by, designs = KEPT[what], LENGTHS, designs._replace(loads={})
    else:
        kept = (designs.conditions[what - CONDITION],)
    state = "omega" in designs.columns
    names = [sensitivity(name, p) for p in ("theta", *moved_by) for name in kept]
    names = [name for name in names if has(name, state)]
    by = designs.values(tuple(names), np.arange(rows.size), theta[rows])
    sign = np.where(out[0, rows] < 0.0, -1.0, 1.0) if kind == 0 else 1.0
    for place, parameter in enumerate(values.search.parameters):
        if parameter in moved_by:
            with np.errstate(all="ignore"):
                out[2 + place, rows] += sign * out[1, rows] * shift(kept, parameter, by)
