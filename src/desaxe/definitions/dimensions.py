"""Dimensional analysis of an expression: terms that are added or compared must have one dimension.

Radians are dimensionless. A literal 0 agrees with everything, so that `max(power_in, 0)` has a meaning.
"""

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any, NamedTuple, NoReturn

from ..mechanism.dimensions import Unit, unit_text
from .grammar import COMPARISONS, DefinitionText, Node

LARGEST_POWER = 64
SIMPLEST = 1000  # the largest denominator of a power
_NAMED = {(2, -3, 1): "W", (2, -2, 1): "N*m", (1, -2, 1): "N"}


class Dimension(NamedTuple):
    """Exponents of m, s and kg."""

    m: Fraction = Fraction(0)
    s: Fraction = Fraction(0)
    kg: Fraction = Fraction(0)

    def __str__(self) -> str:
        if self == NONE:
            return "a plain number"
        return unit_from(self) or "*".join(
            base if power == 1 else f"{base}^{power}" if power.denominator == 1 else f"{base}^({power})"
            for base, power in self._asdict().items()
            if power
        )


NONE = Dimension()


def dimension_of(unit: Unit) -> Dimension:
    """The dimension of a unit; an angle has none."""
    return Dimension(Fraction(unit.m), Fraction(unit.s), Fraction(unit.kg))


def unit_from(dimension: Dimension) -> str | None:
    """The SI unit of a dimension; None where it has no whole powers."""
    if any(power.denominator != 1 for power in dimension):
        return None
    m, s, kg = (int(power) for power in dimension)
    return _NAMED.get((m, s, kg)) or unit_text(Unit(m, s, 0, kg))


class Checker:
    """Finds the dimension of a tree; `known` maps names to dimensions, `numbers` has the constants."""

    def __init__(
        self, source: DefinitionText, known: Mapping[str, Dimension], numbers: Mapping[str, float]
    ) -> None:
        self.source = source
        self.known = known
        self.numbers = numbers

    def of(self, node: Node) -> Dimension | None:
        """The dimension; None for a 0, which has any."""
        if node.op == "number":
            return None if node.number == 0.0 else NONE
        if node.op == "name":
            return self.known[node.name]
        if node.op in COMPARISONS:
            self.source.refuse(
                node.at, node.end, "a comparison stands only as the first argument of where(...)"
            )
        if node.op == "where":
            return self._where(node)
        if node.op == "**":
            return self._power(node)
        parts = [self.of(part) for part in node.parts]
        if node.op == "neg" or node.op == "abs":
            return parts[0]
        if node.op in ("*", "/"):
            sign = 1 if node.op == "*" else -1
            a, b = (part or NONE for part in parts)
            return Dimension(*(x + sign * y for x, y in zip(a, b, strict=True)))
        if node.op == "sqrt":
            return parts[0] and Dimension(*(x / 2 for x in parts[0]))
        if node.op in ("sin", "cos", "tan", "exp", "log"):
            if parts[0] not in (None, NONE):
                self._refuse(node, f"{node.op} wants a plain number, {self._said(node.parts[0], parts[0])}")
            return NONE
        common = self._common(node, node.parts, parts)
        return NONE if node.op == "atan2" else common

    def _where(self, node: Node) -> Dimension | None:
        test, *sides = node.parts
        if test.op not in COMPARISONS:
            self.source.refuse(
                test.at, test.end, "the first argument of where is a comparison, such as V_C > 0"
            )
        self._common(test, test.parts, [self.of(part) for part in test.parts])
        return self._common(node, tuple(sides), [self.of(side) for side in sides])

    def _common(
        self, node: Node, parts: tuple[Node, ...], dimensions: list[Dimension | None]
    ) -> Dimension | None:
        """The common dimension of the parts; ValueError that shows two that differ."""
        first, *_ = [*(place for place, d in enumerate(dimensions) if d is not None), None]
        if first is None:
            return None
        for part, dimension in zip(parts, dimensions, strict=True):
            if dimension is not None and dimension != dimensions[first]:
                one, other = self._said(parts[first], dimensions[first]), self._said(part, dimension)
                self._refuse(node, f"{node.op!r} wants one dimension on both sides: {one}, {other}")
        return dimensions[first]

    def _power(self, node: Node) -> Dimension | None:
        base, exponent = node.parts
        of_base, of_exponent = self.of(base), self.of(exponent)
        if of_exponent not in (None, NONE):
            self._refuse(exponent, f"a power is a plain number, {self._said(exponent, of_exponent)}")
        power = constant(exponent, self.numbers)
        if power is None:
            if of_base in (None, NONE):
                return NONE
            said = self._said(base, of_base)
            self._refuse(exponent, f"the power of what has a dimension is a constant; {said}")
        if not abs(power) <= LARGEST_POWER:
            self._refuse(exponent, f"a power of {power:g}: at most {LARGEST_POWER} is possible")
        whole = Fraction(power).limit_denominator(SIMPLEST)
        return of_base and Dimension(*(x * whole for x in of_base))

    def _said(self, node: Node, dimension: Dimension | None) -> str:
        return f"{self.source.shown(node)!r} is {dimension}"

    def _refuse(self, node: Node, problem: str) -> NoReturn:
        self.source.refuse(node.at, node.end, problem)


def constant(node: Node, numbers: Mapping[str, float]) -> float | None:
    """The value of a constant part; None if it contains a quantity or input, or overflows."""
    if node.op == "number":
        return node.number
    if node.op == "name":
        return numbers.get(node.name)
    values = [constant(part, numbers) for part in node.parts]
    known = [value for value in values if value is not None]
    if len(known) < len(values) or node.op not in _ARITHMETIC:
        return None
    try:
        result = _ARITHMETIC[node.op](*known)
    except (ArithmeticError, ValueError):
        return None
    return result if isinstance(result, float) else None


_ARITHMETIC: dict[str, Callable[..., Any]] = {
    "+": lambda a, b: a + b,
    "-": lambda a, b: a - b,
    "*": lambda a, b: a * b,
    "/": lambda a, b: a / b,
    "neg": lambda a: -a,
    "**": lambda a, b: a**b,
}
