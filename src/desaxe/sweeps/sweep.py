"""A grid of any size, written chunk by chunk to a Zarr store in bounded memory; resumable."""

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import contextmanager
from importlib import import_module
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..runtime.threads import available
from ..support.extras import needed
from ..support.files import as_path
from ..support.memory import bytes_of, size_text
from ..support.progress import Count, Portions, Progress, progress_bar
from ..support.shown import printable
from .request import Sweep, SweepRequest, sweep_of
from .store import absent, claimed, finish, free_at, open_store, require_disk
from .workers import Arrays, BlockWork, require_workers, run_all

if TYPE_CHECKING:
    import xarray as xr


class RunOptions(NamedTuple):
    """The options of a run: Dask client or threads, callbacks."""

    client: Any
    threads: int | None
    watch: Progress | None
    tell: Callable[[str], None] | None


def run_sweep(
    names: str | Sequence[str],
    inputs: Mapping[str, Any],
    *,
    store: str | PathLike[str] | None,
    chunks: Any,
    memory: int | str | None,
    overwrite: bool = False,
    client: Any = None,
    branch: int,
    accuracy: Any,
    threads: int | None,
    reduce: Any,
    peaks: Any,
    watch: Progress | None = None,
    tell: Callable[[str], None] | None = None,
) -> "xr.Dataset":
    """The body of `desaxe.sweep` for names and inputs."""
    for module in ("xarray", "dask", "zarr"):
        with needed("sweep", "scale"):
            import_module(module)
    limit = bytes_of(memory)
    if client is not None:
        require_workers(client)
    options = RunOptions(client, threads, watch, tell)
    request = SweepRequest(names, inputs, branch, accuracy, threads, reduce, peaks, chunks, limit)
    if store is not None:
        root = Path(os.path.abspath(as_path("store", store)))
        return _stored(sweep_of(request), root, overwrite, options)
    if reduce is None and (names or not peaks):
        raise TypeError('sweep: store= is missing: where the grid goes, such as "press.zarr"')
    return _in_memory(sweep_of(request), options)


def _stored(sweep: Sweep, root: Path, overwrite: bool, options: RunOptions) -> "xr.Dataset":
    """Run a sweep into a store, or resume one that was stopped; the opened Dataset."""
    with claimed(sweep, root, overwrite) as sweep:
        layout, total = sweep.layout, sweep.layout.chunks
        left = absent(sweep, root)
        if left:
            layout.require_memory()
            require_disk(sweep, root, -(-sweep.plan.bytes * left // total))
            if options.tell is not None:
                options.tell(_announcement(sweep, free_at(root)))
        try:
            for _ in _run(sweep, root, options):
                pass
        except KeyboardInterrupt as stopped:
            kept = f"{total - absent(sweep, root):,} of {total:,} chunks are kept"
            stopped.args = (f"{printable(root)}: {kept}; the same sweep goes on from there",)
            raise
        finish(root)
    return open_store(root)


def _in_memory(sweep: Sweep, options: RunOptions) -> "xr.Dataset":
    """Run a sweep whose result fits into memory, a reduced one; its Dataset."""
    template = sweep.template
    whole = {str(n): np.empty(v.shape, v.dtype) for n, v in template.data_vars.items()}
    sweep.layout.require_memory()
    for arrays in _run(sweep, None, options):
        for region, values in arrays:
            for name, array in values.items():
                whole[name][region] = array
    return template.assign({n: template[n].copy(data=array) for n, array in whole.items()})


def _announcement(sweep: Sweep, free: int) -> str:
    plan, layout = sweep.plan, sweep.layout
    return (
        f"{plan.points:,} points, {len(sweep.template.data_vars)} variables, at most {size_text(plan.bytes)} "
        f"in {layout.chunks:,} chunks of {layout.shape}; {size_text(free)} free"
    )


def _run(sweep: Sweep, root: Path | None, options: RunOptions) -> Iterator[Arrays]:
    """Compute the chunks that a store lacks, or all of them; the arrays of each as they come, counted."""
    executor, size, threads = _executor(sweep, options)
    work = BlockWork(root, threads, sweep.identity["version"], sweep.identity["digest"])
    with _counted(sweep.plan.points, options.watch) as count, executor:
        for block, arrays in run_all(executor, work.run, sweep.blocks(), 2 * size):
            count(sweep.plan.points_in(block), arrays is not None)
            yield arrays or []


def _executor(sweep: Sweep, options: RunOptions) -> tuple[Executor, int, int]:
    """An executor of the chunks, how many run at once, and the threads of each."""
    if options.client is not None:
        executor = options.client.get_executor(pure=False)
        return executor, max(1, sum(options.client.nthreads().values())), 1
    cores = options.threads or available()
    size = min(cores, sweep.layout.at_once)
    return ThreadPoolExecutor(size, thread_name_prefix="desaxe-sweep"), size, max(1, cores // size)


@contextmanager
def _counted(points: int, watch: Progress | None) -> Iterator[Count]:
    """Counts points that are computed or were there, for a callback, or in a bar on the terminal."""
    if watch is None:
        with progress_bar(unit="points") as bar:
            yield Portions(points, "sweep", bar).add
        return
    done = 0

    def count(more: int, computed: bool) -> None:
        nonlocal done
        done += more
        watch(done, points, "writing" if computed else "reading")

    yield count
