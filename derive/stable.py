"""Variables in which nothing cancels, and recollection in them.

Next to the change point BC = AB + |ec| the textbook form D = BC^2 - u^2 loses every digit, and
its derivatives lose them even if D itself is exact: they are differences of large terms. Two
steps repair that, both exact algebra.

1. With sigma = sign(sin theta) ("side"), nu = sign(u) ("pin_side"), a = |sin theta| and
   eps = 1 - a = cos^2/(1 + a): BC - |u| = q + sigma nu AB eps, where q = BC - nu (ec + sigma AB) is an
   exact sum, the margin where both signs are those of ec. Away from the quarter (a < 1/2) BC - |u| is
   summed from BC - nu ec, which is exact there when |ec| is near BC. D = S^2 = (BC - |u|)(2 BC - (BC - |u|)),
   and q (2 BC - q) = m n, with m = BC - AB - sigma ec and n = BC + AB + sigma ec, whichever sign nu has.
2. The crank-angle derivatives of the rod angle are rational in these; their numerators, written as
   polynomials in m n, sigma ec and AB, have coefficients that factor into a and eps, and the terms
   that cancelled are gone. `recollected` does that, and proves its result against the chain rule.

Everything is divided by powers of S = sqrt(D), so that only ratios of lengths are multiplied.
Source: DESIGN section 5; paper A (5), (6), (10), (14); paper B (12), (18), (29).
"""

from functools import cache

import sympy as sp

from .loop import AB, BC, CRANK, ec, r, rod_partials, solved, theta, u

sin_theta, cos_theta, side, abs_sin, eps = sp.symbols("sin_theta cos_theta side abs_sin eps", real=True)
pin_side, AB_out, ec_out, margin_out = sp.symbols("pin_side AB_out ec_out margin_out", real=True)
u_straight, crank_drop, BC_less_ec, less, D = sp.symbols("u_straight crank_drop BC_less_ec less D", real=True)
less_from, less_by = sp.symbols("less_from less_by", real=True)
margin_area, offset_ratio = sp.symbols("margin_area offset_ratio", real=True)
crank_ratio, margin_ratio, ec_ratio = sp.symbols("crank_ratio margin_ratio ec_ratio", real=True)
tan_phi, sec_phi = sp.symbols("tan_phi sec_phi", real=True)

TRIGONOMETRY = {sp.sin(theta): sin_theta, sp.cos(theta): cos_theta}
CRANK_PIN = CRANK.subs(TRIGONOMETRY)
OFFSET = solved()[u].subs(TRIGONOMETRY)  # u, from the solved loop

# BC - |u| is less_from - less_by, next to the quarters and elsewhere; D and m n.
LESS = (margin_out, crank_drop), (BC_less_ec, pin_side * (AB * sin_theta))
HEIGHT_AREA = less * (2 * BC - less)
MARGIN_AREA = margin_out * (2 * BC - margin_out)

select, lt, le, eq = (sp.Function(name) for name in ("select", "lt", "le", "eq"))
atan2, absolute, copysign = sp.Function("atan2"), sp.Function("abs"), sp.Function("copysign")
two_sum_error, two_product_error = sp.Function("two_sum_error"), sp.Function("two_product_error")
rounding, extended_only = sp.Function("rounding"), sp.Function("extended_only")

# Where AB + |ec| is below this share of BC, no form cancels by much, and the plain ones will do: they err by
# a few tenths of what the promise allows.
WIDE_MARGIN_SHARE = sp.Float(0.875)
wide_margins = sp.Symbol("wide_margins", real=True)


def where_close(stable: sp.Expr, plain: sp.Expr) -> sp.Expr:
    """The stable form where margins may be close, the plain one with wide margins."""
    return select(wide_margins, plain, stable)


def wide_margin_test() -> sp.Expr:
    """The test for wide margins; it implies that all lengths are valid."""
    both = sp.Function("and")
    return both(both(lt(AB + absolute(ec), WIDE_MARGIN_SHARE * BC), le(0, AB)), lt(BC, sp.oo))


def assembled(ok: sp.Expr | int) -> sp.Expr:
    """The status of a point: `ok` where the mechanism can be assembled and has not stalled."""
    stalled = sp.Symbol("stalled", real=True)
    return select(lt(0, D), select(stalled, 3, ok), select(eq(D, 0), 2, 1))


