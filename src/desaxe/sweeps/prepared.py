"""A sweep that is ready to run: names and inputs checked, cut into chunks, with the Dataset that it gives."""

from collections.abc import Mapping, Sequence
from math import prod
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..evaluation.blocks import grid_parts, margin_parts
from ..evaluation.labels import attributes as attributes_of
from ..evaluation.labels import labelled
from ..evaluation.lazy import AnyPart, lazy_grid, parts_of_reduced
from ..evaluation.outer import Outer, outer_of
from ..evaluation.reductions import Reductions, names_reduced, reductions_of
from ..mechanism.names import LENGTHS
from ..runtime.accuracy import accuracy_of
from ..runtime.request import several
from ..support.forks import IMPORTS
from .layout import Layout, layout_of
from .peaks import PeakPart, peak_parts, peak_requests
from .request import identity

if TYPE_CHECKING:
    import xarray as xr


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
    parts: tuple[AnyPart | PeakPart, ...]
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
    peaks: Any,
) -> Sweep:
    """The sweep of these arguments, checked; nothing is computed or written."""
    if reduce is not None:
        names = ((names,) if isinstance(names, str) else several(names)) + names_reduced(reduce)
    outer = outer_of(names, inputs, branch, threads, always=reduce is None)
    for name in outer.dimensions:
        if not outer.axes[name].size:
            raise ValueError(f"{name}: a sweep needs at least one value of it")
    kept = accuracy_of(accuracy)
    reduction = None if reduce is None else reductions_of(reduce, outer.dimensions, outer.names)
    requests = peak_requests(peaks, outer)
    refined = peak_parts(requests, outer, branch, accuracy)
    lost = [
        name for part in refined for name in part.dims if reduction is not None and name in reduction.axes
    ]
    if lost:
        raise ValueError(f"peaks: each is of one design, and {lost[0]} is reduced; sweep them by themselves")
    if not (outer.names or refined):
        raise ValueError("sweep: nothing is requested, give names or peaks=")
    template = _template(outer, branch, accuracy, reduction, refined)
    sizes = {name: template.sizes[name] for name in outer.dimensions if name in template.dims}
    whole = [v for v in template.data_vars.values() if len(v.dims) == len(sizes)]
    stored = sum(variable.dtype.itemsize for variable in whole)
    length = None if reduction is None else prod(outer.axes[axis].size for axis in reduction.axes)
    layout = layout_of(chunks, sizes, stored, length, memory)
    if reduction is not None:
        parts = parts_of_reduced(outer, branch, accuracy, reduction, layout.chunk)
    elif outer.names:
        parts = grid_parts(outer, branch, accuracy, layout.chunk)
    else:
        parts = margin_parts(outer, branch, accuracy, layout.chunk)
    own = [part.own for part in parts] + [part.block.search.form.own for part in refined]
    told = identity(outer, branch, kept, reduction, requests, [repr(one) for one in own if one])
    return Sweep(outer, layout, (*parts, *refined), template, told)


def _template(
    outer: Outer, branch: int, accuracy: Any, reduction: Reductions | None, peaks: Sequence[PeakPart]
) -> "xr.Dataset":
    """The Dataset of a sweep with lazy variables: its names, dimensions and attributes."""
    state = outer.given.get("omega") is not None
    if reduction is not None:
        template = lazy_grid(outer, -1, branch, accuracy, 1, reduction)
    elif outer.names:
        template = lazy_grid(outer, -1, branch, accuracy, 1)
    else:
        kept = {name: array for name, array in outer.coordinates.items() if name != "theta"}
        template = labelled({}, kept, branch, state, accuracy)
    reduced = () if reduction is None else reduction.axes
    if "margin" not in template and all(n in outer.axes and n not in reduced for n in LENGTHS):
        dims = [name for name in outer.dimensions if name in LENGTHS]
        template = template.assign(margin=_lazy(template, dims, np.float64, attributes_of("margin", state)))
    for part in peaks:
        told = part.attributes(state)
        lazy = {n: _lazy(template, part.dims, dtype, told[n]) for n, dtype in part.outputs.items()}
        template = template.assign(lazy)
    return template


def _lazy(template: "xr.Dataset", dims: Sequence[str], dtype: Any, told: Mapping[str, Any]) -> Any:
    with IMPORTS:
        import dask.array as da

    return dims, da.empty([template.sizes[name] for name in dims], dtype=dtype, chunks=-1), dict(told)
