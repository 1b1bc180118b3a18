"""The dimension of a value: exponents of m, s and kg. Radians are dimensionless."""

from fractions import Fraction
from typing import NamedTuple

from ..units.dimensions import Unit, unit_text

_NAMED = {(2, -3, 1): "W", (2, -2, 1): "N*m", (1, -2, 1): "N"}


class Dimension(NamedTuple):
    """Exponents of m, s and kg."""

    m: Fraction = Fraction(0)
    s: Fraction = Fraction(0)
    kg: Fraction = Fraction(0)

    def times(self, other: "Dimension", power: Fraction | int = 1) -> "Dimension":
        """The dimension of a product with a power of another value."""
        return Dimension(*(one + power * two for one, two in zip(self, other, strict=True)))

    def unit(self) -> str | None:
        """The SI unit; None where a power of it is not whole."""
        if any(power.denominator != 1 for power in self):
            return None
        m, s, kg = (int(power) for power in self)
        return _NAMED.get((m, s, kg)) or unit_text(Unit(m, s, 0, kg))

    def __str__(self) -> str:
        if self == NONE:
            return "a plain number"
        powers = [(base, power) for base, power in self._asdict().items() if power]
        return self.unit() or "*".join(f"{base}^{_exponent(power)}" for base, power in powers)


def _exponent(power: Fraction) -> str:
    return f"{power}" if power.denominator == 1 else f"({power})"


NONE = Dimension()


def dimension_of(unit: Unit) -> Dimension:
    """The dimension of a unit; an angle has none."""
    return Dimension(Fraction(unit.m), Fraction(unit.s), Fraction(unit.kg))
