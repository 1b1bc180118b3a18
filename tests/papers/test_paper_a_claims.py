"""Paper A, Sec. III.C and IV: percentages, limits, the optimum."""

import itertools
import math
import random
from functools import cache

import numpy as np
import pytest
from mpmath import mp

import desaxe as dx
from tests.papers import loop
from tests.papers import paper_a as A
from tests.papers.designs import (
    CASE,
    CRANK,
    DESIGNS,
    ROD,
    SHEET,
    SPEED,
    TURN,
    close,
    package,
    scale_of,
)
from tests.papers.loop import Motion

# --- sensitivity analysis, Sec. III.C -------------------------------------------------------------

FORMULA = {"V_C": SHEET.corrected_V_C, "a_C": SHEET.corrected_a_C}
MEASURES = {"max": lambda x: x, "min": lambda x: -x, "abs": abs}


def refine(f, low, high):
    """The angle of the largest f between two angles by golden section."""
    ratio = (math.sqrt(5) - 1) / 2
    while high - low > 1e-9:
        left, right = high - ratio * (high - low), low + ratio * (high - low)
        low, high = (left, high) if f(left) < f(right) else (low, right)
    return (low + high) / 2


@cache
def peak(name, ec, BC=ROD, AB=CRANK, kind="abs", samples=720):
    """Largest measure of V_C or a_C over a turn and its angle (rad), by hand formula, checked at the spot.

    At the angle found the loop closure and the package agree, and nowhere is the package's curve higher.
    """

    def measured(theta):
        return MEASURES[kind](FORMULA[name](theta, ec, AB, BC))

    step = TURN / samples
    near = max((n * step for n in range(samples)), key=measured)
    theta = refine(measured, near - step, near + step)
    check_peak(name, Motion(theta, ec, AB, BC, SPEED), MEASURES[kind])
    return measured(theta), theta % TURN


def check_peak(name, motion, measure):
    """The package agrees with the loop at this angle and is not higher anywhere over the turn."""
    value = measure(package(name, motion))
    assert close(value, measure(loop.truth(name, motion)), 0, 9)
    grid = np.linspace(0.0, TURN, 1441)
    curve = dx.evaluate(name, **(motion._asdict() | {"theta": grid}))
    assert max(measure(x) for x in curve.tolist()) <= value * (1 + 1e-9)


def test_sensitivity_functions_are_values():
    for motion in [CASE, *DESIGNS[:6]]:
        derivative = loop.partial("V_C", "ec", motion)
        assert close(package("V_C_wrt_ec", motion), derivative, 0, 12)
        assert package("V_C", motion) != pytest.approx(float(derivative), rel=1e-3)
        doubled = motion._replace(ec=2 * motion.ec, AB=2 * motion.AB, BC=2 * motion.BC)
        assert close(package("V_C", doubled), 2 * package("V_C", motion), 0, 12)
        assert close(package("V_C_wrt_ec", doubled), package("V_C_wrt_ec", motion), 0, 12)
    assert float(loop.partial("V_C", "ec", CASE)) == pytest.approx(-32.6, abs=0.05)


def test_shock_without_eccentricity():
    assert round(peak("a_C", 0.0, BC=0.127)[0]) == 17176
    assert round(peak("a_C", 0.15)[0]) == 4604


def test_eccentricity_raises_the_peak():
    assert (round(peak("a_C", 0.0)[0]), round(peak("a_C", 0.01)[0])) == (4186, 4187)
    theta = np.linspace(0.0, TURN, 2881)[None, :]
    for ratio in (0.05, 0.1, 0.2, CRANK / ROD, 0.5, 0.7, 0.9, 0.95):
        ec = np.linspace(0.0, 0.96, 25)[:, None] * (1 - ratio)
        for side in (ec, -ec):
            curves = dx.evaluate("a_C", theta=theta, ec=side, AB=ratio, BC=1.0, omega0=1.0)
            assert np.all(np.diff(np.abs(curves).max(axis=1)) > 0)
        hand = A.Worksheet(1.0, 0.0).corrected_a_C
        few = [max(abs(hand(t, e, ratio, 1.0)) for t in theta[0, ::4].tolist()) for e in ec[::6, 0].tolist()]
        assert few == sorted(few)


