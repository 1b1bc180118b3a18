"""Long imports and compilations that no exception of a signal's handler, such as Ctrl-C's, must cut in half.

A package that was imported halfway cannot be imported again, and a compiler that was stopped halfway leaves
its tables inconsistent: the next call in the same process would fail. So both run in a thread of their own,
in which no handler runs: the caller stops at once, and the work is finished behind it. Short imports put the
exception off until they are done (`forks.IMPORTS`). Compiled loops do not hear of one either, but can be
stopped.
"""

import sys
import threading
from collections.abc import Callable
from contextvars import copy_context
from types import ModuleType
from typing import Generic, TypeVar

from .deadline import Deadline
from .forks import IMPORTS, LATE, imported
from .signals import is_main, put_off

T = TypeVar("T")

_NAME = "desaxe-work"


def is_at_work() -> bool:
    """True while work of an interrupted caller is still running."""
    return any(thread.name == _NAME for thread in threading.enumerate())


def import_whole(name: str) -> ModuleType:
    """Import a module to its end, even if the caller is interrupted meanwhile."""
    if name in sys.modules:
        return imported(name)
    return finished(lambda: imported(name))


def finished(work: Callable[[], T]) -> T:
    """Run work to its end, even if the caller is interrupted meanwhile; return its result.

    Within an import, which is not interrupted either, it stays in this thread: another one would wait for the
    lock of imports for ever.
    """
    return _Work(work).answer() if is_main() and not IMPORTS.is_mine else work()


def stopped_early(work: Callable[[], T], stop: Callable[[], object], deadline: Deadline) -> T:
    """Run compiled work, which `stop` ends soon, called at an interrupt and when the time is over.

    At an interrupt the work ends behind the caller: it may be compiling still.
    """
    at_work = _Work(work)
    try:
        return at_work.answer(deadline)
    except TimeoutError:
        stop()
        at_work.is_over()
        raise
    except BaseException:
        stop()
        raise


class _Work(Generic[T]):
    """Work in a thread of its own.

    Its end is told by a lock, which one waits for in short turns. A signal that comes on the way into a wait,
    or to another thread, does not wake it: Python raises the interrupt when the wait is over. `Thread.join`
    has no turns, and (Python 3.11) calls a thread over that an interrupted caller waited for.
    """

    def __init__(self, work: Callable[[], T]) -> None:
        self._found: list[T] = []
        self._error: list[BaseException] = []
        self._at_work = threading.Lock()
        self._thread = threading.Thread(target=copy_context().run, args=(self._run, work), name=_NAME)

    def _run(self, work: Callable[[], T]) -> None:
        try:
            self._found.append(work())
        except BaseException as raised:
            self._error.append(raised)
        finally:
            self._at_work.release()

    def is_over(self, deadline: Deadline | None = None) -> bool:
        """Wait for the end of the work, or of the time: False."""
        left = deadline.left() if deadline else None
        while left is None or left > 0.0:
            if self._at_work.acquire(timeout=LATE if left is None else min(left, LATE)):
                return True
            left = deadline.left() if deadline else None
        return False

    def answer(self, deadline: Deadline | None = None) -> T:
        """Begin, and return what the work returns or raise what it raises; TimeoutError when time is up."""
        self._at_work.acquire()
        with put_off():
            self._thread.start()
        over = self.is_over(deadline)
        if self._error:
            raise self._error[0]
        if deadline and not over:
            raise deadline.error()
        return self._found[0]
