"""Sensitivities of a motion: against 60 digits on the raw loop, closed forms, energy and differences."""

import math

import mpmath
import numpy as np
import pytest

import desaxe as dx
from desaxe.simulation.panel import Record
from tests.effort import cases, first
from tests.motions import true_slopes
from tests.simulation.test_loads import MACHINE
from tests.simulation.test_loads import drawn as random_designs

PRESS = {
    "AB": 0.14, "BC": 0.31, "ec": 0.06, "m_crank": 0.7637, "m_rod": 1.559464, "m_slider": 1.95025,
    "I_crank": 80.6e-6, "I_rod": 166.8085e-6,
}  # fmt: skip
LOADED = {**PRESS, "r_rod": 0.1, "r_crank": -0.03, "g_X": -3.0, "g_Y": -9.81, "F_Y": 4.0}
ROCKER = {**PRESS, "BC": 0.16, "g_Y": -9.81}  # cannot turn fully
CRANK = {"AB": 0.14, "BC": 0.31, "ec": 0.0, "m_crank": 1.0, "I_crank": 0.002, "g_Y": -9.81}
BY_TRUTH = (
    "AB",
    "torque",
    "theta0",
    "ec",
    "BC",
    "m_rod",
    "I_rod",
    "r_rod",
    "r_crank",
    "g_X",
    "F_Y",
    "omega_start",
)
KEYS = ("theta", "omega", "work", "t_last")
H = 2e-5  # of a parameter: the step of the differences


@pytest.mark.sampled
@pytest.mark.parametrize("parameter", BY_TRUTH[: cases(2, 3, len(BY_TRUTH))])
def test_sensitivities_are_those_of_60_digits(parameter):
    start = {"torque": -0.5, "theta0": 1.0, "omega_start": 12.0, "t_end": 0.05}
    result = dx.simulate(**start, times=[0.05], wrt=parameter, **LOADED)
    theta, omega = true_slopes(parameter, LOADED, -0.5, 1.0, 12.0, 0.05, 13)
    assert result[f"theta_wrt_{parameter}"][0] == pytest.approx(theta, rel=1e-12)
    assert result[f"omega_wrt_{parameter}"][0] == pytest.approx(omega, rel=1e-12)


@pytest.mark.parametrize("mu", [0.0, 0.08])
def test_the_numbers_of_an_induction_motor(mu):
    """Differences of motions; the torque of the motor is part of what friction takes."""
    numbers = {"breakdown_torque": 5.0, "breakdown_slip": 0.3, "synchronous_speed": 150.0, "gear": 6.0}
    call = {**PRESS, "mu": mu, "t_end": 0.4, "times": [0.4]}
    result = dx.simulate(torque=dx.kloss(**numbers), wrt=[*numbers], **call)
    for name, number in numbers.items():
        h = 1e-4 * number
        ends = [
            dx.simulate(torque=dx.kloss(**{**numbers, name: number + side * h}), rtol=1e-13, **call)
            for side in (1.0, -1.0)
        ]
        for key in ("theta", "omega"):
            slope = (ends[0][key][0] - ends[1][key][0]) / (2.0 * h)
            assert result[f"{key}_wrt_{name}"][0] == pytest.approx(slope, rel=2e-6)
    assert result.units["theta_wrt_breakdown_torque"] == "rad/N/m"


def test_standstills_of_a_pendulum():
    """theta'' = -(m g r/I) sin(theta), with r half the crank: the quarter period is K(sin(a/2))/w."""
    wrt = ["theta0", "g_Y", "m_crank", "I_crank", "AB"]
    result = dx.simulate(torque=0.0, t_end=2.0, theta0=math.pi - 2.5, wrt=wrt, **CRANK)
    given = {"theta0": math.pi - 2.5, **CRANK}

    def half(p, value):
        at = {**given, p: value}
        arm, amplitude = at["AB"] / 2, mpmath.pi - at["theta0"]
        inertia = at["I_crank"] + at["m_crank"] * arm**2
        speed = mpmath.sqrt(-at["m_crank"] * at["g_Y"] * arm / inertia)
        return 2 * mpmath.ellipk(mpmath.sin(amplitude / 2) ** 2) / speed

    stops = [event for event in result["events"] if event.kind == "standstill"]
    assert len(stops) >= 2
    for p in wrt:
        slope = float(mpmath.diff(lambda value, p=p: half(p, value), given[p]))
        for k, event in enumerate(stops):
            assert event.wrt[p] == pytest.approx((k + 1) * slope, rel=1e-8)


