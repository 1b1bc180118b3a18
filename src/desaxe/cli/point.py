"""`desaxe point`: values at one crank angle of one design."""

import argparse
import json
from math import isfinite
from typing import Any

from ..mechanism.inputs import INPUTS
from ..mechanism.names import LOADS
from ..support.shown import printed, with_unit
from ..support.text_table import table
from .parser import SIGNS, add_command
from .words import names_and_inputs


def add_point(commands: Any) -> None:
    """Add `desaxe point`."""
    parser = add_command(commands, "point", "values at one crank angle of one design", _point, _facts)
    parser.add_argument(
        "words", nargs="*", metavar="NAME | INPUT=VALUE", help="quantities (V_C a_C, or V_C,a_C) and inputs"
    )
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument("--list", action="store_true", help="print all quantities with units and meanings")
    parser.add_argument("--quality", action="store_true", help="print conditions and digits as well")


def _facts() -> dict[str, str | list[str]]:
    return {"LOADS": [f"{name:8} {INPUTS[name].meaning}" for name in LOADS], "SIGNS": SIGNS}


def _point(options: argparse.Namespace) -> int:
    if options.list:
        return _list()
    from ..evaluation.evaluate import evaluate
    from ..loads.absent import warn_that_nothing_acts
    from ..mechanism.catalogue import quantity
    from ..mechanism.slips import warn_of_slips
    from ..mechanism.status import PointStatus

    names, inputs = names_and_inputs(options.words)
    values: dict[str, Any] = evaluate(names, **inputs)
    warn_of_slips(inputs, inputs=inputs)
    warn_that_nothing_acts(names, inputs)
    rows = {name: quantity(name, "omega" in inputs) for name in names}
    status = _status(values, inputs)
    worth = _qualities(names, inputs) if options.quality else {}
    if options.json:
        found: dict[str, Any] = {
            name: {"value": _json_number(values[name]), "unit": row.unit, "meaning": row.meaning}
            | (_json_quality(worth[name]) if name in worth else {})
            for name, row in rows.items()
        }
        if status or "status" in names:
            row = quantity("status")
            found["status"] = {"value": status, "unit": row.unit, "meaning": PointStatus(status).words}
        print(json.dumps(found, indent=2))
        return 0
    texts = [(with_unit(f"{name} = {values[name]!r}", row.unit), row.meaning) for name, row in rows.items()]
    print("\n".join(table(texts, gap="   ")))
    if status:
        print(f"status {status}: {PointStatus(status).words}")
    for name, its in worth.items():
        print(f"\n{name}: {its.digits:.1f} digits, rounding error at most {its.error_bound:.1e}")
        for parameter, condition in its.conditions.items():
            print(f"  1 % of {parameter:8} changes it by {condition:.3g} %")
    return 0


def _qualities(names: list[str], inputs: dict[str, Any]) -> dict[str, Any]:
    """The value of each name with its condition numbers and error bound."""
    from ..evaluation.evaluate import evaluate

    found: dict[str, Any] = evaluate([n for n in names if n != "status"], **inputs, quality=True)
    return found


def _list() -> int:
    from ..mechanism.catalogue import quantities

    rows = quantities().values()
    sources = [f" ({row.source})" if row.source else "" for row in rows]
    cells = [
        (row.name, printed(row.unit) or "1", row.meaning + source)
        for row, source in zip(rows, sources, strict=True)
    ]
    print("\n".join(table(cells)))
    return 0


def _status(values: dict[str, Any], inputs: dict[str, Any]) -> int:
    """The status at the point; 0 also where too few inputs are given to know."""
    from ..evaluation.evaluate import evaluate

    if "status" in values:
        return int(values["status"])
    try:
        return int(evaluate("status", **inputs))
    except TypeError:
        return 0


def _json_quality(its: Any) -> dict[str, Any]:
    conditions = {parameter: _json_number(condition) for parameter, condition in its.conditions.items()}
    numbers = {"error_bound": _json_number(its.error_bound), "digits": _json_number(its.digits)}
    return {"conditions": conditions, **numbers}


def _json_number(value: float) -> float | None:
    """The number for JSON: null for NaN."""
    return value if isfinite(value) else None
