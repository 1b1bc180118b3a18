"""Functions that let one closed form serve a number, in plain `math`, and arrays, in NumPy.

A root of less than nothing and nothing over nothing are NaN, as in arrays; a number over nothing is infinite.
"""

import math
from functools import cache
from typing import Any, NamedTuple


class Maths(NamedTuple):
    """The functions that a closed form calls, for numbers or for arrays."""

    sqrt: Any
    atan2: Any
    over: Any  # a / b
    choose: Any  # a where a condition holds, else b
    ldexp: Any
    exponent: Any  # of two, that a number is below


def _sqrt(a: float) -> float:
    return math.sqrt(a) if a >= 0.0 else math.nan


def _over(a: float, b: float) -> float:
    if b:
        return a / b
    return math.copysign(math.inf, a) * math.copysign(1.0, b) if a else math.nan


def _ldexp(a: float, power: int) -> float:
    try:
        return math.ldexp(a, power)
    except OverflowError:
        return math.copysign(math.inf, a)


PLAIN = Maths(
    _sqrt, math.atan2, _over, lambda condition, a, b: a if condition else b, _ldexp,
    lambda a: math.frexp(a)[1],
)  # fmt: skip


@cache
def arrays() -> Maths:
    """The functions for arrays, in NumPy."""
    import numpy as np

    return Maths(np.sqrt, np.arctan2, np.divide, np.where, np.ldexp, lambda a: np.frexp(a)[1])


def sum_of_three(a: Any, b: Any, c: Any) -> Any:
    """a + b + c, as if rounded once where it cancels: the errors of both sums are added last."""
    first, lost = _two_sum(a, b)
    second, also_lost = _two_sum(first, c)
    return second + (lost + also_lost)


def _two_sum(a: Any, b: Any) -> tuple[Any, Any]:
    total = a + b
    part = total - a
    return total, (a - (total - part)) + (b - part)
