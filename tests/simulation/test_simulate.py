"""The motion under a torque: against Taylor series of the raw loop, energy, closed forms and statics."""

import math
import pickle
import re
import subprocess
import sys
from itertools import pairwise

import mpmath
import numpy as np
import pytest

import desaxe as dx
from tests.motions import true_end

PRESS = {
    "AB": 0.14, "BC": 0.31, "ec": 0.06, "m_crank": 0.7637, "m_rod": 1.559464, "m_slider": 1.95025,
    "I_crank": 80.6e-6, "I_rod": 166.8085e-6,
}  # fmt: skip
LOADED = {**PRESS, "r_rod": 0.1, "r_crank": -0.03, "g_X": -3.0, "g_Y": -9.81, "F_Y": 4.0}
ROCKER = {**PRESS, "BC": 0.16}  # cannot turn fully
CRANK = {"AB": 0.14, "BC": 0.31, "ec": 0.0, "m_crank": 1.0, "I_crank": 0.002}  # massless rod and slider
TURN = 2.0 * math.pi


def kinds(result):
    return [event.kind for event in result["events"]]


# ---- the motion itself ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("design", "torque", "theta0", "omega_start"),
    [
        (PRESS, 0.25, 0.0, 0.0),
        pytest.param(LOADED, -0.5, 1.0, 12.0, marks=pytest.mark.thorough),
        (LOADED, lambda t, theta, omega: omega * -0.1 + t * 2.0, 4.0, -3.0),
        # 0.01 m from its change point
        pytest.param({**PRESS, "ec": -0.16}, 0.25, 2.0, 5.0, marks=pytest.mark.thorough),
    ],
)
def test_the_end_of_a_motion(design, torque, theta0, omega_start):
    theta, omega = true_end(design, torque, theta0, omega_start, 0.15, 40)
    result = dx.simulate(
        torque=torque, t_end=0.15, theta0=theta0, omega_start=omega_start, rtol=1e-11, **design
    )
    assert result["status"] == 0
    assert abs(result["theta"][-1] - theta) < 1e-9
    assert abs(result["omega"][-1] - omega) < 1e-9 * max(1.0, abs(omega))
    assert result["energy_residual"] < 1e-9


def test_without_a_torque_the_energy_stays():
    result = dx.simulate(
        torque=0.0,
        t_end=3.0,
        omega_start=10.0,
        names=["kinetic_energy", "potential_energy"],
        **PRESS,
        g_Y=-9.81,
    )
    energy = result["kinetic_energy"] + result["potential_energy"]
    assert np.ptp(energy) < 1e-9 * result["kinetic_energy"].max()
    assert (result["work"], result["status"]) == (0.0, 0)
    assert result["energy_residual"] < 1e-9


def test_a_constant_torque_works_by_the_angle():
    result = dx.simulate(torque=0.25, t_end=3.0, **PRESS)
    assert result["work"] == pytest.approx(0.25 * result["theta"][-1], rel=1e-10)
    assert result["work"] == pytest.approx(
        dx.evaluate("kinetic_energy", theta=result["theta"][-1], omega=result["omega"][-1], **PRESS),
        rel=1e-10,
    )


def test_the_torque_that_the_motion_takes_is_the_torque_given():
    def torque(t, theta, omega):
        return 0.4 * math.cos(3.0 * t) - 0.02 * omega

    result = dx.simulate(torque=torque, t_end=2.0, names=["T_in"], mu=0.2, **LOADED)
    given = [torque(*row) for row in zip(result["t"], result["theta"], result["omega"], strict=True)]
    resting = (result["omega"] == 0.0) & (result["alpha"] == 0.0)
    np.testing.assert_allclose(result["T_in"][~resting], np.array(given)[~resting], rtol=0, atol=1e-10)


def test_backwards_in_time_it_comes_back():
    there = dx.simulate(torque=0.3, t_end=1.0, omega_start=2.0, **LOADED)
    back = dx.simulate(
        torque=0.3, t_end=1.0, theta0=there["theta"][-1], omega_start=-there["omega"][-1], **LOADED
    )
    assert abs(back["theta"][-1]) < 1e-8
    assert back["omega"][-1] == pytest.approx(-2.0, abs=1e-8)


