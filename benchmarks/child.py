"""One contender in a process and on cores of its own, driven by messages.

The cores are set before anything that starts threads is imported. A child prepares a work (that compiles
it, and runs it once), then runs rounds of it whenever the parent says so, and forgets it. On one core the
processor's time is taken, which leaves out whatever else the machine does meanwhile; on several the clock's.
"""

import ctypes
import gc
import os
import time
from collections.abc import Sequence
from contextlib import suppress
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .work import Inputs

LEAST = 2e-3  # seconds that a round takes: a shorter work is repeated
THREADS = ("OMP_NUM_THREADS", "NUMEXPR_NUM_THREADS", "NUMEXPR_MAX_THREADS", "NUMBA_NUM_THREADS")


def serve(connection: Connection, name: str, cores: Sequence[int]) -> None:
    """Answer messages until the connection closes; an exception is returned as its text."""
    with suppress(EOFError):
        _serve(connection, name, cores)


def _serve(connection: Connection, name: str, cores: Sequence[int]) -> None:
    keep_to(cores)
    from .contenders import BY_NAME

    child = Child(BY_NAME[name].load(), len(cores))
    connection.send(True)
    while (order := connection.recv()) is not None:
        what, *arguments = order
        try:
            connection.send((True, getattr(child, what)(*arguments)))
        except Exception as error:  # what a contender cannot do is reported, and does not end the race
            connection.send((False, f"{type(error).__name__}: {error}".partition("\n")[0]))


def keep_to(cores: Sequence[int]) -> None:
    """Set the affinity of this process, and how many threads libraries start."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, cores)
    os.environ.update(dict.fromkeys(THREADS, str(len(cores))))


class Child:
    """A contender, and the work it is at."""

    def __init__(self, contender: Any, threads: int) -> None:
        self.contender, self.threads = contender, threads
        self.clock = time.process_time if threads == 1 else time.perf_counter
        self.run: Any = None
        self.repeats = 1

    def prepare(self, key: str, count: int) -> float:
        """Make the inputs, compile, run once: seconds of the latter two."""
        from .work import BY_KEY

        inputs = BY_KEY[key].inputs(count)
        started = time.perf_counter()
        self.run = self._made(key, inputs)
        self.run()
        taken = time.perf_counter() - started
        gc.collect()
        gc.disable()  # until it is forgotten: no round pays for what others left
        once = self.round()
        self.repeats = max(1, int(LEAST / once))
        return taken

    def start(self, key: str, count: int) -> None:
        """Compile and run once."""
        from .work import BY_KEY

        self._made(key, BY_KEY[key].inputs(count))()

    def round(self) -> float:
        """Seconds of one call."""
        started = self.clock()
        for _ in range(self.repeats):
            self.run()
        return (self.clock() - started) / self.repeats

    def again(self, times: int) -> float:
        """Seconds of `times` consecutive calls."""
        started = self.clock()
        for _ in range(times):
            self.run()
        return self.clock() - started

    def values(self, key: str, inputs: "Inputs") -> list[Any]:
        """The results at these inputs."""
        import numpy as np

        return [np.array(answer) for answer in self._made(key, inputs)()]

    def memory(self) -> float:
        """Megabytes of the process at its largest during one call, counted from before it."""
        _trim()
        before = _resident("VmRSS")
        try:
            with open("/proc/self/clear_refs", "w", encoding="ascii") as file:
                file.write("5")  # forget the largest size so far
        except OSError:
            return float("nan")
        self.run()
        return (_resident("VmHWM") - before) / 1e6

    def forget(self) -> None:
        """Give the memory back."""
        self.run, self.repeats = None, 1
        gc.enable()
        gc.collect()

    def _made(self, key: str, inputs: "Inputs") -> Any:
        import numpy as np

        from .work import BY_KEY

        work = BY_KEY[key]
        out = [np.zeros(inputs.shape) for _ in work.names] if work.given else None
        for place in out or ():
            place.fill(0.0)  # now the memory is there, and no round waits for it
        return self.contender(work, inputs, out, self.threads)


def _trim() -> None:
    """Return unused memory of the C library to the system, where it can."""
    with suppress(AttributeError, OSError):
        ctypes.CDLL(None).malloc_trim(0)


def _resident(what: str) -> float:
    """A memory figure of this process in bytes, as Linux reports it."""
    with open("/proc/self/status", encoding="ascii") as file:
        line = next(line for line in file if line.startswith(what))
    return 1024.0 * int(line.split()[1])
