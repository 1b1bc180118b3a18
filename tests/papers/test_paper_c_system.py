"""Paper C's eight equations, solved at a point: they obey work and energy; the package has their forces."""

import itertools
import random

import pytest
from mpmath import mp, mpf

import desaxe as dx
from tests.papers import newton_euler_c as ne
from tests.papers.motion_c import inertia
from tests.papers.paper_c import PACKAGE
from tests.papers.states_c import STATES, at_rest, force_scale, random_state

RNG = random.Random(19310)
FRICTION = [random_state(RNG, number, mu=RNG.uniform(0.02, 0.4)) for number in range(24)]


@pytest.fixture(autouse=True)
def many_digits():
    with mp.workdps(2 * ne.DIGITS):
        yield


def test_states_are_of_every_kind():
    for states in (STATES, FRICTION):
        kinds = {(s.branch, s.omega > 0, s.AB > s.BC) for s in states}
        assert kinds == set(itertools.product((1, -1), (True, False), (True, False)))
    signs = [(ne.sliding(s), int(mp.sign(ne.solve(s)["F14y"]))) for s in FRICTION]
    assert set(signs) == set(itertools.product((1, -1), (1, -1)))


def test_package():
    for state in FRICTION:
        (solution,) = ne.balances(state)
        result = dx.evaluate(list(PACKAGE), **state._asdict())
        scale = float(force_scale(solution))
        torque = scale * max(map(abs, (state.AB, state.BC, state.r_crank, state.r_rod))) + abs(
            float(solution["T12"])
        )
        for name, (unknown, sign) in PACKAGE.items():
            size = torque if name == "T_in" else scale
            assert abs(result[name] - sign * solution[unknown]) <= 1e-10 * size, name


def test_virtual_work():
    for state in map(at_rest, STATES):
        held = ne.holding_torque(state)
        assert abs(ne.solve(state)["T12"] - held) < mpf(10) ** -38 * abs(held)


def test_fast_inertia_is_the_bodies_own():
    for state in STATES:
        value, slope = inertia(state, mpf(state.theta))
        assert abs(value - ne.effective_inertia(state)) < mpf(10) ** -38 * value
        assert abs(slope - growth(state._replace(omega=1.0, alpha=0.0), ne.effective_inertia)) < 1e-30 * value


def moved(state, t):
    """The state a time t later, under its constant angular acceleration."""
    omega, alpha = mpf(state.omega), mpf(state.alpha)
    return state._replace(theta=mpf(state.theta) + omega * t + alpha * t * t / 2, omega=omega + alpha * t)


def growth(state, quantity):
    """The time derivative of a quantity along the motion."""
    h = mpf(10) ** -20
    return (quantity(moved(state, h)) - quantity(moved(state, -h))) / (2 * h)


def test_power_balance():
    """What the drive puts in is stored, taken by the force, or lost to friction; rates from the raw loop."""
    for state in [*STATES[:8], *FRICTION[:8]]:
        (solution,) = ne.balances(state)
        V_C = growth(state, lambda s: ne.slider(s, mpf(s.theta))[0])
        stored = growth(state, ne.kinetic_energy) + growth(state, ne.potential_energy)
        worked, lost = mpf(state.F_Y) * V_C, solution["F14x"] * V_C
        assert lost < 0 or state.mu == 0
        terms = abs(stored) + abs(worked) + abs(lost)
        assert abs(solution["T12"] * state.omega - (stored - worked - lost)) < mpf(10) ** -30 * terms