def test_the_mirror_of_a_design_moves_like_it():
    one = dx.simulate(torque=0.3, t_end=1.0, theta0=0.4, omega_start=2.0, mu=0.1, **PRESS, g_X=2.0)
    other = dx.simulate(
        torque=-0.3, t_end=1.0, theta0=-0.4, omega_start=-2.0, mu=0.1, **{**PRESS, "ec": -0.06}, g_X=-2.0
    )
    np.testing.assert_allclose(other["theta"], -one["theta"], rtol=0, atol=1e-11)


def test_the_other_branch_is_the_slider_on_the_other_side():
    """Turned by half a turn, the slider with its eccentricity on the other side."""
    one = dx.simulate(torque=0.3, t_end=1.0, theta0=0.4, **PRESS, F_Y=2.0)
    other = dx.simulate(
        torque=0.3, t_end=1.0, theta0=0.4 + math.pi, branch=-1, **{**PRESS, "ec": -0.06}, F_Y=-2.0
    )
    np.testing.assert_allclose(other["theta"], one["theta"] + math.pi, rtol=0, atol=1e-11)


def test_only_a_crank_is_a_pendulum():
    """theta'' = -(m g r/I) sin(theta): a quarter of the period is K(sin(a/2))/w."""
    amplitude = 2.5
    result = dx.simulate(torque=0.0, t_end=2.0, theta0=math.pi - amplitude, g_Y=-9.81, **CRANK)
    inertia = 0.002 + 1.0 * 0.07**2
    period = 4.0 * mpmath.ellipk(math.sin(amplitude / 2.0) ** 2) / math.sqrt(1.0 * 9.81 * 0.07 / inertia)
    times = [event.t for event in result["events"] if event.kind == "standstill"]
    assert len(times) >= 2
    for k, t in enumerate(times):
        assert abs(t - (k + 1) * period / 2.0) < 1e-9
    assert result["energy_residual"] < 1e-9


# ---- events --------------------------------------------------------------------------------------


@pytest.mark.parametrize(("ec", "branch"), [(0.06, 1), (-0.1, 1), (0.06, -1), (0.0, 1)])
@pytest.mark.parametrize("mu", [0.0, 0.05])
def test_dead_centres(ec, branch, mu):
    design = {**PRESS, "ec": ec}
    result = dx.simulate(torque=0.0, t_end=1.5, theta0=0.5, omega_start=15.0, branch=branch, mu=mu, **design)
    outer, inner = math.asin(-ec / 0.45), math.pi - math.asin(ec / 0.17)
    closed = {"outer": outer, "inner": inner}
    if branch < 0:
        closed = {"outer": math.pi - outer, "inner": math.pi - inner}
    message = [event for event in result["events"] if event.kind == "dead centre"]
    assert len(message) >= 3
    assert all(a.which != b.which for a, b in pairwise(message))
    for event in message:
        away = (event.theta - closed[event.which] + 1.0) % TURN - 1.0
        assert abs(away) < 1e-12
        at = result["solution"](event.t)
        assert abs(at["theta"] - event.theta) < 1e-9
        assert at["omega"] == pytest.approx(event.omega, abs=1e-8)


def test_the_first_angle_that_is_reached_ends_the_motion():
    result = dx.simulate(torque=0.25, t_end=10.0, until=[5.0, -3.0, 9.0], **PRESS)
    assert (result["status"], result["theta"][-1], kinds(result)[-1]) == (0, 5.0, "angle")
    assert result["t"][-1] == result["events"][-1].t < 10.0
    assert "angle 5 rad" in result["message"]


@pytest.mark.parametrize("torque", [0.25, lambda theta: 0.25], ids=["energy", "panels"])
def test_numbers_of_a_motion_are_plain_floats(torque):
    result = dx.simulate(torque=torque, t_end=10.0, until=5.0, **PRESS)
    numbers = [result["t_last"], result["work"], result["energy_residual"]]
    numbers += [number for event in result["events"] for number in event[1:4]]
    assert {type(number) for number in numbers} == {float}


