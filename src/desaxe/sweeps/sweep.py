"""A grid of any size, written chunk by chunk to a Zarr store in bounded memory, and gone on with."""

import json
import os
import shutil
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from importlib import import_module
from math import prod
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..evaluation.blocks import Part, grid_parts, reduced_parts
from ..evaluation.chunks import blocks_of, slices_of
from ..evaluation.labels import attributes as attributes_of
from ..evaluation.lazy import lazy_grid
from ..evaluation.outer import Outer, outer_of
from ..evaluation.reduce import Reduction, reduction_of
from ..loads.resolve import without_loads
from ..runtime.accuracy import accuracy_of
from ..runtime.threads import available
from ..support.extras import needed
from .cluster import Crew, cluster, run_all
from .cluster import threads as thread_crew
from .layout import Layout, bytes_of, layout_of, size_text
from .meter import Meter, Watch
from .request import IDENTITY, differences, identity
from .tasks import Output, Task, is_absent, run, values_for

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[Any]


class Sweep(NamedTuple):
    """A sweep that is ready to run.

    outer       the checked names and inputs
    layout      its dimensions and chunks
    parts       what is computed in each chunk
    template    its Dataset with lazy variables, for names, dimensions and attributes
    identity    the attributes that tell whether a store is of the same sweep
    """

    outer: Outer
    layout: Layout
    parts: tuple[Part, ...]
    template: "xr.Dataset"
    identity: dict[str, str]

    @property
    def points(self) -> int:
        """Points of the grid, those behind a reduced one included."""
        return prod(self.outer.axes[name].size for name in self.outer.dimensions)

    @property
    def bytes(self) -> int:
        """Bytes of the variables before they are compressed."""
        return sum(v.dtype.itemsize * v.size for v in self.template.data_vars.values())


def prepared(
    names: str | Sequence[str],
    inputs: Mapping[str, Any],
    chunks: Any,
    memory: int | None,
    branch: int,
    accuracy: Any,
    threads: int | None,
    reduce: Any,
) -> Sweep:
    """The sweep of these arguments, checked; nothing is computed or written."""
    outer = outer_of(names, inputs, branch, threads, always=reduce is None)
    without_loads("sweep", outer.loads)
    _require_values(outer)
    kept = accuracy_of(accuracy)
    reduction = None if reduce is None else reduction_of(reduce, outer.dimensions, outer.names)
    template = lazy_grid(outer, -1, branch, accuracy, 1, reduce)
    if reduction is not None:
        template = _with_margin(template, outer, branch)
    sizes = {str(name): size for name, size in template.sizes.items()}
    whole = [v for v in template.data_vars.values() if len(v.dims) == len(sizes)]
    stored = sum(variable.dtype.itemsize for variable in whole)
    length = None if reduction is None else outer.axes[reduction.axis].size
    sizes = {name: sizes[name] for name in outer.dimensions if name in sizes}
    layout = layout_of(chunks, sizes, stored, length, memory)
    parts = _parts(outer, branch, accuracy, reduction, layout)
    return Sweep(outer, layout, parts, template, identity(outer, branch, kept, reduction))


def _require_values(outer: Outer) -> None:
    for name in outer.dimensions:
        if not outer.axes[name].size:
            raise ValueError(f"{name}: a sweep needs at least one value of it")


def _parts(
    outer: Outer, branch: int, accuracy: Any, reduction: Reduction | None, layout: Layout
) -> tuple[Part, ...]:
    if reduction is None:
        return grid_parts(outer, branch, accuracy, layout.chunk)
    return reduced_parts(outer, branch, accuracy, reduction, layout.chunk)


def _with_margin(template: "xr.Dataset", outer: Outer, branch: int) -> "xr.Dataset":
    """A reduced grid with the margin of its designs, where all lengths are given."""
    names, along = outer.groups()[1]
    if not all(name in outer.axes for name in ("ec", "AB", "BC")):
        return template
    import dask.array as da

    lengths = [name for name in along if name in template.dims]
    shape = [template.sizes[name] for name in lengths]
    margin = da.empty(shape, dtype=np.float64, chunks=-1, name="margin")
    return template.assign({names[0]: (lengths, margin, attributes_of(names[0]))})


