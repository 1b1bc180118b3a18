"""Time per point of each contender, measured in one process, alternating, on one core."""

from collections.abc import Sequence
from functools import partial

import numpy as np

from desaxe.oracle.families import points

from ..rig import in_turns
from .contenders import INPUTS, NAMES, Array, Contender

DRAWN = 2000  # different points; they are repeated
FEW = 20  # for those who are slow


def times(who: Sequence[Contender], count: int, rounds: int, seed: int) -> dict[str, float]:
    """Seconds for one generic point: the best of several rounds, each with everyone in turn."""
    inputs, outputs = _inputs(count, seed), np.empty((len(NAMES), count))
    few, few_outputs = np.ascontiguousarray(inputs[:, :FEW]), np.empty((len(NAMES), FEW))
    works = {one.name: (few, few_outputs) if one.few else (inputs, outputs) for one in who}
    result = in_turns({one.name: partial(one.make(1), *works[one.name]) for one in who}, rounds, seed)
    return {name: seconds / works[name][0].shape[1] for name, seconds in result.items()}


def _inputs(count: int, seed: int) -> Array:
    """Generic points in an order of their own, so that no pattern in them can be learnt."""
    drawn = list(points("generic", DRAWN, seed))
    columns = np.array([[point[name] for point in drawn] for name in INPUTS])
    order = np.random.default_rng(seed).integers(0, DRAWN, count)
    return np.ascontiguousarray(columns[:, order])
