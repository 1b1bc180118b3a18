"""Arguments of a method: plain numbers in the machine's units, converted to SI."""

from collections.abc import Mapping
from os import PathLike
from typing import Any

from ..loads.resolve import settled
from ..mechanism.inputs import INPUTS
from ..mechanism.names import WHOLE
from ..mechanism.quantity_units import OTHERS, UnitSystem
from ..support.forks import IMPORTS
from ..units.text import PLUS_MINUS, with_unit_of

# Arguments that carry no unit of their own name: what they are about is said by their keys.
BY_KEY = ("over", "keep", "changes", "sigma", "data")
POSITIONS = {"Y", "V_C", "a_C"}


def has_unit(name: str) -> bool:
    """True where an argument of this name is a quantity with a unit."""
    return name in INPUTS or name in OTHERS or name in POSITIONS or name in WHOLE


def in_si(system: UnitSystem, name: str, value: Any) -> Any:
    """An argument in SI units; texts and pint quantities carry their units, functions are in SI."""
    if not system or value is None:
        return value
    if name == "data" and not isinstance(value, (str, PathLike)):
        with IMPORTS:
            from ..design.fit.data import columns_of

        value = columns_of(value)
    if name in BY_KEY and isinstance(value, Mapping):
        return {key: converted(system, _measure(key), part) for key, part in value.items()}
    if not has_unit(name):
        return value
    return converted(system, name, value)


def _measure(key: Any) -> str:
    """The name whose unit the limits of a measure are in: of a peak, the quantity."""
    return str(key[-1]) if isinstance(key, (tuple, list)) else str(key)


def converted(system: UnitSystem, name: str, value: Any) -> Any:
    """A number, array or pair of a named quantity in SI units."""
    if value is None or isinstance(value, bool) or hasattr(value, "magnitude"):
        return value
    if isinstance(value, str):
        return _with_unit(system, name, value)
    if isinstance(value, (tuple, list)):
        parts = [converted(system, name, part) for part in value]
        return type(value)(*parts) if hasattr(value, "_fields") else type(value)(parts)
    if getattr(getattr(value, "dtype", None), "kind", "") in "OUT" and hasattr(value, "tolist"):
        # a Series keeps its index: of texts it is refused by its reader, which names the input
        return value if hasattr(value, "iloc") else converted(system, name, value.tolist())
    if callable(value):
        return settled(name, value, system)
    if hasattr(value, "ppf"):
        with IMPORTS:
            from ..design.tolerance.uncertain import DistributionInSI

        return DistributionInSI(value, system.of(name))
    if "units" in getattr(value, "attrs", {}):
        return value
    plain = isinstance(value, (int, float)) or hasattr(value, "dtype")
    conversion = system.find(name) if plain else None
    if conversion is not None and hasattr(value, "dims"):
        with IMPORTS:
            import xarray

        return xarray.apply_ufunc(conversion.to_si, value, dask="parallelized", output_dtypes=[float])
    if conversion is not None and hasattr(value, "iloc"):  # a pandas Series keeps its index
        return type(value)(conversion.to_si(value.to_numpy()), index=value.index, name=value.name)
    return value if conversion is None else conversion.to_si(value)


def _with_unit(system: UnitSystem, name: str, text: str) -> str:
    """A text, of which a number without a unit is in the machine's, as if it were no text."""
    conversion = system.find(name)
    if conversion is None:
        return text
    value, *tolerance = PLUS_MINUS.split(text)
    return " +- ".join([str(with_unit_of(f"1 {conversion.unit}", value)), *tolerance])
