"""The slope of a user's function over theta by differences, where it was not given: it leads a search."""

from collections.abc import Mapping
from dataclasses import replace
from math import inf
from typing import Any, NamedTuple

import numpy as np

from ..loads.function import FunctionOverTheta
from ..loads.load import Load

STEP = 2.0**-6  # rad
# Of a derivative from eight neighbours: (distance in steps, weight), exact for polynomials of degree 8.
STENCIL = ((1, 4 / 5), (2, -1 / 5), (3, 4 / 105), (4, -1 / 280))
PLACES = np.arange(
    -4.0, 5.0
)  # of nine values in steps, and from these the slope of their polynomial by powers
BY_POWERS = np.arange(1.0, 9.0)[:, None] * np.linalg.inv(np.vander(PLACES, increasing=True))[1:]


def with_slopes(loads: Mapping[str, Load], low: float, high: float) -> dict[str, Load]:
    """The loads, with the derivative of a user's function by differences where it was not given.

    They only lead the search: what it finds is a value of the function itself.
    """
    return {
        name: replace(load, derivative=Differences(load, _nodes(load, low, high)).at)
        if isinstance(load, FunctionOverTheta) and not load.has_slope
        else load
        for name, load in loads.items()
    }


def _nodes(load: FunctionOverTheta, low: float, high: float) -> tuple[float, ...]:
    """The nodes of a function in a range, and one or more on either side."""
    return tuple(load.nodes(low - 2.0 * load.period, high + 2.0 * load.period, smooth=False))


class Differences(NamedTuple):
    """The derivative of a load by differences; `nodes` are those at which it may jump."""

    load: FunctionOverTheta
    nodes: tuple[float, ...]

    def at(self, theta: Any) -> Any:
        """The derivative at a number or an array."""
        theta = np.asarray(theta, float)
        if self.nodes:
            return self._between(theta)
        total = np.zeros(theta.shape)
        for steps, weight in STENCIL:
            ahead, behind = (self.load.value(theta + side * steps * STEP) for side in (1.0, -1.0))
            total += weight * (ahead - behind)
        return total / STEP

    def _between(self, theta: Any) -> Any:
        """The derivative from values between the nodes on both sides: none from beyond a jump."""
        after = np.searchsorted(self.nodes, theta, side="right")
        low, high = np.array(self.nodes)[after - 1], np.nextafter(self.nodes, -inf)[after]
        step = np.minimum(STEP, 0.125 * (high - low))
        centre = np.clip(theta, low + 4.0 * step, high - 4.0 * step)
        found = self.load.value(np.clip(centre + PLACES.reshape(-1, *[1] * theta.ndim) * step, low, high))
        powers = ((theta - centre) / step) ** np.arange(8.0).reshape(-1, *[1] * theta.ndim)
        return (np.tensordot(BY_POWERS, found, axes=1) * powers).sum(axis=0) / step
