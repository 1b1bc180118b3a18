"""A torque's function for many designs: right however it is written, as it is at each call."""

import math
from math import sin
from types import ModuleType

import numpy as np
import pytest
from numba import njit

import desaxe as dx

CRANKS = {"AB": np.array([0.05, 0.06]), "BC": 0.2, "ec": 0.01, "m_slider": 1.0, "I_crank": 0.01}


def by_name(t, theta, omega):
    """Takes a sine by its own name."""
    return 1.5 + 0.3 * sin(3.0 * t) - 0.02 * omega


def held(swing):
    """Takes a sine from the function around it."""
    of = math.sin
    return lambda t, theta, omega: 1.5 + swing * of(3.0 * t) - 0.02 * omega


def of_arrays(t, theta, omega):
    """Takes sines of an array."""
    return 1.5 + 0.3 * np.sin(np.array([3.0 * t, 0.0])).sum() - 0.02 * omega


@pytest.mark.parametrize(
    "way", [by_name, held(0.3), of_arrays, njit(by_name)], ids=["name", "held", "arrays", "jitted"]
)
def test_every_way_to_write_a_sine(way):
    plain = dx.simulate(
        torque=lambda t, theta, omega: 1.5 + 0.3 * math.sin(3.0 * t) - 0.02 * omega, t_end=0.5, **CRANKS
    )
    result = dx.simulate(torque=way, t_end=0.5, **CRANKS)
    np.testing.assert_allclose(result["theta"], plain["theta"], rtol=1e-9)
    assert (result["method"] == "panels").all()


FACTOR, TABLE, FACTORS = 1.0, np.array([1.0, 2.0]), (1.0, 2.0)
CONFIG = ModuleType("config")


def reading():
    """Functions that read a number in many ways, and how to change it."""
    cell, held = 1.0, TABLE.copy()

    def set_cell(x):
        nonlocal cell
        cell = x

    yield "global", lambda omega: 4.0 * FACTOR - omega, lambda x: globals().update(FACTOR=x)
    yield "tuple", lambda omega: 4.0 * FACTORS[0] - omega, lambda x: globals().update(FACTORS=(x, 2.0))
    yield "cell", lambda omega: 4.0 * cell - omega, set_cell
    yield "array", lambda omega: 4.0 * held[0] - omega, lambda x: held.__setitem__(0, x)
    yield "module", lambda omega: 4.0 * CONFIG.factor - omega, lambda x: setattr(CONFIG, "factor", x)


@pytest.mark.parametrize(("torque", "put"), [pytest.param(*both, id=name) for name, *both in reading()])
def test_a_function_reads_what_there_is_at_each_call(torque, put):
    """Against 4 k (1 - exp(-t/I)): a balanced crank, T = 4 k - omega."""
    cranks = {"AB": 0.05, "BC": 0.2, "ec": 0.0, "I_crank": np.array([0.1, 1.0])}
    for k in (1.0, 2.0, 1.0):
        put(k)
        right = 4.0 * k * (1.0 - np.exp(-0.5 / cranks["I_crank"]))
        omega = dx.simulate(torque=torque, t_end=0.5, **cranks)["omega"]
        np.testing.assert_allclose(omega[:, -1], right, rtol=1e-8)
        assert dx.steady(torque=torque, **cranks)["omega_mean"][0] == pytest.approx(4.0 * k, rel=1e-9)


def test_a_function_that_raises_ends_its_own_motions_only():
    def limited(t, theta, omega):
        if theta > 2.0:
            raise ValueError("too far")
        return 1.0

    result = dx.simulate(torque=limited, t_end=0.4, **{**CRANKS, "I_crank": np.array([0.01, 1.0])})
    assert result["status"].tolist() == [4, 0]
    assert np.isnan(result["theta"][0, -1])
