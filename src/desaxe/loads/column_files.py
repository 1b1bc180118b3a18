"""Columns of files and frames: headings with units, and numbers in SI units."""

import re
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from ..units.parse import is_in_table, parse_unit
from ..units.text import spelled
from .cells import Array, Cells, cells_of
from .columns import Written

# A unit stands at the end of a heading: `Y [mm]`, `Y (mm)`, `Y, mm`, `Y / mm`, `Y in mm`.
_UNITS = tuple(
    map(re.compile, (r"\[([^\]]*)\]", r"\(([^()]*)\)\s*$", r",\s*([^,]*)$", r"\s(?:/|in)\s+(\S.*)$"))
)


class Heading(NamedTuple):
    """The name of a column, and its unit; None without one."""

    name: str
    unit: str | None = None


def heading_of(text: str) -> Heading:
    """The name and the unit of a heading."""
    match = next(filter(None, (pattern.search(text) for pattern in _UNITS)), None)
    if match is None:
        return Heading(text.strip())
    unit = spelled(match[1].strip())
    return Heading(text[: match.start()].strip(), "1" if unit == "-" else unit or None)


class Requested(NamedTuple):
    """A column by its position: name, the unit said for it, the SI units that it may be in."""

    name: str
    unit: str | None
    si_units: tuple[str, ...]


def read_columns(source: Any, requested: Sequence[Requested], least: int = 2) -> list[Written]:
    """The first columns of a file or frame; those behind `least` where they have numbers.

    A unit is that said for a column, else that of its heading, else that of another column of its kind.
    ValueError names file, line, column and remedy.
    """
    cells = cells_of(source)
    headings = _headings(cells)
    values = _complete(cells, [column.name for column in requested], least)
    units = [
        _unit(cells.name, column, [row[index] for row in headings if index < len(row)])
        for index, column in enumerate(requested)
    ]
    alike = {column.si_units: unit for column, unit in zip(requested, units, strict=True) if unit is not None}
    return [
        Written(numbers, unit or alike.get(column.si_units))
        for column, unit, numbers in zip(requested, units, values, strict=False)
    ]


def _complete(cells: Cells, names: Sequence[str], least: int) -> list[Array]:
    """The numbers of the first columns; ValueError for a missing one, but in a last column without any."""
    values = cells.numbers(dict(enumerate(names)))
    while len(values) > least and np.isnan(values[-1]).all():
        values.pop()
    for index, numbers in enumerate(values):
        missing = np.isnan(numbers)
        if missing.any():
            problem = "the cell is empty; every row needs a number"
            cells.refuse(int(missing.argmax()), index, names[index], problem)
    return values


def _headings(cells: Cells) -> list[list[str]]:
    """The last two lines above the first one that begins with a number: a heading, perhaps with units."""
    head = cells.head()
    start = next((index for index, row in enumerate(head) if _has_numbers(cells, row)), None)
    if start is None:
        raise ValueError(f"{cells.name}: no line begins with two numbers, such as 90, -400")
    cells.start = start
    headings = head[max(start - 2, 0) : start] or [[*cells.comment]]
    last = headings[-1]
    if len(last) > 2 and not last[0].strip() and last[1].strip():
        problem = (
            "the first column has no heading, as the index of a frame that was written without index=False"
        )
        raise ValueError(f"{cells.name}: {problem}")
    cells.require_width(max(headings, key=len))
    return [_paired(row, len(head[start])) for row in headings]


def _has_numbers(cells: Cells, row: list[str]) -> bool:
    """True for a row of numbers, of which one may be missing."""
    first, *others = (cells.number(cell) for cell in row[:2])
    return first is not None and any(number is not None and number == number for number in (first, *others))


def _paired(row: list[str], width: int) -> list[str]:
    """The cells of a heading; those of `theta, deg, F_Y, kN` over two columns in pairs."""
    if len(row) == 2 * width > 2 and all(is_in_table(unit) for unit in row[1::2]):
        return [f"{name}, {unit}" for name, unit in zip(row[::2], row[1::2], strict=True)]
    return row


def _unit(file: str, column: Requested, headings: Sequence[str]) -> str | None:
    """The unit of a column: as said, else that of a heading; ValueError if they differ."""
    unit = column.unit
    kinds = [parse_unit(si).si for si in column.si_units]
    for cell in headings:
        written, alone = heading_of(cell).unit, cell.strip()
        if written is None and is_in_table(alone) and parse_unit(alone).si in kinds:
            written = spelled(alone)
        if unit is not None and written is not None and written != spelled(unit):
            raise ValueError(f"{file}: {column.name} = {unit!r}, but its heading is {cell!r}")
        unit = unit if written is None else written
    return unit


def named_columns(
    source: Any, is_place: Callable[[str], bool], is_known: Callable[[str], bool]
) -> dict[Heading, Array]:
    """The columns of a file whose headings name them, NaN where a cell is missing; others are left out.

    is_place  true for a name by which the heading is known; lines above it are left out
    """
    cells = cells_of(source)
    head = cells.head()

    def names_a_place(row: Sequence[str]) -> bool:
        return any(is_place(heading_of(cell).name) for cell in row)

    start = next((index for index, row in enumerate(head) if names_a_place(row)), -1)
    if start < 0 and not names_a_place(cells.comment):
        raise ValueError(f"{cells.name}: no heading such as `theta [deg], a_C [m/s2]` names the columns")
    row, below = head[start] if start >= 0 else [*cells.comment], (head[start + 1 :] or [[]])[0]
    headings = dict(enumerate(map(heading_of, _paired(row, len(below)))))
    headings = {index: heading for index, heading in headings.items() if is_known(heading.name)}
    units = {index: below[index].strip("[]() ") for index in headings if index < len(below)}
    texts = [unit for unit in units.values() if unit]
    cells.start = start + 1
    if texts and all(cells.number(text) is None for text in texts):  # a line of units
        cells.start += 1
        headings = {
            k: Heading(name, unit or spelled(units.get(k, "")) or None)
            for k, (name, unit) in headings.items()
        }
    cells.require_width(row)
    values = cells.numbers({index: heading.name for index, heading in headings.items()})
    return dict(zip(headings.values(), values, strict=True))
