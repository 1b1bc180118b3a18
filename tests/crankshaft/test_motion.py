"""Motions and steady states of several sliders, against the equation of motion of free bodies."""

import numpy as np
import pytest
from mpmath import mp
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import desaxe as dx
from tests.crankshaft.test_sums import CYLINDER, SHAFTS, crankshaft, truth
from tests.crankshaft.truth import torque_with_friction
from tests.effort import first

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


MU, FORCE = 0.12, -300.0
RUBBING = dx.Crankshaft(
    dx.Machine(**CYLINDER, mu=MU, F_Y=FORCE), phase=SHAFTS["V"][1], bank=SHAFTS["V"][2], I_shaft=0.02
)


def with_friction(theta, omega, torque):
    """The acceleration of RUBBING by free bodies."""
    lags = np.add(*SHAFTS["V"][1:3])

    def excess(alpha):
        own = (torque_with_friction(CYLINDER, MU, FORCE, theta - lag, omega, alpha) for lag in lags)
        return 0.02 * alpha + sum(own) - torque

    return brentq(excess, -1e7, 1e7, xtol=1e-9, rtol=1e-14)


@pytest.mark.thorough
def test_a_motion_with_friction_is_that_of_the_free_bodies():
    result = solve_ivp(
        lambda t, y: [y[1], with_friction(*y, TORQUE)], (0.0, T_END), [0.3, 40.0], "DOP853",
        rtol=1e-11, atol=1e-11,
    )  # fmt: skip
    how = {"theta0": 0.3, "omega_start": 40.0, "rtol": 1e-12}
    motion = RUBBING.simulate(**how, torque=TORQUE, t_end=T_END, times=[T_END], names=["T_in"])
    assert [motion["theta"][0], motion["omega"][0]] == pytest.approx(result.y[:, -1], rel=1e-8)
    assert motion["T_in"][0] == pytest.approx(TORQUE, rel=1e-10)
    still = RUBBING.simulate(**how, torque=0.0, t_end=5.0, names=["T_in"])
    assert "at rest from t" in still["message"]
    theta = still["theta"][-1]
    assert with_friction(theta, 1e-9, 0.0) < 0.0 < with_friction(theta, -1e-9, 0.0)
    back = RUBBING.simulate(**how, torque=-TORQUE, t_end=0.1)
    assert [event.kind for event in back["events"]] == ["standstill"]
    assert back["alpha"][-1] == pytest.approx(
        with_friction(back["theta"][-1], back["omega"][-1], -TORQUE), rel=1e-9
    )


def test_friction_of_one_guide_jams_the_shaft():
    """Slider 0 is pushed into its guide where mu tan(phi) = 1, sin(phi) = AB sin(theta)/BC."""
    one = dx.Machine(ec=0.0, AB=0.04, BC=0.064, m_slider=0.8, m_rod=0.5, mu=1.5, I_crank=1e-3)
    shaft = dx.Crankshaft(one, phase=[0.0, 1.0], I_shaft=0.01)
    motion = shaft.simulate(torque=3.0, omega_start=30.0, t_end=1.0)
    assert motion["status"] == 3
    assert motion["events"][-1].kind == "friction jams"
    assert np.sin(motion["theta"][-1]) == pytest.approx(0.064 / 0.04 * np.sin(np.arctan(1 / 1.5)), abs=1e-5)


def test_a_limit_angle_of_one_slider_ends_the_motion():
    """S = 0 of slider 1 at ec + AB sin(theta - firing) = BC; derivatives by differences."""
    one = dx.Machine(ec=0.01, AB=0.1, BC=0.07, m_slider=0.4, I_crank=1e-3, g_Y=-9.81)
    two = dx.Crankshaft([one, one.replace(BC=0.08)], phase=[0.3, 0.0], bank=[0.1, 0.0])
    how = {"torque": 0.5, "theta0": 0.2, "omega_start": 1.0, "t_end": 5.0, "rtol": 1e-12}
    backwards = two.simulate(**how | {"omega_start": -8.0, "torque": -0.5})
    assert backwards["theta"][-1] == pytest.approx(0.4 - np.arcsin(0.8), rel=1e-9)
    exact = two.simulate(**how, wrt=["AB", "BC[1]", "BC[0]", "phase[1]"])
    assert exact["status"] == 2
    assert exact["theta"][-1] == pytest.approx(np.arcsin(0.7), rel=1e-12)
    for parameter, value in (("AB", 0.1), ("BC[1]", 0.08), ("BC[0]", 0.07), ("phase[1]", 0.0)):
        ends = [two.replace(**{parameter: value + h}).simulate(**how)["t_last"] for h in (1e-6, -1e-6)]
        assert exact[f"t_last_wrt_{parameter}"] == pytest.approx((ends[0] - ends[1]) / 2e-6, rel=1e-6)


