"""The slider's position and its derivatives where crank and rod fold back onto each other.

Where they are nearly of one length and the eccentricity is small, Y = AB cos(theta) + branch S is a small
difference of large terms on the way back, and so are its derivatives. From the stable variables,

    S^2 - (AB cos)^2 = m n + 2 AB sigma ec eps,      Y = (S^2 - (AB cos)^2)/(branch S - AB cos),

which keeps every digit there; and Y itself, with the derivatives of phi, gives its derivatives:
Y' = -branch (AB/S)(ec cos + Y sin) where Y is the small one, -branch (AB/S)(u cos + branch S sin) where u may
be, and Y'' = -branch (phi' Y + u phi''), which cancels nowhere that other forms do not.

With wide margins nothing cancels by much, and the shortest form will do. With the crank pin at
(X, Z) = AB (cos, sin) and the area A = X u, whose derivative is A' = X^2 - Z u: m = A/S is -dS/dtheta,
m' = (A' + m^2)/S, m'' = (3 m m' - X (3 Z + u))/S, and

    Y' = -(Z + branch m),      Y'' = -(X + branch m'),      Y''' = Z - branch m''.
"""

from functools import cache

import sympy as sp

from .loop import AB, BC, branch, ec, r, slider, u
from .stable import (
    chain_rule_form,
    cos_theta,
    crank_drop,
    crank_ratio,
    ec_out,
    eps,
    in_theta,
    margin_area,
    phi_by_theta,
    sin_theta,
    where_close,
    written_out,
)

folded, folded_area = sp.symbols("folded folded_area", real=True)
lever_X, lever_Y = sp.symbols("lever_X lever_Y", real=True)

FOLDED_AREA = margin_area - 2 * ec_out * crank_drop
LEVERS = (ec, slider), (u, branch / r)  # where folded, elsewhere

pin_along, pin_across = sp.symbols("pin_along pin_across", real=True)
pin_area, pin_area_rate = sp.symbols("pin_area pin_area_rate", real=True)
height_drop, height_drop_rate = sp.symbols("height_drop height_drop_rate", real=True)
WIDE_MARGIN_FORMS = {
    pin_along: AB * cos_theta,
    pin_across: AB * sin_theta,
    pin_area: pin_along * u,
    pin_area_rate: pin_along**2 - pin_across * u,
    height_drop: pin_area * r,
    height_drop_rate: (pin_area_rate + height_drop**2) * r,
}
WIDE_MARGIN_RATES = {
    1: -(pin_across + branch * height_drop),
    2: -(pin_along + branch * height_drop_rate),
    3: pin_across - branch * ((3 * height_drop * height_drop_rate - pin_along * (3 * pin_across + u)) * r),
}


def slider_rate(order: int, straight: sp.Expr) -> sp.Expr:
    """The `order`-th derivative of Y by theta; `straight` is that of AB cos + branch S."""
    if order not in slider_rates():
        return straight
    return where_close(slider_rates()[order], WIDE_MARGIN_RATES[order])


@cache
def slider_rates() -> dict[int, sp.Expr]:
    """Derivatives of Y by theta in Y and the derivatives of phi, proved against the chain rule."""
    first, second, third = (phi_by_theta(n) for n in (1, 2, 3))
    rate = sp.Symbol("Y_wrt_theta", real=True)
    rates = {
        1: -branch * crank_ratio * (lever_X * cos_theta + lever_Y * sin_theta),
        2: -branch * (first * slider + u * second),
        3: -branch * (second * (slider + AB * cos_theta) + first * rate + u * third),
    }
    textbook = AB * cos_theta + branch / r
    for order, form in rates.items():
        textbook = in_theta(textbook)
        for levers in LEVERS:
            by_levers = form.subs(rate, rates[1]).subs(dict(zip((lever_X, lever_Y), levers, strict=True)))
            _prove_rate(order, by_levers - textbook)
        shortest = WIDE_MARGIN_RATES[order]
        for name, value in reversed(WIDE_MARGIN_FORMS.items()):
            shortest = shortest.subs(name, value)
        _prove_rate(order, shortest - textbook)
    return rates


def _prove_rate(order: int, difference: sp.Expr) -> None:
    """Prove that a difference is 0 with Y, ec and the derivatives of phi expanded; else ArithmeticError."""
    known = {slider: AB * cos_theta + branch / r, ec: u - AB * sin_theta, crank_ratio: AB * r}
    known |= {phi_by_theta(n): chain_rule_form(n) for n in (1, 2, 3)}
    plain = sp.Poly(sp.expand(difference.subs(known)), cos_theta, branch)
    for relation in (cos_theta**2 + sin_theta**2 - 1, branch**2 - 1):
        plain = plain.rem(sp.Poly(relation, cos_theta, branch))
    if not plain.is_zero:
        raise ArithmeticError(f"the derivative of Y of order {order} through Y is not the chain rule's")


def prove_folded() -> None:
    """The area is S^2 - (AB cos)^2, or the derivation stops; cos^2 is eps (2 - eps)."""
    if written_out(FOLDED_AREA - (BC**2 - u**2 - AB**2 * eps * (2 - eps))) != 0:
        raise ArithmeticError("the stable form of S^2 - (AB cos)^2 is not that difference")
