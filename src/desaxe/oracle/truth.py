"""Reference values at one point of the offset slider-crank, to any number of digits.

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
from collections.abc import Callable, Iterable
from fractions import Fraction
from functools import lru_cache
from itertools import combinations_with_replacement
from typing import Any

import mpmath
from flint import arb, arb_series

from .jet import BITS, REST, Jet, limit, precision, settled, sign

LAW = ("theta", "ec", "AB", "BC", "omega0", "alpha")
STATE = ("theta", "ec", "AB", "BC", "omega", "alpha")

QUANTITIES = (
    *("phi", "delta", "Y", "s", "V_C", "a_C", "j_C", "omega", "omega_BC", "alpha_BC"),
    *("V_B_X", "V_B_Y", "V_B", "a_B_X", "a_B_Y", "a_B"),
    *("transmission_angle", "pressure_angle", "margin"),
)
GAPS = {"margin": (-1, 1), "rod": (0, 1), "crank": (1, 0), "ec": (0, 0)}  # |ec| = a AB + b BC -+ gap
SECOND_ORDER = ("Y", "V_C", "a_C", "omega_BC", "alpha_BC")


def _speed(theta: Jet, omega: Jet, alpha: Jet, law: bool) -> Jet:
    """The crank's speed: as given, or sign(omega0) sqrt(omega0^2 + 2 alpha theta)."""
    if not law:
        return omega
    return (omega * omega + (alpha * theta).times(2)).sqrt().times(sign(omega.terms[()][0]))


def turning(theta: Jet, omega: Jet, alpha: Jet, law: bool) -> Jet:
    """The crank's angle as a function of time."""
    return theta + _speed(theta, omega, alpha, law).after(1) + alpha.after(2)


def loop(theta: Jet, ec: Jet, AB: Jet, BC: Jet, branch: int) -> tuple[Jet, ...]:
    """Solve the loop: sin and cos of theta; the rod, across from C to B and rising from B to C."""
    sine, cosine = theta.sin_cos()
    across = ec + AB * sine
    return sine, cosine, across, (BC * BC - across * across).sqrt().times(branch)


def _closure(parameters: list[Jet], branch: int, law: bool) -> tuple[Jet, ...]:
    """theta, B, Y, phi and delta as functions of time."""
    theta, ec, AB, BC, omega, alpha = parameters
    theta = turning(theta, omega, alpha, law)
    sine, cosine, across, rise = loop(theta, ec, AB, BC, branch)
    ratio = across * BC.inverse()
    phi, delta = ratio.arc(ratio.terms[()].asin(), 1), ratio.arc(ratio.terms[()].acos(), -1)
    return theta, AB * sine, AB * cosine, AB * cosine + rise, phi, delta


def _quantities(parameters: list[Jet], branch: int, law: bool) -> dict[str, Jet]:
    """Every quantity by name."""
    _, ec, AB, BC, _, _ = parameters
    theta, B_X, B_Y, Y, phi, delta = _closure(parameters, branch, law)
    V_X, V_Y, a_X, a_Y = B_X.rate(1), B_Y.rate(1), B_X.rate(2), B_Y.rate(2)
    outer, pressure = ((AB + BC) * (AB + BC) - ec * ec).sqrt(), phi.times(sign(phi.terms[()][0]))
    quarter = Jet({(): arb_series([arb.pi() / 2])}, phi.order)
    return {
        **{"phi": phi, "delta": delta, "Y": Y, "s": outer - Y.times(branch)},
        **{"V_B_X": V_X, "V_B_Y": V_Y, "V_B": (V_X * V_X + V_Y * V_Y).sqrt()},
        **{"a_B_X": a_X, "a_B_Y": a_Y, "a_B": (a_X * a_X + a_Y * a_Y).sqrt()},
        **{"omega": theta.rate(1), "omega_BC": phi.rate(1), "alpha_BC": phi.rate(2)},
        **{"V_C": Y.rate(1), "a_C": Y.rate(2), "j_C": Y.rate(3)},
        **{"transmission_angle": quarter - pressure, "pressure_angle": pressure},
        "margin": BC - AB - ec.times(sign(ec.terms[()][0])),
    }


@lru_cache(maxsize=16)
def stands_still(theta: float, speed: float, alpha: float, law: bool) -> bool:
    """True if the crank's speed is exactly 0."""
    start = Fraction(speed)
    return start * start + 2 * Fraction(alpha) * Fraction(theta) == 0 if law else start == 0


