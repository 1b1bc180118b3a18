"""Next to and exactly at the places where textbook formulas lose everything, against the truth.

At the change point BC = AB + |ec| rod and crank can lie across the slider axis together.  There, D = BC^2 -
(ec + AB sin theta)^2 vanishes like the square of the distance, and what is divided by it keeps its digits
only if the margin keeps its own.
"""

import itertools
import math

import mpmath
import pytest

import desaxe as dx
from desaxe.oracle.truth import LAW, all_names, conditions, truth, truth_all, ulp_error
from tests.effort import cases

pytestmark = pytest.mark.sampled

QUARTER = math.pi / 2
NAMES = [
    q + tail
    for q in ("Y", "V_C", "a_C", "omega_BC", "alpha_BC")
    for tail in ("", *(f"_wrt_{p}" for p in LAW))
]
EVERY_NAME = all_names()
SIDES = (1, -1)
DISTANCES = [sign * 10.0**-k for k in range(1, 10, cases(4, 1)) for sign in SIDES]
DISTANCES_AND_NONE = [0.0, *DISTANCES]
MOTION = {"omega0": 157.0, "alpha": -3.0}
# Crank and eccentricity; their sum is a double except in the last.
MECHANISMS = [(0.125, 0.2249999940395355), (0.875, 2.0**-20), (2.0**-20, 0.875), (0.35, 0.0), (0.125, 0.225)]


def point(theta, ec, AB, BC, **motion):
    return {"theta": theta, "ec": ec, "AB": AB, "BC": BC, **(motion or MOTION)}


def misses(at, gaps=("margin",), names=NAMES):
    """Names that err by more than 8 ulp x (1 + sum of conditions), with error and bound.

    Of several gaps, the one with the smallest sum counts. Where even that leaves no digit, no number is
    promised, and a point may be called infeasible.
    """
    values, exact = dx.evaluate(names, **at), truth_all(names, **at)
    errors = {name: ulp_error(values[name], exact[name]) for name in names}
    suspects = {name: error for name, error in errors.items() if not error <= 8}
    bounds = {name: 8 * (1 + min(conditions(name, gap, **at) for gap in gaps)) for name in suspects}
    return {
        n: (error, bounds[n])
        for n, error in suspects.items()
        if not error <= bounds[n] and bounds[n] < 2.0**53
    }


def feasible(at):
    return mpmath.isfinite(truth("V_C", **at))


@pytest.mark.parametrize(("AB", "ec"), MECHANISMS)
@pytest.mark.parametrize(("side", "branch"), list(itertools.product(SIDES, SIDES)))
def test_at_the_change_point(AB, ec, side, branch):
    for distance in DISTANCES_AND_NONE:
        at = point(side * QUARTER + distance, side * ec, AB, AB + ec) | {"branch": branch}
        assert not feasible(at) or not misses(at, names=EVERY_NAME), at


@pytest.mark.parametrize(("AB", "ec"), MECHANISMS)
@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("power", range(20, 51, cases(15, 5)))
def test_small_margins(AB, ec, side, power):
    """A little short of the change point, and a little beyond it where the rod still reaches."""
    for sign, distance in itertools.product(SIDES, DISTANCES_AND_NONE):
        at = point(side * QUARTER + distance, side * ec, AB, (AB + ec) * (1 + sign * 2.0**-power))
        assert not feasible(at) or not misses(at), at


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("crank", [0.125, 0.35, 3.0])
def test_eccentricity_near_the_rod(side, crank):
    """|ec| within a last bit of BC: only the crank lets the rod reach, however small theta is.

    BC - |ec| is exact and counts as an input. Derivatives by alpha are left out: under the law they are
    2 theta Y'' + Y', which cancels whatever the gap is.
    """
    BC, names = 0.35, [name for name in NAMES if not name.endswith("_wrt_alpha")]
    for ec, exponent in itertools.product((math.nextafter(BC, 0), BC, math.nextafter(BC, 1)), range(1, 21)):
        at = point(-side * 10.0**-exponent, side * ec, crank, BC)
        assert not feasible(at) or not misses(at, ("margin", "rod"), names), at


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("rod", [1e-3, 0.35, 10.0])
def test_eccentricity_near_the_crank(side, rod):
    """The eccentricity within a last bit of +-AB, at the opposite quarter: the pin meets the slider axis.

    With wide margins nothing else happens there, and only the margin counts as an input of its own.
    """
    crank, gaps = 0.7, ("margin", "crank") if rod < 1.4 else ("margin",)
    for ec, distance in itertools.product(
        (math.nextafter(crank, 0), crank, math.nextafter(crank, 1)), DISTANCES
    ):
        at = point(-side * QUARTER + distance, side * ec, crank, rod)
        assert not feasible(at) or not misses(at, gaps), at


@pytest.mark.parametrize("ratio", [10.0**k for k in range(4, 13)])
def test_long_rods(ratio):
    for theta, ec in itertools.product((0.5, -2.0, QUARTER, math.pi, 1e-9), (0.0, 0.01, -0.3, 30.0)):
        at = point(theta, ec, 0.125, 0.125 * ratio)
        assert not misses(at, ("margin", "ec")), at


@pytest.mark.parametrize("ratio", [3.0, 30.0, 300.0, 3000.0])
@pytest.mark.parametrize("side", SIDES)
def test_long_cranks(side, ratio):
    """Cranks much longer than the rod, which reaches along a short arc only; it may be anywhere."""
    BC = 0.35
    for angle, reach in itertools.product((1e-9, 0.02, 0.55, 0.8, 1.3, 1.57, 2.9), (-0.9, 0.0, 0.6, 0.999)):
        at = point(side * angle, reach * BC - ratio * BC * math.sin(side * angle), ratio * BC, BC)
        assert not feasible(at) or not misses(at, ("margin", "ec")), at


def last_feasible(ec, AB, BC, side):
    """The last double before the angle at which the rod lies across the slider axis."""
    with mpmath.workdps(40):
        theta = float(mpmath.asin((side * mpmath.mpf(BC) - ec) / AB))
    inwards = -side * math.inf
    while not feasible(point(theta, ec, AB, BC)):
        theta = math.nextafter(theta, inwards)
    return theta


@pytest.mark.parametrize(
    ("ec", "AB", "BC"), [(0.0, 0.5, 0.35), (0.1, 0.5, 0.35), (-0.2, 0.3, 0.4), (0.3, 1e3, 0.35)]
)
@pytest.mark.parametrize("side", SIDES)
def test_last_feasible_angles(ec, AB, BC, side):
    """Mechanisms that cannot turn fully: the end of the arc and the way towards it."""
    end = last_feasible(ec, AB, BC, side) if abs(side * BC - ec) < AB else side * QUARTER
    for distance in [0.0, *(10.0**-k for k in range(3, 17))]:
        at = point(end - side * distance, ec, AB, BC)
        assert not feasible(at) or not misses(at), at
