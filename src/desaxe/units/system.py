"""The units of plain numbers: "mm, deg, rpm, kN", one for each dimension."""

import re
from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any, NamedTuple

from ..support.shown import shown
from .parse import factor_to_si, is_in_table, parse_unit
from .scaling import by_digits, scaled
from .table import did_you_mean_unit
from .text import quotient, spelled

DIMENSIONS = {
    "length": "m",
    "angle": "rad",
    "time": "s",
    "mass": "kg",
    "velocity": "m/s",
    "acceleration": "m/s^2",
    "jerk": "m/s^3",
    "angular speed": "rad/s",
    "angular acceleration": "rad/s^2",
    "force": "N",
    "torque": "N*m",
    "energy": "J",
    "power": "W",
    "inertia": "kg*m^2",
    "pressure": "Pa",
}
MOST = 100  # units of one text or table
_PER_SECOND = {"m/s": "/s", "m/s^2": "/s^2", "m/s^3": "/s^3"}


class Conversion(NamedTuple):
    """A displayed unit, and its exact factor to the SI unit."""

    unit: str
    si: Fraction = Fraction(1)

    def shown(self, value: Any) -> Any:
        """A number or array in SI units, in the unit shown."""
        return value if self.si == 1 else scaled(value, 1 / self.si)

    def to_si(self, value: Any) -> Any:
        """A number or array in the unit shown, in SI units: the double nearest to its digits."""
        return value if self.si == 1 else by_digits(value, self.si)

    def per(self, others: "list[Conversion]") -> "Conversion":
        """The conversion of a derivative."""
        si = self.si
        for other in others:
            si /= other.si
        return Conversion(quotient(self.unit, [other.unit for other in others]), si)


def conversion(name: str, unit: str, si: str) -> Conversion:
    """The conversion of numbers in a unit; ValueError that names the unit where it is none of this kind."""
    return Conversion(unit, factor_to_si(f"{name} in {shown(unit)}", unit, si))


def read_units(units: Any, si_unit: Callable[[str], str]) -> dict[str, str]:
    """Unit by dimension or quantity, of a text such as "mm, deg, rpm" or a mapping; ValueError for any other.

    si_unit  the SI unit of a quantity, an input or a measure; ValueError for any other name
    """
    if units is None or isinstance(units, str):
        named = [unit.strip() for unit in (units or "").split(",") if unit.strip()]
        if len(named) > MOST:
            raise ValueError(f"units: {len(named)} units are too many, at most {MOST}")
        rows = [(_dimension_of(unit), unit) for unit in named]
    elif isinstance(units, Mapping):
        rows = [(_key(name, si_unit), unit) for name, unit in units.items()]
    else:
        raise TypeError(f'units = {shown(units)}: expected a text such as "mm, deg, rpm" or a mapping')
    result: dict[str, str] = {}
    for name, unit in rows:
        if name in result:
            raise ValueError(f"units: two units of {name}, {result[name]!r} and {unit!r}")
        if not isinstance(unit, str):
            raise TypeError(f"units: {name} = {unit!r}, expected a text such as 'mm'")
        result[name] = spelled(unit.strip())
        size_in(name, result[name], DIMENSIONS.get(name) or si_unit(name))
    return result


def conversions_by_unit(units: Mapping[str, str]) -> dict[str, Conversion]:
    """The conversions by SI unit; velocities and accelerations follow the length, per second."""
    result = {}
    length = units.get("length")
    if length is not None:
        si = size_in("length", length, "m")
        result = {unit: Conversion(f"{length}{tail}", si) for unit, tail in _PER_SECOND.items()}
    for name, unit in units.items():
        if name in DIMENSIONS:
            result[DIMENSIONS[name]] = Conversion(unit, size_in(name, unit, DIMENSIONS[name]))
    return result


def size_in(name: str, unit: str, si: str) -> Fraction:
    """The exact factor from the unit of a system to the SI unit; ValueError for another dimension."""
    return factor_to_si(f"units: {name} = {shown(f'1 {unit}')}", unit, si)


def _key(name: Any, si_unit: Callable[[str], str]) -> str:
    """A dimension or quantity by its name; ValueError with those there are."""
    if not isinstance(name, str):
        raise TypeError(f"units: the name of a dimension is a text, got {name!r}")
    words = name.replace("_", " ")
    if words in DIMENSIONS:
        return words
    si_unit(name)
    return name


def _dimension_of(unit: str) -> str:
    """The dimension of a unit; N m is a torque, J an energy."""
    meant = "".join(dict.fromkeys(did_you_mean_unit(unit, si) for si in DIMENSIONS.values()))
    try:
        si = parse_unit(unit).si if not meant or is_in_table(unit) else None
    except ValueError:
        si = None
    if si is None:  # kn, which is a knot, too
        raise ValueError(
            f'units: {shown(unit)} is not a known unit; {meant}expected units such as "mm, deg, rpm"'
        )
    fitting = [name for name, coherent in DIMENSIONS.items() if parse_unit(coherent).si == si]
    if not fitting:
        apart = '; commas stand between units, as in "mm, deg, rpm"' if " " in unit.strip() else ""
        raise ValueError(f"units: {shown(unit)} is none of {', '.join(DIMENSIONS)}{apart}")
    product = re.search(r"[^\W\d_][ *.·][^\W\d_]", unit) is not None
    return fitting[-1] if len(fitting) > 1 and not product else fitting[0]
