"""`to_excel`: a labelled result or a dict of answers as a workbook, units in the headings."""

from collections.abc import Iterator, Mapping
from itertools import chain
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from ..evaluation.in_units import Shown, in_units
from ..mechanism.quantity_units import SI, UnitSystem, units_by_name
from ..scenes.stores.tables import heading
from ..scenes.stores.workbook import Sheet, require_room, sheets_of, write_workbook
from ..support.answer import Answer
from ..support.files import as_path
from ..support.shown import printable, shown
from ..support.written import write_whole


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
    sheets = _sheets(data, units)
    with write_whole(place, overwrite) as staged:
        write_workbook(staged, sheets)
    return place


def _sheets(data: Any, units: Any) -> Mapping[str, Sheet]:
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
    inputs = answer.inputs  # in SI units
    shown_in = {n: value if callable(value) else system.of(n).shown(value) for n, value in inputs.items()}
    rows = [*_rows(shown_in, {n: system.of(n).unit for n in inputs}), *_rows(answer, answer.units)]
    columns = [(name, np.asarray(value), unit) for name, value, unit in rows if np.ndim(value)]
    numbers = [[name, value, unit] for name, value, unit in rows if not np.ndim(value)]
    tables: dict[str, Sheet] = {"values": _table(columns)} if columns else {}
    name = "numbers" if columns else "values"
    return {**tables, **({name: [["name", "value", "unit"], *numbers]} if numbers or not columns else {})}


def _units_by_name(found: Mapping[Any, Any]) -> dict[Any, Any]:
    """The units of a plain dict, also of dicts inside, by names that say what they are."""
    units = units_by_name({key: value for key, value in found.items() if not isinstance(value, Mapping)})
    inside = {key: part for key, part in found.items() if isinstance(part, Mapping) and key != "gradient"}
    return {**units, **{key: _units_by_name(part) for key, part in inside.items()}}


def _rows(found: Mapping[Any, Any], units: Any, before: str = "") -> Iterator[tuple[str, Any, str]]:
    """Name, value and unit of each number, array and text, also of dicts inside."""
    for key, value in found.items():
        name, unit = f"{before}{key}", units.get(key, "") if isinstance(units, Mapping) else units
        if isinstance(value, Mapping):
            yield from _rows(value, unit or {}, f"{name} ")
        elif hasattr(value, "magnitude"):
            yield name, _plain(value.magnitude), f"{value.units}"
        elif "units" in getattr(value, "attrs", {}):
            yield name, value.values, str(value.attrs["units"])
        elif not callable(value) or hasattr(value, "over"):  # a load is shown, a solution is not
            has = isinstance(unit, str) and not isinstance(value, (str, bool)) and unit != "1"
            yield name, _plain(value), unit if has else ""


def _plain(value: Any) -> Any:
    """A number, an array of numbers, or text."""
    if value is None or isinstance(value, (str, bool, int, float)):
        return value
    if isinstance(value, (np.ndarray, np.generic)) and value.dtype.kind in "biuf":
        return value if value.ndim else value.item()
    if isinstance(value, (list, tuple)) and value and all(type(part) in (int, float) for part in value):
        return np.array(value)
    return str(value)


def _table(columns: list[tuple[str, Any, str]]) -> Iterator[list[Any]]:
    """Columns side by side: of one shape where they broadcast, else the shorter ones end earlier."""
    arrays = [array for _, array, _ in columns]
    try:
        flat = [array.reshape(-1) for array in np.broadcast_arrays(*arrays)]
    except ValueError:
        flat = [array.reshape(-1) for array in arrays]
    longest = max(array.size for array in flat)
    require_room("values", longest)
    lists = [array.tolist() + [None] * (longest - array.size) for array in flat]
    heads = [heading(name, unit) for name, _, unit in columns]
    return chain([heads], (list(row) for row in zip(*lists, strict=True)))