def test_an_angle_that_is_passed_within_a_turning_back_counts():
    """The crank turns round just behind the angle."""
    swing = dx.simulate(torque=0.0, t_end=2.0, theta0=1.0, g_Y=-9.81, **CRANK)
    top = next(event.theta for event in swing["events"] if event.kind == "standstill")
    result = dx.simulate(torque=0.0, t_end=2.0, theta0=1.0, g_Y=-9.81, until=top - 1e-6, **CRANK)
    assert result["theta"][-1] == top - 1e-6
    assert (
        dx.simulate(torque=0.0, t_end=2.0, theta0=1.0, g_Y=-9.81, until=top + 1e-6, **CRANK)["t"][-1] == 2.0
    )


def limit_time(design, torque, theta0):
    """The time from rest at theta0 to the upper limit angle: of sqrt(M/2E), theta = limit - x^2."""
    with mpmath.workdps(40):
        AB, BC, ec = (mpmath.mpf(design[name]) for name in ("AB", "BC", "ec"))
        last = mpmath.asin((BC - ec) / AB)

        def integrand(x):
            theta = last - x**2
            s, c = mpmath.sin(theta), mpmath.cos(theta)
            u = ec + AB * s
            turn = AB * c / mpmath.sqrt(abs((BC - u) * (BC + u)))
            Y = -AB * s - u * turn
            x_rod, y_rod = AB * c / 2, (Y - AB * s) / 2
            M = design["m_crank"] * AB**2 / 4 + design["I_crank"] + design["m_slider"] * Y**2
            M += design["m_rod"] * (x_rod**2 + y_rod**2) + design["I_rod"] * turn**2
            return mpmath.sqrt(M / (2 * torque * abs(theta - theta0))) * 2 * x

        start = mpmath.sqrt(last - theta0)
        time = mpmath.quad(lambda y: integrand(start - y**2) * 2 * y, [0, mpmath.sqrt(start)])
        return float(last), float(time)


@pytest.mark.parametrize("masses", ["all", "crank"])
def test_a_limit_angle_ends_the_motion(masses):
    light = {"m_rod": 0.0, "m_slider": 0.0, "I_rod": 0.0} if masses == "crank" else {}
    design = {**ROCKER, **light}
    last, time = limit_time(design, 0.25, 0.1)
    result = dx.simulate(torque=0.25, t_end=3.0, theta0=0.1, **design)
    event = result["events"][-1]
    assert (result["status"], event.kind) == (2, "limit")
    assert abs(event.theta - last) <= 1e-12 * last
    assert event.theta == result["theta"][-1]
    assert abs(event.t - time) < 1e-9
    assert (event.omega == 0.0) == (masses == "all")
    assert result["energy_residual"] < 1e-9
    assert result["t"][-1] == event.t
    if masses == "all":  # theta'' there, from the history before it
        t, omega = result["t"][-3:-1], result["omega"][-3:-1]
        slope = (omega[1] - omega[0]) / (t[1] - t[0])
        assert result["alpha"][-1] == pytest.approx(slope, rel=2e-2)


def test_a_load_that_grows_without_bound_at_a_limit():
    """On a massless slider: F_Y Y' is infinite there, its work is not."""
    design = {"AB": 0.1, "BC": 0.15, "ec": -0.06, "m_crank": 0.3, "I_crank": 0.0009, "F_Y": 10.0}
    result = dx.simulate(torque=0.0, t_end=1.0, theta0=0.3, omega_start=-70.0, **design)
    last = math.asin((0.06 - 0.15) / 0.1)
    assert result["status"] == 2
    assert result["theta"][-1] == pytest.approx(last, rel=1e-12)
    assert result["energy_residual"] < 1e-9
    inertia = 0.0009 + 0.3 * 0.05**2
    lost = 10.0 * (dx.evaluate("Y", theta=0.3, ec=-0.06, AB=0.1, BC=0.15) - 0.1 * math.cos(last))
    assert result["omega"][-1] == pytest.approx(-math.sqrt(70.0**2 - 2.0 * lost / inertia), rel=1e-6)