def test_velocity_shifts_with_eccentricity():
    inward = [peak("V_C", ec, kind="min") for ec in (0.0, 0.05, 0.10, 0.15)]
    assert [round(math.degrees(theta), 1) for _, theta in inward] == [72.3, 66.2, 60.9, 56.6]
    assert [round(value, 2) for value, _ in inward] == [20.87, 22.18, 24.28, 27.83]


def test_33_percent():
    before, after = peak("V_C", 0.0)[0], peak("V_C", 0.15)[0]
    assert (round(before, 3), round(after, 3)) == (20.865, 27.827)
    assert round(100 * (after / before - 1)) == 33
    assert 100 * (after / before - 1) == pytest.approx(33.4, abs=0.05)
    assert peak("V_C", 0.15, kind="min")[0] == after
    outward = peak("V_C", 0.15, kind="max")[0]
    assert round(outward, 3) == 19.687
    assert 100 * (outward / before - 1) == pytest.approx(-5.6, abs=0.05)


def dead_centres(ec):
    """The crank angles of the outer and the inner dead centre, rad: crank and rod in line."""
    return -math.asin(ec / (CRANK + ROD)), math.pi - math.asin(ec / (ROD - CRANK))


def test_shorter_side():
    outer, inner = dead_centres(0.15)
    for theta in (outer, inner):
        motion = Motion(theta, 0.15, CRANK, ROD, SPEED)
        assert abs(package("V_C", motion)) < 1e-12 * CRANK * SPEED
        assert abs(loop.truth("V_C", motion)) < 1e-12 * CRANK * SPEED
    assert [round(math.degrees(angle), 1) for angle in (inner - outer, TURN + outer - inner)] == [
        156.6,
        203.4,
    ]
    assert package("V_C", Motion((outer + inner) / 2, 0.15, CRANK, ROD, SPEED)) < 0
    grid = np.linspace(0.0, TURN, 36001)[:-1]
    curve = dx.evaluate("V_C", theta=grid, ec=0.15, AB=CRANK, BC=ROD, omega0=SPEED)
    falling = float(np.mean(curve < 0)) * 360
    assert falling == pytest.approx(156.6, abs=0.05)
    assert 360 - falling == pytest.approx(203.4, abs=0.05)
    assert peak("V_C", 0.15, kind="min")[0] > peak("V_C", 0.15, kind="max")[0]
    near_peaks = [float(np.mean(side > 0.9 * side.max())) * 360 for side in (-curve, curve)]
    assert near_peaks == pytest.approx([38.3, 54.9], abs=0.05)


def acceleration_of_signs(a, b, ec, theta):
    """a_C at alpha = 0 with signs of choice: `a` before a_C1, a_C3, a_C4, `b` before alpha_BC3 in Eq. 14."""
    phi = A.printed_eq6(theta, ec, CRANK, ROD)
    alpha_BC = A.alpha_BC_of_signs((1, 1, b), theta, ec, CRANK, ROD, SPEED, 0.0)
    first, last = A.printed_eq20(theta, CRANK, SPEED), A.printed_eq23(theta, ec, CRANK, ROD, SPEED)
    return a[0] * first - a[1] * ROD * alpha_BC * math.sin(phi) + a[2] * last


def test_97_percent():
    ways = {
        "max": max,
        "min": lambda curve: -min(curve),
        "abs": lambda curve: max(map(abs, curve)),
        "range": lambda curve: max(curve) - min(curve),
    }
    angles = [TURN * n / 1440 for n in range(1440)]
    increase = {}
    for a, b in itertools.product(itertools.product((1, -1), repeat=3), (1, -1)):
        before, after = ([acceleration_of_signs(a, b, ec, t) for t in angles] for ec in (0.0, 0.15))
        increase |= {(a, b, way): 100 * (f(after) / f(before) - 1) for way, f in ways.items()}
    assert len(increase) == 64
    assert not [choice for choice, percent in increase.items() if 96.5 <= percent < 97.5]
    nearest = min(increase.values(), key=lambda percent: abs(percent - 97))
    assert nearest == pytest.approx(increase[(1, 1, 1), -1, "max"], rel=1e-9) == pytest.approx(95.4, abs=0.05)


