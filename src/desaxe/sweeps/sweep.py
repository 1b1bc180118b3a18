"""A grid of any size, written chunk by chunk to a Zarr store in bounded memory; resumable."""

import os
from collections.abc import Callable, Container, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, closing, contextmanager
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
from .best import designs_of, search_of
from .cluster import Crew, cluster, require_workers, run_all
from .cluster import threads as thread_crew
from .estimate import CHUNK, announcement, seconds_of
from .kept import Kept
from .layout import Layout, bytes_of
from .place import CHUNKS, clear, free_at, placed, require_room
from .request import Sweep, SweepRequest, sweep_of
from .skeleton import COMPLETE, STATE, as_signed
from .store import attributes, held, open_store, remove_strays, set_state, sync_folders
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
        if sweep.ranking is None:
            _fill(sweep, root, way)
        else:
            _fill_by_rank(sweep, root, way)
    return open_store(root)


@contextmanager
def _resumable(sweep: Sweep, root: Path) -> Iterator[None]:
    """Say in an interrupt how much of the sweep is kept, and how it goes on."""
    try:
        yield
    except KeyboardInterrupt as stopped:
        total = sweep.layout.chunks
        kept = total - _absent(sweep, root) if sweep.ranking is None else int(Kept(total, root).done.sum())
        words = f"{kept:,} of {total:,} chunks are kept; the same sweep goes on from there"
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


def _fill_by_rank(search: Sweep, root: Path, way: RunOptions) -> None:
    """Search for the best designs, or go on with that, unless a store has them."""
    there = attributes(root) or {}
    if there.get(STATE) == COMPLETE and as_signed(root)[0]:
        return
    found = searched(search, way, root)
    try:
        zarr_store.write_whole(root, found.assign_attrs({CHUNKS: there[CHUNKS]}))
    except OSError as error:
        raise NotStoredError(root, error, found) from error


def _announcement(sweep: Sweep, root: Path, cores: int) -> str:
    variables = len(sweep.template.data_vars)
    plan = sweep.plan
    seconds = seconds_of(plan.cut(sweep.layout.chunk)) / cores
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


def _done(
    sweep: Sweep, sink: Sink, crew: Crew, way: RunOptions, count: Count, before: Container[int] = ()
) -> Iterator[Done]:
    """The chunks of a sweep as they are done, counted; those of `before` are not done again."""
    versions, inner = (sweep.identity["version"], sweep.identity["digest"]), _inner(crew, way)
    tasks = (
        Task(number, sink, block, sweep.plan.points_in(block), inner, *versions)
        for number, block in enumerate(sweep.blocks())
        if number not in before
    )
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


def searched(search: Sweep, way: RunOptions, root: Path | None = None) -> "xr.Dataset":
    """The best designs, the best first; a search that was stopped goes on from the chunks that are kept."""
    ranking, kept = search.ranking, Kept(search.layout.chunks, root)
    assert ranking is not None
    with _counted(search.plan.points, way.watch) as count, _crew(search.layout, way) as crew:
        count(kept.points, False)
        with closing(kept):
            for done in _done(search, ranking, crew, way, count, set(np.flatnonzero(kept.done))):
                kept.add(done.number, ranking.combine(kept.best, *done.found))
    assert kept.best is not None
    return designs_of(search, kept.best)


class NotStoredError(OSError):
    """The best designs were found and could not be stored; `result` has them."""

    def __init__(self, root: Path, error: OSError, result: "xr.Dataset") -> None:
        super().__init__(f"{printable(root)}: not written: {error.strerror or error}")
        self.result = result


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
    way = RunOptions(room, client, threads, watch, tell)
    asked = SweepRequest(names, inputs, branch, accuracy, threads, reduce, peaks, chunks, room)
    if best is not None or by is not None:
        count = _count(best, by)
        if peaks:
            raise TypeError("best= and peaks=: give one of them")
        search = search_of(asked, by, count, order)
        return searched(search, way) if store is None else stored_sweep(search, store, overwrite, way)
    if order is not None:
        raise TypeError("order= belongs to best= and by=: which end of what they are ranked by is the best")
    store = store if store is None else as_path("store", store)
    if store is None and reduce is None and (names or not peaks):
        raise TypeError('sweep: store= is missing: where the grid goes, such as "press.zarr"')
    made = sweep_of(asked)
    return swept(made, way) if store is None else stored_sweep(made, store, overwrite, way)


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
