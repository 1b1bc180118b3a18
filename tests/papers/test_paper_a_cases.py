"""Paper A: its worked numbers and what it concludes from them."""

import pytest
from mpmath import mp, mpf

from tests.papers import loop
from tests.papers import paper_a as A
from tests.papers.designs import (
    CASE,
    CRANK,
    DESIGNS,
    EXACT,
    ROD,
    SPEED,
    agrees,
    close,
    differs,
    exact_point,
    float_point,
    package,
    scale_of,
    three_digits,
)
from tests.papers.proofs import proves

PRINTED = {"omega_BC": 29.5, "V_C": -20.2, "alpha_BC": -7740.0, "a_C": -994.0}
CALL = [mpf(60), mpf(0), mpf(CRANK), mpf(ROD)]


def recomputed(name, motion=CASE):
    """A worked number from the loop closure, which the package repeats to rounding."""
    true = loop.truth(name, motion)
    assert close(package(name, motion), true, 0, 13)
    return true


def rounded(value):
    """A value in the three digits that the paper prints."""
    return mpf(three_digits(value))


@proves("A-case1-omega0", "correct", says="1500 rpm: omega0 = 157.08 rad/s")
def test_case1_omega0():
    exact = 1500 * 2 * mp.pi / 60
    assert float(f"{float(exact):.2f}") == SPEED
    for name, printed in PRINTED.items():
        assert three_digits(package(name, CASE._replace(omega0=float(exact)))) == printed
    return {"omega0": exact, "printed": [exact * 60 / (2 * mp.pi), exact]}


@proves("A-case1-clockwise", "not reproducible", says="1500", cites="2 4 2")
def test_sense_of_rotation():
    """In the paper's frame the pin moves about A anticlockwise, if its axes are right-handed."""
    for motion in DESIGNS:
        p = exact_point(motion)
        (x, y), (vx, vy) = (p.AB * mp.sin(p.theta), -p.pin_height), A.printed_eq2(p.theta, p.AB, p.omega, mp)
        moment = x * vy - y * vx
        assert moment > 0
        mirror = motion._replace(
            theta=-motion.theta, ec=-motion.ec, omega0=-motion.omega0, alpha=-motion.alpha
        )
        for name in ("V_C", "a_C"):
            assert close(package(name, mirror), package(name, motion), scale_of("acceleration", motion), 12)
            assert close(loop.truth(name, mirror), loop.truth(name, motion), 0, 25)
    return {"moment": moment, "names": {"AB": p.AB, "omega": p.omega}}


@proves("A-case1-omega_BC", "correct")
def test_case1_omega_BC():
    true = recomputed("omega_BC")
    assert close(EXACT.omega_BC(*CASE[:4]), true, 0, 30)
    return {"omega_BC": true, "printed": [*CALL, true]}


@proves("A-case1-V_C", "correct", cites="11")
def test_case1_V_C():
    true = recomputed("V_C")
    p = exact_point(CASE)
    assert close(A.printed_eq11(*p.design, p.omega, mp), true, 0, 30)
    return {"V_C": true, "listing": EXACT.V_C(*CASE[:4]), "printed": [*CALL, true]}


@proves("A-case1-direction", "correct")
def test_case1_direction():
    later = CASE._replace(theta=CASE.theta + 1e-6)
    assert 0 < package("Y", later) < package("Y", CASE)
    return {"Y": recomputed("Y"), "V_C": recomputed("V_C")}


@proves("A-case1-textbook", "given")
def test_case1_sizes():
    return {"sizes": [abs(recomputed(name)) for name in ("V_C", "omega_BC")]}


@proves("A-case2-alpha_BC", "correct")
def test_case2_alpha_BC():
    true = recomputed("alpha_BC")
    assert close(EXACT.alpha_BC(*CASE[:4]), true, 0, 30)
    return {"alpha_BC": true, "rounded": rounded(true), "printed": [*CALL, rounded(true)]}


@proves("A-case2-a_C", "correct", cites="19 19")
def test_case2_a_C():
    true = recomputed("a_C")
    assert close(EXACT.corrected_a_C(*CASE[:4]), true, 0, 30)
    return {"a_C": true, "as_printed": EXACT.a_C(*CASE[:4]), "printed": [*CALL, true]}


@proves("A-case2-textbook", "given", says="10 7740 994")
def test_case2_sizes():
    sizes = [abs(recomputed(name)) for name in ("alpha_BC", "a_C")]
    assert [three_digits(size) for size in sizes] == [7740.0, 994.0]
    return {"sizes": sizes}


