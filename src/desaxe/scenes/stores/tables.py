"""Results as tables, units in the headings: labelled ones, and answers; workbooks (.xlsx) of them."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from itertools import zip_longest
from math import isfinite, isnan, prod
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...evaluation.in_units import Shown, in_units
from ...evaluation.labels import import_xarray
from ...mechanism.quantity_units import SI, UnitSystem, units_by_name
from ...support.answer import Answer
from ...support.extras import needed
from ...support.files import as_path
from ...support.shown import printable, shown
from ...support.written import write_whole

if TYPE_CHECKING:
    import xarray as xr

Sheet = Iterable[Sequence[Any]]  # its headings, then its rows

ROWS, LETTERS = 1_048_576, 32_767  # of a sheet, of a cell
NAME = 31  # letters of a sheet's name
FORBIDDEN = str.maketrans(dict.fromkeys("[]:*?/\\'", "_"))
# Texts stay texts: none of them is taken for a formula, a link or a number.
OPTIONS = {"constant_memory": True, "strings_to_formulas": False, "strings_to_urls": False}


def table_of(dataset: "xr.Dataset") -> Iterator[list[Any]]:
    """The headings, then a row for each point."""
    columns = [dataset[name] for name in (*dataset.dims, *dataset.data_vars)]
    yield [heading(str(column.name), column.attrs.get("units", "")) for column in columns]
    plain = [column.variable for column in columns]
    arrays = [one.values.reshape(-1) for one in import_xarray().broadcast(*map(_unlabelled, plain))]
    yield from ([value.item() for value in row] for row in zip(*arrays, strict=True))


def _unlabelled(variable: Any) -> Any:
    """The array of a variable, without its coordinates."""
    return import_xarray().DataArray(variable.values, dims=variable.dims)


def heading(name: str, unit: str) -> str:
    """A name with its unit."""
    return f"{name} [{unit}]" if unit not in ("", "1") else name


def tables_of(answer: Mapping[Any, Any], units: Any) -> dict[str, list[list[Any]]]:
    """The tables of an answer: a column for each array, a row for each number."""
    rows = [*entries(answer, units)]
    columns = [(heading(name, unit), np.asarray(value)) for name, value, unit in rows if np.ndim(value)]
    numbers = [[name, value, unit] for name, value, unit in rows if not np.ndim(value)]
    tables = {"values": [*_side_by_side(columns)]} if columns else {}
    if numbers or not columns:
        tables["numbers" if columns else "values"] = [["name", "value", "unit"], *numbers]
    return tables


def entries(mapping: Mapping[Any, Any], units: Any, before: str = "") -> Iterator[tuple[str, Any, str]]:
    """Name, value and unit of each number, array and text of nested mappings and lists."""
    for key, part in mapping.items():
        value = part._asdict() if hasattr(part, "_asdict") else part
        name = before + (" ".join(map(str, key)) if isinstance(key, tuple) else str(key))
        unit = units.get(key, "") if isinstance(units, Mapping) else units
        if isinstance(value, Mapping):
            yield from entries(value, unit or {}, f"{name}.")
        elif isinstance(value, (list, tuple)) and not all(type(part) in (int, float) for part in value):
            parts = {f"{name}[{k}]": each for k, each in enumerate(value)}
            yield from entries(parts, dict.fromkeys(parts, unit))
        elif hasattr(value, "magnitude"):
            yield name, _plain(value.magnitude), str(value.units)
        elif "units" in getattr(value, "attrs", {}):
            yield name, value.values, str(value.attrs["units"])
        elif not callable(value) or hasattr(value, "over"):  # a load has a text, a solution has none
            has_unit = isinstance(unit, str) and not isinstance(value, (str, bool)) and unit != "1"
            yield name, _plain(value), unit if has_unit else ""


def _plain(value: Any) -> Any:
    """A number, an array of numbers, or text."""
    if value is None or isinstance(value, (str, bool, int, float)):
        return value
    if isinstance(value, (np.ndarray, np.generic)) and value.dtype.kind in "biuf":
        return value if value.ndim else value.item()
    return np.array(value) if isinstance(value, (list, tuple)) and value else str(value)


def _side_by_side(columns: list[tuple[str, Any]]) -> Iterator[list[Any]]:
    """Columns under their headings: of one shape where they broadcast, else the shorter ones end earlier."""
    heads, arrays = zip(*columns, strict=True)
    with suppress(ValueError):
        arrays = np.broadcast_arrays(*arrays)
    yield [*heads]
    yield from map(list, zip_longest(*(array.reshape(-1).tolist() for array in arrays)))


# ---- workbooks -----------------------------------------------------------------------------------


def to_excel(
    data: Any,
    path: str | PathLike[str],
    *,
    units: str | Mapping[str, str] | UnitSystem | None = None,
    overwrite: bool = False,
) -> Path:
    """Write a result as an Excel workbook; returns its path (extra `excel`).

    data   a Dataset, as `grid`, `sweep`, `design_map` and scenes give it: a row for each point, a column for
           each dimension and name, and a sheet with the inputs and where it comes from. Or a dict, as
           `evaluate`, `peak`, `drive` and the others give it: arrays are columns, numbers have a row each
    path   the file, .xlsx
    units  such as "mm, deg, rpm": those that an answer in SI units is written in, or that the numbers of a
           plain dict are in; SI units without

    Numbers have 16 digits; NaN is an empty cell, infinity the text inf. The file appears whole or
    not at all. Raises FileExistsError for a file that desaxe did not write, unless `overwrite`; ValueError
    for more points than a sheet has rows.
    """
    place = as_path("path", path)
    if place.suffix.lower() != ".xlsx":
        raise ValueError(f"{printable(path)}: a workbook is written as .xlsx")
    if hasattr(data, "to_dataset") and hasattr(data, "dims"):
        data = data.to_dataset(name=data.name or "value")
    sheets = sheets_of({"values": data}) if hasattr(data, "data_vars") else _sheets_of_answer(data, units)
    with write_whole(place, overwrite) as staged:
        write_workbook(staged, sheets)
    return place


def _sheets_of_answer(data: Any, units: Any) -> Mapping[str, Sheet]:
    if not isinstance(data, Mapping):
        raise TypeError(f"to_excel: expected a Dataset or a dict of answers, got {shown(data)}")
    answer = data if isinstance(data, Answer) else Answer(data, _units_by_name)
    system = answer.system or SI
    if units is not None and not answer.system:
        system = UnitSystem.read(units)
        answer = (
            in_units(answer, system) if answer is data else Answer(data, Shown(system).texts(answer.units))
        )
    inputs = {n: v if callable(v) else system.of(n).shown(v) for n, v in answer.inputs.items()}  # in SI units
    tables = tables_of({**inputs, **answer}, {**{n: system.of(n).unit for n in inputs}, **answer.units})
    for name, rows in tables.items():
        require_room(name, len(rows) - 1)
    return tables


def _units_by_name(mapping: Mapping[Any, Any]) -> dict[Any, Any]:
    """The units of a plain dict, also of dicts inside, by names that say what they are."""
    units = units_by_name({key: value for key, value in mapping.items() if not isinstance(value, Mapping)})
    inside = {key: part for key, part in mapping.items() if isinstance(part, Mapping) and key != "gradient"}
    return {**units, **{key: _units_by_name(part) for key, part in inside.items()}}


def write_workbook(path: Path, sheets: Mapping[str, Sheet]) -> None:
    """Write sheets of rows, the first of each being its headings; OSError where the file cannot be written.

    Numbers have 16 digits. What has no value, NaN or None, is an empty cell; an infinite number is the text
    inf.
    """
    with needed("an .xlsx file"):
        from xlsxwriter import Workbook
        from xlsxwriter.exceptions import XlsxFileError
    book = Workbook(str(path), {**OPTIONS, "tmpdir": str(path.parent)})
    book.set_properties({"author": "desaxe"})
    bold, taken = book.add_format({"bold": True}), set[str]()
    try:
        for name, rows in sheets.items():
            sheet = book.add_worksheet(_free_name(name, taken))
            sheet.freeze_panes(1, 0)
            for number, row in enumerate(rows):
                for column, head in enumerate(() if number else row):
                    sheet.set_column(column, column, min(max(len(str(head)) + 2, 12), 40))
                sheet.write_row(number, 0, map(_cell, row), None if number else bold)
        book.close()
    except XlsxFileError as error:
        raise OSError(f"not written: {error}") from error
    finally:
        book.fileclosed = True  # else what is left of a book that failed is written when it is collected


def sheets_of(parts: "Mapping[str, xr.Dataset]") -> dict[str, Sheet]:
    """The sheets of labelled results: one for each, and what they are about."""
    for name, part in parts.items():
        require_room(name, prod(part.sizes.values()))
    return {**{name: table_of(part) for name, part in parts.items()}, "about": _about(parts)}


def require_room(what: str, points: int) -> None:
    """ValueError for more points than a sheet has rows."""
    if points >= ROWS:
        raise ValueError(f"{what}: {points} rows, a sheet of .xlsx holds {ROWS}; .csv, .nc, .zarr or .npz do")


def _about(parts: "Mapping[str, xr.Dataset]") -> Iterator[list[Any]]:
    """The origin of each sheet: the inputs that have one value, and the attributes."""
    yield ["sheet", "name", "value", "unit", "meaning"]
    for sheet, part in parts.items():
        scalars = {name: one for name, one in part.coords.items() if one.ndim == 0}
        for name, one in {**scalars, **part.data_vars}.items():
            value = one.item() if name in scalars else None
            yield [sheet, name, value, one.attrs.get("units", ""), one.attrs.get("long_name", "")]
        for key, value in part.attrs.items():
            yield [sheet, key, value if isinstance(value, (int, float)) else str(value), "", ""]


def _cell(value: Any) -> Any:
    """A value as a cell takes it."""
    if isinstance(value, float) and not isfinite(value):
        return None if isnan(value) else str(value)
    return value if value is None or isinstance(value, (int, float)) else str(value)[:LETTERS]


def _free_name(name: str, taken: set[str]) -> str:
    """A name for a sheet: short, without what Excel forbids, unlike the others in small letters too."""
    plain = name.translate(FORBIDDEN) or "sheet"
    free, count = plain[:NAME], 1
    while free.lower() in taken:
        count += 1
        free = f"{plain[: NAME - len(str(count)) - 1]}_{count}"
    taken.add(free.lower())
    return free