def test_what_stands_for_97_percent():
    outward, size = ([peak("a_C", ec, kind=kind)[0] for ec in (0.0, 0.15)] for kind in ("max", "abs"))
    assert [round(value, 1) for value in outward] == [2144.4, 4189.7]
    assert [round(value, 1) for value in size] == [4185.8, 4603.8]
    assert [round(100 * (after / before - 1)) for before, after in (outward, size)] == [95, 10]
    assert round(100 * (peak("a_C", 0.151, kind="max")[0] / outward[0] - 1)) == 97


def test_arguments_are_independent():
    for change in ({"ec": 0.1}, {"AB": 0.1}, {"BC": 0.4}):
        changed = Motion(1.0, 0.05, CRANK, ROD, SPEED)._replace(**change)
        assert close(SHEET.corrected_a_C(*changed[:4]), package("a_C", changed), 0, 12)
        assert close(SHEET.corrected_a_C(*changed[:4]), loop.truth("a_C", changed), 0, 12)
    assert turns_fully(0.2, 0.35)
    assert not turns_fully(0.2, 0.30)


def curves(names, ec, theta, BC=ROD):
    """Curves of the package over theta, NaN where the mechanism cannot be assembled."""
    found = dx.evaluate(list(names), theta=np.asarray(theta), ec=ec, AB=CRANK, BC=BC, omega0=SPEED)
    return [found[name] for name in names]


def turns_fully(ec, BC=ROD):
    """True if V_C exists on the whole turn, the two extreme angles included; checked by the raw loop."""
    angles = [n * math.pi / 360 for n in range(720)]
    reached = [bool(mp.im(loop.truth("Y", Motion(theta, ec, CRANK, BC, SPEED))) == 0) for theta in angles]
    assert np.isfinite(curves(["V_C"], ec, angles, BC)[0]).tolist() == reached
    return all(reached)


def test_three_rod_lengths():
    rods = (0.250, 0.300, 0.350)
    assert all(turns_fully(0.1, BC) for BC in rods)
    assert [round(BC - CRANK - 0.1, 3) for BC in rods] == [0.025, 0.075, 0.125]
    assert [round(peak("a_C", 0.1, BC=BC)[0]) for BC in rods] == [6445, 4627, 4353]


def top(ec):
    """a_C at theta = 90 deg, m/s2: the package's, equal to AB omega^2 tan(phi)."""
    value = package("a_C", Motion(math.pi / 2, ec, CRANK, ROD, SPEED))
    closed = CRANK * SPEED**2 * math.tan(math.asin((ec + CRANK) / ROD))
    assert value == pytest.approx(closed, rel=1e-6)
    return value


def test_no_highest_peak():
    trials = (0.22, 0.224, 0.2249)
    assert [round(peak("a_C", ec, samples=14400)[0]) for ec in trials] == [18057, 40714, 128996]
    assert all(peak("a_C", ec, samples=14400)[0] >= top(ec) * (1 - 1e-9) for ec in trials)
    for margin in (1e-5, 1e-6, 1e-7):
        assert top(0.225 - margin / 100) / top(0.225 - margin) == pytest.approx(10, rel=1e-3)
        assert close(
            top(0.225 - margin),
            loop.truth("a_C", Motion(math.pi / 2, 0.225 - margin, CRANK, ROD, SPEED)),
            0,
            9,
        )


STUCK = math.asin(0.96)  # where ec + AB sin(theta) = BC at ec = 0.23 m


def test_unfeasible_at_0_23():
    assert pytest.approx(-0.005) == ROD - CRANK - 0.23
    assert not turns_fully(0.23)
    assert turns_fully(0.22)
    assert turns_fully(0.2249999999)
    assert not turns_fully(0.2250000001)
    angles = [STUCK - 1e-6, STUCK + 1e-6, math.pi / 2, math.pi - STUCK - 1e-6, math.pi - STUCK + 1e-6]
    assert np.isnan(curves(["a_C"], 0.23, angles)[0]).tolist() == [False, True, True, True, False]
    assert [round(math.degrees(t), 2) for t in (STUCK, math.pi - STUCK)] == [73.74, 106.26]


