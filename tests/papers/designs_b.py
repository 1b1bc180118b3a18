"""Paper B's designs and how its formulas are compared: with the loop, the free bodies and the package."""

import math
import random

from mpmath import mp, mpf

from tests.papers import free_bodies, loop
from tests.papers import paper_b as B
from tests.papers.designs import DESIGNS, close, exact_point, float_point, package, scale_of, vector
from tests.papers.free_bodies import Bodies
from tests.papers.loop import Motion

TABLE_1 = {"omega": 251.0, "k": 0.040, "c": 0.064, "M_k": 0.2, "M_c": 0.5, "M_s": 0.8}
OFFSETS = (0.0, 0.010, 0.020)  # m: the offsets of Figs. 15 and 16; Table 1 has the last
TABLE_2 = {"omega": 20.994, "k": 0.0381, "c": 0.1524, "M_2": 7.0, "M_3": 1.543}

# Table 1 as the paper's two masses, every centre of mass in the middle, and with the uniform rod as it is.
TABLE_1_BODIES = {
    "two masses": Bodies(m_crank=0.35, r_crank=TABLE_1["k"], m_slider=1.05),
    "uniform rod": Bodies(m_crank=0.2, m_rod=0.5, m_slider=0.8, I_rod=0.5 * TABLE_1["c"] ** 2 / 12),
}

STEADY = [motion._replace(alpha=0.0) for motion in DESIGNS]  # the paper's crank turns at constant speed


def random_masses(rng, motion):
    """Masses and centres of mass of some design, in the paper's letters."""
    masses = [rng.uniform(0.1, 3.0) for _ in range(3)]
    return B.Masses(*masses, motion.AB * rng.uniform(0.1, 0.9), motion.BC * rng.uniform(0.1, 0.9))


RNG = random.Random(20200522)
LOADED = [(motion, random_masses(RNG, motion)) for motion in STEADY[:12]]


def case(point):
    """A point of `designs` in the paper's letters."""
    return B.Case(point.theta, point.ec, point.AB, point.BC, point.omega, point.m)


def exact_case(motion):
    """A design in the paper's letters, in 40 digits."""
    return case(exact_point(motion))


def exact_masses(masses):
    """The masses in 40 digits."""
    return B.Masses(*map(mpf, masses))


def table_1(theta, e):
    """The design of Table 1 at a crank angle, with one of the three offsets."""
    return Motion(theta, e, TABLE_1["k"], TABLE_1["c"], TABLE_1["omega"])


def lumped(motion, masses):
    """The paper's model as free bodies: m_2 at the crank pin, m_3 at the slider, a rod without mass."""
    q, w = exact_case(motion), exact_masses(masses)
    return Bodies(m_crank=B.printed_eq36(q, w), r_crank=q.k, m_slider=B.printed_eq34(q, w))


def equivalent(motion, masses):
    """The case and its m_2 and m_3."""
    q, w = exact_case(motion), exact_masses(masses)
    return q, B.printed_eq36(q, w), B.printed_eq34(q, w)


def off(formula, expected, designs=STEADY):
    """A formula of the paper is off by more than a millionth in every design, from loop and package."""
    for motion in designs:
        printed = formula(float_point(motion))
        true = expected(lambda name, at=motion: loop.truth(name, at), exact_point(motion))
        computed = expected(lambda name, at=motion: package(name, at), float_point(motion))
        for value in (true, computed):
            assert abs(printed - value) > 1e-6 * abs(value)


def by_theta(function, q):
    """Derivative of a function of a case with respect to theta."""
    with mp.workdps(2 * loop.DIGITS):
        return mp.diff(lambda theta: function(q._replace(theta=theta)), q.theta)


def force_scale(motion, m_2, m_3):
    """The natural magnitude of a force of a design, N."""
    return (m_2 + m_3) * scale_of("acceleration", motion)


def balanced(formula, expected, arm=False):
    """A force (or, with `arm`, a torque) of the paper's model equals that of the free bodies, to 30 digits.

    `formula(q, m_2, m_3)` is the paper's; `expected(f, q)` says what it should be from the solved unknowns f.
    """
    for motion, masses in LOADED:
        with mp.workdps(loop.DIGITS):
            q, m_2, m_3 = equivalent(motion, masses)
            solved = free_bodies.solve(motion, lumped(motion, masses))
            scale = force_scale(motion, m_2, m_3) * (q.k if arm else 1)
            pairs = zip(vector(formula(q, m_2, m_3)), vector(expected(solved, q)), strict=True)
            assert all(close(result, want, scale, 30) for result, want in pairs)


def unbalanced(formula, expected):
    """A force or torque as printed is off by more than a millionth in every design."""
    for motion, masses in LOADED:
        with mp.workdps(loop.DIGITS):
            q, m_2, m_3 = equivalent(motion, masses)
            want = expected(free_bodies.solve(motion, lumped(motion, masses)), q)
            assert abs(formula(q, m_2, m_3) - want) > 1e-6 * abs(want)


def sweep(steps=3600):
    """Crank angles of a whole turn, rad."""
    return [2 * math.pi * n / steps for n in range(steps)]


def in_stroke(e, k, c, theta):
    """+1 where the slider moves outwards at this crank angle, -1 where inwards; the crank turns forwards."""
    outer, inner = B.dead_centres(e, k, c)
    return -1 if (theta - outer) % (2 * math.pi) < inner - outer else 1


def excess(motion, masses, inertia):
    """By how much two point masses at the pins exceed the rod's moment of inertia about its centre, kg m2."""
    return mpf(masses.m_c) * mpf(masses.c_2) * (mpf(motion.BC) - mpf(masses.c_2)) - inertia
