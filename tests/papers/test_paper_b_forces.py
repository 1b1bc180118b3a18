"""Paper B: equivalent masses, forces and torques, Eqs. 31 to 48."""

import pytest
from mpmath import mp, mpf

from tests.papers import curves_b as curves
from tests.papers import free_bodies, loop
from tests.papers import paper_b as B
from tests.papers.designs import close
from tests.papers.designs_b import (
    LOADED,
    balanced,
    equivalent,
    exact_case,
    exact_masses,
    excess,
    force_scale,
    unbalanced,
)
from tests.papers.free_bodies import Bodies
from tests.papers.proofs import proves

# --- equivalent masses ----------------------------------------------------------------------------


def rod_bodies(masses):
    """The rod alone, with its centre of mass, as free bodies."""
    return Bodies(m_rod=masses.m_c, r_rod=masses.c_2)


@proves("B-text-moment-point-3", "typo", says="3", cites="3 32 2 33 3 33 2")
def test_moment_about_point_2():
    """Moments about point 2 give Eq. 33; with Eq. 32 the two masses keep the rod's centre of mass."""
    for motion, masses in LOADED:
        q, w = exact_case(motion), exact_masses(masses)
        G, P, C = (
            free_bodies.rod_centre(motion, rod_bodies(masses)),
            loop.pin(motion),
            loop.slider(motion),
        )
        assert close(B.printed_eq33(q, w) * q.c, w.m_c * mp.hypot(G[0] - P[0], G[1] - P[1]), 0, 30)
        for axis in (0, 1):
            both = B.printed_eq32(q, w) * P[axis] + B.printed_eq33(q, w) * C[axis]
            assert close(both, w.m_c * G[axis], w.m_c * q.c, 30)


def rod_as_two_masses(motion, masses):
    """Forces of the mechanism with the rod's mass moved to its ends, otherwise unchanged."""
    q, w = exact_case(motion), exact_masses(masses)
    moved = Bodies(m_crank=B.printed_eq32(q, w), r_crank=q.k, m_slider=B.printed_eq34(q, w))
    return free_bodies.solve(motion, moved)


@proves("B-text-forces-a_c", "wrong claim", cites="37 48 B-claim-equivalent-masses")
@proves("B-claim-equivalent-masses", "correct", cites="31 36 1")
def test_lumped_rod_turns_too_heavily():
    """Two masses at the pins keep mass and centre but not the moment of inertia, and the torque shows it."""
    for motion, masses in LOADED:
        q, w = exact_case(motion), exact_masses(masses)
        two = B.printed_eq32(q, w) * w.c_2**2 + B.printed_eq33(q, w) * (q.c - w.c_2) ** 2
        inertia = w.m_c * q.c**2 / 17
        assert close(two - inertia, excess(motion, masses, inertia), two, 30)
        about_B, about_C = (inertia + w.m_c * d**2 for d in (w.c_2, q.c - w.c_2))
        assert close(B.printed_eq33(q, w) * q.c**2 - about_B, excess(motion, masses, inertia), about_B, 30)
        assert close(B.printed_eq32(q, w) * q.c**2 - about_C, excess(motion, masses, inertia), about_C, 30)
        true = free_bodies.solve(motion, Bodies(m_rod=w.m_c, m_slider=w.m_s, I_rod=inertia, r_rod=w.c_2))
        moved = rod_as_two_masses(motion, masses)
        turning = loop.truth("omega_BC", motion) * loop.truth("alpha_BC", motion) / loop.omega(motion)
        difference = moved["T_in"] - true["T_in"]
        want = excess(motion, masses, inertia) * turning
        scale = force_scale(motion, w.m_c, w.m_s) * q.k
        assert close(difference, want, scale, 30)
        assert abs(difference) > 1e-9 * scale
        share = B.printed_eq33(q, w) * loop.truth("a_C", motion)
        assert close(moved["F_A_Y"], true["F_A_Y"], scale / q.k, 30)
        assert close(moved["F_C_Y"] - true["F_C_Y"], share, scale / q.k, 30)
    letters = dict(zip(("m_k", "m_c", "m_s", "k_1", "c_2"), w, strict=True))
    names = letters | {"c_3": q.c - w.c_2, "I": inertia, "alpha_BC": loop.truth("alpha_BC", motion)}
    names |= {name: loop.truth(name, motion) for name in ("omega_BC", "omega")}
    return rod_of_table_1() | {"excess": two - inertia, "difference": difference, "names": names}


def rod_of_table_1():
    """Inertia of the uniform rod, kg mm2, and the torque's peaks with two masses and with it."""
    mass, length = mpf("0.5"), mpf(64)
    uniform = mp.quad(lambda z: mass / length * z**2, [-length / 2, length / 2])
    assert close(mass * (length / 2) ** 2, 3 * uniform, 0, 30)
    two, rod = (
        [max(pair) for pair in curves.torques(reading).values()] for reading in (curves.right, curves.uniform)
    )
    return {"rod": uniform, "offsets": list(map(mpf, curves.OFFSETS)), "two": two, "uniform": rod}