def test_a_function_of_the_slider_up_to_a_limit():
    """Next to the limit angle differences by the angle reach beyond it, where the slider has no position."""
    design = {
        "AB": 0.05663913651858137, "BC": 0.058461746867518684, "ec": -0.008, "m_crank": 0.3, "I_crank": 0.01,
        "m_rod": 0.4993093709566365, "I_rod": 0.0005, "m_slider": 0.7663571141360432, "mu": 0.05,
        "theta0": 0.0874111342590364, "omega_start": -6.0,
    }  # fmt: skip
    result = dx.simulate(torque=lambda Y, omega: 2.0 + 5.0 * Y - 0.05 * omega, t_end=0.4, **design)
    assert result["status"] == 2
    last = math.pi + math.asin((design["BC"] + design["ec"]) / design["AB"])
    assert result["theta"][-1] == pytest.approx(last, rel=1e-12)


def test_steps_that_end_next_to_a_limit():
    """Designs whose steps fall anywhere: each reaches its limit angle, at a time that tells no steps."""
    for omega in np.linspace(3.0, 3.4, 9).tolist():
        loose, tight = (
            dx.simulate(torque=0.25, t_end=3.0, theta0=0.1, omega_start=omega, rtol=rtol, **ROCKER)
            for rtol in (1e-9, 1e-11)
        )
        assert loose["status"] == tight["status"] == 2
        assert loose["t"][-1] == pytest.approx(tight["t"][-1], abs=3e-9)
        assert loose["energy_residual"] < 1e-9


def test_a_swing_between_limits_goes_on():
    result = dx.simulate(torque=lambda t, theta, omega: -2.0 * theta, t_end=5.0, theta0=0.5, **ROCKER)
    assert result["status"] == 0
    assert kinds(result).count("standstill") >= 4
    assert result["theta"].max() == pytest.approx(0.5, abs=1e-8)
    assert result["energy_residual"] < 1e-9


def test_a_change_point_is_a_limit():
    design = {"AB": 0.125, "BC": 0.25, "ec": 0.125, "m_slider": 1.0, "m_crank": 1.0}
    result = dx.simulate(torque=0.05, t_end=5.0, theta0=1.0, **design)
    assert (result["status"], result["theta"][-1]) == (2, math.pi / 2)


def test_a_crank_without_inertia_ends_before_a_dead_centre():
    result = dx.simulate(torque=0.05, t_end=5.0, theta0=1.0, AB=0.14, BC=0.31, ec=0.06, m_slider=1.0)
    assert result["status"] == 5
    assert result["theta"][-1] == pytest.approx(math.pi - math.asin(0.06 / 0.17), abs=2e-4)
    assert "effective inertia vanishes at the inner dead centre" in result["message"]


def test_a_torque_that_jumps_with_the_way_of_turning_is_told():
    def brake(t, theta, omega):
        return -math.copysign(2.0, omega)

    result = dx.simulate(torque=brake, t_end=5.0, omega_start=5.0, **PRESS)
    assert result["status"] == 4
    assert "chatters at standstill" in result["message"]


@pytest.mark.parametrize("masses", [{}, {"m_slider": 0.0, "m_rod": 0.0}, {"mu": 0.05}], ids=str)
@pytest.mark.parametrize("rtol", [1e-10, 1e-4])
@pytest.mark.parametrize(
    ("torque", "speed"),
    [
        (lambda omega: 5.0 if omega < 10.0 else -5.0, 10.0),
        (lambda omega: 5.0 if omega <= -7.0 else -5.0, -7.0),
        (lambda t, omega: 5.0 if omega < 10.0 + 0.0 * t else -5.0, 10.0),
    ],
)
def test_a_two_point_controller_chatters_and_ends_soon(torque, speed, rtol, masses):
    calls = []

    def counted(t, omega):
        calls.append(t)
        return torque(omega) if torque.__code__.co_argcount == 1 else torque(t, omega)

    result = dx.simulate(torque=counted, t_end=2.0, rtol=rtol, **{**PRESS, **masses})
    assert result["status"] == 4
    assert f"jumps back and forth across omega = {speed:g}; let it" in result["message"]
    assert result["omega"][-1] == pytest.approx(speed, rel=0.01)
    assert len(calls) < 100_000


def test_a_two_point_controller_of_many_designs_ends_soon():
    def held(omega):
        return 5.0 if omega < 10.0 else -5.0

    result = dx.simulate(torque=held, t_end=2.0, timeout=20.0, **{**PRESS, "AB": np.array([0.14, 0.12])})
    assert result["status"].tolist() == [4, 4]
    assert (result["t_last"] < 1.0).all()


