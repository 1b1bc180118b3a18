"""Paper B's forces, corrected, against the package: the paper's two masses, and the rod as it is."""

import math
import random

import pytest

import desaxe as dx
from tests.papers import free_bodies
from tests.papers import paper_b as B
from tests.papers.designs import close
from tests.papers.designs_b import (
    EXTREMES,
    LOADED,
    OFFSETS,
    TABLE_1,
    TABLE_1_BODIES,
    TABLE_2,
    equivalent,
    exact_case,
    excess,
    force_scale,
    lumped,
    table_1,
)
from tests.papers.free_bodies import UNKNOWNS, Bodies
from tests.papers.test_free_bodies import LOADED as WITH_EVERYTHING


def forces(names, motion, bodies):
    """Quantities of the package for the bodies of the reference."""
    loads = {name: float(value) for name, value in bodies._asdict().items() if value is not None}
    return dx.evaluate(names, **motion._asdict(), **loads)


@pytest.mark.parametrize("number", range(len(WITH_EVERYTHING)))
def test_free_bodies(number):
    """All eight unknowns with off-centre masses, loads, gravity and an accelerated crank."""
    motion, bodies = WITH_EVERYTHING[number]
    solved = free_bodies.solve(motion, bodies)
    got = forces(list(UNKNOWNS), motion, bodies)
    scale = force_scale(motion, sum(bodies[:3]), 0) + 1000
    for name in UNKNOWNS:
        assert close(got[name], solved[name], scale, 12)


def test_shaking_force_of_two_masses():
    """The package's shaking force is the reversed total of Eq. 46a."""
    for motion, masses in LOADED:
        got = forces(["F_shaking_X", "F_shaking_Y"], motion, lumped(motion, masses))
        q, m_2, m_3 = equivalent(motion, masses)
        along, across = B.printed_eq46a(q, m_2, m_3, B.corrected_eq20(q))
        scale = force_scale(motion, m_2, m_3)
        assert close(got["F_shaking_Y"], -along, scale, 12)
        assert close(got["F_shaking_X"], -across, scale, 12)


def test_equivalent_masses():
    """m_rotating and m_reciprocating are Eqs. 36 and 34; I_lumping what they have too much."""
    for motion, masses in LOADED:
        inertia = masses.m_c * motion.BC**2 / 15
        bodies = Bodies(masses.m_k, masses.m_c, masses.m_s, 0.0, inertia, masses.k_1, masses.c_2)
        got = forces(["m_rotating", "m_reciprocating", "I_lumping"], motion, bodies)
        _, m_2, m_3 = equivalent(motion, masses)
        assert got["m_rotating"] == pytest.approx(float(m_2), rel=1e-12)
        assert got["m_reciprocating"] == pytest.approx(float(m_3), rel=1e-12)
        assert got["I_lumping"] == pytest.approx(float(excess(motion, masses, inertia)), rel=1e-9)


def test_lumping_in_the_torque():
    """Two masses for the rod change T_in by I_lumping alpha_BC omega_BC/omega."""
    rng = random.Random(31)
    for motion, masses in LOADED:
        inertia = masses.m_c * motion.BC**2 * rng.uniform(0.02, 0.2)
        true = Bodies(masses.m_k, masses.m_c, masses.m_s, 0.0, inertia, masses.k_1, masses.c_2)
        names = ["T_in", "I_lumping", "omega_BC", "alpha_BC", "omega"]
        got = forces(names, motion, true)
        change = got["I_lumping"] * got["alpha_BC"] * got["omega_BC"] / got["omega"]
        q, m_2, m_3 = equivalent(motion, masses)
        assert close(
            float(B.drive_torque(q, m_3)),
            got["T_in"] + change,
            float(force_scale(motion, m_2, m_3) * q.k),
            12,
        )


@pytest.mark.parametrize("rod", ["two masses", "uniform rod"])
def test_extremes_of_table_1(rod):
    loads = {name: value for name, value in TABLE_1_BODIES[rod]._asdict().items() if value is not None}
    for e in OFFSETS:
        highest_at, highest, lowest_at, lowest = EXTREMES[rod, e]
        for kind, angle, value in (("max", highest_at, highest), ("min", lowest_at, lowest)):
            at = forces("T_in", table_1(angle, e), TABLE_1_BODIES[rod])
            assert at == pytest.approx(value, rel=1e-11)
            design = {"ec": e, "AB": TABLE_1["k"], "BC": TABLE_1["c"], "omega0": TABLE_1["omega"]}
            found = dx.peak("T_in", kind=kind, **design, **loads)
            assert found["value"] == pytest.approx(value, rel=1e-11)
            assert found["theta"] == pytest.approx(angle, abs=1e-7)


def test_existing_model_beside_the_package():
    """Eq. 53 follows the package's -T_in of Table 2 within 3.1 % of the peak, and no closer."""
    errors, peak = [], 0.0
    for degrees in range(0, 360, 3):
        theta = math.radians(degrees)
        motion = table_1(theta, 0.0)._replace(AB=TABLE_2["k"], BC=TABLE_2["c"], omega0=TABLE_2["omega"])
        torque = forces("T_in", motion, Bodies(m_crank=7.0, r_crank=TABLE_2["k"], m_slider=TABLE_2["M_3"]))
        q = exact_case(motion)
        errors.append(abs(float(B.printed_eq53(q, TABLE_2["M_3"])) + torque))
        peak = max(peak, abs(torque))
    assert max(errors) / peak == pytest.approx(0.0306, abs=2e-4)
