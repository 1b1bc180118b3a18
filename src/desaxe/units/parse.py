"""From a text such as "10 mm", or a pint quantity, to a number in an SI unit.

A text is read as an exact fraction, converted exactly and rounded once, so that "350 mm" is the same
double as 0.350. The unit must say the same as the SI unit, angle included: "25 Hz" is no angular
speed, although a radian has no dimension.
"""

from decimal import Decimal
from fractions import Fraction
from functools import lru_cache
from math import isfinite
from typing import Any

from ..support.forks import IMPORTS
from ..support.shown import printed, shown
from .dimensions import ANGULAR_SPEED, NONE, PER_TIME, Unit
from .scaling import by_digits
from .table import UNITS, ScaledUnit, did_you_mean_unit
from .text import plain_number, split_quantity, terms_of

LONGEST_UNIT = 100  # characters
_LONGEST = 1000  # characters of a number: all digits of any double
_BEYOND = "it must be a number that a double holds, from 4.9e-324 to 1.8e308"
_RATE = 'a rate "per time" does not say of what: write turns or an angle, such as "120 turn/min"'
_COHERENT = ("1", "m", "s", "rad", "kg", "N", "J", "W", "Pa", "Hz")
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


@lru_cache(maxsize=1024)
def parse_unit(text: str) -> ScaledUnit:
    """The unit of a text such as `kg mm^2`, `N*m` or `1/min`; ValueError for any other."""
    if len(text) > LONGEST_UNIT:
        raise ValueError(f"a unit of {len(text)} characters, at most {LONGEST_UNIT}")
    size, si = Fraction(1), NONE
    for name, power in terms_of(text):
        factor = UNITS.get(name) or _unit_of_pint(name)
        size *= factor.size**power
        si = si.times(factor.si, power)
    return ScaledUnit(size, si)


def _unit_of_pint(name: str) -> ScaledUnit:
    with IMPORTS:
        from .pint_units import unit_of_pint

    return unit_of_pint(name)


@lru_cache(maxsize=1024)
def coherent_unit(text: str) -> Unit:
    """The unit of a text such as `m/s^2`, `N m` or `W`: SI without prefixes; ValueError for any other."""
    try:
        if all(name in _COHERENT for name, _ in terms_of(text)):
            special = UNITS[text.strip()].si.name if text.strip() in UNITS else ""
            return parse_unit(text).si._replace(name=special)
    except ValueError:
        pass
    raise ValueError(f"unit {text!r}: expected a product of {', '.join(_COHERENT)}, such as 'N*m'")


def factor_to_si(what: str, unit: str, si: str) -> Fraction:
    """The exact factor from a unit to an SI unit; ValueError, which begins with `what`, for another kind."""
    if unit == si:
        return Fraction(1)
    hint = did_you_mean_unit(unit, si)
    if hint and not is_in_table(unit):  # such letters need no unit library
        raise ValueError(f"{what}: unknown unit; {hint}{_must_be(si)}")
    try:
        scaled = parse_unit(unit)
    except ValueError as error:
        raise ValueError(f"{what}: {error}; {_must_be(si)}") from None
    requested = parse_unit(si)
    if scaled.si == requested.si:
        return scaled.size / requested.size
    if scaled.si[:4] == PER_TIME[:4] and requested.si == ANGULAR_SPEED and unit.lstrip("1 ").startswith("/"):
        raise ValueError(f"{what}: {_RATE}")
    raise ValueError(f"{what}: {hint}{_must_be(si)}")


def is_in_table(unit: str) -> bool:
    """True for a unit that no unit library is needed for."""
    try:
        return all(name in UNITS for name, _ in terms_of(unit))
    except ValueError:
        return False


def exact(name: str, text: str, si: str) -> Fraction:
    """The exact number of a text in an SI unit (pi to 50 digits); one without a unit is in it."""
    what = f"{name} = {shown(text)}"
    number, unit = _number_and_unit(what, text, EXAMPLES.get(si, EXAMPLES["m"]))
    return number * factor_to_si(what, unit, si) if unit else number


def exact_quantity(what: str, text: str) -> ScaledUnit:
    """The exact number of a text in the coherent SI unit of its own, and that unit."""
    number, unit = _number_and_unit(what, text, EXAMPLES["m"])
    try:
        size, si = parse_unit(unit) if unit else ScaledUnit(Fraction(1), NONE)
    except ValueError as error:
        raise ValueError(f"{what}: {error}") from None
    return ScaledUnit(number * size, si)


def _number_and_unit(what: str, text: str, example: str) -> tuple[Fraction, str]:
    try:
        number, unit = split_quantity(text, example)
        _check_size(number)
    except ValueError as error:
        raise ValueError(f"{what}: {error}") from None
    return Fraction(number), unit


def _check_size(number: str) -> None:
    """Refuse a number whose exact value would be far longer than its text, or beyond every double."""
    exponent = number.lower().partition("e")[2]
    if len(number) > _LONGEST or len(exponent.lstrip("+-0")) > 3:
        raise ValueError(f"{_BEYOND}, written with at most {_LONGEST} characters")


def rounded(name: str, text: str, value: Fraction) -> float:
    """The number as a double; ValueError beyond the largest one."""
    try:
        return float(value)
    except OverflowError:
        raise ValueError(f"{name} = {shown(text)}: {_BEYOND}") from None


def in_unit(name: str, value: Any, si: str) -> Any:
    """The magnitude of a text or pint quantity in an SI unit; errors name both."""
    if isinstance(value, str):
        plain = plain_number(value)
        return rounded(name, value, exact(name, value, si)) if plain is None else plain
    factor, magnitude = _factor_of_pint(name, value, si), value.magnitude
    if isinstance(magnitude, (int, float, Decimal, Fraction)) and isfinite(magnitude):
        written = repr(float(magnitude)) if isinstance(magnitude, float) else magnitude
        return rounded(name, str(value), Fraction(written) * factor)  # as the same text
    return magnitude * float(factor) if hasattr(magnitude, "dask") else by_digits(magnitude, factor)


def _factor_of_pint(name: str, value: Any, si: str) -> Fraction:
    """The exact factor of a pint quantity's unit; as a double where only its registry knows the unit."""
    with IMPORTS:
        from .pint_units import size_of

    requested = parse_unit(si)
    try:
        approximate = size_of(value.units)
    except ValueError:
        approximate = None
    if approximate is None or approximate.si != requested.si:
        raise ValueError(f"{name} = {shown(value)}: {_must_be(si)}")
    try:
        size = parse_unit(f"{value.units:~C}").size
    except ValueError:
        size = approximate.size
    same = abs(size - approximate.size) <= abs(size) / 10**12
    return (size if same else approximate.size) / requested.size


def _must_be(si: str) -> str:
    if si == "1":
        return "it must be a plain number, such as 0.1"
    example = EXAMPLES.get(si)
    return f"it must be a quantity in {printed(si)}" + (f", such as {example}" if example else "")
