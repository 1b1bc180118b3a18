"""A scene as a sweep: its grid and peaks in a Zarr store."""

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from ...evaluation.reductions import Reductions
from ...sweeps.peak_step import PeakRequest
from ...sweeps.place import require_place
from ...sweeps.request import Sweep, sweep_of
from ...sweeps.sweep import run_sweep
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


def sweep_content(content: Content, **options: Any) -> "xr.Dataset":
    """Run the sweep of a scene with options of `run_sweep`; those that are not given come from the scene."""
    wanted = arguments_of(content)
    whole = options.get("best") is None
    own = {
        "store": content.store if whole else None,
        "chunks": "auto" if content.chunks is None else content.chunks,
        "memory": content.memory,
        "order": None if whole else content.order,
    }
    auto = isinstance(options.get("chunks"), str) and options["chunks"] == "auto"
    given = {n: v for n, v in options.items() if v is not None and not (auto and n == "chunks")}
    threads = options.get("threads") or content.threads
    return run_sweep(
        wanted.names, wanted.inputs, branch=content.branch, accuracy=content.accuracy, reduce=wanted.reduce,
        peaks=wanted.peaks if whole else (), **{**own, **given, "threads": threads},
    )  # fmt: skip
