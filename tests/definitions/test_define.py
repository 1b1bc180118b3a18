"""Own quantities: values and sensitivities against the oracle, and what a definition changes and does not."""

import math
import subprocess
import sys
from contextlib import ExitStack

import numpy as np
import pytest
from mpmath import mp

import desaxe as dx
from desaxe.oracle.force_truth import OTHERS
from tests.definitions.expressions import BODIES, EXPRESSIONS, GENERIC, defined

PARAMETERS = ("theta", "ec", "AB", "BC", "omega0", "alpha", *OTHERS)
POINT = GENERIC | BODIES


@pytest.mark.parametrize("name", EXPRESSIONS)
def test_values_and_all_first_sensitivities(name):
    expression = EXPRESSIONS[name]
    with defined(name, expression.text, **expression.constants):
        known = set(dx.quantities())
        slopes = {p: f"{name}_wrt_{p}" for p in PARAMETERS if f"{name}_wrt_{p}" in known}
        result = dx.evaluate([name, *slopes.values()], **POINT)
    assert set(slopes) >= set(PARAMETERS[:6])
    assert math.isclose(result[name], expression.exact(POINT), rel_tol=1e-13)
    for parameter, slope in slopes.items():
        exact = float(expression.exact(POINT, parameter))
        assert math.isclose(result[slope], exact, rel_tol=1e-12, abs_tol=1e-14), slope
    # By a parameter that it has no sensitivity by, it does not change.
    for parameter in set(PARAMETERS) - set(slopes):
        assert expression.exact(POINT, parameter) == 0


@pytest.mark.parametrize("name", ["powers", "grows"])
def test_second_sensitivities(name):
    expression = EXPRESSIONS[name]
    pairs = [("theta", "ec"), ("ec", "BC"), ("AB", "omega0")]
    with defined(name, expression.text, **expression.constants):
        result = dx.evaluate([f"{name}_wrt_{p}_{q}" for p, q in pairs], **POINT)
    for (p, q), value in zip(pairs, result.values(), strict=True):
        assert math.isclose(value, expression.exact(POINT, p, q), rel_tol=1e-9, abs_tol=1e-14), (p, q)


def test_second_ones_exist_where_the_names_have_them():
    with defined("shoe", "abs(N_C * V_C)"), pytest.raises(ValueError, match=r"not derived|did you mean"):
        dx.evaluate("shoe_wrt_ec_ec", **POINT)


def test_a_state():
    state = {p: value for p, value in POINT.items() if p != "omega0"} | {"omega": 150.0}
    with defined("rate", "V_C * omega"):
        result = dx.evaluate(
            ["V_C", "V_C_wrt_omega", "rate_wrt_omega", "rate_wrt_theta", "V_C_wrt_theta"], **state
        )
        assert math.isclose(result["rate_wrt_omega"], result["V_C"] + 150.0 * result["V_C_wrt_omega"])
        assert math.isclose(result["rate_wrt_theta"], 150.0 * result["V_C_wrt_theta"])
    with defined("start", "omega0 * AB"), pytest.raises(ValueError, match="no meaning for a given state"):
        dx.evaluate("start", **state)


def test_twice_the_digits():
    expression = EXPRESSIONS["bearing"]
    with defined("bearing", expression.text, **expression.constants):
        value = dx.evaluate("bearing", accuracy="extended", **POINT)
        quality = dx.evaluate("bearing", quality=True, **POINT)
    assert abs(value - expression.exact(POINT)) <= 2 * math.ulp(value)
    assert abs(quality.value - expression.exact(POINT)) <= quality.error_bound
    with (
        defined("grown", "exp(-phi)"),
        pytest.raises(ValueError, match="not available for grown: it uses exp"),
    ):
        dx.evaluate("grown", accuracy="extended", **POINT)


def test_arrays_are_as_points():
    theta = np.linspace(0.0, 6.0, 3_000)
    with defined("both", "where(V_C > 0, hypot(V_C, V_B), exp(phi) * AB * omega0)"):
        inputs = {"ec": 0.3, "AB": 0.125, "BC": 0.35, "omega0": 3.0}  # it cannot turn fully
        result = dx.evaluate(["both", "both_wrt_BC", "status"], theta=theta, **inputs)
        for index in (0, 700, 1_500, 2_500, 2_999):
            point = dx.evaluate(["both", "both_wrt_BC"], theta=theta[index], **inputs)
            for name, value in point.items():
                assert np.isclose(result[name][index], value, rtol=1e-14, equal_nan=True)
        assert (np.isnan(result["both"]) == (result["status"] == 1)).all()
        assert (np.isnan(result["both_wrt_BC"]) == (result["status"] == 1)).all()
        assert (result["status"] == 1).any()


