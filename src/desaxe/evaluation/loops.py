"""Broadcast inputs as a loop nest: the loop that each input varies along.

A sweep of a column of designs over a row of angles needs the sine of an angle once, not once a design. Where
every input varies along one loop alone, the kernel is a nest of loops; else it is one loop over all points.
"""

from collections.abc import Mapping, Sequence
from math import prod
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

NESTED = 200_000  # points from which a nest of loops, a kernel of its own, is worth its compilation
INNERMOST = 64  # points: a shorter innermost loop costs more to start than it saves


class Loops(NamedTuple):
    """The lengths of the loops, outermost first; for each input its values along its loop, and which one."""

    sizes: tuple[int, ...]
    columns: dict[str, Array]
    axis_of: dict[str, int]


def loops_over(arrays: Mapping[str, Array], shape: Sequence[int]) -> Loops:
    """The loops for arrays that broadcast to a shape; none of them is a number."""
    nested = _nested(arrays, shape) if prod(shape) >= NESTED else None
    if nested is not None:
        return nested
    columns = {name: _column(array, shape) for name, array in arrays.items()}
    return Loops((prod(shape),), columns, dict.fromkeys(columns, 0))


def _nested(arrays: Mapping[str, Array], shape: Sequence[int]) -> Loops | None:
    """A nest of loops, if there is one that pays."""
    along = {name: _varies_along(array, shape) for name, array in arrays.items()}
    groups: list[list[int]] = []
    for axis in (axis for axis, size in enumerate(shape) if size > 1):
        together = groups and _inputs(along, groups[-1][-1]) == _inputs(along, axis)
        groups = [*groups[:-1], [*groups[-1], axis]] if together else [*groups, [axis]]
    place = {axis: place for place, group in enumerate(groups) for axis in group}
    places = {name: {place[axis] for axis in axes} for name, axes in along.items()}
    sizes = tuple(prod(shape[axis] for axis in group) for group in groups)
    if len(groups) < 2 or sizes[-1] < INNERMOST or any(len(own) > 1 for own in places.values()):
        return None
    columns = {name: _column(array, array.shape) for name, array in arrays.items()}
    return Loops(sizes, columns, {name: min(own) for name, own in places.items()})


def _varies_along(array: Array, shape: Sequence[int]) -> set[int]:
    """The axes of the shape along which an array has more than one value."""
    lead = len(shape) - array.ndim
    return {lead + axis for axis, size in enumerate(array.shape) if size > 1}


def _inputs(along: Mapping[str, set[int]], axis: int) -> set[str]:
    return {name for name, axes in along.items() if axis in axes}


def _column(array: Array, shape: Sequence[int]) -> Array:
    return np.ascontiguousarray(np.broadcast_to(array, shape)).reshape(-1)


def spread(column: Array, axis: int, shape: Sequence[int]) -> Array:
    """The values along one axis, repeated for each point of a shape, in its order: a contiguous copy."""
    own = [-1 if k == axis else 1 for k in range(len(shape))]
    return np.broadcast_to(column.reshape(own), shape).flatten()
