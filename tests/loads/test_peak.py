"""Peaks under loads that vary with the motion: sides of jumps, friction, two turns."""

import warnings

import numpy as np
import pytest

import desaxe as dx

DESIGN = {"ec": 0.01, "AB": 0.04, "BC": 0.064}
ANGLES = np.linspace(0.0, 2 * np.pi, 25)[:-1]
FORCES = np.random.default_rng(1).normal(size=24) * 300.0


def test_a_bare_function_is_searched_as_a_load_over_theta():
    """By virtual work, T_in = -F_Y dY/dtheta without masses."""

    def load(theta):
        return 300.0 * np.sin(3.0 * theta) ** 3

    theta = np.linspace(0.0, 2 * np.pi, 100_001)
    result = dx.peak("T_in", F_Y=load, **DESIGN)
    swept = np.abs(load(theta) * dx.evaluate("Y_wrt_theta", theta=theta, **DESIGN)).max()
    assert swept * (1 - 1e-12) <= result["value"] <= swept * (1 + 1e-7)
    assert result["status"] == 0


@pytest.mark.parametrize("accuracy", ["standard", "extended"])
def test_a_derivative_is_searched_where_no_second_slope_of_the_load_is_needed(accuracy):
    load = dx.over_theta(ANGLES, FORCES)
    result = dx.peak("T_in_wrt_ec", F_Y=load, accuracy=accuracy, **DESIGN)
    theta = np.linspace(0.0, 2 * np.pi, 100_001)
    swept = np.abs(dx.evaluate("T_in_wrt_ec", theta=theta, F_Y=load, **DESIGN)).max()
    assert swept * (1 - 1e-12) <= result["value"] <= swept * (1 + 1e-6)
    step = 1e-6
    ahead, behind = (
        dx.peak("T_in_wrt_ec", F_Y=load, **{**DESIGN, "AB": DESIGN["AB"] + side * step})["value"]
        for side in (1, -1)
    )
    assert result["gradient"]["AB"] == pytest.approx((ahead - behind) / (2 * step), rel=1e-5)
    for name, more in (("T_in_wrt_theta", load), ("T_in_wrt_AB", dx.over_Y([0.03, 0.06, 0.1], [0, -9, 5]))):
        with pytest.raises(ValueError, match=f"peak of {name}: it has the slope of F_Y"):
            dx.peak(name, F_Y=more, **DESIGN)


def test_both_limits_at_a_jump_take_part():
    load = dx.over_theta([0.0, 1.0, 2.0], [100.0, -50.0, 10.0], kind="step")
    result = dx.peak("F_C_Y", kind="min", F_Y=load, **DESIGN)
    assert result["value"] == -100.0
    arm = -dx.evaluate("Y_wrt_theta", theta=1.0, **DESIGN)
    result = dx.peak("T_in", kind="max", theta=(0.5, 1.5), F_Y=load, **DESIGN)
    assert result["value"] == pytest.approx(100.0 * arm, rel=1e-13)
    assert result["theta"] == pytest.approx(1.0, abs=1e-14)
    result = dx.peak("T_in", kind="min", theta=(0.5, 1.5), F_Y=load, **DESIGN)
    assert result["value"] <= -50.0 * arm


@pytest.mark.thorough
def test_many_designs_friction_and_derivatives_that_are_not_derived():
    ec, load = np.array([0.0, 0.01, 0.015]), dx.over_theta(ANGLES, FORCES)
    bodies = {"AB": 0.04, "BC": 0.064, "m_rod": 0.5, "m_slider": 0.8, "omega0": 200.0, "F_Y": load}
    theta = np.linspace(0.0, 2 * np.pi, 20_001)
    for name, more in (("N_C", {"mu": 0.1}), ("N_C_wrt_mu", {"mu": 0.1}), ("T_in", {})):
        result = dx.peak(name, ec=ec, **bodies, **more)
        scan = np.abs(dx.evaluate(name, theta=theta[:, None], ec=ec, **bodies, **more)).max(axis=0)
        assert (result["value"] >= scan * (1 - 1e-12)).all()
        np.testing.assert_allclose(result["value"], scan, rtol=1e-5)


def test_a_load_of_two_turns_is_searched_over_both():
    load = dx.over_theta([0.0, 1.0, 7.0, 8.0], [0.0, 10.0, 0.0, 500.0], kind="linear", period=4 * np.pi)
    result = dx.peak("T_in", F_Y=load, **DESIGN)
    assert result["theta"] > 2 * np.pi
    assert dx.peak("T_in", F_Y=load, theta=(0.0, 2 * np.pi), **DESIGN)["value"] < result["value"]


def test_a_long_array_of_loads_alone_is_warned_of():
    with pytest.warns(dx.LoadWarning, match="F_Y=desaxe.over_theta"):
        dx.peak("T_in", F_Y=np.zeros(61), **DESIGN)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        dx.peak("T_in", F_Y=np.zeros(60), **DESIGN)
        dx.peak("T_in", F_Y=np.zeros(61), **(DESIGN | {"ec": np.zeros(61)}))
