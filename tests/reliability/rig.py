"""Trials: a thing is done, disturbed by a seed's choice of moment or damage, and what is left is judged."""

import os
import random
import signal
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

RIGHT, WRONG, CRASHED, HUNG, LOST = "right", "wrong", "crashed", "hung", "lost"
OUTCOMES = (RIGHT, WRONG, CRASHED, HUNG, LOST)


class Verdict(NamedTuple):
    """The outcome of a trial, with a note if it failed."""

    outcome: str
    note: str = ""


GOOD = Verdict(RIGHT)


class Trial(NamedTuple):
    """One kind of trial.

    what   a line for the report
    run    (folder, random numbers of a seed) -> verdict; the folder is empty and its own
    short  how many seeds the default test run takes
    full   how many `python -m tests.reliability` takes
    """

    what: str
    run: Callable[[Path, random.Random], Verdict]
    short: int
    full: int


def child(work: Callable[[], object]) -> int:
    """Run some work in a forked process, its process number. It ends with 0, or 1 after an exception."""
    number = os.fork()
    if number:
        return number
    code = 1
    try:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        with open(os.devnull, "w") as nowhere:
            os.dup2(nowhere.fileno(), 2)
        work()
        code = 0
    finally:
        os._exit(code)


def ended(number: int, seconds: float) -> int | None:
    """The exit code of a child, or minus a signal's number; None if it had to be killed."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        done, status = os.waitpid(number, os.WNOHANG)
        if done:
            return os.waitstatus_to_exitcode(status)
        time.sleep(0.002)
    os.kill(number, signal.SIGKILL)
    os.waitpid(number, 0)
    return None


def killed_after(number: int, seconds: float, how: int = signal.SIGKILL) -> None:
    """Let a child run for some time, then kill it."""
    time.sleep(seconds)
    os.kill(number, how)
    os.waitpid(number, 0)
