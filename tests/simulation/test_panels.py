"""Motions under a torque of t, theta and omega in one call: those of one at a time, and of arbs."""

import math

import numpy as np
import pytest

import desaxe as dx
from benchmarks.rows import cranks
from tests.effort import cases
from tests.motions import true_end


def wave(t, theta, omega):
    """Drives, brakes and turns the crank round."""
    return 1.5 * math.sin(3.0 * t) - 0.01 * omega + 0.2 * math.cos(theta)


def of_t_and_omega(t, theta, omega):
    return 1.5 - 0.02 * omega + 0.3 * math.sin(t)


def jumps(t, theta, omega):
    """Off for a while, and with a kink at rest."""
    return (1.0 if t < 0.31 or t > 0.52 else 0.0) - 0.02 * abs(omega)


def drawn(count, seed):
    """Designs that start from rest, turn either way, or have limit angles."""
    rng = np.random.default_rng(seed)
    AB = rng.uniform(0.04, 0.06, count)
    return {
        "AB": AB, "BC": AB * rng.uniform(0.9, 4.0, count), "ec": 0.01, "m_crank": 0.5, "I_crank": 5e-3,
        "m_rod": rng.uniform(0.2, 0.5, count), "I_rod": 5e-4, "m_slider": rng.uniform(0.5, 2.0, count),
        "F_Y": rng.uniform(-10.0, 10.0, count), "g_Y": -9.81, "theta0": rng.uniform(-0.5, 0.5, count),
        "omega_start": rng.choice([0.0, -5.0, 12.0, 30.0], count),
    }  # fmt: skip


@pytest.mark.parametrize("torque", [wave, jumps, of_t_and_omega])
def test_many_motions_are_those_of_one_at_a_time(torque):
    call = {"torque": torque, "t_end": 1.5, "rtol": 1e-9}
    designs = drawn(cases(8, 60, 300), seed=7)
    result = dx.simulate(**call, **designs)
    usual = []
    for row in range(len(designs["AB"])):
        one = {n: float(v[row]) if isinstance(v, np.ndarray) else v for n, v in designs.items()}
        alone = dx.simulate(times=result["t"], **call, **one)
        assert result["status"][row] == alone["status"]
        for name in ("theta", "omega"):
            off = np.abs(result[name][row, : len(alone["t"])] - alone[name]).max()
            assert off < 1e-5 * max(np.abs(alone[name]).max(), 1.0)
            usual.append(off)
    assert np.median(usual) < (1e-6 if torque is jumps else 1e-8)  # a step in time over a jump errs, too
    _check_that_neighbours_do_not_matter({**call, **designs}, result)


def _check_that_neighbours_do_not_matter(call, result):
    some = slice(1, 40, 3)
    fewer = {n: v[some] if isinstance(v, np.ndarray) else v for n, v in call.items()}
    for threads in (1, 3):
        part = dx.simulate(threads=threads, **fewer)
        for name in ("theta", "omega", "alpha", "t_last", "work"):
            np.testing.assert_array_equal(part[name], result[name][some])


@pytest.mark.thorough
def test_the_end_of_a_motion_against_arbs():
    many = cranks()
    row = {name: float(np.broadcast_to(v, 200)[0]) for name, v in many.items()}
    theta, omega = true_end(
        row, lambda t, theta, omega: -0.02 * omega + 1.5 + 0.3 * t.sin(), 0.0, 0.0, 1.0, 300
    )
    result = dx.simulate(torque=of_t_and_omega, t_end=1.0, times=[1.0], rtol=1e-10, **many)
    assert abs(result["theta"][0, 0] / theta - 1.0) < 1e-12
    assert abs(result["omega"][0, 0] / omega - 1.0) < 1e-11


@pytest.mark.parametrize("inertia", [0.02, np.array([0.02, 0.021])], ids=["one", "many"])
def test_a_function_that_jumps_next_to_an_end_of_a_panel(inertia):
    """Kinetic energy of a balanced crank against the work of 1 N m where cos(theta) > 0, else 0.2 N m."""
    result = dx.simulate(
        torque=lambda t, theta, omega: 1.0 if math.cos(theta) > 0.0 else 0.2, t_end=2.0, rtol=1e-10,
        AB=0.05, BC=0.15, ec=0.0, I_crank=inertia,
    )  # fmt: skip
    theta, omega = result["theta"], result["omega"]
    half_turns, rest = np.divmod(theta + 0.5 * np.pi, np.pi)
    work = np.pi * (np.ceil(half_turns / 2.0) + 0.2 * np.floor(half_turns / 2.0))
    work += rest * np.where(half_turns % 2.0 == 0.0, 1.0, 0.2) - 0.5 * np.pi
    energy = 0.5 * np.expand_dims(inertia, -1) * omega**2 if np.ndim(inertia) else 0.5 * inertia * omega**2
    assert np.abs(energy - work).max() < 2e-7 * work.max()


KLOSS = dx.kloss("40 N m", 0.15, "1500 rpm", gear=12)
FORMS = {
    "number": (2.0, lambda t, theta, omega: 2.0),
    "kloss": (KLOSS, lambda t, theta, omega: KLOSS.both(omega, KLOSS.numbers)[0]),
}


@pytest.mark.parametrize("mu", [0.0, 0.15])
@pytest.mark.parametrize("name", FORMS)
def test_the_compiled_law_is_that_of_functions(name, mu):
    """A closed form of the torque against a function, which the loops call."""
    machine = {"AB": 0.04, "BC": 0.064, "ec": 0.01, "m_rod": 0.5, "m_slider": 0.8, "I_crank": 0.01}
    call = {**machine, "g_Y": -9.81, "mu": mu, "t_end": 0.3, "F_X": 5.0, "times": np.linspace(0.0, 0.3, 31)}
    force = dx.over_theta(["0 deg", "90 deg", "180 deg", "270 deg"], [-5.0, 3.0, 8.0, -2.0])
    closed, function = (dx.simulate(torque=torque, F_Y=force, **call) for torque in FORMS[name])
    assert [event.kind for event in closed["events"]] == [event.kind for event in function["events"]]
    for key in ("theta", "omega", "alpha", "work"):
        size = np.abs(function[key]).max()
        np.testing.assert_allclose(closed[key], function[key], rtol=0, atol=1e-8 * size)