PARAMETERS = {
    "AB": 0.045, "AB[1]": 0.045, "m_slider[0]": 0.4, "phase[1]": 0.4, "bank[2]": 0.8, "I_shaft": 0.02,
    "g_Y": -9.81, "m_slider": 0.4, "theta0": 0.3, "omega_start": SPEED, "torque": TORQUE,
}  # fmt: skip


OF_SPEED = dx.damper(50.0) + dx.over_V([-3, 0, 3], [40, 0, -90])
KINDS = {
    "gas": {}, "jumps": {"F_Y": dx.over_theta([0.0, 1.2, 3.5], [0.0, -800.0, 0.0], "step")},
    "of the speed": {"F_Y": OF_SPEED}, "friction": {"F_Y": -300.0, "mu": MU},
}  # fmt: skip


@pytest.mark.parametrize("kind", first(2, KINDS))
def test_derivatives_of_a_motion(kind):
    """Differences of motions; with a load that jumps the jumps move with phases."""
    shaft = crankshaft("V").replace(**KINDS[kind])
    how = {"t_end": T_END, "times": [T_END], "rtol": 1e-13}
    parameters = PARAMETERS | ({"mu": MU, "mu[1]": MU} if kind == "friction" else {})
    exact = shaft.simulate(**STARTS, **how, wrt=[*parameters])
    for parameter, value in parameters.items():
        h = 1e-4 * abs(value)
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
        ({"BC": 0.04}, {}, "slider 0, under theta - firing.0.: theta0 = .*cannot be assembled"),
        ({"F_Y": OF_SPEED}, {"wrt": "F_Y.linear"}, "wrt: no parameter 'F_Y.linear'"),
        ({}, {"torque": lambda V_C: -V_C}, "torque: of several sliders"),
        ({}, {"wrt": "AB[7]"}, "wrt: no parameter 'AB\\[7\\]'"),
    ],
)
def test_motions_that_are_refused(changes, call, message):
    with pytest.raises((ValueError, TypeError), match=message):
        crankshaft("V").replace(**changes).simulate(**{**STARTS, "t_end": T_END, **call})


MOTOR = dx.over_omega([0.0, 100.0, 200.0], [120.0, 90.0, -20.0])


@pytest.mark.parametrize("kind", first(2, [kind for kind in KINDS if kind != "jumps"]))
def test_the_steady_state_repeats(kind):
    shaft = crankshaft("V").replace(**KINDS[kind])
    steady = shaft.steady(torque=MOTOR)
    assert steady["status"] == 0
    turn = steady["theta"][-1] - steady["theta"][0]
    assert turn == pytest.approx((4.0 if kind == "gas" else 2.0) * np.pi, rel=1e-9)
    for k in range(0, len(steady["theta"]), len(steady["theta"]) // (5 if kind == "gas" else 2)):
        theta, omega = steady["theta"][k], steady["omega"][k]
        start = {"theta0": theta, "omega_start": omega, "torque": MOTOR}
        motion = shaft.simulate(**start, t_end=steady["period"], times=[steady["period"]], rtol=1e-12)
        assert motion["omega"][0] == pytest.approx(omega, rel=1e-8)
        assert motion["theta"][0] == pytest.approx(theta + turn, rel=1e-8)


@pytest.mark.parametrize("slip", [0.12, 0.3])
def test_the_steady_state_of_one_slider_is_that_of_its_machine(slip):
    """Trial energies where the motor has no torque are no errors."""
    one = dx.Machine(AB=40, BC=160, ec=0, omega0=900, m_slider=2, mu=0.05, units="mm, deg, rpm")
    one = one.replace(F_Y=one.over_Y([120, 200], [0, -9000], [0, -1000]))
    shaft, motor = dx.Crankshaft(one, phase=[0], I_shaft=0.5), one.kloss(120, slip, 1000)
    steady, same = shaft.steady(torque=motor), one.replace(I_crank=0.5).steady(torque=motor)
    assert steady["status"] == 0
    for name in ("omega_mean", "fluctuation", "power_mean", "multiplier"):
        assert steady[name] == pytest.approx(same[name], rel=1e-9), name


@pytest.mark.parametrize(
    ("kind", "parameter", "value"),
    [
        ("gas", "AB", 0.045), ("gas", "phase[1]", 0.4), ("gas", "m_slider", 0.4),
        ("friction", "mu", MU), ("friction", "phase[1]", 0.4), ("of the speed", "AB", 0.045),
    ],
)  # fmt: skip
def test_derivatives_of_a_steady_state(kind, parameter, value):
    shaft, h = crankshaft("V").replace(**KINDS[kind]), 1e-5 * value
    ends = [shaft.replace(**{parameter: value + s * h}).steady(torque=MOTOR) for s in (1, -1)]
    gradient = shaft.steady(torque=MOTOR)["gradient"]
    for name in ("omega_mean", "fluctuation", "power_mean"):
        slope = (ends[0][name] - ends[1][name]) / (2.0 * h)
        assert gradient[name][parameter] == pytest.approx(slope, rel=1e-4), name
