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


def settled_pieces(load: OverY, place: Place) -> Any:
    """The numbers of pieces at arrays of angles as `piece_at` has them; -1 where long doubles cannot tell.

    Eleven bits more settle all but one of a thousand doubles next to a jump, a thousand times sooner. Where
    a long double is a double nothing is settled.
    """
    with IMPORTS:
        import numpy as np

    unit = 4.0 * float(np.finfo(np.longdouble).eps)  # twice what these lines round, of the sizes below
    ec, AB, BC = (np.asarray(length, np.longdouble) for length in place.lengths)
    theta = np.asarray(place.theta, np.longdouble)
    with np.errstate(all="ignore"):
        sine, cosine = np.sin(theta), np.cos(theta)
        across, cross = ec + AB * sine, np.abs(ec) + AB
        rise = np.sqrt((BC - across) * (BC + across))
        x, room = AB * cosine + place.branch * rise, unit * (AB + rise + cross * np.abs(across) / rise)
        slope = sine * rise + place.branch * cosine * across
        room_of_slope = unit * (rise + cross * (1.0 + BC / rise))
        if isinstance(load, OverStroke):
            along = BC + AB if load.dead_centre == "outer" else BC - AB
            height = np.sqrt((along - ec) * (along + ec))
            x = np.abs(np.copysign(height, place.branch * along) - x)
            room = room + unit * (height + (np.abs(ec) + np.abs(along)) ** 2 / height)
        forward = np.where(np.less(place.way, 0.0), slope, -slope)
        knots = np.array(load.outward.knots)
        away = x[..., None] - knots
        good = (np.abs(away) > room[..., None]).all(axis=-1) & (theta != 0.0)
        if load.inward is not None:
            good &= np.abs(slope) > room_of_slope
    piece = (away >= 0.0).sum(axis=-1)
    piece += np.where((forward < 0.0) & (load.inward is not None), len(load.outward.rows), 0)
    return np.where(good & (unit < 2.0**-60), piece, -1)


def slider_of(load: OverY, place: Place) -> Slider:
    """The slider at an angle, exactly, as the positions of a load measure it."""
    own = place.theta, place.lengths, place.branch
    return FromDeadCentre(*own, load.dead_centre) if isinstance(load, OverStroke) else Slider(*own)