def phi_by_theta(order: int) -> sp.Symbol:
    """The symbol of the `order`-th derivative of the rod angle with respect to the crank angle."""
    return sp.Symbol("phi" + "_wrt" * bool(order) + "_theta" * order, real=True)


def in_theta(expression: sp.Expr) -> sp.Expr:
    """d/dtheta at fixed lengths, by the chain rule on sin, cos, u, 1/S and the rod angle's derivatives."""
    rules = {
        sin_theta: cos_theta,
        cos_theta: -sin_theta,
        u: OFFSET.diff(sin_theta) * cos_theta,
        r: inverse_rate(u) * OFFSET.diff(sin_theta) * cos_theta,
        **{phi_by_theta(n): phi_by_theta(n + 1) for n in range(1, 4)},
    }
    return sp.Add(*(expression.diff(symbol) * rate for symbol, rate in rules.items()))


def inverse_rate(parameter: sp.Symbol) -> sp.Expr:
    """d(1/S)/d(parameter)."""
    return -(r**2) * rod_partials()["S", parameter]


@cache
def chain_rule_form(order: int) -> sp.Expr:
    """The textbook form of the `order`-th derivative of phi by theta, in sin, cos, u, 1/S, AB."""
    if order == 1:
        return rod_partials()["phi", u] * OFFSET.diff(sin_theta) * cos_theta
    return sp.expand(in_theta(chain_rule_form(order - 1)))


@cache
def recollected(order: int) -> sp.Expr:
    """The `order`-th derivative of phi in variables without cancellation: crank_ratio, |sin|, eps, ..."""
    polynomial = _numerator(order)
    common = cos_theta if order % 2 else side
    inner = sp.Poly(polynomial, margin_ratio)
    nested = sp.Integer(0)
    for coefficient in inner.all_coeffs():  # Horner in the margin
        nested = nested * margin_ratio + _by_eccentricity(coefficient)
    result = common * crank_ratio * nested
    _prove(order, result)
    return result


def phi_rate(order: int) -> sp.Expr:
    """The `order`-th derivative of phi by theta, in the form that keeps its digits.

    The recollected form from the third order on cancels where m n is large against S^2, which only a
    crank longer than its rod can have; the chain rule's own form does not cancel there.
    """
    if order == 1:
        return crank_ratio * cos_theta
    if order == 2:
        without_side = recollected(order).subs(ec_ratio, side * offset_ratio).subs(abs_sin, side * sin_theta)
        return where_close(sp.factor_terms(sp.expand(without_side).subs(side**2, 1)), chained(order))
    plain = _plain(order)
    return where_close(select(le(absolute(margin_ratio), 1), recollected(order), plain), chained(order))


def _plain(order: int) -> sp.Expr:
    """The chain rule's own form in ratios, by powers of the crank's."""
    in_ratios = (
        chain_rule_form(order).subs({u: tan_phi / r, sin_theta: side * abs_sin}).subs(AB, crank_ratio / r)
    )
    return sp.collect(sp.expand(in_ratios), crank_ratio, sp.factor).subs(side * abs_sin, sin_theta)


@cache
def chained(order: int) -> sp.Expr:
    """The `order`-th derivative of phi in those of lower orders, the shortest form; proved like the others.

    With k = AB/S and t = tan(phi): phi'' = phi'^2 t - k sin(theta), and t' = (1 + t^2) phi', k' = k t phi'.
    """
    first, second, third = (phi_by_theta(n) for n in (1, 2, 3))
    lift = first**2 * tan_phi - second  # k sin(theta)
    rates = {first: second, second: third, tan_phi: (1 + tan_phi**2) * first}
    if order == 2:
        result = first**2 * tan_phi - crank_ratio * sin_theta
    elif order == 3:
        result = sp.factor(_rate(first**2 * tan_phi, rates) - (lift * tan_phi * first + first))
    else:
        result = sp.factor_terms(_rate(chained(order - 1), rates))
    known = {phi_by_theta(n): chain_rule_form(n) for n in range(1, order)}
    known |= {tan_phi: u * r, crank_ratio: AB * r}
    if sp.expand(result.subs(known) - chain_rule_form(order)) != 0:
        raise ArithmeticError(f"the chained derivative of phi of order {order} is not the chain rule's")
    return result


