"""The grid of a scene: its plan, run block by block, or swept into a store."""

import os
from collections.abc import Mapping
from math import prod
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...evaluation.plan import Plan, plan_of
from ...evaluation.points import outer_of
from ...support.forks import IMPORTS
from ...support.progress import Steps
from ...sweeps.peak_step import PeakRequest
from ...sweeps.request import RunOptions, SweepRequest, sweep_of
from ..reading.values import Value
from ..schema import SceneError
from ..setting import Setting

if TYPE_CHECKING:
    import xarray as xr

BLOCK = 5_000_000  # points of the grid between two reports of progress


def plan_of_grid(setting: Setting) -> Plan:
    """The plan of the outputs over the outer product of all inputs."""
    outer = outer_of(setting.outputs, arrays_of(setting.inputs), setting.branch, setting.threads, always=True)
    return plan_of(outer, setting.branch, setting.accuracy, setting.reduction)


def blocks_of(setting: Setting) -> tuple[int, int]:
    """The number of blocks along the first axis, and their length: a large grid reports its progress."""
    sizes = [len(value) for value in setting.inputs.values() if isinstance(value, tuple)]
    first = sizes[0] if sizes and setting.reduction is None else 1
    length = -(-first // max(1, min(first, prod(sizes) // BLOCK)))
    return -(-first // length), length


def values_of_grid(setting: Setting, steps: Steps) -> "xr.Dataset":
    """The requested outputs over the outer product of all inputs, labelled."""
    plan = plan_of_grid(setting)
    if setting.reduction is not None:
        steps.next("values")
        arrays = plan.values(setting.threads)
    else:
        first = dict.fromkeys(list(plan.sizes)[:1], blocks_of(setting)[1])
        lengths = {name: max(1, size) for name, size in (plan.sizes | first).items()}
        arrays = plan.values_by_blocks(setting.threads, lengths, lambda: steps.next("values"))
    return plan.dataset(arrays).assign_attrs(setting.provenance)


def arrays_of(inputs: Mapping[str, Value]) -> dict[str, Any]:
    """The inputs as `grid` takes them."""
    return {name: np.array(value) if isinstance(value, tuple) else value for name, value in inputs.items()}


def request_of(content: Any) -> SweepRequest:
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


def require_store(content: Any, overwrite: bool) -> None:
    """Fail at the start where the sweep of a scene may not go to its store, or has no room."""
    with IMPORTS:
        from ...sweeps.store import checked

    checked(sweep_of(request_of(content)), Path(os.path.abspath(content.store)), overwrite)


def sweep_content(content: Any, options: RunOptions, *, chunks: Any = "auto", **request: Any) -> "xr.Dataset":
    """Run the sweep of a scene; what is not given comes from the scene."""
    with IMPORTS:  # Zarr, which scenes without a store do without
        from ...sweeps.sweep import run_sweep

    if not (isinstance(chunks, str) and chunks == "auto"):
        request["chunks"] = chunks
    given = {name: value for name, value in request.items() if value is not None}
    store = content.store if options.store is None else options.store
    return run_sweep(request_of(content)._replace(**given), options._replace(store=store))
