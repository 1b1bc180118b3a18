"""Reductions over several axes of arrays in memory, one group of axes after the other.

A number without a value (NaN) is skipped. Where an axis has been reduced already, each number stands for as
many points as it was made of, so that a mean over two axes is that of all their points. What is taken of
pieces of an axis combines to that of the whole in the same way.
"""

from collections.abc import Mapping, Sequence
from math import prod
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .kinds import Extreme, average, kind_called, place

Array = NDArray[Any]
PIECE = "piece"  # the dimension of pieces that are combined


class Field(NamedTuple):
    """Values over dimensions, how many points each stands for, and along which values its extreme is.

    Without counts each stands for one point.
    """

    dims: tuple[str, ...]
    values: Array
    counts: Array | None
    places: Mapping[str, Array]

    def fill(self, region: tuple[slice, ...], part: "Field") -> None:
        """Fill a region with the values, counts and positions of another field."""
        self.values[region] = part.values
        if self.counts is not None:
            self.counts[region] = part.points(())
        for axis, places in part.places.items():
            self.places[axis][region] = places

    def points(self, axes: Sequence[str]) -> Array:
        """The numbers of points along some axes."""
        along = tuple(number for number, axis in enumerate(self.dims) if axis in axes)
        if self.counts is not None:
            return np.asarray(self.counts.sum(axis=along))
        sizes = self.values.shape
        left = [size for number, size in enumerate(sizes) if number not in along]
        return np.full(left, prod(sizes[number] for number in along))


def field_of(dims: Sequence[str], values: Array, places: Mapping[str, Array] = MappingProxyType({})) -> Field:
    """Values of which each that there is stands for one point."""
    good = values == values
    return Field(tuple(dims), values, None if good.all() else good.astype(np.int64), places)


def folded(field: Field, axes: Sequence[str], kind: str, coordinates: Mapping[str, Array]) -> Field:
    """One kind along some axes at once."""
    rest = tuple(name for name in field.dims if name not in axes)
    if not axes:
        return field
    lengths = [field.values.shape[field.dims.index(name)] for name in axes]

    def rows(array: Array) -> Array:
        ends = range(len(rest), len(field.dims))
        moved = np.moveaxis(array, [field.dims.index(name) for name in axes], list(ends))
        return moved.reshape(*moved.shape[: len(rest)], prod(lengths))

    values, total = rows(field.values), field.points(axes)
    counts = None if field.counts is None else rows(field.counts)
    taken_of = kind_called(kind)
    if not isinstance(taken_of, Extreme):
        return Field(rest, np.where(total > 0, average(taken_of, values, counts), np.nan), total, {})
    at = place(taken_of, values, None if counts is None else counts > 0)
    here = np.maximum(at, 0)[..., None]

    def taken(array: Array) -> Array:
        if not array.shape[-1]:
            return np.full(array.shape[:-1], np.nan)
        return np.where(at >= 0, np.take_along_axis(array, here, -1)[..., 0], np.nan)

    index = np.unravel_index(np.maximum(at, 0), lengths) if prod(lengths) else [at] * len(lengths)
    own = {
        axis: np.where(at >= 0, np.append(coordinates[axis], np.nan)[number], np.nan)
        for axis, number in zip(axes, index, strict=True)
    }
    places = {name: taken(rows(array)) for name, array in field.places.items()}
    return Field(rest, taken(taken_of.result(values)), total, {**places, **own})


def combined(parts: Sequence[Field], kind: str) -> Field:
    """One kind over an axis from that over its parts, which are in their order: sums go piece by piece."""
    first = parts[0]
    if len(parts) == 1:
        return first
    values, counts = np.stack([p.values for p in parts], -1), np.stack([p.points(()) for p in parts], -1)
    places = {name: np.stack([p.places[name] for p in parts], -1) for name in first.places}
    whole = Field((*first.dims, PIECE), values, counts, places)
    found = folded(whole, (PIECE,), kind, {PIECE: np.arange(float(len(parts)))})
    return found._replace(places={name: found.places[name] for name in first.places})
