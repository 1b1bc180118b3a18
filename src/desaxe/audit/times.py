"""Time per point of each contender, measured in one process, alternating, on one core."""

import random
import time
from collections.abc import Sequence

import numpy as np

from ..oracle.families import points
from .contenders import INPUTS, NAMES, Array, Contender

DRAWN = 2000  # different points; they are repeated
FEW = 20  # for those who are slow


def times(who: Sequence[Contender], count: int, rounds: int, seed: int) -> dict[str, float]:
    """Seconds for one generic point: the best of several rounds, each with everyone in turn.

    The order changes from round to round: who comes after a slow one finds the caches cold.
    """
    inputs, outputs = _inputs(count, seed), np.empty((len(NAMES), count))
    few, few_outputs = np.ascontiguousarray(inputs[:, :FEW]), np.empty((len(NAMES), FEW))
    runs = {one.name: one.make(1) for one in who}
    best = dict.fromkeys(runs, float("inf"))
    turns, rng = list(who), random.Random(seed)
    for number in range(rounds + 1):
        rng.shuffle(turns)
        for one in turns:
            work = (few, few_outputs) if one.few else (inputs, outputs)
            started = time.perf_counter()
            runs[one.name](*work)
            taken = (time.perf_counter() - started) / work[0].shape[1]
            if number:  # the first round compiles
                best[one.name] = min(best[one.name], taken)
    return best


def _inputs(count: int, seed: int) -> Array:
    """Generic points in an order of their own, so that no pattern in them can be learnt."""
    drawn = list(points("generic", DRAWN, seed))
    columns = np.array([[point[name] for point in drawn] for name in INPUTS])
    order = np.random.default_rng(seed).integers(0, DRAWN, count)
    return np.ascontiguousarray(columns[:, order])
