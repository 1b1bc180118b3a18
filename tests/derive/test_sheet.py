"""The equation sheet: the chain rule between names gives what SymPy gives for the whole expression."""

import pytest
import sympy as sp

from desaxe.derive.sheet import Equation, Sheet, symbol
from desaxe.mechanism.names import PARAMETERS, sensitivity
from desaxe.units.dimensions import LENGTH, Unit

theta, ec, AB = map(symbol, ("theta", "ec", "AB"))
a, b, c = map(symbol, "abc")


def toy():
    sheet = Sheet(())
    sheet.define("a", ec + AB * sp.sin(theta), unit=LENGTH, meaning="a length")
    sheet.define("b", sp.sqrt(AB**2 - a**2))
    sheet.define("c", a * b + sp.cos(theta) / b)
    return sheet


def expanded(sheet, expression):
    """The expression in the parameters alone."""
    for name in reversed(sheet.ordered(tuple(s.name for s in expression.free_symbols))):
        expression = expression.subs(symbol(name), sheet.equations[name].expression)
    return expression


def equal(left, right):
    at = {theta: sp.Rational(7, 10), ec: sp.Rational(1, 5), AB: 3}
    return abs((left - right).subs(at).evalf(40)) < 1e-30


@pytest.mark.parametrize("name", "abc")
@pytest.mark.parametrize("parameter", ["theta", "ec", "AB"])
def test_the_chain_rule(name, parameter):
    sheet = toy()
    whole = expanded(sheet, symbol(name)).diff(symbol(parameter))
    assert equal(expanded(sheet, sheet.derivative(name, parameter)), whole)


@pytest.mark.parametrize("pair", [("theta", "theta"), ("ec", "theta"), ("theta", "AB")])
def test_the_chain_rule_twice(pair):
    sheet = toy()
    sheet.derivative("c", pair[0])
    second = sheet.derivative(sensitivity("c", pair[0]), pair[1])
    assert equal(expanded(sheet, second), expanded(sheet, c).diff(*map(symbol, pair)))


def test_a_derivative_is_in_the_derivatives_of_its_names():
    sheet = toy()
    sheet.derivative("c", "AB")
    names = {s.name for s in sheet.equations["c_wrt_AB"].expression.free_symbols}
    assert {"a_wrt_AB", "b_wrt_AB"} <= names


def test_a_root_is_shared_by_its_derivative():
    sheet = toy()
    sheet.derivative("b", "theta")
    assert sheet.equations["b_wrt_theta"].expression == -a * symbol("a_wrt_theta") / b


def test_a_derivative_is_made_once():
    sheet = toy()
    assert sheet.derivative("c", "ec") is sheet.derivative("c", "ec")


def test_the_derivative_of_a_parameter_is_one_or_nothing():
    assert [toy().derivative("ec", p) for p in ("ec", "AB")] == [1, 0]


def test_what_does_not_change_has_derivative_0():
    assert toy().derivative("a", "BC") == 0


def test_a_rigid_name_has_derivative_0():
    sheet = toy()
    sheet.define("sign", sp.sign(a), rigid=True)
    sheet.define("size", symbol("sign") * a)
    assert sheet.derivative("sign", "ec") == 0
    assert equal(expanded(sheet, sheet.derivative("size", "ec")), 1)


def test_another_expression_can_be_differentiated():
    sheet = toy()
    sheet.define("angle", sp.Function("atan2")(a, b), differentiate=-a)
    assert sheet.derivative("angle", "AB") == symbol("angle_wrt_AB")
    assert equal(expanded(sheet, symbol("angle_wrt_AB")), -sp.sin(theta))


def test_a_derivative_has_its_unit_and_meaning():
    sheet = toy()
    sheet.derivative("a", "theta")
    made = sheet.equations["a_wrt_theta"]
    assert (made.unit, made.meaning) == (Unit(1, 0, -1), "derivative of a with respect to theta")


def test_a_resolver_makes_what_is_asked_for():
    sheet = Sheet((lambda sheet, name: Equation(2 * ec) if name == "twice" else None,))
    assert sheet.equation("twice").expression == 2 * ec
    assert sheet.equation("thrice") is None


def test_a_name_is_defined_once():
    with pytest.raises(ValueError, match="a is defined twice"):
        toy().define("a", ec)


def test_every_name_comes_after_what_it_uses():
    assert toy().ordered(("c",)) == ["a", "b", "c"]


def test_only_what_is_needed_is_ordered():
    assert toy().ordered(("b",)) == ["a", "b"]


@pytest.mark.parametrize(
    ("name", "parameter", "new"),
    [
        ("Y", "ec", "Y_wrt_ec"),
        ("Y_wrt_AB", "theta", "Y_wrt_theta_AB"),
        ("V_C_wrt_alpha", "alpha", "V_C_wrt_alpha_alpha"),
    ],
)
def test_the_parameters_of_a_derivative_stand_in_one_order(name, parameter, new):
    assert sensitivity(name, parameter) == new


def test_the_order_of_the_parameters():
    assert PARAMETERS == ("theta", "ec", "AB", "BC", "omega0", "alpha")


def test_a_line_says_what_it_is_where_it_has_a_unit():
    sheet = toy()
    assert sheet.equations["a"].note == ("m", "a length", "")
    assert sheet.equations["b"].note is None
