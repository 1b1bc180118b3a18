"""Next to and exactly at the places where textbook formulas lose everything, against the truth.

At the change point BC = AB + |ec| rod and crank can lie across the slider axis together.  There, D = BC^2 -
(ec + AB sin theta)^2 vanishes like the square of the distance, and what is divided by it keeps its digits
only if the margin keeps its own.
"""

import itertools
import math
import sys

import mpmath
import pytest

import desaxe as dx
from tests.truth import GAPS, LAW, conditions, truth, truth_all, ulp_error

QUARTER = math.pi / 2
NAMES = [
    q + tail
    for q in ("Y", "V_C", "a_C", "omega_BC", "alpha_BC")
    for tail in ("", *(f"_wrt_{p}" for p in LAW))
]
SIDES = (1, -1)
DISTANCES = [sign * 10.0**-k for k in range(1, 10) for sign in SIDES]
MOTION = {"omega0": 157.0, "alpha": -3.0}
# Crank and eccentricity; their sum is a double except in the last.
MECHANISMS = [(0.125, 0.2249999940395355), (0.875, 2.0**-20), (2.0**-20, 0.875), (0.35, 0.0), (0.125, 0.225)]


def point(theta, ec, AB, BC, **motion):
    return {"theta": theta, "ec": ec, "AB": AB, "BC": BC, **(motion or MOTION)}


def misses(at, gaps=("margin",)):
    """Names that err by more than 8 ulp x (1 + sum of conditions), with error and bound."""
    values, exact = dx.evaluate(NAMES, **at), truth_all(NAMES, **at)
    errors = {name: ulp_error(values[name], exact[name]) for name in NAMES}
    suspects = {name: error for name, error in errors.items() if not error <= 8}
    bounds = {name: 8 * (1 + min(conditions(name, gap, **at) for gap in gaps)) for name in suspects}
    return {name: (error, bounds[name]) for name, error in suspects.items() if not error <= bounds[name]}


def feasible(at):
    return mpmath.isfinite(truth("V_C", **at))


@pytest.mark.parametrize("AB, ec", MECHANISMS)
@pytest.mark.parametrize("side, branch", list(itertools.product(SIDES, SIDES)))
def test_at_the_change_point(AB, ec, side, branch):
    for distance in [0.0, *DISTANCES]:
        at = point(side * QUARTER + distance, side * ec, AB, AB + ec) | {"branch": branch}
        assert not feasible(at) or not misses(at), at


@pytest.mark.parametrize("AB, ec", MECHANISMS)
@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("power", range(20, 51, 3))
def test_small_margins(AB, ec, side, power):
    """A little short of the change point, and a little beyond it where the rod still reaches."""
    for sign, distance in itertools.product(SIDES, [0.0, *DISTANCES]):
        at = point(side * QUARTER + distance, side * ec, AB, (AB + ec) * (1 + sign * 2.0**-power))
        assert not feasible(at) or not misses(at), at


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("crank", [0.125, 0.35, 3.0])
def test_eccentricity_near_the_rod(side, crank):
    """|ec| within a last bit of BC: only the crank lets the rod reach, however small theta is."""
    BC = 0.35
    for ec, exponent in itertools.product((math.nextafter(BC, 0), BC, math.nextafter(BC, 1)), range(1, 21)):
        at = point(-side * 10.0**-exponent, side * ec, crank, BC)
        assert not feasible(at) or not misses(at, GAPS), at


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("rod", [1e-3, 0.35, 10.0])
def test_eccentricity_near_the_crank(side, rod):
    """ec within a last bit of +-AB at the opposite quarter, where pin and slider axis meet."""
    crank = 0.7
    for ec, distance in itertools.product(
        (math.nextafter(crank, 0), crank, math.nextafter(crank, 1)), DISTANCES
    ):
        at = point(-side * QUARTER + distance, side * ec, crank, rod)
        assert not feasible(at) or not misses(at, GAPS), at


@pytest.mark.parametrize("ratio", [10.0**k for k in range(4, 13)])
def test_long_rods(ratio):
    for theta, ec in itertools.product((0.5, -2.0, QUARTER, math.pi, 1e-9), (0.0, 0.01, -0.3, 30.0)):
        at = point(theta, ec, 0.125, 0.125 * ratio)
        assert not misses(at, GAPS), at


def last_feasible(ec, AB, BC, side):
    """The last double before the angle at which the rod lies across the slider axis."""
    with mpmath.workdps(40):
        theta = float(mpmath.asin((side * mpmath.mpf(BC) - ec) / AB))
    inwards = -side * math.inf
    while not feasible(point(theta, ec, AB, BC)):
        theta = math.nextafter(theta, inwards)
    return theta


@pytest.mark.parametrize(
    "ec, AB, BC", [(0.0, 0.5, 0.35), (0.1, 0.5, 0.35), (-0.2, 0.3, 0.4), (0.3, 1e3, 0.35)]
)
@pytest.mark.parametrize("side", SIDES)
def test_last_feasible_angles(ec, AB, BC, side):
    """Mechanisms that cannot turn fully: the end of the arc and the way towards it."""
    end = last_feasible(ec, AB, BC, side) if abs(side * BC - ec) < AB else side * QUARTER
    for distance in [0.0, *(10.0**-k for k in range(3, 17))]:
        at = point(end - side * distance, ec, AB, BC)
        assert not feasible(at) or not misses(at), at


def test_scaling_by_powers_of_two_is_exact():
    """Neither the unit of length nor that of time leaves a trace, up to overflow."""
    at = point(QUARTER - 1e-6, 0.225, 0.125, 0.35 * (1 + 1e-9))
    plain = dx.evaluate(NAMES, **at)
    for power in (-300, -100, 100, 300):
        unit = 2.0**power
        scaled = dx.evaluate(["Y", "V_C", "a_C"], **at | {p: at[p] * unit for p in ("ec", "AB", "BC")})
        assert scaled == {name: plain[name] * unit for name in scaled}
        assert all(sys.float_info.min < abs(value) < math.inf for value in scaled.values())
