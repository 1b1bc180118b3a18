"""Reductions of one axis of a grid: largest, smallest, mean, ... without storing the grid."""

from collections.abc import Callable, Mapping, Sequence
from math import prod
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..compiler.languages.numba.reductions import EXTREMES, outputs_of
from ..runtime.kernels import KernelKey, kernel_for, key_of
from ..runtime.request import Request
from ..runtime.threads import in_blocks
from ..runtime.tiers import COMPILED, tier_of
from .fold import average, place
from .labels import attributes, input_attributes, labelled, provenance
from .reductions import Reduction, method_of

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[Any]
Fill = Callable[[], dict[str, Array]]


def reduced_grid(
    wanted: Request,
    axes: Mapping[str, Array],
    dimensions: Sequence[str],
    reduction: Reduction,
    branch: int,
    threads: int | None,
    whole: Fill,
) -> "xr.Dataset":
    """The grid with one axis reduced, labelled."""
    arrays = reduced(wanted, axes, dimensions, reduction, threads, whole)
    state = wanted.form.state
    kept = {name: axis for name, axis in axes.items() if name != reduction.axis}
    told = reduced_attributes(wanted.shown, reduction, input_attributes(reduction.axis), state)
    dataset = labelled({}, kept, branch, state)
    dataset.attrs |= provenance(arrays, kept, branch, wanted.accuracy, of=wanted.shown)
    return dataset.assign({name: (*found, told[name]) for name, found in arrays.items()})


def reduced(
    wanted: Request,
    axes: Mapping[str, Array],
    dimensions: Sequence[str],
    reduction: Reduction,
    threads: int | None,
    whole: Fill,
) -> dict[str, tuple[tuple[str, ...], Array]]:
    """The reduced arrays by name with their dimensions; `whole` computes the grid where it is small.

    For each name and kind `<name>_<kind>`, of an extreme `<name>_<kind>_<axis>` (where it is), and
    `<name>_skipped`, how many points are NaN.
    """
    rest = tuple(name for name in dimensions if name != reduction.axis)
    shape = tuple(axes[name].size for name in rest)
    length = axes[reduction.axis].size
    outs = {name: np.empty(shape or (1,), kind) for name, kind in outputs_of(wanted.shown, reduction.kinds)}
    order = [*(rest or ("",)), reduction.axis]
    given = {name: axes[name] for name in wanted.inputs if name in axes}
    scalars = {name: float(axis.reshape(-1)[0]) for name, axis in given.items() if name not in order}
    columns = {name: np.ascontiguousarray(axis) for name, axis in given.items() if name in order}
    places = {name: order.index(name) for name in columns}
    key = key_of(wanted, scalars, columns, places, len(order))._replace(reduce=reduction.kinds)
    small = tier_of(key, prod(shape) * length) != COMPILED
    if length == 0 or not all(shape) or small:
        _of_whole(whole(), reduction, dimensions, outs)
    else:
        fill_reduced(key, {**scalars, **columns}, length, list(outs.values()), threads)
    arrays = {name: out if shape else out.reshape(()) for name, out in outs.items()}
    return named_by_reduction(arrays, wanted.shown, reduction, axes[reduction.axis], rest)


def fill_reduced(
    key: KernelKey, values: Mapping[str, Any], length: int, outs: Sequence[Array], threads: int | None
) -> None:
    """Fill the outputs of `outputs_of` by the kernel of a key, whose innermost axis has this length."""
    kernel = kernel_for(key)
    outer = {name for name, axis in kernel.axis_of if axis == 0}
    names = [name for name, _ in kernel.axis_of]

    def block(start: int, stop: int) -> None:
        part = [values[n][start:stop] if n in outer else values[n] for n in names]
        kernel.function(*part, length, *(out[start:stop] for out in outs))

    in_blocks(block, outs[0].shape[0], outs[0].size * length, threads)


def _of_whole(
    grid: Mapping[str, Array], reduction: Reduction, dimensions: Sequence[str], outs: Mapping[str, Array]
) -> None:
    """Reduce a small grid that is already computed, by NumPy."""
    for name, array in grid.items():
        rows = np.moveaxis(array, dimensions.index(reduction.axis), -1)
        good = rows == rows
        outs[f"{name}_count"][...] = good.sum(axis=-1)
        counts = good.astype(np.int64)
        for kind in reduction.kinds:
            if kind not in EXTREMES:
                outs[f"{name}_{kind}"][...] = average(kind, rows, counts)
                continue
            at = place(kind, rows, good)
            outs[f"{name}_{kind}_place"][...] = at
            largest = np.abs(rows) if kind == "absmax" else rows
            padded = np.concatenate([largest, np.full_like(rows[..., :1], np.nan)], axis=-1)
            outs[f"{name}_{kind}"][...] = np.take_along_axis(padded, at[..., None], -1)[..., 0]


def named_by_reduction(
    arrays: Mapping[str, Array],
    names: Sequence[str],
    reduction: Reduction,
    axis: Array,
    rest: tuple[str, ...],
) -> dict[str, tuple[tuple[str, ...], Array]]:
    """Results by public name: indices become values of the axis, counts become numbers of skipped points."""
    found: dict[str, tuple[tuple[str, ...], Array]] = {}
    values = np.append(axis, np.nan)  # place -1
    for name in names:
        for kind in reduction.kinds:
            found[f"{name}_{kind}"] = rest, arrays[f"{name}_{kind}"]
            if kind in EXTREMES:
                found[f"{name}_{kind}_{reduction.axis}"] = rest, values[arrays[f"{name}_{kind}_place"]]
        found[f"{name}_skipped"] = rest, axis.size - arrays[f"{name}_count"]
    return found


def reduced_attributes(
    names: Sequence[str], reduction: Reduction, axis: Mapping[str, str], state: bool
) -> dict[str, dict[str, Any]]:
    """CF attributes of the results of `reduced`; `axis` has those of the reduced axis."""
    found: dict[str, dict[str, Any]] = {}
    for name in names:
        own = attributes(name, state)
        for kind in reduction.kinds:
            found[f"{name}_{kind}"] = {**own, "cell_methods": f"{reduction.axis}: {method_of(kind)}"}
            if kind in EXTREMES:
                what = f"{axis['long_name']} of the {kind} of {name}"
                found[f"{name}_{kind}_{reduction.axis}"] = {"units": axis["units"], "long_name": what}
        found[f"{name}_skipped"] = {
            "units": "1",
            "long_name": f"points along {reduction.axis} without a {name} (infeasible, stalled, bad)",
        }
    return found
