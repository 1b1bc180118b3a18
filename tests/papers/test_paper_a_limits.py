"""Paper A: the eccentricity as large as can be, where the peak has no bound, and beyond."""

import itertools
import random

import numpy as np
from mpmath import mp, mpf

from tests.papers import free_bodies, loop
from tests.papers.curves_a import curves, peak, percent, turns_fully
from tests.papers.designs import CASE, CRANK, SPEED, TURN, close, package
from tests.papers.free_bodies import Bodies
from tests.papers.loop import Motion
from tests.papers.proofs import proves

LIMIT = "0.225"  # m: BC - AB


def top(ec):
    """a_C where theta is 90 deg, m/s2, by the raw loop and by the package."""
    motion = Motion(mp.pi / 2, mpf(ec), mpf("0.125"), mpf("0.35"), mpf(SPEED))
    true = loop.truth("a_C", motion)
    assert close(package("a_C", Motion(*map(float, motion))), true, 0, 4)
    return true


@proves("A-claim-peak-at-0.22", "wrong claim", says="0.22")
def test_no_highest_peak():
    trials = ("0.22", "0.224", "0.2249")
    peaks = [peak("a_C", ec, steps=7200)[0] for ec in trials]
    assert all(value >= top(ec) for value, ec in zip(peaks, trials, strict=True))
    for margin in ("1e-5", "1e-7"):
        assert close(top(mpf(LIMIT) - mpf(margin) / 100) / top(mpf(LIMIT) - mpf(margin)), 10, 0, 3)
    near = mpf(LIMIT) - mpf("1e-9")
    names = {"AB": mpf("0.125"), "BC": mpf("0.35"), "omega": mpf(SPEED)}
    names |= {"phi": mp.asin((near + names["AB"]) / names["BC"])}
    shown = [peaks[0], mpf(trials[0]), *itertools.chain(*zip(peaks[1:], map(mpf, trials[1:]), strict=True))]
    return {
        "peaks": shown,
        "top": top(near),
        "limit": mpf(LIMIT),
        "last": [mpf("0.22"), mpf("0.23")],
        "names": names,
    }


def stuck():
    """The angle, rad, where the rod is at right angles to the slider axis with ec = 0.23 m."""
    return mp.asin((mpf("0.35") - mpf("0.23")) / mpf("0.125"))


def gap():
    """The angles between which no position exists with ec = 0.23 m, deg, by the package and the raw loop."""
    ends = stuck(), mp.pi - stuck()
    around = [end + way * 1e-6 for end in ends for way in (-1, 1)]
    assert np.isnan(curves(["a_C"], 0.23, list(map(float, around)))[0]).tolist() == [False, True, True, False]
    imaginary = [
        mp.im(loop.slider(Motion(a, mpf("0.23"), CRANK, mpf("0.35"), SPEED))[1]) != 0 for a in around
    ]
    assert imaginary == [False, True, True, False]
    return [mp.degrees(end) for end in ends]


@proves("A-claim-0.23-unfeasible", "correct", says="0.23")
def test_unfeasible_at_0_23():
    names = {"AB": mpf("0.125"), "BC": mpf("0.35"), "ec": mpf("0.23")}
    assert not turns_fully(0.23)
    assert turns_fully(0.22)
    assert turns_fully(0.2249999999)
    assert not turns_fully(0.2250000001)
    margin = names["BC"] - names["AB"] - names["ec"]
    return {"margin": margin, "limit": mpf(LIMIT), "gap": gap(), "names": names}


@proves("A-claim-crank-stuck", "correct")
def test_crank_stuck():
    near = Motion(stuck() - mpf("1e-9"), mpf("0.23"), mpf("0.125"), mpf("0.35"), mpf(SPEED))
    assert close(loop.truth("phi", near), mp.pi / 2, 0, 3)
    assert close(package("phi", Motion(*map(float, near))), mp.pi / 2, 0, 3)
    speeds = [
        abs(loop.truth("V_C", near._replace(theta=stuck() - mpf(gap)))) for gap in ("1e-4", "1e-6", "1e-8")
    ]
    assert all(9 < later / earlier < 11 for earlier, later in itertools.pairwise(speeds))
    return {"ec": near.ec, "stuck": [mp.sin(stuck()), mp.degrees(stuck())]}


