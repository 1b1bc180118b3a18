"""Labelled results as files: NetCDF, Zarr, CSV and Excel for spreadsheets, npz for NumPy.

A file, or a Zarr store, appears whole or not at all: it is written beside its place, then swapped in. The
tables of a CSV are several files, each of them whole. What desaxe did not write is left as it is, unless it
may be overwritten. What a run needs and where it writes is looked at before anything is computed.
"""

import csv
import os
import shutil
from collections.abc import Callable, Iterable, Mapping
from importlib import import_module
from math import prod
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...evaluation.labels import source
from ...support.extras import needed
from ...support.files import check_target, kind_of, require_space, require_writable, staging, swap_in
from ...support.forks import IMPORTS
from ...support.memory import size_text
from ...support.shown import printable
from ...support.written import require_ours, require_path, sign_archive
from ..content import Content
from ..parts.grid import require_store
from ..schema import SceneError
from .tables import require_room, sheets_of, table_of, write_workbook

if TYPE_CHECKING:
    import xarray as xr

    Parts = Mapping[str, xr.Dataset]
    Writer = Callable[[Path, Parts], None]

VALUES = "values"  # the part that is no group
STORE = ("zarr.json", ".zgroup", ".zattrs", ".zmetadata")  # at the top of a Zarr store
NETCDF_EXTRA = 65_536  # bytes for what HDF5 writes besides the numbers of a group
LEAST = {".nc": 8, ".npz": 8, ".csv": 4, ".xlsx": 1}  # bytes that a number takes in a file, at least
MODULES = {
    ".nc": {"results.data": "h5netcdf", "the file of results.data": "h5py"},
    ".zarr": {"results.data": "zarr"},
    ".xlsx": {"results.data": "xlsxwriter"},
}


# ---- before the run ------------------------------------------------------------------------------


def require_modules(content: Content) -> None:
    """Fail early if an optional dependency is missing."""
    modules = {"outputs": "xarray"} if content.outputs else {}
    modules |= {"results.store": "zarr", "a results.store": "dask"} if content.store is not None else {}
    modules |= {"[[peak]]": "xarray"} if content.peaks else {}
    modules |= {} if content.data is None else MODULES.get(Path(content.data).suffix, {})
    pictures = {"[[picture]]": "matplotlib", "the values of a [[picture]]": "xarray"}
    for what, module in (modules | (pictures if content.of("picture") else {})).items():
        with needed(what):
            import_module(module)


def require_places(content: Content, overwrite: bool) -> None:
    """Fail at the start where something cannot be written, or would take the place of what is not ours."""
    places: dict[str, str] = {}
    for key, path in _places(content):
        place = os.path.abspath(path)
        if place in places:
            raise SceneError(f"{key} = {str(path)!r}: {places[place]} is written there")
        places[place] = key
        if key == "results.data":
            check_place(path, overwrite)
            require_writable(path)
        elif key != "results.store":
            require_path(path, overwrite)
    if content.store is not None:
        require_store(content, overwrite)
    if content.data is not None and content.outputs and content.reduction is None:
        _require_room(content, Path(content.data))


def _places(content: Content) -> list[tuple[str, Path]]:
    """Each file and store of a scene, by its key."""
    places = [("results.data", file) for file in data_files(content)]
    places += [(f"picture #{k}.file", Path(one.file)) for k, one in enumerate(content.of("picture"), 1)]
    return places + ([] if content.store is None else [("results.store", Path(content.store))])


def data_files(content: Content) -> list[Path]:
    """The files of results.data."""
    if content.data is None:
        return []
    return files_of(Path(content.data), [*[VALUES] * bool(content.outputs), *content.groups])


def _require_room(content: Content, path: Path) -> None:
    """Refuse a file that is larger than what is free."""
    points = prod(len(value) for value in content.inputs.values() if isinstance(value, tuple))
    if path.suffix == ".xlsx":
        require_room("results.data", points)
    size = LEAST.get(path.suffix, 0) * points * len(content.outputs)
    free = shutil.disk_usage(next(one for one in path.absolute().parents if one.exists())).free
    if size > free:
        raise OSError(28, f"it takes {size_text(size)} or more, {size_text(free)} are free", str(path))


