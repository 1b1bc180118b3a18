"""Paper A: what its text, its tool and its worked numbers say."""

import math

import pytest
from mpmath import mp, mpf

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
    agrees,
    close,
    exact_point,
    float_point,
    package,
    scale_of,
    three_digits,
)
from tests.papers.loop import Motion

# --- text of Sec. II ------------------------------------------------------------------------------


def pin_components(q, p):
    """The components of the pin's acceleration along and across its velocity, m/s2."""
    (vx, vy), (ax, ay) = (q("V_B_X"), q("V_B_Y")), (q("a_B_X"), q("a_B_Y"))
    speed = p.m.sqrt(vx**2 + vy**2)
    return (vx * ax + vy * ay) / speed, (ay * vx - ax * vy) / speed


def test_normal_acceleration_text():
    agrees(
        lambda p: A.printed_normal(p.AB, p.omega, p.alpha),
        lambda q, p: -pin_components(q, p)[1],
        "acceleration",
    )
    assert A.printed_normal(CRANK, SPEED, 0.0) == pytest.approx(3084.3, abs=0.05)


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


def test_first_component_gives_omega_BC():
    for motion in DESIGNS:
        with mp.workdps(loop.DIGITS):
            p, phi = exact_point(motion), loop.truth("phi", motion)
            left = A.printed_eq2(p.theta, p.AB, p.omega, mp)
            unit = A.printed_eq9(phi, p.BC, mpf(1), mpf(0), mp)
            omega_BC = left[0] / unit[0]
            V_C = -(left[1] - omega_BC * unit[1])
            assert A.printed_eq9(phi, p.BC, mpf(1), mpf(7), mp)[0] == unit[0]
        assert close(omega_BC, loop.truth("omega_BC", motion), 0, 30)
        assert close(V_C, loop.truth("V_C", motion), scale_of("velocity", motion), 30)
        assert close(V_C, package("V_C", motion), scale_of("velocity", motion), 12)


def test_terms_are_not_constants():
    early, late = (A.a_C_parts(t, 0.1, CRANK, ROD, SPEED, 100.0) for t in (math.pi / 3, 2 * math.pi / 3.1))
    assert all(abs(a - b) > 1e-3 * abs(a) for a, b in zip(early, late, strict=True))
    at_60, at_120 = (A.printed_eq20(math.radians(t), CRANK, SPEED) for t in (60, 120))
    assert (round(at_60), round(at_120)) == (-1542, 1542)


def test_speed_changes_under_alpha():
    for motion in DESIGNS:
        later = motion._replace(theta=motion.theta + 0.01)
        change = package("omega", later) - package("omega", motion)
        assert math.copysign(1, change) == math.copysign(1, motion.alpha)
        rate = loop.partial("omega", "theta", motion) * loop.truth("omega", motion)
        assert close(rate, mpf(motion.alpha), 0, 30)
        assert close(package("omega_wrt_theta", motion) * package("omega", motion), mpf(motion.alpha), 0, 12)


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


def test_list_of_coded_equations():
    p = float_point(CASE)
    assert round(A.printed_eq15(p.theta, p.AB, p.omega)) == -2671
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


# --- the tool, Sec. III.A -------------------------------------------------------------------------


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


def test_example_call():
    motion = Motion(math.radians(60), 0.010, 0.125, 0.3, SPEED)
    assert motion.BC - motion.AB - motion.ec == pytest.approx(0.165)
    for value in (loop.truth("a_C", motion), package("a_C", motion), SHEET.corrected_a_C(*motion[:4])):
        assert float(value) == pytest.approx(-810.399, abs=5e-4)
    assert SHEET.a_C(*motion[:4]) == pytest.approx(-2273.87, abs=5e-3)


def test_unit_comes_from_the_lengths():
    in_millimetres = CASE._replace(AB=1000 * CRANK, BC=1000 * ROD)
    for name, power in {"omega_BC": 0, "alpha_BC": 0, "V_C": 1, "a_C": 1}.items():
        assert package(name, in_millimetres) == pytest.approx(1000**power * package(name, CASE), rel=1e-12)
        assert close(loop.truth(name, in_millimetres), 1000**power * loop.truth(name, CASE), 0, 12)


# --- worked numbers, Sec. III.B -------------------------------------------------------------------

PRINTED = {"omega_BC": 29.5, "V_C": -20.2, "alpha_BC": -7740.0, "a_C": -994.0}


def recomputed(name):
    """A worked number from the loop closure, which the package repeats to rounding."""
    true = loop.truth(name, CASE)
    assert close(package(name, CASE), true, 0, 13)
    return float(true)


def test_case1_omega0():
    exact = 1500 * TURN / 60
    assert exact == pytest.approx(157.0796, abs=5e-5)
    assert float(f"{exact:.2f}") == SPEED
    for name, printed in PRINTED.items():
        assert three_digits(package(name, CASE._replace(omega0=exact))) == printed


def test_sense_of_rotation():
    """In the paper's frame the pin moves about A anticlockwise, if its axes are right-handed."""
    for motion in DESIGNS:
        p = float_point(motion)
        (x, y), (vx, vy) = (p.AB * math.sin(p.theta), -p.pin_height), A.printed_eq2(p.theta, p.AB, p.omega)
        assert x * vy - y * vx == pytest.approx(p.AB**2 * p.omega, rel=1e-12)
        mirror = motion._replace(
            theta=-motion.theta, ec=-motion.ec, omega0=-motion.omega0, alpha=-motion.alpha
        )
        for name in ("V_C", "a_C"):
            assert close(package(name, mirror), package(name, motion), scale_of("acceleration", motion), 12)
            assert close(loop.truth(name, mirror), loop.truth(name, motion), 0, 25)


