"""Long compiled work, which hears of no interrupt but can be stopped.

It runs in a thread of its own, in which no handler of a signal runs, so that the caller hears of Ctrl-C.
Imports and compilations are short: what a handler raises waits for their end (`signals.put_off`).
"""

import threading
from collections.abc import Callable
from contextvars import copy_context
from typing import TypeVar

from .deadline import Deadline
from .forks import LATE
from .signals import put_off

T = TypeVar("T")

_NAME = "desaxe-work"


def is_at_work() -> bool:
    """True while work of an interrupted caller is still running."""
    return any(thread.name == _NAME for thread in threading.enumerate())


def stopped_early(work: Callable[[], T], stop: Callable[[], object], deadline: Deadline) -> T:
    """Run compiled work, which `stop` ends soon, called at an interrupt and when the time is over.

    The end of the work is told by a lock, which one waits for in short turns. A signal that comes on the way
    into a wait, or to another thread, does not wake it: Python raises the interrupt when the wait is over.
    `Thread.join` has no turns, and (Python 3.11) calls a thread over that an interrupted caller waited for.
    """
    results: list[T] = []
    errors: list[BaseException] = []
    at_work = threading.Lock()

    def run() -> None:
        try:
            results.append(work())
        except BaseException as error:
            errors.append(error)
        finally:
            at_work.release()

    try:
        at_work.acquire()
        with put_off():
            threading.Thread(target=copy_context().run, args=(run,), name=_NAME).start()
        while not at_work.acquire(timeout=LATE):
            if deadline.over:
                stop()
                at_work.acquire()
                raise deadline.error()
    except BaseException:
        stop()
        raise
    if errors:
        raise errors[0]
    return results[0]
