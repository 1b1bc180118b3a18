"""Measurements in SI units: samples of the crank angle or the time, and of quantities; NaN where missing."""

import csv
import re
from collections.abc import Iterable, Mapping
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...mechanism.catalogue import quantity
from ...mechanism.inputs import INPUTS
from ...support.extras import MissingExtraError
from ...support.files import read_bytes
from ...support.shown import printable, shown
from ...units.parse import in_unit
from ...units.pint_units import registry
from ...units.text import plain_number, spelled

Array = NDArray[np.float64]
MOST = 1e100  # of samples and unknowns: squares of residuals and derivatives must not overflow, nor vanish
MOST_BYTES = 100_000_000  # of a file
COURSE = {"theta": "rad", "t": "s"}  # what samples are taken over, and its unit
_HEADING = re.compile(r"\s*([^\[\]()]+?)\s*(?:[\[(]\s*([^\])]*?)\s*[\])])?\s*")


class Data(NamedTuple):
    """Samples: `course` is "theta" or "t", `at` its values, `measured` a column for each quantity."""

    course: str
    at: Array
    measured: dict[str, Array]

    @property
    def size(self) -> int:
        """The number of measured values."""
        return sum(int(np.isfinite(column).sum()) for column in self.measured.values())


def read_data(data: Any, state: bool) -> Data:
    """The measurements, checked; errors name the column."""
    columns = read_csv(Path(data)) if isinstance(data, (str, PathLike)) else columns_of(data)
    course = [name for name in COURSE if name in columns]
    if len(course) != 1:
        raise TypeError(f"fit: data has one of theta and t, got {', '.join(map(str, columns)) or 'nothing'}")
    names = [name for name in columns if name not in COURSE]
    if not names:
        raise TypeError(f"fit: data has {course[0]} and no measured quantity")
    units = {name: quantity(name, state).unit for name in names}
    at = _column(course[0], columns[course[0]], COURSE[course[0]])
    measured = {name: _column(name, columns[name], unit) for name, unit in units.items()}
    for name, column in measured.items():
        if column.shape != at.shape:
            raise ValueError(f"data: {name} has {column.size} samples, {course[0]} has {at.size}")
    measured = {name: np.where(np.isfinite(at), column, np.nan) for name, column in measured.items()}
    for name, column in measured.items():
        if not np.isfinite(column).any():
            raise ValueError(f"data: {name} has no finite sample")
    return Data(course[0], np.where(np.isfinite(at), at, 0.0), measured)


def columns_of(data: Any) -> dict[str, Any]:
    """The columns of a mapping, a DataFrame or a Dataset; a course may be its index or coordinate."""
    if hasattr(data, "data_vars"):
        found = {str(name): array for name, array in data.data_vars.items()}
        return {str(n): c for n, c in data.coords.items() if n in COURSE and c.ndim} | found
    if hasattr(data, "columns"):
        index = {data.index.name: data.index.to_numpy()} if data.index.name in COURSE else {}
        return index | {str(name): data[name].to_numpy() for name in data.columns}
    if not isinstance(data, Mapping):
        raise TypeError(
            f"data = {type(data).__name__}: expected a mapping name -> samples, a table or a CSV file"
        )
    return {str(name): column for name, column in data.items()}


def _column(name: str, values: Any, unit: str) -> Array:
    if hasattr(values, "dims"):
        own = values.attrs.get("units", unit)
        values = values.values if own == unit else _converted(name, values.values, own, unit)
    if hasattr(values, "magnitude"):
        values = in_unit(name, values, unit)
    try:
        given = np.asarray(values)
        if given.dtype.kind in "SUO":
            _require_plain(given.ravel().tolist())
        column = given.astype(np.float64)
    except (TypeError, ValueError, OverflowError):
        raise TypeError(f"data: {name}: expected real numbers") from None
    if np.iscomplexobj(values) or column.ndim != 1:
        raise TypeError(f"data: {name}: expected a row of real numbers, got the shape {column.shape}")
    if np.isinf(column).any():
        raise ValueError(f"data: {name}: an infinite sample; a missing one is NaN")
    if (np.abs(column) > MOST).any():
        raise ValueError(f"data: {name}: a sample beyond {MOST:g} in magnitude")
    return column


def _require_plain(samples: Iterable[Any]) -> None:
    """TypeError for a text that is no plain number."""
    for one in samples:
        if isinstance(one, bytes) or (isinstance(one, str) and plain_number(one) is None):
            raise TypeError(f"{shown(one)} is not a number")


def read_csv(path: Path) -> dict[str, Array]:
    """The columns of a CSV file whose heading names them, `theta [deg], a_C [m/s2]`.

    Lines before the heading are skipped, and so are columns that are no quantity.
    """
    try:
        text = read_bytes(path, MOST_BYTES).decode("utf-8-sig")
    except ValueError as error:
        raise ValueError(f"data: {shown(str(path))}: {error}") from None
    separator = ";" if text.count(";") > text.count(",") else ","
    rows = [row for row in csv.reader(text.splitlines(), delimiter=separator) if any(c.strip() for c in row)]
    start = next((k for k, row in enumerate(rows) if _names(row) & set(COURSE)), None)
    if start is None:
        raise ValueError(f"{printable(path)}: no heading with theta or t, such as `theta [deg], a_C [m/s2]`")
    found: dict[str, Array] = {}
    for place, heading in enumerate(rows[start]):
        match = _HEADING.fullmatch(heading)
        if match is None or not heading.strip():
            continue
        name, unit = match[1], match[2]
        if not (name in COURSE or name in INPUTS or _is_quantity(name)):
            continue  # another channel of the instrument
        column = np.array([_number(path, row, place, separator) for row in rows[start + 1 :]])
        wanted = COURSE.get(name) or quantity(name).unit
        found[name] = _converted(name, column, unit, wanted) if unit else column
    return found


def _converted(name: str, column: Any, unit: str, wanted: str) -> Any:
    try:
        quantity = registry().Quantity(column, spelled(unit))
    except MissingExtraError:
        raise
    except Exception:
        raise ValueError(f"data: {name} in {unit!r}: unknown unit; {wanted} is its own") from None
    return in_unit(name, quantity, wanted)


def _names(row: Iterable[str]) -> set[str]:
    return {match[1] for cell in row if (match := _HEADING.fullmatch(cell))}


def _is_quantity(name: str) -> bool:
    try:
        quantity(name)
    except ValueError:
        return False
    return True


def _number(path: Path, row: list[str], place: int, separator: str) -> float:
    text = row[place].strip() if place < len(row) else ""
    if not text or text.lower() in ("nan", "na", "-", "--"):
        return float("nan")
    number = plain_number(text.replace(",", ".") if separator == ";" else text)
    if number is None:
        raise ValueError(f"{printable(path)}: {text!r} is not a number")
    return number
