"""Paper B: what the text says of its kinematics, captions and references."""

import pytest
from mpmath import mp, mpf

import desaxe as dx
from tests.papers import curves_b as curves
from tests.papers import loop
from tests.papers import paper_b as B
from tests.papers.curves_b import case_1, case_2
from tests.papers.designs import agrees, close, exact_point, float_point, package
from tests.papers.designs_b import STEADY, by_theta, case, exact_case
from tests.papers.extremes import greatest
from tests.papers.proofs import proves
from tests.papers.test_paper_b_tables import extremes

EQ_4 = (
    "Equation (4) defined alpha as: sin(alpha) = e/c + (k/c)*sin(theta);"
    " Putting Equation (21) into Equation (4) gives Equation (22)"
)


@proves("B-text-a_k-offset", "wrong claim", says="2", cites="3")
@proves("B-text-crank-offset", "wrong claim", cites="1 3")
def test_text_crank_has_no_offset():
    for motion in STEADY:
        other = motion._replace(ec=-motion.ec / 3)
        for name in ("V_B_X", "V_B_Y", "a_B_X", "a_B_Y"):
            assert package(name, other) == package(name, motion)
            assert loop.truth(name, other) == loop.truth(name, motion)
        for name in ("Y", "V_C", "a_C", "phi", "omega_BC", "alpha_BC"):
            assert loop.truth(name, other) != pytest.approx(float(loop.truth(name, motion)), rel=1e-6)


@proves("B-text-liner", "typo", cites="3")
def test_text_liner():
    """The pin's speed does not change, only its direction: that makes a_k."""
    for motion in STEADY:
        turned = loop.partial("V_B_X", "theta", motion) * motion.omega0
        assert close(turned, loop.truth("a_B_X", motion), 1, 20)
        assert abs(loop.rate(lambda t, at=motion: mp.hypot(*loop.pin(at, t)), 1)) < mpf(10) ** -30


@proves("B-text-x", "wrong claim")
def test_text_x_is_not_the_distance():
    for motion in STEADY:
        distance = mp.hypot(*loop.slider(motion))
        q = exact_case(motion)
        assert close(mp.sqrt(B.printed_eq8(q) ** 2 + q.e**2), distance, 0, 30)
        assert distance - B.printed_eq8(q) > mpf("1e-7") * distance
    return {"distance": distance, "names": {"x": loop.truth("Y", motion), "e": q.e}}


@proves("B-text-eq4-for-eq6", "typo", says=EQ_4, cites="6 4")
def test_text_alpha_is_not_from_eq4():
    """Eq. 4 gives cos(alpha) only, the same for either side of the axis; Eq. 6 tells the side."""
    for motion in STEADY:
        q = exact_case(motion)
        alpha = B.printed_eq22(q)
        assert B.printed_eq4(q, alpha) == B.printed_eq4(q, -alpha)
        assert abs(mp.sin(alpha) - mp.sin(-alpha)) > mpf("1e-3") * abs(mp.sin(alpha))
        assert close(mp.sin(alpha), B.printed_eq6(q), 1, 30)


@proves(
    "B-text-eq5b-for-eq7", "typo", says="Substituting Equation (5b) into Equation (26)", cites="7 26 26 5b 27"
)
def test_text_eq27_follows_from_eq7():
    """Eq. 26 with the cosine of Eq. 7 is Eq. 27; with the sine of Eq. 5b it is not."""
    for motion in STEADY:
        q = exact_case(motion)
        top = q.omega * B.printed_eq24(q)
        assert close(top / B.printed_eq7(q), B.printed_eq27(q), abs(q.omega), 30)
        by_5b = top / ((B.printed_eq5a(q) + q.e) / q.c)
        assert abs(by_5b - B.printed_eq27(q)) > mpf("1e-3") * abs(B.printed_eq27(q))


@proves("B-text-rod-velocity", "typo")
def test_text_rod_velocity_is_a_turning():
    """v_c and a_c keep their value when all lengths are scaled: rad/s and rad/s2, not m/s and m/s2."""
    for motion in STEADY:
        large = motion._replace(AB=10 * motion.AB, BC=10 * motion.BC, ec=10 * motion.ec)
        for name in ("omega_BC", "alpha_BC"):
            assert package(name, large) == pytest.approx(package(name, motion), rel=1e-9)
            assert close(loop.truth(name, large), loop.truth(name, motion), 0, 12)
        assert B.printed_eq27(case(float_point(large))) == pytest.approx(
            package("omega_BC", motion), rel=1e-9
        )


@proves("B-text-stroke-equation", "typo", says="2.3 5 6", cites="9")
def test_text_differentiating_eq9_not_the_stroke():
    """The stroke is one number for a design; what is differentiated is the position s."""
    for motion in STEADY:
        q = exact_case(motion)
        assert by_theta(lambda r: B.corrected_eq49(r.e, r.k, r.c, mp), q) == 0
        assert close(by_theta(B.corrected_eq10, q), B.printed_eq12(q), q.k, 30)
        assert abs(B.printed_eq12(q)) > mpf("1e-6") * q.k


