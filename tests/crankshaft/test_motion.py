"""Motions and steady states of several sliders, against the equation of motion of free bodies."""

import numpy as np
import pytest
from mpmath import mp
from scipy.integrate import solve_ivp

import desaxe as dx
from tests.crankshaft.test_sums import crankshaft, truth

TORQUE, T_END, SPEED = 60.0, 0.02, 130.0
STARTS = {"theta0": 0.3, "omega_start": SPEED, "torque": TORQUE}


def acceleration(theta, omega, torque):
    """From the torque that free bodies need without acceleration, and their inertia."""
    with mp.workdps(30):
        here = truth("V", state={"theta": theta, "omega": omega, "alpha": 0.0})
        return float((torque - here["T_in"]) / here["M_eff"])


def test_the_motion_is_that_of_the_free_bodies():
    result = solve_ivp(
        lambda t, y: [y[1], acceleration(*y, TORQUE)], (0.0, T_END), [0.3, SPEED], "DOP853",
        rtol=1e-12, atol=1e-12,
    )  # fmt: skip
    motion = crankshaft("V").simulate(
        **STARTS, t_end=T_END, times=[T_END], rtol=1e-12, names=["T_in", "a_C[1]"]
    )
    theta, omega = result.y[:, -1]
    assert motion["theta"][0] == pytest.approx(theta, rel=1e-10)
    assert motion["omega"][0] == pytest.approx(omega, rel=1e-10)
    assert motion["alpha"][0] == pytest.approx(acceleration(theta, omega, TORQUE), rel=1e-8)
    assert motion["T_in"][0] == pytest.approx(TORQUE, rel=1e-10)


PARAMETERS = {
    "AB": 0.045, "AB[1]": 0.045, "m_slider[0]": 0.4, "phase[1]": 0.4, "bank[2]": 0.8, "I_shaft": 0.02,
    "g_Y": -9.81, "m_slider": 0.4, "theta0": 0.3, "omega_start": SPEED, "torque": TORQUE,
}  # fmt: skip


@pytest.mark.parametrize("step", [False, True])
def test_derivatives_of_a_motion(step):
    """Differences of motions; with a load that jumps the jumps move with phases."""
    shaft = crankshaft("V")
    if step:
        shaft = shaft.replace(F_Y=dx.over_theta([0.0, 1.2, 3.5], [0.0, -800.0, 0.0], "step"))
    how = {"t_end": T_END, "times": [T_END], "rtol": 1e-13}
    exact = shaft.simulate(**STARTS, **how, wrt=[*PARAMETERS])
    for parameter, value in PARAMETERS.items():
        h = 1e-5 * abs(value)
        ends = []
        for side in (1, -1):
            moved = {parameter: value + side * h}
            other, start = (shaft, moved) if parameter in STARTS else (shaft.replace(**moved), {})
            ends.append(other.simulate(**{**STARTS, **start}, **how))
        for name in ("theta", "omega"):
            slope = (ends[0][name] - ends[1][name]) / (2.0 * h)
            size = abs(exact[name][0] / value)
            assert exact[f"{name}_wrt_{parameter}"] == pytest.approx(slope, rel=1e-5, abs=1e-7 * size), (
                parameter
            )


@pytest.mark.parametrize(
    ("changes", "call", "message"),
    [
        ({"mu": 0.1}, {}, "without friction: mu = 0"),
        ({"BC": 0.04}, {}, "margin > 0"),
        ({}, {"torque": lambda V_C: -V_C}, "torque: of several sliders"),
        ({}, {"wrt": "AB[7]"}, "wrt: no parameter 'AB\\[7\\]'"),
    ],
)
def test_motions_that_are_refused(changes, call, message):
    with pytest.raises((ValueError, TypeError), match=message):
        crankshaft("V").replace(**changes).simulate(**{**STARTS, "t_end": T_END, **call})


MOTOR = dx.over_omega([0.0, 100.0, 200.0], [120.0, 90.0, -20.0])


def test_the_steady_state_repeats_and_obeys_the_free_bodies():
    shaft = crankshaft("V")
    steady = shaft.steady(torque=MOTOR)
    assert steady["status"] == 0
    assert steady["theta"][-1] - steady["theta"][0] == pytest.approx(4.0 * np.pi, rel=1e-9)
    for k in range(0, len(steady["theta"]), len(steady["theta"]) // 5):
        theta, omega = steady["theta"][k], steady["omega"][k]
        start = {"theta0": theta, "omega_start": omega, "torque": MOTOR}
        motion = shaft.simulate(**start, t_end=steady["period"], times=[steady["period"]], rtol=1e-12)
        assert motion["omega"][0] == pytest.approx(omega, rel=1e-8)
        assert motion["theta"][0] == pytest.approx(theta + 4.0 * np.pi, rel=1e-8)


@pytest.mark.parametrize("parameter", ["AB", "phase[1]", "m_slider"])
def test_derivatives_of_a_steady_state(parameter):
    shaft, h = crankshaft("V"), 1e-5 * PARAMETERS[parameter]
    ends = [shaft.replace(**{parameter: PARAMETERS[parameter] + s * h}).steady(torque=MOTOR) for s in (1, -1)]
    gradient = shaft.steady(torque=MOTOR)["gradient"]
    for name in ("omega_mean", "fluctuation", "power_mean"):
        slope = (ends[0][name] - ends[1][name]) / (2.0 * h)
        assert gradient[name][parameter] == pytest.approx(slope, rel=1e-4), name
