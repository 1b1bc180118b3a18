"""Columns of numbers with or without units, from lists, arrays, quantities and files."""

import re
from collections.abc import Mapping, Sequence, Set
from fractions import Fraction
from math import inf, isfinite
from os import PathLike
from typing import Any, NamedTuple

from ..support.files import as_path, read_bytes
from ..support.shown import printable, shown
from ..units.parse import in_unit
from ..units.pint_units import registry
from ..units.system import Conversion
from ..units.text import plain_number, spelled

UNORDERED = (str, bytes, bytearray, memoryview, Set, Mapping)  # or no numbers, though they can be iterated
MOST_BYTES = 100_000_000  # of a file
UNIT_OF_HEADING = re.compile(r"\[([^\]]*)\]")


class Column(NamedTuple):
    """Finite numbers in SI units; the unit that they were given in, and whether one of them had none."""

    values: list[float]
    unit: str | None = None
    plain: bool = False


def places_and_values(places: Any, values: Any) -> tuple[Any, Any]:
    """The places and values that are given; of a Series alone its index and its values."""
    if values is None and hasattr(places, "iloc") and getattr(places, "ndim", 0) == 1:
        return places.index, places
    return places, values


def column_of(what: str, given: Any, units: tuple[str, ...], own: Conversion | None) -> Column:
    """Finite numbers in SI units, plain ones from `own`; their unit is one of `units`."""
    said = getattr(given, "attrs", {}).get("units")
    if said in units:
        return Column(_finite(what, given.values.tolist()), said)
    if said is not None:
        given = registry().Quantity(given.values, said)
    if hasattr(given, "magnitude"):
        unit, found = _first_that_fits(what, given, units)
        return Column(_finite(what, found.tolist()), unit)
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
    told = next((unit for unit, _ in reversed(every) if unit is not None), None)
    bare = [unit is None and number != 0.0 for (unit, _), number in zip(every, numbers, strict=True)]
    if own is None or not any(bare):  # 0 is 0 in any unit
        return Column(numbers, told, any(bare))
    if told not in (None, units[0]) and own.si != 1:
        raise ValueError(f"{what}: plain numbers, which would be in {own.unit}, beside a text in {told}")
    # As the text of the number would be: the decimal that is written, not the double nearest to it.
    scaled = [
        float(Fraction(repr(n)) * own.si) if plain else n for n, plain in zip(numbers, bare, strict=True)
    ]
    return Column(scaled, told or (units[0] if own.si != 1 else None))


def _with_unit(what: str, value: Any, units: tuple[str, ...]) -> tuple[str | None, Any]:
    """A value and its unit; None for a plain number."""
    if hasattr(value, "magnitude") or (isinstance(value, str) and plain_number(value) is None):
        return _first_that_fits(what, value, units)
    return None, value


def _first_that_fits(what: str, value: Any, units: tuple[str, ...]) -> tuple[str, Any]:
    """The first compatible unit, and the magnitude of a quantity in it."""
    for unit in units[:-1]:
        try:
            return unit, in_unit(what, value, unit)
        except ValueError:
            continue
    return units[-1], in_unit(what, value, units[-1])


def _finite(what: str, values: list[Any]) -> list[float]:
    found = []
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
        found.append(number)
    return found


# ---- files ------------------------------------------------------------------------------------------


def unit_of_column(
    path: str | PathLike[str], name: str, given: str | None, heading: Sequence[str]
) -> str | None:
    """The unit of a column: as given, else in brackets in its heading; ValueError if they differ."""
    for cell in heading:
        found = UNIT_OF_HEADING.search(cell)
        unit = spelled(found[1].strip()) if found else given
        if given is not None and unit is not None and unit != spelled(given):
            raise ValueError(f"{printable(path)}: {name} = {given!r}, but its heading is {cell!r}")
        given = unit
    return given


def rows_of(path: str | PathLike[str], least: int) -> tuple[list[str], list[list[str]]]:
    """The cells of the heading, and those of the lines that have numbers.

    ValueError names the line that has none.
    """
    try:
        text = read_bytes(as_path("path", path), MOST_BYTES).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise ValueError(f"{printable(path)}: not a text in UTF-8") from None
    except ValueError as error:
        raise ValueError(f"{shown(path)}: {error}") from None
    rows: list[list[str]] = []
    heading: list[str] = []
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        mark = next((mark for mark in (";", "\t", ",") if mark in line), None)
        cells = [cell.strip() for cell in line.split(mark)]
        if len(cells) >= least and all(plain_number(cell) is not None for cell in cells[:least]):
            rows.append([cell for cell in cells if cell])
        elif rows or heading:
            raise ValueError(
                f"{printable(path)}, line {number}: expected {least} or more numbers, such as 90, -400"
            )
        else:
            heading = cells
    if not rows:
        raise ValueError(f"{printable(path)}: no line has {least} numbers")
    return heading, rows


def column_of_file(
    what: str,
    rows: Sequence[Sequence[str]],
    index: int,
    unit: str | None,
    units: tuple[str, ...],
    own: Conversion | None,
) -> Column:
    """A column of a file, in the unit that is said or else in `own`."""
    cells = [row[index] for row in rows]
    if unit in units:
        return Column(_finite(what, cells), unit)
    numbers = cells if unit is None else [f"{number!r} {unit}" for number in _finite(what, cells)]
    return column_of(what, numbers, units, own)
