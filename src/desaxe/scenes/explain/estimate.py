"""Time and memory before anything runs, from what operations cost.

The table of operations has each cost in additions; a loop that vectorises spends about the same time
on each of these, whatever the kernel: 0.024 to 0.038 ns on a core with AVX-512 from one kernel to the
next, from 82 additions a point to 1034. `python -m benchmarks.startup` measures the rest.
"""

from collections.abc import Sequence

from .loops import LoopCost

ADDITION = 0.03e-9  # s, in a vectorised loop on one core
STORE = 0.4e-9  # s to write a double that does not stay in the cache
PLAIN = 40e-9  # s for an operation in plain Python, with what surrounds it
PLAIN_POINT = 2e-6  # s for a point besides its operations
IMPORT = 0.6  # s for numba and its tables in a process that has not used it yet
LOAD = 0.06  # s to load a kernel that an earlier process compiled
COMPILE = 0.3  # s to compile a kernel, and for each of its lines
COMPILE_LINE = 2e-3


def loops_time(loops: Sequence[LoopCost], stored: int) -> float:
    """Seconds on one core, from the operations and the doubles that are stored."""
    return sum(loop.runs * loop.cost for loop in loops if not loop.close) * ADDITION + stored * STORE


def plain_time(operations: int, points: int) -> float:
    """Seconds in plain Python."""
    return points * (PLAIN_POINT + operations * PLAIN)


def compile_time(loops: Sequence[LoopCost]) -> float:
    """Seconds that the first process waits for a kernel."""
    return COMPILE + COMPILE_LINE * sum(loop.operations for loop in loops)
