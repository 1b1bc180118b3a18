"""The stable form as SymPy: the textbook form's values, at points on every side of its tests, to 30 digits.

Both are algebraic in the sines, cosines and roots of the parameters, so that forms that agree at random
points on each side of the tests, to many digits, are the same.
"""

import mpmath
import pytest
import sympy as sp

import desaxe as dx
from desaxe.derive.stable_text import stable_form

PARAMETERS = ("theta", "ec", "AB", "BC", "omega0", "alpha", "branch")
POINTS = (
    (0.71, -0.031, 0.127, 0.353, 12.3, 5.1, 1),
    (2.05, 0.113, 0.127, 0.353, -12.3, 0.7, -1),
    (-1.45, 0.017, 0.211, 0.239, 3.7, -0.3, 1),  # the pin on the other side, near its quarter
    (3.05, 0.0013, 0.2, 0.203, 3.7, 0.0, 1),  # folded over: Y is small
    (0.05, -0.3, 0.9, 0.35, 3.7, 0.2, -1),  # a long crank
)
NAMES = (
    "Y", "phi", "s", "V_C", "a_C", "j_C", "omega_BC", "alpha_BC", "omega", "transmission_angle", "a_B",
    "margin", "V_C_wrt_theta", "a_C_wrt_ec", "V_C_wrt_AB_BC", "omega_BC_wrt_omega0",
)  # fmt: skip


def values(expression):
    symbols = [sp.Symbol(name, real=True) for name in PARAMETERS]
    function = sp.lambdify(symbols, expression, "mpmath")
    with mpmath.workdps(50):
        return [function(*(mpmath.mpf(str(value)) for value in point)) for point in POINTS]


@pytest.mark.parametrize("name", NAMES)
def test_it_is_the_textbook_form(name):
    stable, textbook = (values(dx.equation(name, form=form).expression) for form in ("stable", "textbook"))
    for one, other in zip(stable, textbook, strict=True):
        assert mpmath.almosteq(one, other, 1e-30), name


def test_steps_lead_to_the_expression():
    """Each step uses parameters and earlier steps; put together, they are the expression."""
    form = stable_form("a_C_wrt_ec")
    seen = {sp.Symbol(name, real=True) for name in PARAMETERS}
    known = {}
    for name, expression in form.definitions.items():
        assert expression.free_symbols <= seen
        seen.add(sp.Symbol(name, real=True))
        known[sp.Symbol(name, real=True)] = expression
    whole = sp.Symbol("a_C_wrt_ec", real=True)
    for symbol in reversed(known):
        whole = whole.subs(symbol, known[symbol])
    for one, other in zip(values(whole), values(form.expression), strict=True):
        assert mpmath.almosteq(one, other, 1e-30)


def test_text():
    result = dx.equation("V_C", form="stable")
    assert result.latex.startswith("\\begin{aligned}\ns_{\\theta} &= \\sin")
    assert result.latex.endswith("V_{C} &= \\frac{\\partial Y}{\\partial \\theta} \\omega\n\\end{aligned}")
    assert result.steps == dx.equation("V_C").steps
    with pytest.raises(ValueError, match="form = 'exact': it is one of textbook, stable"):
        dx.equation("V_C", form="exact")