def test_a_torque_that_is_steep_over_a_range_of_speeds_does_not_chatter():
    result = dx.simulate(torque=lambda omega: 5.0 * math.tanh(50.0 * (10.0 - omega)), t_end=1.0, **PRESS)
    assert result["status"] == 0
    assert result["omega"][-1] == pytest.approx(10.0, abs=0.1)


def test_too_many_steps_are_a_failure():
    result = dx.simulate(torque=0.25, t_end=5.0, max_steps=10, **PRESS)
    assert result["status"] == 4
    assert "more than 10 steps" in result["message"]


# ---- friction ------------------------------------------------------------------------------------

PRESSED = {**PRESS, "mu": 0.3, "F_X": 50.0, "g_Y": -2.0}


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize("theta0", [1.0, 2.0, 4.5])
def test_a_crank_starts_where_statics_says_so(theta0, way):
    """T_in for a vanishing acceleration is the torque that breaks away."""
    least = dx.evaluate("T_in", theta=theta0, omega=0.0, alpha=way * 1e-12, **PRESSED)
    short = dx.simulate(torque=least - way * 1e-6, t_end=0.1, theta0=theta0, **PRESSED)
    beyond = dx.simulate(torque=least + way * 1e-6, t_end=0.1, theta0=theta0, **PRESSED)
    assert (short["status"], short["t"].size, short["theta"][-1]) == (1, 1001, theta0)
    assert beyond["status"] == 0
    assert way * (beyond["theta"][-1] - theta0) > 0.0


def test_a_growing_torque_breaks_away_when_statics_says_so():
    least = dx.evaluate("T_in", theta=1.0, omega=0.0, alpha=1e-12, **PRESSED)
    result = dx.simulate(torque=lambda t, theta, omega: t, t_end=least + 0.1, theta0=1.0, **PRESSED)
    event = result["events"][0]
    assert event.kind == "break-away"
    assert event.t == pytest.approx(least, abs=1e-9)
    assert result["theta"][-1] > 1.0
    waits = dx.simulate(torque=lambda t, theta, omega: t, t_end=0.9 * least, theta0=1.0, **PRESSED)
    assert (waits["status"], waits["theta"][-1], waits["t"][-1]) == (0, 1.0, 0.9 * least)
    assert "at rest" in waits["message"]


def test_a_brake_stalls():
    """All kinetic energy goes into the brake and the friction; what is left cannot move the crank."""
    design = {**PRESS, "mu": 0.3, "F_X": 50.0}
    result = dx.simulate(torque=-0.1, t_end=20.0, theta0=0.8, omega_start=6.0, **design)
    assert (result["status"], kinds(result)[-1]) == (1, "standstill")
    assert result["t"][-1] == result["events"][-1].t < 20.0
    start = dx.evaluate("kinetic_energy", theta=0.8, omega=6.0, **PRESS)
    assert result["work"] == pytest.approx(-start, rel=1e-9)
    assert result["energy_residual"] < 1e-9


def test_friction_on_a_slide_without_a_rod_angle_is_coulombs():
    """A rod so long that the guide feels the load across alone: |N| = F_X, the work is mu F_X |dY|."""
    design = {"AB": 0.1, "BC": 1e7, "ec": 0.0, "I_crank": 0.01, "mu": 0.1, "F_X": 30.0}
    result = dx.simulate(torque=0.0, t_end=1.0, theta0=0.5, omega_start=20.0, **design)
    theta = result["theta"][-1]
    turns, rest = divmod(theta, math.pi)
    path = 2.0 * turns + (1.0 - math.cos(rest)) - (1.0 - math.cos(0.5))
    assert result["work"] == pytest.approx(-0.1 * 30.0 * 0.1 * path, rel=1e-6)


def test_energy_with_friction_through_every_kink():
    result = dx.simulate(torque=lambda t, theta, omega: 4.0 * math.sin(5.0 * t), t_end=4.0, **PRESSED)
    assert result["status"] == 0
    assert {"dead centre", "standstill", "break-away"} <= set(kinds(result))
    assert result["energy_residual"] < 1e-9


