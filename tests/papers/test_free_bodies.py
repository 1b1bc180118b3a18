"""The reference for forces is itself tried: energy, momentum, and cases that need no formula."""

import math
import random

import pytest
from mpmath import mp, mpf

import desaxe as dx
from tests.papers import free_bodies, loop
from tests.papers.designs import DESIGNS, close, scale_of
from tests.papers.designs_b import force_scale
from tests.papers.free_bodies import Bodies
from tests.papers.loop import Motion


def random_bodies(rng, motion):
    """Bodies with everything: off-centre masses, loads and gravity."""
    m = [rng.uniform(0.1, 3.0) for _ in range(3)]
    inertias = [m[0] * motion.AB**2 * rng.uniform(0.01, 0.3), m[1] * motion.BC**2 * rng.uniform(0.01, 0.3)]
    centres = [motion.AB * rng.uniform(-0.5, 1.2), motion.BC * rng.uniform(-0.2, 1.2)]
    loads = [rng.uniform(-500, 500) for _ in range(2)] + [rng.uniform(-10, 10) for _ in range(2)]
    return Bodies(*m, *inertias, *centres, *loads)


RNG = random.Random(1687)
LOADED = [(motion, random_bodies(RNG, motion)) for motion in DESIGNS[:8]]


@pytest.mark.parametrize("number", range(len(LOADED)))
def test_moment_about_the_crank_centre(number):
    """All outer moments about A together change the angular momentum of the three bodies about A."""
    motion, bodies = LOADED[number]
    with mp.workdps(2 * loop.DIGITS):
        f = free_bodies.solve(motion, bodies)
        places = (
            (bodies.m_crank, lambda t: free_bodies.crank_centre(motion, bodies, t)),
            (bodies.m_rod, lambda t: free_bodies.rod_centre(motion, bodies, t)),
            (bodies.m_slider, lambda t: loop.slider(motion, t)),
        )
        change = bodies.I_crank * loop.rate(lambda t: loop.crank_angle(motion, t), 2)
        change += bodies.I_rod * loop.rate(lambda t: free_bodies.turn_of_rod(motion, t), 2)
        outer = f["T_in"] + f["N_C"] * loop.slider(motion)[1]
        x_C, y_C = loop.slider(motion)
        outer += y_C * mpf(bodies.F_X) - x_C * mpf(bodies.F_Y)
        for m, place in places:
            (x, y), (a_X, a_Y) = place(mpf(0)), free_bodies.second_rate(place)
            change += mpf(m) * (y * a_X - x * a_Y)
            outer += mpf(m) * (y * mpf(bodies.g_X) - x * mpf(bodies.g_Y))
        scale = sum(bodies[:3]) * scale_of("acceleration", motion) * motion.BC
        assert close(outer, change, scale, 30)


@pytest.mark.parametrize("number", range(len(LOADED)))
def test_package(number):
    motion, bodies = LOADED[number]
    solved, scale = free_bodies.solve(motion, bodies), force_scale(motion, sum(bodies[:3]), 0) + 1000
    result = dx.evaluate(free_bodies.UNKNOWNS, **motion._asdict(), **bodies._asdict())
    assert all(close(result[name], solved[name], scale, 12) for name in free_bodies.UNKNOWNS)


def test_weight_of_a_crank_at_rest():
    """A crank that stands across gravity is held by weight times arm; its pin carries the weight."""
    at_rest = Motion(math.pi / 2, 0.0, 0.1, 0.3, 0.0)
    f = free_bodies.solve(at_rest, Bodies(m_crank=2.0, g_Y=-9.81, r_crank=0.04))
    assert float(f["T_in"]) == pytest.approx(-2.0 * 9.81 * 0.04, rel=1e-12)
    assert float(f["F_A_Y"]) == pytest.approx(2.0 * 9.81, rel=1e-12)
    assert all(abs(f[name]) < 1e-15 for name in ("F_A_X", "F_B_X", "F_B_Y", "F_C_X", "F_C_Y", "N_C"))


def test_load_on_a_mechanism_without_mass():
    """A push on the slider reaches the crank along the rod: the textbook's 3-4-5 triangle."""
    theta, AB, BC = math.pi / 2, 0.3, 0.5
    f = free_bodies.solve(Motion(theta, 0.0, AB, BC, 10.0), Bodies(F_Y=-400.0))
    assert float(f["F_C_Y"]) == pytest.approx(400.0, rel=1e-12)
    assert float(f["F_C_X"]) == pytest.approx(-300.0, rel=1e-12)
    assert float(f["N_C"]) == pytest.approx(300.0, rel=1e-12)
    assert float(f["T_in"]) == pytest.approx(-400.0 * AB, rel=1e-12)


def test_a_spinning_counterweight_shakes_and_needs_no_torque():
    motion = Motion(0.7, 0.02, 0.1, 0.3, 50.0)
    f = free_bodies.solve(motion, Bodies(m_crank=1.5, r_crank=-0.05))
    assert float(mp.hypot(f["F_A_X"], f["F_A_Y"])) == pytest.approx(1.5 * 0.05 * 2500, rel=1e-12)
    assert abs(f["T_in"]) < 1e-12
