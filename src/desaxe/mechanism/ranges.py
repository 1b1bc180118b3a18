"""Inputs that are not one number: a value with its tolerance, or the two ends of a range.

A bare pair could mean either: `enclose` and `tolerance` refuse it. `plus_minus` and `between` mean the same
everywhere. Numbers and texts are added exactly as they are written and rounded once, so that
plus_minus("10 mm", "0.1 mm") has the ends of between("9.9 mm", "10.1 mm").
"""

from fractions import Fraction
from typing import Any, NamedTuple

from ..support.shown import shown
from ..units.parse import exact, rounded
from ..units.text import with_unit_of
from .inputs import row_of
from .messages import amount, named
from .read import in_si


class PlusMinus(NamedTuple):
    """A value and its tolerance, as given."""

    value: Any
    tolerance: Any

    def __repr__(self) -> str:
        return f"plus_minus({self.value!r}, {self.tolerance!r})"


class Between(NamedTuple):
    """The two ends of a range, as given."""

    low: Any
    high: Any

    def __repr__(self) -> str:
        return f"between({self.low!r}, {self.high!r})"


def plus_minus(value: Any, tolerance: Any) -> PlusMinus:
    """A value and its tolerance, for `enclose` and `tolerance`: value - tolerance .. value + tolerance.

    Each is a number in SI units, or in those of the machine whose call it is given to, or text with a unit;
    the tolerance may be in percent of the value. A text without a unit has that of the one beside it.

        >>> import desaxe as dx
        >>> rod = {"AB": 0.125, "BC": 0.35, "theta": 1.0}
        >>> box = dx.enclose("Y", ec=dx.plus_minus("10 mm", "0.1 mm"), **rod)
        >>> box["lower"] < dx.evaluate("Y", ec=0.01, **rod) < box["upper"]
        True
    """
    return PlusMinus(value, tolerance)


def between(low: Any, high: Any) -> Between:
    """The ends of a range, for `enclose`, `tolerance` (middle and half the width) and `optimize`.

    Each is a number in SI units, or in those of the machine whose method it is passed to, or a text.

        >>> import desaxe as dx
        >>> dx.between("9.9 mm", "10.1 mm")
        between('9.9 mm', '10.1 mm')
    """
    return Between(low, high)


def refuse_bare_pair(name: str, value: Any) -> None:
    """ValueError for two values that do not say whether they are value and tolerance or both ends."""
    if type(value) in (tuple, list) and len(value) == 2:
        first, second = value
        raise ValueError(
            f"{name} = {shown(value)}: a pair must say what it means: dx.plus_minus({first!r}, {second!r}) "
            f"is a value and its tolerance, dx.between({first!r}, {second!r}) both ends of a range"
        )


def ends_of(name: str, given: PlusMinus) -> tuple[float, float]:
    """Both ends of a value with its tolerance; ValueError for a bad one."""
    value, tolerance = _tolerance(name, given)
    return rounded(name, str(given), value - tolerance), rounded(name, str(given), value + tolerance)


def value_and_tolerance(name: str, given: PlusMinus) -> tuple[float, float]:
    """A value and its tolerance, the latter not in percent; ValueError for a bad one."""
    value, tolerance = (rounded(name, str(given), number) for number in _tolerance(name, given))
    return value, tolerance


def middle_of(name: str, value: Between) -> tuple[float, float]:
    """The middle of a range and half its width; ValueError where the lower end is not first."""
    low, high = (_number(name, end, value) for end in value)
    if low > high:
        raise ValueError(named(name, value) + ": the lower end comes first")
    return rounded(name, str(value), (low + high) / 2), rounded(name, str(value), (high - low) / 2)


def _tolerance(name: str, given: PlusMinus) -> tuple[Fraction, Fraction]:
    value = _number(name, given.value, given)
    tolerance = with_unit_of(given.value, given.tolerance)
    if isinstance(tolerance, str) and tolerance.strip().endswith("%"):
        share = exact(name, tolerance.strip().removesuffix("%"), "1") / 100
        result = share * abs(value)
    else:
        result = _number(name, tolerance, given)
    if result < 0:
        raise ValueError(f"{name}: a tolerance of " + amount(name, float(result)) + " is below 0")
    return value, result


def _number(name: str, value: Any, whole: Any) -> Fraction:
    """The number as it is written."""
    if isinstance(value, str):
        return exact(name, value, row_of(name).unit)
    number = in_si(row_of(name), value) if hasattr(value, "magnitude") else value
    try:
        return Fraction(repr(float(number)))
    except (TypeError, ValueError, OverflowError):
        raise ValueError(
            f"{name} = {shown(whole)}: expected two finite numbers or texts with a unit"
        ) from None
