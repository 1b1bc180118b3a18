"""`to_excel`: a labelled result or a dict of answers as a workbook, units in the headings."""

from collections.abc import Iterator, Mapping
from itertools import chain
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from ..mechanism.unit_system import SI, Conversion, UnitSystem
from ..runtime.written import replacing_ours
from ..scenes.tables import heading
from ..scenes.workbook import Sheet, require_room, sheets_of, write_workbook
from ..support.files import as_path
from ..support.shown import printable, shown
from .results import OWN, PLAIN, conversion_of


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
    units  of the numbers of a dict that does not know its own, such as "mm, deg, rpm"; SI units without

    Numbers have 16 digits; NaN is an empty cell, an infinite number the text inf. The file appears whole or
    not at all. Raises FileExistsError for one that desaxe did not write, unless `overwrite`; ValueError for
    more points than a sheet has rows.
    """
    place = as_path("path", path)
    if place.suffix.lower() != ".xlsx":
        raise ValueError(f"{printable(path)}: a workbook is written as .xlsx")
    sheets = _sheets(data, units)
    with replacing_ours(place, overwrite) as staged:
        write_workbook(staged, sheets)
    return place


def _sheets(data: Any, units: Any) -> Mapping[str, Sheet]:
    if hasattr(data, "data_vars"):
        return sheets_of(data, {})
    if hasattr(data, "to_dataset") and hasattr(data, "dims"):
        return sheets_of(data.to_dataset(name=data.name or "value"), {})
    if not isinstance(data, Mapping):
        raise TypeError(f"to_excel: expected a Dataset or a dict of answers, got {shown(data)}")
    system = UnitSystem.read(units) if units is not None else getattr(data, "units", None) or SI
    about, unit = getattr(data, "about", None), getattr(data, "unit", None)
    own = conversion_of(system, about) if isinstance(about, str) else None
    own = Conversion(unit) if isinstance(unit, str) else own
    inputs = getattr(data, "inputs", {})  # in SI units
    shown_in = {n: value if callable(value) else system.of(n).shown(value) for n, value in inputs.items()}
    rows = [*_rows(shown_in, system, None), *_rows(data, system, own)]
    columns = [(name, np.asarray(value), unit) for name, value, unit in rows if np.ndim(value)]
    numbers = [[name, value, unit] for name, value, unit in rows if not np.ndim(value)]
    tables: dict[str, Sheet] = {"values": _table(columns)} if columns else {}
    name = "numbers" if columns else "values"
    return {**tables, **({name: [["name", "value", "unit"], *numbers]} if numbers or not columns else {})}


def _rows(
    found: Mapping[Any, Any], system: UnitSystem, own: Conversion | None, before: str = ""
) -> Iterator[tuple[str, Any, str]]:
    """Name, value and unit of each number, array and text, also of dicts inside."""
    for key, value in found.items():
        name = f"{before}{key}"
        if isinstance(value, Mapping):
            figure = None if key == "gradient" else conversion_of(system, str(key))
            inside = figure or own if "gradient " in before else own or figure
            yield from _rows(value, system, inside, f"{name} ")
        elif hasattr(value, "magnitude"):
            yield name, _plain(value.magnitude), f"{value.units}"
        elif "units" in getattr(value, "attrs", {}):
            yield name, value.values, str(value.attrs["units"])
        elif not callable(value) or hasattr(value, "over"):  # a load is shown, a solution is not
            yield name, _plain(value), _unit(str(key), system, own, "gradient " in before)


def _unit(key: str, system: UnitSystem, own: Conversion | None, slope: bool) -> str:
    if key in PLAIN or key == "status":
        return ""
    known = conversion_of(system, key)
    if slope:
        found = None if own is None or known is None else own.per([known])
    else:
        found = own if own is not None and (key in OWN or known is None) else known
    return "" if found is None or found.unit == "1" else found.unit


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
