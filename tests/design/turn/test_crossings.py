"""`crossings`: angles against the loop closure at 40 digits, jumps and derivatives against differences."""

import math

import numpy as np
import pytest
from mpmath import mp, mpf

import desaxe as dx

LENGTHS = {"ec": 0.02, "AB": 0.1, "BC": 0.3}
MACHINE = {**LENGTHS, "omega0": 10.0, "m_slider": 1.0, "m_rod": 0.5}


def position(theta, branch, ec, AB, BC):
    return AB * mp.cos(theta) + branch * mp.sqrt(BC**2 - (AB * mp.sin(theta) + ec) ** 2)


# Quantity, its value, and what it is at speed 1 by the derivatives of the position.
MOTION = [("Y", 0.31, 0), ("V_C", 0.05, 1), ("a_C", 0.0, 2), ("a_C", -0.05, 2)]


@pytest.mark.parametrize(("name", "value", "order"), MOTION)
@pytest.mark.parametrize("branch", [1, -1])
def test_angles_share_and_derivatives(name, value, order, branch):
    value = branch * value
    result = dx.crossings(name, value=value, branch=branch, omega0=1.0, **LENGTHS)
    with mp.workdps(40):
        lengths = {p: mpf(v) for p, v in LENGTHS.items()}

        def excess(theta, **changed):
            side = {**lengths, **changed}
            return mp.diff(lambda x: position(x, branch, **side), theta, order) - mpf(value)

        grid = [mpf(float(x)) for x in np.linspace(0.0, 2.0 * np.pi, 401)]
        heights = [excess(x) for x in grid]
        roots = [
            (mp.findroot(excess, (a, b), solver="anderson"), 1 if two > one else -1)
            for a, b, one, two in zip(grid, grid[1:], heights, heights[1:], strict=False)
            if one * two < 0
        ]
        assert result["count"] == len(roots) > 0
        assert result["theta"].tolist() == pytest.approx([float(root) for root, _ in roots], abs=3e-15)
        assert result["rising"].tolist() == [sign for _, sign in roots]
        above = sum(-sign * root for root, sign in roots) + (2 * mp.pi if heights[0] > 0 else 0)
        assert result["share"] == pytest.approx(float(above / (2 * mp.pi)), abs=1e-14)
        h = mpf(10) ** -10
        for p in LENGTHS:
            for k, (root, _) in enumerate(roots):
                ends = (
                    mp.findroot(lambda x, s=s, p=p: excess(x, **{p: lengths[p] + s * h}), root)
                    for s in (1, -1)
                )
                up, down = ends
                assert result["gradient"][p][k] == pytest.approx(
                    float((up - down) / (2 * h)), rel=1e-8, abs=1e-9
                )


def test_a_jump_of_a_load_is_a_crossing():
    """T_in changes its sign where a die lets go, at an angle that moves with the lengths."""
    die = dx.over_stroke(
        [0.0, 0.03], outward=[-800.0, 0.0], inward=[0.0, 0.0], kind="step", dead_centre="outer"
    )
    result = dx.crossings("T_in", F_Y=die, **MACHINE)
    (k,) = np.flatnonzero(result["side"])
    theta = float(result["theta"][k])
    assert theta % (2.0 * np.pi) == pytest.approx(
        dx.inverse(s=0.03, **LENGTHS)["theta"].min() % (2.0 * np.pi), abs=1e-12
    )
    before, after = dx.evaluate("T_in", theta=np.array([theta - 1e-9, theta + 1e-9]), F_Y=die, **MACHINE)
    assert before * after < 0.0
    assert result["side"][k] == result["rising"][k] == np.sign(after)
    for p in LENGTHS:
        ends = []
        for step in (1e-6, -1e-6):
            moved = {**LENGTHS, p: LENGTHS[p] + step}
            ends.append(float(dx.inverse(s=0.03, **moved)["theta"].min()))
        assert result["gradient"][p][k] == pytest.approx((ends[0] - ends[1]) / 2e-6, rel=1e-6)


