"""Workbooks (.xlsx): sheets of rows, units in the headings (extra `excel`)."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import isfinite, isnan, prod
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...support.extras import needed
from .tables import table_of

if TYPE_CHECKING:
    import xarray as xr

ROWS, COLUMNS, LETTERS = 1_048_576, 16_384, 32_767  # of a sheet, of a cell
NAME = 31  # letters of a sheet's name
FORBIDDEN = str.maketrans(dict.fromkeys("[]:*?/\\'", "_"))
# Texts stay texts: none of them is taken for a formula, a link or a number.
OPTIONS = {"constant_memory": True, "strings_to_formulas": False, "strings_to_urls": False}

Sheet = Iterable[Sequence[Any]]  # its headings, then its rows


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
