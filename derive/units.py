"""Units of quantities and of their derivatives, as exponents of m, s and rad."""

from typing import NamedTuple


class Unit(NamedTuple):
    """Exponents; `Unit(1, -2)` is m/s^2."""

    m: int = 0
    s: int = 0
    rad: int = 0

    def over(self, *parameters: str) -> "Unit":
        """The unit of a derivative by these parameters."""
        unit = self
        for parameter in parameters:
            unit = Unit(*(a - b for a, b in zip(unit, PARAMETER_UNITS[parameter], strict=True)))
        return unit


NONE = Unit()
ANGLE = Unit(rad=1)
LENGTH = Unit(m=1)
SPEED = Unit(1, -1)
ACCELERATION = Unit(1, -2)
JERK = Unit(1, -3)
ANGULAR_SPEED = Unit(0, -1, 1)
ANGULAR_ACCELERATION = Unit(0, -2, 1)

PARAMETER_UNITS = {
    "theta": ANGLE,
    "ec": LENGTH,
    "AB": LENGTH,
    "BC": LENGTH,
    "omega0": ANGULAR_SPEED,
    "alpha": ANGULAR_ACCELERATION,
}


def unit_text(unit: Unit) -> str:
    """As pint and UDUNITS both read it: `m/s^2/rad`, `1`."""
    above = [_power(name, power) for name, power in unit._asdict().items() if power > 0]
    below = [_power(name, -power) for name, power in unit._asdict().items() if power < 0]
    return "/".join(["*".join(above) or "1", *below])


def _power(name: str, power: int) -> str:
    return name if power == 1 else f"{name}^{power}"
