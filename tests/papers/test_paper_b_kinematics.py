"""Paper B: its kinematic equations, 1 to 30."""

import pytest
from mpmath import mp, mpf

from tests.papers import curves_b as curves
from tests.papers import loop
from tests.papers import paper_b as B
from tests.papers.designs import agrees, close, exact_point, float_point, package, scale_of
from tests.papers.designs_b import STEADY, by_theta, case, exact_case, off, other_rate, same_rate
from tests.papers.proofs import proves

# --- the crank ------------------------------------------------------------------------------------


@proves("B-eq1", "correct")
def test_eq1():
    for motion in STEADY:
        with mp.workdps(loop.DIGITS):
            start = motion._replace(theta=0.0)
            t = mpf(motion.theta) / mpf(motion.omega0)
            assert close(B.printed_eq1(mpf(motion.omega0), t), loop.crank_angle(start, t), 0, 30)
            assert close(B.printed_eq1(mpf(motion.omega0), t), mpf(motion.theta), 0, 30)


@proves("B-eq2a", "correct", cites="1")
def test_eq2a():
    for motion in STEADY:
        turning = loop.rate(lambda t, at=motion: loop.crank_angle(at, t), 1)
        assert close(B.printed_eq2a(mpf(motion.omega0)), turning, 0, 30)
        assert B.printed_eq2a(motion.omega0) == package("omega", motion)


def pin_speed(q, p):
    """Speed of the crank pin, m/s."""
    return p.m.sqrt(q("V_B_X") ** 2 + q("V_B_Y") ** 2)


@proves("B-eq2b", "typo")
def test_eq2b():
    agrees(lambda p: B.printed_eq2b(p.omega, p.AB), pin_speed, "velocity", STEADY)
    agrees(lambda p: B.corrected_eq2b_middle(p.AB, p.omega), pin_speed, "velocity", STEADY)
    for motion in STEADY:
        p = float_point(motion)
        speed = package("V_B", motion)
        assert B.printed_eq2b(p.omega, p.AB) == pytest.approx(speed, rel=1e-12)
        assert abs(B.printed_eq2b_middle(p.omega, p.omega) - speed) > 1e-3 * speed
        assert B.printed_eq2b_middle(p.omega, p.omega) == pytest.approx(speed * p.omega / p.AB, rel=1e-12)
        doubled = package("V_B", motion._replace(AB=2 * motion.AB, BC=2 * motion.BC, ec=2 * motion.ec))
        assert doubled == pytest.approx(2 * speed, rel=1e-12)


@proves("B-text-liner", "typo", cites="3")
@proves("B-eq3", "correct")
def test_eq3():
    agrees(
        lambda p: B.printed_eq3(p.omega, p.AB),
        lambda q, p: p.m.sqrt(q("a_B_X") ** 2 + q("a_B_Y") ** 2),
        "acceleration",
        STEADY,
    )
    for motion in STEADY:  # the speed does not change: only its direction does, which makes a_k
        assert close(
            loop.partial("V_B_X", "theta", motion) * motion.omega0, loop.truth("a_B_X", motion), 1, 20
        )


# --- position -------------------------------------------------------------------------------------


@proves("B-eq4", "correct")
def test_eq4():
    agrees(lambda p: B.printed_eq4(case(p), B.printed_eq22(case(p))), lambda q, p: q("Y"), "length", STEADY)


@proves("B-eq5a", "correct")
def test_eq5a():
    for motion in STEADY:
        with mp.workdps(loop.DIGITS):
            assert close(B.printed_eq5a(exact_case(motion)), loop.pin(motion)[0], motion.AB, 30)


@proves("B-eq5b", "correct")
def test_eq5b():
    for motion in STEADY:
        with mp.workdps(loop.DIGITS):
            h = B.printed_eq5b(exact_case(motion), loop.rod_angle(motion))
            assert close(h, loop.pin(motion)[0], motion.AB, 30)
        h = B.printed_eq5b(case(float_point(motion)), package("phi", motion))
        assert close(h, loop.pin(motion)[0], scale_of("length", motion), 12)


@proves("B-eq6", "correct", cites="5a 5b")
def test_eq6():
    agrees(lambda p: B.printed_eq6(case(p)), lambda q, p: p.m.sin(q("phi")), "angle", STEADY)


@proves("B-eq7", "correct")
def test_eq7():
    agrees(lambda p: B.printed_eq7(case(p)), lambda q, p: p.m.cos(q("phi")), "angle", STEADY)


@proves("B-eq8", "correct")
def test_eq8():
    agrees(lambda p: B.printed_eq8(case(p)), lambda q, p: q("Y"), "length", STEADY)


def paper_s(q, p):
    """The paper's s from the slider's place, m."""
    return B.printed_eq9(case(p), q("Y"))


