"""Progress of a run, and a progress bar on the terminal for a long one."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from shutil import get_terminal_size
from threading import Event, Lock, Thread
from time import monotonic

# Called before each step: steps done, steps in all, what comes next.
Progress = Callable[[int, int, str], None]

Count = Callable[[int, bool], None]  # points that are done now, and whether they were computed

DELAY = 1.0  # seconds without a bar
PACE = 0.2  # seconds between two looks
CLEARED = "\r\x1b[K"  # the start of the line, and nothing behind it


class Steps:
    """Counts the steps of a run and reports them to a callback."""

    def __init__(self, total: int, watch: Progress | None) -> None:
        self.done, self.total, self.watch = 0, total, watch

    def next(self, what: str) -> None:
        """The next step begins."""
        self.report(what)
        self.done += 1

    def report(self, what: str) -> None:
        """Call the callback, if there is one."""
        if self.watch is not None:
            self.watch(self.done, self.total, what)


class Portions(Steps):
    """Counts what is done of a large number, and tells beforehand and on the way what the rest takes."""

    def __init__(self, total: int, what: str, watch: Progress | None) -> None:
        super().__init__(total, watch)
        self.what, self.computed, self.begun = what, 0, monotonic()
        self.report(what)

    def add(self, count: int, computed: bool = True) -> None:
        """Count designs, or other parts, that are done now; those that were there already take no time."""
        self.done = min(self.total, self.done + count)
        self.computed += count if computed else 0
        left = (monotonic() - self.begun) * (self.total - self.done) / max(1, self.computed)
        self.report(f"{self.what}, about {_time(left)} left")


def _time(seconds: float) -> str:
    whole = round(seconds)
    if whole < 120:
        return f"{whole} s"
    return f"{whole // 60} min" if whole < 7200 else f"{whole // 3600} h {whole % 3600 // 60:02d} min"


_drawn = Lock()  # held while a bar is: one at a time


@contextmanager
def progress_bar(delay: float = DELAY, unit: str = "steps") -> Iterator[Progress | None]:
    """A bar on stderr that appears after `delay` seconds and leaves no trace.

    None where stderr is not a terminal, or a bar is there already.
    """
    if not sys.stderr.isatty() or not _drawn.acquire(blocking=False):
        yield None
        return
    state: list[tuple[int, int, str]] = [(0, 1, "")]
    over = Event()
    thread = Thread(target=_draw, args=(state, over, delay, unit), daemon=True)
    thread.start()
    try:
        yield lambda done, total, what: state.__setitem__(0, (done, total, what))
    finally:
        over.set()
        thread.join()
        _drawn.release()


def _draw(state: list[tuple[int, int, str]], over: Event, delay: float, unit: str) -> None:
    """Draw the current state until the run ends; in its own thread, since one step can take long."""
    if over.wait(delay):
        return
    while not over.wait(PACE):
        done, total, what = state[0]
        head, tail = f"{done} of {total} {unit} |", f"| {what}"
        columns = get_terminal_size().columns - 1
        bar = max(0, columns - len(head) - len(tail))
        full = bar * min(done, total) // max(1, total)
        sys.stderr.write(CLEARED + f"{head}{'#' * full:{bar}}{tail}"[:columns])
        sys.stderr.flush()
    sys.stderr.write(CLEARED)
    sys.stderr.flush()
