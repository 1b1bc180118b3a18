"""Evenly spaced values, each the double closest to its exact place."""

from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
MOST = 100_000_000  # values of one range
_BLOCK = 1 << 16  # values at a time, so that what is between them stays in the cache
_DIGITS = 26  # of each of the first two parts of a step: times a whole number below 2^27 they are exact
_ERROR = 2.0**-96  # of the sum of the parts, as a fraction of the larger end; 2^-99 by its roundings
_SCALES = Fraction(1, 2**800), Fraction(2**1000)  # of the larger end, where no part over- or underflows


class Spread(tuple[float, ...]):
    """The values of a range, and its ends as they are written."""

    start: Fraction
    stop: Fraction


def spread(start: Fraction, stop: Fraction, steps: int) -> Spread:
    """The values from start to stop, both included.

    They are summed in parts; one that this leaves in doubt, next to half way between two doubles, is
    computed with fractions.
    """
    step = (stop - start) / steps
    scale = max(abs(start), abs(stop))
    found: list[float] = []
    for first in range(0, steps, _BLOCK):
        places = range(first, min(first + _BLOCK, steps))
        if not _SCALES[0] < scale < _SCALES[1]:
            found += [float(start + step * place) for place in places]
            continue
        values, in_doubt = _rounded(start, step, places, float(scale) * _ERROR)
        for index in np.flatnonzero(in_doubt).tolist():
            values[index] = float(start + step * places[index])
        found += values.tolist()
    values_and_ends = Spread((*found, float(stop)))
    values_and_ends.start, values_and_ends.stop = start, stop
    return values_and_ends


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
    exponent = np.frexp(float(value))[1]
    scale = Fraction(2) ** int(_DIGITS - exponent)
    return float(Fraction(int(value * scale)) / scale)


def _rounded(start: Fraction, step: Fraction, places: range, error: float) -> tuple[Array, NDArray[np.bool_]]:
    """The rounded sums at these places, and where an error of their parts could change them."""
    first, rest, (wide, narrow, tiny) = in_parts(start, step)
    k = np.arange(places.start, places.stop, dtype=np.float64)
    total, lost = _sum(k * wide, k * narrow)
    value, more = _sum(first, total)
    value, left = _sum(value, more + (lost + (k * tiny + rest)))
    return value, (value + (left - error) != value) | (value + (left + error) != value)


def _sum(a: Array | float, b: Array) -> tuple[Array, Array]:
    """The sum of a and b, and what its rounding lost."""
    total = a + b
    of_b = total - a
    return total, (a - (total - of_b)) + (b - of_b)