@proves("B-claim-novel", "wrong claim", cites="2012 6 7 22 8")
@proves("B-claim-lacking", "wrong claim", cites="2012 9 12 6 7 22 8 1 1997 2012")
def test_same_x_as_paper_a():
    """Eqs. 6 to 8 with the offset in them stand in paper A, received in 2012."""
    from tests.papers import paper_a as A

    for motion in STEADY:
        p = exact_point(motion)
        assert close(A.printed_eq7(*p.design, mp), B.printed_eq8(case(p)), p.AB, 30)
        assert close(A.printed_eq6(*p.design, mp), B.printed_eq22(case(p)), 1, 30)


def test_no_mechanism_where_the_root_is_imaginary():
    """Eq. 7's bracket is negative exactly where the package reports that nothing can be assembled."""
    seen = set()
    for motion in STEADY:
        for ec in (motion.ec, motion.BC, -motion.BC, 2 * motion.BC):
            q = case(float_point(motion._replace(ec=ec)))
            impossible = dx.evaluate(("Y", "status"), **motion._replace(ec=ec)._asdict())["status"] == 1
            assert impossible == (q.square < 0)
            seen.add(bool(impossible))
    assert seen == {True, False}


@proves("B-claim-identities", "wrong claim", cites="7 18 42b")
def test_identities_serve_with_an_offset():
    """The cosine of a sum, the square identity and that of the double angle, with an offset."""

    def short(p):
        q = case(p)
        alpha = B.printed_eq22(q)
        turned = q.m.cos(alpha + q.theta) + q.k / q.c * q.cos**2 / q.m.cos(alpha) ** 2
        return q.k * q.omega**2 * turned / q.m.cos(alpha)

    agrees(short, lambda q, p: -q("a_C"), "acceleration", STEADY)
    assert all(motion.ec != 0 for motion in STEADY[:6])


PRINTED = {
    "10": (B.printed_eq10, B.corrected_eq10),
    "17": (B.printed_eq17, B.corrected_eq17),
    "18": (B.printed_eq18, B.corrected_eq18),
    "20": (B.printed_eq20, B.corrected_eq20),
    "29": (B.printed_eq29, B.corrected_eq29),
    "30": (B.printed_eq30, B.corrected_eq30),
}


@proves("B-claim-exact", "wrong claim", cites="10 17 18 20 29 30 4 30")
def test_six_equations_are_not_exact():
    """Eqs. 4 to 30 hold no approximation; as printed six of them are wrong in every design."""
    for motion in STEADY:
        q = case(float_point(motion))
        for printed, corrected in PRINTED.values():
            assert abs(printed(q) - corrected(q)) > 1e-6 * abs(corrected(q))


# --- captions and references ----------------------------------------------------------------------


@proves("B-fig-19", "typo", says="0", cites="3 2")
def test_fig_19_is_an_acceleration():
    """Table 3's numbers are those of Eq. 52 in m/s2; the torque of the same design is small."""
    assert [mp.nstr(value, 4) for value in extremes(B.printed_eq52)] == ["12.59", "-20.99"]
    torque = greatest(lambda t: abs(B.printed_eq53(case_2(t), 1.543)))[0]
    limit = mpf("0.65")
    assert torque < limit
    return {"e": mpf(0), "limit": limit}


@proves("B-fig-17", "omission", cites="52 B-eq52")
@proves("B-fig-18", "correct", says="0", cites="53")
def test_existing_model_has_no_offset():
    """Eqs. 52 and 53 hold no e: they cannot tell one offset from another."""
    for model, exact in (
        (B.reversed_eq52, B.corrected_eq20),
        (lambda q: B.printed_eq53(q, 1), lambda q: curves.right(q, 1)),
    ):
        assert model(case_1(mpf(2), 20)) == model(case_1(mpf(2), 0)) != exact(case_1(mpf(2), 20))
    return {"without": mpf(0)}


CITED = (
    "Sahidur 1991; Julius 2016; Sarigecili 2018; Doyoung 2013; Shrikant 2013; Mohammad 2011; Rudolf 2012;"
    " Boyle 1997; Santosh 2018; Patel 2013; Hroncova 2016; Peter 2015; Jomartov 2015; Gregory 2011;"
    " Kittur 2017; Bhupesh 2013; Hailemariam 2015; Eric 2013"
)
LISTED = (
    "Bhupesh 2013; Boyle 1997; Doyoung 2013; Eric 2013; Gulsuner 2013; Gregory 2011; Hailemariam 2015;"
    " Hroncova 2016; Jomartov 2015; Kittur 2017; Mohammad 2011; Patel 2013; Peter 2015; Rudolf 2012;"
    " Sahidur 1991; Santosh 2018; Sarigecili 2018; Thaddaeus 2016"
)


@proves("B-references", "typo")
def test_references():
    cited, listed = (set(text.split("; ")) for text in (CITED, LISTED))
    assert cited - listed == {"Julius 2016", "Shrikant 2013"}
    assert listed - cited == {"Gulsuner 2013", "Thaddaeus 2016"}
