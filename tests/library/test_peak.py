"""Peaks against mpmath on the closed form, also where they are as narrow as the root of the margin."""

import math

import mpmath
import numpy as np
import pytest

import desaxe as dx
from desaxe.audit.truth import truth

OMEGA = 157.08
MACHINE = {"AB": 0.125, "BC": 0.35, "omega0": OMEGA}


def rate(order, ec, AB, BC):
    """The `order`-th time derivative of Y at speed 1, as a function of theta, from Y itself."""

    def position(theta):
        return AB * mpmath.cos(theta) + mpmath.sqrt(BC**2 - (ec + AB * mpmath.sin(theta)) ** 2)

    return lambda theta: mpmath.diff(position, theta, order) if order else position(theta)


def exact_peak(order, near, ec, AB, BC):
    """The extreme value next to an angle, by mpmath."""
    with mpmath.workdps(50):
        lengths = [mpmath.mpf(x) for x in (ec, AB, BC)]
        theta = mpmath.findroot(rate(order + 1, *lengths), mpmath.mpf(near))
        return theta, rate(order, *lengths)(theta)


@pytest.mark.parametrize("ec", [0.05, 0.15, -0.2, 0.2249])
@pytest.mark.parametrize(("name", "order"), [("Y", 0), ("V_C", 1), ("a_C", 2)])
@pytest.mark.parametrize("kind", ["max", "min", "absmax"])
def test_value_and_angle(name, order, kind, ec):
    found = dx.peak(name, ec=ec, kind=kind, **MACHINE)
    theta, value = exact_peak(order, found["theta"], ec, 0.125, 0.35)
    value = abs(value) if kind == "absmax" else value
    assert found["status"] == 0
    assert abs(found["value"] / (value * mpmath.mpf(OMEGA) ** order) - 1) < 1e-13
    assert abs(found["theta"] - theta) < 1e-7


@pytest.mark.parametrize("kind", ["max", "min", "absmax"])
@pytest.mark.parametrize(
    "name", ["V_C", "a_C", "j_C", "omega_BC", "alpha_BC", "phi", "pressure_angle", "V_C_wrt_ec"]
)
def test_no_sweep_finds_a_better_one(name, kind):
    """A uniform sweep of a hundred thousand angles stays below, and comes close."""
    theta = np.linspace(0, 2 * np.pi, 100_001)
    for ec in (-0.1, 0.03, 0.2):
        values = dx.evaluate(name, theta=theta, ec=ec, **MACHINE)
        swept = {"max": values.max(), "min": values.min(), "absmax": np.abs(values).max()}[kind]
        found = dx.peak(name, ec=ec, kind=kind, **MACHINE)["value"]
        beyond = swept - found if kind == "min" else found - swept
        assert beyond >= -1e-14 * abs(swept)
        assert beyond <= (1e-4 if name == "pressure_angle" else 1e-6) * np.abs(values).max()  # it has a kink


@pytest.mark.parametrize("power", [10, 20, 30, 40])
@pytest.mark.parametrize("side", [1, -1])
def test_peaks_as_narrow_as_the_root_of_the_margin(power, side):
    """Jerk next to the change point: a uniform sweep of 720 sees nothing of it."""
    design = {"ec": side * 0.5, "AB": 1.0, "BC": 1.5 + 2.0**-power, "omega0": 1.0}
    found = dx.peak("j_C", **design)
    exact = [
        abs(truth("j_C", theta=found["theta"] + step * 2.0 ** (-power / 2), **design))
        for step in (-0.01, 0, 0.01)
    ]
    assert abs(found["value"] / exact[1] - 1) < 1e-13
    assert exact[1] > max(exact[0], exact[2])
    # R = sqrt(m + x^2/2), x the distance to the quarter: the jerk is extreme at x = sqrt(m/2), as 1/m.
    distance = abs(found["theta"] - (np.pi / 2 if side > 0 else 3 * np.pi / 2))
    assert distance == pytest.approx(2.0 ** (-(power + 1) / 2), rel=1e-3)


def test_gradient_is_that_of_the_peak():
    """The envelope theorem against differences of the peak itself."""
    design = {"ec": 0.15, "AB": 0.125, "BC": 0.35, "omega0": OMEGA, "alpha": 40.0}
    gradient = dx.peak("a_C", **design)["gradient"]
    assert set(gradient) == set(design)
    for name, value in design.items():
        step = 1e-6 * max(value, 1.0)
        up, down = (dx.peak("a_C", **{**design, name: value + s})["value"] for s in (step, -step))
        assert gradient[name] == pytest.approx((up - down) / (2 * step), rel=1e-6)


def test_ends_of_the_range_count():
    found = dx.peak("a_C", ec=0.0, theta=(0.3, 1.0), kind="min", **MACHINE)
    assert found["theta"] == 0.3
    assert found["value"] == dx.evaluate("a_C", theta=0.3, ec=0.0, **MACHINE)


