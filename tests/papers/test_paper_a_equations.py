"""Paper A: every numbered equation and every line of its listing."""

import itertools
import math

import pytest
from mpmath import mp, mpf

from tests.papers import loop
from tests.papers import paper_a as A
from tests.papers.designs import (
    CASE,
    DESIGNS,
    SHEET,
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


def test_eq2():
    agrees(
        lambda p: A.printed_eq2(p.theta, p.AB, p.omega, p.m), lambda q, p: paper_frame(q, "V_B"), "velocity"
    )


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


def test_eq4():
    agrees(
        lambda p: A.printed_eq4(p.theta, p.AB, p.omega, p.alpha, p.m),
        lambda q, p: paper_frame(q, "a_B"),
        "acceleration",
    )


def test_eq5():
    agrees(lambda p: A.printed_eq5(*p.design, p.m), lambda q, p: q("delta"), "angle")
    agrees(lambda p: p.m.pi / 2 - A.printed_eq5(*p.design, p.m), lambda q, p: q("phi"), "angle")


def test_eq6():
    agrees(lambda p: A.printed_eq6(*p.design, p.m), lambda q, p: q("phi"), "angle")


def test_eq7():
    agrees(lambda p: A.printed_eq7(*p.design, p.m), lambda q, p: q("Y"), "length")
    for motion in DESIGNS:
        with mp.workdps(loop.DIGITS):
            p = exact_point(motion)
            rod = mp.hypot(p.side, A.printed_eq7(*p.design, mp) - p.pin_height)
            assert close(rod, p.BC, 0, 30)


def test_eq8():
    def velocity(p):
        omega_BC = A.printed_eq10(*p.design, p.omega, p.m)
        turning = omega_BC * (A.printed_eq7(*p.design, p.m) - p.pin_height), omega_BC * p.side
        return A.printed_eq8((0, A.printed_eq11(*p.design, p.omega, p.m)), turning)

    agrees(velocity, lambda q, p: (q("V_B_X"), q("V_B_Y")), "velocity")


def test_eq9():
    agrees(
        lambda p: A.printed_eq2(p.theta, p.AB, p.omega, p.m),
        lambda q, p: A.printed_eq9(q("phi"), p.BC, q("omega_BC"), q("V_C"), p.m),
        "velocity",
    )


def test_eq10():
    agrees(lambda p: A.printed_eq10(*p.design, p.omega, p.m), lambda q, p: q("omega_BC"), "rate")


def test_eq11():
    agrees(lambda p: A.printed_eq11(*p.design, p.omega, p.m), lambda q, p: q("V_C"), "velocity")


def test_eq12():
    def acceleration(p):
        omega_BC = A.printed_eq10(*p.design, p.omega, p.m)
        alpha_BC = A.printed_eq14(*p.design, p.omega, p.alpha, p.m)
        a_C = A.corrected_eq19(*p.design, p.omega, p.alpha, p.m)
        across, along = p.side, A.printed_eq7(*p.design, p.m) - p.pin_height
        tangential = alpha_BC * along, alpha_BC * across
        return A.printed_eq12((0, a_C), tangential, (-(omega_BC**2) * across, omega_BC**2 * along))

    agrees(acceleration, lambda q, p: (q("a_B_X"), q("a_B_Y")), "acceleration")


def test_eq13():
    agrees(
        lambda p: A.printed_eq4(p.theta, p.AB, p.omega, p.alpha, p.m),
        lambda q, p: A.printed_eq13(q("phi"), p.BC, q("omega_BC"), q("alpha_BC"), q("a_C"), p.m),
        "acceleration",
    )


def test_eq14():
    agrees(lambda p: A.printed_eq14(*p.design, p.omega, p.alpha, p.m), lambda q, p: q("alpha_BC"), "rate2")


def alpha_part(q, p, axis):
    """The part of the pin's acceleration due to alpha, in the package's frame: along the pin's velocity."""
    return q(f"V_B_{axis}") * p.alpha / p.omega


def test_eq15():
    agrees(
        lambda p: A.printed_eq15(p.theta, p.AB, p.omega, p.m),
        lambda q, p: q("a_B_X") - alpha_part(q, p, "X"),
        "acceleration",
    )


def test_eq16():
    agrees(
        lambda p: A.printed_eq16(p.theta, p.AB, p.alpha, p.m),
        lambda q, p: alpha_part(q, p, "X"),
        "acceleration",
    )


def test_eq17():
    agrees(
        lambda p: A.printed_eq17(*p.design, p.omega, p.m),
        lambda q, p: -(q("omega_BC") ** 2) * p.side,
        "acceleration",
    )


def test_eq18():
    agrees(lambda p: A.printed_eq18(*p.design, p.m), lambda q, p: q("Y") - p.pin_height, "length")


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
    point = float_point(CASE)
    assert A.printed_eq19(*point.design, point.omega, 0.0) == pytest.approx(-2090.66, abs=0.01)
    for motion in DESIGNS:
        one, two, three, four = A.a_C_parts(*float_point(motion)[:6])
        with_eqs_22_and_23_turned = one + two - (-three) - (-four)
        assert close(with_eqs_22_and_23_turned, package("a_C", motion), scale_of("acceleration", motion), 12)


def test_eq20():
    agrees(
        lambda p: A.printed_eq20(p.theta, p.AB, p.omega, p.m),
        lambda q, p: q("a_B_Y") - alpha_part(q, p, "Y"),
        "acceleration",
    )


def test_eq21():
    agrees(
        lambda p: A.printed_eq21(p.theta, p.AB, p.alpha, p.m),
        lambda q, p: alpha_part(q, p, "Y"),
        "acceleration",
    )


def test_eq22():
    agrees(
        lambda p: A.printed_eq22(*p.design, p.omega, p.alpha, p.m),
        lambda q, p: -q("alpha_BC") * p.side,
        "acceleration",
    )


def test_eq23():
    agrees(
        lambda p: A.printed_eq23(*p.design, p.omega, p.m),
        lambda q, p: -(q("omega_BC") ** 2) * (q("Y") - p.pin_height),
        "acceleration",
    )


def test_eq24():
    agrees(lambda p: A.printed_eq24(*p.design, p.sheet), lambda q, p: q("V_C"), "velocity")
    faster = A.Worksheet(2 * SPEED, 0.0)
    assert A.printed_eq24(*CASE[:4], faster) == pytest.approx(2 * package("V_C", CASE), rel=1e-12)


def test_eq25():
    agrees(lambda p: A.printed_eq25(*p.design, p.sheet), lambda q, p: q("a_C"), "acceleration")
    faster, accelerating = A.Worksheet(2 * SPEED, 0.0), A.Worksheet(SPEED, 1000.0)
    assert A.printed_eq25(*CASE[:4], faster) == pytest.approx(4 * package("a_C", CASE), rel=1e-12)
    assert A.printed_eq25(*CASE[:4], accelerating) == pytest.approx(
        package("a_C", CASE._replace(alpha=1000.0)), rel=1e-12
    )


# --- the listing ----------------------------------------------------------------------------------

LINES = {
    "omega": (lambda q, p: q("omega"), "rate"),
    "delta": (lambda q, p: q("delta"), "angle"),
    "phi": (lambda q, p: q("phi"), "angle"),
    "Y": (lambda q, p: q("Y"), "length"),
    "omega_BC": (lambda q, p: q("omega_BC"), "rate"),
    "alpha_BC": (lambda q, p: q("alpha_BC"), "rate2"),
    "alpha_BC1": (lambda q, p: q("a_B_X") - alpha_part(q, p, "X"), "acceleration"),
    "alpha_BC2": (lambda q, p: alpha_part(q, p, "X"), "acceleration"),
    "alpha_BC3": (lambda q, p: -(q("omega_BC") ** 2) * p.side, "acceleration"),
    "alpha_BC4": (lambda q, p: q("Y") - p.pin_height, "length"),
    "a_C1": (lambda q, p: q("a_B_Y") - alpha_part(q, p, "Y"), "acceleration"),
    "a_C2": (lambda q, p: alpha_part(q, p, "Y"), "acceleration"),
    "a_C3": (lambda q, p: -q("alpha_BC") * p.side, "acceleration"),
    "a_C4": (lambda q, p: -(q("omega_BC") ** 2) * (q("Y") - p.pin_height), "acceleration"),
}


@pytest.mark.parametrize("name", LINES)
def test_listing_line(name):
    expected, kind = LINES[name]
    arguments = 1 if name == "omega" else 4
    agrees(lambda p: getattr(p.sheet, name)(*p.design[:arguments]), expected, kind)


def test_listing_V_B():
    agrees(lambda p: p.sheet.V_B(p.theta, p.AB), lambda q, p: paper_frame(q, "V_B"), "velocity")


def test_listing_a_B():
    agrees(lambda p: p.sheet.a_B(p.theta, p.AB), lambda q, p: paper_frame(q, "a_B"), "acceleration")


def test_listing_V_C():
    agrees(lambda p: p.sheet.corrected_V_C(*p.design), lambda q, p: q("V_C"), "velocity")
    agrees(lambda p: p.sheet.V_C(*p.design), lambda q, p: -q("V_C"), "velocity")
    differs(lambda p: p.sheet.V_C(*p.design), "V_C")
    assert three_digits(SHEET.V_C(*CASE[:4])) == 20.2
    choices = list(itertools.product((1, -1), repeat=2))
    printing = [
        signs for signs in choices if three_digits(A.V_C_of_signs(signs, *float_point(CASE)[:5])) == -20.2
    ]
    assert printing == [(-1, -1)]


def test_listing_a_C():
    agrees(lambda p: p.sheet.corrected_a_C(*p.design), lambda q, p: q("a_C"), "acceleration")
    agrees(lambda p: p.sheet.a_C(*p.design), lambda q, p: 2 * q("a_B_Y") - q("a_C"), "acceleration")
    differs(lambda p: p.sheet.a_C(*p.design), "a_C")
    assert SHEET.a_C(*CASE[:4]) == pytest.approx(-2090.66, abs=0.01)


def test_one_choice_of_signs_was_run():
    """All signs of the terms that are there at alpha = 0: 4 choices in V_C, 4 in alpha_BC, 8 in a_C."""
    theta, ec, AB, BC, omega = float_point(CASE)[:5]
    phi = A.printed_eq6(theta, ec, AB, BC)
    centripetal = BC * A.printed_eq10(theta, ec, AB, BC, omega) ** 2 * math.cos(phi)
    run = []
    for v, b, c in itertools.product(*(itertools.product((1, -1), repeat=n) for n in (2, 2, 3))):
        V_C = A.V_C_of_signs(v, theta, ec, AB, BC, omega)
        alpha_BC = A.alpha_BC_of_signs((b[0], 1, b[1]), theta, ec, AB, BC, omega, 0.0)
        parts = -AB * omega**2 * math.cos(theta), -BC * alpha_BC * math.sin(phi), -centripetal
        a_C = sum(sign * part for sign, part in zip(c, parts, strict=True))
        if [three_digits(x) for x in (V_C, alpha_BC, a_C)] == [-20.2, -7740.0, -994.0]:
            run.append((v, b, c))
    assert run == [((-1, -1), (1, -1), (1, 1, 1))]
