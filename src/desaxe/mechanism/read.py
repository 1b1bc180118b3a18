"""One reader of numbers: plain, as text with a unit, as a pint quantity or a NumPy scalar.

A row says name, unit and limit: one of `INPUTS`, or a row of the caller's own for what is no input.
"""

from math import inf
from typing import Any

from ..support.forks import IMPORTS
from ..support.shown import shown
from .inputs import INPUTS, Input
from .spoken import named


def number_of(row: Input, value: Any) -> float | None:
    """The number in the row's unit; None for an array or anything else, ValueError beyond its limit."""
    if isinstance(value, str) or hasattr(value, "magnitude"):
        with IMPORTS:
            from ..units.parse import in_unit

        value = in_unit(row.name, value, row.unit)
    if isinstance(value, bool) or not (isinstance(value, (int, float)) or is_numpy_number(value)):
        return None
    try:
        number = float(value)
    except OverflowError:
        raise ValueError(f"{row.name} = {shown(value)}: it must be {row.limit}, at most 1.8e308") from None
    if not (-inf < number < inf and (row.least is None or row.least <= number)):
        raise ValueError(f"{named(row.name, value)}: it must be {row.limit}")
    return number


def read(row: Input, value: Any, caller: str, expected: str = "a number") -> float:
    """The number in the row's unit; TypeError that says what the caller expects for anything else."""
    number = number_of(row, value)
    if value is None:
        raise TypeError(f"{row.name} is missing: {caller} expects {expected}")
    if number is None:
        raise TypeError(f"{named(row.name, value)}: {caller} expects {expected}")
    return number


def is_numpy_number(value: Any) -> bool:
    """True for a NumPy real scalar such as np.float32(1); not for a 0-d array or a time span."""
    kind = getattr(getattr(value, "dtype", None), "kind", "")
    return getattr(value, "shape", None) == () and hasattr(value, "is_integer") and kind in "fiu"


def in_si(name: str, value: Any) -> Any:
    """The magnitude of a text or pint quantity in the SI unit of an input; errors name both."""
    with IMPORTS:
        from ..units.parse import in_unit

    return in_unit(name, value, INPUTS[name].unit)


def unlabelled(name: str, array: Any, si: str) -> Any:
    """The values of a labelled array in an SI unit, from the unit of its attribute `units`."""
    unit = str(array.attrs.get("units", si))
    if unit == si or hasattr(array.data, "magnitude"):
        return array.data
    with IMPORTS:
        from ..units.system import conversion

    return conversion(name, unit, si).to_si(array.values)
