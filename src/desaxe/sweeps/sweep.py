"""A grid of any size, written chunk by chunk to a Zarr store in bounded memory; resumable."""

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from importlib import import_module
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..runtime.threads import available
from ..support.extras import needed
from ..support.files import as_path
from ..support.progress import Count, Portions, Progress, progress_bar
from ..support.shown import printable
from .cluster import Crew, cluster, require_workers, run_all
from .cluster import threads as thread_crew
from .estimate import CHUNK, announcement, seconds_of
from .layout import Layout, bytes_of
from .place import clear, free_at, placed, require_room
from .request import Sweep, SweepRequest, sweep_of
from .skeleton import COMPLETE
from .store import held, open_store, remove_strays, set_state, sync_folders
from .tasks import Done, InMemory, Sink, Stored, Task, is_absent, run

if TYPE_CHECKING:
    import xarray as xr

Tell = Callable[[str], None]


class RunOptions(NamedTuple):
    """The options of a run: memory for chunks in flight, Dask client or threads, callbacks."""

    memory: int | None
    client: Any
    threads: int | None
    watch: Progress | None
    tell: Tell | None


def stored_sweep(sweep: Sweep, store: str | PathLike[str], overwrite: bool, way: RunOptions) -> "xr.Dataset":
    """Run a sweep into a store, or resume one that was stopped; return the opened Dataset."""
    root = Path(os.path.abspath(store))
    sweep = placed(sweep, root, overwrite, way.memory)
    with held(root), _resumable(sweep, root):
        clear(root)
        _fill(sweep, root, way)
    return open_store(root)


@contextmanager
def _resumable(sweep: Sweep, root: Path) -> Iterator[None]:
    """Say in an interrupt how much of the sweep is kept, and how it goes on."""
    try:
        yield
    except KeyboardInterrupt as stopped:
        total = sweep.layout.chunks
        kept = f"{total - _absent(sweep, root):,} of {total:,} chunks are kept"
        words = f"{kept}; the same sweep goes on from there"
        stopped.args = (f"{printable(root)}: {words}",)
        raise


def _fill(sweep: Sweep, root: Path, way: RunOptions) -> None:
    """Compute the chunks that a store lacks."""
    absent = _absent_bytes(sweep, root)
    if absent:
        sweep.layout.require_memory(way.memory)
        require_room(sweep, root, absent)
    with _counted(sweep.plan.points, way.watch) as count, _crew(sweep.layout, way) as crew:
        if absent and way.tell is not None:
            way.tell(_announcement(sweep, root, crew.size))
        for _ in _done(sweep, Stored(str(root)), crew, way, count):
            pass
    remove_strays(root)  # of workers that were killed
    sync_folders(root)
    set_state(root, COMPLETE)


def _announcement(sweep: Sweep, root: Path, cores: int) -> str:
    variables = len(sweep.template.data_vars)
    plan = sweep.plan
    seconds = seconds_of(plan) / cores
    seconds += CHUNK * sweep.layout.chunks * variables
    return announcement(plan.points, variables, plan.bytes, sweep.layout, seconds, free_at(root))


def _crew(layout: Layout, way: RunOptions) -> AbstractContextManager[Crew]:
    if way.client is not None:
        return cluster(way.client)
    at_once = layout.at_once(way.memory)
    return thread_crew(min(way.threads or available(), at_once, max(1, layout.chunks)))


def _inner(crew: Crew, way: RunOptions) -> int:
    """Threads of each kernel, so that all cores work where few chunks fit into memory."""
    return 1 if way.client is not None else max(1, (way.threads or available()) // crew.size)


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


def _ahead(crew: Crew) -> int:
    """Tasks that wait beside those that run, so that no worker idles; none where memory takes one alone."""
    return crew.size if crew.size > 1 else 0


def _done(sweep: Sweep, sink: Sink, crew: Crew, way: RunOptions, count: Count) -> Iterator[Done]:
    """The chunks of a sweep as they are done, counted."""
    versions, inner = (sweep.identity["version"], sweep.identity["digest"]), _inner(crew, way)
    tasks = (Task(sink, block, sweep.plan.points_in(block), inner, *versions) for block in sweep.blocks())
    for done in run_all(crew, run, tasks, ahead=_ahead(crew)):
        count(done.points, done.computed)
        yield done


def swept(sweep: Sweep, way: RunOptions) -> "xr.Dataset":
    """Run a sweep whose result fits into memory, a reduced one; its Dataset."""
    arrays = {str(n): np.empty(v.shape, v.dtype) for n, v in sweep.template.data_vars.items()}
    sweep.layout.require_memory(way.memory)
    with _counted(sweep.plan.points, way.watch) as count, _crew(sweep.layout, way) as crew:
        for done in _done(sweep, InMemory(), crew, way, count):
            for region, found in done.found:
                for name, values in found.items():
                    arrays[name][region] = values
    return sweep.template.assign({n: sweep.template[n].copy(data=a) for n, a in arrays.items()})


def _absent_bytes(sweep: Sweep, root: Path) -> int:
    """Bytes of the chunks that are not in the store, before they are compressed."""
    return -(-sweep.plan.bytes * _absent(sweep, root) // sweep.layout.chunks)


def _absent(sweep: Sweep, root: Path) -> int:
    """The number of chunks that are not in the store."""
    return sum(is_absent(root, block.parts) for block in sweep.blocks())


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
    tell: Tell | None = None,
) -> "xr.Dataset":
    """The body of `desaxe.sweep` for names and inputs."""
    _require_scale()
    room = bytes_of(memory)
    if client is not None:
        require_workers(client)
    way = RunOptions(room, client, threads, watch, tell)
    asked = SweepRequest(names, inputs, branch, accuracy, threads, reduce, peaks, chunks, room)
    store = store if store is None else as_path("store", store)
    if store is None and reduce is None and (names or not peaks):
        raise TypeError('sweep: store= is missing: where the grid goes, such as "press.zarr"')
    made = sweep_of(asked)
    return swept(made, way) if store is None else stored_sweep(made, store, overwrite, way)


def _require_scale() -> None:
    for module in ("xarray", "dask", "zarr"):
        with needed("sweep", "scale"):
            import_module(module)
