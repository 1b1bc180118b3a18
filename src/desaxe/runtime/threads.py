"""Blocks of the outermost axis, shared by threads; the answer is the same for any number of them."""

import os
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from .kernels import KernelKey, kernel_for

if TYPE_CHECKING:
    from concurrent.futures import ThreadPoolExecutor

# A block smaller than this costs more to hand out than to compute.
LEAST_BLOCK = 20_000


def available() -> int:
    """How many cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


@cache
def _pool(threads: int) -> "ThreadPoolExecutor":
    from concurrent.futures import ThreadPoolExecutor  # logging comes with it

    return ThreadPoolExecutor(threads, thread_name_prefix="desaxe")


def run_in_blocks(
    key: KernelKey, values: Mapping[str, Any], outs: Sequence[Any], threads: int | None
) -> None:
    """Run the kernel of a key over its outermost axis in as many blocks as there are threads."""
    kernel = kernel_for(key)
    outer = {name for name, axis in kernel.axis_of if axis == 0}

    def block(start: int, stop: int) -> None:
        part = {name: v[start:stop] if name in outer else v for name, v in values.items()}
        places = [out[start:stop] for out in outs]
        if kernel.run(part, places):
            from .near_limit import decide

            decide(key, part, places)

    in_blocks(block, outs[0].shape[0], outs[0].size, threads)


def in_blocks(block: Callable[[int, int], None], length: int, points: int, threads: int | None) -> None:
    """Call `block(start, stop)` for as many parts of an axis as there are threads that pay for its points."""
    run_parts(block, length, threads, max(1, LEAST_BLOCK * length // max(points, 1)))


def run_parts(part: Callable[[int, int], None], length: int, threads: int | None, least: int) -> None:
    """Call `part(start, stop)` for parts of a length, one a thread, none shorter than `least`."""
    most = length // least
    count = min(threads or available(), most) if most > 1 else 1
    if count == 1:
        part(0, length)
        return
    edges = [length * k // count for k in range(count + 1)]
    for done in [_pool(count).submit(part, a, b) for a, b in pairwise(edges)]:
        done.result()
