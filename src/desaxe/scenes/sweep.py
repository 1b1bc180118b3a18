"""`sweep`: a grid of any size in a Zarr store, of names and inputs or of a scene."""

import sys
from collections.abc import Mapping, Sequence
from os import PathLike
from typing import TYPE_CHECKING, Any

from ..mechanism.keywords import with_known_keywords
from ..mechanism.own import using
from ..support.progress import Progress
from ..sweeps.request import SweepRequest
from ..sweeps.sweep import run_sweep
from .parts.grid import sweep_content
from .scene import Scene
from .scene import scene as scene_of

if TYPE_CHECKING:
    import xarray as xr


@with_known_keywords
def sweep(
    names: str | Sequence[str] | Scene | PathLike[str] | Mapping[str, Any],
    *,
    store: str | PathLike[str] | None = None,
    chunks: Any = "auto",
    memory: int | str | None = None,
    overwrite: bool = False,
    client: Any = None,
    branch: int = 1,
    accuracy: str | float = "standard",
    threads: int | None = None,
    reduce: Mapping[str, str | Sequence[str]] | None = None,
    peaks: Any = (),
    progress: Progress | None = None,
    **inputs: Any,
) -> "xr.Dataset":
    """A grid of any size, written chunk by chunk to a Zarr store; the opened Dataset, which is lazy.

    names      one or more, or a scene, or the path of one ("press.toml"): its outputs, inputs, [reduce],
               [[peak]] and [results] store, chunks and memory
    inputs, reduce  as in `grid`; `status` and `margin` come always (`margin` alone with `reduce`)
    peaks      refined peaks of each design beside the grid: a name, several, or a dict name -> "absmax",
               "max", "min" or several of these; `peak_absmax_a_C`, with its angle, status and gradient
               (`peak_absmax_a_C_theta`, `..._status`, `..._wrt_ec`); `names` may be empty then
    store      the folder of the store, such as "press.zarr"; `xarray.open_zarr` reads it. Optional with
               `reduce`, and for peaks alone: the Dataset is then in memory
    chunks     as in xarray: a dict, a number or "auto" (16 MiB a variable at most, the last dimensions
               whole); dimensions not named are whole
    memory     bytes, or text such as "200 MB", that the chunks in flight may take (256 MB without);
               the process itself takes some 200 MB more
    overwrite  replace a store of another sweep or with other chunks; a store of this sweep is resumed
    client     a `distributed.Client`: the chunks are computed and written by its workers, which must
               see the same folder
    threads    chunks at a time; default: the number of cores, fewer if memory is short
    progress   called with the points done, the total and a description; without it a terminal
               shows points, rate and remaining time

    If a sweep is stopped, the same call resumes it: whole chunks are kept, and the finished store
    has the same values as that of an uninterrupted run. A finished store
    is read, checked and left unchanged; one with damaged metadata or coordinates is refused by name.

    Raises FileExistsError, with the differences, for a store of another request, version or derivation;
    BlockingIOError while another sweep writes it; OSError if the disk is too full;
    MemoryError if a chunk needs more than `memory`; otherwise as `grid` does. Needs the extra `scale`.

        dx.sweep("press.toml", store="press.zarr", memory="500 MB")
        dx.sweep(["V_C", "a_C"], store="press.zarr", theta=th, ec=ecs, BC=bcs, AB=.125, omega0=157.08)

    See docs/choose.md: which call for which question.
    """
    tell = _tell if progress is None and sys.stderr.isatty() else None
    run = {"store": store, "overwrite": overwrite, "client": client, "watch": progress, "tell": tell}
    if isinstance(names, (Scene, Mapping, PathLike)) or (isinstance(names, str) and names.endswith(".toml")):
        if inputs or reduce is not None or peaks:
            raise TypeError("sweep: a scene has its own inputs, [reduce] and [[peak]]; give none beside it")
        there = names if isinstance(names, Scene) else scene_of(names)
        with using(there.content.definitions):
            return sweep_content(there.content, chunks=chunks, threads=threads, memory=memory, **run)
    request = SweepRequest(names, inputs, branch, accuracy, threads, reduce, peaks, chunks, memory)
    return run_sweep(request._replace(**run))


def _tell(line: str) -> None:
    print(line, file=sys.stderr)