@pytest.mark.parametrize(
    ("knots", "forces", "kind", "theta", "rising", "share"),
    [  # the pin carries -F_Y; shares in rad
        ([0.0, 1.0, 2.0], [0.0, 100.0, 0.0], "step", [1.0, 2.0], [-1, 1], 0.0),
        ([0.0, 1.0, 2.0], [0.0, -100.0, 0.0], "step", [1.0, 2.0], [1, -1], 1.0),
        ([0.0, 1.0], [0.0, 100.0], "step", [0.0, 1.0], [1, -1], 0.0),
        ([0.0, 1.0, 2.0], [-100.0, 0.0, 100.0], "step", [0.0, 1.0, 2.0], [1, -1, -1], 1.0),
        ([0.0, 1.0, 2.0, 3.0], [0.0, 0.0, 100.0, 0.0], "linear", [1.0, 3.0], [-1, 1], 0.0),
        ([0.0, 1.0, 2.0, 3.0], [0.0, 0.0, -100.0, 0.0], "linear", [1.0, 3.0], [1, -1], 2.0),
    ],
)
@pytest.mark.parametrize("omega0", [1.0, -1.0])
def test_a_quantity_that_stays_at_the_value(knots, forces, kind, theta, rising, share, omega0):
    """By the table itself: where it leaves 0, comes back to it, and is above."""
    load = dx.over_theta(knots, forces, kind)
    result = dx.crossings("F_C_Y", m_slider=0.0, F_Y=load, ec=0.0, AB=0.1, BC=0.3, omega0=omega0)
    assert result["theta"].tolist() == pytest.approx(theta, abs=1e-14)
    assert result["rising"].tolist() == rising
    assert result["side"].tolist() == (rising if kind == "step" else [0.0] * len(theta))
    assert result["share"] == pytest.approx(share / (2.0 * math.pi), abs=1e-14)


@pytest.mark.parametrize(("AB", "BC"), [(0.1, 0.3), (0.03, 0.12), (0.05, 0.2), (0.1, 0.25), (0.033, 0.127)])
@pytest.mark.parametrize("ec", [0.0, 0.01, 0.02])
def test_what_touches_the_value_does_not_cross_it(AB, BC, ec):
    """At the dead centres of the closure, to rounding and one unit beside it."""
    outer, inner = (math.sqrt((BC + way * AB) ** 2 - ec**2) for way in (1, -1))
    for touched, share in ((outer, 0.0), (inner, 1.0)):
        for value in (math.nextafter(touched, 0.0), touched, math.nextafter(touched, 1.0)):
            result = dx.crossings("Y", value=value, ec=ec, AB=AB, BC=BC)
            assert (result["count"], result["status"], result["share"]) == (0, 0, share)


def test_statuses_and_many_designs():
    result = dx.crossings("V_C", ec=[0.0, 0.02, 0.02, np.nan], AB=0.1, BC=[0.3, 0.3, 0.11, 0.3], omega0=10.0)
    assert result["status"].tolist() == [0, 0, 1, 4]
    assert result["count"].tolist() == [2, 2, 0, 0]
    assert result["theta"].shape == (4, 2)
    assert np.isnan(result["theta"][2:]).all()
    one = dx.crossings("V_C", omega0=10.0, **LENGTHS)
    np.testing.assert_array_equal(result["theta"][1], one["theta"])
    assert one["share"] == pytest.approx(dx.events(**LENGTHS)["advance_angle"] / (2.0 * np.pi), abs=1e-14)
    assert dx.crossings("omega", value=10.0, omega0=10.0, **LENGTHS)["status"] == 3
    assert dx.crossings("V_C", ec=0.0, AB=0.1, BC=0.3, omega0=10.0)["theta"] == pytest.approx(
        [0.0, np.pi], abs=1e-15
    )


def test_the_cycle_is_that_of_the_loads():
    gas = dx.over_theta(lambda theta: 100.0 * np.sin(theta / 2.0), period=4.0 * np.pi)
    result = dx.crossings("T_in", F_Y=gas, **MACHINE)
    assert result["theta"][-1] > 2.0 * np.pi
    turn = np.linspace(0.0, 4.0 * np.pi, 100_001)
    above = dx.evaluate("T_in", theta=turn, F_Y=gas, **MACHINE) > 0.0
    assert result["share"] == pytest.approx(above.mean(), abs=1e-4)
    assert result["count"] == np.count_nonzero(np.diff(above))


def test_the_units_of_a_machine():
    machine = dx.Machine(units="mm, deg, rpm", ec=20, AB=100, BC=300, omega0=100)
    result = machine.crossings("V_C", value=500)
    assert machine.evaluate("V_C", theta=result["theta"]) == pytest.approx([500.0, 500.0], rel=1e-12)
    with pytest.raises(TypeError, match="theta is the answer"):
        machine.crossings("V_C", theta=1)


def test_a_turn_that_repeats_no_other_is_refused():
    with pytest.raises(TypeError, match="crossings: alpha: no turn repeats"):
        dx.crossings("V_C", alpha=5.0, **MACHINE)
    steady = dx.crossings("V_C", omega0=10.0, **LENGTHS)
    assert (
        dx.crossings("V_C", omega0=10.0, alpha=0.0, **LENGTHS)["theta"].tolist() == steady["theta"].tolist()
    )
