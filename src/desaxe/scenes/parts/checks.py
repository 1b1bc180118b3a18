"""[[check]]: printed values beside the computed ones, with the digits and the unit of the printed one."""

from collections.abc import Mapping
from dataclasses import dataclass
from decimal import ROUND_HALF_EVEN, Context, Decimal
from typing import Any, NamedTuple

from ...evaluation.evaluate import evaluate
from ...mechanism.catalogue import quantity
from ...mechanism.quantity_units import UnitSystem
from ...units.parse import factor_to_si
from ...units.text import split_quantity
from ..content import Content, PlanRow, RequestAnswer, RequestPlan
from ..document.blocks import Section, TextTable
from ..reading.values import Value, design_of, require_quantity, single, with_others, with_unit_in
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
        value, unit_text = Decimal(number), written_unit or unit
        same = unit_text == "%"
        factor = 1.0 if same else float(1 / factor_to_si(f"{key} = {shown(written)}", unit_text, unit))
    except ValueError as error:
        message = str(error)
        prefix = "" if message.startswith(key) else f"{key} = {shown(written)}: "
        raise SceneError(f"{prefix}{message}") from None
    exponent = int(value.as_tuple().exponent)
    place = exponent if exponent < 0 else int(value.normalize().as_tuple().exponent)
    if digits is not None:
        place = value.adjusted() - digits + 1
    return Printed(value, place, unit_text, factor)


def read_percentage(key: str, written: str | float) -> Printed:
    """A printed percentage, with or without its sign."""
    text = str(written).strip()
    try:
        return read_printed(key, text.removesuffix("%"), None, "%")
    except SceneError:
        raise SceneError(f'{key} = {shown(written)}: it must be a percentage such as "33 %"') from None


class CheckResult(NamedTuple):
    """A printed value and the computed one, in SI units."""

    check: "Check"
    computed: float
    agrees: bool


@dataclass(frozen=True)
class Check:
    """A printed value, and the inputs for the computed one."""

    title: str
    source: str
    quantity: str
    printed: Printed
    inputs: dict[str, Any]

    def run(self, content: Content) -> CheckResult:
        """Compute the value."""
        design: dict[str, Any] = {**self.inputs, "branch": content.branch, "accuracy": content.accuracy}
        computed = float(evaluate(self.quantity, **design))
        return CheckResult(self, computed, self.printed.agrees(computed))


@dataclass(frozen=True)
class Checks:
    """All printed values of a scene."""

    key = "check"
    checks: tuple[Check, ...]

    def plan(self, content: Content) -> RequestPlan:
        """A point for each."""
        work = PlanRow("printed values", len(self.checks), "points", "single points in plain Python")
        return RequestPlan(
            lambda _: ChecksAnswer(results=tuple(one.run(content) for one in self.checks)), work=[work]
        )


@dataclass(frozen=True, kw_only=True)
class ChecksAnswer(RequestAnswer):
    """Printed values beside the computed ones, which stay in the units of the printed ones."""

    key = "check"
    results: tuple[CheckResult, ...]

    def blocks(self, units: UnitSystem) -> Section:
        """A table for each source."""
        tables = []
        for source in dict.fromkeys(one.check.source for one in self.results):
            rows: list[tuple[str, ...]] = []
            last = None
            for check, computed, agrees in (one for one in self.results if one.check.source == source):
                number = check.printed
                cells = number.text(number.value), number.text(number.rounded(computed))
                full = f"{computed * number.factor:.8g}"
                title, last = "" if check.title == last else check.title, check.title
                rows.append((title, check.quantity, *cells, full, "agrees" if agrees else "DIFFERS"))
            tables.append(TextTable(("", "", source, "desaxe", "in full", ""), rows))
        return Section("Checks", tables)


def checks_of(
    key: str, table: Mapping[str, Any], inputs: Mapping[str, Value], units: UnitSystem
) -> list[Check]:
    """The printed values of a [[check]], each with the inputs that it needs."""
    there = with_others(inputs, design_of(f"{key}.at", table.get("at", {}), units))
    checks = []
    for name, written in table["printed"].items():
        place = f"{key}.printed.{name}"
        needed = require_quantity(place, name, there)
        text, unit = with_unit_in(units, name, written), quantity(name, "omega" in there).unit
        printed = read_printed(place, text, table.get("digits"), unit)
        design = single(place, needed, there)
        checks.append(Check(table.get("title", ""), table.get("source", "printed"), name, printed, design))
    if not checks:
        raise SceneError(f"{key}.printed = {{}}: expected at least one printed value")
    return checks
