"""Functions that spellings of operations call, besides `math`: plain Python with the answers of IEEE 754.

Modules take the text of these functions (see `builder`): a cache of machine code does not see changes in
another file.
"""

from math import copysign, cos, exp, fabs, floor, inf, log, nan, pow, sin, sqrt
from typing import Any


def two_sum_error(a: float, b: float) -> float:
    """The rounding error of a + b, exactly (Knuth)."""
    total = a + b
    of_b = total - a
    return (a - (total - of_b)) + (b - of_b)


def two_product_error(a: float, b: float) -> float:
    """The rounding error of a * b, exactly (Dekker: both factors in halves, whose products are exact)."""
    product = a * b
    wide = 134217729.0 * a
    a_high = wide - (wide - a)
    a_low = a - a_high
    wide = 134217729.0 * b
    b_high = wide - (wide - b)
    b_low = b - b_high
    return a_low * b_low - (((product - a_high * b_high) - a_low * b_high) - a_high * b_low) + 0.0


def mul_add(a: float, b: float, c: float) -> float:
    """a * b + c, rounded as often as the machine likes."""
    return a * b + c


def extended_only(a: bool) -> bool:
    """False: a form that twice the digits are needed to tell from the plain one is not taken here."""
    return False


def rounding(a: float) -> float:
    """A bound of what rounding takes from a number of this size in four operations."""
    return 4.440892098500626e-16 * fabs(a)


def power_of_two(a: float) -> float:
    """The power of two that is not below a size (Rump), from 2^-960 to 2^960."""
    size = a if a < 9.7453140114e288 else 9.7453140114e288
    size = size if size > 1.0261342003245941e-289 else 1.0261342003245941e-289
    wide = 9007199254740992.0 * size
    step = (wide + size) - wide
    return step if step > 0.0 else size


def rotated_sin(sine: float, cosine: float, quarters: float) -> float:
    """The sine of an angle and a whole number of quarter turns, from the angle's sine and cosine."""
    value = cosine if quarters % 2.0 == 1.0 else sine
    return -value if quarters % 4.0 >= 2.0 else value


def rotated_cos(sine: float, cosine: float, quarters: float) -> float:
    """The cosine of an angle and a whole number of quarter turns, from the angle's sine and cosine."""
    value = sine if quarters % 2.0 == 1.0 else cosine
    return -value if (quarters + 1.0) % 4.0 >= 2.0 else value


def lookup_piece(x: float, knots: Any, way: float) -> float:
    """The number of the piece of a table at x; those of the way back follow. Of NaN it is the first."""
    low, high = 0, len(knots)
    while low < high:
        middle = (low + high) // 2
        if knots[middle] <= x:
            low = middle + 1
        else:
            high = middle
    return float(low + (len(knots) + 1 if way < 0.0 else 0))


def lookup(x: float, knots: Any, rows: Any, piece: float) -> float:
    """The value of a piece of a table at x, beyond its ends too."""
    number = int(piece)
    at = number % (len(knots) + 1)
    s = x - float(knots[at - 1 if at > 0 else 0])
    k = 4 * number
    a, b, c, d = float(rows[k]), float(rows[k + 1]), float(rows[k + 2]), float(rows[k + 3])
    return a + s * (b + s * (c + s * d))


def lookup_slope(x: float, knots: Any, rows: Any, piece: float) -> float:
    """The slope of a piece of a table at x, beyond its ends too."""
    number = int(piece)
    at = number % (len(knots) + 1)
    s = x - float(knots[at - 1 if at > 0 else 0])
    k = 4 * number
    b, c, d = float(rows[k + 1]), float(rows[k + 2]), float(rows[k + 3])
    return b + s * (2.0 * c + s * (3.0 * d))


def divide(a: float, b: float) -> float:
    """a / b with the IEEE 754 answers that Python refuses to give."""
    if b:
        return a / b
    return nan if a == 0.0 or a != a else copysign(inf, a) * copysign(1.0, b)


def root(a: float) -> float:
    """The square root, NaN below zero."""
    return sqrt(a) if a >= 0.0 else nan


def sine(a: float) -> float:
    """The sine, NaN of an infinity."""
    return sin(a) if a - a == 0.0 else nan


def cosine(a: float) -> float:
    """The cosine, NaN of an infinity."""
    return cos(a) if a - a == 0.0 else nan


def hypot(a: float, b: float) -> float:
    """The root of a^2 + b^2; the squares neither overflow nor vanish."""
    a, b = fabs(a), fabs(b)
    most, least = b if a < b else a, a if a < b else b
    size = most * sqrt(1.0 + (least / most) * (least / most)) if least > 0.0 else most + least
    return most + least if most - most != 0.0 else size


def exponential(a: float) -> float:
    """The exponential; infinite where it is too large."""
    return exp(a) if not a > 709.782712893384 else a * inf


def logarithm(a: float) -> float:
    """The natural logarithm, NaN below zero."""
    return log(a) if a > 0.0 else (-inf if a == 0.0 else nan)


def power(a: float, b: float) -> float:
    """a to the power b with the IEEE 754 answers that Python refuses to give."""
    if a == 0.0 and b < 0.0:
        return copysign(inf, a) if b % 2.0 == 1.0 else inf
    if a < 0.0 and b != floor(b) if a - a == 0.0 and b - b == 0.0 else False:
        return nan
    try:
        return pow(a, b)
    except OverflowError:
        return -inf if a < 0.0 and b % 2.0 == 1.0 else inf


def whole(a: float) -> float:
    """The floor as a float; infinities, NaN and the sign of a zero stay."""
    return float(floor(a)) if a - a == 0.0 and a else a