def _rate(expression: sp.Expr, rates: dict[sp.Symbol, sp.Expr]) -> sp.Expr:
    return sp.Add(*(expression.diff(symbol) * rate for symbol, rate in rates.items()))


def _numerator(order: int) -> sp.Expr:
    """The numerator over S^(2 order - 1), divided by AB and by cos (odd) or side (even)."""
    squared = margin_ratio + 2 * (crank_ratio + ec_ratio) * crank_ratio * eps - (crank_ratio * eps) ** 2
    across = side * (ec_ratio + crank_ratio * (1 - eps))
    textbook = sp.expand(chain_rule_form(order) / r ** (2 * order - 1))
    in_ratios = textbook.subs(
        {r: 1 / sp.sqrt(squared), u: across, AB: crank_ratio, sin_theta: side * (1 - eps)}
    )
    divided = sp.expand(in_ratios / (crank_ratio * (cos_theta if order % 2 else side)))
    even = sp.expand(divided.subs(cos_theta, sp.sqrt(eps * (2 - eps))))
    return sp.expand(even.replace(lambda x: x.is_Pow and x.base == side, lambda x: side ** (x.exp % 2)))


def _by_eccentricity(coefficient: sp.Expr) -> sp.Expr:
    """A coefficient of the margin, Horner in ec_ratio, each part factored into |sin| and eps."""
    nested = sp.Integer(0)
    for part in sp.Poly(coefficient, ec_ratio).all_coeffs():
        nested = nested * ec_ratio + _factored(part)
    return nested


def _factored(part: sp.Expr) -> sp.Expr:
    """The factors of a polynomial in eps; 1 - eps is written |sin|."""
    constant, factors = sp.factor_list(part, eps, crank_ratio)
    result = sp.Mul(constant)
    for factor, power in factors:
        if sp.expand(factor - (eps - 1)) == 0:
            result *= (-abs_sin) ** power
        elif sp.expand(factor - (eps - 2)) == 0:
            result *= (-(1 + abs_sin)) ** power
        else:
            result *= sp.horner(factor, eps) ** power
    return result


def _prove(order: int, result: sp.Expr) -> None:
    """Prove that the recollected form equals the chain rule's, as polynomials; ArithmeticError if not."""
    textbook = _numerator(order) * crank_ratio * (cos_theta if order % 2 else side)
    if sp.expand(result.subs(abs_sin, 1 - eps) - textbook) != 0:
        raise ArithmeticError(f"the recollected derivative of phi of order {order} is not the chain rule's")


def written_out(expression: sp.Expr) -> sp.Expr:
    """An expression of lengths in AB, BC, ec, eps and the signs sigma and nu, expanded."""
    definitions = {
        less: margin_out - crank_drop,
        margin_area: MARGIN_AREA,
        margin_out: BC - AB_out - ec_out,
        BC_less_ec: BC - ec_out,
        crank_drop: -AB_out * eps,
        AB_out: side * pin_side * AB,
        ec_out: pin_side * ec,
        u: OFFSET,
        sin_theta: side * (1 - eps),
    }
    for name, value in definitions.items():
        expression = expression.subs(name, value)
    plain = sp.Poly(sp.expand(expression), side, pin_side)
    for square in (side**2 - 1, pin_side**2 - 1):
        plain = plain.rem(sp.Poly(square, side, pin_side))
    return sp.expand(plain.as_expr())


def prove_height() -> None:
    """Prove the stable forms of BC - |u|, D and m n; ArithmeticError if one is wrong."""
    zeros = {
        "BC - |u|": (LESS[0][0] - LESS[0][1]) - (LESS[1][0] - LESS[1][1]),
        "D": HEIGHT_AREA - (BC**2 - u**2),
        "m n": MARGIN_AREA - (BC**2 - (AB + side * ec) ** 2),
    }
    for name, difference in zeros.items():
        if written_out(difference) != 0:
            raise ArithmeticError(f"the stable form of {name} is not {name}")
