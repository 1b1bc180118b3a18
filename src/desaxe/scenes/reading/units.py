"""The units of a scene: what its plain numbers mean, and which units its texts are written in.

Plain numbers become texts with units before a scene is read; of lists, numbers in SI units. The units of its
texts are those of its report and its pictures where it names none.
"""

from collections.abc import Iterator, Mapping
from typing import Any

from ...mechanism.inputs import INPUTS
from ...mechanism.quantity_units import SI, UnitSystem
from ...mechanism.slips import slip
from ...units.system import DIMENSIONS
from ...units.text import split_quantity, with_unit_of
from ..schema import SECTIONS

ENDS = ("start", "stop", "step")
# A load over a place, whose points may stand in the scene: the key of their unit, and what they are.
TABLES = {"over_theta": "theta", "over_Y": "Y", "over_stroke": "distance"}
PLACES = {"distance": "Y"}
WORDS = ("printed", "quantities", "reduce")  # tables whose texts are no values of inputs
MOTOR = ("torque", "flywheel_inertia")  # of [steady]
# What the text of an input says of all quantities of its dimension; a rate does not follow the lengths.
SHARED = {
    si: name
    for name, si in DIMENSIONS.items()
    if name in ("length", "angle", "angular speed", "mass", "force")
}
RATES = {name: DIMENSIONS[name] for name in ("velocity", "acceleration", "jerk")}


def units_of(data: Mapping[str, Any]) -> UnitSystem:
    """The units that a scene names: `units = "mm, deg, rpm"` or a table; ValueError where they are none."""
    return UnitSystem.read(data.get("units"))


def with_units(data: Mapping[str, Any], units: UnitSystem) -> dict[str, Any]:
    """The scene with a unit attached to each plain number of a quantity with a unit."""
    if not units:
        return dict(data)
    return {
        key: value if key in ("units", "quantities") else _part(value, key, units)
        for key, value in data.items()
    }


def _part(value: Any, key: str, units: UnitSystem) -> Any:
    """A table, list or value of a scene, by the key that it stands at."""
    if key in INPUTS or key in MOTOR:
        return _input(value, key, units)
    if key == "printed" and isinstance(value, Mapping):
        return {name: _printed(part, str(name), units) for name, part in value.items()}
    if isinstance(value, Mapping):
        return {name: _part(part, str(name), units) for name, part in value.items()}
    if isinstance(value, list):
        return [_part(part, "", units) for part in value]
    return value


def _input(value: Any, name: str, units: UnitSystem) -> Any:
    """The values of an input: a number, a list, a range, or a load that varies with the motion."""
    if isinstance(value, list):
        own = units.of(name)
        return [own.to_si(float(p)) if _is_number(p) else with_unit_of(f"1 {own.unit}", p) for p in value]
    if isinstance(value, Mapping):
        along = next((place for key, place in TABLES.items() if isinstance(value.get(key), list)), None)
        if along is not None:
            return _table(value, name, along, units)
        return {key: _input(part, name, units) if key in ENDS else part for key, part in value.items()}
    return _written(value, name, units)


def _table(load: Mapping[str, Any], name: str, along: str, units: UnitSystem) -> dict[str, Any]:
    """The points of a load over theta or Y; a unit that stands beside them holds for all of a column."""

    def column(number: Any, index: int) -> Any:
        its, beside = (PLACES.get(along, along), along) if index == 0 else (name, "value")
        return number if load.get(beside) is not None else _written(number, its, units)

    def points(key: str, rows: Any) -> Any:
        index = 0 if key in TABLES else 1
        if not isinstance(rows, list):
            plain = key == "period" and load.get(along) is None
            return _written(rows, along, units) if plain else rows
        return [
            [column(number, place) for place, number in enumerate(row)]
            if isinstance(row, list)
            else column(row, index)
            for row in rows
        ]

    return {key: points(key, part) for key, part in load.items()}


def _written(value: Any, name: str, units: UnitSystem) -> Any:
    """A number with its unit, as a text; a text that is a number alone has the same unit."""
    conversion = units.of(name)
    if isinstance(value, str):
        return with_unit_of(f"1 {conversion.unit}", value)
    return f"{value!r} {conversion.unit}" if _is_number(value) and conversion.si != 1 else value


def _printed(value: Any, name: str, units: UnitSystem) -> Any:
    """A printed number of a quantity; what is no quantity is left to the reader of the scene."""
    try:
        return _written(value, name, units)
    except ValueError:
        return value


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


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
