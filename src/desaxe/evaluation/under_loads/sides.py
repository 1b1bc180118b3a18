"""On which side of a jump of a load samples are, from their values and those at the doubles next to them."""

from collections.abc import Mapping
from math import inf
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...loads.along_motion import members_of
from ...loads.angles import crossings
from ...loads.load import Load, OverTheta, OverY
from ...loads.table import SAME
from ...mechanism.closed import TURN
from ...mechanism.closed.angles import dead_centres
from ...mechanism.names import LENGTHS
from ..points import Points

Array = NDArray[Any]
NEAR = 1e-11  # of 1 + theta: more than what is rounded of the angle of a jump


def sides_of(name: str, source: Points, points: Mapping[str, Array]) -> NDArray[np.int8]:
    """-1 for a sample that is the last one before a jump, 1 for the first one after it, else 0."""
    size = points["theta"].size
    points = {**{n: np.full(size, value) for n, value in source.numbers}, **points}
    side = np.zeros(size, np.int8)
    loads = members_of(() if source.loads is None else source.loads.loads.values())
    near = np.logical_or.reduce([_near(load, points, source.branch) for load in loads])
    rows = np.flatnonzero(near)
    if rows.size:
        some = {n: column[rows] for n, column in points.items()}
        beside = [np.nextafter(some["theta"], end) for end in (-inf, inf)]
        before, here, after = (
            source.at({**some, "theta": theta})[name] for theta in (beside[0], some["theta"], beside[1])
        )
        side[rows] = 1 * _differ(here, before) - 1 * _differ(here, after)
    return side


def _differ(one: Array, other: Array) -> NDArray[np.bool_]:
    apart: NDArray[np.bool_] = ~(np.abs(one - other) <= SAME * np.maximum(np.abs(one), np.abs(other)))
    return apart


def _near(load: Load, points: Mapping[str, Array], branch: int) -> NDArray[np.bool_]:
    """Mask of the samples that are within rounding of a jump of a load."""
    theta = points["theta"]
    if isinstance(load, OverTheta):
        return _near_nodes(np.array(load.nodes(0.0, load.period, smooth=False)), load.period, theta)
    if not isinstance(load, OverY):
        return np.zeros(theta.size, np.bool_)
    lengths = [points[n] for n in LENGTHS]
    angles = [crossings(load, load.jumps, lengths, branch), *([dead_centres(lengths)] if load.turns else [])]
    away = theta[:, None] - np.concatenate(angles, axis=1)
    away -= TURN * np.round(away / TURN)
    near: NDArray[np.bool_] = (np.abs(away) <= NEAR * (1.0 + np.abs(theta[:, None]))).any(axis=1)
    return near


def _near_nodes(nodes: Array, period: float, theta: Array) -> NDArray[np.bool_]:
    """Mask of the angles that are within rounding of one of the sorted nodes of a period."""
    if not nodes.size:
        return np.zeros(theta.size, np.bool_)
    nodes = np.concatenate([nodes[-1:] - period, nodes, nodes[:1] + period])
    rest = theta - period * np.floor(theta / period)
    after = np.searchsorted(nodes, rest).clip(1, nodes.size - 1)
    away = np.minimum(np.abs(rest - nodes[after - 1]), np.abs(rest - nodes[after]))
    near: NDArray[np.bool_] = away <= NEAR * (1.0 + np.abs(theta))
    return near
