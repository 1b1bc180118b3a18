"""One load, the same meaning in every call: motion, drive, flywheel, harmonics, tolerance, optimum."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

import desaxe as dx
from desaxe.design.measures import measured

BODIES = {"ec": 0.01, "AB": 0.04, "BC": 0.064, "m_rod": 0.5, "m_slider": 0.8}
TURN = 2 * np.pi
STEP = dx.over_theta([0.0, 1.0, 2.0, 4.0], [0.0, -400.0, -50.0, 20.0], kind="step")
LOADS = {
    "cubic": dx.over_theta([0.0, 1.0, 2.0, 4.0], [0.0, -400.0, -50.0, 20.0]),
    "step": STEP,
    "function": dx.over_theta(
        lambda theta: np.where(np.mod(theta, TURN) < 1.0, -300.0, 0.0), nodes=[0.0, 1.0]
    ),
}


def work(load, a, b):
    """The work of the load between two crank angles: the integral of F dY."""

    def power(theta):
        return dx.evaluate("Y_wrt_theta", theta=theta, ec=0.01, AB=0.04, BC=0.064) * float(load(theta))

    inside = np.linspace(a, b, 41)
    parts = np.unique([a, b, *load.nodes(a, b, smooth=False), *inside])
    return sum(quad(power, *ends, epsabs=1e-13)[0] for ends in pairwise(parts))


@pytest.mark.parametrize("kind", ["cubic", "step", "function"])
@pytest.mark.parametrize("mu", [0.0, 0.1])
def test_the_motion_keeps_its_energy_and_its_torque_across_jumps(kind, mu):
    run = dx.simulate(
        torque=8.0,
        t_end=0.3,
        omega_start=30.0,
        I_crank=0.01,
        mu=mu,
        F_Y=LOADS[kind],
        names=["T_in"],
        **BODIES,
    )
    assert run["energy_residual"] < 1e-11
    np.testing.assert_allclose(
        run["T_in"], 8.0, rtol=1e-9
    )  # the torque that this motion needs is the one given


BY_NAME = {
    "t": (lambda t: 5.0 + t, lambda t, x, v, Y, s, V: 5.0 + t),
    "swapped": (
        lambda omega, theta: 5.0 + np.cos(theta) - omega,
        lambda t, x, v, Y, s, V: 5.0 + np.cos(x) - v,
    ),
    "a default": (lambda theta, omega=9.0: omega - np.cos(theta), lambda t, x, v, Y, s, V: 9.0 - np.cos(x)),
    "by name alone": (lambda *, V_C, t: 5.0 + t - 9.0 * V_C, lambda t, x, v, Y, s, V: 5.0 + t - 9.0 * V),
    "the slider": (lambda s, Y: 5.0 - 70.0 * s + Y, lambda t, x, v, Y, s, V: 5.0 - 70.0 * s + Y),
}


@pytest.mark.parametrize(("torque", "meant"), BY_NAME.values(), ids=BY_NAME)
@pytest.mark.parametrize("loaded", ["torque", "F_Y"])
def test_a_function_is_called_by_the_names_of_its_arguments(torque, meant, loaded):
    """Against SciPy on a crank with a slider without mass: I alpha = T + F_Y dY/dtheta."""
    ec, AB, BC, inertia = 0.01, 0.04, 0.064, 0.05

    def slider(x, v):
        root = np.sqrt(BC**2 - (ec + AB * np.sin(x)) ** 2)
        slope = -AB * np.sin(x) - (ec + AB * np.sin(x)) * AB * np.cos(x) / root
        Y = AB * np.cos(x) + root
        return Y, np.sqrt((AB + BC) ** 2 - ec**2) - Y, slope

    def rate(t, y):
        Y, s, slope = slider(*y)
        value = meant(t, *y, Y, s, slope * y[1])
        return y[1], (value if loaded == "torque" else 2.0 + value * slope) / inertia

    truth = solve_ivp(rate, (0.0, 0.5), [0.3, 1.0], method="DOP853", rtol=1e-12, atol=1e-12).y[1, -1]
    call = {"torque": 2.0, "t_end": 0.5, "theta0": 0.3, "omega_start": 1.0, "ec": ec, "AB": AB, "BC": BC}
    call[loaded] = torque
    assert dx.simulate(**call, I_crank=inertia)["omega"][-1] == pytest.approx(truth, rel=1e-8)
    many = dx.simulate(**call, I_crank=[inertia, 2.0 * inertia])
    assert many["omega"][0, -1] == pytest.approx(truth, rel=1e-8)


def test_harmonics_across_jumps_are_integrals():
    """Of a force that jumps: the guide carries it where nothing has mass, and nothing else."""
    light = {"ec": 0.0, "AB": 0.04, "BC": 0.064}
    result = dx.harmonics("F_C_Y", orders=40, F_Y=STEP, **light)
    knots, values = [0.0, 1.0, 2.0, 4.0, TURN], [0.0, 400.0, 50.0, -20.0]  # the slider on the rod
    for n in (1, 7, 40):
        pieces = zip(pairwise(knots), values, strict=True)
        cosine = sum(v * (np.sin(n * b) - np.sin(n * a)) / n / np.pi for (a, b), v in pieces)
        assert abs(result["cos"][n]) == pytest.approx(abs(cosine), abs=1e-11)
    squares = sum(v * v * (b - a) for (a, b), v in zip(pairwise(knots), values, strict=True)) / TURN
    series = result["mean"] ** 2 + 0.5 * np.sum(result["amplitude"][1:] ** 2)
    assert result["remainder"] == pytest.approx(np.sqrt(squares - series), rel=1e-9)


def test_a_four_stroke_load_repeats_after_two_turns():
    load = dx.over_theta([0.0, 1.0, 7.0, 8.0], [0.0, -10.0, 0.0, -500.0], kind="linear", period=2 * TURN)
    machine = BODIES | {"omega0": 50.0}
    motor = dx.drive(fluctuation=0.05, F_Y=load, **machine)
    assert motor["torque_mean"] == pytest.approx(-work(load, 0.0, 2 * TURN) / (2 * TURN), rel=1e-9)
    assert motor["power_mean"] == pytest.approx(50.0 * motor["torque_mean"], rel=1e-9)
    assert "Drive over 2 turns" in motor.report()
    assert "477.465 rpm, 0.251327 s in 2 turns" in motor.report()
    ends = {"theta": (0.0, 2 * TURN), "F_Y": load, **machine}
    assert motor["torque_peak"] == pytest.approx(dx.peak("T_in", **ends)["value"], rel=1e-12)
    back = dx.drive(fluctuation=0.05, F_Y=load, **machine | {"omega0": -50.0})
    assert back["work_in"] == pytest.approx(motor["work_out"], rel=1e-9)
    assert dx.harmonics("T_in", F_Y=load, **machine)["mean"] == pytest.approx(motor["torque_mean"], rel=1e-12)
    mean = measured([("mean", "T_in")], {**machine, "F_Y": load})[("mean", "T_in")].value
    assert mean == pytest.approx(motor["torque_mean"], rel=1e-9)
    machine["F_Y"] = dx.over_theta([0.0, 1.0], [0.0, -10.0], kind="linear", period=5 * TURN)
    with pytest.raises(ValueError, match="F_Y: drive is over at most 4 turns, after which the load must rep"):
        dx.drive(**machine)


STEPS = dx.over_Y([0.02, 0.05, 0.08, 0.1], [-900, -200, -50, -30], [-90, -40, -15, -3], kind="step")
DIE = dx.over_stroke([0.0, 0.008, 0.008], [-8e3, -8e3, 0.0], [0.0, 0.0, 0.0], dead_centre="outer")


@pytest.mark.parametrize("steps", [STEPS, DIE], ids=["Y", "stroke"])
@pytest.mark.parametrize("measure", [("rms", "T_in"), ("mean", "N_C"), ("rms", "F_C_Y")])
def test_averages_and_their_gradients_across_jumps_that_move(measure, steps):
    machine = {"AB": 0.04, "BC": 0.064, "m_slider": 0.8, "omega0": 50.0, "F_Y": steps}

    def at(ec):
        return measured([measure], {**machine, "ec": np.array([ec])})[measure]

    series = dx.harmonics(measure[1], orders=0, ec=0.01, **machine)
    right = series["mean"] if measure[0] == "mean" else np.hypot(series["mean"], series["remainder"])
    assert at(0.01).value[0] == pytest.approx(right, rel=1e-9, abs=1e-9)
    slope = (at(0.01 + 1e-6).value - at(0.01 - 1e-6).value) / 2e-6
    assert at(0.01).gradient["ec"] == pytest.approx(slope, rel=1e-6)


LIGHT = {"ec": 0.01, "AB": 0.04, "BC": 0.064, "omega0": 50.0}


def test_a_function_has_its_period_in_every_call_over_a_cycle():
    """Massless: T_in = -F_Y dY/dtheta, and the flywheel stores the largest work less the smallest."""
    load = dx.over_theta(lambda theta: 800.0 * np.cos(theta / 2) - 300.0 * np.sin(theta), period=2 * TURN)
    machine = {**LIGHT, "F_Y": load}

    def torque(theta):
        u = 0.01 + 0.04 * np.sin(theta)
        return load(theta) * (0.04 * np.sin(theta) + u * 0.04 * np.cos(theta) / np.sqrt(0.064**2 - u**2))

    mean, square = (
        quad(lambda t, n=n: torque(t) ** n, 0.0, 2 * TURN, epsabs=1e-12, limit=200)[0] / (2 * TURN)
        for n in (1, 2)
    )
    motor = dx.drive(fluctuation=0.05, **machine)
    assert motor["torque_mean"] == pytest.approx(mean, rel=1e-12)
    assert motor["torque_rms"] == pytest.approx(square**0.5, rel=1e-12)
    theta = np.linspace(0.0, 2 * TURN, 20_001)
    rate = mean - torque(theta)
    work = np.append(0.0, np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(theta)))
    assert motor["flywheel_inertia"] == pytest.approx(np.ptp(work) / (0.05 * 50.0**2), rel=1e-6)
    del machine["AB"]
    best = dx.optimize(minimize=("rms", "T_in"), over={"AB": (0.04, 0.04 + 1e-9)}, starts=1, **machine)
    assert best["value"] == pytest.approx(square**0.5, rel=1e-6)


CYCLES = {
    "drive": dx.drive,
    "harmonics": lambda **inputs: dx.harmonics("T_in", **inputs),
    "mean": lambda **inputs: dx.design_map([("mean", "T_in")], **{**inputs, "ec": [0.0, 0.01]}),
    "rms": lambda **inputs: dx.optimize(minimize=("rms", "T_in"), over={"m_rod": (0.0, 0.1)}, **inputs),
    "steady": lambda omega0, **inputs: dx.steady(torque=dx.kloss(9, 0.2, 100), **inputs),
}


@pytest.mark.parametrize("name", CYCLES)
@pytest.mark.parametrize(
    "function",
    [lambda theta: 9.0 * theta, lambda theta: 90.0 * (theta < 3.0), lambda theta: np.cos(theta / 2)],
)
def test_a_function_that_does_not_repeat_is_refused_where_a_cycle_is_requested(name, function):
    with pytest.raises(ValueError, match=r"F_Y: .* the load must repeat; this function does not after 6\.28"):
        CYCLES[name](**{**LIGHT, "m_slider": 1.0, "F_Y": function})


@pytest.mark.parametrize("mu", [0.0, 0.1])
def test_a_load_that_opposes_either_way_holds_a_crank_at_rest(mu):
    """It stops, stays, and breaks away once the torque is that of the load (and of friction)."""
    ends = dx.events(**{n: BODIES[n] for n in ("ec", "AB", "BC")})
    load = dx.over_Y([ends["Y_inner"], ends["Y_outer"]], [-30.0, -30.0], inward=[30.0, 30.0])
    machine = BODIES | {"F_Y": load, "mu": mu, "theta0": 1.0, "omega_start": 0.5}
    still = dx.simulate(torque=0.0, t_end=1.0, **machine)
    assert still["omega"][-1] == 0.0
    assert "at rest from" in still["message"]
    moved = dx.simulate(torque=lambda t, theta, omega: 5.0 * max(t - 1.0, 0.0), t_end=2.0, **machine)
    start = next(event for event in moved["events"] if event.kind == "break-away")
    given = BODIES | {"mu": mu, "F_Y": 30.0, "omega0": 1e-9}
    needed = dx.evaluate("T_in", theta=start.theta, **given)  # inward, against +30 N
    assert 5.0 * (start.t - 1.0) == pytest.approx(needed, rel=1e-6)
