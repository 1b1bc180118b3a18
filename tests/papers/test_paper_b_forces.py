"""Paper B: equivalent masses, forces and torques, Eqs. 31 to 48."""

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
    lumped,
    unbalanced,
)
from tests.papers.free_bodies import Bodies
from tests.papers.proofs import proves

# --- equivalent masses ----------------------------------------------------------------------------


@proves("B-eq31", "correct", cites="32 33")
def test_eq31():
    for motion, masses in LOADED:
        with mp.workdps(loop.DIGITS):
            q, w = exact_case(motion), exact_masses(masses)
            parts = B.printed_eq32(q, w), B.printed_eq33(q, w)
            assert close(B.printed_eq31(*parts), w.m_c, 0, 30)


def rod_bodies(masses):
    """The rod alone, with its centre of mass, as free bodies."""
    return Bodies(m_rod=masses.m_c, r_rod=masses.c_2)


@proves("B-eq32", "correct", cites="3")
def test_eq32():
    """Moments about point 3: the rod's mass at its centre and m_2c at the pin weigh the same."""
    for motion, masses in LOADED:
        with mp.workdps(loop.DIGITS):
            q, w = exact_case(motion), exact_masses(masses)
            (x, y), C = free_bodies.rod_centre(motion, rod_bodies(masses)), loop.slider(motion)
            true = w.m_c * mp.hypot(x - C[0], y - C[1])
            assert close(B.printed_eq32(q, w) * q.c, true, 0, 30)


@proves("B-text-moment-point-3", "typo", says="3", cites="3 32 2 33 3 33 2")
@proves("B-eq33", "correct", cites="2 3 32")
def test_eq33():
    """Moments about point 2; with Eq. 32 the two masses keep the rod's centre of mass."""
    for motion, masses in LOADED:
        with mp.workdps(loop.DIGITS):
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


@proves("B-eq34", "correct")
def test_eq34():
    """The push that m_3 needs along the axis is that of the slider and of the rod's share together."""
    for motion, masses in LOADED:
        with mp.workdps(loop.DIGITS):
            q, w = exact_case(motion), exact_masses(masses)
            push = rod_as_two_masses(motion, masses)["F_C_Y"]
            want = (w.m_s + w.m_c - B.printed_eq32(q, w)) * loop.truth("a_C", motion)
            assert close(push, want, force_scale(motion, w.m_c, w.m_s), 30)
            assert close(push, B.printed_eq34(q, w) * loop.truth("a_C", motion), abs(push), 30)


@proves("B-eq35", "correct")
def test_eq35():
    """m_2k at the pin shakes the frame as the crank's mass does at its centre."""
    for motion, masses in LOADED:
        with mp.workdps(loop.DIGITS):
            q, w = exact_case(motion), exact_masses(masses)
            true = free_bodies.solve(motion, Bodies(m_crank=w.m_k, r_crank=w.k_1))
            moved = free_bodies.solve(motion, Bodies(m_crank=B.printed_eq35(q, w), r_crank=q.k))
            for name in ("F_A_X", "F_A_Y"):
                assert close(moved[name], true[name], force_scale(motion, w.m_k, 0), 30)


def total_inertia(motion, masses):
    """Masses times accelerations of crank, rod and slider along x and y, from the raw loop, N."""
    bodies = Bodies(r_crank=masses.k_1, r_rod=masses.c_2)
    places = (
        (masses.m_k, lambda t: free_bodies.crank_centre(motion, bodies, t)),
        (masses.m_c, lambda t: free_bodies.rod_centre(motion, bodies, t)),
        (masses.m_s, lambda t: loop.slider(motion, t)),
    )
    parts = [(mpf(m), free_bodies.second_rate(place)) for m, place in places]
    return sum(m * a[1] for m, a in parts), sum(m * a[0] for m, a in parts)


