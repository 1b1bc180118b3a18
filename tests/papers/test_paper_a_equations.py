"""Paper A: every numbered equation and every line of its listing."""

import itertools
import math

import pytest
from mpmath import mp, mpf

from tests.papers import free_bodies, loop
from tests.papers import paper_a as A
from tests.papers.designs import (
    CASE,
    DESIGNS,
    SPEED,
    agrees,
    close,
    differs,
    exact_point,
    float_point,
    package,
    paper_frame,
    scale_of,
    three_digits,
)
from tests.papers.proofs import proves

RESULTS = [-20.2, -7740.0, -994.0]  # V_C, alpha_BC and a_C of the test cases, as printed

# --- numbered equations ---------------------------------------------------------------------------


def carried(motion, order):
    """Rates of a moving crank centre A and of the pin it carries, X and Y, in the package's frame."""

    def centre(t):
        return mpf("0.3") * t - t * t, mpf("0.2") * t + t * t / 2

    def carried_pin(t):
        return tuple(a + b for a, b in zip(centre(t), loop.pin(motion, t), strict=True))

    def rates(position):
        return tuple(loop.rate(lambda t, axis=axis: position(t)[axis], order) for axis in (0, 1))

    return rates(centre), rates(carried_pin)


@proves("A-eq1", "correct")
def test_eq1():
    for motion in DESIGNS:
        with mp.workdps(loop.DIGITS):
            V_A, V_B = carried(motion, 1)
            (x, y), omega = loop.pin(motion), loop.omega(motion)
            turning = omega * y, -omega * x
            got = A.printed_eq1(V_A, turning)
            assert all(close(g, v, scale_of("velocity", motion), 30) for g, v in zip(got, V_B, strict=True))
        at_rest = A.printed_eq1((0.0, 0.0), tuple(map(float, turning)))
        assert at_rest == pytest.approx((package("V_B_X", motion), package("V_B_Y", motion)), rel=1e-12)


@proves("A-eq2", "correct")
def test_eq2():
    agrees(
        lambda p: A.printed_eq2(p.theta, p.AB, p.omega, p.m), lambda q, p: paper_frame(q, "V_B"), "velocity"
    )


@proves("A-eq3", "correct")
def test_eq3():
    for motion in DESIGNS:
        with mp.workdps(loop.DIGITS):
            a_A, a_B = carried(motion, 2)
            (x, y), omega, alpha = loop.pin(motion), loop.omega(motion), mpf(motion.alpha)
            normal, tangential = (-(omega**2) * x, -(omega**2) * y), (alpha * y, -alpha * x)
            got = A.printed_eq3(a_A, normal, tangential)
            assert all(
                close(g, a, scale_of("acceleration", motion), 30) for g, a in zip(got, a_B, strict=True)
            )
        at_rest = tuple(map(float, A.printed_eq3((0, 0), normal, tangential)))
        scale = 1e-12 * scale_of("acceleration", motion)
        assert at_rest == pytest.approx(
            (package("a_B_X", motion), package("a_B_Y", motion)), rel=0, abs=scale
        )


@proves("A-eq4", "correct", cites="2")
def test_eq4():
    agrees(
        lambda p: A.printed_eq4(p.theta, p.AB, p.omega, p.alpha, p.m),
        lambda q, p: paper_frame(q, "a_B"),
        "acceleration",
    )


@proves("A-eq5", "correct")
def test_eq5():
    agrees(lambda p: A.printed_eq5(*p.design, p.m), lambda q, p: q("delta"), "angle")
    agrees(lambda p: p.m.pi / 2 - A.printed_eq5(*p.design, p.m), lambda q, p: q("phi"), "angle")


@proves("A-eq6", "correct")
def test_eq6():
    agrees(lambda p: A.printed_eq6(*p.design, p.m), lambda q, p: q("phi"), "angle")


@proves("A-eq7", "correct")
def test_eq7():
    agrees(lambda p: A.printed_eq7(*p.design, p.m), lambda q, p: q("Y"), "length")
    for motion in DESIGNS:
        with mp.workdps(loop.DIGITS):
            p = exact_point(motion)
            rod = mp.hypot(p.side, A.printed_eq7(*p.design, mp) - p.pin_height)
            assert close(rod, p.BC, 0, 30)


