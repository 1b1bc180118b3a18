"""Many designs in one compiled call: the same motions as one at a time, whatever the threads."""

import math
import re
from pathlib import Path

import numba
import numpy as np
import pytest

import desaxe as dx
from desaxe.simulation.coordinate import EDGE
from desaxe.simulation.loops import law
from tests.motions import true_end
from tests.simulation.test_simulate import CRANK, LOADED, PRESS, ROCKER

ECS = np.array([-0.1, 0.0, 0.06, 0.12])


def one(result, row):
    """The histories of one design."""
    return [result[name][row] for name in ("theta", "omega", "alpha")]


def alone(design, t, **more):
    """The histories of a design on its own."""
    result = dx.simulate(t_end=t[-1], times=t, **{**design, **more})
    return result, [result[name] for name in ("theta", "omega", "alpha")]


@pytest.mark.parametrize("branch", [1, -1])
def test_each_design_moves_as_it_does_alone(branch):
    start = {"torque": 0.25, "omega_start": 3.0, "theta0": 0.4, "branch": branch}
    many = dx.simulate(t_end=1.0, **start, **{**LOADED, "ec": ECS})
    assert many["theta"].shape == (4, 101)
    for row, ec in enumerate(ECS.tolist()):
        single, histories = alone({**LOADED, "ec": ec}, many["t"], **start)
        for ours, theirs in zip(one(many, row), histories, strict=True):
            np.testing.assert_allclose(ours, theirs, rtol=1e-9, atol=1e-9 * np.abs(theirs).max())
        assert many["work"][row] == pytest.approx(single["work"], rel=1e-9)
        assert many["t_last"][row] == 1.0
    assert (many["status"] == 0).all()
    assert (many["energy_residual"] < 1e-9).all()


@pytest.mark.thorough
def test_the_end_of_a_motion():
    torques = np.array([0.25, -0.5])
    many = dx.simulate(torque=torques, t_end=0.3, rtol=1e-11, omega_start=8.0, **LOADED)
    for row, torque in enumerate(torques.tolist()):
        theta, omega = true_end(LOADED, torque, 0.0, 8.0, 0.3, 80)
        assert abs(many["theta"][row, -1] - theta) < 1e-9
        assert abs(many["omega"][row, -1] - omega) < 1e-8


def test_the_threads_do_not_matter():
    design = {**LOADED, "ec": np.linspace(-0.1, 0.1, 23)}
    answers = [dx.simulate(torque=0.25, t_end=0.5, threads=threads, **design) for threads in (1, 2, 5, None)]
    for other in answers[1:]:
        for name, value in answers[0].items():
            if name != "message":
                np.testing.assert_array_equal(other[name], value)


def test_designs_broadcast():
    torque = np.array([0.1, 0.2, 0.3])
    many = dx.simulate(torque=torque, t_end=0.5, times=[0.0, 0.1, 0.5], **{**LOADED, "ec": ECS[:, None]})
    assert many["theta"].shape == (4, 3, 3)
    assert many["status"].shape == many["energy_residual"].shape == (4, 3)
    flat = dx.simulate(torque=0.3, t_end=0.5, times=[0.0, 0.1, 0.5], **{**LOADED, "ec": ECS})
    np.testing.assert_array_equal(many["theta"][:, 2], flat["theta"])


def test_names_are_those_of_evaluate():
    many = dx.simulate(torque=0.25, t_end=0.5, names=["V_C", "T_in"], **{**LOADED, "ec": ECS})
    state = {name: many[name] for name in ("theta", "omega", "alpha")}
    again = dx.evaluate("V_C", **state, **{**LOADED, "ec": ECS[:, None]})
    np.testing.assert_allclose(many["V_C"], again, rtol=1e-13, atol=1e-15)
    np.testing.assert_allclose(many["T_in"], 0.25, rtol=0, atol=1e-10)


def test_units():
    text = dx.simulate(torque=["250 N*mm", "0.5 N*m"], t_end="0.5 s", omega_start="60 rpm", **LOADED)
    plain = dx.simulate(torque=[0.25, 0.5], t_end=0.5, omega_start=2.0 * math.pi, **LOADED)
    np.testing.assert_array_equal(text["theta"], plain["theta"])


# ---- limits and bad designs ----------------------------------------------------------------------

MIXED = {
    **ROCKER,
    "BC": np.array([0.16, 0.31, 0.16, 0.1, 0.31, -1.0]),
    "m_rod": np.array([1.5, 1.5, 0.0, 1.5, 0.0, 1.5]),
    "m_slider": np.array([2.0, 2.0, 0.0, 2.0, 1.0, 2.0]),
    "I_rod": np.array([1e-4, 1e-4, 0.0, 1e-4, 0.0, 1e-4]),
    "m_crank": np.array([0.7, 0.7, 0.7, 0.7, 0.0, 0.7]),
    "I_crank": np.array([1e-4, 1e-4, 1e-4, 1e-4, 0.0, 1e-4]),
    "F_Y": 0.01,
    "g_X": 0.01,
    "g_Y": -0.01,  # of the family of other tests, which share its kernel
}


