"""Designs in their order: the best of a block, and the best of two."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..evaluation.plan import Block, Part

Array = NDArray[Any]


class BestDesigns(NamedTuple):
    """The best designs of some chunks: flat indices, values, angles, number of points without a value."""

    places: NDArray[np.int64]
    values: Array
    theta: Array
    skipped: Array
    feasible: int
    points: int


class Ranking(NamedTuple):
    """The criterion of a ranking of designs; for the tasks of a sweep, what is taken of their blocks.

    name      the quantity
    kind      max, min or absmax, or a mean: what is taken of it
    order     which end is the best: "smallest" or "largest"
    variable  the variable of a block that is compared
    axis      the reduced axis, if there is one
    most      how many designs are searched
    shape     the lengths of the dimensions of the whole
    """

    name: str
    kind: str
    order: str
    variable: str
    axis: str | None
    most: int
    shape: tuple[int, ...]

    def rank(self, values: Array) -> Array:
        """The place of values of a block in the ranking: the smallest comes first."""
        compared = np.abs(values) if self.variable == self.name and self.kind == "absmax" else values
        return compared if self.order == "smallest" else -compared

    def left(self, part: Part) -> list[str]:
        """The outputs of a part that are to be computed."""
        return list(part.step.outputs)

    def take(self, block: Block, part: Part, arrays: dict[str, Array], points: int) -> BestDesigns:
        """The best designs of a block."""
        values = arrays[self.variable]
        rank = self.rank(values).reshape(-1)
        order = np.argsort(rank, kind="stable")[: self.most]  # NaN comes last
        order = order[~np.isnan(rank[order])]
        places = np.zeros(order.size, np.int64)
        if values.ndim:
            local = np.unravel_index(order, values.shape)
            whole = tuple(i + region.start for i, region in zip(local, part.region, strict=True))
            places = np.ravel_multi_index(whole, self.shape).astype(np.int64)
        flat = {n: a.reshape(-1)[order] for n, a in arrays.items()}
        angles = skipped = np.full(order.size, np.nan)
        feasible = int((~np.isnan(rank)).sum())
        if self.axis is not None:
            every = arrays[f"{self.name}_skipped"]
            feasible = int(every.size * block.values[self.axis].size - every.sum())
            angles, skipped = flat.get(f"{self.variable}_{self.axis}", angles), flat[f"{self.name}_skipped"]
        return BestDesigns(places, flat[self.variable], angles, skipped, feasible, points)

    def combine(self, one: BestDesigns | None, other: BestDesigns) -> BestDesigns:
        """The best of two; of equal ones the earlier in the grid, whichever chunk was done first."""
        if one is None:
            return other
        columns = (np.concatenate([a, b]) for a, b in zip(one[:4], other[:4], strict=True))
        places, values, theta, skipped = columns
        order = np.lexsort((places, self.rank(values)))[: self.most]
        feasible, points = one.feasible + other.feasible, one.points + other.points
        return BestDesigns(places[order], values[order], theta[order], skipped[order], feasible, points)
