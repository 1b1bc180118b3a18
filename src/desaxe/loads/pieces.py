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
        found, still, theta, way, *lengths = np.broadcast_arrays(
            found, still, place.theta, place.way, *place.lengths
        )
        found = found.copy()
        for at in zip(*np.nonzero(still), strict=True):
            sides = tuple(float(length[at]) for length in lengths)
            found[at] = piece_at(load, Place(float(theta[at]), sides, float(way[at]), place.branch))
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


def first_doubles(load: OverY, place: Place, turns: Any) -> tuple[Any, Any]:
    """The first doubles behind jumps, from their rounded angles, and where long doubles are sure of that.

    Elsewhere it is that double or the next one; NaN where any may be, as where a long double is a double. A
    step of Newton's method: eleven bits more settle nearly all jumps, a thousand times sooner than integers.

    turns   true for jumps at dead centres; the others are at the nearest position of the load
    """
    with IMPORTS:
        import numpy as np

    unit = 4.0 * float(np.finfo(np.longdouble).eps)  # twice what these lines round, of the sizes below
    theta, branch = np.asarray(place.theta, float), place.branch
    with np.errstate(all="ignore"):
        ec, AB, BC = (np.asarray(length, np.longdouble) for length in place.lengths)
        sine, cosine = np.sin(theta.astype(np.longdouble)), np.cos(theta.astype(np.longdouble))
        across = ec + AB * sine
        rise = np.sqrt((BC - across) * (BC + across))
        x, slope = AB * cosine + branch * rise, sine * rise + branch * cosine * across
        if isinstance(load, OverStroke):
            along = BC + AB if load.dead_centre == "outer" else BC - AB
            height = np.sqrt((along - ec) * (along + ec))
            x = x - np.copysign(height, branch * along)
        rate, x = (-np.copysign(AB, x), np.abs(x)) if load.centre else (-AB, x)
        away = (x - np.array(sorted(set(load.outward.knots)))[:, None]).astype(float)
        # What is small has its digits: the rest needs no more of them than doubles have.
        sine, cosine, across, rise, slope, rate = (
            part.astype(float) for part in (sine, cosine, across, rise, slope, rate)
        )
        ec, AB, BC = place.lengths
        cross = np.abs(ec) + AB
        room = unit * (AB + rise + cross * np.abs(across) / rise)
        if isinstance(load, OverStroke):
            height, along = height.astype(float), along.astype(float)
            room += unit * (height + (np.abs(ec) + np.abs(along)) ** 2 / height)
        bend = cosine * (rise + branch * AB * cosine) - sine * across * (branch + AB * cosine / rise)
        steep, step = np.where(turns, bend, rate * slope / rise), np.spacing(np.abs(theta))
        error = np.where(turns, unit * (rise + cross * (1.0 + BC / rise)), room)
        size = np.abs(away)
        value = np.where(turns, slope, away[size.argmin(axis=0), np.arange(theta.size)])
        room += np.where(turns, APART * BC, 2.0 * MOST_STEPS * step * np.abs(steep))
        alone = (size <= room).sum(axis=0) == np.where(turns, 0, 1)
        steps = -value / (steep * step)
        open_ = np.abs(error / (steep * step)) + ROUNDED_STEP
        sure = np.abs(steps - np.rint(steps)) > open_
        good = alone & (np.abs(steps) < MOST_STEPS) & (open_ < 0.5) & (unit < 2.0**-60)
        good &= np.spacing(np.abs(theta) + MOST_STEPS * step) == step
        good &= np.spacing(np.abs(theta) - MOST_STEPS * step) == step
        steps = np.where(sure, np.ceil(steps), np.rint(steps))
        return np.where(good, theta + steps * step, np.nan), sure & good


def slider_of(load: OverY, place: Place) -> Slider:
    """The slider at an angle, exactly, as the positions of a load measure it."""
    own = place.theta, place.lengths, place.branch
    return FromDeadCentre(*own, load.dead_centre) if isinstance(load, OverStroke) else Slider(*own)
