"""The package's forces against paper C's eight equations, solved at a point, and against work and energy."""

import itertools
import math
import random

import numpy as np
import pytest
from mpmath import mp, mpf

import desaxe as dx
from tests.papers import newton_euler_c as ne
from tests.papers.motion_c import inertia
from tests.papers.paper_c import PACKAGE
from tests.papers.states_c import STATES, at_rest, force_scale, random_state, report

RNG = random.Random(19310)
FRICTION = [random_state(RNG, number, mu=RNG.uniform(0.02, 0.4)) for number in range(24)]
JAMMING = [random_state(RNG, number, mu=RNG.uniform(1.5, 4.0)) for number in range(60)]
ENERGIES = {
    "M_eff": ne.effective_inertia,
    "M_eff_wrt_theta": ne.effective_inertia_slope,
    "kinetic_energy": ne.kinetic_energy,
    "potential_energy": ne.potential_energy,
}


@pytest.fixture(autouse=True)
def many_digits():
    with mp.workdps(2 * ne.DIGITS):
        yield


def package(names, state):
    """Quantities of the package in this state."""
    return dx.evaluate(list(names), **state._asdict())


def scale(state, name, solution):
    """The scale of a force or torque of this solution."""
    lengths = (state.AB, state.BC, state.r_crank, state.r_rod)
    arm = max(map(abs, lengths)) if name == "T_in" else 1.0
    return arm * float(force_scale(solution)) + (abs(float(solution["T12"])) if name == "T_in" else 0.0)


def assert_forces(state, solution, tolerance=1e-10):
    """Every force of the package equals the eight equations' own."""
    got = package(PACKAGE, state)
    for name, (unknown, sign) in PACKAGE.items():
        assert abs(got[name] - sign * solution[unknown]) <= tolerance * scale(state, name, solution), name


def test_states_are_of_every_kind():
    for states in (STATES, FRICTION):
        kinds = {(s.branch, s.omega > 0, s.AB > s.BC) for s in states}
        assert kinds == set(itertools.product((1, -1), (True, False), (True, False)))
    signs = [(ne.sliding(s), int(mp.sign(ne.solve(s)["F14y"]))) for s in FRICTION]
    assert set(signs) == set(itertools.product((1, -1), (1, -1)))


def test_forces_without_friction():
    for state in STATES:
        assert_forces(state, ne.solve(state))


def test_forces_with_friction():
    for state in FRICTION:
        (solution,) = ne.balances(state)
        assert_forces(state, solution)
        assert solution["F14x"] * ne.sliding(state) < 0
        assert abs(abs(solution["F14x"]) - mpf(state.mu) * abs(solution["F14y"])) < mpf(10) ** -60


def test_friction_of_the_motion_that_starts():
    for state in FRICTION:
        starting = state._replace(omega=0.0)
        (solution,) = ne.balances(starting)
        assert solution["F14x"] != 0
        assert_forces(starting, solution)
        still = at_rest(state)
        assert_forces(still, ne.solve(still))


def test_jamming():
    """Where friction's sign leads to no balance of forces, or to two, the package says so."""
    found = {0: 0, 1: 0, 2: 0}
    for state in JAMMING:
        solutions = ne.balances(state)
        found[len(solutions)] += 1
        got = package([*PACKAGE, "status"], state)
        assert got["status"] == {0: 5, 1: 0, 2: 6}[len(solutions)]
        if len(solutions) == 1:
            assert_forces(state, solutions[0])
        else:
            assert all(math.isnan(got[name]) for name in ("T_in", "N_C", "F_friction", "F_C_X", "F_C_Y"))
    assert min(found.values()) >= 5


def test_report_under_its_force():
    """The report's own mechanism, held at rest: the force of 50 N alone."""
    for degrees in (0, 90, 180, 270):
        state = report(theta=math.radians(degrees))
        assert_forces(state, ne.solve(state), 1e-13)


def test_eight_equations_obey_virtual_work():
    for state in map(at_rest, STATES):
        held = ne.holding_torque(state)
        assert abs(ne.solve(state)["T12"] - held) < mpf(10) ** -38 * abs(held)


def test_package_obeys_virtual_work():
    """T_in at rest is -(F . dC/dtheta + sum of m g . dG/dtheta), terms taken one by one as the scale."""
    loads = ("F_X", "F_Y", "g_X", "g_Y")
    for state in map(at_rest, STATES):
        alone = [state._replace(**{name: 0.0 for name in loads if name != load}) for load in loads]
        terms = sum(abs(ne.holding_torque(one)) for one in alone)
        assert abs(package(["T_in"], state)["T_in"] - ne.holding_torque(state)) <= 1e-12 * terms


@pytest.mark.parametrize("name", ENERGIES)
def test_energies(name):
    for state in STATES:
        true = ENERGIES[name](state)
        masses = state.m_crank + state.m_rod + state.m_slider
        cancelling = {
            "M_eff_wrt_theta": ne.effective_inertia(state),
            "potential_energy": 20 * masses * (state.AB + state.BC + abs(state.ec)),
        }
        assert abs(package([name], state)[name] - true) <= 1e-12 * (abs(true) + cancelling.get(name, 0))


def test_fast_inertia_is_the_bodies_own():
    for state in STATES:
        value, slope = inertia(state, mpf(state.theta))
        assert abs(value - ne.effective_inertia(state)) < mpf(10) ** -38 * value
        assert abs(slope - ne.effective_inertia_slope(state)) < mpf(10) ** -38 * value


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
    for state in [*STATES, *FRICTION]:
        (solution,) = ne.balances(state)
        V_C = growth(state, lambda s: ne.slider(s, mpf(s.theta))[0])
        stored = growth(state, ne.kinetic_energy) + growth(state, ne.potential_energy)
        worked, lost = mpf(state.F_Y) * V_C, solution["F14x"] * V_C
        balance = stored - worked - lost
        terms = abs(stored) + abs(worked) + abs(lost)
        assert lost < 0 or state.mu == 0
        assert abs(solution["T12"] * state.omega - balance) < mpf(10) ** -30 * terms
        got = package(["power_in", "T_in", "F_friction", "V_C"], state)
        assert abs(got["power_in"] - balance) <= 1e-10 * terms
        assert got["power_in"] == pytest.approx(got["T_in"] * state.omega, rel=1e-14)
        assert abs(got["F_friction"] * got["V_C"] - lost) <= 1e-10 * terms


def test_shaking_forces_are_those_on_the_frame():
    """What the mechanism does to link 1: -(F12 + F14), and about A the guide's moment and the motor's."""
    for state in [*STATES, *FRICTION]:
        (solution,) = ne.balances(state)
        C = ne.slider(state, mpf(state.theta))
        guide = solution["F14x"], solution["F14y"]
        force = ne.times(mpf(-1), ne.add((solution["F12x"], solution["F12y"]), guide))
        turning = -(solution["T12"] + ne.moment(C, guide))
        got = package(["F_shaking_X", "F_shaking_Y", "M_shaking"], state)
        size = float(force_scale(solution))
        assert np.allclose(
            [got["F_shaking_Y"], got["F_shaking_X"]], list(map(float, force)), rtol=0, atol=1e-10 * size
        )
        arm = state.AB + state.BC + abs(state.ec)
        assert abs(got["M_shaking"] - turning) <= 1e-10 * (arm * size + abs(solution["T12"]))
