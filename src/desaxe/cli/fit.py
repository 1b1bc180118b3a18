"""`desaxe fit`: the parameters of a scene's machine from measurements."""

import argparse
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..mechanism.quantity_units import UnitSystem, si_unit
from .answers import plain
from .parser import add_command
from .words import UsageError

# What the JSON of a fit has.
KEPT = (
    "value",
    "std_error",
    "interval",
    "names",
    "unidentified",
    "at_bound",
    "chi_square",
    "status",
    "message",
)


def add_fit(commands: Any) -> None:
    """Add `desaxe fit`."""
    parser = add_command(commands, "fit", "parameters of a machine from measurements", _fit)
    parser.add_argument("scene", metavar="SCENE", help="path of a TOML file")
    parser.add_argument("data", metavar="DATA", help="path of a CSV file")
    parser.add_argument(
        "--over",
        metavar="NAME[=START|=LOW:HIGH]",
        nargs="+",
        required=True,
        help="the unknowns, with a start or a range",
    )
    parser.add_argument(
        "--sigma", metavar="NAME=VALUE", nargs="+", default=(), help="standard deviations of quantities"
    )
    parser.add_argument(
        "--nuisance",
        metavar="NAME",
        nargs="+",
        default=(),
        help="errors of instruments: offset, biases, scales",
    )
    parser.add_argument("--loss", default="linear", help="linear (default), soft_l1, huber, cauchy or arctan")
    parser.add_argument("--picture", metavar="FILE", help="write a picture of measurements and fit")
    parser.add_argument(
        "--overwrite", action="store_true", help="replace a picture that desaxe did not write"
    )
    parser.add_argument("--json", action="store_true", help="print JSON")


def _fit(options: argparse.Namespace) -> int:
    from ..design.fit.data import columns_of
    from ..design.fit.fit import fit
    from ..evaluation.in_units import in_units
    from ..scenes.scene import scene
    from ..support.written import require_path

    if options.picture:
        require_path(Path(options.picture), options.overwrite)
    whole = scene(options.scene)
    known = whole.content
    over = dict(_unknown(word, known.inputs, known.units) for word in options.over)
    fixed: dict[str, Any] = {
        name: value for name, value in known.inputs.items() if name not in over and name != "theta"
    }
    for name, value in fixed.items():
        if isinstance(value, tuple):
            raise UsageError(
                f"{name}: the scene has {len(value)} values of it, and a fit is of one machine: "
                f"--over {name}=LOW:HIGH"
            )
    sigma = dict(_sigma(word, known.units) for word in options.sigma) or None
    data = columns_of(options.data, known.units)
    found = fit(data, over, sigma, options.nuisance, options.loss, branch=known.branch, **fixed)
    told = in_units(found, whole.shown_in)  # JSON is in SI units
    kept = {key: plain(found[key]) for key in KEPT}
    print(json.dumps(kept, indent=2) if options.json else told.report(), flush=True)
    if options.picture:
        from ..plot.save import save

        save(told.plot(), options.picture, overwrite=options.overwrite)
    return 0


def _unknown(word: str, inputs: Mapping[str, Any], units: UnitSystem) -> tuple[str, Any]:
    """Parse NAME, NAME=START or NAME=LOW:HIGH, in the scene's units, into a name and its value for `fit`."""
    name, equals, value = word.partition("=")
    if not equals:
        if not isinstance(inputs.get(name), (int, float)):
            raise UsageError(
                f"--over {name}: the scene has no number for it; give {name}=START or {name}=LOW:HIGH"
            )
        return name, inputs[name]
    low, colon, high = value.partition(":")
    first = _in_si(name, low, units)
    return name, (first, _in_si(name, high, units)) if colon else first


def _sigma(word: str, units: UnitSystem) -> tuple[str, Any]:
    name, equals, value = word.partition("=")
    if not equals:
        raise UsageError(f"--sigma {word}: expected NAME=VALUE")
    return name, _in_si(name, value, units)


def _in_si(name: str, text: str, units: UnitSystem) -> Any:
    """A number in SI units from a text, of which a plain one is in the scene's; `fit` refuses other names."""
    from ..mechanism.inputs import Input
    from ..mechanism.read import in_si

    conversion = units.find(name)
    return text if conversion is None else in_si(Input(name, si_unit(name), ""), text, units)
