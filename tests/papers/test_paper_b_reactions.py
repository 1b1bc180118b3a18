"""Paper B, Secs. 3.3 and 4.2.2: reactions, shaking forces, and what makes torque."""

import math

import numpy as np
from mpmath import mp, mpf

from tests.papers import curves_b as curves
from tests.papers import free_bodies
from tests.papers import paper_b as B
from tests.papers.curves_b import CENTRES, OFFSETS, case_1, mean, motion_of, places, torques
from tests.papers.designs import close
from tests.papers.designs_b import LOADED, TABLE_1_BODIES, equivalent, exact_case, lumped, sweep
from tests.papers.extremes import golden, greatest
from tests.papers.free_bodies import Bodies
from tests.papers.proofs import proves

LUMPED, ROD = TABLE_1_BODIES["two masses"], TABLE_1_BODIES["uniform rod"]


def solved(theta, e, bodies):
    """The free bodies of Table 1 at a crank angle in rad."""
    return free_bodies.solve(motion_of(case_1(mpf(theta), e)), bodies)


@proves(
    "B-text-pin-or-centre",
    "wrong claim",
    says="Reactions at the crank centre (R_x and R_y) ... the reactions at the crank pin are",
    cites="38 39",
)
@proves("B-claim-pin-shakes", "wrong claim", cites="46a")
def test_pin_and_centre_are_two_places():
    """The force at the crank pin is neither that at the crank centre nor what shakes the frame."""
    for motion, masses in LOADED:
        f = free_bodies.solve(motion, lumped(motion, masses))
        pin, centre = mp.hypot(f["F_B_X"], f["F_B_Y"]), mp.hypot(f["F_A_X"], f["F_A_Y"])
        shaking = mp.hypot(f["F_A_X"] + f["N_C"], f["F_A_Y"])
        assert abs(pin - centre) > 1e-3 * centre
        assert abs(pin - shaking) > 1e-3 * shaking
        q, m_2, m_3 = equivalent(motion, masses)
        total = B.printed_eq46a(q, m_2, m_3, B.corrected_eq20(q))
        assert close(mp.hypot(*total), shaking, shaking, 30)


@proves("B-fig-12", "typo", says="11 12", cites="12")
def test_captions_of_figs_11_and_12():
    """The two reactions that Figs. 11 and 12 are to show, from the free bodies: two curves."""
    forces = [solved(math.radians(n), 20, LUMPED) for n in range(0, 360, 15)]
    along, across = ([float(f[name]) for f in forces] for name in ("F_A_Y", "F_A_X"))
    assert abs(np.corrcoef(along, across)[0, 1]) < 0.8
    (x, _), (y, angle) = (places(curve) for curve in (reaction_x, reaction_y))
    theta = mp.radians(angle)
    assert close(abs(solved(theta, 20, LUMPED)["F_A_X"]), y, 0, 14)

    def with_rod(t):
        return abs(float(solved(t, 20, ROD)["F_A_X"]))

    top = with_rod(golden(with_rod, float(theta) - 0.1, float(theta) + 0.1, 1e-5))
    assert all(with_rod(math.radians(n)) <= top for n in range(0, 360, 30))
    return {"x": x / 1000, "y": y / 1000, "uniform": mpf(top) / 1000}


def reaction_x(q):
    """The reaction at the crank centre along x, N: Eq. 38 corrected."""
    return B.corrected_eq38(q, *curves.like(q, *CENTRES))


def reaction_y(q):
    """The reaction at the crank centre along y, N: Eq. 39 corrected."""
    return B.corrected_eq39(q, *curves.like(q, *CENTRES))


@proves("B-claim-shear", "wrong claim", says="11 12", cites="41 38 39 1 38 39")
def test_pin_is_sheared_by_the_rod():
    """At the pin acts the rod's force; Eqs. 38 and 39 have the force on the rotating mass alone."""
    for motion, masses in LOADED[:4]:
        f = free_bodies.solve(motion, lumped(motion, masses))
        q, _, m_3 = equivalent(motion, masses)
        assert close(mp.hypot(f["F_B_X"], f["F_B_Y"]), abs(B.corrected_eq41(q, m_3)), 0, 30)
    pin = places(lambda q: B.corrected_eq41(q, *curves.like(q, CENTRES[1])))[0]
    size = B.printed_eq37a(case_1(mpf(0)), *curves.like(case_1(mpf(0)), CENTRES[0]))
    return {"pin": pin / 1000, "size": size / 1000}


@proves("B-fig-13", "wrong claim", says="13 13", cites="46b 46a 1")
def test_total_inertia_force_has_two_parts():
    """The sum in the text is Eq. 46b, the part along x; Eq. 46a has one along y, of the rotating mass."""
    q = case_1(mpf(1))
    masses = curves.like(q, *CENTRES)
    assert B.printed_eq46a(q, *masses, B.corrected_eq20(q))[0] == reaction_x(q)
    return {"along": places(reaction_x)[0], "across": B.printed_eq37a(q, masses[0])}


def shaking_force(q):
    """Size of the force on the frame in the paper's model, N."""
    return q.m.hypot(*B.printed_eq46a(q, *curves.like(q, *CENTRES), B.corrected_eq20(q)))


@proves("B-claim-balanced", "wrong claim", says="0 0")
def test_not_balanced_without_offset():
    """Shaking forces and a torque that changes its sign remain without an offset: nothing is balanced."""
    centric, offset = (places(shaking_force, e)[0] for e in (0, 20))
    least = -greatest(lambda t: -shaking_force(case_1(t, 0)))[0]
    assert least > 800
    return {
        "shaking": centric,
        "least": mpf(800),
        "offset": [offset, mpf(20)],
        "torque": torques(curves.right)[0][0],
    }


@proves("B-claim-total-inertia", "wrong claim")
def test_only_the_reciprocating_mass_makes_torque():
    for motion, masses in LOADED:
        _, _, m_3 = equivalent(motion, masses)
        whole = free_bodies.solve(motion, lumped(motion, masses))["T_in"]
        slider = free_bodies.solve(motion, Bodies(m_slider=m_3))["T_in"]
        assert close(whole, slider, abs(whole), 30)
        assert close(slider, B.drive_torque(exact_case(motion), m_3), abs(whole), 30)


@proves("B-text-torque-of-crank", "correct", cites="40 48")
def test_torque_is_crank_length_times_tangential_force():
    for motion, masses in LOADED:
        q, _, m_3 = equivalent(motion, masses)
        across = B.corrected_eq40(q, B.corrected_eq41(q, m_3))
        want = -free_bodies.solve(motion, lumped(motion, masses))["T_in"]
        assert close(q.k * across, want, abs(want), 30)


@proves("B-text-tangential", "wrong claim")
def test_tangential_force_opposes_the_motion_half_the_time():
    values = [B.corrected_eq40(q, B.corrected_eq41(q, 1.05)) for q in map(case_1, sweep(720))]
    assert 0.3 < sum(value > 0 for value in values) / len(values) < 0.7


@proves("B-text-constant-force", "wrong claim")
def test_constant_force_does_not_turn_it_evenly():
    """The torque that keeps the speed even changes its sign four times a turn; a constant one does not."""
    for e in OFFSETS:
        values = [curves.right(case_1(angle, e)) for angle in sweep(3601)]
        assert sum((a > 0) != (b > 0) for a, b in zip(values, values[1:] + values[:1], strict=True)) == 4
    assert abs(mean()) < mpf(10) ** -20
