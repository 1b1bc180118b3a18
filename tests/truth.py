"""The truth about one point of the offset slider-crank, to as many digits as are asked for.

Nothing here is shared with the package.  The raw loop closure

    B = (AB sin theta, AB cos theta),   C = (-ec, Y),   |C - B| = BC,   on the branch given,

is evaluated in ball arithmetic (python-flint's ``arb``: every result is an enclosure), as a power series
in time whose coefficients are truncated Taylor polynomials in the parameters.  One evaluation encloses every
quantity, its rates and all its partial derivatives, mixed ones too.  Precision is raised until the enclosure
is far smaller than the last digit asked for.  The doubles given are taken as exact.

    truth("a_C_wrt_ec", theta=1.0, ec=0.01, AB=0.125, BC=0.35, omega0=157.0)     # an mpmath number
    truth_all(["Y", "V_C"], theta=1.0, ec=0.01, AB=0.125, BC=0.35, omega=3.0)    # a state instead of a law
    conditions("a_C", theta=1.0, ec=0.01, AB=0.125, BC=0.35, omega0=157.0)       # sum of condition numbers

Motion: d theta/dt = omega, d omega/dt = alpha, a constant.  Under the law, omega = sign(omega0)
sqrt(omega0^2 + 2 alpha theta) moves with theta, omega0 and alpha; as a state (``omega=``), omega and alpha
are parameters themselves.  Where the crank stands still, everything is its limit for a vanishing speed, with
alpha as given: infinite if the limit is.

Results are NaN where the mechanism cannot be assembled, is stalled or folds (D = 0, even where Y is finite).
Kinks are taken from the right: |ec| at ec = 0, |phi| at phi = 0, sign(omega0) at 0.
"""

import math
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from fractions import Fraction
from functools import cache, lru_cache
from itertools import combinations_with_replacement

import mpmath
from flint import arb, arb_series, ctx

LAW = ("theta", "ec", "AB", "BC", "omega0", "alpha")
STATE = ("theta", "ec", "AB", "BC", "omega", "alpha")

QUANTITIES = (
    *("phi", "delta", "Y", "s", "V_C", "a_C", "j_C", "omega", "omega_BC", "alpha_BC"),
    *("V_B_X", "V_B_Y", "V_B", "a_B_X", "a_B_Y", "a_B"),
    *("transmission_angle", "pressure_angle", "margin"),
)
GAPS = {"margin": (-1, 1), "rod": (0, 1), "crank": (1, 0), "ec": (0, 0)}  # |ec| = a AB + b BC -+ gap
SECOND_ORDER = ("Y", "V_C", "a_C", "omega_BC", "alpha_BC")

_BITS = (1024, 2048, 4096, 8192)  # precisions tried
_NOTHING = arb(2) ** -1536  # an enclosure of zero smaller than this is zero
_REST = arb(2) ** -1000  # the speed that stands for "about to vanish"; then
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
        taylor, inverse = [self.terms[()].sqrt()], self.terms[()].rsqrt() ** 2
        for k in range(self.order):
            taylor.append(taylor[k] * inverse * (1 - 2 * k) / (2 * k + 2))
        return self.compose(taylor)

    def inverse(self) -> "Jet":
        return self.compose([-((-1 / self.terms[()]) ** (k + 1)) for k in range(self.order + 1)])

    def sin_cos(self) -> tuple["Jet", ...]:
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
def _precision(bits: int) -> Iterator[None]:
    """Arithmetic with so many bits, and power series in time up to the jerk."""
    before = ctx.prec, ctx.cap
    ctx.prec, ctx.cap = bits, 4
    try:
        yield
    finally:
        ctx.prec, ctx.cap = before


def _sign(x: float | arb) -> int:
    return -1 if x < 0 else 1


def _speed(theta: Jet, omega: Jet, alpha: Jet, law: bool) -> Jet:
    """The crank's speed: as given, or sign(omega0) sqrt(omega0^2 + 2 alpha theta)."""
    if not law:
        return omega
    return (omega * omega + (alpha * theta).times(2)).sqrt().times(_sign(omega.terms[()][0]))


