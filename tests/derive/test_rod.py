"""The rod's functions: every partial derivative, followed along the crank, is its independent difference."""

from functools import cache

import mpmath
import pytest
import sympy as sp

from desaxe.derive.quantities import build_sheet
from desaxe.derive.rod import RodFunction, read_rod_function, resolve_rod
from desaxe.units.dimensions import Unit

DIGITS = 60
AT = {"theta": "1.1", "ec": "0.02", "AB": "0.125", "BC": "0.35"}
NAMES = [
    "phi_u", "phi_BC", "phi_u_u", "phi_u_BC", "phi_BC_BC", "S_u", "S_BC", "S_u_u", "S_u_BC", "S_BC_BC",
    "S_1", "S_2", "S_3", "phi_u_1", "phi_BC_2", "phi_u_BC_1", "phi_u_u_2", "S_u_2", "S_BC_3", "S_u_BC_2",
    "S_BC_BC_1", "S_u_u_2",
]  # fmt: skip


sheet = cache(build_sheet)


def numbers():
    return {name: mpmath.mpf(value) for name, value in AT.items()}


def offset(theta, BC=None):
    at = numbers()
    return at["ec"] + at["AB"] * mpmath.sin(theta)


def function(name, u, BC):
    return mpmath.asin(u / BC) if name == "phi" else mpmath.sqrt(BC * BC - u * u)


def by_differences(rod):
    """The derivative by u and BC, then by theta along u(theta), by mpmath's differences."""
    at = numbers()
    order = rod.by.count("u"), rod.by.count("BC")

    def partial(theta):
        return mpmath.diff(lambda u, BC: function(rod.function, u, BC), (offset(theta), at["BC"]), order)

    return mpmath.diff(partial, at["theta"], rod.turns)


def known():
    """Numbers for the names that the equations are written in."""
    at = numbers()
    u, theta = offset(at["theta"]), at["theta"]
    height = function("S", u, at["BC"])
    along = {f"phi_wrt{'_theta' * n}": turning(theta, n) for n in range(1, 5)}
    ratios = {"inv_S": 1 / height, "tan_phi": u / height, "sec_phi": at["BC"] / height}
    return at | ratios | along | {"u": u, "sin_theta": mpmath.sin(theta), "cos_theta": mpmath.cos(theta)}


def turning(theta, order):
    return mpmath.diff(lambda t: function("phi", offset(t), numbers()["BC"]), theta, order)


@pytest.mark.parametrize("name", NAMES)
def test_a_rod_function_is_its_difference(name):
    with mpmath.workdps(DIGITS):
        expression = resolve_rod(sheet(), name).expression
        values = known()
        names = sorted(s.name for s in expression.free_symbols)
        formula = sp.lambdify([sp.Symbol(n, real=True) for n in names], expression, mpmath)
        expected = by_differences(read_rod_function(name))
        assert abs(formula(*(values[n] for n in names)) - expected) < mpmath.mpf(10) ** -15 * (
            1 + abs(expected)
        )


@pytest.mark.parametrize("name", NAMES)
def test_a_name_says_which_function(name):
    assert read_rod_function(name).symbol.name == name


@pytest.mark.parametrize("name", ["Y", "phi_wrt_theta", "S_theta", "T_u", "phi_u_x"])
def test_another_name_is_no_rod_function(name):
    assert read_rod_function(name) is None


def test_the_order_of_the_parameters_does_not_matter():
    start = RodFunction("S")
    assert start.with_respect_to("u").with_respect_to("BC") == start.with_respect_to("BC").with_respect_to(
        "u"
    )


@pytest.mark.parametrize(
    ("name", "unit"),
    [("S_u", Unit()), ("phi_u", Unit(-1, 0, 1)), ("S_u_BC_2", Unit(-1, 0, -2)), ("S_1", Unit(1, 0, -1))],
)
def test_units(name, unit):
    assert read_rod_function(name).unit == unit


def test_the_rod_itself_is_no_derivative():
    assert resolve_rod(sheet(), "S") is None
