"""Memory: sizes as numbers and texts, and a check for free memory before a result is allocated."""

import os
import re
from collections.abc import Iterator
from contextlib import suppress
from math import inf
from numbers import Real
from pathlib import Path
from typing import Any

from .forks import imported
from .shown import shown

ALWAYS = 100_000_000  # bytes that are not checked
_CGROUP = Path("/sys/fs/cgroup")
_SIZE = re.compile(
    r"\s*((?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:e[0-9]{1,2})?)\s*(?:([kmgt]?)(i?)b)?\s*", re.IGNORECASE
)


def bytes_of(memory: Any) -> int | None:
    """A number of bytes, or text such as "200 MB"; None stays None."""
    if memory is None:
        return None
    is_number = isinstance(memory, Real) and not isinstance(memory, bool)
    match = _SIZE.fullmatch(memory) if isinstance(memory, str) else None
    if match is not None:
        prefix = " kmgt".index((match[2] or " ").lower())
        number = float(match[1]) * (1024.0 if match[3] else 1000.0) ** prefix
    elif is_number and type(memory).__name__ != "timedelta64":  # which NumPy counts among integers
        number = float(max(min(memory, 2**63), -1))
    else:
        kind = ValueError if isinstance(memory, str) else TypeError
        raise kind(f'memory = {shown(memory)}: a number of bytes, or text such as "200 MB"')
    if not 1.0 <= number < 2.0**63:
        raise ValueError(f"memory = {shown(memory)}: at least one byte, less than 2^63")
    return int(number)


def size_text(size: float) -> str:
    """A number of bytes as text, in kB, MB, GB or TB."""
    for unit in ("bytes", "kB", "MB", "GB"):
        if size < 1000.0:
            return f"{size:.0f} bytes" if unit == "bytes" else f"{size:.3g} {unit}"
        size /= 1000.0
    return f"{size:.3g} TB"


def require(size: float, what: str) -> None:
    """Raise MemoryError where a result of `size` bytes does not fit into the memory that is free."""
    if size < ALWAYS:
        return
    free = available()
    if size > free:
        message = f"{what} takes {size_text(size)} and {size_text(free)} are free"
        raise MemoryError(f"{message}: ask for fewer points or names, or for a reduction (reduce=)")


def available() -> float:
    """Bytes that this process may still take of the machine, its container and its own limit."""
    return max(min(_limits(), default=inf), 0.0)


def _limits() -> Iterator[float]:
    """Bytes that each of these has left, as far as it says so."""
    with suppress(OSError, ValueError, IndexError):
        words = Path("/proc/meminfo").read_text().split()
        yield 1024.0 * int(words[words.index("MemAvailable:") + 1])
    with suppress(AttributeError, OSError, ValueError):
        yield float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    with suppress(OSError, ValueError):
        most = int((_CGROUP / "memory.max").read_text())  # ValueError for "max"
        yield float(most - int((_CGROUP / "memory.current").read_text()))
    with suppress(ImportError, OSError, ValueError, IndexError):
        resource = imported("resource")
        most = resource.getrlimit(resource.RLIMIT_AS)[0]
        if most != resource.RLIM_INFINITY:
            pages = int(Path("/proc/self/statm").read_text().split()[0])
            yield float(most - pages * resource.getpagesize())