def _closure(parameters: list[Jet], branch: int, law: bool) -> tuple[Jet, ...]:
    """Solve the loop: theta, B, Y, phi and delta as functions of time."""
    theta, ec, AB, BC, omega, alpha = parameters
    theta = theta + _speed(theta, omega, alpha, law).after(1) + alpha.after(2)
    sine, cosine = theta.sin_cos()
    B_X, B_Y = AB * sine, AB * cosine
    across = ec + B_X  # from C to B, along X
    Y = B_Y + (BC * BC - across * across).sqrt().times(branch)
    ratio = across * BC.inverse()
    phi, delta = ratio.arc(ratio.terms[()].asin(), 1), ratio.arc(ratio.terms[()].acos(), -1)
    return theta, B_X, B_Y, Y, phi, delta


def _quantities(parameters: list[Jet], branch: int, law: bool) -> dict[str, Jet]:
    """Every quantity by name."""
    _, ec, AB, BC, _, _ = parameters
    theta, B_X, B_Y, Y, phi, delta = _closure(parameters, branch, law)
    V_X, V_Y, a_X, a_Y = B_X.rate(1), B_Y.rate(1), B_X.rate(2), B_Y.rate(2)
    outer, pressure = ((AB + BC) * (AB + BC) - ec * ec).sqrt(), phi.times(_sign(phi.terms[()][0]))
    quarter = Jet({(): arb_series([arb.pi() / 2])}, phi.order)
    return {
        **{"phi": phi, "delta": delta, "Y": Y, "s": outer - Y.times(branch)},
        **{"V_B_X": V_X, "V_B_Y": V_Y, "V_B": (V_X * V_X + V_Y * V_Y).sqrt()},
        **{"a_B_X": a_X, "a_B_Y": a_Y, "a_B": (a_X * a_X + a_Y * a_Y).sqrt()},
        **{"omega": theta.rate(1), "omega_BC": phi.rate(1), "alpha_BC": phi.rate(2)},
        **{"V_C": Y.rate(1), "a_C": Y.rate(2), "j_C": Y.rate(3)},
        **{"transmission_angle": quarter - pressure, "pressure_angle": pressure},
        "margin": BC - AB - ec.times(_sign(ec.terms[()][0])),
    }


@lru_cache(maxsize=16)
def _stands_still(theta: float, speed: float, alpha: float, law: bool) -> bool:
    start = Fraction(speed)
    return start * start + 2 * Fraction(alpha) * Fraction(theta) == 0 if law else start == 0


@lru_cache(maxsize=16)
def _enclosures(values: tuple[float, ...], law: bool, branch: int, order: int, bits: int) -> dict[str, Jet]:
    """Enclosures of all quantities and partial derivatives at one point."""
    theta, *_, speed, alpha = values
    with _precision(bits):
        exact = [arb(value) for value in values]
        if _stands_still(theta, speed, alpha, law):
            exact[4] += _sign(speed) * _REST
        terms = [{(): arb_series([x]), (number,): arb_series([1])} for number, x in enumerate(exact)]
        return _quantities([Jet(parameter, order) for parameter in terms], branch, law)


def _number(x: arb) -> mpmath.mpf:
    """The midpoint, exactly."""
    mantissa, exponent = x.mid().man_exp()
    return mpmath.mp.make_mpf(mpmath.libmp.from_man_exp(int(mantissa), int(exponent)))


def _settled(x: arb, digits: int) -> mpmath.mpf | None:
    """The number inside an enclosure, if that is good enough; zero if it is far below the smallest double."""
    if x.is_finite() and (x == 0 or x.rel_accuracy_bits() > digits * math.log2(10)):
        return _number(x)
    return mpmath.mpf(0) if x.is_finite() and abs(x) < _NOTHING else None


def _limit(x: mpmath.mpf) -> mpmath.mpf:
    """What a number becomes when the crank stops: 0 or infinite if it goes there with the speed."""
    if x == 0 or not mpmath.isfinite(x) or abs(mpmath.mag(x)) < _REST_MAGNITUDE:
        return x
    return mpmath.mpf(0) if mpmath.mag(x) < 0 else mpmath.sign(x) * mpmath.inf


