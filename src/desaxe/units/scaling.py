"""Numbers and arrays times exact factors, rounded once."""

from decimal import Decimal, localcontext
from fractions import Fraction
from math import isfinite
from typing import Any

from ..support.forks import IMPORTS

_MOST_DECIMALS = 6  # of the elements of arrays that are taken as written


def by_digits(value: Any, factor: Fraction) -> Any:
    """A number as it is written, times a factor: 2.1 mm is 0.0021 m, the double of the text "2.1 mm".

    Of an array this holds for elements with up to six decimals; others are scaled as doubles.
    """
    if isinstance(value, (int, float)):
        return float(Fraction(repr(float(value))) * factor) if isfinite(value) else float(value)
    with IMPORTS:
        import numpy as np

    array, one = np.asarray(value, dtype=np.float64), 10**_MOST_DECIMALS
    with np.errstate(over="ignore", invalid="ignore"):
        count = np.rint(array * one)
        written = count / one == array
    result = np.where(written, scaled(count, factor / one), scaled(array, factor))
    return result if result.ndim else float(result)


def scaled(value: Any, factor: Fraction) -> Any:
    """A number times a factor, rounded once; an array in extended precision where supported."""
    above, below = factor.as_integer_ratio()
    if isinstance(value, (int, float)):
        if not isfinite(value):
            return float(value)
        number, under = value.as_integer_ratio()
        return number * above / (under * below)
    with IMPORTS:
        import numpy as np

    wide = np.asarray(value, dtype=np.longdouble)
    if above == 1:
        product = wide / np.longdouble(str(below))
    else:
        with localcontext(prec=30):
            product = wide * np.longdouble(str(Decimal(above) / Decimal(below)))
    result = np.asarray(product, dtype=np.float64)
    return result if result.ndim else float(result)