def test_crank_stuck():
    near = Motion(STUCK - 1e-9, 0.23, CRANK, ROD, SPEED)
    assert package("phi", near) == pytest.approx(math.pi / 2, abs=1e-3)
    assert float(loop.truth("phi", near)) == pytest.approx(math.pi / 2, abs=1e-3)
    speeds = [abs(package("V_C", near._replace(theta=STUCK - gap))) for gap in (1e-4, 1e-6, 1e-8)]
    assert all(9 < later / earlier < 11 for earlier, later in itertools.pairwise(speeds))
    assert mp.im(loop.truth("Y", near._replace(theta=STUCK + 1e-9))) != 0


def test_velocity_has_the_same_gap():
    angles = np.linspace(0.0, TURN, 7201)
    velocity, acceleration = curves(["V_C", "a_C"], 0.23, angles)
    assert np.isnan(velocity).tolist() == np.isnan(acceleration).tolist()
    gone = np.degrees(angles[np.isnan(velocity)])
    assert (gone.min(), gone.max()) == pytest.approx((73.74, 106.26), abs=0.06)


def test_detection_by_gap():
    rng = random.Random(225)
    for _ in range(40):
        BC, ec = rng.uniform(0.15, 0.5), rng.choice([-1, 1]) * rng.uniform(0.0, 0.4)
        assert turns_fully(ec, BC) == (BC - CRANK - abs(ec) >= 0)
    plot = [TURN * n / 1001 for n in range(1001)]
    assert not np.isnan(curves(["V_C"], 0.2250001, plot)[0]).any()
    assert not turns_fully(0.2250001)
    gap = 2 * math.degrees(math.acos((ROD - 0.2250001) / CRANK))
    assert gap == pytest.approx(0.145, abs=5e-4)


def test_no_optimum_eccentricity():
    trials = [0.2 + 0.025 * (1 - 0.5**n) for n in range(12)]
    peaks = [peak("a_C", ec, samples=14400)[0] for ec in trials]
    assert peaks == sorted(peaks)
    assert len(set(peaks)) == len(peaks)
    assert top(0.225 - 1.6e-6) > 1e6


def test_velocity_does_not_show_the_acceleration_peak():
    bound = CRANK * SPEED * (1 + math.sqrt(ROD / CRANK))
    assert round(bound, 1) == 52.5
    trials = [0.0, 0.1, 0.2, 0.22, 0.2249, 0.22499, 0.2249999]
    speeds = [peak("V_C", ec, samples=14400)[0] for ec in trials]
    assert speeds == sorted(speeds)
    assert speeds[-1] < bound < speeds[-1] * 1.001
    gains = [
        peak(name, 0.22499, samples=14400)[0] / peak(name, 0.2249, samples=14400)[0] - 1
        for name in ("V_C", "a_C")
    ]
    assert gains == pytest.approx([0.018, 2.16], abs=5e-3)


def test_curves_are_cyclic():
    for motion in DESIGNS:
        steady, speeding = (
            motion._replace(alpha=0.0),
            motion._replace(alpha=abs(motion.alpha), theta=abs(motion.theta)),
        )
        for name in ("V_C", "a_C"):
            once, again = (package(name, steady._replace(theta=steady.theta + turn)) for turn in (0.0, TURN))
            assert close(again, once, scale_of("acceleration", steady), 12)
            first, second = (
                loop.truth(name, speeding._replace(theta=speeding.theta + turn)) for turn in (0.0, TURN)
            )
            assert abs(second - first) > 1e-3 * abs(first)
            assert abs(package(name, speeding._replace(theta=speeding.theta + TURN)) - first) > 1e-3 * abs(
                first
            )


def test_a_small_offset_is_as_smooth():
    """A tenth of the crank as offset raises the greatest acceleration by less than a thousandth."""
    centric = peak("a_C", 0.0)[0]
    assert centric == pytest.approx(4185.8, abs=0.05)
    assert [peak("a_C", ec)[0] for ec in (0.010, 0.0125)] == pytest.approx([4187.35, 4188.23], abs=0.05)
    assert peak("a_C", 0.0125)[0] < 1.001 * centric
