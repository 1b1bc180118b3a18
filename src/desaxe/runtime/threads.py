"""Blocks of the outermost axis, shared by threads; the results do not depend on their number.

No block runs for long: between two of them an interrupt is heard, and it stops all threads.
"""

import os
from collections.abc import Callable, Sequence
from contextvars import copy_context
from itertools import pairwise
from threading import Event
from typing import TYPE_CHECKING

from ..support.forks import IMPORTS, in_child
from ..support.signals import put_off

if TYPE_CHECKING:
    from concurrent.futures import Future, ThreadPoolExecutor

MOST_THREADS = 256
LONGEST_BLOCK = 4_000_000  # points: half a second for the costliest kernels
# A smaller block costs more to hand out, some 80 us, than to compute: the light one for few values a point.
LEAST_BLOCK, LEAST_LIGHT_BLOCK = 20_000, 80_000
HEAVY = 8  # values of a point, each of 0.5 ns or more
PARTS = 4  # of each thread: one that wakes late leaves some to the others


def available() -> int:
    """The number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


_POOLS: "dict[int, ThreadPoolExecutor]" = {}
_INHERITED: "list[ThreadPoolExecutor]" = []  # in a forked child: pools without threads, never touched again


def pool(threads: int) -> "ThreadPoolExecutor":
    """The pool of this number of threads, created on first use."""
    result = _POOLS.get(threads)
    if result is None:
        with IMPORTS:
            from concurrent.futures import ThreadPoolExecutor  # logging comes with it

        result = _POOLS.setdefault(threads, ThreadPoolExecutor(threads, thread_name_prefix="desaxe"))
    return result


def _forget_pools() -> None:
    _INHERITED.extend(_POOLS.values())
    _POOLS.clear()


in_child(_forget_pools)


def run_parts(
    part: Callable[[int, int], None], length: int, threads: int | None, least: int, longest: int
) -> None:
    """Call `part(start, stop)` for all parts of a length, on threads with at least `least` of it each.

    No part is longer than `longest`. An exception, or an interrupt of the caller, ends the work of all
    threads after the part that each of them is in.
    """
    most = length // least
    workers = min(threads or available(), most, MOST_THREADS) if most > 1 else 1
    count = max(1, min(length, max(workers * PARTS if workers > 1 else 1, -(-length // longest))))
    edges = pairwise(length * k // count for k in range(count + 1))
    if workers == 1:
        for start, stop in edges:
            part(start, stop)
        return
    ways, stopped = list(edges)[::-1], Event()

    def work() -> None:
        while ways and not stopped.is_set():
            try:
                start, stop = ways.pop()
            except IndexError:  # another thread was faster
                return
            try:
                part(start, stop)
            except BaseException:
                stopped.set()
                raise

    run_together([work] * workers, stopped)


def run_together(works: Sequence[Callable[[], None]], stopped: Event) -> None:
    """Run each function, the first on the caller's thread; if one fails or is interrupted, set `stopped`.

    A caller that only waited would leave its core to a thread that it wakes, often to both of two. A function
    that no thread has begun when the first returns finds nothing to do, and is not waited for: the threads
    may be busy with another caller's work. However often it is interrupted, it returns when all have ended:
    they write into the caller's arrays.
    """
    with IMPORTS:
        from concurrent.futures import wait

    first, *others = works
    begun: list[Future[None]] = []
    with put_off(stopped.set):
        try:
            begun.extend(pool(len(others)).submit(copy_context().run, work) for work in others)
            first()
            for done in begun:
                if not done.cancel():
                    done.result()
        except BaseException:
            stopped.set()
            wait(begun)
            raise
