"""Feasible crank angles, against the status of a fine sweep and exact margins."""

import math
from fractions import Fraction

import mpmath
import numpy as np
import pytest

import desaxe as dx

DESIGNS = [
    (0.1, 0.125, 0.35), (0.23, 0.125, 0.35), (-0.23, 0.125, 0.35), (0.0, 0.5, 0.35), (0.1, 0.5, 0.35),
    (-0.1, 0.5, 0.35), (0.45, 0.125, 0.35), (-0.45, 0.125, 0.35), (0.48, 0.125, 0.35), (2.0, 0.5, 0.35),
]  # fmt: skip


@pytest.mark.parametrize(("ec", "AB", "BC"), DESIGNS)
def test_intervals_are_where_the_sweep_is_feasible(ec, AB, BC):
    intervals = dx.feasibility(ec=ec, AB=AB, BC=BC)["theta_intervals"]
    theta = np.linspace(0, 2 * np.pi, 5001)
    status = dx.evaluate("status", theta=theta, ec=ec, AB=AB, BC=BC)
    inside = np.zeros(theta.size, bool)
    for first, last in intervals:
        assert 0 <= first < 2 * np.pi
        assert first < last
        for turn in (0, 2 * np.pi):
            inside |= (theta + turn >= first) & (theta + turn <= last)
    np.testing.assert_array_equal(inside, status == 0)


@pytest.mark.parametrize("ec", [0.2251, 0.225 + 1e-9, 0.225 + 1e-13])
def test_limit_angles_keep_their_digits(ec):
    """Next to the change point asin loses half of the digits; the gap from the quarter must not."""
    first, last = dx.feasibility(ec=ec, AB=0.125, BC=0.35)["theta_intervals"][0]
    with mpmath.workdps(50):
        gap = mpmath.acos((mpmath.mpf(0.35) - mpmath.mpf(ec)) / mpmath.mpf(0.125))
    assert first - math.pi / 2 == pytest.approx(float(gap), abs=5e-16)
    assert last - 5 * math.pi / 2 == pytest.approx(-float(gap), abs=2e-15)


@pytest.mark.parametrize("left", [1e-3, 1e-9, 1e-15])
@pytest.mark.parametrize("side", [1, -1])
def test_limit_angles_of_what_can_hardly_be_assembled(left, side):
    """Where |ec| nearly is AB + BC only angles next to one quarter are left."""
    ec, middle = side * (1.25 - left), side * -math.pi / 2 % (2 * math.pi)
    (result,) = dx.feasibility(ec=ec, AB=0.5, BC=0.75)["theta_intervals"]
    many = dx.feasibility(ec=[ec, 0.0], AB=0.5, BC=0.75)["theta_intervals"][0]
    with mpmath.workdps(50):
        away = float(mpmath.acos((abs(mpmath.mpf(ec)) - mpmath.mpf(0.75)) / mpmath.mpf(0.5)))
    assert away > 0
    for first, last in (result, many[0]):
        assert first == pytest.approx(middle - away, abs=2e-15)
        assert last == pytest.approx(middle + away, abs=2e-15)
    assert np.isnan(many[1]).all()


@pytest.mark.parametrize(
    ("ec", "AB", "BC"), [(0.225, 0.125, 0.35), (0.1, 0.2, 0.3), (-1 / 3, 0.1, 0.7), (1e-30, 1.0, 1.0)]
)
def test_margin_is_rounded_once(ec, AB, BC):
    exact = float(Fraction(BC) - Fraction(AB) - abs(Fraction(ec)))
    assert dx.feasibility(ec=ec, AB=AB, BC=BC)["margin"] == exact
    assert dx.evaluate("margin", ec=ec, AB=AB, BC=BC) == exact
    assert dx.evaluate("margin", ec=[ec, 0.0], AB=AB, BC=BC)[0] == exact


@pytest.mark.parametrize(
    ("ec", "AB", "BC", "kind", "turns"),
    [
        (0.1, 0.125, 0.35, "crank", True), (0.225, 0.125, 0.35, "change point", False),
        (0.23, 0.125, 0.35, "rocker", False), (2.0, 0.1, 0.3, "none", False),
        (0.25, 0.5, 0.75, "change point", True),
    ],
)  # fmt: skip
def test_kind(ec, AB, BC, kind, turns):
    result = dx.feasibility(ec=ec, AB=AB, BC=BC)
    assert (result["kind"], result["can_turn"]) == (kind, turns)


def test_arrays_are_many_numbers():
    ec = np.array([0.1, -0.1, 0.0, 0.225, 0.23, -0.23, 0.45, -0.45, 0.48, 2.0, 0.475, np.nan])[:, None, None]
    AB, BC = np.array([0.125, 0.5, 0.0, 0.35])[:, None], np.array([0.35, 0.1])
    many = dx.feasibility(ec=ec, AB=AB, BC=BC)
    for i, j, k in np.ndindex(len(ec) - 1, len(AB), len(BC)):
        one = dx.feasibility(ec=ec[i, 0, 0], AB=AB[j, 0], BC=BC[k])
        for name in ("margin", "can_turn", "kind", "grashof", "status"):
            assert many[name][i, j, k] == one[name], name
        for name, slope in one["gradient"].items():
            assert many["gradient"][name][i, j, k] == slope
        intervals = [tuple(ends) for ends in many["theta_intervals"][i, j, k] if np.isfinite(ends[0])]
        assert len(intervals) == len(one["theta_intervals"])
        np.testing.assert_allclose(intervals, one["theta_intervals"], rtol=1e-15)
    assert (many["status"][-1] == 4).all()
    assert (many["kind"][-1] == "bad input").all()


@pytest.mark.parametrize("call", [dx.feasibility, dx.events])
def test_status_next_to_the_limit_is_that_of_the_exact_margin(call):
    ec = np.nextafter(0.225, [0, 0.225, 1])
    exact = [Fraction(0.35) - Fraction(0.125) - Fraction(e) for e in ec]
    expected = [0 if m > 0 else 2 if m == 0 else 1 for m in exact]
    assert call(ec=ec, AB=0.125, BC=0.35)["status"].tolist() == expected
    assert dx.feasibility(ec=ec, AB=0.125, BC=0.35)["kind"].tolist() == ["change point"] * 3
    assert [call(ec=e, AB=0.125, BC=0.35)["status"] for e in ec] == expected


def test_the_shorter_one_turns():
    """Grashof: against the sweep of the crank, and of the rod as a crank."""
    for ec, AB, BC in [(0.1, 0.5, 0.35), (0.2, 0.5, 0.35), (0.1, 0.125, 0.35), (0.3, 0.125, 0.35)]:
        short, long = sorted((AB, BC))
        turns = dx.feasibility(ec=ec, AB=short, BC=long)["can_turn"]
        assert dx.feasibility(ec=ec, AB=AB, BC=BC)["grashof"] == turns
