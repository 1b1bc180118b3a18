"""Numbers and arrays times exact factors, rounded once."""

from fractions import Fraction
from math import isfinite
from typing import Any

from ..support.lazy import np

_DECIMALS = (6, 12)  # of the elements of arrays that are taken as written


def by_digits(value: Any, factor: Fraction) -> Any:
    """A number as it is written, times a factor: 2.1 mm is 0.0021 m, the double of the text "2.1 mm".

    Of an array this holds for elements with up to 12 decimals and 15 digits; others are scaled as doubles.
    """
    if isinstance(value, (int, float)):
        return float(Fraction(repr(float(value))) * factor) if isfinite(value) else float(value)
    array = np.asarray(value, dtype=np.float64)
    result, left = scaled(array, factor), np.isfinite(array)
    for decimals in _DECIMALS:
        if not left.any():
            break
        with np.errstate(over="ignore"):
            count = np.rint(array * 10.0**decimals)
        written = left & (count / 10.0**decimals == array) & (np.abs(count) < 2.0**53)
        result = np.where(written, scaled(count, factor / 10**decimals), result)
        left &= ~written
    return result if result.ndim else float(result)


def scaled(value: Any, factor: Fraction) -> Any:
    """A number times a factor, rounded once; of an array the product is in twice the digits.

    T. J. Dekker, Numer. Math. 18 (1971); where that overflows it is that of doubles.
    """
    if isinstance(value, (int, float)):
        return float(Fraction(value) * factor) if isfinite(value) else float(value)
    array, high = np.asarray(value, dtype=np.float64), float(factor)
    with np.errstate(over="ignore", invalid="ignore"):
        product = array * high
        (a, b), (c, d) = _halves(array), _halves(high)
        rest = ((a * c - product) + a * d + b * c) + b * d + array * float(factor - Fraction(high))
        result = np.asarray(np.where(np.isfinite(rest), product + rest, product))
    return result if result.ndim else float(result)


def _halves(value: Any) -> tuple[Any, Any]:
    """A number as the sum of two with 26 bits each."""
    wide = value * 134217729.0
    high = wide - (wide - value)
    return high, value - high
