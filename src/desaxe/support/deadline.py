"""A time limit for work that may not end by itself."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from math import inf
from typing import Any

from .checks import real_number
from .progress import Progress, progress_bar
from .shown import shown


class Deadline:
    """Counts from when it is made; `check` raises TimeoutError when the time is over.

    On a terminal `shown` has a bar for the block: the time that is gone, and how much was done.
    """

    def __init__(self, what: str, timeout: Any) -> None:
        self.what, self.seconds = what, inf if timeout is None else real_number("timeout", timeout)
        if not self.seconds > 0.0:
            raise ValueError(f"timeout = {shown(timeout)}: a number of seconds above 0, or None for no limit")
        self._start = time.monotonic()
        self._end = self._start + self.seconds
        self._checks = 0
        self._watch: Progress | None = None

    @property
    def over(self) -> bool:
        """True when the time is over."""
        return time.monotonic() > self._end

    def check(self) -> None:
        """Raise TimeoutError when the time is over."""
        if self._watch is not None:
            self._checks += 1
            gone = int(time.monotonic() - self._start)
            most = gone + 1 if self.seconds == inf else int(self.seconds)
            self._watch(gone, most, f"{self.what}, {self._checks} evaluations")
        if self.over:
            raise self.error()

    @contextmanager
    def shown(self) -> Iterator[None]:
        """Show a bar on the terminal while the block runs."""
        with progress_bar(unit="s at most") as watch:
            self._watch = watch
            try:
                yield
            finally:
                self._watch = None

    def lift(self) -> None:
        """Remove the limit."""
        self._end = inf

    def error(self) -> TimeoutError:
        """Return the error to raise when the time is over."""
        return TimeoutError(f"{self.what}: not done within timeout = {self.seconds:g} s")
