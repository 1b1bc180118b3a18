"""Numbers of columns from tables as spreadsheets, loggers and oscilloscopes write them, and from frames.

Columns of a text stand between semicolons, tabs, blanks or commas, whichever gives numbers; a decimal comma
is read where they do not stand between commas. Lines that begin with # are comments. An empty cell stays in
its column.
"""

import csv
import io
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from itertools import islice, takewhile
from math import inf, nan
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from ..support.extras import MissingExtraError, explained
from ..support.files import as_path, read_bytes
from ..support.forks import IMPORTS
from ..support.shown import printable, shown
from ..units.text import plain_number

MOST_BYTES = 100_000_000  # of a file
SHEETS = {".xlsx": "openpyxl", ".xlsm": "openpyxl", ".xls": "xlrd", ".ods": "odf"}  # what reads them
MISSING = frozenset(("", "nan", "na", "<na>", "n/a", "#n/a", "nat", "none", "null", "-", "--"))
DECIMAL_COMMA = "a decimal comma needs semicolons or tabs between the columns"
_BATCH = 2_000  # rows at once, which a processor's cache holds
_SAMPLE = 60  # lines by which the separator is known
_SEPARATORS = (";", "\t", " ", ",")
_NUMBER = re.compile(r"[-+]?(?:\d+(?:[.,]\d*)?|\.\d+)(?:[eE][-+]?\d+)?", re.ASCII)
_IN_BRACKETS = re.compile(r"[\[(][^\])]*[\])]")
_BEFORE_BRACKETS = re.compile(r"(?<=[^\s\])])\s+(?=[\[(])")
_QUOTED = re.compile(r'"[^"]*"')
_SPEC = re.compile(r'"?sep=(.)"?\s*', re.IGNORECASE)  # the first line of some spreadsheets
Array = NDArray[np.float64]
Row = tuple[int, list[str]]  # the number of its line, and its cells


@dataclass
class Cells:
    """The rows of a table that are not empty.

    name     of the file, or "data"
    unit     what rows are counted in: "line" or "row"
    comment  the last line of the comment at the beginning, which may be a heading
    start    index of the first row below the headings
    """

    name: str
    rows: Callable[[], Iterable[Row]]
    unit: str = "line"
    decimal_comma: bool = False
    comment: Sequence[str] = ()
    start: int = 0
    _mark: str = ""  # the decimal mark of the file, once a number has one

    def head(self, most: int = 1000) -> list[list[str]]:
        """The cells of the first rows."""
        return [cells for _, cells in islice(self.rows(), most)]

    def require_width(self, heading: Sequence[str]) -> None:
        """ValueError for a line with more cells than the heading, as decimal commas between commas make."""
        numbers = [self.number(cell) for cell in heading if cell.strip()]
        if self.decimal_comma or len(numbers) < 2 or any(number is not None for number in numbers):
            return  # a line above the columns
        for index, row in enumerate(self.head()[self.start :]):
            beyond = next((k for k, cell in enumerate(row) if k >= len(heading) and cell.strip()), None)
            if beyond is not None:
                problem = f"the heading has {len(heading)} columns: name every one; {DECIMAL_COMMA}"
                self.refuse(index, beyond, "no heading", problem)

    def number(self, cell: str) -> float | None:
        """The number of a cell, NaN of a missing one; None for anything else."""
        text = cell.strip()
        if text.lower() in MISSING:
            return nan
        number = plain_number(text.replace(",", ".") if self.decimal_comma else text)
        return None if number is None or abs(number) == inf else number

    def numbers(self, columns: Mapping[int, str]) -> list[Array]:
        """The numbers of columns below the headings, NaN where a cell is missing.

        columns  index -> name, for messages. ValueError that names file, line, column and remedy for a cell
                 that is no number
        """
        parts: list[list[Array]] = [[np.empty(0)] for _ in columns]
        rows = islice(self.rows(), self.start, None)
        first = 0
        while batch := list(islice(rows, _BATCH)):
            for part, (column, name) in zip(parts, columns.items(), strict=True):
                cells = [row[column] if column < len(row) else "" for _, row in batch]
                part.append(self._numbers(cells, first, column, name))
            first += len(batch)
        return [np.concatenate(part) for part in parts]

    def refuse(self, index: int, column: int, name: str, problem: str) -> NoReturn:
        """Raise ValueError that names the file, the line and the column of a cell, by its row's index."""
        line, _ = next(islice(self.rows(), self.start + index, None))
        raise ValueError(f"{self.name}, {self.unit} {line}, column {column + 1} ({name}): {problem}")

    def _numbers(self, cells: list[str], first: int, column: int, name: str) -> Array:
        joined = "\0".join(cells)
        if self.decimal_comma:
            self._require_one_mark(joined, cells, first, column, name)
            joined = joined.replace(",", ".")
        if joined.isascii() and "_" not in joined:
            try:
                numbers = np.fromiter(map(float, joined.split("\0")), float, len(cells))
            except ValueError:
                pass
            else:
                if np.isfinite(numbers).all():
                    return numbers
        result = [self.number(cell) for cell in cells]
        if None in result:
            index = result.index(None)
            problem = f"{shown(cells[index].strip())} is not a finite number; {_remedy(cells[index])}"
            self.refuse(first + index, column, name, problem)
        return np.array(result, float)

    def _require_one_mark(self, joined: str, cells: list[str], first: int, column: int, name: str) -> None:
        """ValueError for numbers with a decimal point beside some with a decimal comma."""
        for mark in (mark for mark in ",." if mark in joined):
            self._mark = self._mark or mark
            if mark != self._mark:
                index = next(k for k, cell in enumerate(cells) if mark in cell)
                problem = f"{shown(cells[index])} beside numbers with {self._mark!r}; write one decimal mark"
                self.refuse(first + index, column, name, problem)