def test_the_work_of_a_constant_torque_is_that_of_the_angle():
    wrt = ["torque", "AB", "theta0", "m_slider"]
    result = dx.simulate(torque=0.25, t_end=1.0, theta0=0.3, wrt=wrt, **PRESS)
    turned = result["theta"][-1] - 0.3
    for p in wrt:
        own = turned if p == "torque" else -0.25 if p == "theta0" else 0.0
        expected = 0.25 * result[f"theta_wrt_{p}"][-1] + own
        assert result[f"work_wrt_{p}"] == pytest.approx(expected, rel=1e-8)
        assert result[f"t_last_wrt_{p}"] == 0.0
    result = dx.simulate(torque=0.25, t_end=5.0, theta0=0.3, until=4.0, wrt=wrt, **PRESS)
    expected = {"torque": 3.7, "AB": 0.0, "theta0": -0.25, "m_slider": 0.0}
    for p in wrt:
        assert result[f"work_wrt_{p}"] == pytest.approx(expected[p], abs=1e-8)
        assert result[f"t_last_wrt_{p}"] == result["events"][-1].wrt[p] != 0.0
        along = result[f"theta_wrt_{p}"][-1] + result["omega"][-1] * result[f"t_last_wrt_{p}"]
        assert along == pytest.approx(0.0, abs=1e-8)


# ---- against differences of tight integrations ------------------------------------------------------


def moved(call, given, p, steps, share):
    """The motion with a parameter moved by some steps."""
    step = share * max(abs(given[p]), 0.05)
    return dx.simulate(**call, **{**given, p: given[p] + steps * step}), step


def differences(call, given, p, share=H):
    """Central differences of order 4 by a parameter; None where the events are not those of all four."""
    runs = [moved(call, given, p, k, share) for k in (-2, -1, 1, 2)]
    kinds = [(run["status"], [(e.kind, e.which) for e in run["events"]], len(run["t"])) for run, _ in runs]
    if kinds.count(kinds[0]) < 4:
        return None
    (a, step), (b, _), (c, _), (d, _) = runs

    def slope(key):
        return (8.0 * (key(c) - key(b)) - (key(d) - key(a))) / (12.0 * step)

    result = {key: slope(lambda run, key=key: np.asarray(run[key])) for key in KEYS}
    return result | {"events": slope(lambda run: np.array([event.t for event in run["events"]]))}


def check(call, given, wrt, tolerance=1e-5, derivative=None):
    """Compare all sensitivities with differences; False where there are none."""
    call = {"rtol": 3e-14, "times": np.linspace(0.0, call["t_end"], 9), **call}
    extra = {} if derivative is None else {"derivative": derivative}
    result = dx.simulate(**{**call, "rtol": 1e-10}, wrt=wrt, **extra, **given)
    for p in wrt:
        expected = differences(call, given, p)
        if expected is None or len(expected["theta"]) != len(result["t"]):
            return False
        for key in KEYS:
            own, size = np.asarray(result[f"{key}_wrt_{p}"]), np.abs(expected[key]).max()
            least = np.abs(result[key]).max() / max(abs(given[p]), 0.05)
            np.testing.assert_allclose(
                own, expected[key], rtol=0, atol=tolerance * (size + 1e-2 * least), err_msg=f"{key} by {p}"
            )
        events = [e.wrt[p] for e in result["events"]]
        size = np.abs(expected["events"]).max(initial=0.0) + 1e-2 * call["t_end"] / max(abs(given[p]), 0.05)
        np.testing.assert_allclose(events, expected["events"], rtol=0, atol=tolerance * size, err_msg=p)
    return True


