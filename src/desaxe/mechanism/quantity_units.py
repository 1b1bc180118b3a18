"""Units of inputs, quantities, measures and their derivatives, in SI and in any system of units.

    UnitSystem.read("mm, deg, rpm")
    UnitSystem.read({"length": "mm", "torque": "kN m", "a_C": "standard_gravity"})

A dimension that is not named stays in SI units and radians. Velocities, accelerations and jerks follow the
length that is named, per second; a quantity may have a unit of its own. A sensitivity is a quotient of units.
"""

import re
from collections.abc import Iterable, Mapping
from typing import Any

from ..support.computed import computed_once
from ..units.system import DIMENSIONS, Conversion, conversions_by_unit, read_units, size_in
from .catalogue import quantity
from .inputs import UNITS
from .names import parts
from .own import register

PLAIN = Conversion("1")
# Numbers of a load on the slider: one is the load's unit by those of these quantities; a position is no load.
OF_LOADS = {"stiffness": ("Y",), "linear": ("V_C",), "quadratic": ("V_C", "V_C"), "free": None}
_OF_A_LOAD = re.compile(rf"(F_[XY])\.({'|'.join(OF_LOADS)})(_\d+)?")  # stiffness_2 is of a second spring


class UnitSystem:
    """Units by dimension and by quantity; all others are SI.

    Sensitivities are quotients of them, or in SI units too where `quotients` is False.
    """

    def __init__(self, units: Mapping[str, str], quotients: bool = True) -> None:
        self.units = dict(units)
        self.quotients = quotients
        self.remembered: dict[tuple[str, str], Conversion | None] = {}  # by name and parameter

    @classmethod
    def read(cls, units: "str | Mapping[str, str] | UnitSystem | None") -> "UnitSystem":
        """Read a unit system from a text such as "mm, deg, rpm" or a mapping; ValueError for any other."""
        return units if isinstance(units, UnitSystem) else cls(read_units(units, si_unit))

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
        return self._by_unit.get(si) or Conversion(si)

    def of(self, name: str) -> Conversion:
        """The conversion of a quantity, sensitivity, input or measure of a design."""
        if name in self._by_name:
            return self._by_name[name]
        of_load = _OF_A_LOAD.fullmatch(name)
        if of_load:
            per = OF_LOADS[of_load[2]]
            return self.of("Y") if per is None else self.of(of_load[1]).per([*map(self.of, per)])
        base, by = parts(name)
        if by and not self.quotients:
            return Conversion(si_unit(name))
        if by:
            result = self.of(base).per([self.of(parameter) for parameter in by])
            return Conversion(_simplified(name, result.unit)) if result.si == 1 else result
        return self.of_unit(si_unit(name))

    def find(self, name: str, by: str = "") -> Conversion | None:
        """The conversion of a name, or of its derivative; None where it has no unit."""
        known = {} if register().rows else self.remembered
        if (name, by) not in known:
            known[name, by] = self._look_up(name, by)
        return known[name, by]

    def _look_up(self, name: str, by: str) -> Conversion | None:
        if by:
            own, per = self.find(name) or PLAIN, self.find(by)
            return own.per([per]) if per else own
        try:
            return self.of(name) if name else None
        except ValueError:
            return None

    @computed_once
    def _by_name(self) -> dict[str, Conversion]:
        """The conversions of quantities with units of their own."""
        return {
            name: Conversion(unit, size_in(name, unit, si_unit(name)))
            for name, unit in self.units.items()
            if name not in DIMENSIONS
        }

    @computed_once
    def _by_unit(self) -> dict[str, Conversion]:
        return conversions_by_unit(self.units)


SI = UnitSystem({})


def si_unit(name: str) -> str:
    """The SI unit of a quantity, input or measure, also of one slider of several; ValueError for another."""
    if _OF_A_LOAD.fullmatch(name):
        return SI.of(name).unit
    if name.endswith("]"):
        name = name.partition("[")[0]
    if name in UNITS:
        return UNITS[name]
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
        return si_unit(name)
    except ValueError:
        return quotient


class QuantityUnit(str):
    """The SI unit of a quantity, an input or a measure, or of its derivative with respect to another one."""

    name: str = ""
    by: str = ""


def unit_of(name: Any, by: Any = "") -> QuantityUnit:
    """The unit of a name, or of a measure such as ("absmax", "a_C"); "1" where there is none."""
    last = [part[-1] if isinstance(part, (tuple, list)) else part for part in (name, by)]
    name, by = (part if isinstance(part, str) else "" for part in last)
    unit = QuantityUnit((SI.find(name, by) or PLAIN).unit)
    unit.name, unit.by = name, by
    return unit


def units_of(names: Iterable[str]) -> dict[str, QuantityUnit]:
    """The units of answers whose keys are the names of what they are."""
    return {name: unit_of(name) for name in names}


def units_by_name(result: Mapping[Any, Any]) -> dict[Any, Any]:
    """The units of an answer whose keys are the names of what they are, those of `gradient` too."""
    names = (key for key in result if isinstance(key, str) and key != "status" and SI.find(key))
    units: dict[Any, Any] = units_of(names)
    if "gradient" in result:
        units["gradient"] = {name: slopes_of(name, slopes) for name, slopes in result["gradient"].items()}
    return units


def units_of_extreme(name: str, result: Mapping[Any, Any]) -> dict[str, Any]:
    """The units of an extreme value of a quantity, where it is reached, and its gradient."""
    return {
        "value": unit_of(name),
        "theta": unit_of("theta"),
        "gradient": slopes_of(name, result["gradient"]),
    }


def slopes_of(name: Any, parameters: Iterable[Any]) -> dict[Any, QuantityUnit]:
    """The units of the derivatives of a quantity by some parameters."""
    return {parameter: unit_of(name, parameter) for parameter in parameters}


def conversion_of(unit: str, system: UnitSystem) -> Conversion:
    """The conversion of numbers in this SI unit; that of the quantity itself where the unit knows it."""
    if not isinstance(unit, QuantityUnit):
        return system.of_unit(unit)
    return system.find(unit.name, unit.by) or PLAIN
