"""Paper A: what its text, its tool and its worked numbers say."""

import math

import pytest
from mpmath import mp, mpf

from tests.papers import free_bodies, loop
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
    exact_point,
    float_point,
    package,
    scale_of,
)
from tests.papers.free_bodies import Bodies
from tests.papers.loop import Motion
from tests.papers.proofs import proves
from tests.papers.test_paper_a_cases import PRINTED

# --- text of Sec. II ------------------------------------------------------------------------------


def pin_components(q, p):
    """The components of the pin's acceleration along and across its velocity, m/s2."""
    (vx, vy), (ax, ay) = (q("V_B_X"), q("V_B_Y")), (q("a_B_X"), q("a_B_Y"))
    speed = p.m.sqrt(vx**2 + vy**2)
    return (vx * ax + vy * ay) / speed, (ay * vx - ax * vy) / speed


@proves("A-text-normal", "correct", says="the present of normal acceleration (AB*omega_BA^2)")
def test_normal_acceleration_text():
    agrees(
        lambda p: A.printed_normal(p.AB, p.omega, p.alpha),
        lambda q, p: -pin_components(q, p)[1],
        "acceleration",
    )
    return {"size": A.printed_normal(CRANK, mpf(SPEED), 0)}


@proves("A-text-tangential", "typo", says="tangential acceleration (AB*omega_BA^2)", cites="4")
def test_tangential_acceleration_text():
    agrees(
        lambda p: A.corrected_tangential(p.AB, p.omega, p.alpha),
        lambda q, p: pin_components(q, p)[0],
        "acceleration",
    )
    for motion in DESIGNS:
        p = float_point(motion)
        true = pin_components(lambda name, at=motion: package(name, at), p)[0]
        assert abs(A.printed_tangential(p.AB, p.omega, p.alpha) - true) > 1e-3 * abs(true)
    p = exact_point(DESIGNS[0])
    tangential, _ = pin_components(lambda name: loop.truth(name, DESIGNS[0]), p)
    rest = A.printed_normal(CRANK, mpf(SPEED), 0), A.corrected_tangential(CRANK, mpf(SPEED), 0)
    names = {"AB": p.AB, "alpha": p.alpha, "alpha_BA": p.alpha}
    return {"tangential": tangential, "size": rest[0], "none": rest[1], "names": names}


@proves(
    "A-text-two-bodies",
    "wrong claim",
    says="The slider mechanism as illustrated in Fig. 1 consists of two rigid bodies.",
    cites="2",
)
def test_two_bodies_and_three_move_alike():
    """Three coordinates a body, less two for each pin and for the guide, or less one for a pin in a slot."""
    coordinates, pins = 3, 2
    two, three = coordinates * 2 - pins * 2 - 1, coordinates * 3 - pins * 3 - 2
    assert two == three == 1
    guide = free_bodies.solve(CASE, Bodies(m_slider=1.0))["N_C"]
    assert abs(guide) > 100
    return {"two": mpf(two), "three": mpf(three), "load": [mpf(1), abs(guide)]}


@proves(
    "A-text-omega-of-theta",
    "typo",
    says="omega in Eqs. 2, 4 and 13; omega(theta) in Eqs. 9 to 11, 15 and 20",
    cites="2 4 13",
)
def test_omega_is_that_at_theta():
    """The pin's velocity and acceleration need the speed at theta, not that at the start."""
    for motion in DESIGNS:
        p = exact_point(motion)
        true = loop.truth("V_B_X", motion), -loop.truth("V_B_Y", motion)
        for omega, right in ((p.omega, True), (p.omega0, False)):
            result = A.printed_eq2(p.theta, p.AB, omega, mp)
            assert all(close(g, t, 0, 25) for g, t in zip(result, true, strict=True)) == right
            result = A.printed_eq4(p.theta, p.AB, omega, p.alpha, mp)
            assert close(result[0], loop.truth("a_B_X", motion), 0, 25) == right


@proves("A-text-first-component", "correct", says="9", cites="9")
def test_first_component_gives_omega_BC():
    for motion in DESIGNS:
        p, phi = exact_point(motion), loop.truth("phi", motion)
        left = A.printed_eq2(p.theta, p.AB, p.omega, mp)
        unit = A.printed_eq9(phi, p.BC, mpf(1), mpf(0), mp)
        omega_BC = left[0] / unit[0]
        V_C = -(left[1] - omega_BC * unit[1])
        assert A.printed_eq9(phi, p.BC, mpf(1), mpf(7), mp)[0] == unit[0]
        assert close(omega_BC, loop.truth("omega_BC", motion), 0, 30)
        assert close(V_C, loop.truth("V_C", motion), scale_of("velocity", motion), 30)
        assert close(V_C, package("V_C", motion), scale_of("velocity", motion), 12)


@proves("A-text-constants", "typo", says="with the constants ... [a_C1 to a_C4]", cites="2")
def test_terms_are_not_constants():
    early, late = (A.a_C_parts(t, 0.1, CRANK, ROD, SPEED, 100.0) for t in (math.pi / 3, 2 * math.pi / 3.1))
    assert all(abs(a - b) > 1e-3 * abs(a) for a, b in zip(early, late, strict=True))
    ends = [mpf(60), mpf(120)]
    return {"range": ends, "a_C1": [A.printed_eq20(mp.radians(t), CRANK, mpf(SPEED), mp) for t in ends]}


