"""A scene as a sweep: its grid and peaks in a Zarr store.

What runs sweeps needs Zarr and is imported where one is run: scenes without a store do without it.
"""

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...support.forks import IMPORTS
from ...sweeps.peak_step import PeakRequest
from ...sweeps.request import SweepRequest, sweep_of
from ..content import Content
from ..schema import SceneError
from .grid import arrays_of

if TYPE_CHECKING:
    import xarray as xr


def request_of(content: Content) -> SweepRequest:
    """The request of a scene's sweep; SceneError where its peaks are of other designs."""
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
    peaks = tuple(dict.fromkeys(PeakRequest(one.quantity, one.kind, one.theta) for one in content.peaks))
    return SweepRequest(
        list(content.outputs), arrays_of(inputs), content.branch, content.accuracy, content.threads,
        content.reduction, peaks, "auto" if content.chunks is None else content.chunks, content.memory,
    )  # fmt: skip


def require_store(content: Content, overwrite: bool) -> None:
    """Fail at the start where the sweep of a scene may not go to its store, or has no room."""
    with IMPORTS:
        from ...sweeps.store import checked

    assert content.store is not None
    checked(sweep_of(request_of(content)), Path(os.path.abspath(content.store)), overwrite)


def sweep_content(content: Content, **options: Any) -> "xr.Dataset":
    """Run the sweep of a scene with options of `run_sweep`; those that are not given come from the scene."""
    with IMPORTS:
        from ...sweeps.sweep import run_sweep

    auto = isinstance(options.get("chunks"), str) and options["chunks"] == "auto"
    given = {n: v for n, v in options.items() if v is not None and not (auto and n == "chunks")}
    return run_sweep(**{**request_of(content)._asdict(), "store": content.store, **given})
