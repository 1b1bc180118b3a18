"""Fork safety: a child must inherit no locked lock and no handle of a thread that it does not have.

`fork` copies one thread. A lock that any other thread holds at that moment stays locked for ever in the
child, and a pool waits for threads that it does not have.
"""

import os
import time
from collections.abc import Callable
from importlib import import_module
from threading import RLock, local
from types import TracebackType

WAIT = 20.0  # seconds that a fork waits for a compilation of another thread


class ForkSafeLock:
    """A reentrant lock that a fork waits for, so that what it guards is whole in the child.

    In the child it is free, even where the fork did not get it in time.
    """

    def __init__(self) -> None:
        self._lock = RLock()
        self._entered = local()
        _LOCKS.append(self)

    @property
    def is_mine(self) -> bool:
        """True in a block of this thread that holds the lock: no other thread can acquire it meanwhile."""
        return getattr(self._entered, "depth", 0) > 0

    def __enter__(self) -> None:
        self._lock.acquire()
        self._entered.depth = getattr(self._entered, "depth", 0) + 1

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._entered.depth -= 1
        self._lock.release()

    def acquire_until(self, end: float) -> bool:
        """Try to acquire it until some time of the monotonic clock."""
        return self._lock.acquire(timeout=max(end - time.monotonic(), 0.0))

    def release(self) -> None:
        """Release it."""
        self._lock.release()

    def renew(self) -> None:
        """In a child: free it of a thread that is not there."""
        self._lock = RLock()


_LOCKS: list[ForkSafeLock] = []
_HELD = local()  # of the forking thread: for each registration, the locks that it has acquired
IMPORTS = ForkSafeLock()  # held while a package is imported: half of one cannot be imported again
_AFTER_LOGGING: list[bool] = []


def _before() -> None:
    """Acquire the locks, those that are taken first in a call before those taken inside it."""
    end = time.monotonic() + WAIT
    stack = _HELD.__dict__.setdefault("stack", [])
    stack.append([lock for lock in reversed(_LOCKS) if lock.acquire_until(end)])


def _after_in_parent() -> None:
    # Registered while the fork was under way, it runs after it without having run before it.
    if _HELD.__dict__.get("stack"):
        for lock in _HELD.stack.pop():
            lock.release()


def _after_in_child() -> None:
    held = _HELD.__dict__.get("stack") or [[]]
    missed = [lock for lock in _LOCKS if lock not in held[-1]]
    _after_in_parent()
    for lock in missed:
        lock.renew()


def wait_first() -> None:
    """Let forks wait for our locks before they take those of logging.

    What is registered last runs first before a fork. Registered before logging is imported, a fork would
    hold its lock while it waits for an import or a compilation, which need that lock.
    """
    if not _AFTER_LOGGING:
        import_module("logging")
        _AFTER_LOGGING.append(True)
        _register()


def _register() -> None:
    if hasattr(os, "register_at_fork"):
        os.register_at_fork(before=_before, after_in_parent=_after_in_parent, after_in_child=_after_in_child)


_register()


def in_child(action: Callable[[], object]) -> None:
    """Register an action that runs first in every forked child."""
    if hasattr(os, "register_at_fork"):
        os.register_at_fork(after_in_child=action)
