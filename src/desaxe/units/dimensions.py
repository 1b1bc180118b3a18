"""Units as exponents of m, s, rad and kg."""

from collections.abc import Mapping
from fractions import Fraction
from typing import NamedTuple

Power = int | Fraction


class Unit(NamedTuple):
    """A coherent SI unit as exponents: `Unit(1, -2)` is m/s^2; `name` is its special name, such as W."""

    m: Power = 0
    s: Power = 0
    rad: Power = 0
    kg: Power = 0
    name: str = ""

    def times(self, other: "Unit", power: Power = 1) -> "Unit":
        """The product with a power of another unit."""
        m, s, rad, kg = (a + power * b for a, b in zip(self[:4], other[:4], strict=True))
        return Unit(m, s, rad, kg)


NONE = Unit()
ANGLE, LENGTH, TIME = Unit(rad=1), Unit(m=1), Unit(s=1)
SPEED, ACCELERATION, JERK = Unit(1, -1), Unit(1, -2), Unit(1, -3)
ANGULAR_SPEED, ANGULAR_ACCELERATION = Unit(0, -1, 1), Unit(0, -2, 1)
PER_TIME, PER_TIME2 = Unit(s=-1), Unit(s=-2)
MASS = Unit(kg=1)
MASS_MOMENT = Unit(1, kg=1)
INERTIA = Unit(2, kg=1)
FORCE, TORQUE = Unit(1, -2, kg=1), Unit(2, -2, kg=1)
ENERGY = Unit(2, -2, kg=1, name="J")
POWER = Unit(2, -3, kg=1, name="W")
PRESSURE = Unit(-1, -2, kg=1, name="Pa")


def unit_text(unit: Unit) -> str:
    """A unit as text for pint and UDUNITS: `m/s^2/rad`, `N*m`, `1`."""
    powers: dict[str, Power] = {"N": 0, "kg": unit.kg, "m": unit.m, "s": unit.s, "rad": unit.rad}
    if powers["kg"] == 1 and powers["s"] <= -2:  # a force is in it
        powers.update(N=1, kg=0, m=powers["m"] - 1, s=powers["s"] + 2)
    return unit.name or product(powers)


def product(powers: Mapping[str, Power]) -> str:
    """The text of powers of names: `N*m/rad`, `1/s^2`."""
    above = [_power(name, power) for name, power in powers.items() if power > 0]
    below = [_power(name, -power) for name, power in powers.items() if power < 0]
    return "/".join(["*".join(above) or "1", *below])


def _power(name: str, power: Power) -> str:
    exponent = f"{power}" if power.denominator == 1 else f"({power})"
    return name if power == 1 else f"{name}^{exponent}"
