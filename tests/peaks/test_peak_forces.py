"""Peaks of forces and torques, and what friction does to them: kinks, jumps, angles at which it jams."""

import math

import mpmath
import numpy as np
import pytest

import desaxe as dx
from desaxe.oracle.force_truth import truth
from tests.effort import cases

ENGINE = {"AB": 0.04, "BC": 0.064, "m_rod": 0.5, "m_slider": 0.8}
THETA = np.linspace(0, 2 * np.pi, 100_001)
PRESS = {"m_slider": 1.0, "m_rod": 0.6, "I_rod": 0.004, "g_Y": -9.81}


@pytest.mark.parametrize(
    ("name", "kind", "ec", "AB", "BC", "omega0", "mu", "F_Y"),
    [
        ("F_B_Y", "max", 0.0, 0.03666491089193882, 0.03667439176148753, 32.6, 0.15178493801098533, 94.1),
        ("N_C", "max", 0.0, 0.03152791172485842, 0.031528525800495935, 34.4, 0.0802, 78.1),
        ("F_B_Y", "min", 0.0, 0.04027280059351783, 0.040442095567029865, 17.45, 0.1884, 64.4),
        (
            "T_in",
            "min",
            0.03410456756538252,
            0.04848866204263014,
            0.08274899840083416,
            22.09751569134461,
            0.3009214521926092,
            -90.52384465241121,
        ),
    ],
)
def test_an_extremum_next_to_an_angle_from_which_friction_jams(name, kind, ec, AB, BC, omega0, mu, F_Y):
    """Between the last node and the end of the balance: peaks were up to 0.8 % off."""
    design = {"ec": ec, "AB": AB, "BC": BC, "omega0": omega0, "mu": mu, "F_Y": F_Y, **PRESS}
    result, sign = dx.peak(name, kind=kind, **design), 1.0 if kind == "max" else -1.0
    exact = [sign * truth(name, theta=result["theta"] + s, **design) for s in (-1e-4, 0.0, 1e-4)]
    assert sign * result["value"] == pytest.approx(float(exact[1]), rel=1e-11)
    assert exact[1] > max(exact[0], exact[2])
    assert sign * result["value"] >= np.nanmax(sign * dx.evaluate(name, theta=THETA, **design)) - 1e-11


def refined(name, sign, theta, design):
    """The largest of a sweep, and the largest next to it by golden section on free bodies at 50 digits."""
    swept = sign * dx.evaluate(name, theta=theta, **design)
    k = int(np.nanargmax(swept))
    low, high = (mpmath.mpf(theta[max(0, min(theta.size - 1, k + step))]) for step in (-1, 1))

    def value(angle):
        exact = truth(name, theta=float(angle), **design)
        return -mpmath.inf if mpmath.isnan(exact) else sign * exact

    for _ in range(60):
        first, second = high - (high - low) / mpmath.phi, low + (high - low) / mpmath.phi
        low, high = (low, second) if value(first) > value(second) else (first, high)
    return max(float(value(low)), float(value(high)), float(value(theta[k])))


@pytest.mark.sampled
def test_peaks_with_friction_are_those_of_free_bodies():
    """Random designs of both branches that turn fully; values are finite where friction never jams."""
    for seed in range(cases(3, 40, 1000)):
        rng = np.random.default_rng([seed, 50])
        AB = rng.uniform(0.03, 0.07)
        ec, mu = rng.uniform(-0.9, 0.9) * AB * rng.integers(0, 2), rng.uniform(0.01, 0.3)
        BC = max(
            AB + abs(ec) + AB * np.exp(rng.uniform(-9.0, 1.5)), (AB + abs(ec)) * np.hypot(1.0, 1.05 * mu)
        )
        design = {"ec": ec, "AB": AB, "BC": BC, "mu": mu, "omega0": rng.uniform(5.0, 50.0), **PRESS}
        design |= {"F_Y": rng.uniform(-200.0, 200.0), "branch": rng.choice([1, -1]).item()}
        name = rng.choice(["T_in", "N_C", "F_B_Y", "F_A_X"]).item()
        kind, sign = (("max", 1.0), ("min", -1.0))[rng.integers(2)]
        result = dx.peak(name, kind=kind, **design)
        if result["status"] in (5, 6):
            continue
        theta = np.linspace(0.0, 2.0 * np.pi, 4001)
        best, value = refined(name, sign, theta, design), sign * result["value"]
        assert value >= best - 1e-11 * abs(best), seed
        beside = [sign * truth(name, theta=result["theta"] + s, **design) for s in (-1e-12, 0.0, 1e-12)]
        assert min(abs(float(exact) - value) for exact in beside) <= 1e-9 * abs(value), seed


