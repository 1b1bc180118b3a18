"""States of the mechanism for paper C's proofs: seeded random ones and those of the report itself."""

import math
import random

from mpmath import mp, mpf

from tests.papers import newton_euler_c as ne
from tests.papers import paper_c as C
from tests.papers.newton_euler_c import State


def random_state(rng, number, mu=0.0):
    """Any mechanism in any state, under gravity and a force; both branches, both senses, any AB/BC."""
    AB = rng.uniform(0.03, 0.6)
    BC = AB * math.exp(rng.uniform(-1.2, 1.2))
    theta, rod_angle = rng.uniform(-math.pi, math.pi), rng.uniform(-1.1, 1.1)
    return State(
        theta=theta,
        ec=BC * math.sin(rod_angle) - AB * math.sin(theta),
        AB=AB,
        BC=BC,
        omega=(-1) ** (number // 2) * rng.uniform(1.0, 30.0),
        alpha=rng.choice([-1, 1]) * rng.uniform(10.0, 300.0),
        branch=(-1) ** number,
        m_crank=rng.uniform(0.1, 3.0),
        m_rod=rng.uniform(0.1, 3.0),
        m_slider=rng.uniform(0.1, 3.0),
        I_crank=rng.uniform(0.1, 1.0) * AB**2,
        I_rod=rng.uniform(0.1, 1.0) * BC**2,
        r_crank=rng.uniform(-0.5, 1.2) * AB,
        r_rod=rng.uniform(-0.3, 1.3) * BC,
        F_X=rng.uniform(-100.0, 100.0),
        F_Y=rng.uniform(-100.0, 100.0),
        g_X=rng.uniform(-10.0, 10.0),
        g_Y=rng.uniform(-10.0, 10.0),
        mu=mu,
    )


RNG = random.Random(748)
STATES = [random_state(RNG, number) for number in range(24)]
WEIGHTLESS = [state._replace(g_X=0.0, g_Y=0.0) for state in STATES]  # the paper has no gravity


def at_rest(state):
    """The state of a mechanism at rest, otherwise unchanged."""
    return state._replace(omega=0.0, alpha=0.0)


def report(theta=0.0, **changes):
    """The report's mechanism as placed in `paper_c`, at rest, its force of 50 N along negative X."""
    fixed = State(
        theta=theta,
        ec=C.ECCENTRICITY,
        AB=C.CRANK,
        BC=C.ROD,
        omega=0.0,
        alpha=0.0,
        m_crank=C.CRANK_MASS,
        m_rod=C.ROD_MASS,
        m_slider=C.SLIDER_MASS,
        I_crank=C.CRANK_INERTIA,
        I_rod=C.ROD_INERTIA,
        r_crank=C.CRANK / 2,
        r_rod=C.ROD / 2,
        F_Y=-C.FORCE,
    )
    return fixed._replace(**changes)


def symbols(state, friction=0):
    """A state in the paper's symbols, unknowns solved: what its equations are fed with."""
    with mp.workdps(2 * ne.DIGITS):
        at = ne.bodies(state)
        vectors = {"R12": at.R12, "R32": at.R32, "R23": at.R23, "R43": at.R43}
        vectors |= {"aG2": at.a_G2, "aG3": at.a_G3, "aG4": at.a_G4, "FP": at.force}
        vectors |= {"R14": (mpf(0), mpf(0)), "R34": (mpf(0), mpf(0)), "RP": (mpf(0), mpf(0))}
        parts = {
            name + axis: value
            for name, pair in vectors.items()
            for axis, value in zip("xy", pair, strict=True)
        }
        masses = {"m2": mpf(state.m_crank), "m3": mpf(state.m_rod), "m4": mpf(state.m_slider)}
        turning = {
            "IG2": mpf(state.I_crank),
            "IG3": mpf(state.I_rod),
            "alpha2": at.alpha2,
            "alpha3": at.alpha3,
        }
        return parts | masses | turning | ne.solve(state, mpf(friction))


def force_scale(forces):
    """The greatest force of a solution, N."""
    return max(abs(value) for name, value in forces.items() if name.startswith("F"))
