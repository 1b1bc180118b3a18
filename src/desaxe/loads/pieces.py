"""The piece of a load over Y that holds at a crank angle: exactly, where rounding leaves a jump open."""

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from ..support.forks import IMPORTS
from .exact import FromDeadCentre, Slider
from .load import POSITION, OverY
from .stroke import OverStroke

NEAR = 2.0**-44  # of AB + BC: next to a jump, as far as a rounded position tells
FLAT = 2.0**-36  # of AB: next to a dead centre, as far as a rounded slope tells
MOST_STEPS = 8.0  # doubles between an angle and a jump that it is rounded from
ROUNDED_STEP = 2.0**-20  # of the step between doubles: more than a step of Newton's method is off, next to it
SHORT = 2.0**-60  # four times what a long double rounds; more where it is no longer than a double
APART = 2.0**-40  # of BC: so far from a position the slider does not reach it next to a dead centre


class Place(NamedTuple):
    """The slider's place at an angle, and its direction: numbers, or arrays that broadcast."""

    theta: Any
    lengths: Sequence[Any]  # ec, AB, BC
    way: Any  # negative where the crank turns backwards
    branch: int


def ahead(motion: Mapping[str, Any], way: Any) -> Any:
    """Negative where the slider goes inward; at a dead centre where it will."""
    _, slope, bend = (motion[name] for name in POSITION)
    if isinstance(slope, float) and isinstance(way, float):
        forward = slope or bend
        return float(forward if way >= 0.0 else -forward)
    with IMPORTS:
        import numpy as np

    forward = np.where(np.equal(slope, 0.0), bend, slope)
    return np.where(np.less(way, 0.0), -forward, forward)


def pieces_at(load: OverY, place: Place, motion: Mapping[str, Any]) -> Any:
    """The number of the piece at each point, from its motion: the values of `load.motion()`."""
    Y, slope = load.along(motion), motion["Y_wrt_theta"]
    found = load.piece(Y, ahead(motion, place.way))
    still = load.jumping and _is_open(load, place, Y, slope, found)
    if isinstance(found, int):
        return piece_at(load, place) if still else found
    with IMPORTS:
        import numpy as np

    if np.any(still):
        found, still, *parts = np.broadcast_arrays(found, still, place.theta, place.way, *place.lengths)
        theta, way, *lengths = (np.asarray(part[still], float) for part in parts)
        found, some = found.copy(), Place(theta, lengths, way, place.branch)
        pieces = settled_pieces(load, some)
        for k in np.flatnonzero(pieces < 0).tolist():
            sides = tuple(float(length[k]) for length in lengths)
            pieces[k] = piece_at(load, Place(float(theta[k]), sides, float(way[k]), place.branch))
        found[still] = pieces
    return found


def _is_open(load: OverY, place: Place, Y: Any, slope: Any, piece: Any) -> Any:
    """True where rounding may have decided on the piece."""
    _, AB, BC = place.lengths
    number, edges, room = piece % len(load.outward.rows), load.edges(Y), NEAR * (AB + BC)
    found = (Y - edges[number] <= room) | (edges[number + 1] - Y <= room)
    return found | (abs(slope) <= FLAT * AB) if load.turns else found


def piece_at(load: OverY, place: Place) -> int:
    """The number of the piece at one point, exactly."""
    slider = slider_of(load, place)
    inward = load.inward is not None and slider.way * (1 if place.way >= 0.0 else -1) < 0
    table = load.inward if inward and load.inward is not None else load.outward
    return bisect_right(table.knots, slider) + (len(load.outward.rows) if inward else 0)


class _Fine(NamedTuple):
    """A slider in long doubles, rounded to doubles: what is small has its digits.

    unit         four times what they round
    sine, cosine, across, rise   of the crank angle, of the rod
    outward      what the position, or the distance from a dead centre, grows by where the slider goes outward
    away         from the positions of a load, a row each; `room` is more than what is rounded of it
    slope        a multiple of -dY/dtheta, and more than what is rounded of that
    """

    unit: float
    sine: Any
    cosine: Any
    across: Any
    rise: Any
    outward: Any
    away: Any
    room: Any
    slope: Any
    room_of_slope: Any


