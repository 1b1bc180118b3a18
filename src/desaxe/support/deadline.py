"""A time limit for work that may not end by itself."""

import time
from math import inf
from typing import Any

from .checks import time_limit

LONGEST = 1e9  # seconds: beyond it there is no limit


class Deadline:
    """Counts from when it is made; `check` raises TimeoutError when the time is over."""

    def __init__(self, what: str, timeout: Any) -> None:
        self.what, self.seconds = what, time_limit(timeout)
        self._end = inf if self.seconds is None else time.monotonic() + self.seconds

    @property
    def over(self) -> bool:
        """True when the time is over."""
        return time.monotonic() > self._end

    def check(self) -> None:
        """Raise TimeoutError when the time is over."""
        if self.over:
            raise self.error()

    def lift(self) -> None:
        """Remove the limit."""
        self._end = inf

    def error(self) -> TimeoutError:
        """Return the error to raise when the time is over."""
        return TimeoutError(f"{self.what}: not done within timeout = {self.seconds:g} s")

    def left(self) -> float | None:
        """Seconds that are left, as a thread may be waited for; None without a limit."""
        return max(self._end - time.monotonic(), 0.0) if self._end < LONGEST else None
