"""Peaks under loads that vary with the motion: against virtual work, T_in = -F_Y dY/dtheta without masses."""

import warnings

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import desaxe as dx

DESIGN = {"ec": 0.01, "AB": 0.04, "BC": 0.064}
ANGLES = np.linspace(0.0, 2 * np.pi, 25)[:-1]
FORCES = np.random.default_rng(1).normal(size=24) * 300.0
POSITIONS, OUTWARD, INWARD = [0.02, 0.05, 0.08, 0.1], [-900, -200, -50, -30], [900, -400, -150, -30]
LOADS = {
    "cubic": dx.over_theta(ANGLES, FORCES),
    "linear": dx.over_theta(ANGLES, FORCES, kind="linear"),
    "step": dx.over_theta(ANGLES, FORCES, kind="step"),
    "function": lambda theta: 300.0 * np.sin(3.0 * theta) ** 3,
    "stroke": dx.over_Y(POSITIONS, OUTWARD, INWARD),
    "stepped stroke": dx.over_Y(POSITIONS, OUTWARD, INWARD, kind="step"),
}


def torque(load, theta, ec=0.01, AB=0.04, BC=0.064):
    """The torque that holds the load, from the textbook's slider position."""
    side = ec + AB * np.sin(theta)
    height = np.sqrt(BC**2 - side**2)
    slope = -AB * np.sin(theta) - side * AB * np.cos(theta) / height
    over_theta = getattr(load, "over", "theta") == "theta"
    force = load(theta) if over_theta else load(AB * np.cos(theta) + height, np.where(slope < 0, -1.0, 1.0))
    return -force * slope


def largest(load, **lengths):
    """The largest magnitude: a fine scan, refined where it is smooth."""
    theta = np.linspace(0.0, 2 * np.pi, 400_001)
    value = np.abs(torque(load, theta, **lengths))
    top = theta[value.argmax()]
    best = minimize_scalar(
        lambda t: -abs(torque(load, t, **lengths)), bounds=(top - 2e-5, top + 2e-5), options={"xatol": 1e-12}
    )
    return max(value.max(), -best.fun)


@pytest.mark.parametrize("kind", LOADS)
def test_the_peak_is_the_largest_of_virtual_work_and_its_gradient_that_of_the_peak(kind):
    load = LOADS[kind]
    found = dx.peak("T_in", F_Y=load, **DESIGN)
    right = largest(load)
    assert right * (1 - 1e-12) <= found["value"] <= right * (1 + 2e-5)  # a jump's limit is between two angles
    assert found["status"] == 0
    for name in DESIGN:
        near = [DESIGN | {name: DESIGN[name] + side * 1e-8} for side in (1, -1)]
        ahead, behind = (dx.peak("T_in", F_Y=load, **design)["value"] for design in near)
        assert found["gradient"][name] == pytest.approx((ahead - behind) / 2e-8, rel=2e-5)


def test_both_limits_at_a_jump_take_part():
    load = dx.over_theta([0.0, 1.0, 2.0], [100.0, -50.0, 10.0], kind="step")
    found = dx.peak("F_C_Y", kind="min", F_Y=load, **DESIGN)
    assert found["value"] == -100.0
    arm = -dx.evaluate("Y_wrt_theta", theta=1.0, **DESIGN)
    found = dx.peak("T_in", kind="max", theta=(0.5, 1.5), F_Y=load, **DESIGN)
    assert found["value"] == pytest.approx(100.0 * arm, rel=1e-13)
    assert found["theta"] == pytest.approx(1.0, abs=1e-14)
    found = dx.peak("T_in", kind="min", theta=(0.5, 1.5), F_Y=load, **DESIGN)
    assert found["value"] <= -50.0 * arm


@pytest.mark.thorough
def test_many_designs_friction_and_derivatives_that_are_not_derived():
    ec, load = np.array([0.0, 0.01, 0.015]), LOADS["cubic"]
    bodies = {"AB": 0.04, "BC": 0.064, "m_rod": 0.5, "m_slider": 0.8, "omega0": 200.0, "F_Y": load}
    theta = np.linspace(0.0, 2 * np.pi, 20_001)
    for name, more in (("N_C", {"mu": 0.1}), ("N_C_wrt_mu", {"mu": 0.1}), ("T_in", {})):
        found = dx.peak(name, ec=ec, **bodies, **more)
        scan = np.abs(dx.evaluate(name, theta=theta[:, None], ec=ec, **bodies, **more)).max(axis=0)
        assert (found["value"] >= scan * (1 - 1e-12)).all()
        np.testing.assert_allclose(found["value"], scan, rtol=1e-5)


def test_a_load_of_two_turns_is_searched_over_both():
    load = dx.over_theta([0.0, 1.0, 7.0, 8.0], [0.0, 10.0, 0.0, 500.0], kind="linear", period=4 * np.pi)
    found = dx.peak("T_in", F_Y=load, **DESIGN)
    assert found["theta"] > 2 * np.pi
    assert dx.peak("T_in", F_Y=load, theta=(0.0, 2 * np.pi), **DESIGN)["value"] < found["value"]


def test_a_long_array_of_loads_alone_is_warned_of():
    with pytest.warns(dx.LoadWarning, match="F_Y=desaxe.over_theta"):
        dx.peak("T_in", F_Y=np.zeros(61), **DESIGN)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        dx.peak("T_in", F_Y=np.zeros(60), **DESIGN)
        dx.peak("T_in", F_Y=np.zeros(61), **(DESIGN | {"ec": np.zeros(61)}))