# --- forces ---------------------------------------------------------------------------------------


@proves("B-text-inertia-direction", "wrong claim")
def test_text_inertia_force_points_outwards():
    """What points to the centre is the force on the mass; its inertia pulls outwards, at the frame."""
    for motion, masses in LOADED:
        q, m_2, _ = equivalent(motion, masses)
        f = free_bodies.solve(motion, Bodies(m_crank=m_2, r_crank=q.k))
        on_crank, place = (f["F_A_Y"], f["F_A_X"]), (q.k * q.cos, q.k * q.sin)
        towards = B.printed_eq37b(q, m_2)
        assert all(close(a, b, B.printed_eq37a(q, m_2), 30) for a, b in zip(on_crank, towards, strict=True))
        assert sum(a * b for a, b in zip(towards, place, strict=True)) < 0
        shaking = [-a for a in on_crank]
        assert sum(a * b for a, b in zip(shaking, place, strict=True)) > 0


def test_eq41_is_endless_where_crank_and_rod_cross():
    """Where they make a right angle the printed force on the rod and the tangential force have no bound."""
    for motion, masses in LOADED:
        with mp.workdps(loop.DIGITS):
            crossing = mp.atan2(motion.BC, motion.AB) - mp.asin(
                mpf(motion.ec) / mp.hypot(motion.AB, motion.BC)
            )
            q, m_2, m_3 = equivalent(motion._replace(theta=crossing), masses)
            assert close(B.printed_eq22(q) + q.theta, mp.pi / 2, 1, 30)
            assert abs(B.printed_eq41(q, m_2)) > mpf(10) ** 20 * abs(B.corrected_eq41(q, m_3))
            assert abs(B.printed_eq40(q, m_2)) > mpf(10) ** 20 * abs(B.corrected_eq41(q, m_3))


def test_share_of_the_rotating_mass():
    """Eqs. 38 and 39 as printed are what is left at the crank centre without the rod's force."""
    balanced(lambda q, m_2, m_3: B.printed_eq38(q, m_2), lambda f, q: f["F_A_Y"] - f["F_B_Y"])
    balanced(lambda q, m_2, m_3: B.printed_eq39(q, m_2), lambda f, q: f["F_A_X"] - f["F_B_X"])


def test_eq42b_is_not_eq42a_with_eq20():
    for motion, masses in LOADED:
        with mp.workdps(loop.DIGITS):
            q, _, m_3 = equivalent(motion, masses)
            printed, by_eq20 = B.printed_eq42b(q, m_3), B.printed_eq42a(m_3, B.printed_eq20(q))
            assert not close(printed, by_eq20, force_scale(motion, 0, m_3), 6)


@pytest.mark.parametrize(("sign", "times"), [(1, 2), (-1, 0)])
def test_eq45_counts_one_force_twice_or_not_at_all(sign, times):
    def printed(q, m_2, m_3):
        F_Is, F_c = sign * B.corrected_eq42a(q, m_3), B.corrected_eq41(q, m_3)
        return B.printed_eq45(F_Is, F_c, B.printed_eq22(q), q.m)

    balanced(printed, lambda f, q: times * f["F_C_Y"])


@pytest.mark.parametrize(
    "half",
    [
        lambda q, m_2, m_3: B.printed_eq48(q, B.corrected_eq42a(q, m_3)),
        lambda q, m_2, m_3: B.corrected_eq48(q, B.printed_eq46b(q, m_2, m_3, B.corrected_eq20(q))),
    ],
)
def test_half_of_the_repair_of_eq48(half):
    unbalanced(half, lambda f, q: -f["T_in"])


# --- torques --------------------------------------------------------------------------------------


@proves("B-text-torque", "wrong claim", cites="47")
@proves("B-eq47", "wrong claim")
def test_rotating_mass_needs_no_torque():
    """The rotating mass alone needs no torque at constant speed: its force is radial."""
    for motion, masses in LOADED:
        q, m_2, _ = equivalent(motion, masses)
        f = free_bodies.solve(motion, Bodies(m_crank=m_2, r_crank=q.k))
        scale = force_scale(motion, m_2, 0) * q.k
        assert close(f["T_in"], 0, scale, 30)
        F_x, F_y = B.printed_eq37b(q, m_2)
        assert close(q.k * q.cos * F_y - q.k * q.sin * F_x, 0, scale, 30)
        assert close(B.printed_eq47(q, m_2), q.k * f["F_A_Y"], scale, 30)
        assert abs(B.printed_eq47(q, m_2)) > 1e-3 * m_2 * q.omega**2 * q.k**2