def stored_sweep(
    sweep: Sweep,
    store: str | PathLike[str],
    *,
    memory: int | None,
    overwrite: bool,
    client: Any,
    threads: int | None,
    watch: Watch | None,
) -> "xr.Dataset":
    """Run a sweep into a store, or go on with one that was stopped; the opened Dataset."""
    from .store import COMPLETE, held, open_store, remove_strays, set_state, sync_folders

    root = Path(os.path.abspath(store))
    sweep = _placed(sweep, root, overwrite, memory)
    with held(root):
        remove_strays(root)
        absent = _absent_bytes(sweep, root)
        if absent:
            sweep.layout.require_memory(memory)
            _require_room(sweep, root, absent)
        meter = Meter(sweep.points, watch)
        with closing(meter), _crew(sweep.layout, memory, client, threads) as crew:
            _write(sweep, root, crew, meter, 1 if client is not None else _inner(crew, threads))
        remove_strays(root)  # of workers that were killed
        sync_folders(root)
        set_state(root, COMPLETE)
    return open_store(root)


def _crew(layout: Layout, memory: int | None, client: Any, threads: int | None) -> Any:
    if client is not None:
        return cluster(client)
    return thread_crew(min(threads or available(), layout.at_once(memory), max(1, layout.chunks)))


def _inner(crew: Crew, threads: int | None) -> int:
    """Threads of each kernel, so that all cores work where few chunks fit into memory."""
    return max(1, (threads or available()) // crew.size)


def _placed(sweep: Sweep, root: Path, overwrite: bool, memory: int | None) -> Sweep:
    """Make the store, or see that the one there is of this sweep; the sweep with the store's chunks."""
    from .store import INCOMPLETE, STATE, attributes, create, held

    there = attributes(root)
    if root.exists() and there is None and (not root.is_dir() or any(root.iterdir())):
        raise FileExistsError(f"{root}: this is no Zarr store; it is left as it is")
    if there is None or overwrite:
        sweep.layout.require_memory(memory)
        _require_room(sweep, root, sweep.bytes)
        chunks = json.dumps(sweep.layout.chunk)
        told = {**sweep.template.attrs, **sweep.identity, "chunks": chunks, STATE: INCOMPLETE}
        template = sweep.template.assign_attrs(told)
        if there is None:
            if root.is_dir():
                root.rmdir()
            create(root, template, sweep.layout.chunk, False)
        else:
            with held(root):
                create(root, template, sweep.layout.chunk, True)
        return sweep
    if not set(IDENTITY) <= set(there):
        raise FileExistsError(f"{root}: a store that no sweep wrote; overwrite=True replaces it")
    found = differences(there, sweep.identity)
    if found:
        raise FileExistsError(
            f"{root}: a store of another sweep: {'; '.join(found)}. overwrite=True replaces it"
        )
    chunk = {name: int(length) for name, length in json.loads(there["chunks"]).items()}
    return sweep._replace(layout=sweep.layout._replace(chunk=chunk))


def _require_room(sweep: Sweep, root: Path, needed_bytes: int) -> None:
    """Refuse what the disk has no room for."""
    parent = next(path for path in root.parents if path.exists())
    free = shutil.disk_usage(parent).free
    if needed_bytes > free:
        raise OSError(
            28,
            f"the store takes up to {size_text(needed_bytes)} ({sweep.points:,} points, "
            f"{len(sweep.template.data_vars)} variables), {size_text(free)} are free",
            str(root),
        )


def _outputs(sweep: Sweep, place: tuple[int, ...]) -> tuple[tuple[Output, ...], dict[str, slice]]:
    """What is written with a chunk: a part of fewer dimensions goes with the first chunk that has it."""
    layout = sweep.layout
    regions = slices_of(place, layout.sizes, layout.chunk)
    places = dict(zip(layout.sizes, place, strict=True))
    outputs = tuple(
        Output(
            part,
            tuple(part.outputs),
            tuple(places[name] for name in part.dims),
            tuple(regions[name] for name in part.dims),
        )
        for part in sweep.parts
        if all(places[name] == 0 for name in places if name not in part.dims)
    )
    return outputs, regions


def _write(sweep: Sweep, root: Path, crew: Crew, meter: Meter, inner: int) -> None:
    """Write every chunk that is not in the store, whole."""
    layout, told = sweep.layout, (sweep.identity["version"], sweep.identity["digest"])
    scale = sweep.points // max(1, prod(layout.sizes.values()))

    def tasks() -> Iterator[Task]:
        for place in blocks_of(layout.sizes, layout.chunk):
            outputs, regions = _outputs(sweep, place)
            points = scale * prod(part.stop - part.start for part in regions.values())
            values = values_for(outputs, sweep.outer.axes, regions)
            yield Task(str(root), outputs, values, points, inner, *told)

    for done in run_all(crew, run, tasks(), ahead=crew.size if crew.size > 1 else 0):
        meter.add(done.points, done.computed)


def _absent_bytes(sweep: Sweep, root: Path) -> int:
    """Bytes of the chunks that are not in the store, before they are compressed."""
    layout = sweep.layout
    places = list(blocks_of(layout.sizes, layout.chunk))
    absent = sum(is_absent(root, _outputs(sweep, place)[0]) for place in places)
    return -(-sweep.bytes * absent // len(places))


def sweep(
    names: str | Sequence[str],
    *,
    store: str | PathLike[str],
    chunks: Any = "auto",
    memory: int | str | None = None,
    overwrite: bool = False,
    client: Any = None,
    branch: int = 1,
    accuracy: str | float = "standard",
    threads: int | None = None,
    reduce: Mapping[str, str | Sequence[str]] | None = None,
    progress: Watch | None = None,
    **inputs: Any,
) -> "xr.Dataset":
    """A grid of any size, written chunk by chunk to a Zarr store; the opened Dataset, which is lazy.

    names, inputs, reduce  as in `grid`; `status` and `margin` come always (`margin` alone with `reduce`)
    store      the folder of the store, such as "press.zarr"; `xarray.open_zarr` reads it
    chunks     as in xarray: a dict, a number or "auto" (16 MiB a variable at most, the last dimensions
               whole); dimensions not named are whole
    memory     bytes, or text such as "200 MB", that the chunks in flight may take (256 MB without);
               the process itself takes some 200 MB more
    overwrite  replace a store of another sweep
    client     a `distributed.Client`: the chunks are computed and written by its workers, which must
               see the same folder
    threads    chunks at once, as many as there are cores without; fewer where memory ends
    progress   called with points done, points in all and what is being done; without it a terminal
               shows points, rate and time left

    A sweep that was stopped goes on where it stopped when it is called again: chunks that are whole
    are kept, and the finished store has the same bytes as that of an undisturbed run. A finished store
    is read, checked and left as it is.

    Raises FileExistsError for a store of another request, version or derivation, with what differs;
    BlockingIOError while another sweep writes it; OSError where the disk has too little room;
    MemoryError where a chunk needs more than `memory`; else as `grid` does. Needs the extra `scale`.

        dx.sweep(["V_C", "a_C"], store="press.zarr", theta=th, ec=ecs, BC=bcs, AB=.125, omega0=157.08)
    """
    _require_scale()
    room = bytes_of(memory)
    made = prepared(names, inputs, chunks, room, branch, accuracy, threads, reduce)
    return stored_sweep(
        made, store, memory=room, overwrite=overwrite, client=client, threads=threads, watch=progress
    )


def _require_scale() -> None:
    for module in ("xarray", "dask", "zarr"):
        with needed("sweep", "scale"):
            import_module(module)
