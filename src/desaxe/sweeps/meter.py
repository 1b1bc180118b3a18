"""Progress of a sweep on one line of a terminal: points, rate, time left."""

import sys
import time
from collections.abc import Callable

Watch = Callable[[int, int, str], None]  # points done, points in all, what is being done

PACE = 0.2  # seconds between two lines


class Meter:
    """Counts points and reports them to a callback, or on stderr if that is a terminal."""

    def __init__(self, total: int, watch: Watch | None) -> None:
        self.total, self.watch = total, watch
        self.done, self.found, self.start = 0, 0, time.monotonic()
        self.shown = 0.0
        self.live = watch is None and sys.stderr.isatty()

    def add(self, points: int, computed: bool) -> None:
        """Points that are done; the rate counts those that had to be computed."""
        self.done += points
        self.found += 0 if computed else points
        if self.watch is not None:
            self.watch(self.done, self.total, "writing" if computed else "reading")
        now = time.monotonic()
        if self.live and now - self.shown >= PACE:
            self.shown = now
            print(f"\r\033[K{self.text(now)}", end="", file=sys.stderr, flush=True)

    def text(self, now: float) -> str:
        """The line."""
        rate = (self.done - self.found) / max(now - self.start, 1e-9)
        left = (self.total - self.done) / rate if rate else 0.0
        share = 100.0 * self.done / max(self.total, 1)
        return (
            f"{self.done:,} of {self.total:,} points ({share:.0f} %), {rate:.3g} a second, {_time(left)} left"
        )

    def close(self) -> None:
        """Leave no trace on the terminal."""
        if self.live and self.shown:
            print("\r\033[K", end="", file=sys.stderr, flush=True)


def _time(seconds: float) -> str:
    whole = round(seconds)
    if whole < 120:
        return f"{whole} s"
    return f"{whole // 60} min" if whole < 7200 else f"{whole // 3600} h {whole % 3600 // 60:02d} min"
