"""Printed numbers of a paper: a computed value is shown with the same digits and unit."""

from decimal import ROUND_HALF_EVEN, Context, Decimal
from typing import NamedTuple

from ...units.parse import factor_to_si
from ...units.text import split_quantity
from ..schema import SceneError, shown

MOST_DIGITS = 15  # in front of the point; a larger number is written as a power of ten


class Printed(NamedTuple):
    """A printed number: its value, the power of ten of its last digit, and its unit as written.

    `factor` turns a computed value into that unit.
    """

    value: Decimal
    place: int
    unit: str
    factor: float = 1.0

    def rounded(self, computed: float) -> Decimal:
        """A computed value with the digits of the printed one."""
        exact = Decimal(computed * self.factor)
        if not exact.is_finite():
            return exact
        wide = Context(prec=max(28, exact.adjusted() - self.place + 3))
        return exact.quantize(Decimal(1).scaleb(self.place), ROUND_HALF_EVEN, wide)

    def agrees(self, computed: float) -> bool:
        """True if a computed value rounds to the printed one."""
        return self.rounded(computed) == self.value

    def text(self, value: Decimal) -> str:
        """A value written like the printed one; as a power of ten where that would fill the line."""
        form = "f" if not value or value.adjusted() < MOST_DIGITS else ".6e"
        return f"{value:{form}} {self.unit}".rstrip()


def read_printed(key: str, written: str | float, digits: int | None, unit: str) -> Printed:
    """The printed number that stands in a scene for a quantity in this SI unit.

    Trailing zeros of a whole number are not taken as digits: -7740 has three, unless `digits` says
    otherwise. A number without a unit is in the SI unit.
    """
    try:
        number, written_unit = split_quantity(str(written))
        value = Decimal(number)
    except ValueError as error:
        raise SceneError(f"{key} = {shown(written)}: {error}") from None
    exponent = int(value.as_tuple().exponent)
    place = exponent if exponent < 0 else int(value.normalize().as_tuple().exponent)
    if digits is not None:
        place = value.adjusted() - digits + 1
    unit_text = written_unit or unit
    return Printed(value, place, unit_text, _factor(f"{key} = {shown(written)}", unit_text, unit))


def read_percentage(key: str, written: str | float) -> Printed:
    """A printed percentage, with or without its sign."""
    text = str(written).strip()
    try:
        return read_printed(key, text.removesuffix("%"), None, "%")
    except SceneError:
        raise SceneError(f'{key} = {shown(written)}: it must be a percentage such as "33 %"') from None


def _factor(complaint: str, unit: str, si: str) -> float:
    """The factor from the SI unit to a unit."""
    if unit == "%":
        return 1.0
    try:
        return float(1 / factor_to_si(complaint, unit, si))
    except ValueError as error:
        raise SceneError(str(error)) from None
