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


def slider_of(load: OverY, place: Place) -> Slider:
    """The slider at an angle, exactly, as the positions of a load measure it."""
    own = place.theta, place.lengths, place.branch
    return FromDeadCentre(*own, load.dead_centre) if isinstance(load, OverStroke) else Slider(*own)