@proves("A-claim-velocity-discontinuity", "correct", says="0.23")
def test_velocity_has_the_same_gap():
    angles = np.linspace(0.0, TURN, 7201)
    velocity, acceleration = curves(["V_C", "a_C"], 0.23, angles)
    assert np.isnan(velocity).tolist() == np.isnan(acceleration).tolist()
    gone = np.degrees(angles[np.isnan(velocity)])
    assert all(abs(end - angle) < 0.06 for end, angle in zip((gone.min(), gone.max()), gap(), strict=True))
    return {"gap": [*gap(), mpf("0.23")]}


@proves("A-claim-detection", "correct")
def test_detection_by_gap():
    rng = random.Random(225)
    for number in range(40):
        BC, ec = rng.uniform(0.15, 0.5), (-1) ** number * rng.uniform(0.0, 0.4)
        assert turns_fully(ec, BC) == (BC - CRANK - abs(ec) >= 0)
    ec, points = mpf("0.2250001"), 1001
    assert not turns_fully(float(ec))
    half = mp.degrees(mp.acos((mpf("0.35") - ec) / mpf("0.125")))

    def seen(steps):
        return [n for n in range(points) if abs(mpf(360) * n / steps - 90) < half]

    assert not seen(points)
    assert not np.isnan(curves(["V_C"], float(ec), [TURN * n / points for n in range(points)])[0]).any()
    step = mpf(360) / (points - 1)
    assert seen(points - 1) == [250]
    shown = {
        "blind": [ec, 2 * half],
        "points": [mpf(points), mpf(360), mpf(points)],
        "closed": [step, 250 * step],
    }
    return shown


@proves("A-claim-optimum", "wrong claim")
def test_no_optimum_eccentricity():
    trials = [mpf("0.2") + mpf("0.025") * (1 - mpf("0.5") ** n) for n in range(0, 12, 2)]
    peaks = [peak("a_C", ec, steps=7200)[0] for ec in trials]
    assert all(a < b for a, b in itertools.pairwise(peaks))
    bound = mpf("1e6")
    passed = mp.findroot(lambda margin: top(mpf(LIMIT) - margin) - bound, (mpf("1.6e-6"), mpf("1.7e-6")))
    return {"limit": mpf(LIMIT), "bound": [bound, passed]}


@proves("A-claim-force", "wrong claim", cites="2")
def test_acceleration_is_not_the_force_on_the_material():
    mass, load = mpf(1), mpf(1000)
    free, loaded = (free_bodies.solve(CASE, Bodies(m_slider=mass, F_Y=push))["F_C_Y"] for push in (0, load))
    a_C = loop.truth("a_C", CASE)
    assert close(free, mass * a_C, 0, 30)
    names = {"F_C": loaded, "m_slider": mass, "a_C": a_C}
    return {"mass": mass, "free": free, "loaded": loaded, "load": load, "press": -load, "names": names}


@proves("A-claim-either-function", "wrong claim")
def test_velocity_does_not_show_the_acceleration_peak():
    AB, BC = mpf("0.125"), mpf("0.35")
    bound = AB * mpf(SPEED) * (1 + mp.sqrt(BC / AB))
    speeds = [
        peak("V_C", ec, steps=7200)[0] for ec in ("0", "0.1", "0.2", "0.22", "0.2249", "0.22499", "0.2249999")
    ]
    assert speeds == sorted(speeds)
    assert speeds[-1] < bound < speeds[-1] * mpf("1.001")
    ends = "0.2249", "0.22499"
    gains = [percent(*(peak(name, ec, steps=7200)[0] for ec in reversed(ends))) for name in ("V_C", "a_C")]
    names = {"AB": AB, "BC": BC, "omega": mpf(SPEED)}
    return {"bound": bound, "gains": [*map(mpf, ends), *gains], "names": names}