def _finely(load: OverY, place: Place) -> _Fine:
    with IMPORTS:
        import numpy as np

    unit, branch = 4.0 * float(np.finfo(np.longdouble).eps), place.branch
    with np.errstate(all="ignore"):
        theta, ec, AB, BC = (np.asarray(each, np.longdouble) for each in (place.theta, *place.lengths))
        sine, cosine = np.sin(theta), np.cos(theta)
        across = ec + AB * sine
        rise = np.sqrt((BC - across) * (BC + across))
        x, slope = AB * cosine + branch * rise, sine * rise + branch * cosine * across
        cross = np.abs(ec) + AB
        room, room_of_slope = AB + rise + cross * np.abs(across) / rise, rise + cross * (1.0 + BC / rise)
        outward: Any = np.ones(x.shape)
        if isinstance(load, OverStroke):
            along = BC + AB if load.dead_centre == "outer" else BC - AB
            height = np.sqrt((along - ec) * (along + ec))
            x = x - np.copysign(height, branch * along)
            outward, x = np.copysign(1.0, x), np.abs(x)
            room = room + height + (np.abs(ec) + np.abs(along)) ** 2 / height
        away = x - np.array(load.outward.knots)[:, None]
        parts = sine, cosine, across, rise, outward, away, unit * room, slope, unit * room_of_slope
        return _Fine(unit, *(part.astype(float) for part in parts))


def settled_pieces(load: OverY, place: Place) -> Any:
    """The numbers of pieces at arrays of angles as `piece_at` has them; -1 where long doubles cannot tell.

    Eleven bits more settle all but one of a thousand doubles next to a jump, a thousand times sooner. Where
    a long double is a double nothing is settled.
    """
    with IMPORTS:
        import numpy as np

    fine = _finely(load, place)
    good = (np.abs(fine.away) > fine.room).all(axis=0) & (place.theta != 0.0) & (fine.unit < SHORT)
    inward = np.zeros(good.shape, np.bool_)
    if load.inward is not None:
        good &= np.abs(fine.slope) > fine.room_of_slope
        inward = np.where(np.less(place.way, 0.0), fine.slope, -fine.slope) < 0.0
    piece = (fine.away >= 0.0).sum(axis=0) + np.where(inward, len(load.outward.rows), 0)
    return np.where(good, piece, -1)


def first_doubles(load: OverY, place: Place, turns: Any) -> tuple[Any, Any]:
    """The first doubles behind jumps, from their rounded angles, and where long doubles are sure of that.

    Elsewhere it is that double or the next one; NaN where any may be, as where a long double is a double. A
    step of Newton's method: eleven bits more settle nearly all jumps, a thousand times sooner than integers.

    turns   true for jumps at dead centres; the others are at the nearest position of the load
    """
    with IMPORTS:
        import numpy as np

    theta, branch = np.asarray(place.theta, float), place.branch
    _, AB, BC = place.lengths
    fine = _finely(load, place)
    with np.errstate(all="ignore"):
        rise, cosine, size = fine.rise, fine.cosine, np.abs(fine.away)
        bend = cosine * (rise + branch * AB * cosine)
        bend -= fine.sine * fine.across * (branch + AB * cosine / rise)
        steep, step = np.where(turns, bend, -AB * fine.outward * fine.slope / rise), np.spacing(np.abs(theta))
        error = np.where(turns, fine.room_of_slope, fine.room)
        value = np.where(turns, fine.slope, fine.away[size.argmin(axis=0), np.arange(theta.size)])
        room = fine.room + np.where(turns, APART * BC, 2.0 * MOST_STEPS * step * np.abs(steep))
        alone = (size <= room).sum(axis=0) == np.where(turns, 0, (size == size.min(axis=0)).sum(axis=0))
        steps = -value / (steep * step)
        open_ = np.abs(error / (steep * step)) + ROUNDED_STEP
        sure = np.abs(steps - np.rint(steps)) > open_
        good = alone & (np.abs(steps) < MOST_STEPS) & (open_ < 0.5) & (fine.unit < SHORT)
        good &= np.spacing(np.abs(theta) + MOST_STEPS * step) == step
        good &= np.spacing(np.abs(theta) - MOST_STEPS * step) == step
        steps = np.where(sure, np.ceil(steps), np.rint(steps))
        return np.where(good, theta + steps * step, np.nan), sure & good


def slider_of(load: OverY, place: Place) -> Slider:
    """The slider at an angle, exactly, as the positions of a load measure it."""
    own = place.theta, place.lengths, place.branch
    return FromDeadCentre(*own, load.dead_centre) if isinstance(load, OverStroke) else Slider(*own)
