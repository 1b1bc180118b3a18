"""Constants of an expression: numbers, or texts such as "1 mm", as SI numbers.

A small table of units does without a unit library, so that definitions in files can be read by a plain
installation. Any other unit needs the extra `units`.
"""

from fractions import Fraction
from math import isfinite, pi
from typing import Any

from ..mechanism.dimensions import ANGLE, ENERGY, FORCE, LENGTH, MASS, NONE, POWER, Unit
from ..support.forks import IMPORTS
from ..support.quantity_text import spelled, split_quantity
from ..support.shown import shown

_PI = Fraction(pi)
_PASCAL, _SECOND = Unit(-1, -2, kg=1), Unit(s=1)
_PREFIXES = {"": 0, "u": -6, "m": -3, "c": -2, "k": 3, "M": 6, "G": 9}


def _prefixed(
    symbol: str, prefixes: str, unit: Unit, factor: Fraction | int = 1
) -> dict[str, tuple[Fraction, Unit]]:
    ten = Fraction(10)
    rows = ["", *prefixes]
    return {f"{prefix}{symbol}": (factor * ten ** _PREFIXES[prefix], unit) for prefix in rows}


_UNITS: dict[str, tuple[Fraction, Unit]] = {
    "1": (Fraction(1), NONE),
    "%": (Fraction(1, 100), NONE),
    **_prefixed("m", "umck", LENGTH),
    **_prefixed("s", "um", _SECOND),
    **_prefixed("g", "mk", MASS, Fraction(1, 1000)),
    **_prefixed("N", "mkM", FORCE),
    **_prefixed("J", "mkM", ENERGY),
    **_prefixed("W", "mkM", POWER),
    **_prefixed("Pa", "kMG", _PASCAL),
    **_prefixed("Hz", "kM", Unit(s=-1)),
    "t": (Fraction(1000), MASS),
    "bar": (Fraction(100_000), _PASCAL),
    "min": (Fraction(60), _SECOND),
    "h": (Fraction(3600), _SECOND),
    "rad": (Fraction(1), ANGLE),
    "mrad": (Fraction(1, 1000), ANGLE),
    "deg": (_PI / 180, ANGLE),
    "turn": (2 * _PI, ANGLE),
    "rpm": (2 * _PI / 60, Unit(0, -1, 1)),
}


def constant_value(name: str, value: Any) -> tuple[float, Unit]:
    """A constant in SI units, and its unit; ValueError or TypeError that names it."""
    if isinstance(value, str):
        number, unit = _from_text(name, value)
    elif hasattr(value, "magnitude") and hasattr(value, "to_root_units"):
        number, unit = _from_pint(value)
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


def _as_float(value: Any) -> float:
    try:
        return float(value)
    except OverflowError:
        return float("inf")


def _from_text(name: str, text: str) -> tuple[float, Unit]:
    if len(text) > 100:
        raise ValueError(f"constant {name}: {len(text)} characters are no number with a unit")
    try:
        number, unit = split_quantity(text)
    except ValueError as error:
        raise ValueError(f"constant {name} = {text!r}: {error}") from None
    if abs(int(("0" + number.lower().partition("e")[2].lstrip("+-0")) or 0)) > 400:
        raise ValueError(f"constant {name} = {text!r}: it must be finite")
    found = _product(spelled(unit)) if unit else (Fraction(1), NONE)
    if found is None:
        return _from_pint(_pint(name, text))
    factor, dimension = found
    return _as_float(Fraction(number) * factor), dimension


def _product(text: str) -> tuple[Fraction, Unit] | None:
    """Factor and unit of a product of units; None if one is not in the table."""
    factor, unit = Fraction(1), NONE
    for place, part in enumerate(text.split("/")):
        for term in part.replace("*", " ").split():
            symbol, _, power = term.partition("^")
            if symbol not in _UNITS:
                return None
            count = int(power or 1) * (-1 if place else 1)
            factor *= _UNITS[symbol][0] ** count
            unit = _times(unit, _UNITS[symbol][1], count)
    return factor, unit


def _times(a: Unit, b: Unit, count: int) -> Unit:
    """a b^count."""
    return Unit(a.m + count * b.m, a.s + count * b.s, a.rad + count * b.rad, a.kg + count * b.kg)


def _pint(name: str, text: str) -> Any:
    with IMPORTS:
        from ..mechanism.units import registry
        from ..support.extras import MissingExtraError, needed

    number, unit = split_quantity(text)
    try:
        with needed(f"the unit {unit!r}"):
            return registry().Quantity(float(number), spelled(unit))
    except MissingExtraError:
        raise
    except Exception:
        raise ValueError(f"constant {name} = {text!r}: unknown unit") from None


_BASES = {"meter": LENGTH, "second": _SECOND, "radian": ANGLE, "kilogram": MASS, "gram": MASS}


def _from_pint(quantity: Any) -> tuple[float, Unit]:
    root = quantity.to_base_units()
    unit, factor = NONE, 1.0
    for base, power in dict(root.units._units).items():
        if base not in _BASES or power != int(power):
            raise ValueError(f"constant {quantity}: expected a unit of m, s, kg and rad")
        unit = _times(unit, _BASES[base], int(power))
        factor *= 1e-3**power if base == "gram" else 1.0
    return float(root.magnitude) * factor, unit
