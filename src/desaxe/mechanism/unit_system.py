"""Unit systems: the units of plain numbers in inputs and results.

    UnitSystem.read("mm, deg, rpm")
    UnitSystem.read({"length": "mm", "torque": "kN m", "a_C": "standard_gravity"})

A dimension that is not named stays in SI units and radians. Velocities, accelerations and jerks follow the
length that is named, per second; a quantity may have a unit of its own. A sensitivity is a quotient of units.
"""

import re
from collections.abc import Iterable, Mapping
from decimal import Decimal, localcontext
from fractions import Fraction
from math import isfinite
from typing import Any, NamedTuple

from ..support.computed import computed_once
from ..support.forks import IMPORTS
from ..support.quantity_text import quotient, spelled
from ..support.shown import shown
from .catalogue import quantity
from .inputs import INPUTS
from .names import parts
from .units import did_you_mean_unit, exact

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
}
MOST = 100  # units of one text or table
PER_SECOND = {"m/s": "/s", "m/s^2": "/s^2", "m/s^3": "/s^3"}
# Units of inputs and results that are no quantities of the catalogue.
OTHERS = {
    **dict.fromkeys(("V_outward", "V_inward"), "m/s"),
    **dict.fromkeys(("theta0", "until", "phase", "angle", "theta_intervals"), "rad"),
    **dict.fromkeys(("omega_start", "omega_mean", "synchronous_speed"), "rad/s"),
    **dict.fromkeys(("t", "t_end", "t_last", "times", "max_step", "period"), "s"),
    **dict.fromkeys(
        (
            "torque", "torque_mean", "torque_rms", "torque_peak", "starting_torque", "flywheel_torque",
            "T_motor", "breakdown_torque", "mean_torque", "max_torque", "min_torque", "ripple",
        ),
        "N*m",
    ),
    **dict.fromkeys(("work", "work_in", "work_out", "energy_fluctuation"), "J"),
    **dict.fromkeys(("power_mean", "power_peak"), "W"),
    **dict.fromkeys(("inertia", "inertia_first_order", "flywheel_inertia"), "kg*m^2"),
    **dict.fromkeys(("breakdown_slip", "gear"), "1"),
    "radius": "m",
    "mass": "kg",
    "product": "kg*m",
    "peak_a_C": "m/s^2",
}  # fmt: skip


class Conversion(NamedTuple):
    """A displayed unit, and its exact factor to the SI unit."""

    unit: str
    si: Fraction = Fraction(1)

    def shown(self, value: Any) -> Any:
        """A number or array in SI units, in the unit shown."""
        return value if self.si == 1 else _scaled(value, self.si.denominator, self.si.numerator)

    def to_si(self, value: Any) -> Any:
        """A number or array in the unit shown, in SI units: the double nearest to it."""
        return value if self.si == 1 else _scaled(value, self.si.numerator, self.si.denominator)

    def per(self, others: "list[Conversion]") -> "Conversion":
        """The conversion of a derivative."""
        si = self.si
        for other in others:
            si /= other.si
        return Conversion(quotient(self.unit, [other.unit for other in others]), si)


class UnitSystem:
    """Units by dimension and by quantity; all others are SI.

    Sensitivities are quotients of them, or in SI units too where `quotients` is False.
    """

    def __init__(self, units: Mapping[str, str], quotients: bool = True) -> None:
        self.units = dict(units)
        self.quotients = quotients
        self.remembered: dict[tuple[str, str], Conversion] = {}  # by name and parameter

    @classmethod
    def read(cls, units: "str | Mapping[str, str] | UnitSystem | None") -> "UnitSystem":
        """Read a unit system from a text such as "mm, deg, rpm" or a mapping; ValueError for any other."""
        if isinstance(units, UnitSystem):
            return units
        if units is None or isinstance(units, str):
            named = [unit.strip() for unit in (units or "").split(",") if unit.strip()]
            if len(named) > MOST:
                raise ValueError(f"units: {len(named)} units are too many, at most {MOST}")
            rows = [(_dimension_of(unit), unit) for unit in named]
        elif isinstance(units, Mapping):
            rows = [(_key(name), unit) for name, unit in units.items()]
        else:
            raise TypeError(f'units = {shown(units)}: expected a text such as "mm, deg, rpm" or a mapping')
        found: dict[str, str] = {}
        for name, unit in rows:
            if name in found:
                raise ValueError(f"units: two units of {name}, {found[name]!r} and {unit!r}")
            if not isinstance(unit, str):
                raise TypeError(f"units: {name} = {unit!r}, expected a text such as 'mm'")
            found[name] = spelled(unit.strip())
            _si_of(name, found[name], DIMENSIONS.get(name) or _si_unit(name))
        return cls(found)

    def __bool__(self) -> bool:
        return bool(self.units)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, UnitSystem) and self.units == other.units

    def __hash__(self) -> int:
        return hash(frozenset(self.units.items()))

    def __repr__(self) -> str:
        if all(name in DIMENSIONS for name in self.units):
            return repr(", ".join(self.units.values()))
        return repr(self.units)

    def of_unit(self, si: str) -> Conversion:
        """The conversion of values in this SI unit."""
        return self._known.get(si) or Conversion(si)

    def of(self, name: str) -> Conversion:
        """The conversion of a quantity, sensitivity, input or measure of a design."""
        if name in self._own:
            return self._own[name]
        base, by = parts(name)
        if by and not self.quotients:
            return Conversion(_si_unit(name))
        if by:
            found = self.of(base).per([self.of(parameter) for parameter in by])
            return Conversion(_simplified(name, found.unit)) if found.si == 1 else found
        return self.of_unit(_si_unit(name))

    def find(self, name: str) -> Conversion | None:
        """The conversion of a name; None where it has no unit."""
        try:
            return self.of(name)
        except ValueError:
            return None

    def slope(self, name: str | Conversion, by: str) -> Conversion:
        """The conversion of a derivative by an input."""
        return (self.of(name) if isinstance(name, str) else name).per([self.of(by)])

    @computed_once
    def _own(self) -> dict[str, Conversion]:
        """The conversions of quantities with units of their own."""
        return {
            name: Conversion(unit, _si_of(name, unit, _si_unit(name)))
            for name, unit in self.units.items()
            if name not in DIMENSIONS
        }

    @computed_once
    def _known(self) -> dict[str, Conversion]:
        """The conversions by SI unit."""
        found = {}
        length = self.units.get("length")
        if length is not None:
            si = _si_of("length", length, "m")
            found = {unit: Conversion(f"{length}{tail}", si) for unit, tail in PER_SECOND.items()}
        for name, unit in self.units.items():
            if name in DIMENSIONS:
                found[DIMENSIONS[name]] = Conversion(unit, _si_of(name, unit, DIMENSIONS[name]))
        return found


