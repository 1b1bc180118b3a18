"""An interrupt is raised in the caller and ends the work, whenever it comes, to whichever thread."""

import signal
import sys
import threading

import pytest

from desaxe.support import interrupts
from desaxe.support.deadline import Deadline
from desaxe.support.interrupts import stopped_early
from desaxe.support.signals import finished, put_off

LONG = 20.0  # seconds that work takes which nothing stops


@pytest.fixture(autouse=True)
def default_handler():
    before, trace = signal.signal(signal.SIGINT, signal.default_int_handler), sys.gettrace()
    yield
    sys.settrace(trace)
    signal.signal(signal.SIGINT, before)


class LongWork:
    """Work that ends when it is stopped, as compiled loops do, or when it is done."""

    def __init__(self, begun=lambda: None):
        self.end, self.ended, self.begun, self.stopped = threading.Event(), threading.Event(), begun, False

    def __call__(self):
        self.begun()
        self.end.wait(LONG)
        self.ended.set()

    def stop(self):
        self.stopped = not self.ended.is_set()
        self.end.set()

    def run(self, timeout=600.0):
        stopped_early(self, self.stop, Deadline("work", timeout))


def to_this_thread():
    """A signal that another thread than the main one receives wakes no wait of the main one.

    Nor does one that the main thread receives on its way into the wait: that moment is too short to hit.
    """
    signal.pthread_kill(threading.get_ident(), signal.SIGINT)


@pytest.mark.skipif(not hasattr(signal, "pthread_kill"), reason="signals of threads")
@pytest.mark.parametrize("timeout", [600.0, float("inf")])
def test_an_interrupt_that_wakes_no_wait_ends_the_work(timeout):
    work = LongWork(to_this_thread)
    with pytest.raises(KeyboardInterrupt):
        work.run(timeout)
    assert work.stopped
    assert work.ended.wait(LONG)


@pytest.mark.skipif(not hasattr(signal, "pthread_kill"), reason="signals of threads")
def test_an_interrupt_waits_for_a_compilation():
    done = []
    with pytest.raises(KeyboardInterrupt):
        finished(lambda: done.append(to_this_thread()))
    assert done == [None]


def interrupted_at(line, work):
    """Run work with SIGINT at line n of the module, counted from 0; False if it ended before."""
    lines = 0

    def trace(frame, event, argument):
        nonlocal lines
        if frame.f_code.co_filename != interrupts.__file__:
            return None
        if event == "line":
            lines += 1
            if lines == DONE:
                work.end.set()
            if lines == line + 1:
                sys.settrace(None)
                signal.raise_signal(signal.SIGINT)
        return trace

    sys.settrace(trace)
    try:
        work.run()
    finally:
        sys.settrace(None)
    return lines > line


DONE = 45  # lines: the work began long before, and was waited for in some turns


def test_an_interrupt_at_any_line_ends_the_work(monkeypatch):
    monkeypatch.setattr(interrupts, "LATE", 0.002)
    for line in range(1_000):
        begun = threading.Event()
        work = LongWork(begun.set)
        try:
            within = interrupted_at(line, work)
        except KeyboardInterrupt:
            assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
            if line < DONE - 1 and (interrupts.is_at_work() or begun.is_set()):
                assert work.stopped, f"line {line}: it went on"
                assert work.ended.wait(LONG)
            continue
        assert not within, f"line {line}: lost"
        break
    assert DONE < line < 1_000


def fails_after_signals(heard):
    with put_off(lambda: heard.append("stop")):
        signal.raise_signal(signal.SIGTERM)
        signal.raise_signal(signal.SIGINT)
        assert heard == [signal.SIGTERM, "stop"]
        raise ImportError("a package that is missing")


def test_a_handler_runs_when_its_signal_comes_and_raises_after_a_block_that_puts_it_off():
    heard, before = [], signal.signal(signal.SIGTERM, lambda number, frame: heard.append(number))
    try:
        with pytest.raises(KeyboardInterrupt):
            fails_after_signals(heard)
    finally:
        signal.signal(signal.SIGTERM, before)
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
