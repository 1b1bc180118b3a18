"""`machine.plot.tornado`: the changes and the title that a machine knows by itself."""

from collections.abc import Mapping
from typing import Any

from .. import plot
from ..design.tolerance.uncertain import read
from ..evaluation.in_units import in_units
from ..mechanism.catalogue import has
from ..mechanism.inputs import INPUTS
from ..mechanism.names import sensitivity
from ..mechanism.program import program_of
from ..mechanism.ranges import Between, PlusMinus
from ..plot.dataset import as_dataset
from ..plot.style import title_of
from ..plot.tornado import value_text
from ..units.text import PLUS_MINUS
from .arguments import in_si

WORDS = {"absmax": "largest magnitude", "max": "maximum", "min": "minimum"}
SIDES = {-1: ", before a jump", 1: ", after a jump"}
SHARE = 0.01  # of an input, where no changes are given


def tornado(
    machine: Any, name: str, changes: Mapping[str, Any] | None, kind: str, ax: Any, inputs: Mapping[str, Any]
) -> plot.Picture:
    """Draw what changes do to a peak, to the value at an angle, or to a quantity of the whole design."""
    if not isinstance(name, str):
        raise TypeError(
            f"plot.tornado: expected the name of a quantity, got a {type(name).__name__}; a result is drawn "
            "by desaxe.plot.tornado(result, changes)"
        )
    others = dict(inputs)
    theta = others.pop("theta", None)
    values, spread = _split(machine.units, others)
    design = machine.replace(**values)
    turns = "theta" in program_of((name,)).inputs
    if turns and (theta is None or isinstance(theta, (tuple, list))):
        found = design.peak(name, kind=kind, **({} if theta is None else {"theta": theta}))
        told = f"{WORDS[kind]} of {value_text(found, name, design.units)}"
        told += SIDES.get(found["side"], "")
    else:
        found = _at_a_point(design, name, {"theta": theta} if turns else {})
        told = value_text(found, name, design.units)
    steps = {**spread, **(changes or {})} or _shares(design, found["gradient"])
    title = f"{told}\n{title_of(labelled_inputs(design, [name]), [name])}"
    return plot.tornado(found, steps, name=name, units=design.units, title=title, ax=ax)


def labelled_inputs(design: Any, names: Any) -> Any:
    """A Dataset without values: the inputs of a machine with its units, for a title."""
    given = {key: value for key, value in design.items() if key != "branch"}
    empty = as_dataset(dict.fromkeys(names, 0.0), "theta", {**given, "theta": 0.0})
    named: Any = in_units(empty.drop_vars("theta"), design.units)
    return named.assign_attrs(branch=design.get("branch", 1))


def _split(units: Any, inputs: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, float]]:
    """The values of inputs, and the tolerances of those that have one, in the units of the machine."""
    values: dict[str, Any] = {}
    spread: dict[str, float] = {}
    for name, given in inputs.items():
        rough = isinstance(given, (PlusMinus, Between)) or (
            isinstance(given, str) and PLUS_MINUS.search(given)
        )
        row: Any = (
            read(name, in_si(units, name, given), "uniform", 3.0) if rough and name in INPUTS else given
        )
        if hasattr(row, "tolerance"):
            values[name], spread[name] = (units.of(name).shown(v) for v in (row.mean, row.tolerance))
        else:
            values[name] = row if row is given else units.of(name).shown(row)
    return values, spread


def _at_a_point(design: Any, name: str, theta: Mapping[str, Any]) -> dict[str, Any]:
    """The value and its derivatives by the machine's inputs, as a peak gives them."""
    rows = {p: sensitivity(name, p) for p in design if p != "branch"}
    rows = {p: row for p, row in rows.items() if has(row, "omega" in design)}
    found = design.evaluate([name, *rows.values()], **theta)
    return {"value": found[name], "gradient": {p: found[row] for p, row in rows.items()}, **theta}


def _shares(design: Any, slopes: Mapping[str, Any]) -> dict[str, float]:
    """One percent of each input that a derivative is by; of ec = 0 one of AB."""
    shown = design.in_units()
    sizes = {p: shown[p] for p in slopes if p in shown and not callable(shown[p])}
    if sizes.get("ec") == 0.0:
        sizes["ec"] = shown["AB"]
    return {p: SHARE * abs(size) for p, size in sizes.items() if size}