def test_kinks_at_one_instant_are_all_met():
    """With ec = 0 and no rod mass the normal force changes its side just at the dead centres."""
    design = {"AB": 0.14, "BC": 0.31, "ec": 0.0, "m_crank": 1.0, "m_slider": 1.0, "mu": 0.3}
    result = dx.simulate(torque=0.05, t_end=3.0, **design)
    message = [event.theta / math.pi for event in result["events"] if event.kind == "dead centre"]
    assert message == pytest.approx([1.0, 2.0, 3.0, 4.0][: len(message)], abs=1e-12)
    assert len(message) >= 4
    assert result["energy_residual"] < 1e-9


def test_a_jam_on_the_way_is_told_at_once():
    """Next to a change point the rod is nearly across: |N| grows without bound."""
    result = dx.simulate(torque=0.5, t_end=2.0, omega_start=10.0, mu=0.1, **{**PRESS, "BC": 0.2 + 1e-8})
    assert (result["status"], kinds(result)[-1]) == (3, "friction jams")
    assert "no forces balance" in result["message"]
    design = {"AB": 0.14, "BC": 0.21, "ec": 0.06, "I_crank": 0.05, "m_slider": 0.01, "mu": 1.5, "F_Y": -3.0}
    result = dx.simulate(torque=2.0, t_end=5.0, theta0=-0.1, omega_start=5.0, **design)
    assert "two sets of forces balance" in result["message"]


@pytest.mark.parametrize("torque", [-0.7, -0.5, 0.0, 3.0])
def test_a_steep_rod_rests_only_where_statics_lets_it(torque):
    """The torque alone loads the rod; friction has to balance the rest of F_Y by mu |N|, here mu tan > 1."""
    design = {"AB": 0.04, "BC": 0.101, "ec": 0.06, "mu": 2.0, "F_Y": -50.0, "m_slider": 1.0, "I_crank": 0.01}
    result = dx.simulate(torque=torque, t_end=0.05, **design)
    across = 0.06 / math.sqrt(0.101**2 - 0.06**2)  # the crank is level: Y' = -AB across
    along = -torque / (0.04 * across)  # what the rod exerts on the slider
    assert (result["status"] == 1) == (abs(along - 50.0) <= 2.0 * abs(along * across))
    several = dx.simulate(torque=[torque, torque], t_end=0.05, **design)
    assert several["status"].tolist() == [result["status"]] * 2
    assert result["status"] == 1 or "two sets of forces balance" in result["message"]


def test_an_angle_that_is_a_dead_centre_is_both():
    result = dx.simulate(torque=0.25, t_end=3.0, until=math.pi - math.asin(0.06 / 0.17), **PRESS)
    assert kinds(result) == ["dead centre", "angle"]


def test_friction_that_jams_is_told():
    design = {"AB": 0.14, "BC": 0.21, "ec": 0.06, "I_crank": 0.001, "mu": 2.0, "F_Y": -10.0}
    result = dx.simulate(torque=1.0, t_end=5.0, theta0=0.9, omega_start=2.0, **design)
    assert (result["status"], kinds(result)) == (3, ["friction jams"])
    assert "balance" in result["message"]


# ---- what is told --------------------------------------------------------------------------------


def test_names_are_those_of_evaluate():
    names = ["V_C", "N_C", "T_in_wrt_m_slider", "Y_wrt_ec"]

    def load(t, theta, omega):
        return 3.0 + t

    result = dx.simulate(torque=0.25, t_end=1.0, names=names, F_Y=load, mu=0.1, **PRESS)
    state = {"theta": result["theta"], "omega": result["omega"], "alpha": result["alpha"]}
    again = dx.evaluate(names, **state, F_Y=3.0 + result["t"], mu=0.1, **PRESS)
    for name in names:
        np.testing.assert_array_equal(result[name], again[name])