def _split(name: str, parameters: tuple[str, ...]) -> tuple[str, tuple[int, ...]]:
    """``a_C_wrt_ec_AB`` -> ``a_C`` and the numbers of ec and AB."""
    quantity, _, tail = name.partition("_wrt_")
    return quantity, tuple(sorted(parameters.index(p) for p in tail.split("_"))) if tail else ()


def truth(
    name: str,
    *,
    theta: float,
    ec: float,
    AB: float,
    BC: float,
    omega0: float = 0.0,
    alpha: float = 0.0,
    omega: float | None = None,
    branch: int = 1,
    digits: int = 50,
) -> mpmath.mpf:
    """One quantity or sensitivity (``q``, ``q_wrt_p``, ``q_wrt_p_p``, ...) with so many correct digits."""
    law = omega is None
    quantity, monomial = _split(name, LAW if law else STATE)
    values = tuple(map(float, (theta, ec, AB, BC, omega0 if omega is None else omega, alpha)))
    still = _stands_still(values[0], *values[4:], law)
    for bits in _BITS[-1:] if still else _BITS:
        jet = _enclosures(values, law, branch, max(2, len(monomial)), bits)[quantity]
        with _precision(bits):
            result = _settled(jet.partial(monomial), digits)
        if result is not None:
            return _limit(result) if still else result
    return mpmath.mpf("nan")


def all_names(parameters: tuple[str, ...] = LAW) -> list[str]:
    """Every name that the library knows: the margin has no sensitivities, five quantities second ones."""
    first = [f"{q}_wrt_{p}" for q in QUANTITIES if q != "margin" for p in parameters]
    pairs = combinations_with_replacement(parameters, 2)
    return [*QUANTITIES, *first, *(f"{q}_wrt_{p}_{r}" for p, r in pairs for q in SECOND_ORDER)]


def truth_all(names: Iterable[str], **point: float) -> dict[str, mpmath.mpf]:
    """Many names at one point; the work is shared."""
    return {name: truth(name, **point) for name in names}


def conditions(name: str, gap: str = "margin", **point: float) -> float:
    """Sum of |x/f df/dx| over theta, AB, BC, omega0 (or omega), alpha and a gap, an input in place of ec.

    The gap is the margin in |ec| = BC - AB - margin, or another of ``GAPS``: what is exact may be small.
    """
    parameters = STATE if point.get("omega") is not None else LAW
    joint = "_" if "_wrt_" in name else "_wrt_"
    cranks, rods = (_sign(point["ec"]) * count for count in GAPS[gap])
    with mpmath.workdps(point.get("digits", 50)):
        f = truth(name, **point)
        slope = {p: truth(name + joint + p, **point) for p in parameters}
        slope["AB"] += cranks * slope["ec"]
        slope["BC"] += rods * slope["ec"]
        value = {p: mpmath.mpf(float(point.get(p, 0.0))) for p in parameters}
        value["ec"] -= cranks * value["AB"] + rods * value["BC"]
        steps = [abs(value[p] * slope[p]) for p in parameters if value[p] and slope[p]]
        return float(sum(steps) / abs(f)) if f else math.inf if steps else 0.0


def ulp_error(value: float, exact: mpmath.mpf) -> float:
    """|value - exact| in units of the last bit of a double at the exact value."""
    if mpmath.isfinite(exact) and math.isfinite(value):
        exponent = mpmath.mag(exact) - 1 if exact else -1022
        return float(mpmath.ldexp(abs(mpmath.mpf(value) - exact), 52 - max(exponent, -1022)))
    return 0.0 if value == exact or (math.isnan(value) and mpmath.isnan(exact)) else math.inf


def relative_error(value: float, exact: mpmath.mpf) -> float:
    """|value - exact| / |exact|; only zero is right where the truth is zero."""
    if exact and mpmath.isfinite(exact) and math.isfinite(value):
        return float(abs((mpmath.mpf(value) - exact) / exact))
    return math.inf if ulp_error(value, exact) else 0.0
