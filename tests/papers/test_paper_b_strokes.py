"""Paper B: dead centres, strokes and their times."""

import math

import pytest
from mpmath import mp, mpf

import desaxe as dx
from tests.papers import curves_b as curves
from tests.papers import loop
from tests.papers import paper_b as B
from tests.papers.curves_b import SPEED, case_1, dead_centres, degrees, peaks, stroke
from tests.papers.designs import TURN, close
from tests.papers.designs_b import OFFSETS, TABLE_1, in_stroke, sweep, table_1
from tests.papers.proofs import proves

K, C, E = TABLE_1["k"], TABLE_1["c"], OFFSETS[-1]


# --- dead centres, stroke, time ratio -------------------------------------------------------------


@pytest.mark.parametrize("e", curves.OFFSETS)
def test_dead_centres(e):
    """Both closed angles stop the slider of the raw loop, and the closed stroke is the way between them."""
    with mp.workdps(loop.DIGITS):
        q = case_1(mpf(0), e)
        far, near = (curves.motion_of(q._replace(theta=angle)) for angle in dead_centres(e))
        for motion in (far, near):
            assert abs(loop.truth("V_C", motion)) < mpf(10) ** -30
        assert loop.truth("a_C", far) < 0 < loop.truth("a_C", near)
        assert close(stroke(e), 1000 * (loop.truth("Y", far) - loop.truth("Y", near)), 0, 30)
    way = [dx.peak("Y", kind=kind, ec=e / 1000, AB=K, BC=C, omega0=SPEED)["value"] for kind in ("max", "min")]
    assert way[0] - way[1] == pytest.approx(float(stroke(e)) / 1000, rel=1e-12)


@proves("B-text-stroke", "correct", says="The distance from C_1 to C_2 is known as the stroke")
def test_stroke_of_a_design():
    """Between the places where the slider stops, over a whole turn."""
    far, near = (B.printed_eq8(case_1(angle)) for angle in dead_centres())
    assert close(1000 * (far - near), stroke(), 0, 30)
    assert all(near <= B.printed_eq8(case_1(mpf(angle))) <= far for angle in sweep(360))


CENTRES = (
    "The slider block moves between two centers C_1 and C_2 which correspond to Bottom Dead Centre (BDC) and"
    " Top Dead Centre (TDC)"
)


@proves("B-text-dead-centres", "correct", says=CENTRES, cites="1 1")
def test_slider_moves_between_the_dead_centres():
    """It stops at both, changes its direction there, and is nowhere beyond either."""
    far, near = (B.printed_eq8(case_1(angle)) for angle in dead_centres())
    assert all(near <= B.printed_eq8(case_1(angle)) <= far for angle in sweep())
    for angle in dead_centres():
        before, after = (B.printed_eq13(case_1(angle + mpf(step))) for step in (-1e-4, 1e-4))
        assert before * after < 0
    return {"centres": degrees(*dead_centres())}


@proves("B-eq49", "wrong claim", cites="1")
@proves("B-claim-stroke", "wrong claim", says="80 0.08 80")
@proves("B-table1-S", "wrong claim", says="Maximum Stroke [S] 80 Mm", cites="B-claim-stroke")
def test_eq49():
    assert close(1000 * B.printed_eq49(case_1(mpf(0)).k), stroke(0), 0, 30)
    assert stroke(20) > stroke(10) > stroke(0)
    assert stroke(20, 128) > mpf("81.1")  # the nearest reading of Eq. 50 does not save the 80 mm either
    strokes = [stroke(20), mpf(20), stroke(10), mpf(10)]
    return {
        "strokes": strokes,
        "stroke": strokes[:2],
        "closed": stroke(20),
        "centric": stroke(0),
        "alone": stroke(),
    }


@proves("B-eq50", "wrong claim", cites="1 1 1")
@proves("B-claim-lengths", "wrong claim", says="49 50", cites="50")
def test_eq50():
    """As printed the rod's length follows the offset: none without one, and too short for 10 mm."""
    c, k = mpf(64), mpf(40)
    assert B.printed_eq50(20) == c
    assert B.printed_eq50(0) == 0
    short = mpf("3.2") * 10
    result = dx.evaluate(
        ("Y", "status"), theta=math.pi / 2, ec=0.010, AB=K, BC=float(short) / 1000, omega0=SPEED
    )
    assert result["status"] == 1
    read = mpf("3.2") * k
    return {"c": c, "at_20": [c, mpf(20)], "short": [mpf(10), short], "read": read, "names": {"k": k}}


@proves("B-eq51", "correct")
def test_eq51():
    """Of times or of crank angles, the same at constant speed."""
    for e in OFFSETS[1:]:
        outer, inner = B.dead_centres(e, K, C)
        angles = TURN - (inner - outer), inner - outer
        times = [angle / SPEED for angle in angles]
        assert B.printed_eq51(*angles) == pytest.approx(B.printed_eq51(*times), rel=1e-12)
        steps = [in_stroke(e, K, C, angle) for angle in sweep()]
        assert steps.count(1) / steps.count(-1) == pytest.approx(B.time_ratio(e, K, C), rel=2e-3)
        signs = [math.copysign(1, -B.printed_eq13(case_1(angle, 1000 * e))) for angle in sweep()]
        assert sum(a != b for a, b in zip(signs, steps, strict=True)) <= 1


def returned(e=20, c=64):
    """Crank angle of the return stroke, deg."""
    outer, inner = dead_centres(e, c)
    return mp.degrees(inner - outer)