@proves("A-eq8", "correct")
def test_eq8():
    def velocity(p):
        omega_BC = A.printed_eq10(*p.design, p.omega, p.m)
        turning = omega_BC * (A.printed_eq7(*p.design, p.m) - p.pin_height), omega_BC * p.side
        return A.printed_eq8((0, A.printed_eq11(*p.design, p.omega, p.m)), turning)

    agrees(velocity, lambda q, p: (q("V_B_X"), q("V_B_Y")), "velocity")


@proves("A-eq9", "correct", cites="2")
def test_eq9():
    agrees(
        lambda p: A.printed_eq2(p.theta, p.AB, p.omega, p.m),
        lambda q, p: A.printed_eq9(q("phi"), p.BC, q("omega_BC"), q("V_C"), p.m),
        "velocity",
    )


@proves("A-eq10", "correct")
def test_eq10():
    agrees(lambda p: A.printed_eq10(*p.design, p.omega, p.m), lambda q, p: q("omega_BC"), "rate")
    motion = DESIGNS[0]
    turn = loop.rate(lambda t: free_bodies.turn_of_rod(motion, t), 1)
    return {"turn": turn, "names": {"omega_BC": loop.truth("omega_BC", motion)}}


@proves("A-eq11", "correct")
def test_eq11():
    agrees(lambda p: A.printed_eq11(*p.design, p.omega, p.m), lambda q, p: q("V_C"), "velocity")


@proves("A-eq12", "correct", cites="2")
def test_eq12():
    def acceleration(p):
        omega_BC = A.printed_eq10(*p.design, p.omega, p.m)
        alpha_BC = A.printed_eq14(*p.design, p.omega, p.alpha, p.m)
        a_C = A.corrected_eq19(*p.design, p.omega, p.alpha, p.m)
        across, along = p.side, A.printed_eq7(*p.design, p.m) - p.pin_height
        tangential = alpha_BC * along, alpha_BC * across
        return A.printed_eq12((0, a_C), tangential, (-(omega_BC**2) * across, omega_BC**2 * along))

    agrees(acceleration, lambda q, p: (q("a_B_X"), q("a_B_Y")), "acceleration")


@proves("A-eq13", "correct", cites="19")
def test_eq13():
    agrees(
        lambda p: A.printed_eq4(p.theta, p.AB, p.omega, p.alpha, p.m),
        lambda q, p: A.printed_eq13(q("phi"), p.BC, q("omega_BC"), q("alpha_BC"), q("a_C"), p.m),
        "acceleration",
    )


@proves("A-eq14", "correct")
def test_eq14():
    agrees(lambda p: A.printed_eq14(*p.design, p.omega, p.alpha, p.m), lambda q, p: q("alpha_BC"), "rate2")


def alpha_part(q, p, axis):
    """The part of the pin's acceleration due to alpha, in the package's frame: along the pin's velocity."""
    return q(f"V_B_{axis}") * p.alpha / p.omega


@proves("A-eq15", "correct")
def test_eq15():
    agrees(
        lambda p: A.printed_eq15(p.theta, p.AB, p.omega, p.m),
        lambda q, p: q("a_B_X") - alpha_part(q, p, "X"),
        "acceleration",
    )


@proves("A-eq16", "correct")
def test_eq16():
    agrees(
        lambda p: A.printed_eq16(p.theta, p.AB, p.alpha, p.m),
        lambda q, p: alpha_part(q, p, "X"),
        "acceleration",
    )


@proves("A-eq17", "correct")
def test_eq17():
    agrees(
        lambda p: A.printed_eq17(*p.design, p.omega, p.m),
        lambda q, p: -(q("omega_BC") ** 2) * p.side,
        "acceleration",
    )


@proves("A-eq18", "correct")
def test_eq18():
    agrees(lambda p: A.printed_eq18(*p.design, p.m), lambda q, p: q("Y") - p.pin_height, "length")


