"""A scene as a sweep: its grid and peaks in a Zarr store."""

import os
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from ...evaluation.reductions import Reductions
from ...sweeps.meter import Watch
from ...sweeps.peak_step import PeakRequest
from ...sweeps.place import require_place
from ...sweeps.request import Sweep, sweep_of
from ...sweeps.sweep import Tell, run_sweep
from ..content import Content
from ..schema import SceneError
from .grid import arrays_of

if TYPE_CHECKING:
    import xarray as xr


class Arguments(NamedTuple):
    """The arguments of a scene's sweep."""

    names: list[str]
    inputs: dict[str, Any]
    reduce: Reductions | None
    peaks: tuple[PeakRequest, ...]


def arguments_of(content: Content) -> Arguments:
    """The names, inputs, reduction and peaks of a scene; SceneError where its peaks are of other designs."""
    if not (content.outputs or content.peaks):
        raise SceneError("there is nothing to sweep: give outputs = [...] or [[peak]]")
    inputs = dict(content.inputs)
    if not content.outputs:
        inputs = {**content.peaks[0].fixed, **content.peaks[0].axes}
    for number, peak in enumerate(content.peaks, 1):
        for name, value in {**peak.axes, **peak.fixed}.items():
            if inputs.get(name, 0.0) != value:
                raise SceneError(
                    f"peak #{number}.over.{name}: a sweep takes peaks of the designs of its grid; "
                    "sweep these in a scene of their own"
                )
    peaks = tuple(PeakRequest(peak.quantity, peak.kind, peak.theta) for peak in content.peaks)
    return Arguments(list(content.outputs), arrays_of(inputs), content.reduction, peaks)


def prepared_content(content: Content) -> Sweep:
    """The sweep of a scene into its store; nothing is computed or written."""
    wanted = arguments_of(content)
    chunks = "auto" if content.chunks is None else content.chunks
    return sweep_of(
        wanted.names, wanted.inputs, chunks, content.memory, content.branch, content.accuracy,
        content.threads, wanted.reduce, wanted.peaks,
    )  # fmt: skip


def require_store(content: Content, overwrite: bool) -> None:
    """Fail at the start where the sweep of a scene may not go to its store, or has no room."""
    assert content.store is not None
    require_place(prepared_content(content), Path(os.path.abspath(content.store)), overwrite, content.memory)


def sweep_content(
    content: Content,
    *,
    store: str | PathLike[str] | None = None,
    chunks: Any = "auto",
    memory: int | str | None = None,
    best: int | None = None,
    threads: int | None = None,
    watch: Watch | None = None,
    tell: Tell | None = None,
    overwrite: bool = False,
    client: Any = None,
    by: Any = None,
    order: str | None = None,
) -> "xr.Dataset":
    """Run the sweep of a scene; options that are not given come from the scene."""
    wanted = arguments_of(content)
    return run_sweep(
        wanted.names,
        wanted.inputs,
        store=content.store if store is None and best is None else store,
        chunks=content.chunks if chunks == "auto" and content.chunks is not None else chunks,
        memory=content.memory if memory is None else memory,
        branch=content.branch,
        accuracy=content.accuracy,
        threads=threads or content.threads,
        reduce=wanted.reduce,
        peaks=() if best is not None else wanted.peaks,
        best=best,
        watch=watch,
        tell=tell,
        overwrite=overwrite,
        client=client,
        by=by,
        order=content.order if order is None and best is not None else order,
    )