SI = UnitSystem({})


def _key(name: Any) -> str:
    """A dimension or quantity by its name; ValueError with those there are."""
    if not isinstance(name, str):
        raise TypeError(f"units: the name of a dimension is a text, got {name!r}")
    words = name.replace("_", " ")
    if words in DIMENSIONS:
        return words
    _si_unit(name)
    return name


def _si_unit(name: str) -> str:
    """The SI unit of a quantity, input or measure."""
    if name in INPUTS:
        return INPUTS[name].unit
    if name in OTHERS:
        return OTHERS[name]
    if name.startswith("theta_"):
        return "rad"
    try:
        return quantity(name, "omega" in parts(name)[1]).unit
    except ValueError as error:
        there = ", ".join(DIMENSIONS)
        raise ValueError(
            f"units: {name!r} is neither a dimension ({there}) nor a quantity: {error}"
        ) from None


def _simplified(name: str, quotient: str) -> str:
    """The SI unit of a sensitivity, as the catalogue writes it, if no choice of units changes it."""
    try:
        return _si_unit(name)
    except ValueError:
        return quotient


def _dimension_of(unit: str) -> str:
    """The dimension of a unit; N m is a torque, J an energy."""
    fitting = []
    for name, si in DIMENSIONS.items():
        try:
            _si_of(name, unit, si)
        except ValueError as error:
            if "unknown unit" in str(error) or "it must be a number" in str(error):
                meant = _meant(unit, DIMENSIONS.values())
                raise ValueError(
                    f'units: {shown(unit)} is not a known unit; {meant}expected units such as "mm, deg, rpm"'
                ) from None
        else:
            fitting.append(name)
    meant = _meant(unit, (si for name, si in DIMENSIONS.items() if name not in fitting))
    if meant:  # kn is a knot
        raise ValueError(f"units: {shown(unit)}: {meant}".rstrip())
    if not fitting:
        apart = '; commas stand between units, as in "mm, deg, rpm"' if " " in unit.strip() else ""
        raise ValueError(f"units: {shown(unit)} is none of {', '.join(DIMENSIONS)}{apart}")
    product = re.search(r"[^\W\d_][ *.·][^\W\d_]", unit) is not None
    return fitting[-1] if len(fitting) > 1 and not product else fitting[0]


def _meant(unit: str, dimensions: Iterable[str]) -> str:
    """The question for the unit of these dimensions, by their SI units, whose letters it has; else empty."""
    return "".join(dict.fromkeys(did_you_mean_unit(unit, si) for si in dimensions))


def _si_of(name: str, unit: str, si: str) -> Fraction:
    """The exact factor from a unit to the SI unit; ValueError for another dimension."""
    if unit == si:
        return Fraction(1)
    return exact(f"units: {name}", f"1 {unit}", si)


def _scaled(value: Any, above: int, below: int) -> Any:
    """A number times above/below, rounded once; an array in extended precision where supported."""
    if isinstance(value, (int, float)):
        if not isfinite(value):
            return float(value)
        own, under = value.as_integer_ratio()
        return own * above / (under * below)
    with IMPORTS:
        import numpy as np

    wide = np.asarray(value, dtype=np.longdouble)
    if above == 1:
        scaled = wide / np.longdouble(str(below))
    else:
        with localcontext(prec=30):
            scaled = wide * np.longdouble(str(Decimal(above) / Decimal(below)))
    result = np.asarray(scaled, dtype=np.float64)
    return result if result.ndim else float(result)
