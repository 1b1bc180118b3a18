"""Evenly spaced values, each the double closest to its exact place."""

from fractions import Fraction
from math import frexp, lcm

MOST = 100_000_000  # values of one range
_DIGITS = 26  # of each of the first two parts of a step: times a whole number below 2^27 they are exact


class Spread(tuple[float, ...]):
    """The values of a range, and its ends as they are written."""

    start: Fraction
    stop: Fraction


def spread(start: Fraction, stop: Fraction, steps: int) -> Spread:
    """The values from start to stop, both included: quotients of whole numbers, which Python rounds once."""
    step = (stop - start) / steps
    common = lcm(start.denominator, step.denominator)
    first, distance = int(start * common), int(step * common)
    values = Spread((*((first + k * distance) / common for k in range(steps)), float(stop)))
    values.start, values.stop = start, stop
    return values


def in_parts(start: Fraction, step: Fraction) -> tuple[float, float, tuple[float, float, float]]:
    """The first value and what rounding takes from it; the step as three doubles."""
    first = float(start)
    wide = _short(step)
    narrow = _short(step - Fraction(wide))
    return (
        first,
        float(start - Fraction(first)),
        (wide, narrow, float(step - Fraction(wide) - Fraction(narrow))),
    )


def _short(value: Fraction) -> float:
    """The value with few digits."""
    if not value:
        return 0.0
    scale = Fraction(2) ** (_DIGITS - frexp(float(value))[1])
    return float(Fraction(int(value * scale)) / scale)
