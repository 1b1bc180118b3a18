"""The inputs of a scene as they are written, and the units of its texts."""

from collections.abc import Iterator, Mapping
from typing import Any

from ...mechanism.inputs import INPUTS
from ...mechanism.quantity_units import SI, UnitSystem
from ...mechanism.ranges import Between
from ...units.system import DIMENSIONS
from ...units.text import split_quantity
from ..schema import SECTIONS

ENDS = ("start", "stop", "step")
WORDS = ("printed", "quantities", "reduce")  # tables whose texts are no values of inputs
# What the text of an input says of all quantities of its dimension; a rate does not follow the lengths.
SHARED = {
    si: name
    for name, si in DIMENSIONS.items()
    if name in ("length", "angle", "angular speed", "mass", "force")
}
RATES = {name: DIMENSIONS[name] for name in ("velocity", "acceleration", "jerk")}


def written_inputs(data: Mapping[str, Any]) -> dict[str, Any]:
    """The inputs as the scene has them, of a range its ends: what slips of units are looked for in."""
    pairs = [pair for section in SECTIONS for pair in data.get(section, {}).items()]
    return {
        name: Between(value.get("start"), value.get("stop")) if isinstance(value, Mapping) else value
        for name, value in pairs
    }


def units_written(data: Mapping[str, Any]) -> UnitSystem:
    """The units that the texts of a scene are written in: "60 mm" says mm of ec, and of lengths at all.

    The first text of an input counts. Velocities, accelerations and sensitivities stay in SI units.
    """
    found: dict[str, str] = {}
    for name, unit in _written_units(data):
        found.setdefault(name, unit)
        dimension = SHARED.get(INPUTS[name].unit)
        if dimension is not None:
            found.setdefault(dimension, unit)
    return UnitSystem(UnitSystem.read({**RATES, **found}).units, quotients=False) if found else SI


def _written_units(part: Any, key: str = "") -> Iterator[tuple[str, str]]:
    """Input and unit of every text of an input, in the order in which they stand in the scene."""
    if isinstance(part, Mapping):
        for name, value in part.items():
            if name not in WORDS:
                yield from _written_units(value, key if name in ENDS else str(name))
    elif isinstance(part, list):
        for value in part:
            yield from _written_units(value, key)
    elif isinstance(part, str) and key in INPUTS and part.strip()[:1] in "+-.0123456789":
        unit = split_quantity(part)[1]
        if unit:
            yield key, unit
