"""`name_alpha` and `name_step` of a C module under loads from tables."""

import ctypes
import math
from functools import cache

import numpy as np
import pytest

import desaxe as dx
from tests.compiler.languages.tools import library, pointer
from tests.effort import cases
from tests.loads.module_loads import SHAPES, load, scene

DOUBLE = ctypes.c_double
STILL = {"ec": 0.01, "AB": 0.035, "BC": 0.064, "m_slider": 0.8, "I_crank": 2e-4}
KIND = "outer both ways"  # all that there is; a thorough run has two more


class Press:
    """A module under a load, in a given state, whose crank has inertia, too."""

    def __init__(self, folder, given):
        content = scene(given, motion={"theta": [0.0, 1.0], "omega": [1.0, 2.0]})
        content["mechanism"] = {name: STILL[name] for name in ("ec", "AB", "BC")}
        content["masses"] = {"m_slider": 0.8, "I_crank": 2e-4}
        self.loaded = library(dx.compile(content, folder / "press", to="c") / "press.c", options=("-O1",))
        self.row = pointer(np.array([math.nan, math.nan]))

    def alpha(self, torque, theta, omega):
        alpha = DOUBLE(7.0)
        state = map(DOUBLE, (torque, theta, omega))
        return self.loaded.press_alpha(*state, self.row, ctypes.byref(alpha)), alpha.value

    def step(self, h, torque, theta, omega):
        state = DOUBLE(theta), DOUBLE(omega)
        status = self.loaded.press_step(DOUBLE(h), DOUBLE(torque), *map(ctypes.byref, state), self.row)
        return status, *(each.value for each in state)

    def run(self, t_end, steps, torque, theta, omega):
        for _ in range(steps):
            status, theta, omega = self.step(t_end / steps, torque, theta, omega)
            assert status == 0
        return theta, omega


@pytest.fixture(scope="module")
def press_under(tmp_path_factory):
    """A press under a load, compiled once."""
    return cache(lambda given: Press(tmp_path_factory.mktemp("press"), given))


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("kind", "shape"),
    [
        pytest.param(kind, shape, marks=[] if (kind, shape) == (KIND, "jumping") else pytest.mark.thorough)
        for kind in (KIND, "theta", "Y", "sum")
        for shape in SHAPES
    ],
)
def test_the_torque_of_the_acceleration_is_the_torque(kind, shape, press_under):
    """`T_in` under the table gives it back: virtual work, not the formula of `alpha`."""
    one, rng = load(kind, shape, 0.01), np.random.default_rng(36)
    for _ in range(cases(20, 200)):
        torque, theta, omega = rng.uniform((-5, -9, -60), (5, 9, 60))
        status, alpha = press_under(one).alpha(torque, theta, omega)
        assert status == 0
        right = dx.evaluate("T_in", theta=theta, omega=omega, alpha=alpha, **STILL, F_Y=one)
        assert right == pytest.approx(torque, abs=1e-10 * (1 + abs(alpha)))


@pytest.mark.parametrize(
    ("kind", "shape"),
    [(KIND, "jumping"), pytest.param("theta", "smooth", marks=pytest.mark.thorough), ("sum", "smooth")],
)
def test_steps_follow_simulate(kind, shape, press_under):
    """Of order 4 where the table is smooth; across jumps and the change at dead centres of order 1."""
    one = load(kind, shape, 0.02)
    motion = dx.simulate(torque=0.4, t_end=0.2, theta0=0.3, omega_start=40.0, **STILL, F_Y=one, rtol=1e-12)
    right = np.array([motion["theta"][-1], motion["omega"][-1]])
    errors = [np.abs(press_under(one).run(0.2, n, 0.4, 0.3, 40.0) - right) for n in (400, 800, 1600)]
    if shape == "smooth":
        assert (errors[0] > 7 * errors[1]).all()  # the third derivative of a spline jumps
        assert (errors[2] < 4e-6 * np.abs(right)).all()
    else:
        assert (errors[2] < 2e-3 * np.abs(right)).all()


def test_a_crank_at_rest_goes_the_way_that_the_load_lets_it(press_under):
    """Against the slider both ways, a load holds it, as friction does, until the torque is enough."""
    press = press_under(dx.over_stroke([0.0, 0.1], [-50.0, -50.0], [50.0, 50.0], dead_centre="outer"))
    assert press.step(1e-3, 0.1, 1.0, 0.0) == (0, 1.0, 0.0)
    assert press.alpha(0.1, 1.0, 0.0) == (0, 0.0)
    inward, outward = (
        dx.evaluate("T_in", theta=1.0, omega=1.0, alpha=0.0, **STILL, F_Y=force) for force in (50.0, -50.0)
    )
    assert inward > 0.1
    status, alpha = press.alpha(2 * inward, 1.0, 0.0)
    assert (status, alpha > 0.0) == (0, True)
    assert press.alpha(2 * outward, 1.0, 0.0)[1] < 0.0