@proves("B-eq36", "correct")
def test_eq36():
    """With m_2 and m_3 the model has the true bodies' total of mass times acceleration."""
    for motion, masses in LOADED:
        with mp.workdps(loop.DIGITS):
            q, m_2, m_3 = equivalent(motion, masses)
            a_B, a_C = (loop.truth("a_B_Y", motion), loop.truth("a_B_X", motion)), loop.truth("a_C", motion)
            got = m_2 * a_B[0] + m_3 * a_C, m_2 * a_B[1]
            scale = force_scale(motion, m_2, m_3)
            assert all(
                close(g, t, scale, 30) for g, t in zip(got, total_inertia(motion, masses), strict=True)
            )
            assert close(m_2, sum(exact_masses(masses)[:2]) - rest_of_mass(q, masses), 0, 30)


def rest_of_mass(q, masses):
    """The mass of crank and rod that is not at the pin, kg: at the crank centre and at the slider."""
    w = exact_masses(masses)
    return w.m_k * (1 - w.k_1 / q.k) + B.printed_eq33(q, w)


@proves("B-text-forces-a_c", "wrong claim", cites="37 48 B-claim-equivalent-masses")
@proves("B-claim-equivalent-masses", "correct", cites="31 36 1")
def test_lumped_rod_turns_too_heavily():
    """Two masses at the pins keep mass and centre but not the moment of inertia, and the torque shows it."""
    for motion, masses in LOADED:
        with mp.workdps(loop.DIGITS):
            q, w = exact_case(motion), exact_masses(masses)
            two = B.printed_eq32(q, w) * w.c_2**2 + B.printed_eq33(q, w) * (q.c - w.c_2) ** 2
            inertia = w.m_c * q.c**2 / 17
            assert close(two - inertia, excess(motion, masses, inertia), two, 30)
            about_B, about_C = (inertia + w.m_c * d**2 for d in (w.c_2, q.c - w.c_2))
            assert close(
                B.printed_eq33(q, w) * q.c**2 - about_B, excess(motion, masses, inertia), about_B, 30
            )
            assert close(
                B.printed_eq32(q, w) * q.c**2 - about_C, excess(motion, masses, inertia), about_C, 30
            )
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


@proves("B-eq37a", "correct", cites="37b B-text-inertia-direction")
def test_eq37a():
    for motion, masses in LOADED:
        with mp.workdps(loop.DIGITS):
            q, m_2, _ = equivalent(motion, masses)
            size = m_2 * mp.hypot(loop.truth("a_B_X", motion), loop.truth("a_B_Y", motion))
            assert close(B.printed_eq37a(q, m_2), size, 0, 30)
            assert close(B.printed_eq37a(q, m_2), mp.hypot(*B.printed_eq37b(q, m_2)), 0, 30)


@proves("B-eq37b", "correct", cites="B-text-inertia-direction")
def test_eq37b():
    for motion, masses in LOADED:
        with mp.workdps(loop.DIGITS):
            q, m_2, _ = equivalent(motion, masses)
            want = m_2 * loop.truth("a_B_Y", motion), m_2 * loop.truth("a_B_X", motion)
            got = B.printed_eq37b(q, m_2)
            assert all(close(g, w, force_scale(motion, m_2, 0), 30) for g, w in zip(got, want, strict=True))


@proves("B-text-inertia-direction", "wrong claim")
def test_text_inertia_force_points_outwards():
    """What points to the centre is the force on the mass; its inertia pulls outwards, at the frame."""
    for motion, masses in LOADED:
        with mp.workdps(loop.DIGITS):
            q, m_2, _ = equivalent(motion, masses)
            f = free_bodies.solve(motion, Bodies(m_crank=m_2, r_crank=q.k))
            on_crank, place = (f["F_A_Y"], f["F_A_X"]), (q.k * q.cos, q.k * q.sin)
            towards = B.printed_eq37b(q, m_2)
            assert all(
                close(a, b, B.printed_eq37a(q, m_2), 30) for a, b in zip(on_crank, towards, strict=True)
            )
            assert sum(a * b for a, b in zip(towards, place, strict=True)) < 0
            shaking = [-a for a in on_crank]
            assert sum(a * b for a, b in zip(shaking, place, strict=True)) > 0