@pytest.mark.parametrize("parameter", ["ec", "AB", "BC", "omega0", "m_rod", "m_slider", "mu"])
def test_gradient_with_friction(parameter):
    """Against differences of peaks, also where friction jams at other angles (the last design)."""
    for ec, mu, omega0, status in ((0.01, 0.1, 251.0, 0), (0.02, 0.5, 251.0, 6), (0.02, 1.0, -251.0, 5)):
        design = {**ENGINE, "ec": ec, "mu": mu, "omega0": omega0}
        result = dx.peak("T_in", **design)
        step = 1e-6 * abs(design[parameter])
        near = design[parameter] + step * np.array([-1.0, 1.0])
        low, high = dx.peak("T_in", **{**design, parameter: near})["value"]
        assert result["status"] == status
        assert result["gradient"][parameter] == pytest.approx((high - low) / (2 * step), rel=1e-6)


def test_a_jump_at_the_dead_centre():
    """There friction turns round: the peak is its value on one side, and moves with the design."""
    design = {**ENGINE, "ec": 0.02, "mu": 0.1, "omega0": -251.0}
    result = dx.peak("F_friction", kind="max", **design)
    dead_centre = math.pi - math.asin(0.02 / (0.064 - 0.04))
    assert result["theta"] == pytest.approx(dead_centre, abs=1e-12)
    sides = dx.evaluate("F_friction", theta=dead_centre + np.array([-1e-10, 1e-10]), **design)
    assert sides[0] * sides[1] < 0
    assert result["value"] == pytest.approx(sides.max(), rel=1e-8)
    assert result["status"] == 2
    assert all(math.isnan(slope) for slope in result["gradient"].values())


def test_a_torque_without_bound_where_friction_jams():
    """It jams where mu |tan phi| = 1, and the torque grows without bound towards there."""
    result = dx.peak("T_in", ec=0.0, mu=1.5, omega0=251.0, **ENGINE)
    phi = math.atan(1 / 1.5)
    assert result["value"] == math.inf
    assert result["theta"] == pytest.approx(math.asin(0.064 * math.sin(phi) / 0.04), abs=1e-12)
    assert result["status"] == 5
    assert all(math.isnan(slope) for slope in result["gradient"].values())
    lowest = dx.peak("T_in", kind="min", ec=0.0, mu=1.5, omega0=251.0, **ENGINE)
    assert math.isfinite(lowest["value"])
    assert lowest["status"] == 5


def test_an_arc_with_one_balance_ends_where_a_second_appears():
    """There the force is finite, and half of what it would be without friction."""
    design = {**ENGINE, "ec": 0.01, "omega0": 251.0}
    result = dx.peak("N_C", kind="max", mu=1.0, **design)
    without = dx.evaluate("N_C", theta=result["theta"], **design)
    assert dx.evaluate("phi", theta=result["theta"], ec=0.01, AB=0.04, BC=0.064) == pytest.approx(math.pi / 4)
    assert result["value"] == pytest.approx(without / 2, rel=1e-9)
    assert result["status"] == 5  # elsewhere it jams
    assert all(math.isnan(slope) for slope in result["gradient"].values())


def test_where_two_balances_end_and_jamming_begins_there_is_no_extremum():
    """There the next double had one balance by rounding alone, and its value made a minimum of +inf."""
    design = {"ec": -0.058501449617742916, "AB": 0.07192560315550124, "BC": 0.16120624679489065}
    design |= {"omega0": -39.171379570360706, "mu": 1.4981931463077875, "F_Y": -300.0, "branch": -1}
    design |= {"m_slider": 2.0, "m_rod": 1.0, "I_rod": 0.004, "g_Y": -9.81}
    result = dx.peak("F_B_Y", kind="min", **design)
    sampled = np.nanmin(dx.evaluate("F_B_Y", theta=THETA, **design))
    assert sampled * (1.0 - 1e-5) <= result["value"] <= sampled


def test_only_where_forces_balance():
    """Within these angles nothing balances once; outside of them nothing is wrong."""
    design = {**ENGINE, "ec": 0.0, "mu": 1.5, "omega0": 251.0}
    result = dx.peak("T_in", theta=(1.2, 1.4), **design)
    assert math.isnan(result["value"])
    assert math.isnan(result["theta"])
    assert result["status"] in (5, 6)
    assert dx.peak("T_in", theta=(0.0, 1.0), **design)["status"] == 0
    assert dx.peak("a_C", **design)["status"] == 0