def test_the_histories():
    result = dx.simulate(torque=0.25, t_end=1.0, **PRESS)
    assert list(result)[:4] == ["t", "theta", "omega", "alpha"]
    assert result["t"].shape == result["theta"].shape == (1001,)
    assert (result["t"][0], result["t"][-1]) == (0.0, 1.0)
    few = dx.simulate(torque=0.25, t_end=1.0, times=[0.0, 0.25, 1.0], **PRESS)
    np.testing.assert_allclose(few["theta"], result["theta"][[0, 250, 1000]], rtol=1e-14)
    both = result["solution"](np.array([[1.0, 0.25]]))
    np.testing.assert_allclose(both["omega"], result["omega"][[1000, 250]][None], rtol=1e-14)
    np.testing.assert_allclose(
        np.gradient(result["omega"], result["t"])[1:-1],
        result["alpha"][1:-1],
        atol=1e-3 * result["alpha"].max(),
    )
    shown = repr(result)
    assert "reached t_end = 1 s" in shown
    assert "dead centre (inner)" in shown
    assert len(shown.splitlines()) < 24
    assert "solution(t)" in repr(result["solution"])


def test_a_load_given_as_a_function_is_the_same_as_a_number():
    one = dx.simulate(torque=0.25, t_end=1.0, F_Y=3.0, F_X=2.0, mu=0.1, **PRESS)
    other = dx.simulate(
        torque=lambda t, theta, omega: 0.25,
        t_end=1.0,
        F_Y=lambda t, theta, omega: 3.0,
        F_X=lambda t, theta, omega: 2.0,
        mu=0.1,
        **PRESS,
    )
    np.testing.assert_allclose(one["theta"], other["theta"], rtol=1e-11)


def test_units():
    plain = dx.simulate(
        torque=0.25, t_end=0.5, theta0=math.radians(30), omega_start=TURN, until=math.pi / 2, **PRESS
    )
    text = dx.simulate(
        torque="250 N*mm", t_end="500 ms", theta0="30 deg", omega_start="60 rpm", until="90 deg",
        **{**PRESS, "AB": "140 mm", "m_slider": "1950.25 g"},
    )  # fmt: skip
    np.testing.assert_allclose(text["theta"], plain["theta"], rtol=0, atol=1e-12)


# ---- refusals ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        ({"t_end": 0.0}, ValueError, "t_end = 0.0: it must be a finite time > 0"),
        ({"t_end": math.inf}, ValueError, "t_end = inf"),
        ({"torque": "3 N"}, ValueError, "torque = '3 N': it must be a quantity in N m"),
        ({"torque": None}, TypeError, "torque is missing: simulate expects a finite number or a"),
        ({"torque": math.nan}, ValueError, "torque = nan"),
        ({"torque": lambda t, x: 0.0}, TypeError, "torque: a function is called by the names"),
        ({"torque": lambda t, theta, omega: math.nan}, ValueError, "torque gave nan at t = 0"),
        ({"torque": lambda t, theta, omega: "much"}, TypeError, "torque gave 'much' at t = 0"),
        ({"F_Y": lambda t, theta, omega: math.inf}, ValueError, "F_Y gave inf at t = 0"),
        (
            {"BC": 0.16, "theta0": 1.5},
            ValueError,
            "theta0 = 1.5: it cannot be assembled there; with ec = 0.06",
        ),
        ({"BC": 0.01}, ValueError, "ec = 0.06, AB = 0.14, BC = 0.01"),
        ({"BC": 0.2, "ec": 0.06, "theta0": math.pi / 2}, ValueError, "a limit angle (S = 0)"),
        ({"m_slider": -1.0}, ValueError, "m_slider = -1.0: it must be a finite mass >= 0"),
        ({"theta0": math.nan}, ValueError, "theta0 = nan: it must be a finite number"),
        ({"branch": 2}, ValueError, "branch = 2: it is +1 or -1"),
        ({"names": ["V_D"]}, ValueError, "unknown quantity 'V_D'"),
        ({"names": ["status"]}, ValueError, "'status' is always among the results"),
        ({"method": "Radau"}, TypeError, "simulate() has no input 'method'"),
        ({"rtol": 1e-16}, ValueError, "rtol = 1e-16: it must be a number from 3e-14 to 0.1"),
        ({"times": [0.0, 3.0]}, ValueError, "times[1] = 3: instants must ascend from 0 to t_end = 1"),
        ({"times": 3.0}, ValueError, "times: expected a row of finite instants"),
        ({"until": math.nan}, ValueError, "until = nan"),
    ],
)
def test_what_is_refused(change, error, message):
    arguments = {"torque": 0.25, "t_end": 1.0, **PRESS, **change}
    with pytest.raises(error, match=re.escape(message)):
        dx.simulate(**arguments)


