"""Forms of Y and its derivatives that keep their digits where crank and rod fold back: exact, or refused."""

import pytest

from desaxe.derive import folded
from desaxe.derive.stable import crank_drop, ec_out, margin_area


def test_there_is_a_form_for_every_rate():
    assert list(folded.slider_rates()) == [1, 2, 3]


def test_a_higher_derivative_stays_as_it_is():
    assert folded.slider_rate(4, ec_out) == ec_out


def test_a_wrong_area_is_refused(monkeypatch):
    monkeypatch.setattr(folded, "FOLDED_AREA", margin_area + 2 * ec_out * crank_drop)
    with pytest.raises(ArithmeticError, match="is not that difference"):
        folded.prove_folded()


@pytest.mark.parametrize("order", [1, 2, 3])
def test_a_wrong_rate_is_refused(monkeypatch, order):
    right = folded.phi_by_theta
    monkeypatch.setattr(folded, "LEVERS", ((folded.ec, 2 * folded.slider),))
    with pytest.raises(ArithmeticError, match="of order 1 through Y"):
        folded.slider_rates.__wrapped__()
    with pytest.raises(ArithmeticError, match=f"of order {order} through Y"):
        folded._prove_rate(order, right(order))