@lru_cache(maxsize=16)
def _enclosures(values: tuple[float, ...], law: bool, branch: int, order: int, bits: int) -> dict[str, Jet]:
    """Enclosures of all quantities and partial derivatives at one point."""
    theta, *_, speed, alpha = values
    with precision(bits):
        exact = [arb(value) for value in values]
        if stands_still(theta, speed, alpha, law):
            exact[4] += sign(speed) * REST
        terms = [{(): arb_series([x]), (number,): arb_series([1])} for number, x in enumerate(exact)]
        return _quantities([Jet(parameter, order) for parameter in terms], branch, law)


def split(name: str, parameters: tuple[str, ...]) -> tuple[str, tuple[int, ...]]:
    """``a_C_wrt_ec_AB`` -> ``a_C`` and the numbers of ec and AB; of two parameters the longer name counts."""
    quantity, _, tail = name.partition("_wrt_")
    numbers = []
    while tail:
        first = max((p for p in parameters if f"{tail}_".startswith(f"{p}_")), key=len)
        numbers.append(parameters.index(first))
        tail = tail[len(first) + 1 :]
    return quantity, tuple(sorted(numbers))


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
    """One quantity or sensitivity (``q``, ``q_wrt_p``, ``q_wrt_p_p``, ...) to `digits` correct digits."""
    law = omega is None
    quantity, monomial = split(name, LAW if law else STATE)
    values = tuple(map(float, (theta, ec, AB, BC, omega0 if omega is None else omega, alpha)))
    still = stands_still(values[0], *values[4:], law)
    for bits in BITS[-1:] if still else BITS:
        jet = _enclosures(values, law, branch, max(2, len(monomial)), bits)[quantity]
        with precision(bits):
            result = settled(jet.partial(monomial), digits)
        if result is not None:
            return limit(result) if still else result
    return mpmath.mpf("nan")


def all_names(parameters: tuple[str, ...] = LAW) -> list[str]:
    """Every name that the library knows: the margin has no sensitivities, five quantities second ones."""
    first = [f"{q}_wrt_{p}" for q in QUANTITIES if q != "margin" for p in parameters]
    pairs = combinations_with_replacement(parameters, 2)
    return [*QUANTITIES, *first, *(f"{q}_wrt_{p}_{r}" for p, r in pairs for q in SECOND_ORDER)]


def truth_all(names: Iterable[str], **point: Any) -> dict[str, mpmath.mpf]:
    """Many names at one point; the work is shared."""
    return {name: truth(name, **point) for name in names}


def conditions(
    name: str,
    gap: str = "margin",
    others: tuple[str, ...] = (),
    oracle: Callable[..., mpmath.mpf] = truth,
    **point: Any,
) -> float:
    """Sum of |x/f df/dx| over theta, AB, BC, omega0 (or omega), alpha and a gap, which replaces ec.

    The gap is the margin in |ec| = BC - AB - margin, or another of ``GAPS``: what is exact may be small.
    An oracle with more inputs may count others of them too.
    """
    parameters = (*(STATE if point.get("omega") is not None else LAW), *others)
    joint = "_" if "_wrt_" in name else "_wrt_"
    cranks, rods = (sign(point["ec"]) * count for count in GAPS[gap])
    with mpmath.workdps(point.get("digits", 50)):
        f = oracle(name, **point)
        slope = {p: oracle(name + joint + p, **point) for p in parameters}
        slope["AB"] += cranks * slope["ec"]
        slope["BC"] += rods * slope["ec"]
        value = {p: mpmath.mpf(float(point.get(p, 0.0))) for p in parameters}
        value["ec"] -= cranks * value["AB"] + rods * value["BC"]
        steps = [abs(value[p] * slope[p]) for p in parameters if value[p] and slope[p]]
        return float(sum(steps) / abs(f)) if f else math.inf if steps else 0.0


def ulp_error(value: float, exact: mpmath.mpf) -> float:
    """|value - exact| in ulp of the exact value."""
    if mpmath.isfinite(exact) and math.isfinite(value):
        exponent = mpmath.mag(exact) - 1 if exact else -1022
        return float(mpmath.ldexp(abs(mpmath.mpf(value) - exact), 52 - max(exponent, -1022)))
    return 0.0 if value == exact or (math.isnan(value) and mpmath.isnan(exact)) else math.inf


def relative_error(value: float, exact: mpmath.mpf) -> float:
    """|value - exact| / |exact|; infinite for any error of an exact 0."""
    if exact and mpmath.isfinite(exact) and math.isfinite(value):
        return float(abs((mpmath.mpf(value) - exact) / exact))
    return math.inf if ulp_error(value, exact) else 0.0
