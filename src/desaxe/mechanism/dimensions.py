"""Units of quantities and of their derivatives, as exponents of m, s, rad and kg."""

import re
from functools import cache
from typing import NamedTuple

from .inputs import INPUTS


class Unit(NamedTuple):
    """A unit as exponents: `Unit(1, -2)` is m/s^2; `name` is its own name, such as W."""

    m: int = 0
    s: int = 0
    rad: int = 0
    kg: int = 0
    name: str = ""

    @property
    def exponents(self) -> dict[str, int]:
        """The exponents that are not 0, by base unit."""
        return {base: power for base, power in self._asdict().items() if base != "name" and power}

    def over(self, *parameters: str) -> "Unit":
        """The unit of a derivative by these parameters."""
        powers = self[:4]
        for parameter in parameters:
            m, s, rad, kg = (a - b for a, b in zip(powers, PARAMETER_UNITS[parameter][:4], strict=True))
            powers = m, s, rad, kg
        return Unit(*powers) if parameters else self


NONE = Unit()
ANGLE = Unit(rad=1)
LENGTH = Unit(m=1)
SPEED = Unit(1, -1)
ACCELERATION = Unit(1, -2)
JERK = Unit(1, -3)
ANGULAR_SPEED = Unit(0, -1, 1)
ANGULAR_ACCELERATION = Unit(0, -2, 1)
PER_TIME2 = Unit(s=-2)
MASS = Unit(kg=1)
MASS_MOMENT = Unit(1, kg=1)
INERTIA = Unit(2, kg=1)
FORCE = Unit(1, -2, kg=1)
TORQUE = Unit(2, -2, kg=1)
ENERGY = Unit(2, -2, kg=1, name="J")
POWER = Unit(2, -3, kg=1, name="W")


def unit_text(unit: Unit) -> str:
    """A unit as text for pint and UDUNITS: `m/s^2/rad`, `N*m`, `1`."""
    powers = {"N": 0, "kg": 0, "m": 0, "s": 0, "rad": 0, **unit.exponents}
    if powers["kg"] == 1 and powers["s"] <= -2:  # a force is in it
        powers.update(N=1, kg=0, m=powers["m"] - 1, s=powers["s"] + 2)
    above = [_power(name, power) for name, power in powers.items() if power > 0]
    below = [_power(name, -power) for name, power in powers.items() if power < 0]
    return unit.name or "/".join(["*".join(above) or "1", *below])


def _power(name: str, power: int) -> str:
    return name if power == 1 else f"{name}^{power}"


_COHERENT = {
    "1": NONE, "m": LENGTH, "s": Unit(s=1), "rad": ANGLE, "kg": MASS, "N": FORCE, "J": ENERGY, "W": POWER,
    "Pa": Unit(-1, -2, kg=1, name="Pa"), "Hz": Unit(s=-1, name="Hz"),
}  # fmt: skip
_TERM = re.compile(r"([A-Za-z]+|1)(?:\^?(-?[0-9]))?")


@cache
def unit_of(text: str) -> Unit:
    """The unit of a text such as `m/s^2`, `N m` or `W`: SI without prefixes; ValueError for any other."""
    m, s, rad, kg = 0, 0, 0, 0
    for place, part in enumerate(re.sub(r"\*\*", "^", text.strip()).split("/")):
        for term in re.split(r"[*\s]+", part.strip()):
            match = _TERM.fullmatch(term)
            if match is None or match[1] not in _COHERENT:
                raise ValueError(
                    f"unit {text!r}: expected a product of {', '.join(_COHERENT)}, such as 'N*m'"
                )
            power = int(match[2] or 1) * (-1 if place else 1)
            unit = _COHERENT[match[1]]
            m, s, rad, kg = (
                m + power * unit.m,
                s + power * unit.s,
                rad + power * unit.rad,
                kg + power * unit.kg,
            )
    return Unit(m, s, rad, kg, _COHERENT[text.strip()].name if text.strip() in _COHERENT else "")


PARAMETER_UNITS = {name: unit_of(row.unit) for name, row in INPUTS.items()}
