"""Imports and compilations that an interrupt (SIGINT) must not cut in half.

A package that was imported halfway cannot be imported again, and a compiler that was stopped halfway leaves
its tables inconsistent: the next call in the same process would fail. Imports are short: they put an
interrupt off until they are done. Compilations are long: they run in a thread of their own, which interrupts
do not reach, so that the caller stops at once and the work is finished behind it.
"""

import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Any, TypeVar

from .forks import IMPORTS

T = TypeVar("T")


_NAME = "desaxe-work"


def is_at_work() -> bool:
    """True while work of an interrupted caller is still running."""
    return any(thread.name == _NAME for thread in threading.enumerate())


def _is_main() -> bool:
    return threading.current_thread() is threading.main_thread()


@contextmanager
def put_off() -> Iterator[None]:
    """Delay an interrupt (SIGINT) until the block is done; only the main thread receives one."""
    if not _is_main() or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        yield
        return
    came: list[int] = []
    signal.signal(signal.SIGINT, lambda number, frame: came.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    if came:
        raise KeyboardInterrupt


def import_whole(name: str) -> None:
    """Import a module with interrupts delayed; nothing if it is already imported."""
    if name not in sys.modules:
        with put_off(), IMPORTS:
            import_module(name)


def finished(work: Callable[[], T]) -> T:
    """Run work to its end, even if the caller is interrupted meanwhile; return its result."""
    if not _is_main():
        return work()
    answer: list[Any] = []
    error: list[BaseException] = []

    def run() -> None:
        try:
            answer.append(work())
        except BaseException as raised:
            error.append(raised)

    thread = threading.Thread(target=run, name=_NAME)
    with put_off():
        thread.start()
    thread.join()
    if error:
        raise error[0]
    found: T = answer[0]
    return found