@proves("B-eq38", "wrong claim", cites="46b")
def test_eq38():
    balanced(B.corrected_eq38, lambda f, q: f["F_A_Y"])
    unbalanced(lambda q, m_2, m_3: B.printed_eq38(q, m_2), lambda f, q: f["F_A_Y"])
    balanced(lambda q, m_2, m_3: B.printed_eq38(q, m_2), lambda f, q: f["F_A_Y"] - f["F_B_Y"])


@proves("B-eq39", "wrong claim")
def test_eq39():
    balanced(B.corrected_eq39, lambda f, q: f["F_A_X"])
    unbalanced(lambda q, m_2, m_3: B.printed_eq39(q, m_2), lambda f, q: f["F_A_X"])
    balanced(lambda q, m_2, m_3: B.printed_eq39(q, m_2), lambda f, q: f["F_A_X"] - f["F_B_X"])


def across_the_crank(f, q):
    """The rod's force on the crank along the crank's circle, in the sense of theta, N."""
    return -(f["F_B_X"] * q.cos - f["F_B_Y"] * q.sin)


def along_the_rod(f, q):
    """The rod's push on the slider, N: along B to C, which is (cos alpha, -sin alpha) in x and y."""
    alpha = B.printed_eq22(q)
    return f["F_C_Y"] * q.m.cos(alpha) - f["F_C_X"] * q.m.sin(alpha)


def force_on_rotating_mass(f, q):
    """The size of the radial force F_k on m_2, N: what the frame applies less what goes on into the rod."""
    return q.m.hypot(f["F_A_X"] - f["F_B_X"], f["F_A_Y"] - f["F_B_Y"])


@proves("B-eq40", "wrong claim")
def test_eq40():
    balanced(
        lambda q, m_2, m_3: B.printed_eq40(q, m_2) / q.m.tan(B.printed_eq22(q) + q.theta),
        force_on_rotating_mass,
    )
    balanced(lambda q, m_2, m_3: B.corrected_eq40(q, B.corrected_eq41(q, m_3)), across_the_crank)
    unbalanced(lambda q, m_2, m_3: B.printed_eq40(q, m_2), across_the_crank)
    unbalanced(lambda q, m_2, m_3: -B.printed_eq40(q, m_2), across_the_crank)
    for motion, masses in LOADED:  # Eqs. 40 and 41 hold for the radial part of the rod's own force
        with mp.workdps(loop.DIGITS):
            q, _, m_3 = equivalent(motion, masses)
            F_c = B.corrected_eq41(q, m_3)
            radial = F_c * mp.cos(B.printed_eq22(q) + q.theta)
            assert close(radial * mp.tan(B.printed_eq22(q) + q.theta), B.corrected_eq40(q, F_c), abs(F_c), 30)


@proves("B-eq41", "wrong claim")
def test_eq41():
    balanced(
        lambda q, m_2, m_3: B.printed_eq41(q, m_2) * q.m.cos(B.printed_eq22(q) + q.theta),
        force_on_rotating_mass,
    )
    balanced(lambda q, m_2, m_3: B.corrected_eq41(q, m_3), along_the_rod)
    unbalanced(lambda q, m_2, m_3: B.printed_eq41(q, m_2), along_the_rod)
    unbalanced(lambda q, m_2, m_3: -B.printed_eq41(q, m_2), along_the_rod)


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


@proves("B-eq42a", "correct", cites="9 14 37 46")
def test_eq42a():
    for motion, masses in LOADED:
        with mp.workdps(loop.DIGITS):
            _, _, m_3 = equivalent(motion, masses)
            a_s = -loop.truth("a_C", motion)
            push = m_3 * loop.truth("a_C", motion)
            assert close(B.printed_eq42a(m_3, a_s), push, force_scale(motion, 0, m_3), 30)
    balanced(lambda q, m_2, m_3: B.corrected_eq42a(q, m_3), lambda f, q: f["F_C_Y"])