def test_case1_omega_BC():
    assert recomputed("omega_BC") == pytest.approx(29.496, abs=5e-4)
    assert (
        three_digits(recomputed("omega_BC")) == three_digits(SHEET.omega_BC(*CASE[:4])) == PRINTED["omega_BC"]
    )


def test_case1_V_C():
    assert recomputed("V_C") == pytest.approx(-20.197, abs=5e-4)
    assert three_digits(A.printed_eq11(*CASE[:5])) == three_digits(recomputed("V_C")) == PRINTED["V_C"]
    assert three_digits(SHEET.V_C(*CASE[:4])) == -PRINTED["V_C"]


def test_case1_direction():
    assert (
        float(loop.truth("Y", CASE))
        == pytest.approx(package("Y", CASE), rel=1e-13)
        == pytest.approx(0.39534, abs=5e-6)
    )
    later = CASE._replace(theta=CASE.theta + 1e-6)
    assert 0 < package("Y", later) < package("Y", CASE)
    assert recomputed("V_C") < 0


def test_case1_sizes():
    assert [three_digits(abs(recomputed(name))) for name in ("V_C", "omega_BC")] == [20.2, 29.5]


def test_case2_alpha_BC():
    assert recomputed("alpha_BC") == pytest.approx(-7742.1, abs=0.05)
    assert (
        three_digits(recomputed("alpha_BC")) == three_digits(SHEET.alpha_BC(*CASE[:4])) == PRINTED["alpha_BC"]
    )


def test_case2_a_C():
    assert recomputed("a_C") == pytest.approx(-993.605, abs=5e-4)
    assert three_digits(SHEET.corrected_a_C(*CASE[:4])) == three_digits(recomputed("a_C")) == PRINTED["a_C"]
    assert three_digits(A.printed_eq19(*CASE[:5], 0.0)) == three_digits(SHEET.a_C(*CASE[:4])) == -2090.0


def test_case2_sizes():
    assert [three_digits(abs(recomputed(name))) for name in ("alpha_BC", "a_C")] == [7740.0, 994.0]


def growth_of_speed(motion):
    """d|V_C|/dt at constant omega from the package's V_C at two angles, m/s2."""
    step = 1e-6
    after, before = (abs(package("V_C", motion._replace(theta=motion.theta + h))) for h in (step, -step))
    return (after - before) / (2 * step) * motion.omega0


def test_negative_acceleration_is_not_deceleration():
    assert recomputed("a_C") < 0 < growth_of_speed(CASE)


def test_positive_velocity_slows_down():
    slowing = CASE._replace(theta=math.radians(300))
    assert three_digits(package("V_C", slowing)) == 20.2
    assert three_digits(package("a_C", slowing)) == -994.0
    assert growth_of_speed(slowing) == pytest.approx(float(loop.truth("a_C", slowing)), rel=1e-6)
    assert growth_of_speed(slowing) < 0


def test_negative_velocity_speeds_up():
    assert recomputed("V_C") < 0
    assert growth_of_speed(CASE) == pytest.approx(-recomputed("a_C"), rel=1e-6)
    assert three_digits(growth_of_speed(CASE)) == 994.0


def test_printed_functions_fail_the_validation():
    printed = {name: three_digits(getattr(SHEET, name)(*CASE[:4])) for name in PRINTED}
    assert [name for name in PRINTED if printed[name] == PRINTED[name]] == ["omega_BC", "alpha_BC"]
    assert (printed["V_C"], printed["a_C"]) == (20.2, -2090.0)
    assert round(SHEET.a_C(*CASE[:4])) == -2091
    corrected = SHEET.corrected_V_C(*CASE[:4]), SHEET.corrected_a_C(*CASE[:4])
    assert [three_digits(value) for value in corrected] == [PRINTED["V_C"], PRINTED["a_C"]]


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


def test_validation_cannot_see_ec_or_alpha():
    for mutant in MUTANTS:
        assert {name: three_digits(value) for name, value in mutated(mutant, CASE).items()} == PRINTED
        for motion in DESIGNS:
            wrong = mutated(mutant, motion)["a_C"]
            assert wrong != pytest.approx(package("a_C", motion), rel=1e-6)
            assert wrong != pytest.approx(float(loop.truth("a_C", motion)), rel=1e-6)


CONCENTRIC = [motion._replace(ec=0.0) for motion in DESIGNS]


def test_concentric_designs():
    agrees(lambda p: p.sheet.omega_BC(*p.design), lambda q, p: q("omega_BC"), "rate", CONCENTRIC)
    agrees(lambda p: p.sheet.corrected_V_C(*p.design), lambda q, p: q("V_C"), "velocity", CONCENTRIC)
    agrees(lambda p: p.sheet.alpha_BC(*p.design), lambda q, p: q("alpha_BC"), "rate2", CONCENTRIC)
    agrees(lambda p: p.sheet.corrected_a_C(*p.design), lambda q, p: q("a_C"), "acceleration", CONCENTRIC)
