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
from . import store as zarr_store
from .best import BestSearch, best_designs, search_for
from .cluster import Crew, cluster, require_workers, run_all
from .cluster import threads as thread_crew
from .estimate import CHUNK, announcement, seconds_of
from .kept import Kept
from .layout import Layout, bytes_of
from .place import CHUNKS, clear, free_at, placed, placed_search, require_room
from .request import Sweep, sweep_of
from .skeleton import COMPLETE, STATE, as_signed
from .store import attributes, held, open_store, remove_strays, set_state, sync_folders
from .tasks import Task, compute, is_absent, run

if TYPE_CHECKING:
    import xarray as xr

Tell = Callable[[str], None]


class Way(NamedTuple):
    """The options of a run: memory for chunks in flight, Dask client or threads, callbacks."""

    memory: int | None
    client: Any
    threads: int | None
    watch: Progress | None
    tell: Tell | None


def stored_sweep(sweep: Sweep, store: str | PathLike[str], overwrite: bool, way: Way) -> "xr.Dataset":
    """Run a sweep into a store, or resume one that was stopped; return the opened Dataset."""
    root = Path(os.path.abspath(store))
    sweep = placed(sweep, root, overwrite, way.memory)
    with held(root):
        clear(root)
        absent = _absent_bytes(sweep, root)
        if absent:
            sweep.layout.require_memory(way.memory)
            require_room(sweep, root, absent)
        with _counted(sweep.plan.points, way.watch) as count, _crew(sweep.layout, way) as crew:
            if absent and way.tell is not None:
                way.tell(_announcement(sweep, root, crew.size))
            for done in run_all(crew, run, _tasks(sweep, root, _inner(crew, way)), ahead=_ahead(crew)):
                count(done.points, done.computed)
        remove_strays(root)  # of workers that were killed
        sync_folders(root)
        set_state(root, COMPLETE)
    return open_store(root)


def _announcement(sweep: Sweep, root: Path, cores: int) -> str:
    variables = len(sweep.template.data_vars)
    plan = sweep.plan
    seconds = seconds_of(plan.cut(sweep.layout.chunk)) / cores
    seconds += CHUNK * sweep.layout.chunks * variables
    return announcement(plan.points, variables, plan.bytes, sweep.layout, seconds, free_at(root))


def _crew(layout: Layout, way: Way) -> AbstractContextManager[Crew]:
    if way.client is not None:
        return cluster(way.client)
    at_once = layout.at_once(way.memory)
    return thread_crew(min(way.threads or available(), at_once, max(1, layout.chunks)))


def _inner(crew: Crew, way: Way) -> int:
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


def _tasks(sweep: Sweep, root: Path | None, inner: int) -> Iterator[Task]:
    versions = sweep.identity["version"], sweep.identity["digest"]
    for block in sweep.blocks():
        yield Task(str(root), block.parts, block.values, sweep.plan.points_in(block), inner, *versions)


def unstored_sweep(sweep: Sweep, way: Way) -> "xr.Dataset":
    """Run a sweep whose result fits into memory, a reduced one; its Dataset."""
    arrays = {str(n): np.empty(v.shape, v.dtype) for n, v in sweep.template.data_vars.items()}
    sweep.layout.require_memory(way.memory)
    with _counted(sweep.plan.points, way.watch) as count, _crew(sweep.layout, way) as crew:
        tasks = _tasks(sweep, None, _inner(crew, way))
        for done in run_all(crew, compute, tasks, ahead=_ahead(crew)):
            for name, (region, values) in done.variables.items():
                arrays[name][region] = values
            count(done.points, True)
    return sweep.template.assign({n: sweep.template[n].copy(data=a) for n, a in arrays.items()})


def best_sweep(
    search: BestSearch, count: int, store: str | PathLike[str] | None, overwrite: bool, way: Way
) -> "xr.Dataset":
    """Run a search for the best designs, or resume the one whose store it is; the Dataset."""
    if store is None:
        return _searched(search, count, way, None)
    root = Path(os.path.abspath(store))
    search = placed_search(search, root, overwrite)
    with held(root):
        clear(root)
        there = attributes(root) or {}
        if there.get(STATE) != COMPLETE or not as_signed(root)[0]:
            found = _searched(search, count, way, root)
            try:
                zarr_store.write_whole(root, found.assign_attrs({CHUNKS: there[CHUNKS]}))
            except OSError as error:
                raise NotStoredError(root, error, found) from error
    return open_store(root)


def _searched(search: BestSearch, count: int, way: Way, root: Path | None) -> "xr.Dataset":
    with _counted(search.plan.points, way.watch) as told, _crew(search.layout, way) as crew:
        kept = Kept(search.layout.chunks, root)
        return best_designs(search, count, crew, told, _inner(crew, way), kept)


class NotStoredError(OSError):
    """The best designs were found and could not be stored; `result` has them."""

    def __init__(self, root: Path, error: OSError, result: "xr.Dataset") -> None:
        super().__init__(f"{printable(root)}: not written: {error.strerror or error}")
        self.result = result


def _absent_bytes(sweep: Sweep, root: Path) -> int:
    """Bytes of the chunks that are not in the store, before they are compressed."""
    absent = sum(is_absent(root, block.parts) for block in sweep.blocks())
    return -(-sweep.plan.bytes * absent // sweep.layout.chunks)


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
    best: int | None = None,
    by: Any = None,
    order: str | None = None,
    watch: Progress | None = None,
    tell: Tell | None = None,
) -> "xr.Dataset":
    """The body of `desaxe.sweep` for names and inputs."""
    _require_scale()
    room = bytes_of(memory)
    if client is not None:
        require_workers(client)
    way = Way(room, client, threads, watch, tell)
    if best is not None or by is not None:
        count = _count(best, by)
        if peaks:
            raise TypeError("best= and peaks=: give one of them")
        search = search_for(names, inputs, by, reduce, branch, accuracy, threads, room, count, order)
        return best_sweep(search, count, store, overwrite, way)
    if order is not None:
        raise TypeError("order= belongs to best= and by=: which end of what they are ranked by is the best")
    store = store if store is None else as_path("store", store)
    if store is None and reduce is None and (names or not peaks):
        raise TypeError('sweep: store= is missing: where the grid goes, such as "press.zarr"')
    made = sweep_of(names, inputs, chunks, room, branch, accuracy, threads, reduce, peaks)
    if store is None:
        return unstored_sweep(made, way)
    return stored_sweep(made, store, overwrite, way)


def _count(best: Any, by: Any) -> int:
    if best is None or by is None:
        raise TypeError('best= and by= belong together: how many designs, by what, such as best=10, by="a_C"')
    if isinstance(best, bool) or not hasattr(best, "__index__") or int(best) < 1:
        raise ValueError(f"best = {best!r}: a whole number, at least 1")
    return int(best)


def _require_scale() -> None:
    for module in ("xarray", "dask", "zarr"):
        with needed("sweep", "scale"):
            import_module(module)
