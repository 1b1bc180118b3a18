"""The grid of a scene: its plan, run block by block, or swept into a store."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...evaluation.plan import Plan, plan_of
from ...evaluation.points import outer_of
from ...mechanism.quantity_units import UnitSystem
from ...support.forks import IMPORTS
from ...support.shown import printed
from ...sweeps.peak_step import PeakRequest
from ...sweeps.request import SweepRequest, sweep_of
from ..content import Content, RequestAnswer, RequestPlan, Sink
from ..document.blocks import Block, Section, Text, TextTable, cell
from ..reading.values import Value
from ..schema import SceneError
from ..stores.tables import table_of

if TYPE_CHECKING:
    import xarray as xr

BLOCK = 5_000_000  # points of the grid between two reports of progress
FEW = 12  # points whose values are printed


@dataclass(frozen=True)
class Grid:
    """The outputs of a scene over the outer product of all inputs, or what a store takes of them."""

    key = "outputs"

    def plan(self, content: Content) -> RequestPlan:
        """Blocks of points, or a sweep."""
        if content.store is not None:
            return RequestPlan(lambda sink: self._stored(content, sink), 1, file=content.store)
        return RequestPlan(lambda sink: self._answer(content, sink), blocks_of(content)[0])

    def _stored(self, content: Content, sink: Sink) -> "GridAnswer":
        sink.steps.next(f"sweeping into {content.store}")
        # The steps of the run are reported, not the points of the sweep.
        dataset = sweep_content(content, overwrite=sink.overwrite, watch=lambda done, total, what: None)
        return GridAnswer(dataset=dataset, content=content)

    def _answer(self, content: Content, sink: Sink) -> "GridAnswer":
        plan = plan_of_grid(content)
        if content.reduction is not None:
            sink.steps.next("values")
            arrays = plan.values(content.threads)
        else:
            first = dict.fromkeys(list(plan.sizes)[:1], blocks_of(content)[1])
            lengths = {name: max(1, size) for name, size in (plan.sizes | first).items()}
            arrays = plan.values_by_blocks(content.threads, lengths, lambda: sink.steps.next("values"))
        dataset = plan.dataset(arrays).assign_attrs(content.provenance)
        return GridAnswer(dataset=dataset, content=content)


@dataclass(frozen=True, kw_only=True)
class GridAnswer(RequestAnswer):
    """The outputs over the grid, labelled."""

    key = "outputs"
    content: Content

    def blocks(self, units: UnitSystem) -> Section:
        """The names and axes of the labelled result, and the values where they are few."""
        content, dataset = self.content, self.dataset
        shape = " x ".join(f"{name} ({size})" for name, size in dataset.sizes.items()) or "one point"
        if content.store is not None:
            kept = f"in the store {content.store}"
            kept += ", group steady beside them" if content.of("steady") else ""
            names = ", ".join(map(str, dataset.data_vars))
            return Section("Values", [Text(f"{names} over {shape}"), Text(kept)])
        taken = content.reduction
        of = f" ({', '.join(taken.kinds)} over {', '.join(taken.axes)})" if taken else ""
        line = Text(f"{', '.join(content.outputs)}{of} over {shape}")
        return Section("Values", [line, *_few_values(dataset)])


def _few_values(dataset: "xr.Dataset") -> Iterator[Block]:
    """A row for each quantity that has one value; a table of a few points."""
    arrays = dataset.data_vars.values()
    single = [a for a in arrays if not a.ndim and (a.name != "margin" or not dataset.sizes)]
    if single:
        rows = [(str(a.name), cell(float(a)), printed(a.attrs.get("units", "1"))) for a in single]
        yield TextTable(("quantity", "value", "unit"), rows)
    if dataset.sizes and prod(dataset.sizes.values()) <= FEW:
        heads, *points = table_of(dataset.drop_vars([str(a.name) for a in single]))
        yield TextTable(heads, [[cell(v) if isinstance(v, float) else str(v) for v in row] for row in points])


def plan_of_grid(content: Content) -> Plan:
    """The plan of the outputs over the outer product of all inputs."""
    outer = outer_of(content.outputs, arrays_of(content.inputs), content.branch, content.threads, always=True)
    return plan_of(outer, content.branch, content.accuracy, content.reduction)


def blocks_of(content: Content) -> tuple[int, int]:
    """The number of blocks along the first axis, and their length: a large grid reports its progress."""
    sizes = [len(value) for value in content.inputs.values() if isinstance(value, tuple)]
    first = sizes[0] if sizes and content.reduction is None else 1
    length = -(-first // max(1, min(first, prod(sizes) // BLOCK)))
    return -(-first // length), length


def arrays_of(inputs: Mapping[str, Value]) -> dict[str, Any]:
    """The inputs as `grid` takes them."""
    return {name: np.array(value) if isinstance(value, tuple) else value for name, value in inputs.items()}


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
        content.store,
    )  # fmt: skip


def require_store(content: Content, overwrite: bool) -> None:
    """Fail at the start where the sweep of a scene may not go to its store, or has no room."""
    with IMPORTS:
        from ...sweeps.store import checked

    checked(sweep_of(request_of(content)), Path(content.store or "").absolute(), overwrite)


def sweep_content(content: Content, *, chunks: Any = "auto", **request: Any) -> "xr.Dataset":
    """Run the sweep of a scene; what is not given comes from the scene."""
    with IMPORTS:  # Zarr, which scenes without a store do without
        from ...sweeps.sweep import run_sweep

    if not (isinstance(chunks, str) and chunks == "auto"):
        request["chunks"] = chunks
    more = {name: value for name, value in request.items() if value is not None}
    return run_sweep(request_of(content)._replace(**more))
