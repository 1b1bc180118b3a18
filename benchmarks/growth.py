"""Growth of the time with the number of points, from one to 10^8.

More than a million are computed a million at a time, in the same memory, by everyone whom it does not take
too long.
"""

from collections.abc import Mapping

from .race import Found, Racer, RefusedError, race
from .work import BY_KEY, MILLION

SIZES = tuple(10**k for k in range(9))
QUICK = (1, 1_000, 100_000)
LONGEST = 12.0  # seconds
WORK = BY_KEY["point"]


def growth(who: Mapping[str, Racer], sizes: tuple[int, ...], rounds: int) -> dict[str, dict[str, float]]:
    """Size -> name -> seconds for all its points."""
    result: dict[str, dict[str, float]] = {}
    for size in (size for size in sizes if size <= MILLION):
        raced = race(who, WORK, size, rounds)
        result[str(size)] = {name: one.seconds for name, one in raced.items() if isinstance(one, Found)}
    large = [size for size in sizes if size > MILLION]
    for name, racer in who.items() if large else ():
        try:
            racer.ask("prepare", WORK.key, MILLION)
            once = racer.ask("round")
            for size in (size for size in large if once * size < LONGEST * MILLION):
                result.setdefault(str(size), {})[name] = racer.ask("again", size // MILLION)
            racer.ask("forget")
        except RefusedError:
            continue
    return result