@proves("B-eq9", "correct", cites="1")
def test_eq9():
    """The package measures s from the outer dead centre, the paper from k + c: they differ by a constant."""

    def from_dead_centre(p):
        return p.AB + p.BC - p.m.sqrt((p.AB + p.BC) ** 2 - p.ec**2)

    for motion in STEADY:
        p = float_point(motion)
        difference = paper_s(lambda name, at=motion: package(name, at), p) - package("s", motion)
        assert difference == pytest.approx(from_dead_centre(p), rel=0, abs=1e-12 * scale_of("length", motion))
        with mp.workdps(loop.DIGITS):
            p = exact_point(motion)
            outer = motion._replace(theta=B.dead_centres(p.ec, p.AB, p.BC, mp)[0])
            least = paper_s(lambda name, at=outer: loop.truth(name, at), p)
            assert close(least, from_dead_centre(p), p.AB, 30)
            assert least > 0
    q = curves.case_1(mpf(0))
    least = q.k + q.c - loop.truth("Y", curves.motion_of(q._replace(theta=curves.dead_centres()[0])))
    names = {"k": q.k, "c": q.c, "e": q.e, "s": least}
    return {"least": least, "mm": 1000 * least, "names": names}


@proves("B-eq10", "sign", cites="9 12")
def test_eq10():
    agrees(lambda p: B.corrected_eq10(case(p)), paper_s, "length", STEADY)
    off(lambda p: B.printed_eq10(case(p)), paper_s)
    same_rate(B.printed_eq12, B.corrected_eq10, "length")
    other_rate(B.printed_eq12, B.printed_eq10)
    agrees(
        lambda p: B.printed_eq10(case(p)) - 2 * (p.BC * p.m.cos(B.printed_eq22(case(p)))),
        paper_s,
        "length",
        STEADY,
    )
    assert all(B.printed_eq10(case(float_point(motion))) > motion.BC for motion in STEADY)


# --- velocity and acceleration of the slider ------------------------------------------------------


def chained(name, rate, sign, kind):
    """df/dtheta dtheta/dt is df/dt: from the loop to 30 digits and from the package."""
    for motion in STEADY:
        scale = scale_of(kind, motion)
        with mp.workdps(loop.DIGITS):
            got = B.chain(sign * loop.partial(name, "theta", motion), loop.omega(motion))
            assert close(got, sign * loop.truth(rate, motion), scale, 30)
        got = B.chain(sign * package(f"{name}_wrt_theta", motion), package("omega", motion))
        assert close(got, sign * loop.truth(rate, motion), scale, 12)


@proves("B-eq11", "correct")
def test_eq11():
    chained("Y", "V_C", -1, "velocity")


@proves("B-eq12", "correct", cites="9 10")
def test_eq12():
    same_rate(B.printed_eq12, B.corrected_eq10, "length")
    agrees(
        lambda p: B.printed_eq12(case(p)), lambda q, p: -q("V_C") / p.omega, "length", STEADY
    )  # the chain rule backwards


@proves("B-eq13", "correct")
def test_eq13():
    agrees(lambda p: B.printed_eq13(case(p)), lambda q, p: -q("V_C"), "velocity", STEADY)


@proves("B-eq14", "correct")
def test_eq14():
    chained("V_C", "a_C", -1, "acceleration")


@proves("B-eq15", "correct", cites="13")
def test_eq15():
    agrees(lambda p: sum(B.printed_eq15(case(p))), lambda q, p: -q("V_C"), "velocity", STEADY)
    agrees(lambda p: B.printed_eq15(case(p))[0], lambda q, p: -q("V_B_Y"), "velocity", STEADY)


@proves("B-eq16", "correct", cites="15")
def test_eq16():
    agrees(lambda p: B.printed_eq16(*B.printed_eq15(case(p))), lambda q, p: -q("V_C"), "velocity", STEADY)
    for motion in STEADY:
        with mp.workdps(loop.DIGITS):
            q = exact_case(motion)
            rates = [by_theta(lambda r, n=n: B.printed_eq15(r)[n], q) for n in (0, 1)]
            want = -loop.truth("a_C", motion) / q.omega
            assert close(B.printed_eq16(*rates), want, scale_of("velocity", motion), 30)


@proves("B-eq17", "sign")
def test_eq17():
    same_rate(B.corrected_eq17, lambda q: B.printed_eq15(q)[0], "velocity")
    other_rate(B.printed_eq17, lambda q: B.printed_eq15(q)[0])
    agrees(lambda p: B.printed_eq17(case(p)), lambda q, p: q("a_B_Y") / p.omega, "velocity", STEADY)


@proves("B-eq18", "sign and exponent")
def test_eq18():
    same_rate(B.corrected_eq18, lambda q: B.printed_eq15(q)[1], "velocity")
    other_rate(B.printed_eq18, lambda q: B.printed_eq15(q)[1])
    same_rate(lambda q: -q.square * B.printed_eq18(q), lambda q: B.printed_eq15(q)[1], "velocity")
    other_rate(lambda q: B.eq18(q, 1, 3, 5), lambda q: B.printed_eq15(q)[1])  # signs alone do not mend it
    other_rate(lambda q: B.eq18(q, -1, 1, 3), lambda q: B.printed_eq15(q)[1])  # nor exponents alone


def in_other_units(q, per_metre):
    """The case with its lengths in another unit."""
    return q._replace(e=q.e * per_metre, k=q.k * per_metre, c=q.c * per_metre)