def slips_of_eq42b(q, m_3):
    """The sum of the printed and the right form of Eq. 42b, N: due to the missing e and the last sign."""
    lost = q.omega**2 * q.k * (q.e - 1) * q.sin / q.root(1)
    return m_3 * (lost - 2 * B.a_s_terms(q, 1, 3)[2])


@proves("B-eq42b", "sign and missing factor", cites="42a 20")
def test_eq42b():
    balanced(lambda q, m_2, m_3: slips_of_eq42b(q, m_3) - B.printed_eq42b(q, m_3), lambda f, q: f["F_C_Y"])
    balanced(lambda q, m_2, m_3: B.corrected_eq42b(q, m_3), lambda f, q: f["F_C_Y"])
    unbalanced(lambda q, m_2, m_3: B.printed_eq42b(q, m_3), lambda f, q: f["F_C_Y"])
    unbalanced(lambda q, m_2, m_3: -B.printed_eq42b(q, m_3), lambda f, q: f["F_C_Y"])
    for motion, masses in LOADED:
        with mp.workdps(loop.DIGITS):
            q, _, m_3 = equivalent(motion, masses)
            large = q._replace(e=1000 * q.e, k=1000 * q.k, c=1000 * q.c)  # the same in millimetres
            scale = 1000 * force_scale(motion, 0, m_3)
            assert close(B.corrected_eq42b(large, m_3), 1000 * B.corrected_eq42b(q, m_3), scale, 30)
            assert not close(B.printed_eq42b(large, m_3), 1000 * B.printed_eq42b(q, m_3), scale, 6)
            assert not close(
                B.printed_eq42b(q, m_3), B.printed_eq42a(m_3, B.printed_eq20(q)), scale / 1000, 6
            )


@proves("B-eq43", "correct", cites="41")
def test_eq43():
    balanced(
        lambda q, m_2, m_3: B.printed_eq43(B.corrected_eq41(q, m_3), B.printed_eq22(q), q.m),
        lambda f, q: f["F_C_Y"],
    )


@proves("B-eq44", "correct")
def test_eq44():
    balanced(
        lambda q, m_2, m_3: B.printed_eq44(B.corrected_eq41(q, m_3), B.printed_eq22(q), q.m),
        lambda f, q: -f["F_C_X"],
    )
    balanced(
        lambda q, m_2, m_3: B.printed_eq44(B.corrected_eq41(q, m_3), B.printed_eq22(q), q.m),
        lambda f, q: f["N_C"],
    )


@proves("B-eq45", "wrong claim")
def test_eq45():
    """The inertia force IS the rod's push: adding them counts one force twice, or gives nothing."""

    def printed(q, sign, m_3):
        alpha = B.printed_eq22(q)
        return B.printed_eq45(sign * B.corrected_eq42a(q, m_3), B.corrected_eq41(q, m_3), alpha, q.m)

    balanced(lambda q, m_2, m_3: printed(q, 1, m_3), lambda f, q: 2 * f["F_C_Y"])
    balanced(lambda q, m_2, m_3: printed(q, -1, m_3), lambda f, q: 0)
    balanced(lambda q, m_2, m_3: B.corrected_eq42a(q, m_3), lambda f, q: f["F_C_Y"])
    unbalanced(lambda q, m_2, m_3: printed(q, 1, m_3), lambda f, q: f["F_C_Y"])


