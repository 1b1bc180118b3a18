"""Reductions of one axis of a grid: largest, smallest, mean, ... without storing the grid."""

import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from math import prod
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiler.languages.numba.reductions import EXTREMES, KINDS, outputs_of
from ..mechanism.spelling import did_you_mean
from ..runtime.kernels import KernelKey, kernel_for, key_of
from ..runtime.request import Request
from ..runtime.threads import in_blocks
from ..runtime.tiers import COMPILED, tier_of
from ..support.shown import shown
from .labels import attributes, input_attributes, labelled, provenance

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[Any]
Fill = Callable[[], dict[str, Array]]


NO_STATUS = "a status has no largest or mean: leave it out; each name has a count of skipped points"


class Reduction(NamedTuple):
    """The reductions and the axis that they run along."""

    axis: str
    kinds: tuple[str, ...]


def reduction_of(asked: Any, dimensions: Sequence[str], names: Sequence[str]) -> Reduction:
    """`{"theta": "absmax"}` or `{"theta": ["max", "mean"]}`, checked."""
    if not isinstance(asked, Mapping) or len(asked) != 1:
        raise TypeError(
            f'reduce = {shown(asked)}: one axis and what is taken of it, such as {{"theta": "absmax"}}'
        )
    axis, kinds = next(iter(asked.items()))
    if axis not in dimensions:
        there = ", ".join(dimensions) or "none"
        raise ValueError(
            f"reduce: {axis!r} is no axis of this grid; {did_you_mean(str(axis), dimensions)}axes: {there}"
        )
    if callable(kinds) or not isinstance(kinds, Iterable):
        raise TypeError(
            f"reduce: {axis} = {kinds!r}: expected the name of a reduction or a list of names, "
            f"of {', '.join(KINDS)}"
        )
    kinds = (kinds,) if isinstance(kinds, str) else tuple(dict.fromkeys(kinds))
    for kind in kinds:
        if kind not in KINDS:
            raise ValueError(f"reduce: {kind!r}: {did_you_mean(str(kind), KINDS)}allowed: {', '.join(KINDS)}")
    if not kinds:
        raise ValueError(f"reduce: nothing is taken of {axis}; allowed: {', '.join(KINDS)}")
    if "status" in names:
        raise ValueError(f"reduce: {NO_STATUS}")
    return Reduction(axis, kinds)


def reduced_grid(
    wanted: Request,
    axes: Mapping[str, Array],
    dimensions: Sequence[str],
    reduce: Any,
    branch: int,
    threads: int | None,
    whole: Fill,
    stored: bool = False,
) -> "xr.Dataset":
    """The grid with one axis reduced, labelled; `stored`: by way of the whole grid."""
    reduction = reduction_of(reduce, dimensions, wanted.shown)
    arrays = reduced(wanted, axes, dimensions, reduction, threads, whole, stored)
    state = wanted.form.state
    kept = {name: axis for name, axis in axes.items() if name != reduction.axis}
    told = reduced_attributes(wanted.shown, reduction, input_attributes(reduction.axis), state)
    dataset = labelled({}, kept, branch, state)
    dataset.attrs |= provenance(arrays, kept, branch, wanted.accuracy)
    return dataset.assign({name: (*found, told[name]) for name, found in arrays.items()})


def reduced(
    wanted: Request,
    axes: Mapping[str, Array],
    dimensions: Sequence[str],
    reduction: Reduction,
    threads: int | None,
    whole: Fill,
    stored: bool = False,
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
    if stored or length == 0 or not all(shape) or small:
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
        for kind in reduction.kinds:
            outs[f"{name}_{kind}"][...] = _NUMPY[kind](rows) if rows.shape[-1] else np.nan
            if kind in EXTREMES:
                outs[f"{name}_{kind}_place"][...] = _place(kind, rows, good)


def _place(kind: str, rows: Array, good: Array) -> Array:
    if not rows.shape[-1]:
        return np.full(rows.shape[:-1], -1)
    turned: Array = np.abs(rows) if kind == "absmax" else -rows if kind == "min" else rows
    # Before the first -inf that is a number there may be one that stands for a NaN.
    found = np.argmax(np.where(good, turned, -np.inf) + np.where(good, 0.0, -np.inf), axis=-1)
    found = np.where(np.take_along_axis(good, found[..., None], -1)[..., 0], found, np.argmax(good, axis=-1))
    return np.where(good.any(axis=-1), found, -1)


def _quiet(function: Callable[..., Any]) -> Callable[[Array], Array]:
    def reduced_rows(rows: Array) -> Array:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore", RuntimeWarning)  # a row without a number is NaN
            return np.asarray(function(rows))

    return reduced_rows


def _rms(rows: Array) -> Array:
    largest = np.nanmax(np.where(np.isinf(rows), np.nan, np.abs(rows)), axis=-1, keepdims=True)
    factor = np.ldexp(1.0, -np.frexp(np.where(largest > 0.0, largest, 1.0))[1].clip(-1000, 1000))
    return np.asarray(np.sqrt(np.nanmean((rows * factor) ** 2, axis=-1)) / factor[..., 0])


_NUMPY: dict[str, Callable[[Array], Array]] = {
    "max": _quiet(lambda rows: np.nanmax(rows, axis=-1)),
    "min": _quiet(lambda rows: np.nanmin(rows, axis=-1)),
    "absmax": _quiet(lambda rows: np.nanmax(np.abs(rows), axis=-1)),
    "mean": _quiet(lambda rows: np.nanmean(rows, axis=-1)),
    "rms": _quiet(_rms),
}


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
            found[f"{name}_{kind}"] = {**own, "cell_methods": f"{reduction.axis}: {KINDS[kind]}"}
            if kind in EXTREMES:
                what = f"{axis['long_name']} of the {kind} of {name}"
                found[f"{name}_{kind}_{reduction.axis}"] = {"units": axis["units"], "long_name": what}
        found[f"{name}_skipped"] = {
            "units": "1",
            "long_name": f"points along {reduction.axis} without a {name} (infeasible, stalled, bad)",
        }
    return found
