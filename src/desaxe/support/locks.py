"""File locks between processes; the operating system releases them when the process ends."""

import os
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from .shown import printable

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

WAIT = 60.0  # seconds for a lock that is held for milliseconds
_FIRST_PAUSE, _LONGEST_PAUSE = 0.002, 0.1


@contextmanager
def locked(path: Path, wait: float = WAIT, message: str = "") -> Iterator[bool]:
    """Lock a file (created if missing) or an existing folder for the duration of a block.

    Yields True while the lock is held and False where the file system has no locks. Raises TimeoutError
    after `wait` seconds, and OSError where the file cannot be opened. A link is not followed.
    """
    descriptor = _opened(path)
    try:
        held = descriptor is not None and _acquire(descriptor, path, wait, message)
        try:
            yield held
        finally:
            if held and descriptor is not None:
                release(descriptor)
    finally:
        if descriptor is not None:
            os.close(descriptor)


def _opened(path: Path) -> int | None:
    """A descriptor to lock; None for a folder where folders cannot be opened."""
    if path.is_dir():
        return os.open(path, os.O_RDONLY) if sys.platform != "win32" else None
    flags = os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)
    return os.open(path, flags, 0o600)


def _acquire(descriptor: int, path: Path, wait: float, message: str) -> bool:
    """Wait for a lock with short pauses, so that an interrupt takes effect at once."""
    end, pause = time.monotonic() + wait, _FIRST_PAUSE
    while True:
        held = try_lock(descriptor)
        if held is not False:
            return held is True
        if time.monotonic() >= end:
            raise TimeoutError(
                message or f"{printable(path)}: another process has held its lock for {wait:g} s"
            )
        time.sleep(pause)
        pause = min(2.0 * pause, _LONGEST_PAUSE)


def try_lock(descriptor: int) -> bool | None:
    """Try to lock a descriptor: True if locked, False if another process has it, None without support."""
    try:
        if sys.platform == "win32":
            msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
        else:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except (BlockingIOError, PermissionError):
        return False
    except OSError:
        return None
    return True


def release(descriptor: int) -> None:
    """Release a lock explicitly: closing is not enough if a forked child has a copy of the descriptor."""
    with suppress(OSError):
        if sys.platform == "win32":
            msvcrt.locking(descriptor, msvcrt.LK_UNLCK, 1)
        else:
            fcntl.flock(descriptor, fcntl.LOCK_UN)
