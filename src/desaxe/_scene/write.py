"""Labelled results as files: NetCDF, Zarr, CSV for spreadsheets, npz for NumPy.

A file appears whole or not at all: it is written beside its place, then moved there.
"""

import csv
import os
import shutil
import tempfile
from collections.abc import Callable, Iterator, Mapping
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import xarray as xr

    Writer = Callable[[Path, xr.Dataset | None, Mapping[str, xr.Dataset]], None]


def rooms_of(data: str) -> dict[str, str]:
    """What is needed to write a file of this name: a word for it, and the module."""
    return {
        ".nc": {"results.data": "h5netcdf", "the file of results.data": "h5py"},
        ".zarr": {"results.data": "zarr"},
    }.get(Path(data).suffix, {})


def write(path: Path, values: "xr.Dataset | None", groups: "Mapping[str, xr.Dataset]") -> list[Path]:
    """Write the values and, as groups, the peaks; the files that were written."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=".desaxe-") as folder:
        _WRITERS[path.suffix](Path(folder) / path.name, values, groups)
        staged = sorted(Path(folder).iterdir())
        for file in staged:
            _move(file, path.parent / file.name)
    return [path.parent / file.name for file in staged]


def _move(staged: Path, place: Path) -> None:
    if place.is_dir():  # a Zarr store of an earlier run
        shutil.rmtree(place)
    os.replace(staged, place)


def _apart(peaks: "xr.Dataset") -> "xr.Dataset":
    """Peaks under dimensions of their own: a group may not share one of another length with its parent."""
    return peaks.rename({name: f"peak_{name}" for name in peaks.dims})


def _parts(
    values: "xr.Dataset | None", groups: "Mapping[str, xr.Dataset]"
) -> "Iterator[tuple[str | None, xr.Dataset]]":
    if values is not None:
        yield None, values
    for name, peaks in groups.items():
        yield name, _apart(peaks)


def _netcdf(path: Path, values: "xr.Dataset | None", groups: "Mapping[str, xr.Dataset]") -> None:
    for group, part in _parts(values, groups):
        part.to_netcdf(path, mode="a" if path.exists() else "w", group=group, engine="h5netcdf")


def _zarr(path: Path, values: "xr.Dataset | None", groups: "Mapping[str, xr.Dataset]") -> None:
    for group, part in _parts(values, groups):
        part.to_zarr(path, mode="a" if path.exists() else "w", group=group, consolidated=False)


def _csv(path: Path, values: "xr.Dataset | None", groups: "Mapping[str, xr.Dataset]") -> None:
    """A table for each part: a column for each dimension and name, units in the heading."""
    parts = {path.name: values} if values is not None else {}
    parts |= {f"{path.stem}_{name}.csv": peaks for name, peaks in groups.items()}
    for name, part in parts.items():
        with open(path.with_name(name), "w", encoding="utf-8", newline="") as file:
            csv.writer(file).writerows(_table(part))


def _table(dataset: "xr.Dataset") -> Iterator[list[Any]]:
    columns = [dataset[name] for name in (*dataset.dims, *dataset.data_vars)]
    yield [_heading(column) for column in columns]
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


def _heading(column: "xr.DataArray") -> str:
    unit = column.attrs.get("units", "")
    return f"{column.name} [{unit}]" if unit not in ("", "1") else str(column.name)


def _npz(path: Path, values: "xr.Dataset | None", groups: "Mapping[str, xr.Dataset]") -> None:
    """Arrays by name, coordinates too; those of a peak with its group before them."""
    arrays: dict[str, Any] = {} if values is None else {str(n): a.values for n, a in values.variables.items()}
    for group, peaks in groups.items():
        arrays |= {f"{group}/{name}": array.values for name, array in peaks.variables.items()}
    np.savez(path, **arrays)


_WRITERS: "dict[str, Writer]" = {".nc": _netcdf, ".zarr": _zarr, ".csv": _csv, ".npz": _npz}
