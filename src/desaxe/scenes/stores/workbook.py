"""Workbooks (.xlsx): sheets of rows, units in the headings (extra `excel`)."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import isfinite, isnan, prod
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...evaluation.in_units import Shown, in_units
from ...mechanism.quantity_units import SI, UnitSystem, units_by_name
from ...support.answer import Answer
from ...support.extras import needed
from ...support.files import as_path
from ...support.shown import printable, shown
from ...support.written import write_whole
from .tables import table_of, tables_of

if TYPE_CHECKING:
    import xarray as xr

ROWS, COLUMNS, LETTERS = 1_048_576, 16_384, 32_767  # of a sheet, of a cell
NAME = 31  # letters of a sheet's name
FORBIDDEN = str.maketrans(dict.fromkeys("[]:*?/\\'", "_"))
# Texts stay texts: none of them is taken for a formula, a link or a number.
OPTIONS = {"constant_memory": True, "strings_to_formulas": False, "strings_to_urls": False}

Sheet = Iterable[Sequence[Any]]  # its headings, then its rows


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

    Numbers have 16 digits; NaN is an empty cell, an infinite number the text inf. The file appears whole or
    not at all. Raises FileExistsError for one that desaxe did not write, unless `overwrite`; ValueError for
    more points than a sheet has rows.
    """
    place = as_path("path", path)
    if place.suffix.lower() != ".xlsx":
        raise ValueError(f"{printable(path)}: a workbook is written as .xlsx")
    sheets = _sheets_of_result(data, units)
    with write_whole(place, overwrite) as staged:
        write_workbook(staged, sheets)
    return place


def _sheets_of_result(data: Any, units: Any) -> Mapping[str, Sheet]:
    if hasattr(data, "data_vars"):
        return sheets_of(data, {})
    if hasattr(data, "to_dataset") and hasattr(data, "dims"):
        return sheets_of(data.to_dataset(name=data.name or "value"), {})
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
            _fill(sheet, rows, bold)
        book.close()
    except XlsxFileError as error:
        raise OSError(f"not written: {error}") from error
    finally:
        book.fileclosed = True  # else what is left of a book that failed is written when it is collected


def _fill(sheet: Any, rows: Sheet, bold: Any) -> None:
    for place, row in enumerate(rows):
        for column, value in enumerate(row):
            if place == 0:
                sheet.set_column(column, column, min(max(len(str(value)) + 2, 12), 40))
            _cell(sheet, place, column, value, None if place else bold)


def sheets_of(values: "xr.Dataset | None", groups: "Mapping[str, xr.Dataset]") -> dict[str, Sheet]:
    """The sheets of labelled results: one for each, and what they are about."""
    parts = {**({} if values is None else {"values": values}), **groups}
    for name, part in parts.items():
        require_room(name, prod(part.sizes.values()))
    sheets: dict[str, Sheet] = {name: table_of(part) for name, part in parts.items()}
    return {**sheets, "about": _about(parts)}


def require_room(what: str, points: int) -> None:
    """ValueError for more points than a sheet has rows."""
    if points >= ROWS:
        raise ValueError(f"{what}: {points} rows, a sheet of .xlsx holds {ROWS}; .csv, .nc, .zarr or .npz do")


def _about(parts: "Mapping[str, xr.Dataset]") -> Iterator[list[Any]]:
    """The origin of each sheet: the inputs that have one value, and the attributes."""
    yield ["sheet", "name", "value", "unit", "meaning"]
    for sheet, part in parts.items():
        for name, one in part.coords.items():
            if one.ndim == 0:
                about = one.attrs
                yield [sheet, name, one.item(), about.get("units", ""), about.get("long_name", "")]
        for name, one in part.data_vars.items():
            yield [sheet, name, None, one.attrs.get("units", ""), one.attrs.get("long_name", "")]
        for key, value in part.attrs.items():
            yield [sheet, key, value if isinstance(value, (int, float)) else str(value), "", ""]


def _cell(sheet: Any, row: int, column: int, value: Any, form: Any) -> None:
    if value is None or value == "":
        return
    if isinstance(value, bool):
        sheet.write_boolean(row, column, value, form)
    elif isinstance(value, (int, float)) and isfinite(value):
        sheet.write_number(row, column, value, form)
    elif not (isinstance(value, float) and isnan(value)):
        sheet.write_string(row, column, str(value)[:LETTERS], form)


def _free_name(name: str, taken: set[str]) -> str:
    """A name for a sheet: short, without what Excel forbids, unlike the others in small letters too."""
    plain = name.translate(FORBIDDEN) or "sheet"
    found, count = plain[:NAME], 1
    while found.lower() in taken:
        count += 1
        found = f"{plain[: NAME - len(str(count)) - 1]}_{count}"
    taken.add(found.lower())
    return found