def drawn(rng):
    """A random design with its torque, loads and start: call, numbers, derivative of a function."""
    AB, ec = rng.uniform(0.05, 0.15), rng.uniform(-0.05, 0.05)
    BC = abs(ec) + AB * rng.uniform(1.3, 3.0)
    given = {
        "AB": AB, "BC": BC, "ec": ec, "m_crank": rng.uniform(0.2, 1.0), "m_rod": rng.uniform(0.2, 2.0),
        "m_slider": rng.uniform(0.5, 3.0), "I_crank": rng.uniform(1e-3, 1e-2),
        "I_rod": rng.uniform(1e-4, 1e-2), "g_X": rng.normal(), "g_Y": rng.normal(0, 5),
        "theta0": rng.uniform(-3, 3), "omega_start": rng.normal(0, 8),
        "mu": rng.choice([0.0, 0.0, rng.uniform(0.02, 0.2)]),
    }  # fmt: skip
    call, derivative = {"t_end": 0.35}, None
    angles, forces = np.sort(rng.uniform(0.0, 6.2, 4)), rng.normal(0, 20, 4)
    places = np.linspace(BC - AB, BC + 1.3 * AB, 4)
    load = rng.integers(6)
    if load == 0:
        given["F_Y"] = rng.normal(0, 10)
    elif load <= 2:
        call["F_Y"] = dx.over_theta(angles, forces, kind=("step", "linear")[load - 1])
    elif load == 3:
        call["F_Y"] = dx.over_Y(places[[0, 1, 1, 3]], forces, rng.normal(0, 20, 4))
    else:
        stroke = dx.events(ec=ec, AB=AB, BC=BC)["stroke"]
        distances = [0.0, 0.5 * stroke, 0.5 * stroke, 1.1 * stroke]
        call["F_Y"] = dx.over_stroke(
            distances, forces, rng.normal(0, 20, 4), dead_centre=("outer", "inner")[load - 4]
        )
    torque = rng.integers(5)
    if torque <= 1:
        given["torque"] = rng.normal(0, 1)
    elif torque == 2:
        call["torque"] = dx.over_theta(angles, rng.normal(0, 1, 4), kind="step")
    elif torque == 3:
        call["torque"] = dx.kloss(1.0, 0.2, rng.choice([-20.0, 20.0]))
    else:
        k, w = rng.normal(0, 0.02), rng.uniform(1, 5)
        call["torque"] = lambda t, theta, omega: math.cos(w * t) + math.sin(theta) + k * omega

        def derivative(t, theta, omega):
            return math.cos(theta), k, -w * math.sin(w * t)

    return call, given, derivative


JUMPS = {
    "over Y": (dx.over_Y([0.1, 0.25, 0.25, 0.4], [0.0, 20.0, -10.0, 0.0]), 0.0, ["AB"]),
    "over the stroke": (
        dx.over_stroke([0.0, 0.1, 0.1, 0.3], [0, 20, -10, 0], [0, 0, -10, 0], dead_centre="outer"),
        0.1, ["BC", "mu"],
    ),
}  # fmt: skip


@pytest.mark.parametrize("kind", JUMPS)
def test_jumps_of_loads_that_move_with_the_lengths(kind):
    load, mu, wrt = JUMPS[kind]
    given = {**PRESS, "torque": 0.25, "theta0": 0.3, "omega_start": 4.0, "mu": mu}
    assert check({"t_end": 0.4, "F_Y": load}, given, wrt, 3e-5)


@pytest.mark.sampled
def test_random_motions_with_events():
    """Two parameters of each; a motion whose events change within the step of differences is redrawn."""
    rng = np.random.default_rng(20)
    expected, done, tried = cases(3, 7, 1000), 0, 0
    while done < expected:
        tried += 1
        call, given, derivative = drawn(rng)
        wrt = sorted(rng.choice(sorted(p for p in given if given[p]), 2, replace=False).tolist())
        done += check(call, given, wrt, 3e-5, derivative)
        assert tried < 3 * expected + 10