@pytest.mark.parametrize(
    "expression",
    ["max(V_C, 0)", "min(0, V_C)", "where(V_C > 0, 1, 2)", "where(V_C != 0, 1, 2)", "2 * phi", "abs(V_C)"],
)
def test_what_does_not_exist_is_nan(expression):
    with defined("own", expression):
        result = dx.evaluate(
            ["own", "own_wrt_ec", "own_wrt_alpha"], theta=1.57, ec=0.3, AB=0.125, BC=0.35, omega0=3.0
        )
    assert all(map(math.isnan, result.values()))


def test_magnitudes_at_0_have_no_derivative():
    dead_centre = {"theta": 0.0, "ec": 0.0, "AB": 0.125, "BC": 0.35, "omega0": 3.0}
    for expression in ("abs(V_C)", "hypot(V_C, V_C)", "sqrt(V_C**2)"):
        with defined("size", expression):
            assert dx.evaluate("size", **dead_centre) == 0.0
            assert math.isnan(dx.evaluate("size_wrt_theta", **dead_centre))
    with defined("kink", "max(V_C, 2*V_C)"):  # the side that is taken
        assert dx.evaluate("kink_wrt_theta", **dead_centre) in (
            dx.evaluate("V_C_wrt_theta", **dead_centre) * factor for factor in (1, 2)
        )


def test_the_peak_of_a_kinked_quantity_and_its_gradient():
    inputs = {p: value for p, value in POINT.items() if p not in ("theta", "mu")}
    with defined("loss", "0.1 * abs(N_C * V_C)"):
        peak = dx.peak("loss", **inputs)
        theta = np.linspace(0, 2 * np.pi, 1_501)
        samples = dx.evaluate("loss", theta=theta, **inputs)
        assert samples.max() <= peak["value"] <= samples.max() * (1 + 1e-4)
        assert math.isclose(dx.evaluate("loss", theta=peak["theta"], **inputs), peak["value"], rel_tol=1e-12)
        slope = dx.evaluate("loss_wrt_ec", theta=peak["theta"], **inputs)
        assert math.isclose(peak["gradient"]["ec"], slope, rel_tol=1e-9)


def test_nothing_is_stale():
    inputs = {p: value for p, value in POINT.items() if p != "theta"}
    theta = np.array([0.3, 1.1])
    with defined("own", "V_C"), defined("of_own", "own / V_C"):
        for factor in (1, 3):
            dx.define("own", f"{factor} * V_C")
            assert dx.evaluate("of_own", **POINT) == factor
            assert dx.evaluate("of_own", theta=theta, **inputs).tolist() == [factor, factor]
            peaks = dx.peak("own", **inputs)["value"], dx.peak("V_C", **inputs)["value"]
            assert math.isclose(peaks[0], factor * peaks[1])
            assert dx.quantities()["own"].source == f"{factor} * V_C"
        with pytest.raises(ValueError, match="used by of_own"):
            dx.undefine("own")
    for name in ("own", "own_wrt_ec"):
        with pytest.raises(ValueError, match="unknown quantity"):
            dx.evaluate(name, **POINT)
    with pytest.raises(ValueError, match="is not a defined quantity"):
        dx.undefine("own")


def test_a_new_definition_is_checked_with_those_that_use_it():
    with defined("base", "V_C"), defined("user", "base + V_C"):
        with pytest.raises(ValueError, match="user: '\\+' wants one dimension"):
            dx.define("base", "a_C")
        with pytest.raises(ValueError, match="defined by itself"):
            dx.define("base", "user")
        assert dx.evaluate("user", **POINT) == 2 * dx.evaluate("V_C", **POINT)


def test_a_definition_can_have_the_name_of_a_line():
    """The derivation's own names and those that emitters use are no names of a user's."""
    names = ("D", "eps", "t0", "x", "x_close", "length", "slope", "max_x")
    with ExitStack() as stack:
        for count, name in enumerate(names):
            stack.enter_context(defined(name, f"{count + 1} * V_C"))
        result = dx.evaluate(["V_C", *names], **POINT)
    assert [*result.values()][1:] == [(k + 1) * result["V_C"] for k in range(len(names))]


def test_angles_of_an_expression_have_any_size():
    with defined("wave", "sin(50 * theta)"):
        assert math.isclose(dx.evaluate("wave", theta=1e9), mp.sin(50 * mp.mpf(1e9)), rel_tol=1e-12)


def test_a_unit_that_only_the_unit_library_knows_is_looked_up_in_a_fresh_process():
    """The library is imported within another import, whose lock no second thread may wait for."""
    code = """
import desaxe as dx
dx.define("line_load", "F_C / w", w="2 inch")
try:
    dx.define("other", "w * F_C", w="1 mmm")
except ValueError as error:
    print(error)
"""
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True)
    assert ran.stdout == "other: constant w = '1 mmm': unknown unit\n"


def test_one_over_nothing_is_no_foreign_traceback():
    with defined("pole", "1 / 0 * a_C"):
        assert not math.isfinite(dx.evaluate("pole", **POINT))
