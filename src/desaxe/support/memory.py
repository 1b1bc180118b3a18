"""A check for free memory before a result is allocated."""

import os
import sys
from contextlib import suppress
from math import inf
from pathlib import Path

from .forks import IMPORTS

ALWAYS = 100_000_000  # bytes that are not checked
_CGROUP = Path("/sys/fs/cgroup")


def require(size: int, what: str) -> None:
    """Raise MemoryError where a result of `size` bytes does not fit into the memory that is free."""
    if size < ALWAYS:
        return
    free = available()
    if size > free:
        told = f"{what} takes {in_words(size)} and {in_words(free)} are free"
        raise MemoryError(f"{told}: ask for fewer points or names, or for a reduction (reduce=)")


def in_words(size: float) -> str:
    """A number of bytes as text, in MB or GB."""
    return f"{size / 1e9:.3g} GB" if size >= 1e9 else f"{size / 1e6:.3g} MB"


def available() -> float:
    """Bytes that this process may still take of the machine, its container and its own limit."""
    return max(min(_of_machine(), _of_container(), _of_process()), 0.0)


def _of_machine() -> float:
    with suppress(OSError, ValueError, IndexError):
        for line in Path("/proc/meminfo").read_text().splitlines():
            if line.startswith("MemAvailable:"):
                return 1024.0 * int(line.split()[1])
    with suppress(AttributeError, OSError, ValueError):
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    return inf


def _of_container() -> float:
    with suppress(OSError, ValueError):
        most = int((_CGROUP / "memory.max").read_text())  # ValueError for "max"
        return float(most - int((_CGROUP / "memory.current").read_text()))
    return inf


def _of_process() -> float:
    if sys.platform == "win32":
        return inf
    with suppress(OSError, ValueError, IndexError):
        with IMPORTS:
            import resource

        most = resource.getrlimit(resource.RLIMIT_AS)[0]
        if most != resource.RLIM_INFINITY:
            pages = int(Path("/proc/self/statm").read_text().split()[0])
            return float(most - pages * resource.getpagesize())
    return inf
