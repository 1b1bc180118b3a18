"""The units of a scene: what its plain numbers mean, so that the rest of it need not know.

Plain numbers become texts with units before a scene is read; of lists, numbers in SI units.
"""

from collections.abc import Mapping
from typing import Any

from ..mechanism.inputs import INPUTS
from ..mechanism.slips import slip
from ..mechanism.unit_system import UnitSystem

SECTIONS = ("mechanism", "motion", "masses", "loads")
ENDS = ("start", "stop", "step")


def units_of(data: Mapping[str, Any]) -> UnitSystem:
    """The units that a scene names: `units = "mm, deg, rpm"` or a table; ValueError where they are none."""
    return UnitSystem.read(data.get("units"))


def with_units(data: Mapping[str, Any], units: UnitSystem) -> dict[str, Any]:
    """The scene with a unit at each plain number that has one."""
    if not units:
        return dict(data)
    return {
        key: value if key in ("units", "quantities") else _part(value, key, units)
        for key, value in data.items()
    }


def _part(value: Any, key: str, units: UnitSystem) -> Any:
    """A table, list or value of a scene, by the key that it stands at."""
    if key in INPUTS:
        return _input(value, key, units)
    if key == "printed" and isinstance(value, Mapping):
        return {name: _printed(part, str(name), units) for name, part in value.items()}
    if isinstance(value, Mapping):
        return {name: _part(part, str(name), units) for name, part in value.items()}
    if isinstance(value, list):
        return [_part(part, "", units) for part in value]
    return value


def _input(value: Any, name: str, units: UnitSystem) -> Any:
    """The values of an input: a number, a list, or a range."""
    if isinstance(value, list):
        return [units.of(name).to_si(float(part)) if _is_number(part) else part for part in value]
    if isinstance(value, Mapping):
        return {key: _input(part, name, units) if key in ENDS else part for key, part in value.items()}
    return _written(value, name, units)


def _written(value: Any, name: str, units: UnitSystem) -> Any:
    """A number with its unit, as a text."""
    conversion = units.of(name)
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
