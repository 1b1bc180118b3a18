"""Signals during work that must not be cut in half: what their handlers raise waits for its end.

That is the KeyboardInterrupt of Ctrl-C, and the exception of any other handler, such as that of an alarm.
"""

# What `signal` wraps in enumerations, which take 5 us a signal.
import _signal  # type: ignore[import-not-found]
from collections.abc import Callable
from threading import get_ident, main_thread
from types import FrameType, TracebackType
from typing import Any, TypeVar

T = TypeVar("T")

EVERY = range(1, _signal.NSIG)


def is_main() -> bool:
    """True in the main thread, the one in which handlers of signals run."""
    return get_ident() == main_thread().ident


class put_off:
    """A context whose end raises what handlers of signals raised meanwhile; `stop` is called at once.

    The handlers themselves run when the signal comes. Other threads than the main one run none.
    """

    __slots__ = ("_active", "_handlers", "_stop", "raised")

    def __init__(self, stop: Callable[[], object] | None = None) -> None:
        self.raised: list[BaseException] = []
        self._handlers: dict[int, Callable[[int, FrameType | None], Any]] = {}
        self._active, self._stop = False, stop

    def __enter__(self) -> "put_off":
        if is_main():
            for number, handler in enumerate(map(_signal.getsignal, EVERY), EVERY.start):
                if callable(handler):
                    self._handlers[number] = handler
                    _signal.signal(number, self._run)
            self._active = True
        return self

    def _run(self, number: int, frame: FrameType | None) -> None:
        """Run a handler. Outside of the block, where one was not put back, it raises as without it."""
        try:
            self._handlers[number](number, frame)
        except BaseException as error:
            if not self._active:
                raise
            self.raised.append(error)
            if self._stop is not None:
                self._stop()

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._active = False
        for number, handler in self._handlers.items():
            if _signal.getsignal(number) == self._run:  # else the block, or a handler, has set another one
                _signal.signal(number, handler)
        if self.raised:
            raise self.raised[0]


def finished(work: Callable[[], T]) -> T:
    """Run work, such as a compilation, to its end: an interrupt is raised when it is done."""
    with put_off():
        return work()
