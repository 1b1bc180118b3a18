"""Locks of folders between processes; the operating system releases them when the process ends."""

import os
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from .shown import printable

if sys.platform != "win32":
    import fcntl

WAIT = 60.0  # seconds for a lock that is held for milliseconds
_FIRST_PAUSE, _LONGEST_PAUSE = 0.002, 0.1


@contextmanager
def locked(folder: Path, wait: float = WAIT) -> Iterator[bool]:
    """Lock an existing folder for the duration of a block.

    Yields True while the lock is held and False where the system has no locks. Raises TimeoutError after
    `wait` seconds, of short pauses, so that an interrupt takes effect at once.
    """
    descriptor = opened(folder)
    if descriptor is None:
        yield False
        return
    end, pause = time.monotonic() + wait, _FIRST_PAUSE
    try:
        while (held := try_lock(descriptor)) is False:
            if time.monotonic() >= end:
                raise TimeoutError(f"{printable(folder)}: another process has held its lock for {wait:g} s")
            time.sleep(pause)
            pause = min(2.0 * pause, _LONGEST_PAUSE)
        try:
            yield held is True
        finally:
            _release(descriptor)
    finally:
        os.close(descriptor)


def opened(folder: Path, flags: int = 0) -> int | None:
    """A descriptor of a folder; None on Windows, where folders cannot be opened."""
    return None if sys.platform == "win32" else os.open(folder, os.O_RDONLY | os.O_DIRECTORY | flags)


def try_lock(descriptor: int) -> bool | None:
    """Try to lock a descriptor: True if locked, False if another process has it, None without support."""
    if sys.platform != "win32":
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            return True
        except (BlockingIOError, PermissionError):
            return False
        except OSError:
            pass
    return None


def _release(descriptor: int) -> None:
    """Release a lock: closing is not enough if a forked child has a copy of the descriptor."""
    if sys.platform != "win32":
        with suppress(OSError):
            fcntl.flock(descriptor, fcntl.LOCK_UN)
