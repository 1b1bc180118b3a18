"""A grid of any size, written chunk by chunk to a Zarr store in bounded memory; resumable.

The chunks are computed on threads of this process or on a Dask cluster, a bounded number of them at a time.
"""

import os
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, ThreadPoolExecutor, wait
from contextlib import nullcontext
from functools import partial
from importlib import import_module
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from ..evaluation.plan import Block
from ..mechanism.program import digest
from ..runtime.threads import available
from ..support.extras import needed
from ..support.files import as_path
from ..support.forks import IMPORTS
from ..support.memory import size_text
from ..support.progress import Portions, progress_bar
from ..support.shown import printable
from ..support.version import version as desaxe_version
from .request import Sweep, SweepRequest, sweep_of
from .store import absent, claimed, finish, free_at, is_whole, require_disk, write_chunk

if TYPE_CHECKING:
    import xarray as xr

T = TypeVar("T")
R = TypeVar("R")
Arrays = list[tuple[tuple[slice, ...], dict[str, NDArray[Any]]]]  # the region of each, and those in it


def run_sweep(request: SweepRequest) -> "xr.Dataset":
    """The body of `desaxe.sweep`."""
    for module in ("xarray", "dask", "zarr"):
        with needed("sweep", "scale"):
            import_module(module)
    if request.client is not None:
        require_workers(request.client)
    if request.store is not None:
        root = Path(os.path.abspath(as_path("store", request.store)))
        return _stored(sweep_of(request), root, request)
    if request.reduce is None and (request.names or not request.peaks):
        raise TypeError('sweep: store= is missing: where the grid goes, such as "press.zarr"')
    return _in_memory(sweep_of(request), request)


def _stored(sweep: Sweep, root: Path, request: SweepRequest) -> "xr.Dataset":
    """Run a sweep into a store, or resume one that was stopped; the opened Dataset."""
    try:
        with claimed(sweep, root, request.overwrite) as sweep:
            plan, total = sweep.plan, sweep.chunks
            left = absent(sweep, root)
            if left:
                sweep.require_memory()
                require_disk(sweep, root, -(-plan.bytes * left // total))
                if request.tell is not None:
                    variables = f"{len(sweep.template.data_vars)} variables, at most {size_text(plan.bytes)}"
                    chunks = f"{total:,} chunks of {sweep.shape}; {size_text(free_at(root))} free"
                    request.tell(f"{plan.points:,} points, {variables} in {chunks}")
            for _ in _run(sweep, root, request):
                pass
            finish(root)
    except KeyboardInterrupt as stopped:
        kept = f"{sweep.chunks - absent(sweep, root):,} of {sweep.chunks:,} chunks are kept"
        stopped.args = (f"{printable(root)}: {kept}; the same sweep goes on from there",)
        raise
    with IMPORTS:
        import xarray

    dataset: xr.Dataset = xarray.open_zarr(root)
    return dataset


def _in_memory(sweep: Sweep, request: SweepRequest) -> "xr.Dataset":
    """Run a sweep whose result fits into memory, a reduced one; its Dataset."""
    template = sweep.template
    whole = {str(n): np.empty(v.shape, v.dtype) for n, v in template.data_vars.items()}
    sweep.require_memory()
    for arrays in _run(sweep, None, request):
        for region, values in arrays:
            for name, array in values.items():
                whole[name][region] = array
    return template.assign({n: template[n].copy(data=array) for n, array in whole.items()})


def _run(sweep: Sweep, root: Path | None, request: SweepRequest) -> Iterator[Arrays]:
    """Compute the chunks that a store lacks, or all of them; the arrays of each as they come, counted."""
    executor: Executor
    if request.client is not None:
        executor, each = request.client.get_executor(pure=False), 1
        size = max(1, sum(request.client.nthreads().values()))
    else:
        cores = request.threads or available()
        size = min(cores, sweep.at_once)
        executor, each = ThreadPoolExecutor(size, thread_name_prefix="desaxe-sweep"), max(1, cores // size)
    work = partial(compute_block, root, each, sweep.identity)
    shown = progress_bar(unit="points") if request.watch is None else nullcontext(request.watch)
    with shown as watch, executor:
        portions = Portions(sweep.plan.points, "sweep", watch)
        for block, arrays in run_all(executor, work, sweep.plan.blocks(sweep.chunk), 2 * size):
            portions.add(sweep.plan.points_in(block), arrays is not None)
            yield arrays or []


# ---- work on threads and workers --------------------------------------------------------------------


class VersionError(RuntimeError):
    """A worker has another desaxe than the one that sent it work."""


def compute_block(root: Path | None, threads: int, identity: dict[str, str], block: Block) -> Arrays | None:
    """Compute the chunks of a block that a store lacks, None if none; without a store return them."""
    check_version(identity["version"], identity["digest"])
    back: Arrays | None = None
    for part in block.parts:
        missing = [n for n in part.step.outputs if root is None or not is_whole(root, n, part)]
        if missing:
            back = back or []
            values = part.step.compute(block.values, threads)
            if root is None:
                back.append((part.region, values))
                continue
            for name in missing:
                write_chunk(root, name, part, values.pop(name))
    return back


def check_version(version: str, program: str) -> None:
    """Refuse to compute with another version or derivation than the sender's."""
    if (desaxe_version(), digest()) != (version, program):
        raise VersionError(
            f"this worker has desaxe {desaxe_version()}, derivation {digest()[:16]}; "
            f"the sweep is of desaxe {version}, derivation {program[:16]}"
        )


def require_workers(client: Any) -> None:
    """Refuse what is no client, a cluster without workers, and by address workers with another desaxe."""
    with needed("client="):
        import distributed

    if not isinstance(client, distributed.Client):
        raise TypeError(f"client = {client!r}: expected a distributed.Client")
    if not client.nthreads():
        client.wait_for_workers(1, timeout=30)
    answers = client.run(check_version, desaxe_version(), digest(), on_error="return")
    refused = [f"{address}: {error or type(error).__name__}" for address, error in answers.items() if error]
    if refused:
        raise VersionError("; ".join(refused))


def run_all(
    executor: Executor, function: Callable[[T], R], tasks: Iterable[T], limit: int
) -> Iterator[tuple[T, R]]:
    """Each task with its result, as they come; at most `limit` of them are under way.

    After an error no further task begins, and those that run are waited for.
    """
    left = iter(tasks)
    running = {executor.submit(function, task): task for task in islice(left, limit)}
    try:
        while running:
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                result = future.result()
                task = running.pop(future)
                running |= {executor.submit(function, task): task for task in islice(left, 1)}
                yield task, result
    finally:
        for future in running:
            future.cancel()
        wait(running)