# ---- where there is none, and who asks -----------------------------------------------------------------


@pytest.mark.parametrize(("omega_start", "mu"), [(9.0, 0.0), (-3.0, 0.0), (9.0, 0.07)])
def test_a_limit_angle_and_when_it_is_reached(omega_start, mu):
    """With friction two sets of forces balance the acceleration there; the motion has one of them."""
    given = {**ROCKER, "torque": 0.25, "theta0": 0.3, "omega_start": omega_start, "mu": mu}
    wrt = ["m_slider", "theta0"]
    result = dx.simulate(t_end=1.0, times=[0.0], wrt=wrt, **given)
    assert result["status"] == 2
    for p in wrt:
        expected = differences({"t_end": 1.0, "times": [0.0]}, given, p, 2e-3)
        assert result[f"t_last_wrt_{p}"] == result["events"][-1].wrt[p]
        assert result[f"t_last_wrt_{p}"] == pytest.approx(expected["t_last"], rel=1e-4)
        assert result[f"work_wrt_{p}"] == pytest.approx(expected["work"], rel=1e-4, abs=1e-5)


@pytest.mark.thorough
def test_random_machines_up_to_a_limit_angle():
    number = cases(60, 200, 1_000)
    designs, wrt = random_designs(number, 8), ["AB", "ec", "m_slider", "theta0", "torque"]
    call = {"t_end": 0.8, "times": [0.0]}
    limit = np.flatnonzero(dx.simulate(**call, **designs)["status"] == 2)
    assert limit.size >= 5
    for row in limit[: cases(5, 200, 1_000)]:
        one = {name: float(np.broadcast_to(v, number)[row]) for name, v in designs.items()}
        result = dx.simulate(**call, wrt=wrt, **one)
        for p in wrt:
            truth = differences(call, one, p)
            if truth is not None:
                for key in ("t_last", "work"):
                    assert result[f"{key}_wrt_{p}"] == pytest.approx(truth[key], rel=1e-5, abs=1e-5)


@pytest.mark.parametrize("start", [0.0, 1e-7, -1e-7])
def test_next_to_rest(start):
    """At rest and barely moving: the derivatives are one smooth function of the start."""
    wrt = ["AB", "m_slider", "theta0", "omega_start", "torque"]
    call = {"t_end": 0.5, "times": [0.1, 0.5], "wrt": wrt, "torque": 1.0, "theta0": 0.4}
    near, far = (dx.simulate(**call, omega_start=omega, **MACHINE) for omega in (start, 1e-4))
    for p in wrt:
        np.testing.assert_allclose(near[f"theta_wrt_{p}"], far[f"theta_wrt_{p}"], rtol=1e-3, atol=1e-3)


@pytest.mark.parametrize("kind", ["number", "over Y", "over the stroke", "over theta"])
def test_the_work_up_to_a_limit_angle_is_that_of_where_it_starts(kind):
    """A constant torque, and a load F(Y) or F(theta): what they do less when the crank starts later."""
    place = {n: ROCKER[n] for n in ("ec", "AB", "BC")} | {"theta": 0.3}
    Y, slope = (dx.evaluate(name, **place) for name in ("Y", "Y_wrt_theta"))
    outer = dx.evaluate("Y_outer", **{n: place[n] for n in ("ec", "AB", "BC")})
    loads = {
        "number": (4.0, 4.0),
        "over Y": (dx.over_Y([-1.0, 1.0], [0.0, 40.0]), 20.0 + 20.0 * Y),
        "over the stroke": (dx.over_stroke([0.0, 1.0], [0.0, 40.0], dead_centre="outer"), 40.0 * (outer - Y)),
        "over theta": (dx.over_theta([0.0, 3.0, 5.0], [5.0, 8.0, 1.0], kind="linear"), 5.3),
    }
    load, there = loads[kind]
    call = {"torque": 0.25, "t_end": 1.0, "theta0": 0.3, "omega_start": 9.0, "F_Y": load}
    result = dx.simulate(**call, wrt="theta0", **ROCKER)
    assert result["status"] == 2
    assert result["work_wrt_theta0"] == pytest.approx(-0.25 - there * slope, abs=1e-6)