def test_dimensions_of_eq18_and_eq20():
    """An acceleration in mm/s2 is 1000 times that in m/s2: not so as printed."""
    for motion in STEADY:
        q = case(float_point(motion))
        for printed, corrected in (
            (B.printed_eq18, B.corrected_eq18),
            (B.printed_eq20, B.corrected_eq20),
        ):
            assert corrected(in_other_units(q, 1000)) == pytest.approx(1000 * corrected(q), rel=1e-9)
            assert printed(in_other_units(q, 1000)) != pytest.approx(1000 * printed(q), rel=1e-3)


@proves("B-eq19", "correct")
def test_eq19():
    agrees(
        lambda p: B.printed_eq19(case(p), B.corrected_eq17(case(p)), B.corrected_eq18(case(p))),
        lambda q, p: -q("a_C"),
        "acceleration",
        STEADY,
    )


@proves("B-eq20", "sign and exponent", cites="17 19 9 14 1")
def test_eq20():
    def mended(p):
        """The printed form with its last two terms multiplied by the bracket, all reversed."""
        q = case(p)
        return -(B.printed_eq20(q) + q.omega**2 * q.k * q.cos) * q.square + q.omega**2 * q.k * q.cos

    agrees(mended, lambda q, p: -q("a_C"), "acceleration", STEADY)
    agrees(lambda p: B.corrected_eq20(case(p)), lambda q, p: -q("a_C"), "acceleration", STEADY)
    off(lambda p: B.printed_eq20(case(p)), lambda q, p: -q("a_C"))
    off(lambda p: B.printed_eq20(case(p)), lambda q, p: q("a_C"))  # nor is it d2x/dt2
    agrees(lambda p: -sum(B.a_s_terms(case(p), 1, 3)), lambda q, p: q("a_C"), "acceleration", STEADY)
    for motion in STEADY:
        q = case(float_point(motion))
        assembled = B.printed_eq19(q, B.printed_eq17(q), B.printed_eq18(q))
        third = q.omega**2 * q.k**2 * q.cos**2 * q.side**2 / q.root(5)
        assert assembled == pytest.approx(B.printed_eq20(q), rel=1e-9, abs=1e-9 * third)
    in_mm = curves.places(lambda q: B.printed_eq20(curves.in_millimetres(q)) / 1000)[0]
    true, printed = (curves.places(f)[0] for f in (B.corrected_eq20, B.printed_eq20))
    return {"metres": printed, "mm": in_mm, "true": true}


# --- the rod --------------------------------------------------------------------------------------


@proves("B-eq21", "correct", cites="6")
def test_eq21():
    agrees(
        lambda p: B.printed_eq21(case(p))[0] + B.printed_eq21(case(p))[1] * p.m.sin(p.theta),
        lambda q, p: p.m.sin(q("phi")),
        "angle",
        STEADY,
    )


@proves("B-eq22", "correct")
def test_eq22():
    agrees(lambda p: B.printed_eq22(case(p)), lambda q, p: q("phi"), "angle", STEADY)


@proves("B-eq23", "correct")
def test_eq23():
    chained("phi", "omega_BC", 1, "rate")


@proves("B-eq24", "correct", cites="6")
def test_eq24():
    agrees(
        lambda p: B.printed_eq24(case(p)),
        lambda q, p: p.m.cos(q("phi")) * q("omega_BC") / p.omega,
        "angle",
        STEADY,
    )


@proves("B-eq25", "correct", cites="24")
def test_eq25():
    agrees(
        lambda p: B.printed_eq25(case(p), B.printed_eq22(case(p))),
        lambda q, p: q("omega_BC") / p.omega,
        "angle",
        STEADY,
    )


@proves("B-eq26", "correct")
def test_eq26():
    agrees(
        lambda p: B.printed_eq26(case(p), B.printed_eq22(case(p))), lambda q, p: q("omega_BC"), "rate", STEADY
    )


@proves("B-eq27", "correct")
def test_eq27():
    agrees(lambda p: B.printed_eq27(case(p)), lambda q, p: q("omega_BC"), "rate", STEADY)


@proves("B-eq28", "correct")
def test_eq28():
    chained("omega_BC", "alpha_BC", 1, "rate2")


@proves("B-eq29", "sign", cites="27")
def test_eq29():
    same_rate(B.corrected_eq29, B.printed_eq27, "rate")
    other_rate(B.printed_eq29, B.printed_eq27)
    same_rate(
        lambda q: -2 * q.omega * q.k * q.sin / q.root(1) - B.printed_eq29(q), B.printed_eq27, "rate"
    )  # the first fraction twice, less the printed form: its second sign reversed


@proves("B-eq30", "sign", cites="29")
def test_eq30():
    agrees(lambda p: B.corrected_eq30(case(p)), lambda q, p: q("alpha_BC"), "rate2", STEADY)
    off(lambda p: B.printed_eq30(case(p)), lambda q, p: q("alpha_BC"))
    agrees(
        lambda p: B.printed_eq30(case(p)),
        lambda q, p: 2 * q("a_B_X") / (p.BC * p.m.cos(q("phi"))) - q("alpha_BC"),
        "rate2",
        STEADY,
    )
