"""Units of the numbers of answers: texts that know what they are the unit of, for any unit system."""

from collections.abc import Iterable, Mapping
from functools import lru_cache
from typing import Any

from .own import register
from .unit_system import SI, Conversion, UnitSystem

PLAIN = Conversion("1")


class Of(str):
    """The SI unit of a quantity, an input or a measure, or of its derivative by another one."""

    name: str = ""
    by: str = ""


def unit_of(name: Any, by: Any = "") -> Of:
    """The unit of a name, or of a measure such as ("absmax", "a_C"); "1" where there is none."""
    told = [part[-1] if isinstance(part, (tuple, list)) else part for part in (name, by)]
    return (_unit_of if register().rows else _remembered_unit)(
        *(p if isinstance(p, str) else "" for p in told)
    )


def _unit_of(name: str, by: str) -> Of:
    unit = Of(_conversion(SI, name, by).unit)
    unit.name, unit.by = name, by
    return unit


_remembered_unit = lru_cache(maxsize=4096)(_unit_of)  # where no quantity of a user's own can change it


def units_of(names: Iterable[str]) -> dict[str, Of]:
    """The units of answers whose keys are the names of what they are."""
    return {name: unit_of(name) for name in names}


def units_by_name(found: Mapping[Any, Any]) -> dict[Any, Any]:
    """The units of an answer whose keys are the names of what they are, those of `gradient` too."""
    known = [key for key in found if isinstance(key, str) and _has_unit(key)]
    units: dict[Any, Any] = units_of(known)
    if "gradient" in found:
        units["gradient"] = {name: slopes_of(name, slopes) for name, slopes in found["gradient"].items()}
    return units


def _has_unit(key: str) -> bool:
    return (_is_known if register().rows else _remembered_to_be_known)(key)


def _is_known(key: str) -> bool:
    return key != "status" and SI.find(key) is not None


_remembered_to_be_known = lru_cache(maxsize=4096)(_is_known)


def units_of_extreme(name: str, found: Mapping[Any, Any]) -> dict[str, Any]:
    """The units of an extreme value of a quantity, where it is reached, and its gradient."""
    return {
        "value": unit_of(name),
        "theta": unit_of("theta"),
        "gradient": slopes_of(name, found["gradient"]),
    }


def slopes_of(name: Any, parameters: Iterable[Any]) -> dict[Any, Of]:
    """The units of the derivatives of a quantity by some parameters."""
    return {parameter: unit_of(name, parameter) for parameter in parameters}


def conversion_of(unit: str, system: UnitSystem) -> Conversion:
    """The conversion of numbers in this SI unit; that of the quantity itself where the unit knows it."""
    if not isinstance(unit, Of):
        return system.of_unit(unit)
    if register().rows:
        return _conversion(system, unit.name, unit.by)
    known = system.remembered.get((unit.name, unit.by))
    if known is None:
        known = system.remembered[unit.name, unit.by] = _conversion(system, unit.name, unit.by)
    return known


def _conversion(system: UnitSystem, name: str, by: str) -> Conversion:
    own = system.find(name) if name else None
    per = system.find(by) if by else None
    return (own or PLAIN) if per is None else (own or PLAIN).per([per])
