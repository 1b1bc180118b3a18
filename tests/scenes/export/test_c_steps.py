"""`name_alpha` and `name_step` of a C module: torques balance, and the motion is the one of `simulate`."""

import ctypes
import math

import numpy as np
import pytest

import desaxe as dx
from tests.compiler.languages.tools import library, pointer

DOUBLE = ctypes.c_double
LENGTHS, MASSES = {"ec": 0.01, "AB": 0.04, "BC": 0.1}, {"m_slider": 0.4, "m_rod": 0.2, "I_crank": 2e-3}
OPEN = ("ec", "BC", "m_slider", "F_Y", "mu")  # in the order of in[], behind theta and omega


def content(mu, branch=1):
    """A scene with some inputs open; mu is open, too, if it is a list."""
    return {
        "outputs": ["V_C"],
        "mechanism": {"ec": [0, 0.01], "AB": 0.04, "BC": [0.1, 0.2], "branch": branch},
        "motion": {"theta": [0, 1], "omega": [0, 1]},
        "masses": MASSES | {"m_slider": [0.3, 0.4]},
        "loads": {"F_X": 30, "F_Y": [-50, 0], "g_Y": -9.81, "mu": mu},
    }


class Press:
    """A compiled module of the scene above."""

    def __init__(self, folder, mu=0.0, branch=1):
        place = dx.compile(content(mu, branch), folder / "press", to="c")
        self.loaded, self.branch, self.mu = (
            library(place / "press.c", options=("-O1",)),
            branch,
            mu,
        )

    def row(self, ec, BC, m_slider, F_Y, mu=None):
        open_mu = [mu] if isinstance(self.mu, list) else []
        return pointer(np.array([math.nan, ec, BC, math.nan, m_slider, F_Y, *open_mu]))

    def alpha(self, torque, theta, omega, *inputs):
        result = DOUBLE(7.0)
        given = map(DOUBLE, (torque, theta, omega))
        status = self.loaded.press_alpha(*given, self.row(*inputs), ctypes.byref(result))
        return status, result.value

    def step(self, h, torque, theta, omega, *inputs):
        state = DOUBLE(theta), DOUBLE(omega)
        given = (DOUBLE(h), DOUBLE(torque), *map(ctypes.byref, state), self.row(*inputs))
        return self.loaded.press_step(*given), *(number.value for number in state)

    def run(self, t_end, steps, torque, theta, omega, *inputs):
        for _ in range(steps):
            status, theta, omega = self.step(t_end / steps, torque, theta, omega, *inputs)
            assert status == 0
        return theta, omega


@pytest.mark.parametrize(("mu", "branch"), [(0.0, 1), ([0.1, 0.2], -1), ([0.1, 0.2], 1)])
def test_the_torque_of_the_acceleration_is_the_torque(mu, branch, tmp_path):
    """`T_in`, which the free bodies check, gives it back, where one set of forces has the acceleration."""
    press, rng, seen = Press(tmp_path, mu, branch), np.random.default_rng(36), []
    for _ in range(100):
        torque, theta, omega = rng.uniform((-5, -9, -60), (5, 9, 60))
        given = {"ec": rng.uniform(-0.02, 0.02), "BC": rng.uniform(0.04, 0.2)}
        given |= {"m_slider": rng.uniform(0, 1), "F_Y": rng.uniform(-90, 90), "mu": rng.uniform(0, 0.6)}
        status, alpha = press.alpha(torque, theta, omega, *given.values())
        seen.append(status)
        given |= {} if mu else {"mu": 0.0}
        fixed = {**MASSES, "AB": 0.04, **given, "F_X": 30.0, "g_Y": -9.81, "branch": branch}
        there = dx.evaluate(
            ["T_in", "status"], theta=theta, omega=omega, alpha=0.0 if status else alpha, **fixed
        )
        if status == 0:
            assert there["status"] in (0, 6)
            assert there["status"] == 6 or there["T_in"] == pytest.approx(
                torque, abs=1e-10 * (1 + abs(alpha))
            )
        else:
            assert math.isnan(alpha)
            assert status in ((1, 5, 6) if mu else (1,))
    assert seen.count(0) > 50
    assert 1 in seen


