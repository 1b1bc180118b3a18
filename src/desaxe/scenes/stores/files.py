"""Labelled results as files: NetCDF, Zarr, CSV and Excel for spreadsheets, npz for NumPy.

A file, or a Zarr store, appears whole or not at all: it is written beside its place, then swapped in. The
tables of a CSV are several files, each of them whole. What desaxe did not write is left as it is, unless it
may be overwritten.
"""

import csv
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...evaluation.labels import source
from ...support.files import check_target, kind_of, require_space, staging, swap_in
from ...support.forks import IMPORTS
from ...support.shown import printable
from ...support.written import require_ours, sign_archive
from .tables import table_of
from .workbook import sheets_of, write_workbook

_NETCDF_EXTRA = 65_536  # bytes for what HDF5 writes besides the numbers of a group

if TYPE_CHECKING:
    import xarray as xr

    Writer = Callable[[Path, xr.Dataset | None, Mapping[str, xr.Dataset]], None]


def requirements_of(data: str) -> dict[str, str]:
    """The kind of file that a name stands for, and the module that writes it."""
    return {
        ".nc": {"results.data": "h5netcdf", "the file of results.data": "h5py"},
        ".zarr": {"results.data": "zarr"},
        ".xlsx": {"results.data": "xlsxwriter"},
    }.get(Path(data).suffix, {})


def write(
    path: Path, values: "xr.Dataset | None", groups: "Mapping[str, xr.Dataset]", overwrite: bool = False
) -> list[Path]:
    """Write the values and, as groups, the peaks; return the files that were written."""
    check_place(path, overwrite)
    with staging(path.parent) as folder:
        try:
            _WRITERS[path.suffix](folder / path.name, values, groups)
        except (OSError, RuntimeError) as error:  # HDF5 has both for a full disk
            raise OSError(f"{printable(path)}: not written: {error}") from error
        staged = sorted(folder.iterdir())
        for file in staged:
            check_place(path.parent / file.name, overwrite)
        for file in staged:
            swap_in(file, path.parent / file.name)
    return [path.parent / file.name for file in staged]


def files_of(path: Path, values: bool, groups: Iterable[str]) -> list[Path]:
    """The files that `write` makes: the one of that name, but a table of each part as CSV."""
    if path.suffix != ".csv":
        return [path]
    return [*([path] if values else []), *(path.with_name(f"{path.stem}_{name}.csv") for name in groups)]


def check_place(path: Path, overwrite: bool = False) -> None:
    """Refuse to replace what is no earlier result: another file, a folder that is no Zarr store, a pipe."""
    if path.suffix != ".zarr" or not os.path.lexists(path):
        check_target(path)
    elif kind_of(path) != "a folder" or path.is_symlink():
        raise ValueError(f"{printable(path)}: this is no Zarr store, and would be replaced")
    elif any(path.iterdir()) and not any((path / name).exists() for name in _STORE):
        raise ValueError(f"{printable(path)}: this folder holds no Zarr store, and would be replaced")
    require_ours(path, overwrite)


def _apart(group: str, peaks: "xr.Dataset") -> "xr.Dataset":
    """Peaks under dimensions of their own: a group may not share one of another length with its parent."""
    kind = group.partition("_")[0]  # peak, or steady
    return peaks.rename({name: f"{kind}_{name}" for name in peaks.dims})


def _parts(
    values: "xr.Dataset | None", groups: "Mapping[str, xr.Dataset]"
) -> "Iterator[tuple[str | None, xr.Dataset]]":
    """The parts by the names of their groups, each with its source, which is the mark of the file."""
    parts: dict[str | None, xr.Dataset] = {} if values is None else {None: values}
    parts |= {name: _apart(name, peaks) for name, peaks in groups.items()}
    for name, part in parts.items():
        yield name, part.assign_attrs({"source": source(), **part.attrs})


def _netcdf(path: Path, values: "xr.Dataset | None", groups: "Mapping[str, xr.Dataset]") -> None:
    size = sum(part.nbytes + _NETCDF_EXTRA for _, part in _parts(values, groups))
    require_space(path.parent, size)  # HDF5 ends the process on a full disk
    for group, part in _parts(values, groups):
        part.to_netcdf(path, mode="a" if path.exists() else "w", group=group, engine="h5netcdf")


def _zarr(path: Path, values: "xr.Dataset | None", groups: "Mapping[str, xr.Dataset]") -> None:
    with IMPORTS:
        from ...sweeps.store import put, zarr_files

    put(path, zarr_files(dict(_parts(values, groups))))


def store_group(path: Path, name: str, part: "xr.Dataset") -> list[Path]:
    """Add a group to the Zarr store of a sweep, or replace it there."""
    with IMPORTS:
        from ...sweeps.store import put_group

    put_group(path, name, dict(_parts(None, {name: part}))[name])
    return []


def _csv(path: Path, values: "xr.Dataset | None", groups: "Mapping[str, xr.Dataset]") -> None:
    """A table for each part: where it is from, a column for each dimension and name, units in the heading."""
    parts = [*([] if values is None else [values]), *groups.values()]
    for place, part in zip(files_of(path, values is not None, groups), parts, strict=True):
        with open(place, "w", encoding="utf-8", newline="") as file:
            file.write(f"# {source()}\r\n")
            csv.writer(file).writerows(table_of(part))


def _xlsx(path: Path, values: "xr.Dataset | None", groups: "Mapping[str, xr.Dataset]") -> None:
    """A sheet for each part, and one on what they are about."""
    write_workbook(path, sheets_of(values, groups))


def _npz(path: Path, values: "xr.Dataset | None", groups: "Mapping[str, xr.Dataset]") -> None:
    """Arrays by name, coordinates too; those of a peak with its group before them."""
    arrays: dict[str, Any] = {} if values is None else {str(n): a.values for n, a in values.variables.items()}
    for group, peaks in groups.items():
        arrays |= {f"{group}/{name}": array.values for name, array in peaks.variables.items()}
    np.savez(path, **arrays)
    sign_archive(path)


_STORE = (
    "zarr.json",
    ".zgroup",
    ".zattrs",
    ".zmetadata",
)  # at the top of a Zarr store
_WRITERS: "dict[str, Writer]" = {
    ".nc": _netcdf,
    ".zarr": _zarr,
    ".csv": _csv,
    ".xlsx": _xlsx,
    ".npz": _npz,
}
