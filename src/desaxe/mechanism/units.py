"""Units of inputs: text such as "10 mm" and pint quantities become SI numbers (extra `units`).

Text is read as an exact fraction, converted exactly and rounded once, so that "350 mm" is the same
double as 0.350. The unit must say the same as the input's own, angle included: "25 Hz" is no angular
speed, although to a unit library a radian is nothing.
"""

from decimal import Decimal
from fractions import Fraction
from functools import cache, lru_cache
from math import isfinite
from typing import Any

from ..support.extras import MissingExtraError, explained
from ..support.interrupts import import_whole
from ..support.quantity_text import plain_number, printed, quantity_text, split_quantity
from ..support.shown import shown
from .inputs import INPUTS

LONGEST_UNIT = 100  # characters
_LONGEST = 1000  # characters of a number: all digits of any double
_BEYOND = "it must be a number that a double holds, from 4.9e-324 to 1.8e308"
EXAMPLES = {
    "m": '"125 mm"',
    "rad": '"60 deg"',
    "rad/s": '"1500 rpm", "25 turn/s" or "157 rad/s"',
    "rad/s^2": '"10 rad/s^2"',
    "kg": '"0.5 kg"',
    "kg*m^2": '"80.6 kg mm2"',
    "N": '"50 N"',
    "m/s^2": '"9.81 m/s^2"',
}
# Units whose letters people write in the wrong case, or without the blank, by SI unit.
COMMON = {
    "m": ("mm", "cm", "m"),
    "rad": ("deg", "rad"),
    "rad/s": ("rpm",),
    "kg": ("kg", "g"),
    "N": ("kN", "N"),
    "N*m": ("N m", "kN m", "N mm"),
    "kg*m^2": ("kg m^2", "kg m2", "kg mm^2", "kg mm2"),
    "W": ("kW", "W"),
    "J": ("kJ", "J"),
}


@cache
def registry() -> Any:
    """The registry of units that floats are converted with."""
    return _registry(float)


@cache
def _exact_registry() -> Any:
    return _registry(Fraction)


def _registry(number: type) -> Any:
    with explained("a value with a unit"):
        pint = import_whole("pint")
    units: Any = pint.UnitRegistry(non_int_type=number)
    units.define("@alias revolution = rev")
    units.define("@alias revolutions_per_minute = RPM")
    return units


def in_si(name: str, value: Any) -> Any:
    """The magnitude of a text or pint quantity in the SI unit of an input; errors name both."""
    return in_unit(name, value, INPUTS[name].unit)


def in_unit(name: str, value: Any, unit: str) -> Any:
    """The magnitude of a text or pint quantity in a unit."""
    if isinstance(value, str):
        return (_of_short_text if len(value) <= SHORT else _of_text)(name, value, unit)
    if not _says_the_same(value, unit):
        raise ValueError(f"{name} = {shown(value)}: {_wanted(unit)}")
    factor = _factor(str(value.units), unit)
    known = float((1 * value.units).to(unit).magnitude)
    if factor is None or abs(float(factor) - known) > 1e-12 * abs(known):  # a unit of another registry
        return value.to(unit).magnitude
    magnitude = value.magnitude
    if isinstance(magnitude, (int, float, Decimal, Fraction)) and isfinite(magnitude):
        written = repr(float(magnitude)) if isinstance(magnitude, float) else magnitude
        return rounded(name, str(value), Fraction(written) * factor)  # as the same text
    return magnitude / float(1 / factor) if factor.numerator == 1 else magnitude * float(factor)


def _of_text(name: str, text: str, unit: str) -> float:
    plain = plain_number(text)
    return rounded(name, text, exact(name, text, unit)) if plain is None else plain


SHORT = 40  # letters of a text that is worth remembering
_of_short_text = lru_cache(maxsize=1024)(_of_text)


@cache
def _factor(own: str, unit: str) -> Fraction | None:
    """The exact factor between two units; None for a unit that only another registry knows."""
    try:
        return Fraction(_exact_registry().Quantity(Fraction(1), own).to(unit).magnitude)
    except Exception:
        return None


def unlabelled(name: str, array: Any, expected: str) -> Any:
    """The values of a labelled array; a pint quantity if its attribute `units` is not the expected unit."""
    unit = array.attrs.get("units", expected)
    if unit == expected or hasattr(array.data, "magnitude"):
        return array.data
    try:
        return registry().Quantity(array.values, unit)
    except MissingExtraError:
        raise
    except Exception:
        raise ValueError(f"{name} in {unit!r}: unknown unit; {_wanted(expected)}") from None


def rounded(name: str, text: str, value: Fraction) -> float:
    """The number as a double; ValueError beyond the largest one."""
    try:
        return float(value)
    except OverflowError:
        raise ValueError(f"{name} = {shown(text)}: {_BEYOND}") from None


def exact(name: str, text: str, unit: str) -> Fraction:
    """The number that a text with a unit is in another unit, exactly (pi to 50 digits)."""
    try:
        number, own = split_quantity(text, EXAMPLES.get(unit, EXAMPLES["m"]))
        _check_size(number)
        if not own:
            return Fraction(number)
        if len(own) > LONGEST_UNIT:
            raise ValueError(f"a unit of {len(own)} characters, at most {LONGEST_UNIT}")
        quantity = _exact_registry().Quantity(Fraction(number), quantity_text(f"1 {own}")[2:])
    except MissingExtraError:
        raise
    except ValueError as error:
        raise ValueError(f"{name} = {shown(text)}: {error}") from None
    except Exception:
        hint = did_you_mean_unit(own, unit)
        raise ValueError(f"{name} = {shown(text)}: unknown unit; {hint}{_wanted(unit)}") from None
    if not _says_the_same(quantity, unit):
        raise ValueError(f"{name} = {shown(text)}: {did_you_mean_unit(own, unit)}{_wanted(unit)}")
    return Fraction(quantity.to(unit).magnitude)


def did_you_mean_unit(own: str, unit: str) -> str:
    """The question "did you mean kN? " for kn, which is a knot, or "N m" for Nm; empty for other units."""
    letters = own.replace(" ", "").lower()
    others = (each for each in COMMON.get(unit, ()) if each != own)
    near = next((each for each in others if each.replace(" ", "").lower() == letters), "")
    return f"did you mean {near}? " if near else ""


def _check_size(number: str) -> None:
    """Refuse a number whose exact value would be far longer than its text, or beyond every double."""
    exponent = number.lower().partition("e")[2]
    if len(number) > _LONGEST or len(exponent.lstrip("+-0")) > 3:
        raise ValueError(f"{_BEYOND}, written with at most {_LONGEST} characters")


def _says_the_same(quantity: Any, unit: str) -> bool:
    """True if both have the same base units, radians included."""
    own = quantity.to_root_units().units
    wanted = (1 * quantity._REGISTRY.Unit(unit)).to_root_units().units
    return dict(own._units) == dict(wanted._units)


def _wanted(unit: str) -> str:
    if unit == "1":
        return "it must be a plain number, such as 0.1"
    example = EXAMPLES.get(unit)
    return f"it must be a quantity in {printed(unit)}" + (f", such as {example}" if example else "")