def test_a_mechanism_that_cannot_turn():
    """Acceleration grows without bound at the limit angle; the position has its extremum there."""
    found = dx.peak("a_C", ec=0.23, **MACHINE)
    assert found["value"] == math.inf
    assert found["status"] == 2
    assert math.isnan(found["gradient"]["ec"])
    limit = math.asin(0.12 / 0.125)
    assert found["theta"] == pytest.approx(limit, abs=1e-9) or found["theta"] == pytest.approx(
        math.pi - limit, abs=1e-9
    )
    lowest = dx.peak("Y", ec=0.23, kind="min", AB=0.125, BC=0.35)
    assert lowest["value"] == pytest.approx(-0.125 * math.cos(limit), abs=1e-7)
    assert lowest["status"] == 2


def test_a_stall_is_an_end_but_no_pole():
    """At the stall a_C is alpha dY/dtheta, finite, although nothing goes on beyond."""
    found = dx.peak("a_C", ec=0.01, AB=0.04, BC=0.1, omega0=10.0, alpha=-50.0, kind="max", theta=(0.0, 2.0))
    slope = dx.evaluate("V_C", theta=1.0, ec=0.01, AB=0.04, BC=0.1, omega=1.0)
    assert found["theta"] == pytest.approx(1.0, abs=1e-9)
    assert found["value"] == pytest.approx(-50.0 * slope, rel=1e-9)
    assert found["status"] == 2


def test_what_needs_no_motion_and_what_is_nothing():
    """Statics: virtual work, T_in = -F_Y dY/dtheta. No speed is needed, and a given one changes nothing."""
    design = {"ec": 0.06, "AB": 0.14, "BC": 0.31}
    speed = dx.peak("V_C", omega0=1.0, **design)
    for motion in ({}, {"omega0": 0.0}, {"omega0": OMEGA}):
        torque = dx.peak("T_in", F_Y=-50.0, **design, **motion)
        assert torque["value"] == pytest.approx(50.0 * speed["value"], rel=1e-13)
        assert torque["theta"] == pytest.approx(speed["theta"], abs=1e-9)
        assert torque["gradient"]["F_Y"] == pytest.approx(-speed["value"], rel=1e-13)
        assert torque["gradient"]["ec"] == pytest.approx(50.0 * speed["gradient"]["ec"], rel=1e-9)
        assert "omega0" not in torque["gradient"]
    assert dx.peak("T_in", **design)["value"] == 0.0
    crank = dx.peak("T_in", m_crank=2.0, g_Y=-10.0, **design)
    assert crank["value"] == pytest.approx(2.0 * 10.0 * 0.07)
    assert dx.peak("V_B", omega0=3.0, **design)["value"] == pytest.approx(0.42)


def test_designs_broadcast_and_what_cannot_be_is_told():
    found = dx.peak("a_C", ec=[[0.0], [0.15], [0.9]], AB=[0.125, 0.1], BC=0.35, omega0=OMEGA)
    assert found["value"].shape == found["theta"].shape == found["gradient"]["AB"].shape == (3, 2)
    assert found["status"].tolist() == [[0, 0], [0, 0], [1, 1]]
    assert np.isnan(found["value"][2]).all()
    one = dx.peak("a_C", ec=0.15, AB=0.1, BC=0.35, omega0=OMEGA)
    assert found["value"][1, 1] == pytest.approx(one["value"], rel=1e-14)


def test_of_two_equal_peaks_the_first_is_told():
    assert dx.peak("V_C", ec=0.0, **MACHINE)["theta"] == pytest.approx(1.26120, abs=1e-5)
    assert dx.peak("a_C", ec=0.0, kind="max", **MACHINE)["theta"] < np.pi


def test_where_there_is_no_peak_there_is_no_angle():
    found = dx.peak("a_C", ec=1.0, **MACHINE)
    assert math.isnan(found["value"])
    assert math.isnan(found["theta"])


def test_the_range_takes_units():
    assert dx.peak("a_C", ec=0.1, theta=("0 deg", "90 deg"), **MACHINE)["theta"] <= np.pi / 2


def test_a_state_has_a_peak_too():
    law = dx.peak("a_C", ec=0.1, **MACHINE)
    state = dx.peak("a_C", ec=0.1, AB=0.125, BC=0.35, omega=OMEGA)
    assert state["value"] == pytest.approx(law["value"], rel=1e-14)
    assert state["gradient"]["omega"] == pytest.approx(law["gradient"]["omega0"], rel=1e-12)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"kind": "largest"}, "kind = 'largest': it is one of absmax, max, min"),
        ({"theta": (1.0, 0.0)}, r"theta = \(1.0, 0.0\)"),
        ({"theta": 1.0}, r"theta = 1.0: a range \(lower end, upper end\) is wanted"),
        ({"AB": -1.0}, "AB = -1.0"),
    ],
)
def test_bad_arguments(arguments, words):
    with pytest.raises(ValueError, match=words):
        dx.peak("a_C", **{"ec": 0.0, **MACHINE, **arguments})


def test_an_unknown_name():
    with pytest.raises(ValueError, match="unknown quantity 'a_D'"):
        dx.peak("a_D", ec=0.0, **MACHINE)
