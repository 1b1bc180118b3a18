"""Names of units that the table does not have, and pint's quantities (extra `units`)."""

from fractions import Fraction
from functools import cache
from typing import Any

from ..support.extras import explained
from ..support.forks import imported
from .dimensions import NONE, Unit
from .table import ScaledUnit

_BASES = {"meter": Unit(m=1), "second": Unit(s=1), "radian": Unit(rad=1), "kilogram": Unit(kg=1)}
_BASES["gram"] = _BASES["kilogram"]


@cache
def registry(number: type = float) -> Any:
    """The registry of units of the quantities that answers are made of; `number`: the type of its factors."""
    with explained("a quantity with a unit"):
        units: Any = imported("pint").UnitRegistry(non_int_type=number)
    units.define("@alias revolution = rev")
    units.define("@alias revolutions_per_minute = RPM")
    return units


def unit_of_pint(name: str) -> ScaledUnit:
    """The unit that pint knows by a name; ValueError where it knows none, or one of no mechanism."""
    with explained(f"the unit {name!r}"):
        imported("pint")
    try:
        size = registry(Fraction).Quantity(Fraction(1), name).to_root_units()
        magnitude = Fraction(size.magnitude)
    except Exception:  # of pint: an unknown name, a logarithm
        raise ValueError("unknown unit") from None
    return _scaled(magnitude, size.units)


def size_of(units: Any) -> ScaledUnit:
    """The size of the unit of a pint quantity, of any registry."""
    size = (1 * units).to_root_units()
    return _scaled(Fraction(float(size.magnitude)), size.units)


def _scaled(size: Fraction, units: Any) -> ScaledUnit:
    si = NONE
    for base, power in dict(units._units).items():
        if base not in _BASES or power != int(power):
            raise ValueError("expected a unit of m, s, kg and rad")
        si = si.times(_BASES[base], int(power))
        size *= Fraction(1, 1000) ** int(power) if base == "gram" else 1
    return ScaledUnit(size, si)
