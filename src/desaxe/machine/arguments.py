"""Arguments of a method: plain numbers in the machine's units, converted to SI."""

from collections.abc import Mapping
from typing import Any

from ..evaluation.reductions.argument import at_with_units
from ..loads.arguments import ARGUMENTS, arguments_of
from ..loads.load import Load
from ..loads.resolve import settled
from ..loads.units import function_in_si, slopes_in_si
from ..mechanism import read
from ..mechanism.catalogue import of_design
from ..mechanism.inputs import UNITS, Input
from ..mechanism.quantity_units import UnitSystem, si_unit
from ..support.forks import IMPORTS
from ..units.text import PLUS_MINUS, with_unit_of

# Arguments that carry no unit of their own name: what they are about is said by their keys.
EQUATION = "=="  # of a limit of `keep`
BY_KEY = ("over", "keep", "where", "changes", "sigma", "nuisance")
VALUES = {"Y", "s", "V_C", "a_C", "V_outward", "V_inward"}  # by which an answer is asked for


def has_unit(name: str) -> bool:
    """True where an argument of this name, or of one slider of several, is a quantity with a unit."""
    if name.endswith("]"):
        name = name.partition("[")[0]
    return name in UNITS or name in VALUES or of_design(name)


def in_si(system: UnitSystem, name: str, value: Any) -> Any:
    """An argument in SI units; texts and pint quantities carry their units."""
    if not system or value is None:
        return value
    if name == "data":
        with IMPORTS:
            from ..design.fit.data import columns_of

        columns = columns_of(value, system).items()
        return {head: part if head.unit else _converted(system, head.name, part) for head, part in columns}
    if name == "derivative" and callable(value):
        return slopes_in_si(value, arguments_of(name, value, ARGUMENTS), system)
    value = at_with_units(value, system)
    if name in BY_KEY and isinstance(value, Mapping):
        return {key: _converted(system, _quantity_of(key), part) for key, part in value.items()}
    return _converted(system, name, value) if has_unit(name) else value


def in_unit_of(name: str, value: Any, system: UnitSystem) -> Any:
    """A value of a quantity in SI units."""
    return _converted(system, name, value) if system else value


def _quantity_of(measure: Any) -> str:
    """The name whose unit the limits of a measure are in: of a peak or a bias, the quantity."""
    name = str(measure[-1] if isinstance(measure, (tuple, list)) else measure)
    return name.removesuffix("_bias").removesuffix("_offset")


def _converted(system: UnitSystem, name: str, value: Any) -> Any:
    """A number, array or pair of a named quantity in SI units; of a text that is no number with its unit."""
    conversion = system.find(name)
    if value is None or conversion is None:
        return value
    if isinstance(value, str) and value == EQUATION:
        return value
    if isinstance(value, str):
        first, *tolerance = PLUS_MINUS.split(value)
        return " +- ".join([str(with_unit_of(f"1 {conversion.unit}", first)), *tolerance])
    if isinstance(value, (tuple, list)):
        parts = [_converted(system, name, part) for part in value]
        return type(value)(*parts) if hasattr(value, "_fields") else type(value)(parts)
    if callable(value) and not (isinstance(value, Load) or hasattr(value, "call")):  # a motor has one
        return function_in_si(name, value, arguments_of(name, value, ARGUMENTS), system)
    if callable(value):
        return settled(name, value, system)
    if hasattr(value, "ppf"):
        with IMPORTS:
            from ..design.tolerance.uncertain import DistributionInSI

        return DistributionInSI(value, conversion)
    return read.in_si(Input(name, si_unit(name), ""), value, system)