def check_place(path: Path, overwrite: bool = False) -> None:
    """Refuse to replace what is no earlier result: another file, a folder that is no Zarr store, a pipe."""
    if path.suffix != ".zarr" or not os.path.lexists(path):
        check_target(path)
    elif kind_of(path) != "a folder" or path.is_symlink():
        raise ValueError(f"{printable(path)}: this is no Zarr store, and would be replaced")
    elif any(path.iterdir()) and not any((path / name).exists() for name in STORE):
        raise ValueError(f"{printable(path)}: this folder holds no Zarr store, and would be replaced")
    require_ours(path, overwrite)


# ---- after it ------------------------------------------------------------------------------------


def write(
    path: Path, values: "xr.Dataset | None", groups: "Parts | None" = None, overwrite: bool = False
) -> list[Path]:
    """Write the values and, as groups, the peaks; return the files that were written."""
    check_place(path, overwrite)
    parts = {**({} if values is None else {VALUES: values}), **(groups or {})}
    with staging(path.parent) as folder:
        try:
            _WRITERS[path.suffix](folder / path.name, parts)
        except (OSError, RuntimeError) as error:  # HDF5 has both for a full disk
            raise OSError(f"{printable(path)}: not written: {error}") from error
        staged = sorted(folder.iterdir())
        for file in staged:
            check_place(path.parent / file.name, overwrite)
        for file in staged:
            swap_in(file, path.parent / file.name)
    return [path.parent / file.name for file in staged]


def files_of(path: Path, parts: Iterable[str]) -> list[Path]:
    """The files that `write` makes: the one of that name, but a table of each part as CSV."""
    if path.suffix != ".csv":
        return [path]
    return [path if name == VALUES else path.with_name(f"{path.stem}_{name}.csv") for name in parts]


def _marked(parts: "Parts") -> "dict[str | None, xr.Dataset]":
    """The parts by the names of their groups, each with its source, which is the mark of the file.

    Peaks have dimensions of their own: a group may not share one of another length with its parent.
    """
    marked: dict[str | None, xr.Dataset] = {}
    for name, part in parts.items():
        prefix = "" if name == VALUES else f"{name.partition('_')[0]}_"  # peak, or steady
        apart = part.rename({dim: f"{prefix}{dim}" for dim in part.dims}) if prefix else part
        marked[name if prefix else None] = apart.assign_attrs({"source": source(), **part.attrs})
    return marked


def _netcdf(path: Path, parts: "Parts") -> None:
    size = sum(part.nbytes + NETCDF_EXTRA for part in parts.values())
    require_space(path.parent, size)  # HDF5 ends the process on a full disk
    for group, part in _marked(parts).items():
        part.to_netcdf(path, mode="a" if path.exists() else "w", group=group, engine="h5netcdf")


def _zarr(path: Path, parts: "Parts") -> None:
    with IMPORTS:
        from ...sweeps.store import write_groups

    write_groups(str(path), _marked(parts))


def store_group(path: Path, name: str, part: "xr.Dataset") -> list[Path]:
    """Add a group to the Zarr store of a sweep, or replace it there."""
    with IMPORTS:
        from ...sweeps.store import put_group

    put_group(path, name, _marked({name: part})[name])
    return []


def _csv(path: Path, parts: "Parts") -> None:
    """A table for each part: where it is from, a column for each dimension and name, units in the heading."""
    for place, part in zip(files_of(path, parts), parts.values(), strict=True):
        with open(place, "w", encoding="utf-8", newline="") as file:
            file.write(f"# {source()}\r\n")
            csv.writer(file).writerows(table_of(part))


def _npz(path: Path, parts: "Parts") -> None:
    """Arrays by name, coordinates too; those of a peak with its group before them."""
    arrays: dict[str, Any] = {
        str(name) if group == VALUES else f"{group}/{name}": array.values
        for group, part in parts.items()
        for name, array in part.variables.items()
    }
    np.savez(path, **arrays)
    sign_archive(path)


_WRITERS: "dict[str, Writer]" = {
    ".nc": _netcdf, ".zarr": _zarr, ".csv": _csv, ".npz": _npz,
    ".xlsx": lambda path, parts: write_workbook(path, sheets_of(parts)),
}  # fmt: skip