def test_nothing_moves_without_inertia():
    lengths = {"AB": 0.14, "BC": 0.31, "ec": 0.0}
    with pytest.raises(ValueError, match=re.escape("M_eff = 0 kg m^2 at theta0 = 1: nothing moves without")):
        dx.simulate(torque=0.1, t_end=1.0, theta0=1.0, **lengths)
    with pytest.raises(ValueError, match=re.escape("(the outer dead centre)")):
        dx.simulate(torque=0.1, t_end=1.0, m_slider=1.0, **lengths)


def test_a_torque_without_a_value_later_is_told_when_it_is_reached():
    def late(t, theta, omega):
        return 0.1 if t < 0.5 else math.nan

    with pytest.raises(ValueError, match=r"torque gave nan at t = 0\.[5-9]"):
        dx.simulate(torque=late, t_end=1.0, **PRESS)
    assert dx.simulate(torque=late, t_end=1.0, until=0.05, **PRESS)["status"] == 0


def test_the_solution_ends_with_the_motion():
    result = dx.simulate(torque=0.25, t_end=1.0, until=1.0, **PRESS)
    with pytest.raises(ValueError, match="where the motion ends"):
        result["solution"](1.0)


@pytest.mark.parametrize("mu", [0.0, 0.1])
def test_a_simulation_can_be_pickled(mu):
    result = dx.simulate(torque=lambda t, theta, omega: 0.4 - 0.01 * omega, t_end=1.0, mu=mu, **PRESS)
    again = pickle.loads(pickle.dumps(result))
    assert type(again) is type(result)
    assert again["events"] == result["events"]
    t = np.linspace(0.0, again["t"][-1], 11)
    np.testing.assert_array_equal(again["solution"](t)["omega"], result["solution"](t)["omega"])


def test_scipy_is_not_loaded_before_it_is_needed():
    point = "theta=1.0, ec=0.0, AB=1.0, BC=2.0"
    code = f"import sys, desaxe as dx; dx.evaluate('Y', {point}); print('scipy' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


@pytest.mark.parametrize(
    "torque", [0.0, -0.0, lambda t: 0.0, dx.over_theta([0.0, 2.0], [0.0, 0.0], kind="step")]
)
@pytest.mark.parametrize("ec", [0.01, [0.01, 0.02]])
def test_a_crank_that_nothing_moves_stays(torque, ec):
    result = dx.simulate(torque=torque, t_end=0.5, theta0=1.0, ec=ec, AB=0.05, BC=0.2, m_slider=2.0)
    assert (result["theta"] == 1.0).all()
    assert np.all(result["status"] == 0)
    if torque == 0.0:
        slope = dx.simulate(
            torque=0.0,
            t_end=0.5,
            theta0=1.0,
            ec=ec,
            AB=0.05,
            BC=0.2,
            m_slider=2.0,
            wrt=["torque", "omega_start"],
        )
        M_eff = dx.evaluate("M_eff", theta=1.0, ec=ec, AB=0.05, BC=0.2, m_slider=2.0)
        np.testing.assert_allclose(slope["theta_wrt_torque"][..., -1], 0.125 / M_eff, rtol=1e-9)
        np.testing.assert_allclose(slope["theta_wrt_omega_start"][..., -1], 0.5, rtol=1e-9)


@pytest.mark.parametrize("torque", [1.5, -1.5])
def test_a_start_at_rest_has_the_load_of_the_way_in_which_it_starts(torque):
    """Without friction the drive torque is the torque given, also at the instant of the start."""
    load = dx.over_Y([0.1, 0.3], [-5.0, -5.0], inward=[7.0, 7.0])
    result = dx.simulate(
        torque=torque, t_end=1e-3, theta0=1.0, omega_start=0.0, names=["T_in"], times=[0.0, 1e-3],
        ec=0.01, AB=0.05, BC=0.2, m_slider=2.0, I_crank=0.05, F_Y=load,
    )  # fmt: skip
    np.testing.assert_allclose(result["T_in"], torque, rtol=1e-9)
    assert result["alpha"][0] == pytest.approx(result["alpha"][1], rel=1e-3)
