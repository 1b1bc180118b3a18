"""`desaxe sweep`: a scene of any size into a Zarr store, on this machine or a Dask cluster."""

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ..support.extras import needed
from ..support.shown import printable
from .parser import add_command
from .words import UsageError


def add_sweep(commands: Any) -> None:
    """Add `desaxe sweep`."""
    parser = add_command(commands, "sweep", "a grid of any size into a Zarr store, resumable", _sweep)
    parser.add_argument("scene", metavar="SCENE", help="path of a TOML file")
    parser.add_argument(
        "-o", metavar="STORE", dest="store", help="path of the store (default: that of [results])"
    )
    parser.add_argument("--chunks", metavar="CHUNKS", help="auto, a number, or theta=1000,ec=10")
    parser.add_argument("--memory", metavar="SIZE", help='memory for the chunks in flight, such as "200 MB"')
    parser.add_argument(
        "--overwrite", action="store_true", help="replace a store of another sweep, or a file"
    )
    parser.add_argument("--netcdf", metavar="FILE", help="write it as NetCDF too, if it fits into memory")
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--workers", metavar="N", type=int, help="processes on this machine")
    where.add_argument("--scheduler", metavar="ADDRESS", help="address of a Dask scheduler")


def _sweep(options: argparse.Namespace) -> int:
    from ..scenes.scene import scene
    from ..sweeps.workers import VersionError

    content = scene(options.scene).content
    if options.store is None and content.store is None:
        raise UsageError("where to? give -o STORE.zarr, or [results] store in the scene")
    if options.netcdf is not None:
        _require_netcdf(Path(options.netcdf), options.overwrite)
    try:
        dataset = _swept(content, options)
    except VersionError as error:
        raise UsageError(str(error)) from None
    shape = " x ".join(f"{name} ({size})" for name, size in dataset.sizes.items())
    store = printable(options.store or content.store)
    print(f"{store}: {', '.join(map(str, dataset.data_vars))} over {shape or 'one point'}")
    if options.netcdf is not None:
        _write_netcdf(dataset, Path(options.netcdf), options.overwrite)
    return 0


def _swept(content: Any, options: argparse.Namespace) -> Any:
    """The sweep of a scene, on threads here or on a Dask cluster."""
    from ..scenes.parts.grid import sweep_content

    chosen = {name: getattr(options, name) for name in ("store", "memory", "overwrite")}
    with _client(options) as client:
        return sweep_content(content, tell=print, chunks=_chunks(options.chunks), client=client, **chosen)


def _chunks(text: str | None) -> Any:
    """`auto`, a number, or `theta=1000,ec=10`."""
    if text is None or text == "auto":
        return "auto"
    try:
        if "=" not in text:
            return int(text)
        pairs = (part.split("=", 1) for part in text.split(","))
        return {name.strip(): "auto" if value == "auto" else int(value) for name, value in pairs}
    except ValueError:
        raise UsageError(f"--chunks {text}: auto, a number, or pairs such as theta=1000,ec=10") from None


@contextmanager
def _client(options: argparse.Namespace) -> Iterator[Any]:
    """A client of the cluster that is named, or of processes here; None for threads."""
    if options.workers is None and options.scheduler is None:
        yield None
        return
    if options.workers is not None and options.workers < 1:
        raise UsageError(f"--workers {options.workers}: at least 1")
    with needed("a Dask cluster"):
        from distributed import Client
    here = {"n_workers": options.workers, "threads_per_worker": 1, "dashboard_address": None}
    with Client(options.scheduler, timeout="30s", **({} if options.scheduler else here)) as client:
        yield client


def _require_netcdf(path: Path, overwrite: bool) -> None:
    """Fail before the sweep where the NetCDF file could not be written."""
    from ..support.written import require_path

    if path.suffix != ".nc":
        raise UsageError(f"--netcdf {printable(path)}: its name must end in .nc")
    require_path(path, overwrite)


def _write_netcdf(dataset: Any, path: Path, overwrite: bool) -> None:
    """Write the Dataset as one file, if there is memory for it."""
    from ..scenes.stores.files import write
    from ..support.memory import require

    require(2 * dataset.nbytes, f"--netcdf {printable(path)}")
    write(path, dataset.load(), {}, overwrite)
    print(f"{printable(path)}: the same as NetCDF")
