"""Harmonics against series and sums by hand, counterweights as bodies, flywheels in a simulated motion."""

import math

import numpy as np
import pytest

import desaxe as dx

PRESS = {"ec": 0.01, "AB": 0.04, "BC": 0.064, "omega0": 251.0, "m_rod": 0.5, "m_slider": 0.8, "m_crank": 0.3}
ANGLES = (np.arange(4096) + 0.5) * 2 * np.pi / 4096


def by_sums(name, order, **inputs):
    """Coefficients by the midpoint rule at other angles."""
    value = dx.evaluate(name, theta=ANGLES, **inputs)
    scale = 1 if order == 0 else 2
    return scale * np.mean(value * np.cos(order * ANGLES)), scale * np.mean(value * np.sin(order * ANGLES))


@pytest.mark.parametrize("name", ["F_shaking_X", "F_shaking_Y", "T_in", "a_C", "a_C_wrt_ec"])
def test_harmonics_by_sums(name):
    inputs = {k: v for k, v in PRESS.items() if name not in ("a_C", "a_C_wrt_ec") or not k.startswith("m_")}
    result = dx.harmonics(name, orders=5, **inputs)
    for n in range(6):
        cosine, sine = by_sums(name, n, **inputs)
        assert result["cos"][n] == pytest.approx(cosine, abs=5 * result["error"])
        assert result["sin"][n] == pytest.approx(sine, abs=5 * result["error"])
    along = result["amplitude"] * np.cos(result["phase"])
    np.testing.assert_allclose(along, result["cos"], atol=1e-12 * result["amplitude"].max())
    value = dx.evaluate(name, theta=ANGLES, **inputs)
    series = sum(
        result["cos"][n] * np.cos(n * ANGLES) + result["sin"][n] * np.sin(n * ANGLES) for n in range(6)
    )
    assert result["remainder"] == pytest.approx(np.sqrt(np.mean((value - series) ** 2)), rel=1e-9)


def test_the_series_of_textbooks():
    """In line, with k = AB/BC: a_C = -AB omega^2 (cos theta + A2 cos 2 theta - A4 cos 4 theta + ...).

    A2 = k + k^3/4 + 15 k^5/128 + ..., A4 = k^3/4 + 3 k^5/16 + ...
    """
    k = 0.05
    result = dx.harmonics("a_C", ec=0, AB=0.1, BC=2.0, omega0=10.0)
    assert result["cos"][1] == pytest.approx(-10.0, rel=1e-14)
    assert result["cos"][2] == pytest.approx(-10.0 * (k + k**3 / 4 + 15 * k**5 / 128), rel=1e-8)
    assert result["cos"][4] == pytest.approx(10.0 * (k**3 / 4 + 3 * k**5 / 16), rel=1e-4)
    assert np.abs(result["sin"]).max() < 10 * result["error"]
    rows = [line.split() for line in repr(result).splitlines()]
    significant = np.where(np.abs(result["cos"]) > result["error"], result["cos"], 0.0)
    assert np.flatnonzero(significant).tolist()[:3] == [1, 2, 4]  # what is within the error is printed as 0
    assert [row[1] for row in rows[2:11]] == [f"{cosine:.6g}" for cosine in significant]


def test_next_to_the_change_point_the_stated_error_holds():
    design = {"ec": 0.0239999, "AB": 0.04, "BC": 0.064, "omega0": 10.0}
    result = dx.harmonics("V_C", orders=3, **design)
    fine = (np.arange(2**20) + 0.5) * 2 * np.pi / 2**20
    value = dx.evaluate("V_C", theta=fine, **design)
    for n in range(1, 4):
        assert result["cos"][n] == pytest.approx(
            2 * np.mean(value * np.cos(n * fine)), abs=result["error"] + 1e-14
        )


def with_weight(product, angle):
    """The shaking force with a mass on the crank, by its centrifugal force."""
    force = dx.evaluate(["F_shaking_X", "F_shaking_Y"], theta=ANGLES, **PRESS)
    size = product * PRESS["omega0"] ** 2
    return force["F_shaking_X"] + size * np.sin(ANGLES + angle), force["F_shaking_Y"] + size * np.cos(
        ANGLES + angle
    )


def first(force):
    return 2 * np.mean(force * np.exp(-1j * ANGLES))


@pytest.mark.parametrize("along", ["both", "X", "Y"])
def test_counterweight(along):
    result = dx.counterweight(along=along, radius="50 mm", **PRESS)
    X, Y = with_weight(result["product"], result["angle"])
    assert abs(first(X)) == pytest.approx(result["after"]["X"], abs=1e-9)
    assert abs(first(Y)) == pytest.approx(result["after"]["Y"], abs=1e-9)
    assert np.hypot(X, Y).max() == pytest.approx(result["after"]["peak"], rel=1e-5)
    assert result["mass"] == pytest.approx(result["product"] / 0.05)
    if along != "both":
        assert result["after"][along] < 1e-9
    else:
        second = result["counter_rotating"]
        size = second["product"] * PRESS["omega0"] ** 2
        assert abs(first(X + size * np.sin(second["angle"] - ANGLES))) < 1e-9
        assert abs(first(Y + size * np.cos(second["angle"] - ANGLES))) < 1e-9
        # No other weight leaves a smaller first harmonic.
        for product, angle in ((1.05, 0.0), (0.95, 0.0), (1.0, 0.05), (1.0, -0.05)):
            X, Y = with_weight(product * result["product"], result["angle"] + angle)
            turned = (first(Y) + 1j * first(X)) / 2, np.conj(first(Y) - 1j * first(X)) / 2
            assert sum(map(abs, turned)) > result["after"]["largest"]


