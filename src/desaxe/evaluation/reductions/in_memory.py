"""Reductions over several axes of arrays in memory, one group of axes after the other.

A number without a value (NaN) is skipped. Where an axis has been reduced already, each number stands for as
many points as it was made of, so that a mean over two axes is that of all their points. What is taken of
pieces of an axis combines to that of the whole in the same way.
"""

from collections.abc import Mapping, Sequence
from math import prod
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .kinds import Extreme, average, kind_called, place

Array = NDArray[Any]
PIECE = "piece"  # the dimension of pieces that are combined


class Field(NamedTuple):
    """Values over dimensions, how many points each stands for, and along which values its extreme is."""

    dims: tuple[str, ...]
    values: Array
    counts: Array
    places: Mapping[str, Array]

    def counted_anew(self) -> "Field":
        """Each value that there is as one point."""
        return self._replace(counts=(self.values == self.values).astype(np.int64))


def field_of(dims: Sequence[str], values: Array) -> Field:
    """Values of which none is reduced."""
    return Field(tuple(dims), values, np.empty(0), {}).counted_anew()


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

    values, counts = rows(field.values), rows(field.counts)
    total = counts.sum(axis=-1)
    taken_of = kind_called(kind)
    if not isinstance(taken_of, Extreme):
        return Field(rest, np.where(total > 0, average(taken_of, values, counts), np.nan), total, {})
    at = place(taken_of, values, counts > 0)
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
    values, counts = np.stack([p.values for p in parts], -1), np.stack([p.counts for p in parts], -1)
    places = {name: np.stack([p.places[name] for p in parts], -1) for name in first.places}
    whole = Field((*first.dims, PIECE), values, counts, places)
    found = folded(whole, (PIECE,), kind, {PIECE: np.arange(float(len(parts)))})
    return found._replace(places={name: found.places[name] for name in first.places})
