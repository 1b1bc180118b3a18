"""Columns of numbers with or without units, from lists, arrays, quantities and files."""

from collections.abc import Mapping, Set
from math import inf, isfinite
from typing import Any, NamedTuple

from ..support.lazy import np
from ..support.shown import shown
from ..units.parse import in_unit, parse_unit
from ..units.scaling import by_digits
from ..units.system import Conversion, conversion
from ..units.text import plain_number

UNORDERED = (str, bytes, bytearray, memoryview, Set, Mapping)  # or no numbers, though they can be iterated


class Column(NamedTuple):
    """Finite numbers in SI units; the unit that they were given in, and whether one of them had none.

    kind  "value", or "pressure" for forces that pressures stand for
    """

    values: list[float]
    unit: str | None = None
    plain: bool = False
    kind: str = "value"


class Written(NamedTuple):
    """Numbers of a file, as an array, and the unit that is written there."""

    values: Any
    unit: str | None


def places_and_values(places: Any, values: Any) -> tuple[Any, Any]:
    """The places and values that are given; of a Series alone its index and its values."""
    if values is None and hasattr(places, "iloc") and getattr(places, "ndim", 0) == 1:
        return places.index, places
    return places, values


def column_of(what: str, given: Any, units: tuple[str, ...], own: Conversion | None) -> Column:
    """Finite numbers in SI units, plain ones from `own`; their unit is one of `units`."""
    said = getattr(given, "attrs", {}).get("units")
    if isinstance(given, Written):
        given, said = given
    if said is not None:
        unit = said if said in units else _same_kind(str(said), units)
        values = getattr(given, "values", given)
        values = values if unit == said else conversion(what, str(said), unit).to_si(values)
        return Column(_finite(what, values.tolist()), unit)
    if hasattr(given, "magnitude"):
        unit, result = _first_that_fits(what, given, units)
        return Column(_finite(what, result.tolist()), unit)
    if isinstance(given, UNORDERED) or not hasattr(given, "__iter__"):
        raise TypeError(f"{what} = {shown(given)}: expected a list or array of numbers")
    elements = given.tolist() if hasattr(given, "tolist") else list(given)
    if any(isinstance(row, (list, tuple)) or getattr(row, "ndim", 0) for row in elements):
        call = what.partition(":")[0]
        raise TypeError(
            f"{what} = {shown(given)}: expected a list or array of numbers, of one dimension; each column is "
            f"an argument of its own, as in desaxe.{call}(*zip(*rows))"
        )
    every = [_with_unit(what, value, units) for value in elements]
    numbers = _finite(what, [number for _, number in every])
    message = next((unit for unit, _ in reversed(every) if unit is not None), None)
    bare = [unit is None and number != 0.0 for (unit, _), number in zip(every, numbers, strict=True)]
    if own is None or not any(bare):  # 0 is 0 in any unit
        return Column(numbers, message, any(bare))
    if message not in (None, units[0]) and own.si != 1:
        raise ValueError(f"{what}: plain numbers, which would be in {own.unit}, beside a text in {message}")
    # As the text of the number would be: the decimal that is written, not the double nearest to it.
    scaled = by_digits(_array(numbers), own.si).tolist()
    values = [si if plain else n for n, si, plain in zip(numbers, scaled, bare, strict=True)]
    return Column(values, message or (units[0] if own.si != 1 else None))


def _with_unit(what: str, value: Any, units: tuple[str, ...]) -> tuple[str | None, Any]:
    """A value and its unit; None for a plain number."""
    if hasattr(value, "magnitude") or (isinstance(value, str) and plain_number(value) is None):
        return _first_that_fits(what, value, units)
    return None, value


def _same_kind(unit: str, units: tuple[str, ...]) -> str:
    """The first of some SI units that measures the same as a unit; the last of them without any."""
    try:
        return next((si for si in units if parse_unit(si).si == parse_unit(unit).si), units[-1])
    except ValueError:
        return units[-1]


def _first_that_fits(what: str, value: Any, units: tuple[str, ...]) -> tuple[str, Any]:
    """The first compatible unit, and the magnitude of a quantity in it."""
    for unit in units[:-1]:
        try:
            return unit, in_unit(what, value, unit)
        except ValueError:
            continue
    return units[-1], in_unit(what, value, units[-1])


def _finite(what: str, values: list[Any]) -> list[float]:
    if {*map(type, values)} == {float} and all(map(isfinite, values)):
        return [*values]
    result = []
    for value in values:
        try:
            number = plain_number(value) if isinstance(value, str) else float(value)
        except OverflowError:
            number = inf
        except (TypeError, ValueError):
            number = None
        if number is None or isinstance(value, (bytes, bytearray)):
            raise TypeError(f"{what}: {shown(value)} is not a number")
        if isinstance(value, bool) or not isfinite(number):
            raise ValueError(f"{what}: {shown(value)}; every one must be a finite number")
        result.append(number)
    return result


def _array(numbers: list[float]) -> Any:
    return np.array(numbers)
