"""Closed forms: the same numbers as the stable program, for every quantity and first sensitivity."""

import random
import re

import mpmath
import pytest
import sympy as sp

import desaxe as dx
from desaxe.derive.dynamics import FORCES
from desaxe.derive.quantities import QUANTITIES

LINKS = {"m_crank": 1.2, "m_rod": 0.7, "m_slider": 0.9, "I_crank": 0.002, "I_rod": 0.01}
LOADS = {"r_crank": 0.05, "r_rod": 0.2, "F_X": 20.0, "F_Y": -90.0, "g_X": 3.0, "g_Y": -9.0, "mu": 0.15}
POINT = {"theta": 0.7, "ec": -0.03, "AB": 0.125, "BC": 0.35, "omega0": 12.0, "alpha": 5.0, **LINKS, **LOADS}
FIRST = [name for name in dx.quantities() if name.partition("_wrt_")[2] in POINT]


def number(expression, point=POINT):
    """Returns its value at 40 digits."""
    names = sorted(expression.free_symbols, key=str)
    function = sp.lambdify(names, expression.doit(), "mpmath", cse=True)
    known = {**point, "branch": 1}
    with mpmath.workdps(40):
        return function(*(mpmath.mpf(known[one.name]) for one in names))


def in_each_run(name):
    """Closed forms of forces are long: a thorough run has them all."""
    is_long = name in FORCES and name not in ("T_in", "N_C")
    return pytest.param(name, marks=pytest.mark.thorough) if is_long else name


@pytest.mark.parametrize("name", [in_each_run(name) for name in (*QUANTITIES, "margin", "status")])
def test_closed_forms(name):
    assert float(number(dx.equation(name).expression)) == pytest.approx(dx.evaluate(name, **POINT), rel=1e-13)


@pytest.mark.thorough
def test_derivatives_of_closed_forms():
    for name in random.Random(5).sample(FIRST, 12):
        assert float(number(dx.equation(name).expression)) == pytest.approx(
            dx.evaluate(name, **POINT), rel=1e-12
        ), name


@pytest.mark.parametrize(
    "name", ["V_C", "j_C", "omega_BC_wrt_ec", "V_C_wrt_theta", "V_C_wrt_omega0", "omega", "F_friction"]
)
def test_turning_backwards(name):
    back = {**POINT, "omega0": -12.0}
    assert float(number(dx.equation(name).expression, back)) == pytest.approx(
        dx.evaluate(name, **back), rel=1e-12
    )


def test_text():
    result = dx.equation("V_C_wrt_ec")
    assert result.latex.startswith(r"\frac{\partial V_{C}}{\partial e_c} = ")
    assert result.unit == "1/s"
    assert result.steps[-1].startswith("V_C_wrt_ec = ")
    assert result._repr_latex_().startswith("$")
    assert r"\overline{BC}^{2}" in result.latex
    assert not re.search(r"[A-Z]{2}\^", result.latex)  # AB^2 would be the square of B alone
    assert dx.equation("a_C").source == "A (19)"
    assert repr(result).startswith("V_C_wrt_ec [1/s], derivative of V_C with respect to ec\nV_C_wrt_ec = ")


def test_unknown():
    with pytest.raises(ValueError, match="did you mean a_C"):
        dx.equation("a_c")
