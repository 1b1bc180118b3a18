"""Taylor polynomials whose coefficients are power series in time, in ball arithmetic, and what settles them.

Every number is python-flint's ``arb``: an enclosure. Precision is raised until it is small enough.
"""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache

import mpmath
from flint import arb, arb_series, ctx

BITS = (1024, 2048, 4096, 8192)  # precisions tried
_NOTHING = arb(2) ** -1536  # an enclosure of zero smaller than this is zero
REST = arb(2) ** -1000  # the speed that stands for "about to vanish"; then
_REST_MAGNITUDE = 300  # numbers below 2^-300 tend to 0 and those above 2^300 to infinity


class Jet:
    """A Taylor polynomial: sorted parameter numbers (a monomial) -> coefficient, a power series in time."""

    def __init__(self, terms: dict[tuple[int, ...], arb_series], order: int) -> None:
        self.terms, self.order = terms, order

    def __add__(self, other: "Jet") -> "Jet":
        terms = dict(self.terms)
        for monomial, coefficient in other.terms.items():
            terms[monomial] = terms[monomial] + coefficient if monomial in terms else coefficient
        return Jet(terms, self.order)

    def __mul__(self, other: "Jet") -> "Jet":
        terms: dict[tuple[int, ...], arb_series] = {}
        for left, a in self.terms.items():
            for right, b in other.terms.items():
                if len(left) + len(right) <= self.order:
                    monomial = _merge(left, right)
                    terms[monomial] = terms[monomial] + a * b if monomial in terms else a * b
        return Jet(terms, self.order)

    def times(self, factor: int) -> "Jet":
        """This jet times a whole number."""
        return Jet({monomial: a * factor for monomial, a in self.terms.items()}, self.order)

    def __sub__(self, other: "Jet") -> "Jet":
        return self + other.times(-1)

    def compose(self, taylor: list[arb_series]) -> "Jet":
        """A function of this jet, from the function's Taylor coefficients at the centre (Horner)."""
        offset = Jet({monomial: a for monomial, a in self.terms.items() if monomial}, self.order)
        result = Jet({(): taylor[self.order]}, self.order)
        for coefficient in reversed(taylor[: self.order]):
            result = result * offset + Jet({(): coefficient}, self.order)
        return result

    def sqrt(self) -> "Jet":
        """The square root."""
        taylor, inverse = [self.terms[()].sqrt()], self.terms[()].rsqrt() ** 2
        for k in range(self.order):
            taylor.append(taylor[k] * inverse * (1 - 2 * k) / (2 * k + 2))
        return self.compose(taylor)

    def inverse(self) -> "Jet":
        """The reciprocal."""
        return self.compose([-((-1 / self.terms[()]) ** (k + 1)) for k in range(self.order + 1)])

    def sin_cos(self) -> tuple["Jet", ...]:
        """Sine and cosine."""
        sine, cosine = self.terms[()].sin(), self.terms[()].cos()
        cycles = (sine, cosine, -sine, -cosine), (cosine, -sine, -cosine, sine)
        taylors = ([c[k % 4] / math.factorial(k) for k in range(self.order + 1)] for c in cycles)
        return tuple(map(self.compose, taylors))

    def arc(self, value: arb_series, sign: int) -> "Jet":
        """asin (sign 1) or acos (sign -1), from (1 - x^2) f'' = x f' and f' = sign/sqrt(1 - x^2)."""
        x = self.terms[()]
        slope = (1 - x * x).rsqrt()
        taylor = [value, slope * sign]
        for k in range(self.order - 1):
            head = x * taylor[k + 1] * ((k + 1) * (2 * k + 1)) + taylor[k] * (k * k)
            taylor.append(head * slope * slope / ((k + 1) * (k + 2)))
        return self.compose(taylor)

    def after(self, k: int) -> "Jet":
        """This constant times time^k / k!."""
        before, scale = [0] * k, math.factorial(k)
        return Jet({m: arb_series([*before, a[0] / scale]) for m, a in self.terms.items()}, self.order)

    def rate(self, k: int) -> "Jet":
        """The k-th derivative with respect to time, now."""
        return Jet({m: arb_series([a[k] * math.factorial(k)]) for m, a in self.terms.items()}, self.order)

    def partial(self, monomial: tuple[int, ...]) -> arb:
        """The partial derivative (not the Taylor coefficient) that belongs to a sorted monomial, now."""
        repeats = math.prod(math.factorial(monomial.count(number)) for number in set(monomial))
        return self.terms[monomial][0] * repeats if monomial in self.terms else arb(0)


@cache
def _merge(left: tuple[int, ...], right: tuple[int, ...]) -> tuple[int, ...]:
    return tuple(sorted(left + right))


@contextmanager
def precision(bits: int, terms: int = 4) -> Iterator[None]:
    """Set the precision of arithmetic, and the length of power series in time: 4 terms reach the jerk."""
    before = ctx.prec, ctx.cap
    ctx.prec, ctx.cap = bits, terms
    try:
        yield
    finally:
        ctx.prec, ctx.cap = before


def sign(x: float | arb) -> int:
    """-1 or 1; 1 at zero."""
    return -1 if x < 0 else 1


def _number(x: arb) -> mpmath.mpf:
    """The midpoint, exactly."""
    mantissa, exponent = x.mid().man_exp()
    return mpmath.mp.make_mpf(mpmath.libmp.from_man_exp(int(mantissa), int(exponent)))


def settled(x: arb, digits: int) -> mpmath.mpf | None:
    """The number in an enclosure of `digits` digits, else None; 0 if far below the smallest double."""
    if x.is_finite() and (x == 0 or x.rel_accuracy_bits() > digits * math.log2(10)):
        return _number(x)
    return mpmath.mpf(0) if x.is_finite() and abs(x) < _NOTHING else None


def limit(x: mpmath.mpf) -> mpmath.mpf:
    """The limit of a number as the crank stops: 0 or infinite if it scales with the speed."""
    if x == 0 or not mpmath.isfinite(x) or abs(mpmath.mag(x)) < _REST_MAGNITUDE:
        return x
    return mpmath.mpf(0) if mpmath.mag(x) < 0 else mpmath.sign(x) * mpmath.inf


def tendency(x: arb, still: bool = False) -> int | None:
    """The sign of a number, or of its limit as the crank stops; None if the enclosure is too wide."""
    smallest = arb(2) ** -_REST_MAGNITUDE if still else _NOTHING
    if x.is_finite() and (x == 0 or abs(x) < smallest):
        return 0
    return 1 if x > 0 else -1 if x < 0 else None
