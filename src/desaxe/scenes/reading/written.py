"""Units in the texts of a scene, and slips of units in its plain numbers."""

from collections.abc import Iterator, Mapping
from typing import Any

from ...mechanism.inputs import INPUTS
from ...mechanism.quantity_units import SI, UnitSystem
from ...mechanism.slips import slip
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


def slips_of(data: Mapping[str, Any], units: UnitSystem) -> list[str]:
    """Warnings about plain numbers of the scene that are almost surely slips of a unit."""
    found = []
    for section in SECTIONS:
        values = data.get(section)
        for name, value in values.items() if isinstance(values, Mapping) else ():
            ends = [value.get(end) for end in ENDS[:2]] if isinstance(value, Mapping) else [value]
            found += [told for end in ends if (told := slip(str(name), end, units))]
    return found


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