def test_a_counterweight_is_a_crank_with_its_mass_on_the_other_side():
    """A body of the library, at the angle pi: r_crank < 0."""
    light = {"ec": 0.0, "AB": 0.05, "BC": 0.2, "omega0": 100.0, "m_slider": 0.4}
    result = dx.counterweight(**light)
    assert result["product"] == pytest.approx(0.4 * 0.05 / 2, rel=1e-12)
    assert result["angle"] == pytest.approx(math.pi)
    assert result["balanced"] == pytest.approx(0.5, rel=1e-12)
    balanced = dx.counterweight(m_crank=1.0, r_crank=-result["product"], **light)
    assert balanced["before"]["largest"] == pytest.approx(result["after"]["largest"], rel=1e-12)
    assert balanced["product"] == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("period", [1, 2])
def test_a_load_between_slider_and_frame_does_not_shake_the_foundation(period):
    """A compressor: half of what goes to and fro and all that turns, opposite the crank."""
    machine = {"ec": 0.0, "AB": 0.03, "BC": 0.12, "omega0": 100.0, "m_slider": 0.9, "m_rod": 0.6}
    gas = dx.over_theta([0.0, 1.0, 3.0], [0.0, -900.0, -50.0], "linear", period=2 * np.pi * period)
    result = dx.counterweight(radius=0.05, F_Y=gas, **machine)
    assert result["mass"] * 0.05 == pytest.approx((0.5 * (0.9 + 0.3) + 0.3) * 0.03, rel=1e-12)
    assert result["angle"] == pytest.approx(np.pi, abs=1e-12)
    # Masses alone leave what the load adds from outside to the first harmonic of the shaking force.
    if period == 1:
        outside = dx.counterweight(F_Y=gas, loads=True, **machine)["before"]["Y"]
        force = gas(ANGLES) + dx.evaluate("F_shaking_Y", theta=ANGLES, **machine)
        assert outside == pytest.approx(abs(first(force)), rel=1e-5)


def test_a_flywheel_without_a_load():
    """(J + M_eff) omega^2 stays the same: the extremes of M_eff are those of the speed."""
    J = dx.drive(fluctuation=0.02, **PRESS)["flywheel_inertia"]
    heavy, light = (dx.peak("M_eff", kind=kind, **PRESS)["value"] for kind in ("max", "min"))
    ratio = math.sqrt((J + heavy) / (J + light))  # fastest over slowest
    assert 2 * (ratio - 1) / (ratio + 1) == pytest.approx(0.02, rel=1e-9)


def test_a_load_may_be_a_function_of_one_angle():
    def load(theta):
        return -50.0 * math.cos(theta) if theta % (2 * math.pi) < 3.0 else 0.0

    one, other = (dx.drive(fluctuation=0.02, F_Y=f, **PRESS) for f in (load, np.vectorize(load)))
    for name in ("torque_rms", "work_in", "flywheel_inertia"):
        assert one[name] == pytest.approx(other[name], rel=1e-12)


def test_half_orders_of_a_four_stroke_load():
    """A load of two turns has orders 0, 1/2, 1, ...: midpoint sums over both."""
    gas = dx.over_theta(lambda theta: 900.0 * np.exp(np.cos(theta / 2.0 - 0.2)), period=4.0 * np.pi)
    result = dx.harmonics("T_in", orders=3, F_Y=gas, **PRESS)
    assert result["order"].tolist() == [0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0]
    angles = (np.arange(8192) + 0.5) * 4 * np.pi / 8192
    value = dx.evaluate("T_in", theta=angles, F_Y=gas, **PRESS)
    series = np.zeros_like(value)
    for k, order in enumerate(result["order"]):
        scale = 2.0 if k else 1.0
        for wave, part in ((np.cos, "cos"), (np.sin, "sin")):
            assert result[part][k] == pytest.approx(scale * np.mean(value * wave(order * angles)), abs=1e-9)
            series += result[part][k] * wave(order * angles)
    assert result["remainder"] == pytest.approx(np.sqrt(np.mean((value - series) ** 2)), rel=1e-9)
    outside = dx.counterweight(loads=True, F_Y=gas, **PRESS)
    X, Y = (dx.evaluate(f"F_shaking_{axis}", theta=angles, F_Y=gas, **PRESS) for axis in "XY")
    for axis, force in (("X", X), ("Y", Y)):
        assert outside["before"][axis] == pytest.approx(
            2 * abs(np.mean(force * np.exp(-1j * angles))), rel=1e-9
        )


def test_a_share_of_the_force_along_the_slider_axis():
    for along, share in (("X", 0.0), ("both", 0.5), ("Y", 1.0)):
        assert dx.counterweight(balance=share, **PRESS) == dx.counterweight(along=along, **PRESS)
    result = dx.counterweight(balance=0.7, **PRESS)
    _, Y = with_weight(result["product"], result["angle"])
    in_line = dx.counterweight(ec=0, AB=0.05, BC=0.2, omega0=100.0, m_slider=0.4, balance=0.7)
    assert in_line["product"] == pytest.approx(0.7 * 0.4 * 0.05, rel=1e-12)
    assert abs(first(Y)) == pytest.approx(result["after"]["Y"], abs=1e-9)
    for wrong in (-0.1, 1.1, "1 m"):
        with pytest.raises(ValueError, match=r"balance.*share|balance"):
            dx.counterweight(balance=wrong, **PRESS)
