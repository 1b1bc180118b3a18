"""Recollection: exact algebra that equals the chain rule, and is refused where it would not."""

import mpmath
import pytest
import sympy as sp

from desaxe.derive import stable
from desaxe.derive.stable import chain_rule_form, recollected

POINTS = [
    {"theta": 1.1, "ec": 0.02, "AB": 0.125, "BC": 0.35},
    {"theta": -0.4, "ec": 0.3, "AB": 0.7, "BC": 0.5},
    {"theta": 4.0, "ec": -0.1, "AB": 0.2, "BC": 0.35},
]
ORDERS = (2, 3, 4)


def slope(order, theta, ec, AB, BC):
    return mpmath.diff(lambda t: mpmath.asin((ec + AB * mpmath.sin(t)) / BC), theta, order)


def names_at(theta, ec, AB, BC):
    """The values of the forms' symbols at a point."""
    sine, cosine = mpmath.sin(theta), mpmath.cos(theta)
    side = 1 if sine >= 0 else -1
    offset = ec + AB * sine
    inverse = 1 / mpmath.sqrt(BC * BC - offset * offset)
    margin, reach = BC - AB - side * ec, BC + AB + side * ec
    ratios = {
        "crank_ratio": AB * inverse,
        "ec_ratio": side * ec * inverse,
        "margin_ratio": margin * reach * inverse**2,
    }
    crank = {"sin_theta": sine, "cos_theta": cosine, "side": side, "abs_sin": abs(sine), "eps": 1 - abs(sine)}
    return ratios | crank | {"u": offset, "inv_S": inverse, "AB": AB}


@pytest.mark.parametrize("form", [chain_rule_form, recollected])
@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("at", POINTS)
def test_a_form_is_the_difference(form, order, at):
    with mpmath.workdps(60):
        exact = {name: mpmath.mpf(value) for name, value in at.items()}
        names = names_at(**exact)
        expression = form(order)
        symbols = sorted(expression.free_symbols, key=lambda s: s.name)
        value = sp.lambdify(symbols, expression, mpmath)(*(names[s.name] for s in symbols))
        assert abs(value / slope(order, **exact) - 1) < 1e-20


@pytest.mark.parametrize("order", ORDERS)
def test_the_recollected_form_has_no_textbook_names(order):
    names = {s.name for s in recollected(order).free_symbols}
    assert names <= {"crank_ratio", "ec_ratio", "margin_ratio", "eps", "abs_sin", "side", "cos_theta"}


@pytest.mark.parametrize("order", ORDERS)
def test_a_recollection_gone_wrong_is_refused(monkeypatch, order):
    """One factor counted double."""
    right = stable._factored
    monkeypatch.setattr(stable, "_factored", lambda part: 2 * right(part))
    with pytest.raises(ArithmeticError, match=f"of order {order} is not the chain rule's"):
        recollected.__wrapped__(order)


def test_a_lost_term_is_refused(monkeypatch):
    right = stable._by_eccentricity
    monkeypatch.setattr(stable, "_by_eccentricity", lambda c: right(c).subs(stable.ec_ratio, 0))
    with pytest.raises(ArithmeticError, match="not the chain rule's"):
        recollected.__wrapped__(2)


def test_a_form_with_one_term_more_is_refused():
    with pytest.raises(ArithmeticError, match="not the chain rule's"):
        stable._prove(2, recollected(2) + stable.eps)


def test_the_curvature_next_to_the_change_point_keeps_its_digits():
    """At the quarter, m > 0 is all that is left of it: -side crank_ratio margin_ratio."""
    at_quarter = recollected(2).subs({stable.eps: 0, stable.abs_sin: 1})
    assert sp.expand(at_quarter + stable.side * stable.crank_ratio * stable.margin_ratio) == 0


def test_a_height_gone_wrong_is_refused(monkeypatch):
    monkeypatch.setattr(stable, "HEIGHT_AREA", stable.less * stable.BC)
    with pytest.raises(ArithmeticError, match="the stable form of D is not D"):
        stable.prove_height()


def test_a_rod_summed_wrongly_is_refused(monkeypatch):
    near, (start, drop) = stable.LESS
    monkeypatch.setattr(stable, "LESS", (near, (start, -drop)))
    with pytest.raises(ArithmeticError, match=r"BC - \|u\|"):
        stable.prove_height()
