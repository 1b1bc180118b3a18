"""The kinds of reductions: a row each, and what they are of arrays in memory along some of their axes.

A number without a value (NaN) is skipped. Where an axis has been reduced already, each number stands for as
many points as it was made of, so that a mean over two axes is that of all their points. What is taken of
pieces of an axis combines to that of the whole in the same way.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from math import prod
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...mechanism.spelling import did_you_mean
from ...support.forks import imported
from ...support.shown import shown

Array = NDArray[Any]
PIECE = "piece"  # the dimension of pieces that are combined


class Kind(NamedTuple):
    """A kind of reduction.

    method    as CF's `cell_methods` say it
    of_rows   of an extreme its result, from the sample; of an average the number made of rows, and of the
              numbers of points that each of their values stands for: one without
    score     of an extreme: the sample of a row with the largest one is taken
    combines  whether that of a row follows from those of its parts; exported modules have these
    """

    method: str
    of_rows: Callable[..., Array] = np.asarray
    score: Callable[[Array], Array] | None = None
    combines: bool = True


def exact_sum(rows: Array) -> Array:
    """The sum of each row, as if its rounding were that of a few operations; infinite where a value is.

    Beside a power of two that is larger than the sum of magnitudes each number splits into a high part, whose
    sum is exact, and a small rest.
    """
    largest = np.abs(rows).max(axis=-1, keepdims=True, initial=0.0)
    power = np.ldexp(1.0, np.minimum(np.frexp(largest)[1] + rows.shape[-1].bit_length(), 1023))
    high = (rows + power) - power
    total = high.sum(axis=-1) + (rows - high).sum(axis=-1)
    return np.asarray(np.where(np.isfinite(total), total, rows.sum(axis=-1)))


def _mean(rows: Array, counts: Array | None) -> Array:
    if counts is None:
        return np.asarray(exact_sum(rows) / rows.shape[-1])
    return np.asarray(exact_sum(np.where(counts > 0, rows * counts, 0.0)) / counts.sum(axis=-1))


def _scaled_root(rows: Array, counts: Array | None) -> Array:
    """The root of the mean square, of any scale: a power of two brings the squares into range."""
    sizes = np.abs(rows).max(axis=-1, initial=0.0)
    if ((sizes < 2.0**500) & (sizes > 2.0**-400)).all():
        return np.asarray(np.sqrt(_mean(rows * rows, counts)))
    finite = np.where(np.isinf(rows), np.nan, np.abs(rows))
    largest = np.fmax.reduce(finite, axis=-1, keepdims=True)  # NaN for a row without a number
    factor = np.ldexp(1.0, -np.frexp(np.where(largest > 0.0, largest, 1.0))[1].clip(-1000, 1000))
    return np.asarray(np.sqrt(_mean((rows * factor) ** 2, counts)) / factor[..., 0])


def _deviation(rows: Array, counts: Array | None) -> Array:
    return _scaled_root(rows - _mean(rows, counts)[..., None], counts)


def _percentile(percent: float, rows: Array, counts: Array | None) -> Array:
    imported("numpy.ma")  # by `nanpercentile`
    empty = np.asarray(np.isnan(rows).all(axis=-1))
    values = np.nanpercentile(np.where(empty[..., None], 0.0, rows), percent, axis=-1)
    return np.asarray(np.where(empty, np.nan, values))


KINDS = {
    "max": Kind("maximum", score=np.asarray),
    "min": Kind("minimum", score=np.negative),
    "absmax": Kind("maximum_absolute_value", np.abs, np.abs),
    "mean": Kind("mean", _mean),
    "rms": Kind("root_mean_square", _scaled_root),
    "std": Kind("standard_deviation", _deviation, combines=False),  # of all points, divided by their number
    "median": Kind("median", partial(_percentile, 50.0), combines=False),
}
NAMES = tuple(KINDS)
ALLOWED = f"{', '.join(NAMES)}, and percentiles such as p95"


def kind_name(kind: Any) -> str:
    """A kind as it is called: "max", "std", "p95"."""
    if isinstance(kind, (tuple, list)) and len(kind) == 2 and kind[0] == "percentile":
        kind = f"p{kind[1]:g}" if isinstance(kind[1], (int, float)) else f"p{kind[1]}"
    if isinstance(kind, str) and kind in KINDS:
        return kind
    if isinstance(kind, str) and re.fullmatch(r"p\d+(\.\d+)?", kind):
        if float(kind[1:]) > 100.0:
            raise ValueError(f"reduce: {kind!r}: a percentile is from p0 to p100")
        return f"p{float(kind[1:]):g}"
    raise ValueError(f"reduce: {shown(kind)}: {did_you_mean(str(kind)[:40], tuple(KINDS))}allowed: {ALLOWED}")


def kind_of(name: str) -> Kind:
    """The kind of a name that `kind_name` gives."""
    return KINDS.get(name) or Kind(
        f"percentile_{name[1:]}", partial(_percentile, float(name[1:])), combines=False
    )


class Field(NamedTuple):
    """Values over dimensions, how many points each stands for, and along which values its extreme is.

    Without counts each stands for one point.
    """

    dims: tuple[str, ...]
    values: Array
    counts: Array | None
    places: Mapping[str, Array]

    @property
    def points(self) -> Array:
        """The counts."""
        return np.ones(self.values.shape, np.int64) if self.counts is None else self.counts


def field_of(dims: Sequence[str], values: Array, places: Mapping[str, Array] = MappingProxyType({})) -> Field:
    """Values of which each that there is stands for one point."""
    good = values == values
    return Field(tuple(dims), values, None if good.all() else good.astype(np.int64), places)


def folded(field: Field, axes: Sequence[str], name: str, coordinates: Mapping[str, Array]) -> Field:
    """The kind of a name along some axes at once."""
    if not axes:
        return field
    rest, kind = tuple(dim for dim in field.dims if dim not in axes), kind_of(name)
    lengths = [field.values.shape[field.dims.index(axis)] for axis in axes]

    def rows(array: Array) -> Array:
        ends = range(len(rest), len(field.dims))
        moved = np.moveaxis(array, [field.dims.index(axis) for axis in axes], list(ends))
        return moved.reshape(*moved.shape[: len(rest)], prod(lengths))

    values, counts = rows(field.values), None if field.counts is None else rows(field.counts)
    total = np.full(values.shape[:-1], values.shape[-1]) if counts is None else counts.sum(axis=-1)
    if kind.score is None:
        return Field(rest, np.where(total > 0, _average(kind, values, counts), np.nan), total, {})
    at = _place(kind.score(values), counts)
    here, lost = np.maximum(at, 0)[..., None], at < 0

    def taken(array: Array) -> Array:
        there = np.take_along_axis(array, here, -1)[..., 0] if array.shape[-1] else np.nan
        return np.where(lost, np.nan, there)

    index = np.unravel_index(here[..., 0], lengths) if prod(lengths) else [at] * len(lengths)
    own = {
        axis: np.where(lost, np.nan, np.append(coordinates[axis], np.nan)[number])
        for axis, number in zip(axes, index, strict=True)
    }
    before = {axis: taken(rows(array)) for axis, array in field.places.items()}
    return Field(rest, taken(kind.of_rows(values)), total, {**before, **own})


def _place(scores: Array, counts: Array | None) -> Array:
    """The index of the largest score of each row, the first of equals; -1 where nothing counts."""
    if not scores.shape[-1]:
        return np.full(scores.shape[:-1], -1)
    if counts is None:
        return np.asarray(np.argmax(scores, axis=-1))
    # Before the first -inf that is a number there may be one that stands for a NaN.
    good = counts > 0
    first = np.argmax(np.where(good, scores, -np.inf) + np.where(good, 0.0, -np.inf), axis=-1)
    first = np.where(np.take_along_axis(good, first[..., None], -1)[..., 0], first, np.argmax(good, axis=-1))
    return np.where(good.any(axis=-1), first, -1)


def _average(kind: Kind, rows: Array, counts: Array | None) -> Array:
    """A mean, a percentile or another average of each row."""
    if not rows.shape[-1]:
        return np.full(rows.shape[:-1], np.nan)
    with np.errstate(all="ignore"):  # a row without a number is NaN; filters of warnings are of all threads
        return kind.of_rows(rows, counts)


def combined(parts: Sequence[Field], name: str) -> Field:
    """One kind over an axis from that over its parts, which are in their order: sums go piece by piece."""
    first = parts[0]
    if len(parts) == 1:
        return first
    columns = ((part.values, part.counts, *part.places.values()) for part in parts)
    stacked = [np.stack(arrays, -1) for arrays in zip(*columns, strict=True)]
    places = dict(zip(first.places, stacked[2:], strict=True))
    whole = Field((*first.dims, PIECE), stacked[0], stacked[1], places)
    result = folded(whole, (PIECE,), name, {PIECE: np.arange(float(len(parts)))})
    return result._replace(places={axis: result.places[axis] for axis in first.places})