def growth_of_speed(motion):
    """d|V_C|/dt at constant omega from the loop's V_C at two angles, m/s2."""
    step = mpf(10) ** -15
    after, before = (abs(loop.truth("V_C", motion._replace(theta=motion.theta + h))) for h in (step, -step))
    return (after - before) / (2 * step) * motion.omega0


@proves("A-case2-deceleration", "wrong claim")
def test_negative_acceleration_is_not_deceleration():
    assert recomputed("a_C") < 0 < growth_of_speed(CASE)
    return {"V_C": recomputed("V_C"), "a_C": recomputed("a_C"), "growth": growth_of_speed(CASE)}


@proves("A-case2-slowing", "correct")
def test_positive_velocity_slows_down():
    slowing = CASE._replace(theta=5 * mp.pi / 3)
    V_C, a_C = loop.truth("V_C", slowing), loop.truth("a_C", slowing)
    assert growth_of_speed(slowing) < 0 < V_C
    assert close(growth_of_speed(slowing), a_C, 0, 20)
    return {"deg": mp.degrees(slowing.theta), "V_C": V_C, "a_C": a_C}


@proves("A-case2-speeding", "correct")
def test_negative_velocity_speeds_up():
    assert recomputed("V_C") < 0
    assert close(growth_of_speed(CASE), -recomputed("a_C"), 0, 20)
    return {"growth": growth_of_speed(CASE), "deg": mp.degrees(mpf(CASE.theta))}


@proves("A-claim-validation", "wrong claim", cites="13 19")
def test_printed_functions_fail_the_validation():
    printed = {name: getattr(EXACT, name)(*CASE[:4]) for name in PRINTED}
    passing = [name for name in PRINTED if three_digits(printed[name]) == PRINTED[name]]
    assert passing == ["omega_BC", "alpha_BC"]
    corrected = EXACT.corrected_V_C(*CASE[:4]), EXACT.corrected_a_C(*CASE[:4])
    assert [three_digits(value) for value in corrected] == [PRINTED["V_C"], PRINTED["a_C"]]
    return {"V_C": printed["V_C"], "a_C": printed["a_C"]}


MUTANTS = {
    "ec reversed": lambda p: p._replace(ec=-p.ec),
    "ec left out": lambda p: p._replace(ec=0.0),
    "alpha reversed": lambda p: p._replace(alpha=-p.alpha),
    "alpha left out": lambda p: p._replace(alpha=0.0),
}


def mutated(mutant, motion):
    """The four functions of Sec. III.B with a wrong ec or a wrong alpha at the same speed."""
    p = MUTANTS[mutant](float_point(motion))
    return {
        "omega_BC": A.printed_eq10(*p.design, p.omega),
        "V_C": A.printed_eq11(*p.design, p.omega),
        "alpha_BC": A.printed_eq14(*p.design, p.omega, p.alpha),
        "a_C": A.corrected_eq19(*p.design, p.omega, p.alpha),
    }


@proves("A-claim-general", "wrong claim")
def test_validation_cannot_see_ec_or_alpha():
    for mutant in MUTANTS:
        assert {name: three_digits(value) for name, value in mutated(mutant, CASE).items()} == PRINTED
        for motion in DESIGNS:
            wrong = mutated(mutant, motion)["a_C"]
            assert wrong != pytest.approx(package("a_C", motion), rel=1e-6)
            assert wrong != pytest.approx(float(loop.truth("a_C", motion)), rel=1e-6)


CONCENTRIC = [motion._replace(ec=0.0) for motion in DESIGNS]


@proves("A-claim-concentric", "wrong claim", says="0", cites="11 13 2")
def test_concentric_designs():
    """Right as corrected; as printed V_C and a_C of the listing are wrong in each of them."""
    agrees(lambda p: p.sheet.omega_BC(*p.design), lambda q, p: q("omega_BC"), "rate", CONCENTRIC)
    agrees(lambda p: p.sheet.corrected_V_C(*p.design), lambda q, p: q("V_C"), "velocity", CONCENTRIC)
    agrees(lambda p: p.sheet.alpha_BC(*p.design), lambda q, p: q("alpha_BC"), "rate2", CONCENTRIC)
    agrees(lambda p: p.sheet.corrected_a_C(*p.design), lambda q, p: q("a_C"), "acceleration", CONCENTRIC)
    agrees(lambda p: p.sheet.V_C(*p.design), lambda q, p: -q("V_C"), "velocity", CONCENTRIC)
    differs(lambda p: p.sheet.a_C(*p.design), "a_C", CONCENTRIC)
    return {"as_printed": EXACT.a_C(*CASE[:4]), "a_C": recomputed("a_C")}
