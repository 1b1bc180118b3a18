"""A time limit for work that may not end by itself."""

import time
from math import inf
from typing import Any

from .checks import time_limit


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
            raise TimeoutError(f"{self.what}: not done within timeout = {self.seconds:g} s")
