"""Paper B: the curves of position, velocity and acceleration."""

import itertools
import math

import pytest
from mpmath import mp, mpf

import desaxe as dx
from tests.papers import paper_b as B
from tests.papers.curves_b import SPEED, case_1, dead_centres, degrees, peaks
from tests.papers.designs import TURN
from tests.papers.designs_b import OFFSETS, TABLE_1, sweep, table_1
from tests.papers.proofs import proves

K, C, E = TABLE_1["k"], TABLE_1["c"], OFFSETS[-1]


def harmonics(function, count=5, steps=360):
    """Cosine and sine amplitudes of the first harmonics: the sums converge as fast as the curve is smooth."""
    with mp.workdps(20):
        angles = [2 * mp.pi * n / steps for n in range(steps)]
        values = [function(case_1(angle)) for angle in angles]
        waves = [[(mp.cos(n * a), mp.sin(n * a)) for a in angles] for n in range(1, count + 1)]
        return [
            tuple(2 * mp.fdot(values, part) / steps for part in zip(*wave, strict=True)) for wave in waves
        ]


@proves("B-claim-not-sinusoidal", "correct")
def test_not_sinusoidal():
    shares = []
    for function in (B.printed_eq13, B.corrected_eq20):
        first, second = (mp.hypot(*pair) for pair in harmonics(function, 2))
        shares.append(100 * second / first)
    return {"shares": shares}


@proves("B-claim-return-faster", "correct")
def test_return_is_faster():
    back, away = peaks(B.printed_eq13)
    for kind, size in (("min", -back), ("max", away)):
        peak = dx.peak("V_C", kind=kind, ec=E, AB=K, BC=C, omega0=SPEED)["value"]
        assert peak == pytest.approx(float(size), rel=1e-9)
    return {"speeds": [back, away]}


@proves("B-claim-acceleration-direction", "wrong claim")
def test_acceleration_changes_sign_within_each_stroke():
    """Every stroke starts with an acceleration along it and ends with one against it."""
    (outer, inner), shares = dead_centres(), []
    for low, high, sign in ((outer, inner, 1), (inner, outer + 2 * mp.pi, -1)):
        assert [mp.sign(B.corrected_eq20(case_1(end))) for end in (low, high)] == [sign, -sign]
        turned = mp.findroot(lambda t: B.corrected_eq20(case_1(t)), (low, high), solver="anderson")
        inside = [B.corrected_eq20(case_1(low + (high - low) * n / 360)) > 0 for n in range(361)]
        assert sum(a != b for a, b in itertools.pairwise(inside)) == 1
        shares.append(100 * (turned - low if sign == 1 else high - turned) / (high - low))
    return {"greatest": list(peaks(B.corrected_eq20)), "shares": shares}


@proves("B-claim-rod-period", "correct")
def test_rod_has_the_period_of_the_crank():
    for angle in sweep(36):
        here, later = (dx.evaluate("omega_BC", **table_1(a, E)._asdict()) for a in (angle, angle + TURN))
        assert later == pytest.approx(here, rel=0, abs=1e-9)
        half = dx.evaluate("omega_BC", **table_1(angle + math.pi, E)._asdict())
        assert abs(half - here) > 1e-3 or abs(here) < 40


@proves("B-claim-rod-cosine", "correct", cites="9 10")
def test_rod_curves():
    """The rod's rate is led by a cosine; its acceleration by a reversed sine, without that cosine."""
    rate, growth = harmonics(B.printed_eq27), harmonics(B.corrected_eq30, 1)
    assert abs(rate[0][1]) < mpf("1e-9")
    assert abs(growth[0][0]) < mpf("1e-6")
    assert all(mp.hypot(*pair) < rate[0][0] / 5 for pair in rate[1:])
    return {"rate": rate[0][0], "growth": growth[0][1]}


@proves("B-claim-steeper-slider", "correct", says="7")
def test_steeper_slider():
    """Slopes of the slider's velocity by stroke, and where its curve bends in the forward stroke."""
    (_, inner), slope = dead_centres(), B.corrected_eq20

    def jerk(angle):
        return mp.diff(lambda t: slope(case_1(t)), angle)

    forward = [inner + (mp.mpf(225) * n / 90 + 1) * mp.pi / 180 for n in range(90)]
    grows = [jerk(angle) > 0 for angle in forward]
    bends = [
        mp.findroot(jerk, pair, solver="anderson")
        for pair, (a, b) in zip(itertools.pairwise(forward), itertools.pairwise(grows), strict=True)
        if a != b
    ]
    return {"slopes": list(peaks(slope)), "bends": degrees(*bends)}


@proves("B-claim-steeper-rod", "correct")
def test_steeper_rod():
    """Slopes over time of the rod's angular velocity and of its angular acceleration, by stroke."""

    def change(q):
        def growth(theta):
            return B.corrected_eq30(q._replace(theta=theta))

        step = 1e-5 if q.m is math else mpf("1e-15")
        return q.omega * (growth(q.theta + step) - growth(q.theta - step)) / (2 * step)

    with mp.workdps(60):
        return {"rate": list(peaks(B.corrected_eq30)), "growth": list(peaks(change))}