def test_the_work_where_a_torque_jumps_just_before_a_limit_angle():
    """The last panel starts with the jump; the work is 0.25 (0.78 - theta0) + 3 (limit - 0.78)."""
    torque = dx.over_theta([-1.0, 0.78, 1.5], [0.25, 3.0, 0.25], kind="step")
    call = {"t_end": 1.0, "theta0": 0.3, "omega_start": 9.0, "wrt": ["AB", "theta0"], **ROCKER}
    result = dx.simulate(torque=torque, **call)
    assert result["status"] == 2
    limit = math.asin((ROCKER["BC"] - ROCKER["ec"]) / ROCKER["AB"])
    assert result["work_wrt_theta0"] == pytest.approx(-0.25, rel=1e-7)
    assert result["work_wrt_AB"] == pytest.approx(-3.0 * math.tan(limit) / ROCKER["AB"], rel=1e-7)


Y_PLACES, ANGLES = [0.029, 0.036, 0.093, 0.095, 0.125], [0.672, 1.516, 1.616, 2.342, 3.009]
UP_TO_A_LIMIT = {
    "a jump at the start of the last panel": {
        "AB": 0.113, "BC": 0.102, "m_crank": 0.154, "m_rod": 0.621, "m_slider": 2.211, "omega_start": 9.1,
        "g_X": 5.0, "F_Y": dx.over_Y(Y_PLACES, [-4.648, 11.68, 33.429, -36.163, -32.829], kind="step"),
        "F_X": dx.over_Y(Y_PLACES, [36.334, -10.53, 11.761, 3.478, -31.119], [-26.6, 25.4, 1.8, 14.3, -3.7]),
        "torque": dx.over_omega([-20.0, 0.0, 20.0], [1.0, 0.5, -1.0]),
    },
    "the guide changes sides": {
        "AB": 0.099, "BC": 0.096, "m_crank": 0.81, "m_rod": 1.74, "m_slider": 1.295, "omega_start": 7.5,
        "F_Y": 4.0, "torque": dx.over_theta(ANGLES, [-1.464, -0.683, -1.616, -0.537, -0.159], "linear"),
    },
}  # fmt: skip


@pytest.mark.thorough
@pytest.mark.parametrize("case", first(1, UP_TO_A_LIMIT.values()))
def test_the_work_of_friction_up_to_a_limit_angle_is_the_same_at_every_rtol(case):
    """Against central differences of two steps."""
    call = {"t_end": 2.0, "ec": 0.048, "g_Y": -9.81, **case}

    def difference(h):
        more, less = (dx.simulate(**call, mu=mu, rtol=1e-12)["work"] for mu in (0.2 + h, 0.2 - h))
        return (more - less) / (2.0 * h)

    right = (4.0 * difference(1e-3) - difference(2e-3)) / 3.0
    for rtol in (1e-8, 1e-9, 1e-10, 1e-12):
        result = dx.simulate(**call, mu=0.2, rtol=rtol, wrt="mu")
        assert result["status"] == 2
        assert result["work_wrt_mu"] == pytest.approx(right, rel=3e-6), rtol


def test_an_angle_that_is_only_touched_has_no_derivative():
    swing = {"torque": 0.0, "theta0": math.pi - 2.5, "rtol": 1e-12, **CRANK}
    free = dx.simulate(t_end=1.0, **swing)
    stop = next(event for event in free["events"] if event.kind == "standstill")
    result = dx.simulate(t_end=1.0, until=stop.theta - 1e-14, wrt=["g_Y", "torque"], **swing)
    last = result["events"][-1]
    assert last.kind == "angle"
    assert all(map(math.isnan, (*last.wrt.values(), result["t_last_wrt_g_Y"], result["work_wrt_torque"])))
    assert "sensitivities: NaN where an angle is only touched" in result["message"]
    assert np.isfinite(result["theta_wrt_g_Y"]).all()


