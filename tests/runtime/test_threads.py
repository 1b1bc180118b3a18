"""Parts of a length on threads: all of it once, the caller's thread among them, and one failure ends all."""

import signal
import threading
import time

import pytest

from desaxe.runtime.threads import run_parts


@pytest.mark.parametrize(
    ("length", "threads", "least", "longest"),
    [(1, None, 1, 10), (3, 2, 1, 10), (3, 8, 1, 10), (100, 2, 10, 7), (100, 1, 10, 7), (1_000, 3, 1, 1_000)],
)
def test_every_point_belongs_to_one_part(length, threads, least, longest):
    parts = []
    run_parts(lambda start, stop: parts.append((start, stop)), length, threads, least, longest)
    parts.sort()
    assert all(start < stop <= start + longest for start, stop in parts)
    assert [start for start, _ in parts] == [0, *(stop for _, stop in parts[:-1])]
    assert parts[-1][1] == length


def test_the_caller_works_too():
    seen = set()

    def part(start, stop):
        seen.add(threading.get_ident())
        time.sleep(0.01)

    run_parts(part, 100, 2, 1, 100)
    assert threading.get_ident() in seen
    assert len(seen) == 2


def test_parts_may_have_parts_of_their_own():
    """The threads that would help are busy then: nobody waits for them."""
    done = []
    run_parts(lambda a, b: run_parts(lambda c, d: done.append(d - c), 8, 2, 1, 8), 8, 2, 1, 8)
    assert sum(done) == 64


@pytest.mark.parametrize("by_caller", [True, False])
def test_a_failure_ends_the_work_of_all(by_caller):
    own, done = threading.get_ident(), []

    def part(start, stop):
        time.sleep(0.01)
        if (threading.get_ident() == own) is by_caller:
            raise KeyboardInterrupt if by_caller else ValueError
        done.append(start)

    with pytest.raises(KeyboardInterrupt if by_caller else ValueError):
        run_parts(part, 1_000, 2, 1, 2)
    assert len(done) < 250


class AlarmError(Exception):
    """An alarm went off."""


def alarm(number, frame):
    raise AlarmError


HANDLERS = [("SIGINT", signal.default_int_handler, KeyboardInterrupt), ("SIGALRM", alarm, AlarmError)]


@pytest.mark.skipif(not hasattr(signal, "pthread_kill"), reason="signals of threads")
@pytest.mark.parametrize(("name", "handler", "error"), HANDLERS)
def test_no_worker_is_left_behind_however_often_the_caller_is_interrupted(name, handler, error):
    """It would go on to write into arrays that the caller may have freed."""
    number, own, parts = getattr(signal, name), threading.get_ident(), []
    busy, all_sent = threading.Event(), threading.Event()

    def part(start, stop):
        if threading.get_ident() == own:
            busy.wait(10.0)
            return
        busy.set()
        all_sent.wait(10.0)
        parts.append(start)
        busy.clear()

    def send():
        busy.wait(10.0)
        for _ in range(20):
            signal.pthread_kill(own, number)  # which wakes a wait
            time.sleep(0.005)
        all_sent.set()

    before, sender = signal.signal(number, handler), threading.Thread(target=send)
    try:
        sender.start()
        with pytest.raises(error):
            run_parts(part, 1_000, 2, 1, 1)
        assert not busy.is_set()
        assert signal.getsignal(number) is handler
    finally:
        all_sent.set()
        sender.join()
        signal.signal(number, before)
    assert len(parts) == 1