def test_order_4(tmp_path):
    """Half the step, a sixteenth of the error, beside `simulate`."""
    press, row = Press(tmp_path), (0.01, 0.1, 0.4, -20.0)
    result = dx.simulate(
        torque=1.5,
        t_end=0.2,
        theta0=0.3,
        omega_start=20.0,
        **LENGTHS,
        **MASSES,
        F_X=30.0,
        F_Y=-20.0,
        g_Y=-9.81,
    )
    expected = np.array([result["theta"][-1], result["omega"][-1]])
    errors = [np.abs(press.run(0.2, n, 1.5, 0.3, 20.0, *row) - expected) for n in (400, 800, 1600)]
    assert (errors[2] < 1e-6).all()
    ratios = [*(errors[0] / errors[1]), *(errors[1] / errors[2])]
    assert min(ratios) > 12
    assert max(ratios) < 24


def test_friction_stops_the_crank_holds_it_and_lets_it_go(tmp_path):
    press, row = Press(tmp_path, [0.1, 0.2]), (0.01, 0.1, 0.4, 4.0, 0.3)
    given = {**LENGTHS, **MASSES, "F_X": 30.0, "F_Y": 4.0, "g_Y": -9.81, "mu": 0.3}
    stop = dx.simulate(torque=0.0, t_end=0.5, theta0=1.0, omega_start=8.0, **given)
    assert stop["status"] == 1
    theta, omega = press.run(0.5, 3000, 0.0, 1.0, 8.0, *row)
    assert omega == 0.0
    assert theta == pytest.approx(stop["theta"][-1], abs=1e-7)
    assert press.step(0.01, 0.0, theta, omega, *row) == (0, theta, 0.0)
    assert press.alpha(0.0, theta, 0.0, *row) == (0, 0.0)
    later = press.step(1e-3, 5.0, theta, 0.0, *row)
    moved = dx.simulate(torque=5.0, t_end=1e-3, theta0=theta, **given)
    ends = moved["theta"][-1], moved["omega"][-1]
    assert later == (0, pytest.approx(ends[0], abs=1e-9), pytest.approx(ends[1], rel=1e-6))


def test_a_turn_inside_a_step(tmp_path):
    """A load that drives the crank back through its standstill: friction changes its side there."""
    press, row = Press(tmp_path, [0.1, 0.2]), (0.01, 0.1, 0.4, -60.0, 0.1)
    given = {**LENGTHS, **MASSES, "F_X": 30.0, "F_Y": -60.0, "g_Y": -9.81, "mu": 0.1}
    result = dx.simulate(torque=0.0, t_end=0.04, theta0=1.0, omega_start=-8.0, **given)
    assert [event.kind for event in result["events"]].count("standstill") == 1
    expected = pytest.approx((result["theta"][-1], result["omega"][-1]), rel=1e-6)
    assert press.run(0.04, 41, 0.0, 1.0, -8.0, *row) == expected


@pytest.mark.parametrize("mu", [0.0, 0.2])
def test_an_error_leaves_the_state(mu, tmp_path):
    press, good = Press(tmp_path, mu), (0.01, 0.1, 0.4, -20.0)
    bad = {
        4: [(math.nan, 1.0, 0.5, 1.0, *good), (math.inf, 1.0, 0.5, 1.0, *good), (-1e-3, 1.0, 0.5, 1.0, *good),
            (1e-3, math.inf, 0.5, 1.0, *good), (1e-3, 1.0, math.nan, 1.0, *good),
            (1e-3, 1.0, 0.5, math.inf, *good), (1e-3, 1.0, 0.5, 1.0, 0.01, -0.1, 0.4, -20.0)],
        1: [(1e-3, 1.0, math.pi / 2, 1.0, 0.01, 0.03, 0.4, -20.0)],
    }  # fmt: skip
    for status, calls in bad.items():
        for h, torque, theta, omega, *row in calls:
            result = press.step(h, torque, theta, omega, *row)
            assert result[0] == status
            np.testing.assert_array_equal(result[1:], (theta, omega))
    theta, omega = press.step(0.0, 1.0, 0.5, 1.0, *good)[1:]
    assert (theta, omega) == (0.5, 1.0)


def test_no_masses_no_step(tmp_path):
    place = dx.compile({k: v for k, v in content(0.0).items() if k != "masses"}, tmp_path / "press", to="c")
    assert "press_step" not in (place / "press.h").read_text() + (place / "press.c").read_text()