def ratio(e=20, c=64):
    """Time of the advance stroke over that of the return stroke."""
    return (360 - returned(e, c)) / returned(e, c)


MILLISECONDS = {12: "172.57", 13: "186.96", 25: "359.53"}  # ms: the angle printed, deg


@proves("B-claim-time-ratio", "wrong claim", says="1.08", cites="1 B-claim-return-angle")
def test_time_ratio():
    """As printed it is that of whole milliseconds; even the rod of 3.2 crank lengths has another."""
    times = [mpf(ms) / 1000 for ms in (13, 12)]
    assert mp.nstr(times[0] / times[1], 3) == "1.08"
    assert mp.nstr(ratio(20, 128), 3) != "1.08"
    result = {"ratio": ratio(), "centres": degrees(*dead_centres()), "angles": [360 - returned(), returned()]}
    rod = [mpf("3.2") * 40, ratio(20, 128)]
    return result | {
        "milliseconds": [times[0] / times[1], *times],
        "rod": rod[0],
        "read": rod,
        "names": {"k": mpf(40)},
    }


@proves("B-claim-quick-return", "correct")
def test_quick_return():
    return {"ratios": [ratio(20), mpf(20), ratio(10), mpf(10), ratio(0)]}


@proves("B-text-time-constant", "typo")
def test_time_ratio_has_no_unit():
    """A time constant would change with the speed; this ratio does not."""
    outer, inner = B.dead_centres(E, K, C)
    for speed in (SPEED, 10 * SPEED):
        away, back = (TURN - inner + outer) / speed, (inner - outer) / speed
        assert B.printed_eq51(away, back) == pytest.approx(float(ratio()), rel=1e-12)


def milliseconds():
    """The printed angles are 251 rad/s times whole milliseconds."""
    turned = {ms: mp.degrees(mpf(SPEED) * ms / 1000) for ms in MILLISECONDS}
    assert all(abs(angle - mpf(MILLISECONDS[ms])) < mpf("0.006") for ms, angle in turned.items())
    fastest = peaks(B.printed_eq13)[0]
    for angle in ("0", *MILLISECONDS.values()):  # none is a dead centre: there the slider moves
        assert abs(B.printed_eq13(case_1(mp.radians(mpf(angle))))) > fastest / 10
    return turned


@proves("B-claim-return-angle", "wrong claim", says="172.57")
def test_return_angle():
    turned = milliseconds()
    inner = mp.degrees(dead_centres(20, 128)[1])
    product = [turned[12], mpf(SPEED), mpf(12) / 1000]
    return {"angle": returned(), "product": product, "read": [mpf(128), inner]}


@proves("B-claim-advance-angle", "wrong claim", says="186.96")
def test_advance_angle():
    milliseconds()
    both = [mpf(MILLISECONDS[12]), mpf(MILLISECONDS[12]) + mpf(MILLISECONDS[13])]
    return {"angle": 360 - returned(), "product": [mpf(SPEED), mpf(13) / 1000], "both": both}


def time_of(angle):
    """Time of a crank angle in deg, s."""
    return mp.radians(angle) / SPEED


@proves("B-claim-return-time", "wrong claim", says="0.12")
def test_return_time():
    printed, period = mpf("0.12"), mpf(60) / 2400
    assert 4.5 < printed / period < 5
    assert time_of(returned()) < mpf(12) / 1000
    return {
        "time": time_of(returned()),
        "printed_time": printed,
        "belongs": [mpf(MILLISECONDS[12]), mpf(12) / 1000],
    }


@proves("B-claim-advance-time", "wrong claim", says="0.13", cites="B-claim-return-time")
def test_advance_time():
    milliseconds()
    return {"time": time_of(360 - returned()), "belongs": [mpf(MILLISECONDS[13]), mpf(13) / 1000]}


@proves(
    "B-claim-advance-range",
    "wrong claim",
    says="forward stroke ... corresponds to crank angle range of 172.57 deg - 359.53 deg",
)
def test_advance_range():
    turned, (outer, inner) = milliseconds(), degrees(*dead_centres())
    return {"range": [inner, 360 + outer], "product": [turned[25], mpf(SPEED), mpf(25) / 1000]}


@proves(
    "B-claim-return-range",
    "wrong claim",
    says="return stroke ... corresponds to crank angle range of 0 deg - 172.57 deg",
)
def test_return_range():
    milliseconds()
    return {"range": degrees(*dead_centres())}


@proves("B-claim-directions", "correct")
def test_directions():
    """Anticlockwise with the slider's axis below the crank: the short stroke goes left, inwards."""
    for angle, sign in ((60, -1), (240, 1)):
        assert in_stroke(E, K, C, math.radians(angle)) == sign
        assert float(loop.truth("V_C", table_1(math.radians(angle), E))) * sign > 0
    assert returned(20) < 180 < returned(-20)  # the axis above the crank turns it round


@proves("B-claim-period", "correct", cites="B-claim-advance-range")
def test_period():
    period, rounded = mpf(60) / 2400, 2 * mp.pi / SPEED
    assert close(mp.degrees(period * SPEED), mpf(MILLISECONDS[25]), 0, 4)
    result = {"exact": [mpf(60), mpf(2400)], "rounded": [mpf(SPEED), rounded]}
    return result | {"short": [period, mp.degrees(period * SPEED)], "printed": [period, mpf(360)]}
