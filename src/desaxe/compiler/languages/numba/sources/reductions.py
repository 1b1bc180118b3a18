"""Reductions of a row: the largest number and its place, or a sum. A NaN is skipped."""

from __future__ import annotations

from math import frexp, inf
from typing import TYPE_CHECKING

from numpy import full, zeros

if TYPE_CHECKING:
    from typing import Any


def count_valid(row: Any) -> int:
    """The number of elements that are not NaN."""
    found = 0
    for here in range(row.size):
        found += row[here] == row[here]
    return found


def take_max(row: Any, start: int, value: float, place: int) -> tuple[float, int]:
    """Go on with a row: the largest number so far and its place."""
    return take_largest(row, start, value, place, kind=0)


def take_min(row: Any, start: int, value: float, place: int) -> tuple[float, int]:
    """Go on with a row: the smallest number so far, negated, and its place."""
    return take_largest(row, start, value, place, kind=1)


def take_absmax(row: Any, start: int, value: float, place: int) -> tuple[float, int]:
    """Go on with a row: the largest magnitude so far and its place."""
    return take_largest(row, start, value, place, kind=2)


def scored(x: float, kind: int) -> float:
    """The number that is to be large: x itself, -x or |x|."""
    return abs(x) if kind == 2 else -x if kind == 1 else x


def take_largest(row: Any, start: int, value: float, place: int, kind: int) -> tuple[float, int]:
    """Go on with a row: the largest score so far and its place, the first of equals; no NaN.

    Sixteen lanes, each with a largest number of its own, are vectors; one largest number is a chain.
    """
    values = full(16, -inf)
    places = full(16, -1)
    whole = row.size - row.size % 16
    for first in range(0, whole, 16):
        for lane in range(16):
            x = scored(row[first + lane], kind)
            better = (x > values[lane]) | ((places[lane] < 0) & (x == x))
            values[lane] = x if better else values[lane]
            places[lane] = first if better else places[lane]
    best, at = -inf, -1
    for lane in range(16):
        x, here = values[lane], places[lane] + lane
        if places[lane] >= 0 and (at < 0 or x > best or (x == best and here < at)):
            best, at = x, here
    for here in range(whole, row.size):
        x = scored(row[here], kind)
        if x > best or (at < 0 and x == x):
            best, at = x, here
    if at >= 0 and (place < 0 or best > value):
        return best, start + at
    return value, place


def take_sum(row: Any, factor: float, power: int, total: float, rest: float) -> tuple[float, float]:
    """Go on with the sum of (factor x)^power in sixteen lanes, with what rounding takes kept; no NaN."""
    sums, rests = zeros(16), zeros(16)
    whole = row.size - row.size % 16
    for first in range(0, whole, 16):
        for lane in range(16):
            x = factor * row[first + lane]
            x = x * x if power == 2 else x
            x = x if x == x else 0.0
            longer = sums[lane] + x
            of_x = longer - sums[lane]
            rests[lane] += (sums[lane] - (longer - of_x)) + (x - of_x)
            sums[lane] = longer
    for place in range(16 + row.size - whole):
        x = factor * row[whole + place - 16] if place >= 16 else sums[place]
        x = x * x if power == 2 and place >= 16 else x
        x = x if x == x else 0.0
        longer = total + x
        of_x = longer - total
        rest += (total - (longer - of_x)) + (x - of_x)
        rest += rests[place] if place < 16 else 0.0
        total = longer
    return total, rest


def whole_sum(total: float, rest: float) -> float:
    """A sum and what rounding took from it; an infinity has no rest."""
    return total + rest if rest == rest else total


def take_mean(row: Any, start: int, total: float, rest: float) -> tuple[float, float]:
    """Go on with the sum for a mean."""
    return take_sum(row, 1.0, 1, total, rest)


def factor_for(row: Any, factor: float) -> float:
    """A power of two that brings the squares of a row into range; the one so far, if it does."""
    largest = 0.0
    for here in range(row.size):
        x = abs(row[here])
        largest = x if largest < x < inf else largest
    if largest == 0.0 or (factor > 0.0 and largest * factor < 2.0**300):
        return factor
    return 2.0 ** max(min(-frexp(largest)[1], 1000), -1000)
