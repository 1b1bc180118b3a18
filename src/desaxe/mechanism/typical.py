"""Sizes of inputs, beyond which a number is almost surely a slip of a unit, and the remedies."""

from math import pi
from typing import NamedTuple

SIZES = ("ec", "AB", "BC", "r_crank", "r_rod")
FORCES = ("F_X", "F_Y")
MASSES = ("m_crank", "m_rod", "m_slider")
SPEEDS = ("omega0", "omega", "synchronous_speed")
FARTHEST = 20.0  # m: no size of a mechanism is larger


class Typical(NamedTuple):
    """A kind of input: above `most` it is a slip, unless it is above `beyond` as well: then it is meant.

    remedy  to be written instead, of the number that was written
    """

    most: float
    beyond: float
    remedy: str


SIZE = Typical(FARTHEST, 2e4, '"{number:.6g} mm"')
TURNS = Typical(4.0 * pi, 3600.0, '"{number:.6g} deg"')
SPEED = Typical(1000.0, 1e5, '"{number:.6g} rpm"')
MASS = Typical(1e5, 1e8, '"{number:.6g} g"')
GRAVITY = Typical(100.0, 1e5, '"{earth:.2f} m/s^2"')
KINDS = {
    "theta": TURNS,
    **dict.fromkeys(SIZES, SIZE),
    **dict.fromkeys(SPEEDS, SPEED),
    **dict.fromkeys(MASSES, MASS),
    **dict.fromkeys(("g_X", "g_Y"), GRAVITY),
    "mu": Typical(10.0, 100.0, "{hundredth:.6g}"),
    "breakdown_slip": Typical(3.0, 100.0, '"{number:.6g} %"'),
}