@proves("A-eq19", "sign", cites="22 23 13 2 19 22 23")
def test_eq19():
    agrees(
        lambda p: A.corrected_eq19(*p.design, p.omega, p.alpha, p.m), lambda q, p: q("a_C"), "acceleration"
    )
    agrees(
        lambda p: A.printed_eq19(*p.design, p.omega, p.alpha, p.m),
        lambda q, p: 2 * q("a_B_Y") - q("a_C"),  # what the two wrong signs make of it
        "acceleration",
    )
    differs(lambda p: A.printed_eq19(*p.design, p.omega, p.alpha), "a_C")
    for motion in DESIGNS:
        one, two, three, four = A.a_C_parts(*float_point(motion)[:6])
        with_eqs_22_and_23_turned = one + two - (-three) - (-four)
        assert close(with_eqs_22_and_23_turned, package("a_C", motion), scale_of("acceleration", motion), 12)
    run, tried = signs_that_were_run()
    assert run == [((-1, -1), (1, -1), (1, 1, 1))]
    p = exact_point(CASE)
    all_plus = A.corrected_eq19(*p.design, p.omega, 0, mp)
    values = {"choices": mpf(tried), "three": list(map(mpf, RESULTS)), "plain": mpf(RESULTS[2])}
    return case_as_printed() | values | {"all_plus": all_plus}


def case_as_printed():
    """a_C of test case 2 by Eq. 19 and by the listing as printed, which agree, m/s2."""
    sheet = A.Worksheet(mpf(SPEED), 0, mp)
    p = exact_point(CASE)
    by_equation, by_listing = A.printed_eq19(*p.design, p.omega, 0, mp), sheet.a_C(*CASE[:4])
    assert close(by_equation, by_listing, 1, 30)
    return {"as_printed": by_listing}


@proves("A-eq20", "correct")
def test_eq20():
    agrees(
        lambda p: A.printed_eq20(p.theta, p.AB, p.omega, p.m),
        lambda q, p: q("a_B_Y") - alpha_part(q, p, "Y"),
        "acceleration",
    )


@proves("A-eq21", "correct")
def test_eq21():
    agrees(
        lambda p: A.printed_eq21(p.theta, p.AB, p.alpha, p.m),
        lambda q, p: alpha_part(q, p, "Y"),
        "acceleration",
    )


@proves("A-eq22", "correct", cites="13 19")
def test_eq22():
    agrees(
        lambda p: A.printed_eq22(*p.design, p.omega, p.alpha, p.m),
        lambda q, p: -q("alpha_BC") * p.side,
        "acceleration",
    )


@proves("A-eq23", "correct", cites="13 19")
def test_eq23():
    agrees(
        lambda p: A.printed_eq23(*p.design, p.omega, p.m),
        lambda q, p: -(q("omega_BC") ** 2) * (q("Y") - p.pin_height),
        "acceleration",
    )


@proves("A-eq24", "correct", cites="A-claim-sensitivity-functions")
def test_eq24():
    agrees(lambda p: A.printed_eq24(*p.design, p.sheet), lambda q, p: q("V_C"), "velocity")
    faster = A.Worksheet(2 * SPEED, 0.0)
    assert A.printed_eq24(*CASE[:4], faster) == pytest.approx(2 * package("V_C", CASE), rel=1e-12)


@proves("A-eq25", "correct", cites="24 A-claim-sensitivity-functions")
def test_eq25():
    agrees(lambda p: A.printed_eq25(*p.design, p.sheet), lambda q, p: q("a_C"), "acceleration")
    faster, accelerating = A.Worksheet(2 * SPEED, 0.0), A.Worksheet(SPEED, 1000.0)
    assert A.printed_eq25(*CASE[:4], faster) == pytest.approx(4 * package("a_C", CASE), rel=1e-12)
    assert A.printed_eq25(*CASE[:4], accelerating) == pytest.approx(
        package("a_C", CASE._replace(alpha=1000.0)), rel=1e-12
    )


def signs_that_were_run():
    """Signs of the terms present without alpha that print the three results, and the number tried."""
    theta, ec, AB, BC, omega = float_point(CASE)[:5]
    phi = A.printed_eq6(theta, ec, AB, BC)
    centripetal = BC * A.printed_eq10(theta, ec, AB, BC, omega) ** 2 * math.cos(phi)
    choices = list(itertools.product(*(itertools.product((1, -1), repeat=n) for n in (2, 2, 3))))
    run = []
    for v, b, c in choices:
        V_C = A.V_C_of_signs(v, theta, ec, AB, BC, omega)
        alpha_BC = A.alpha_BC_of_signs((b[0], 1, b[1]), theta, ec, AB, BC, omega, 0.0)
        parts = -AB * omega**2 * math.cos(theta), -BC * alpha_BC * math.sin(phi), -centripetal
        a_C = sum(sign * part for sign, part in zip(c, parts, strict=True))
        if [three_digits(x) for x in (V_C, alpha_BC, a_C)] == RESULTS:
            run.append((v, b, c))
    return run, len(choices)