@proves("B-eq46a", "correct", cites="20 B-text-inertia-direction")
def test_eq46a():
    """All outer forces of the mechanism: the frame's on the crank and the guide's on the slider."""
    balanced(
        lambda q, m_2, m_3: B.printed_eq46a(q, m_2, m_3, B.corrected_eq20(q)),
        lambda f, q: (f["F_A_Y"], f["F_A_X"] + f["N_C"]),
    )
    for motion, masses in LOADED:
        with mp.workdps(loop.DIGITS):
            q, m_2, m_3 = equivalent(motion, masses)
            got = B.printed_eq46a(q, m_2, m_3, B.corrected_eq20(q))
            want = total_inertia(motion, masses)
            assert all(close(g, w, force_scale(motion, m_2, m_3), 30) for g, w in zip(got, want, strict=True))


@proves("B-eq46b", "correct", cites="46a B-text-inertia-direction")
def test_eq46b():
    balanced(lambda q, m_2, m_3: B.printed_eq46b(q, m_2, m_3, B.corrected_eq20(q)), lambda f, q: f["F_A_Y"])
    unbalanced(
        lambda q, m_2, m_3: B.printed_eq46b(q, m_2, m_3, -B.corrected_eq20(q)), lambda f, q: f["F_A_Y"]
    )


# --- torques --------------------------------------------------------------------------------------


@proves("B-text-torque", "wrong claim", cites="47")
@proves("B-eq47", "wrong claim")
def test_eq47():
    """The rotating mass alone needs no torque at constant speed: its force is radial."""
    for motion, masses in LOADED:
        with mp.workdps(loop.DIGITS):
            q, m_2, _ = equivalent(motion, masses)
            f = free_bodies.solve(motion, Bodies(m_crank=m_2, r_crank=q.k))
            scale = force_scale(motion, m_2, 0) * q.k
            assert close(f["T_in"], 0, scale, 30)
            F_x, F_y = B.printed_eq37b(q, m_2)
            assert close(q.k * q.cos * F_y - q.k * q.sin * F_x, 0, scale, 30)
            assert close(B.printed_eq47(q, m_2), q.k * f["F_A_Y"], scale, 30)
            assert abs(B.printed_eq47(q, m_2)) > 1e-3 * m_2 * q.omega**2 * q.k**2


def inertia_torque(f, q):
    """The inertia torque on the crank: the opposite of the drive's torque, N m."""
    return -f["T_in"]


def printed_torque(q, m_2, m_3):
    """Eq. 48 with the force of Eq. 46b and the corrected acceleration."""
    return B.printed_eq48(q, B.printed_eq46b(q, m_2, m_3, B.corrected_eq20(q)))


@proves("B-eq48", "wrong claim")
def test_eq48():
    balanced(lambda q, m_2, m_3: B.corrected_eq48(q, B.corrected_eq42a(q, m_3)), inertia_torque, arm=True)
    balanced(lambda q, m_2, m_3: B.drive_torque(q, m_3), lambda f, q: f["T_in"], arm=True)
    balanced(
        printed_torque, lambda f, q: q.k * f["F_A_Y"] * q.m.tan(B.printed_eq22(q)), arm=True
    )  # as printed: the reaction along x, at an arm without a meaning
    unbalanced(printed_torque, inertia_torque)
    unbalanced(lambda *q: -printed_torque(*q), inertia_torque)
    unbalanced(lambda q, m_2, m_3: B.printed_eq48(q, B.corrected_eq42a(q, m_3)), inertia_torque)
    unbalanced(
        lambda q, m_2, m_3: B.corrected_eq48(q, B.printed_eq46b(q, m_2, m_3, B.corrected_eq20(q))),
        inertia_torque,
    )


def test_eq48_is_virtual_work():
    for motion, masses in LOADED:
        with mp.workdps(loop.DIGITS):
            q, m_2, m_3 = equivalent(motion, masses)
            power = m_3 * loop.truth("a_C", motion) * loop.truth("V_C", motion)
            scale = force_scale(motion, m_2, m_3) * q.k * abs(q.omega)
            assert close(B.drive_torque(q, m_3) * q.omega, power, scale, 30)
            assert close(
                free_bodies.drive_power(motion, lumped(motion, masses)),
                power,
                scale,
                30,
            )
