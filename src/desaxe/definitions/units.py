"""Constants of an expression: numbers, or texts such as "1 mm", as SI numbers."""

from fractions import Fraction
from math import isfinite
from typing import Any

from ..support.forks import IMPORTS
from ..support.shown import shown
from ..units.dimensions import NONE, Unit
from ..units.parse import exact_quantity

LONGEST = 100  # characters of a text


def constant_value(name: str, value: Any) -> tuple[float, Unit]:
    """A constant in SI units, and its unit; ValueError or TypeError that names it."""
    if isinstance(value, str):
        if len(value) > LONGEST:
            raise ValueError(f"constant {name}: {len(value)} characters are no number with a unit")
        exact, unit = exact_quantity(f"constant {name} = {value!r}", value)
        number = _as_float(exact)
    elif hasattr(value, "magnitude") and hasattr(value, "to_root_units"):
        with IMPORTS:
            from ..units.pint_units import size_of

        size, unit = size_of(value.units)
        number = float(value.magnitude) * float(size)
    elif isinstance(value, bool) or not _is_number(value):
        raise TypeError(f"constant {name} = {shown(value)}: expected a number or a text such as '1 mm'")
    else:
        number, unit = _as_float(value), NONE
    if not isfinite(number):
        raise ValueError(f"constant {name} = {shown(value)}: it must be finite")
    return number, unit


def _is_number(value: Any) -> bool:
    """True for Python's and NumPy's real numbers; a time span is none."""
    kind = getattr(getattr(value, "dtype", None), "kind", "f")
    return isinstance(value, (int, float)) or (hasattr(value, "is_integer") and kind in "fiu")


def _as_float(value: float | Fraction) -> float:
    try:
        return float(value)
    except OverflowError:
        return float("inf")