def test_every_status():
    many = dx.simulate(torque=0.25, t_end=2.0, theta0=0.1, **{**MIXED, "ec": 0.06})
    assert many["status"].tolist() == [2, 0, 2, 2, 5, 6]
    assert many["message"].startswith("6 designs: 1 reached t_end, 3 reached a limit angle, 1 the effective")
    for row in (0, 2, 3):
        design = {n: float(v[row]) if np.ndim(v) else v for n, v in MIXED.items()}
        single = dx.simulate(torque=0.25, t_end=2.0, theta0=0.1, **design)
        assert single["status"] == 2
        assert many["t_last"][row] == pytest.approx(single["t"][-1], abs=1e-9)
        message = many["t"] <= many["t_last"][row]
        assert np.isfinite(many["theta"][row, message]).all()
        assert np.isnan(many["theta"][row, ~message]).all()
        at = single["solution"](many["t"][message])
        np.testing.assert_allclose(many["theta"][row, message], at["theta"], rtol=0, atol=1e-9)
    assert np.isfinite(many["theta"][1]).all()
    assert np.isnan(many["theta"][5]).all()
    assert np.isnan(many["t_last"][5])


def test_a_start_outside_is_told_and_disturbs_nothing():
    theta0 = np.array([0.1, 1.5, math.nan, 0.2])
    many = dx.simulate(torque=0.25, t_end=0.1, theta0=theta0, **ROCKER)
    assert many["status"].tolist() == [0, 6, 6, 0]
    assert np.isfinite(many["theta"]).all(axis=1).tolist() == [True, False, False, True]


def test_too_many_steps_are_a_failure():
    many = dx.simulate(torque=[0.25, 0.5], t_end=5.0, max_steps=10, **LOADED)
    assert many["status"].tolist() == [4, 4]
    assert (many["t_last"] < 5.0).all()


# ---- torque as a function ------------------------------------------------------------------------


def drag(t, theta, omega):
    return 0.3 * math.cos(4.0 * t) - 0.01 * omega


@pytest.mark.thorough
@pytest.mark.parametrize("torque", [drag, numba.njit(drag)], ids=["plain", "compiled"])
def test_a_torque_function(torque):
    many = dx.simulate(torque=torque, t_end=0.5, **{**LOADED, "ec": ECS})
    for row, ec in enumerate(ECS.tolist()):
        _, (theta, *_) = alone({**LOADED, "ec": ec}, many["t"], torque=drag)
        np.testing.assert_allclose(many["theta"][row], theta, rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    ("torque", "message"),
    [
        (lambda t, theta, omega: dx.evaluate("Y", theta=theta, ec=0.0, AB=1.0, BC=2.0), "cannot"),
        (lambda t, theta, omega: (t, theta), "torque: the function gives"),
        (lambda t, x: 0.0, "names of its arguments, t, theta, omega, Y, s, V_C, but <lambda> has x"),
    ],
)
def test_a_torque_that_numba_cannot_compile(torque, message):
    with pytest.raises(TypeError, match=re.escape(message)):
        dx.simulate(torque=torque, t_end=0.5, **{**LOADED, "ec": ECS})


@pytest.mark.parametrize("more", [{"mu": np.array([0.0, 0.05, 0.1, 0.2])}, {"until": 1.5}])
def test_designs_that_rub_or_stop_at_an_angle_are_each_alone(more):
    """A history of many is NaN from where the motion of its design ends."""
    given = {**PRESS, "torque": 0.25, "t_end": 1.0, "omega_start": 10.0}
    times = np.linspace(0.0, 1.0, 11)
    many = dx.simulate(**{**given, "ec": ECS, **more}, times=times)
    for row, ec in enumerate(ECS):
        own = {name: value[row] if np.ndim(value) else value for name, value in more.items()}
        one = dx.simulate(**{**given, "ec": ec, **own}, times=times)
        count = len(one["t"])
        np.testing.assert_allclose(many["omega"][row, :count], one["omega"], rtol=1e-9)
        assert np.isnan(many["omega"][row, count:]).all()
        assert many["t_last"][row] == pytest.approx(one["t_last"], rel=1e-9)
        assert many["status"][row] == one["status"]


# ---- refusals ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        ({"torque": [1.0, 2.0]}, ValueError, "the shapes do not broadcast together"),
        ({"torque": ["3 N"] * 4}, ValueError, "torque = '3 N': it must be a quantity in N m"),
        ({"torque": [None] * 4}, TypeError, "torque: expected real numbers"),
        ({"omega_start": math.inf}, ValueError, "omega_start = inf: it must be a finite number"),
        ({"m_slider": [-1.0] * 4}, ValueError, "m_slider: every value is bad"),
        ({"threads": 0}, ValueError, "threads = 0: a whole number, at least 1"),
        ({"BC": None}, TypeError, "BC is missing"),
        ({"BC": None, "mu": 0.1}, TypeError, "BC is missing"),
        ({"m_slider": [], "mu": 0.1}, ValueError, "an empty array"),
    ],
)
def test_what_is_refused(change, error, message):
    with pytest.raises(error, match=re.escape(message)):
        dx.simulate(**{"torque": 0.25, "t_end": 1.0, **PRESS, "ec": ECS, **change})


def test_friction_of_none_counts_as_designs():
    result = dx.simulate(**{"torque": 0.25, "t_end": 0.1, "times": [0.1], **PRESS, "mu": [0.0, 0.0]})
    assert result["theta"].shape == (2, 1)
    assert result["status"].shape == (2,)


def test_the_edge_is_the_same_in_both():
    assert f"{EDGE:g}" in Path(law.__file__).read_text(encoding="utf-8")


@pytest.mark.thorough
def test_only_a_crank():
    many = dx.simulate(torque=[0.0, 0.1], t_end=1.0, theta0=1.0, g_Y=-9.81, **CRANK)
    _, (theta, *_) = alone(CRANK, many["t"], torque=0.1, theta0=1.0, g_Y=-9.81)
    np.testing.assert_allclose(many["theta"][1], theta, rtol=0, atol=1e-9)
