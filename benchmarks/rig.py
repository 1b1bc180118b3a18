"""The timing rig of the benchmarks: one call, or several in turns."""

import random
import time
from collections.abc import Callable, Mapping
from typing import Any


def timed(run: Callable[[], Any], clock: Callable[[], float] = time.perf_counter) -> tuple[float, Any]:
    """Seconds of a call, and what it returns."""
    started = clock()
    result = run()
    return clock() - started, result


def in_turns(runs: Mapping[str, Callable[[], Any]], rounds: int, seed: int = 0) -> dict[str, float]:
    """The least seconds of each of several calls in some rounds, each with every call in turn.

    The order changes from round to round: who comes after a slow one finds the caches cold. A round before
    the first one compiles and does not count.
    """
    best = dict.fromkeys(runs, float("inf"))
    turns, rng = list(runs), random.Random(seed)
    for number in range(rounds + 1):
        rng.shuffle(turns)
        for name in turns:
            seconds, _ = timed(runs[name])
            if number:
                best[name] = min(best[name], seconds)
    return best
