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
    from ..sweeps.tasks import VersionError

    wanted = scene(options.scene)
    if options.store is None and wanted.content.store is None:
        raise UsageError("where to? give -o STORE.zarr, or [results] store in the scene")
    if options.netcdf is not None:
        _require_netcdf(options.netcdf, options.overwrite)
    try:
        found = _swept(wanted.content, options)
    except VersionError as error:
        raise UsageError(str(error)) from None
    shape = " x ".join(f"{name} ({size})" for name, size in found.sizes.items())
    place = printable(options.store or wanted.content.store)
    print(f"{place}: {', '.join(map(str, found.data_vars))} over {shape or 'one point'}")
    if options.netcdf is not None:
        _write_netcdf(found, options.netcdf, options.overwrite)
    return 0


def _swept(content: Any, options: argparse.Namespace) -> Any:
    """The sweep of a scene, on threads here or on a Dask cluster."""
    from ..scenes.parts.stored import sweep_content

    with _client(options) as client:
        return sweep_content(
            content,
            tell=print,
            store=options.store,
            chunks=_chunks(options.chunks),
            memory=options.memory,
            overwrite=options.overwrite,
            client=client,
        )


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
    with needed("a Dask cluster"):
        from distributed import Client, LocalCluster
    if options.scheduler is not None:
        with Client(options.scheduler, timeout="30s") as client:
            yield client
        return
    if options.workers < 1:
        raise UsageError(f"--workers {options.workers}: at least 1")
    with (
        LocalCluster(n_workers=options.workers, threads_per_worker=1, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        yield client


def _require_netcdf(place: str, overwrite: bool) -> None:
    """Fail before the sweep where the NetCDF file could not be written."""
    from ..scenes.stores.files import check_place
    from ..support.files import require_writable

    if not place.endswith(".nc"):
        raise UsageError(f"--netcdf {printable(place)}: its name must end in .nc")
    check_place(Path(place), overwrite)
    require_writable(Path(place))


def _write_netcdf(found: Any, place: str, overwrite: bool) -> None:
    """Write the Dataset as one file, if there is memory for it."""
    from ..scenes.stores.files import write
    from ..sweeps.layout import size_text
    from ..sweeps.memory import free_memory

    free = free_memory()
    if free is not None and found.nbytes > free // 2:
        raise MemoryError(
            f"--netcdf {printable(place)}: {size_text(found.nbytes)} do not fit into the free memory "
            f"({size_text(free)}); the Zarr store is complete"
        )
    write(Path(place), found.load(), {}, overwrite)
    print(f"{printable(place)}: the same as NetCDF")