def test_a_crank_that_friction_holds_has_none_of_its_speed():
    wrt = ["omega_start", "mu", "theta0"]
    call = {"torque": lambda omega: 0.0, "derivative": lambda omega: (0.0, 0.0), "wrt": wrt}
    result = dx.simulate(**call, t_end=2.0, omega_start=3.0, mu=0.3, F_X=-8.0, **PRESS)
    assert "at rest from" in result["message"]
    end, stop = result["events"][-1], result["theta"] == result["theta"][-1]
    assert end.kind == "standstill"
    for p in wrt:
        assert stop.sum() > 100
        assert np.ptp(result[f"theta_wrt_{p}"][stop]) == 0.0
        assert not result[f"omega_wrt_{p}"][stop].any()
        assert end.wrt[p] != 0.0


def test_a_motion_that_jams_has_those_up_to_there():
    jams = {"ec": 0.06, "AB": 0.04, "BC": 0.101, "m_slider": 1.0, "I_crank": 0.01, "F_Y": -50.0, "mu": 0.9}
    wrt = ["omega_start", "theta0", "AB"]
    result = dx.simulate(torque=3.0, t_end=1.0, theta0=1.0, omega_start=-3.0, times=[0.0], wrt=wrt, **jams)
    assert result["status"] == 3
    assert [result[f"omega_wrt_{p}"][0] for p in wrt] == [1.0, 0.0, 0.0]
    assert [result[f"theta_wrt_{p}"][0] for p in wrt] == [0.0, 1.0, 0.0]
    assert math.isnan(result["t_last_wrt_AB"])
    assert "NaN of friction jams" in result["message"]


def test_a_break_away_comes_when_the_torque_is_enough():
    given = {"mu": 0.3, "F_X": -40.0, "theta0": 1.0, "AB": 0.14, "omega_start": 0.0}
    rest = {n: value for n, value in PRESS.items() if n not in given}
    wrt = ["mu", "F_X", "theta0", "AB"]
    call = {"torque": lambda t, theta, omega: 4.0 * math.sin(5.0 * t), "t_end": 0.2, **rest}

    def slopes(t, theta, omega):
        return 0.0, 0.0, 20.0 * math.cos(5.0 * t)

    result = dx.simulate(**call, **given, wrt=wrt, derivative=slopes)
    assert result["events"][0].kind == "break-away"
    held = {**given, **rest, "theta": 1.0, "omega": 1e-30, "alpha": 0.0}
    del held["theta0"], held["omega_start"]
    for p in wrt:
        by = dx.evaluate(f"T_in_wrt_{'theta' if p == 'theta0' else p}", **held)
        rate = 20.0 * math.cos(5.0 * result["events"][0].t)
        assert result["events"][0].wrt[p] == pytest.approx(by / rate, rel=1e-6)
    assert check(call, given, wrt, 3e-5, slopes)
    two = dx.simulate(**call, **given, wrt=wrt, derivative=lambda t, theta, omega: (0.0, 0.0))
    assert all(map(math.isnan, two["events"][0].wrt.values()))
    assert "returns dT/dt, too" in two["message"]
    np.testing.assert_array_equal(two["theta_wrt_mu"], result["theta_wrt_mu"])


