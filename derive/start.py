"""Derivatives of the accelerations by alpha near theta = 0, where under the law alpha has hardly any effect.

d(alpha_BC)/d(alpha) = phi' + 2 theta phi''. Where |ec| is nearly BC, both terms grow like 1/sqrt(theta) and
cancel but for a share theta of them. From S^2 = L W with L = BC - |u|, W = BC + |u|, and d = BC - nu ec,

    phi' + 2 theta phi'' = (AB/S) (c (W/S) (d/S - nu (AB/S) h) - 2 theta s - nu theta (AB/S) c^2 (L/S))

where h = s - theta c = theta^3/3 - theta^5/30 + ...: d is exact, and what cancelled is gone. From it follows
d(a_C)/d(alpha), because Y'' = -AB c - branch (u phi'' + AB c phi').
"""

import sympy as sp

from desaxe.mechanism.names import per
from desaxe.units.dimensions import LENGTH, NONE

from .loop import AB, BC, branch, ec, r, theta, u
from .sheet import Sheet, symbol
from .stable import (
    BC_less_ec,
    absolute,
    chain_rule_form,
    cos_theta,
    crank_ratio,
    extended_only,
    in_theta,
    less,
    lt,
    phi_by_theta,
    pin_side,
    select,
    sin_theta,
)

NEAR = sp.Float(2.0**-20)  # beyond, two words lose less than half of their digits
near_start, sine_excess, rod_start = map(symbol, ("near_start", "sine_excess", "rod_start"))

IS_NEAR = extended_only(lt(absolute(theta), NEAR))
SINE_EXCESS = theta**3 * (sp.Rational(1, 3) - theta**2 / 30)
ROD_START = crank_ratio * (
    cos_theta * (2 * BC - less) * r * (BC_less_ec * r - pin_side * crank_ratio * sine_excess)
    - 2 * theta * sin_theta
    - theta * pin_side * crank_ratio * cos_theta**2 * (less * r)
)
SLIDER_START = -AB * (sin_theta + 2 * theta * cos_theta) - branch * (
    u * rod_start + 2 * theta * AB * cos_theta * phi_by_theta(1)
)


def prove_start() -> None:
    """The forms are phi' + 2 theta phi'' and Y' + 2 theta Y'', or the derivation stops."""
    rates = {phi_by_theta(n): chain_rule_form(n) for n in (1, 2)}
    rod = phi_by_theta(1) + 2 * theta * phi_by_theta(2)
    height = AB * cos_theta + branch / r
    turning = in_theta(height) + 2 * theta * in_theta(in_theta(height))
    excess = {sine_excess: sin_theta - theta * cos_theta}
    _prove(ROD_START.subs(excess) - rod.subs(rates))
    _prove(SLIDER_START.subs(rod_start, rod).subs(rates) - turning)
    rest = sp.series(sp.sin(theta) - theta * sp.cos(theta), theta, 0, 7).removeO() - SINE_EXCESS
    if sp.expand(rest) != 0:
        raise ArithmeticError("h is not sin(theta) - theta cos(theta)")


def _prove(difference: sp.Expr) -> None:
    """Prove that a difference is 0, with all lengths expanded; ArithmeticError if not."""
    known = {crank_ratio: AB * r, less: BC - pin_side * u, BC_less_ec: BC - pin_side * ec}
    S = symbol("S")
    written = difference.subs(known).subs(ec, u - AB * sin_theta).subs(r, 1 / S)
    plain = sp.Poly(sp.expand(written * S**4), BC, cos_theta, pin_side, branch)
    for relation in (BC**2 - u**2 - S**2, cos_theta**2 + sin_theta**2 - 1, pin_side**2 - 1, branch**2 - 1):
        plain = plain.rem(sp.Poly(relation, BC, cos_theta, pin_side, branch))
    if not plain.is_zero:
        raise ArithmeticError("what alpha does to the accelerations at the start is not the chain rule's")


def define_start(sheet: Sheet) -> None:
    """alpha_BC and a_C differentiated by alpha; other derivatives of them are the chain rule's."""
    prove_start()
    sheet.define("near_start", IS_NEAR)
    sheet.define("sine_excess", SINE_EXCESS, NONE, "sin(theta) - theta cos(theta) near 0")
    sheet.define("rod_start", ROD_START, NONE, "alpha_BC_wrt_alpha, where the crank has just started")
    sheet.define("slider_start", SLIDER_START, LENGTH, "a_C_wrt_alpha, where the crank has just started")
    for name, start in (("alpha_BC", rod_start), ("a_C", symbol("slider_start"))):
        plain, unit = sheet.chain_rule(name, "alpha"), sheet.equations[name].unit
        assert unit is not None
        sheet.define(f"{name}_wrt_alpha", select(near_start, start, plain), per(unit, "alpha"),
                     f"derivative of {name} with respect to alpha", differentiate=plain)  # fmt: skip