@proves("A-text-omega-varies", "correct")
def test_speed_changes_under_alpha():
    for motion in DESIGNS:
        later = motion._replace(theta=motion.theta + 0.01)
        change = package("omega", later) - package("omega", motion)
        assert math.copysign(1, change) == math.copysign(1, motion.alpha)
        rate = loop.partial("omega", "theta", motion) * loop.truth("omega", motion)
        assert close(rate, mpf(motion.alpha), 0, 30)
        assert close(package("omega_wrt_theta", motion) * package("omega", motion), mpf(motion.alpha), 0, 12)


@proves("A-text-V_B-dependence", "wrong claim")
def test_V_B_depends_on_the_motion():
    for motion in DESIGNS:
        faster = motion._replace(omega0=2 * motion.omega0, alpha=4 * motion.alpha)
        steady = motion._replace(alpha=0.0)
        other = motion._replace(ec=-motion.ec / 2, BC=1.1 * motion.BC)
        assert package("V_B", faster) == pytest.approx(2 * package("V_B", motion), rel=1e-12)
        assert package("a_B", faster) == pytest.approx(4 * package("a_B", motion), rel=1e-12)
        assert float(loop.truth("V_B_X", faster)) == pytest.approx(
            2 * float(loop.truth("V_B_X", motion)), rel=1e-12
        )
        assert package("V_B", steady) != pytest.approx(package("V_B", motion), rel=1e-3)
        assert package("a_B", steady) != pytest.approx(package("a_B", motion), rel=1e-3)
        assert package("V_B", other) == package("V_B", motion)
        assert package("a_B", other) == package("a_B", motion)


@proves("A-text-equation-list", "typo", says="10 11 14 15", cites="10 11 14 15 18 19 20 23 15 2 19")
def test_list_of_coded_equations():
    for motion in DESIGNS:
        p = float_point(motion)
        coded = {
            "omega_BC": A.printed_eq10(*p.design, p.omega),
            "V_C": A.printed_eq11(*p.design, p.omega),
            "alpha_BC": A.printed_eq14(*p.design, p.omega, p.alpha),
            "a_C": A.corrected_eq19(*p.design, p.omega, p.alpha),
        }
        assert all(value == pytest.approx(package(name, motion), rel=1e-9) for name, value in coded.items())
        term = A.printed_eq15(p.theta, p.AB, p.omega)
        assert all(term != pytest.approx(value, rel=1e-3) for value in coded.values())
    p = exact_point(CASE)
    return {"term": A.printed_eq15(p.theta, p.AB, p.omega, mp)}


@proves("A-fig4", "given", says="90")
def test_turning_the_sketch():
    """The two angles are complementary: a quarter turn swaps the axes that they are measured from."""
    for motion in DESIGNS:
        assert close(loop.truth("delta", motion) + loop.truth("phi", motion), mp.pi / 2, 0, 30)
    return {"turned": mpf(90)}


# --- the tool, Sec. III.A -------------------------------------------------------------------------


@proves("A-fig8-V_Bmag", "omission")
@proves("A-fig8-a_Bmag", "omission")
def test_pin_magnitudes():
    """The presumed V_Bmag and a_Bmag are the package's V_B and a_B."""
    agrees(
        lambda p: p.m.sqrt(sum(v**2 for v in p.sheet.V_B(p.theta, p.AB))),
        lambda q, p: pin_size(q, "V_B"),
        "velocity",
    )
    agrees(
        lambda p: p.AB * p.m.sqrt(p.omega**4 + p.alpha**2), lambda q, p: pin_size(q, "a_B"), "acceleration"
    )
    for motion in DESIGNS:
        assert package("V_B", motion) == pytest.approx(motion.AB * float(loop.omega(motion)), rel=1e-12)
        sides = package("a_B_X", motion), package("a_B_Y", motion)
        assert package("a_B", motion) == pytest.approx(math.hypot(*sides), rel=1e-12)


def pin_size(q, name):
    """Size of a vector of the pin."""
    return mp.sqrt(q(f"{name}_X") ** 2 + q(f"{name}_Y") ** 2)


@proves("A-example-a_C", "correct", cites="25 19")
def test_example_call():
    motion = Motion(mp.pi / 3, mpf("0.010"), mpf("0.125"), mpf("0.3"), mpf(SPEED))
    true = loop.truth("a_C", motion)
    assert close(EXACT.corrected_a_C(*motion[:4]), true, 0, 30)
    assert close(package("a_C", Motion(*map(float, motion))), true, 0, 12)
    call = [mp.degrees(motion.theta), *motion[1:4]]
    margin = motion.BC - motion.AB - motion.ec
    values = {"margin": margin, "omega0": motion.omega0, "a_C": true, "as_printed": EXACT.a_C(*motion[:4])}
    return values | {"printed": [*call, *call[1:]]}


@pytest.mark.filterwarnings("ignore::desaxe.UnitWarning")
@proves("A-claim-unit", "not reproducible")
def test_unit_comes_from_the_lengths():
    in_millimetres = CASE._replace(AB=1000 * CRANK, BC=1000 * ROD)
    for name, power in {"omega_BC": 0, "alpha_BC": 0, "V_C": 1, "a_C": 1}.items():
        assert package(name, in_millimetres) == pytest.approx(1000**power * package(name, CASE), rel=1e-12)
        assert close(loop.truth(name, in_millimetres), 1000**power * loop.truth(name, CASE), 0, 12)
    scaled = [loop.truth(name, in_millimetres) / loop.truth(name, CASE) for name in ("V_C", "a_C")]
    return {"results": [mpf(value) for value in PRINTED.values()], "scale": mpf(1000), "scaled": scaled}