def test_an_array_of_designs_has_those_of_each():
    wrt, masses = ["m_slider", "torque", "omega_start"], np.array([[1.0, 2.0], [3.0, -1.0]])
    call = {"torque": 0.25, "t_end": 0.3, "times": [0.1, 0.3], "omega_start": 2.0, "wrt": wrt}
    result = dx.simulate(**call, **{**PRESS, "m_slider": masses})
    for at in ((0, 0), (0, 1), (1, 0)):
        one = dx.simulate(**call, **{**PRESS, "m_slider": masses[at]})
        for p in wrt:
            for key in (f"theta_wrt_{p}", f"omega_wrt_{p}", f"t_last_wrt_{p}", f"work_wrt_{p}"):
                np.testing.assert_allclose(result[key][at], one[key], rtol=1e-8, atol=1e-12)
    assert result["theta_wrt_torque"].shape == (2, 2, 2)
    assert np.isnan(result["work_wrt_torque"][1, 1])
    assert result["status"][1, 1] == 6


def test_a_machine_tells_them_in_its_units():
    si = {"ec": 0.01, "AB": 0.05, "BC": 0.12, "m_slider": 2.0, "I_crank": 0.01}
    machine = dx.Machine(si, units="m, kg").replace(units="mm, deg, rpm")
    wrt = ["AB", "theta0", "omega_start", "torque"]
    ours = machine.simulate(torque=1.5, t_end=0.3, wrt=wrt)
    plain = dx.simulate(torque=1.5, t_end=0.3, wrt=wrt, **si)
    degree, rpm = math.degrees(1.0), 30.0 / math.pi
    shown = {"AB": 1000.0, "theta0": degree, "omega_start": rpm, "torque": 1.0}
    for p, unit in shown.items():
        for key, own in {"theta": degree, "omega": rpm, "t_last": 1.0, "work": 1.0}.items():
            expected = np.asarray(plain[f"{key}_wrt_{p}"]) * own / unit
            np.testing.assert_allclose(ours[f"{key}_wrt_{p}"], expected, rtol=1e-12)
        assert ours["events"][0].wrt[p] == pytest.approx(plain["events"][0].wrt[p] / unit, rel=1e-12)


WRONG = {
    "no parameter 'm_slidr'; did you mean m_slider": {"wrt": "m_slidr"},
    "torque = <function": {"wrt": "torque", "torque": lambda t, theta, omega: 1.0},
    "F_Y = <load": {"wrt": "F_Y", "F_Y": dx.over_theta([0.0, 1.0], [0.0, 1.0])},
    "F_Y = <function": {"wrt": "AB", "F_Y": lambda theta: 1.0},
    "give derivative=": {"wrt": "AB", "torque": lambda theta: 1.0},
    "it is for a torque that is a function": {"wrt": "AB", "derivative": lambda omega: (0.0, 0.0)},
    "expected two numbers": {
        "wrt": "AB", "torque": lambda omega: 1.0 - omega, "derivative": lambda omega: -1.0,
    },
    "they must be finite": {
        "wrt": "AB", "torque": lambda omega: 1.0 - omega, "derivative": lambda omega: (0.0, math.inf),
    },
}  # fmt: skip


@pytest.mark.parametrize("words", WRONG)
def test_what_has_no_derivative_is_refused_by_name(words):
    error = ValueError if words.startswith(("no parameter", "torque =", "F_Y = <load", "they")) else TypeError
    with pytest.raises(error, match=words):
        dx.simulate(**{"torque": 1.0, "t_end": 0.1, **PRESS, **WRONG[words]})


def test_the_effort_of_derivatives_grows_with_the_panels_not_their_square(monkeypatch):
    """Each knot of a table cuts a panel; the stretches between them are counted a few times in all."""
    counted = []
    for name in ("stretches", "rests"):
        get = getattr(Record, name).fget
        counting = property(lambda self, get=get: counted.append(1) or get(self))
        monkeypatch.setattr(Record, name, counting)
    angles = np.arange(120) * (2.0 * math.pi / 120)
    force = dx.over_theta(angles.tolist(), (-300.0 - 200.0 * np.cos(angles)).tolist())
    dx.simulate(torque=30.0, omega_start=20.0, t_end=0.3, wrt="AB", **{**LOADED, "F_Y": force})
    assert len(counted) < 16
