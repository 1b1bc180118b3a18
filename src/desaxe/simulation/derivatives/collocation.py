"""Linear equations of order two on panels of time, by collocation at Gauss nodes.

    x'' = a(t) x + b(t) x' + c(t)

is solved on every panel for the two starts (1, 0) and (0, 1) and for each column of c at once; panels are
then joined one after the other, by whoever knows what happens between two of them.
"""

from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from ..panel import NODES, ONCE, PLACES, RUNNING, SERIES

Array = NDArray[np.float64]
TWICE = legendre.legint(ONCE, lbnd=-1, axis=0) / 2.0
RUNNING_TWICE = legendre.legvander(2.0 * PLACES - 1.0, NODES + 1) @ TWICE @ SERIES
LEAST = 1e-12  # of a column's largest coefficient: a panel with less need not resolve it


class Local(NamedTuple):
    """Solutions on panels: series of h^2 x'' for the starts (x, h x') = (1, 0), (0, 1) and each column."""

    h: Array
    series: Array  # panels, NODES, 2 + columns


def solve(h: Array, a: Array, b: Array, c: Array) -> Local:
    """The solutions on panels of the lengths h; a, b at the nodes: panels, NODES; c: columns besides."""
    with np.errstate(invalid="ignore", over="ignore"):
        a, b, c = a * h[:, None] ** 2, b * h[:, None], c * h[:, None, None] ** 2
        matrix = np.eye(NODES) - a[:, :, None] * RUNNING_TWICE - b[:, :, None] * RUNNING
        right = np.concatenate([a[..., None], (a * PLACES + b)[..., None], c], axis=2)
        known = np.isfinite(matrix).all(axis=(1, 2)) & np.isfinite(right).all(axis=(1, 2))
        found = np.full(right.shape, np.nan)
        found[known] = SERIES @ np.linalg.solve(matrix[known], right[known])
    return Local(h, found)


class Trajectories(NamedTuple):
    """x and x' of every column on consecutive panels, each from its start."""

    start: Array
    h: Array
    x: Array  # panels, columns
    y: Array  # h x'
    series: Array  # panels, NODES, columns

    def at(self, t: Array) -> tuple[Array, Array]:
        """x and x' at instants: instants, columns; where two panels meet, at the end of the first."""
        ends = self.start[1:]
        panel = np.searchsorted(ends, t)
        s = (t - self.start[panel]) / np.where(self.h[panel] > 0.0, self.h[panel], 1.0)
        x, y, series = self.x[panel], self.y[panel], self.series[panel]
        once = legendre.legvander(2.0 * s - 1.0, NODES) @ ONCE
        twice = legendre.legvander(2.0 * s - 1.0, NODES + 1) @ TWICE
        moved = s[:, None] != 0.0  # at a start nothing is rounded
        position = x + moved * (s[:, None] * y + np.einsum("ij,ijk->ik", twice, series))
        change = y + moved * np.einsum("ij,ijk->ik", once, series)
        return position, change / np.where(self.h[panel] > 0.0, self.h[panel], 1.0)[:, None]

    def unresolved(self, tolerance: float) -> NDArray[np.bool_]:
        """The panels on which the last terms of a series are more than this share of what it is added to."""
        tail = np.abs(self.series[:, -2:]).max(axis=1)
        size = np.maximum(np.abs(self.x) * LEAST, np.abs(self.y)) + np.abs(self.series).max(axis=1)
        with np.errstate(invalid="ignore"):
            least = LEAST * np.nanmax(size, axis=0, initial=0.0)
            bad: NDArray[np.bool_] = (tail > tolerance * np.maximum(size, least)).any(axis=1)
        return bad
