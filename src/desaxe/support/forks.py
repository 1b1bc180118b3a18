"""Fork safety: a child must inherit no locked lock and no handle of a thread that it does not have.

`fork` copies one thread. A lock that any other thread holds at that moment stays locked for ever in the
child, and a pool waits for threads that it does not have.
"""

import os
from collections.abc import Callable
from threading import RLock
from typing import Any


def fork_safe_lock() -> Any:
    """A lock that a fork waits for, so that it is free in the child and what it guards is whole there."""
    lock = RLock()
    if hasattr(os, "register_at_fork"):
        os.register_at_fork(before=lock.acquire, after_in_parent=lock.release, after_in_child=lock.release)
    return lock


def in_child(action: Callable[[], object]) -> None:
    """Register an action that runs first in every forked child."""
    if hasattr(os, "register_at_fork"):
        os.register_at_fork(after_in_child=action)
