"""Contenders in turns, each in its own process, one at a time: so that noise meets all of them alike."""

import random
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from multiprocessing import get_context
from typing import Any, NamedTuple

from .child import serve
from .contenders import Contender
from .work import Work

PATIENCE = 3.0  # seconds for one contender at one work: the slow ones have fewer rounds
FEWEST = 2  # rounds all the same


class RefusedError(RuntimeError):
    """A contender cannot do a work; the message is its own."""


class Found(NamedTuple):
    """The measurements of one contender at one work."""

    seconds: float  # the best round
    first: float  # compilation and the first call
    memory: float  # megabytes that a call needs


class Racer:
    """The parent's end of a child."""

    def __init__(self, contender: Contender, cores: Sequence[int]) -> None:
        context = get_context("spawn")
        self.connection, other = context.Pipe()
        self.process = context.Process(target=serve, args=(other, contender.name, tuple(cores)), daemon=True)
        self.process.start()
        other.close()

    def wait(self) -> None:
        """Until it is there."""
        self.connection.recv()

    def ask(self, *order: Any) -> Any:
        """Have it do something; RefusedError if it cannot."""
        try:
            self.connection.send(order)
            good, answer = self.connection.recv()
        except (EOFError, OSError):
            raise RefusedError("its process has ended") from None
        if not good:
            raise RefusedError(answer)
        return answer

    def stop(self) -> None:
        """End the process."""
        if self.process.is_alive():
            self.connection.send(None)
        self.process.join(10.0)


@contextmanager
def racers(contenders: Iterable[Contender], cores: Sequence[int]) -> Iterator[dict[str, Racer]]:
    """A process for each contender, all on the same cores."""
    result = {one.name: Racer(one, cores) for one in contenders}
    try:
        for one in result.values():
            one.wait()
        yield result
    finally:
        for one in result.values():
            one.stop()


def race(who: Mapping[str, Racer], work: Work, count: int, rounds: int) -> dict[str, Found | str]:
    """Everyone at one work: what was found, or why not.

    The order changes from round to round: who comes after a slow one finds the caches cold.
    """
    result: dict[str, Found | str] = {}
    for name, racer in who.items():
        try:
            first = racer.ask("prepare", work.key, count)
            result[name] = Found(racer.ask("round"), first, racer.ask("memory"))
        except RefusedError as refused:
            result[name] = str(refused)
    turns, spent = [n for n, one in result.items() if isinstance(one, Found)], dict.fromkeys(result, 0.0)
    for number in range(rounds):
        random.Random(number).shuffle(turns)
        for name in turns:
            one = result[name]
            if isinstance(one, Found) and (number < FEWEST or spent[name] < PATIENCE):
                seconds = who[name].ask("round")
                spent[name] += seconds
                result[name] = one._replace(seconds=min(one.seconds, seconds))
    for name in turns:
        who[name].ask("forget")
    return result
