"""Sizes of inputs, beyond which a number is almost surely a slip of a unit, and the remedies."""

from math import inf, pi
from typing import NamedTuple

from .inputs import UNITS

FORCES = ("F_X", "F_Y")
FARTHEST = 20.0  # m: no size of a mechanism is larger


class Typical(NamedTuple):
    """A kind of input: above `most` it is a slip, unless it is above `beyond` as well: then it is meant.

    remedy  to be written instead, of the number that was written; another unit alone where it is smaller
    unit    the SI unit
    """

    most: float
    beyond: float
    remedy: str
    unit: str = "1"


SIZE = Typical(FARTHEST, 2e4, '"{number:.6g} mm"', "m")
TURNS = Typical(4.0 * pi, 3600.0, '"{number:.6g} deg"', "rad")
SPEED = Typical(1000.0, 1e5, '"{number:.6g} rpm"', "rad/s")
MASS = Typical(1e5, 1e8, '"{number:.6g} g"', "kg")
GRAVITY = Typical(100.0, 1e5, '"{earth:.2f} m/s^2"', "m/s^2")
_BY_UNIT = {kind.unit: kind for kind in (TURNS, SIZE, SPEED, MASS, GRAVITY)}
SHARE, MOST_PERCENT = Typical(3.0, inf, '"{number:.6g} %"'), 100.0
KINDS = {
    **{name: _BY_UNIT[unit] for name, unit in UNITS.items() if unit in _BY_UNIT},
    "Y": SIZE,
    "mu": Typical(10.0, 100.0, "{hundredth:.6g}"),
    "breakdown_slip": SHARE,
}
