"""[[check]]: printed values beside the computed ones."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from ...evaluation.evaluate import evaluate
from ...mechanism.catalogue import quantity
from ...mechanism.quantity_units import UnitSystem
from ...scenes import schema
from ..reading.needs import needs_of, require, require_known, single, with_others
from ..reading.printed import Printed, read_printed
from ..reading.values import Value, design_of, with_unit_in
from ..schema import SceneError
from ..setting import Setting


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

    def run(self, setting: Setting) -> CheckResult:
        """Compute the value."""
        design: dict[str, Any] = {**self.inputs, "branch": setting.branch, "accuracy": setting.accuracy}
        computed = float(evaluate(self.quantity, **design))
        return CheckResult(self, computed, self.printed.agrees(computed))


def checks_of(
    key: str, table: schema.CheckTable, inputs: Mapping[str, Value], units: UnitSystem
) -> list[Check]:
    """The printed values of a [[check]], each with the inputs that it needs."""
    there = with_others(inputs, design_of(f"{key}.at", table.at, units))
    checks = []
    for name, written in table.printed.items():
        place = f"{key}.printed.{name}"
        require_known(place, name, "omega" in there)
        needed = require(place, needs_of((name,), there), name, there)
        printed = read_printed(
            place, with_unit_in(units, name, written), table.digits, quantity(name, "omega" in there).unit
        )
        checks.append(Check(table.title, table.source, name, printed, single(place, needed, there)))
    if not checks:
        raise SceneError(f"{key}.printed = {{}}: expected at least one printed value")
    return checks
