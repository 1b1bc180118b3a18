"""Fork safety: a child must inherit no locked lock and no handle of a thread that it does not have.

`fork` copies one thread. A lock that any other thread holds at that moment stays locked for ever in the
child, and a pool waits for threads that it does not have.
"""

import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from threading import RLock, local
from types import ModuleType, TracebackType
from typing import Any, Protocol

from .signals import is_main, put_off

LATE = 0.05  # seconds: how late an interrupt of a wait is heard at most
WAIT = 60.0  # seconds that a fork waits for a compilation of another thread


# A Python class around a lock could be interrupted between acquiring it and entering the block.
_RLock: Any = type(RLock())


class ForkSafeLock(_RLock):  # type: ignore[misc]
    """A reentrant lock that a fork waits for, so that what it guards is whole in the child.

    In the child it is free, even where the fork did not get it in time.
    """

    def __init__(self) -> None:
        _LOCKS.append(self)

    @property
    def is_mine(self) -> bool:
        """True in a block of this thread that holds the lock: no other thread can acquire it meanwhile."""
        return bool(self._is_owned())

    def acquire_until(self, end: float) -> bool:
        """Try to acquire it until some time of the monotonic clock."""
        return bool(self.acquire(timeout=max(end - time.monotonic(), 0.0)))

    def renew(self) -> None:
        """In a child: free it of a thread that is not there."""
        self._at_fork_reinit()


class ImportLock(ForkSafeLock):
    """The lock of imports inside functions, which what a signal's handler raises does not cut in half.

    A module that was imported halfway cannot be imported again, and may stay locked for all threads.
    """

    def __init__(self) -> None:
        super().__init__()
        self._raised_later: put_off | None = None  # of the main thread, in its outermost block

    def __enter__(self) -> None:
        if self.is_mine or not is_main():
            self.acquire()
            return
        later = put_off().__enter__()
        while not self.acquire(timeout=LATE):
            if later.raised:
                later.__exit__(None, None, None)
        self._raised_later = later

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.release()
        if self._raised_later is not None and is_main() and not self.is_mine:
            later, self._raised_later = self._raised_later, None
            later.__exit__(kind, error, trace)


class Waited(Protocol):
    """A lock that a fork waits for: `ForkSafeLock`, or that of a library."""

    def acquire_until(self, end: float) -> bool:
        """Try to acquire it until some time of the monotonic clock."""

    def release(self) -> None:
        """Release it after the fork."""

    def renew(self) -> None:
        """In the child: free it of a thread that is not there."""


_LOCKS: list[Waited] = []  # acquired from the last to the first
_HELD = local()  # of the forking thread: the locks that it has acquired

# Held by every import inside a function. A module that another thread has imported halfway cannot be imported
# in a child at all: Python's own lock of it stays locked there.
IMPORTS = ImportLock()


def acquired_last(lock: Waited) -> None:
    """Acquire a library's lock before each fork after all others: imports, which it may block, have ended."""
    _LOCKS.insert(0, lock)


def imported(name: str) -> ModuleType:
    """Import a module by its name."""
    with IMPORTS:
        return import_module(name)


# Modules that have a lock acquired before a fork and released after it, and the name of the lock.
_ALIKE = {"logging": "_lock", "concurrent.futures.thread": "_global_shutdown_lock"}


def _before() -> None:
    """Acquire the locks, those that are taken first in a call before those taken inside it."""
    end = time.monotonic() + WAIT
    known = {name for name in _ALIKE if _is_imported(name)}
    _HELD.locks = []
    with _without_logging():
        # One by one: an error of one leaves none of the others acquired for ever.
        _HELD.locks.extend(lock for lock in reversed(_LOCKS) if lock.acquire_until(end))
    for name, attribute in _ALIKE.items():
        if name not in known and _is_imported(name):  # while we waited: it releases what it has not acquired
            getattr(sys.modules[name], attribute).acquire()


def _is_imported(name: str) -> bool:
    """True for a module that no thread is importing."""
    module = sys.modules.get(name)
    return module is not None and not getattr(module.__spec__, "_initializing", False)


@contextmanager
def _without_logging() -> Iterator[None]:
    """Let go of the lock of logging, which its own preparation for a fork may have acquired before ours.

    Imports and compilations, for which we wait, need it.
    """
    lock: Any = getattr(sys.modules.get("logging"), "_lock", None)
    count = 0
    while lock is not None and lock._is_owned():
        lock.release()
        count += 1
    try:
        yield
    finally:
        for _ in range(count):
            lock.acquire()


def _after_in_parent() -> None:
    # Registered while the fork was under way, it runs after it without having run before it.
    for lock in _HELD.__dict__.pop("locks", ()):
        lock.release()


def _after_in_child() -> None:
    held = _HELD.__dict__.get("locks", ())
    missed = [lock for lock in _LOCKS if lock not in held]
    _after_in_parent()
    for lock in missed:
        lock.renew()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(before=_before, after_in_parent=_after_in_parent, after_in_child=_after_in_child)


def in_child(action: Callable[[], object]) -> None:
    """Register an action that runs first in every forked child."""
    if hasattr(os, "register_at_fork"):
        os.register_at_fork(after_in_child=action)
