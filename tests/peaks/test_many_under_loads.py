"""Peaks under loads: of many designs at once, of derivatives, over two turns."""

import warnings

import numpy as np
import pytest

import desaxe as dx

MACHINE = {"AB": 0.1, "BC": 0.35, "omega0": 30.0, "m_slider": 2.0, "m_rod": 1.0}
LOADS = {
    "theta": dx.over_theta([0.0, 1.0, 3.0, 4.5], [0.0, -400.0, -50.0, 20.0], kind="step"),
    "Y": dx.over_Y([0.27, 0.33, 0.42], [0.0, -100.0, -400.0], [0.0, -10.0, -50.0], kind="step"),
    "stroke": dx.over_stroke([0.0, 0.008, 0.1], [-400.0, -100.0, 0.0], kind="linear", dead_centre="inner"),
}


@pytest.mark.parametrize("over", LOADS)
@pytest.mark.parametrize("kind", ["absmax", "max", "min"])
def test_each_design_has_the_peak_that_it_has_alone(over, kind):
    """One of them cannot turn fully, one has a bad length; blocks of two designs give the same."""
    ec = np.array([-0.05, 0.0, 0.02, 0.26, 0.049])
    BC = np.array([0.35, 0.35, 0.30, 0.35, -1.0])
    machine = {name: value for name, value in MACHINE.items() if name != "BC"}
    every = dx.peak("T_in", ec=ec, BC=BC, F_Y=LOADS[over], kind=kind, **machine)
    for row in range(4):
        alone = dx.peak("T_in", ec=ec[row], BC=BC[row], F_Y=LOADS[over], kind=kind, **machine)
        assert every["status"][row] == alone["status"]
        assert every["side"][row] == alone["side"]
        for key in ("value", "theta"):
            np.testing.assert_allclose(every[key][row], alone[key], rtol=1e-9, err_msg=f"{key} of {row}")
        for p, slope in alone["gradient"].items():
            np.testing.assert_allclose(every["gradient"][p][row], slope, rtol=1e-7, atol=1e-9, err_msg=p)
    assert every["status"][4] == 4


@pytest.mark.parametrize(
    "load",
    [
        dx.over_theta([1.5, 3.1, 4.9], [170.0, 470.0, 330.0], kind="linear"),
        dx.over_stroke([0.0, 0.05, 0.05, 0.2], [-460.0, 0.0, 360.0, 90.0], dead_centre="outer"),
        dx.over_Y([0.2, 0.4], [300.0, 460.0], [-420.0, -280.0]),
    ],
)
def test_no_value_with_friction_is_that_of_a_dead_centre(load):
    """There rounding chose between friction of either way and none: peaks were up to 100 % off."""
    ec = np.linspace(-0.05, 0.06, 12)
    AB, BC = MACHINE["AB"], MACHINE["BC"]
    dead = np.stack([-np.arcsin(ec / (AB + BC)), np.pi - np.arcsin(ec / (BC - AB))], axis=1)
    beside = np.concatenate([dead - 1e-9, dead + 1e-9], axis=1) % (2.0 * np.pi)
    theta = np.concatenate([np.broadcast_to(np.linspace(0.0, 2.0 * np.pi, 5001), (12, 5001)), beside], axis=1)
    theta[(np.abs(np.sin(0.5 * (theta[:, :, None] - dead[:, None]))) < 1e-10).any(axis=2)] = np.nan
    given = {"ec": ec, "mu": 0.17, "g_Y": -9.81, "F_Y": load, **MACHINE}
    for name, kind, best in (("F_C_Y", "min", np.nanmin), ("F_friction", "max", np.nanmax)):
        sign = 1.0 if kind == "max" else -1.0
        result = dx.peak(name, kind=kind, **given)["value"]
        swept = best(dx.evaluate(name, **{**given, "ec": ec[:, None], "theta": theta}), axis=1)
        beyond = sign * (result - swept) / np.abs(swept)
        assert (beyond >= -1e-8).all()
        assert (beyond <= 2e-3).all()


DESIGN = {"ec": 0.01, "AB": 0.04, "BC": 0.064}
ANGLES = np.linspace(0.0, 2 * np.pi, 25)[:-1]
FORCES = np.random.default_rng(1).normal(size=24) * 300.0


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
