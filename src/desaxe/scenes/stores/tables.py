"""Results as tables, units in the headings: labelled ones, and answers."""

from collections.abc import Iterator, Mapping
from contextlib import suppress
from itertools import product, zip_longest
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import xarray as xr


def table_of(dataset: "xr.Dataset") -> Iterator[list[Any]]:
    """The headings, then a row for each point."""
    columns = [dataset[name] for name in (*dataset.dims, *dataset.data_vars)]
    yield [heading(str(column.name), column.attrs.get("units", "")) for column in columns]
    order = tuple(dataset.dims)
    wide = dict(dataset.sizes)
    full = [
        np.broadcast_to(
            c.transpose(*(d for d in order if d in c.dims)).values.reshape(
                [wide[d] if d in c.dims else 1 for d in order]
            ),
            [wide[d] for d in order],
        )
        for c in columns
    ]
    for index in product(*(range(wide[d]) for d in order)):
        yield [array[index].item() for array in full]


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