def _remedy(cell: str) -> str:
    """Return what to write in place of a cell that is no number."""
    if re.search(r"\d[.,' \u00a0\u202f]\d{3}(?!\d)", cell):
        return "write it without marks between thousands"
    if re.search(r"\d,\d", cell):
        return DECIMAL_COMMA
    return "write a number such as 12.5, without a unit"


def cells_of(source: Any) -> Cells:
    """The cells of a text file, of the first sheet of a workbook, or of a frame."""
    if hasattr(source, "columns"):
        return _cells_of_frame(source)
    path = as_path("path", source)
    return _cells_of_sheet(path) if path.suffix.lower() in SHEETS else _cells_of_text(path)


def _cells_of_frame(frame: Any) -> Cells:
    """The columns of a frame of pandas or polars."""
    names = [str(name) for name in frame.columns]
    columns = [np.asarray(frame[name]) for name in frame.columns]
    if any(column.ndim != 1 for column in columns):
        raise ValueError(f"data: two columns of one name in {shown(names)}")
    rows = [names, *(list(map(str, row)) for row in zip(*(c.tolist() for c in columns), strict=True))]
    return Cells("data", lambda: enumerate(rows), "row")


def _cells_of_text(path: Path) -> Cells:
    name = printable(path)
    text = _decoded(path, name)
    spec = _SPEC.match(text)
    separator = spec[1] if spec else _separator(text)

    def cells(lines: Iterable[str]) -> Iterator[Row]:
        if separator == " ":
            lines = (_with_single_blanks(line) for line in lines)
        reader = csv.reader(lines, delimiter=separator, skipinitialspace=True)
        try:
            for row in reader:
                if any(map(str.strip, row)) and not (spec and reader.line_num == 1):
                    yield reader.line_num, row
        except csv.Error as error:
            raise ValueError(f"{name}, line {reader.line_num}: {error}") from None

    def rows() -> Iterator[Row]:
        lines: Iterable[str] = io.StringIO(text, newline=None)
        if "#" in text:  # an empty line is counted, too
            lines = ("\n" if line.lstrip().startswith("#") else line for line in lines)
        return cells(lines)

    leading = [*takewhile(lambda line: line.startswith("#"), io.StringIO(text, newline=None))]
    comment = next((row for _, row in cells([leading[-1].lstrip("# ")])), []) if leading else []
    return Cells(name, rows, decimal_comma=separator != ",", comment=comment)


def _decoded(path: Path, name: str) -> str:
    try:
        data = read_bytes(path, MOST_BYTES)
    except ValueError as error:
        raise ValueError(f"{shown(str(path))}: {error}") from None
    wide = data.startswith((b"\xff\xfe", b"\xfe\xff"))
    for encoding in ("utf-16",) if wide else ("utf-8-sig", "cp1252"):
        try:
            text = data.decode(encoding)
        except UnicodeDecodeError:
            continue
        if "\0" not in text:
            return text
    raise ValueError(f"{name}: not a text; save the table as a text in UTF-8, with ; or , between columns")


def _separator(text: str) -> str:
    """The separator with which most lines have two numbers; of several the first."""
    lines = (_QUOTED.sub("0", line) for line in io.StringIO(text, newline=None))
    sample = [
        *islice((line for line in lines if line.strip() and not line.lstrip().startswith("#")), _SAMPLE)
    ]
    counts = {mark: sum(_has_two_numbers(line, mark) for line in sample) for mark in _SEPARATORS}
    if not any(counts.values()):
        counts = {mark: sum(line.count(mark) for line in sample) for mark in (";", "\t", ",")}
    return max(counts, key=lambda mark: counts[mark])


def _has_two_numbers(line: str, separator: str) -> bool:
    cells = line.split(None if separator == " " else separator)
    if separator == " " and any(cell.startswith(",") or cell.endswith((",", ";")) for cell in cells):
        return False
    numbers = [cell for cell in cells if _NUMBER.fullmatch(cell.strip())]
    return len(numbers) > 1


def _with_single_blanks(line: str) -> str:
    """A line of columns with blanks between them; those of a unit in brackets go: `T[N*m]`."""
    if "[" in line or "(" in line:
        line = _IN_BRACKETS.sub(lambda match: "*".join(match[0].split()), line)
        line = _BEFORE_BRACKETS.sub("", line)
    return " ".join(line.split()) + "\n"


def _cells_of_sheet(path: Path) -> Cells:
    what = f"the workbook {printable(path)}"
    try:
        with explained(what, "excel"), IMPORTS:
            import pandas

            import_module(SHEETS[path.suffix.lower()])
    except ModuleNotFoundError as error:  # of no extra
        raise MissingExtraError(f"{what} needs {error.name}; or save it as .xlsx") from None
    frame = pandas.read_excel(path, header=None, dtype=object)
    rows = [
        (k, ["" if pandas.isna(cell) else str(cell) for cell in row]) for k, row in enumerate(frame.values, 1)
    ]
    return Cells(printable(path), lambda: (row for row in rows if any(row[1])), "row")
