"""`desaxe point`: values at one crank angle of one design."""

import argparse
import json
from math import isfinite
from typing import Any

from ..mechanism.inputs import INPUTS
from ..mechanism.names import LOADS
from ..support.text_table import table
from .parser import SIGNS, add_command
from .words import names_and_inputs

_POINT = f"""\
inputs (SI units and radians, or any unit written behind the number):
  theta    crank angle            theta=60deg  theta=1.047
  ec       eccentricity           ec=10mm      either sign
  AB, BC   crank, connecting rod  AB=125mm     BC=0.35
  omega0   crank speed at theta=0 omega0=1500rpm; omega^2 = omega0^2 + 2 alpha theta
  alpha    crank acceleration     alpha=10     0 by default
  omega    speed at this instant, instead of omega0
  branch   1 (default) or -1: on which side of the crank pin the slider is

masses and loads, for forces, torques and energies; 0 by default, but r_crank = AB/2, r_rod = BC/2:
{"".join(f"  {name:8} {INPUTS[name].meaning}" + chr(10) for name in LOADS)}
  m_rod=0.5kg  I_rod="80.6 kg mm2"  F_Y=-50N  g_X=-9.81m/s2  mu=0.1

Where a value is NaN the status says why: 1 cannot be assembled here, 2 change point, 3 stalled,
5 friction jams (no balance of forces), 6 friction has two balances of forces.

{SIGNS}

examples:
  desaxe point a_C theta=60deg ec=10mm AB=125mm BC=300mm omega0=1500rpm
  desaxe point V_C,a_C,a_C_wrt_ec theta=60deg ec=0 AB=.125 BC=.35 omega0=157.08
  desaxe point T_in,N_C theta=60deg ec=10mm AB=125mm BC=0.3 omega0=0 F_Y=-50N
  desaxe point margin ec=220mm AB=125mm BC=350mm --json
  desaxe point V_C theta=1 ec=0 AB=.125 BC=.35 omega0=157 --quality     with conditions and digits
  desaxe point --list                        all names, with units and meanings"""


def add_point(commands: Any) -> None:
    """Add `desaxe point`."""
    parser = add_command(commands, "point", "values at one crank angle of one design", _POINT, _point)
    parser.add_argument(
        "words", nargs="*", metavar="NAME | INPUT=VALUE", help="quantities (V_C a_C, or V_C,a_C) and inputs"
    )
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument("--list", action="store_true", help="print all quantities with units and meanings")
    parser.add_argument("--quality", action="store_true", help="print conditions and digits as well")


def _point(options: argparse.Namespace) -> int:
    if options.list:
        return _list()
    from ..evaluation.evaluate import evaluate
    from ..mechanism.catalogue import quantity
    from ..mechanism.slips import warn_of_slips
    from ..mechanism.status import PointStatus

    names, inputs = names_and_inputs(options.words)
    values: dict[str, Any] = evaluate(names, **inputs)
    warn_of_slips(inputs)
    rows = {name: quantity(name, "omega" in inputs) for name in names}
    status = _status(values, inputs)
    worth = _qualities(names, inputs) if options.quality else {}
    if options.json:
        found: dict[str, Any] = {
            name: {"value": _json_number(values[name]), "unit": row.unit, "meaning": row.meaning}
            | (_json_quality(worth[name]) if name in worth else {})
            for name, row in rows.items()
        }
        print(json.dumps({**found, **({"status": PointStatus(status).words} if status else {})}, indent=2))
        return 0
    texts = [
        (f"{name} = {values[name]!r} {'' if row.unit == '1' else row.unit}".rstrip(), row.meaning)
        for name, row in rows.items()
    ]
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
    cells = [(row.name, row.unit, row.meaning + source) for row, source in zip(rows, sources, strict=True)]
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
