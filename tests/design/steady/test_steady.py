"""`steady` against Newton's law of the free bodies, over random machines, motors and loads."""

import re
from math import exp, pi, sqrt

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import desaxe as dx
from desaxe.loads.angles import meeting_angles
from tests.design.steady.free_bodies import FreeBodies, turn
from tests.effort import cases, first

PRESS = {"ec": 0.01, "AB": 0.05, "BC": 0.2, "m_slider": 20.0, "I_crank": 2.0, "F_Y": -900.0}
MOTOR = dx.kloss(40.0, 0.15, 157.08, gear=12)
KEYS = ("period", "omega_mean", "fluctuation", "power_mean")
NARROW = 307  # its motion is between two starts of the scan, the lower one of which Newton's method leaves


def machine(rng):
    """Inputs, some of which are 0."""
    AB = rng.uniform(0.03, 0.1)
    BC = AB * rng.uniform(2.2, 5.0)
    some = rng.integers(0, 2, 5)
    result = {
        "ec": rng.uniform(-0.4, 0.4) * (BC - AB) * some[0], "AB": AB, "BC": BC,
        "m_crank": rng.uniform(0, 5), "m_rod": rng.uniform(0.1, 3), "m_slider": rng.uniform(0.5, 10),
        "I_crank": rng.uniform(0.01, 1), "I_rod": rng.uniform(0, 0.02), "g_Y": -9.81 * some[1],
        "g_X": rng.uniform(-9, 9) * some[2], "F_X": rng.uniform(-100, 100) * some[3],
        "F_Y": rng.uniform(-100, 100), "r_rod": rng.uniform(0, 1) * BC, "r_crank": rng.uniform(-1, 1) * AB,
    }  # fmt: skip
    return result | ({"mu": rng.uniform(0.01, 0.3)} if some[4] else {})


def with_load(rng, inputs, branch):
    """A load over position, stroke or two turns, as desaxe and as the free bodies take it."""
    kind = rng.integers(0, 4)
    raw = dict(inputs)
    if kind == 0:
        return inputs, raw
    if kind == 3:
        angles = np.sort(rng.uniform(0.1, 4 * pi - 0.1, 5))
        values = rng.uniform(-300, 300, 5)
        inputs = {**inputs, "F_Y": dx.over_theta(angles, values, "linear", period=4 * pi)}
        raw["F_Y"] = lambda theta, Y, way: np.interp(theta % (4 * pi), angles, values, period=4 * pi)
        return inputs, raw
    lengths = {n: inputs[n] for n in ("ec", "AB", "BC")}
    centres = dx.evaluate(["Y_outer", "Y_inner"], branch=branch, **lengths)
    low, high = sorted(centres.values())
    x = np.sort(rng.uniform(low, high, 4))
    out, back = rng.uniform(-500, 500, (2, 4))
    if kind == 1:
        inputs = {**inputs, "F_Y": dx.over_Y(x, out, back)}
        raw["F_Y"] = lambda theta, Y, way: np.interp(Y, x, out if way >= 0 else back)
    else:
        d = x - low
        inputs = {**inputs, "F_Y": dx.over_stroke(d, out, back, dead_centre="outer")}
        centre = centres["Y_outer"]
        raw["F_Y"] = lambda theta, Y, way: np.interp(abs(centre - Y), d, out if way >= 0 else back)
    return inputs, raw


def motor(rng, way):
    """A motor, and its torque as a function of (theta, omega)."""
    size, top = rng.uniform(40, 150), rng.uniform(5, 60)
    kind = rng.integers(0, 4)
    if kind == 0:
        gear = rng.uniform(1, 10)
        result = dx.kloss(size / gear, rng.uniform(0.1, 0.5), way * top * gear, gear)
        return result, lambda theta, omega: result(omega)
    if kind == 1:
        speeds = way * np.linspace(0, top, 5)[:: int(way)]
        torques = (way * np.array([1.2, 1.4, 1.6, 1.0, 0.0]) * size * rng.uniform(0.8, 1.2, 5))[:: int(way)]
        result = dx.over_omega(speeds, torques, kind=rng.choice(["linear", "smooth"]))
        return result, lambda theta, omega: result(omega)
    if kind == 2:
        return (lambda omega: way * size * (1.2 - abs(omega) / top)), (
            lambda theta, omega: way * size * (1.2 - abs(omega) / top)
        )

    def torque(theta, omega):
        return way * size * (1.2 + 0.3 * np.sin(2 * theta) - (omega / top) ** 2)

    return torque, torque


def drawn(seed):
    """A random machine on its motor: the call, and the free bodies with the motor's torque."""
    rng = np.random.default_rng(seed)
    branch, way = int(rng.choice([1, -1])), float(rng.choice([1, -1]))
    inputs, raw = with_load(rng, machine(rng), branch)
    torque, plain = motor(rng, way)
    J = 10 ** rng.uniform(-1.5, 1.5)
    call = {**inputs, "torque": torque, "flywheel_inertia": J, "branch": branch, "omega0": way}
    return call, FreeBodies(branch, way, **raw, J=J), plain


def edges_of(call, result):
    """Even edges and the kinks of the load over the period, in the way of turning."""
    way, period = np.sign(result["theta"][-1]), abs(result["theta"][-1])
    loads = [call["F_Y"]] if callable(call["F_Y"]) else []
    lengths = [np.array([call[n]]) for n in ("ec", "AB", "BC")]
    kinks = meeting_angles(loads, period, lengths, call["branch"])
    kinks = kinks[np.isfinite(kinks)] - (0.0 if way > 0 else period)
    every = np.unique([*turn(round(period / (2 * pi)), way), *kinks])
    return every[np.append(True, np.diff(every) > 1e-12)][:: int(way)]


def motions(result):
    return [one for one in (result, *result["others"]) if one["status"] == 0]


@pytest.mark.thorough
@pytest.mark.sampled
def test_a_period_later_the_free_bodies_are_where_they_were():
    seen = 0
    for seed in (*range(cases(4, 14, 300)), NARROW):
        call, bodies, torque = drawn(seed)
        result = dx.steady(**call)
        assert result["status"] == 0 or seed != NARROW
        for one in motions(result):
            places = np.array([17, 100, 222, 333])
            theta, omega = one["theta"][places], one["omega"][places]
            square, period, work, there = bodies.period(
                torque, one["omega"][0], edges_of(call, one), at=theta
            )
            grown = 1e-9 * max(1.0, one["multiplier"])
            assert square == pytest.approx(one["omega"][0] ** 2, rel=grown), seed
            assert period == pytest.approx(one["period"], rel=grown), seed
            assert work == pytest.approx(one["work"], rel=grown, abs=grown * 2 * pi * 40), seed
            np.testing.assert_allclose(there, omega, rtol=grown, err_msg=str(seed))
            np.testing.assert_allclose(
                one["T_motor"][places], np.vectorize(torque)(theta, omega), rtol=1e-11, err_msg=str(seed)
            )
            assert one["omega_mean"] == pytest.approx(one["theta"][-1] / period, rel=grown)
            assert one["power_mean"] == pytest.approx(one["work"] / one["period"], rel=1e-12)
            seen += 1
    assert seen >= 2


STEPS, WEIGHTS = np.array([-3, -2, -1, 1, 2, 3]), np.array([-1 / 60, 0.15, -0.75, 0.75, -0.15, 1 / 60])


@pytest.mark.sampled
def test_gradients_are_those_of_the_values():
    """Central differences of order 6, of designs in one array."""
    seen = 0
    for seed in range(100, 100 + cases(2, 5)):
        call, *_ = drawn(seed)
        found = dx.steady(**call)
        if found["status"] or found["multiplier"] > 0.99:
            continue
        by_period = found["gradient"]["period"]
        own = getattr(call["torque"], "numbers", {})
        numbers = {n: v for n, v in call.items() if n in by_period and not callable(v) and v} | dict(own)
        for name in np.random.default_rng(seed).permutation(list(numbers))[:2]:
            at = numbers[name]
            h = 3e-4 * (call["AB"] if name == "ec" else abs(at))
            moved = {name: at + h * STEPS}
            torque = dx.kloss(**{**own, **moved}) if name in own else call["torque"]
            result = dx.steady(**{**call, **({} if name in own else moved), "torque": torque})
            for key in KEYS:
                exact = found["gradient"][key][name]
                slope = WEIGHTS @ result[key] / h
                power = found["omega_mean"] * np.abs(found["T_motor"]).max()
                size = power if key == "power_mean" else found[key]
                scale = abs(exact) + 1e-2 * abs(size / at)
                assert abs(slope - exact) < 2e-7 * scale, (seed, name, key)
            seen += 1
    assert seen


def bare(net):
    """A wheel alone on a motor with this torque of omega: the mechanism has no mass."""
    return dx.steady(torque=net, ec=0.0, AB=0.05, BC=0.2, I_crank=0.7, flywheel_inertia=0.3)


@pytest.mark.parametrize("load", [3.0, 39.9])
def test_the_stable_speed_of_an_induction_motor_and_its_multiplier(load):
    motor = dx.kloss(40.0, 0.2, 30.0)
    result = bare(lambda omega: motor(omega) - load)
    ratio = 40.0 / load
    slip = 0.2 * (ratio - sqrt(ratio**2 - 1))
    speed = 30.0 * (1 - slip)
    assert result["omega_mean"] == pytest.approx(speed, rel=1e-11 if load < 39.9 else 1e-9)
    assert result["stable"]
    steep = -2 * 40 * 0.2 * (0.04 - slip * slip) / (0.04 + slip * slip) ** 2 / 30.0
    assert result["multiplier"] == pytest.approx(exp(2 * pi * steep / speed), rel=1e-9)
    assert not result["others"]


def test_other_stable_speeds_are_listed_and_unstable_ones_are_not():
    result = bare(lambda omega: -0.01 * (omega - 10.0) * (omega - 20.0) * (omega - 30.0))
    (other,) = result["others"]
    for one, speed, steep in ((result, 30.0, -2.0), (other, 10.0, -2.0)):
        assert one["omega_mean"] == pytest.approx(speed, rel=1e-10)
        assert one["multiplier"] == pytest.approx(exp(2 * pi * steep / speed), rel=1e-8)
        assert one["stable"]


def test_arrays_are_the_designs_one_by_one():
    lengths = np.linspace(0.04, 0.06, 5)
    most = np.array([[2.0], [30.0]])
    many = dx.steady(torque=dx.kloss(most, 0.15, 157.08, gear=12), mu=0.05, **{**PRESS, "AB": lengths})
    assert many["status"].shape == (2, 5)
    assert many["omega"].shape == many["theta"].shape == (2, 5, 361)
    for i, j in np.ndindex(2, 5):
        motor = dx.kloss(most[i, 0], 0.15, 157.08, gear=12)
        one = dx.steady(torque=motor, mu=0.05, **{**PRESS, "AB": lengths[j]})
        assert many["status"][i, j] == one["status"]
        assert many["message"][i, j] == one["message"]
        assert len(many["others"][i, j]) == len(one["others"])
        for key in (*KEYS, "work", "multiplier", "omega"):
            np.testing.assert_allclose(many[key][i, j], one[key], rtol=1e-10)
        for key, by in one["gradient"].items():
            for name, slope in by.items():
                scale = abs(one[key]) * 1e-9 / max(1e-3, abs(PRESS.get(name, 1.0)))
                assert many["gradient"][key][name][i, j] == pytest.approx(slope, rel=1e-7, abs=scale)


def test_the_way_of_turning_may_be_an_array():
    """A torque that has no way of its own, over a plane of designs: each turns as its speed says."""
    call = {"torque": lambda omega: 60.0 * np.sign(omega) - 2.0 * omega, **PRESS, "I_crank": [2.0, 3.0]}
    result = dx.steady(omega0=[[1.0], [-1.0]], **call)
    assert np.sign(result["omega_mean"]).tolist() == [[1.0, 1.0], [-1.0, -1.0]]
    assert result["omega_mean"][1, 0] == pytest.approx(
        dx.steady(omega0=-1.0, **{**call, "I_crank": 2.0})["omega_mean"]
    )


def test_bad_designs_of_an_array_leave_the_others_alone():
    result = dx.steady(torque=MOTOR, **{**PRESS, "AB": [0.05, np.nan, 0.3]})
    assert result["status"].tolist() == [0, 4, 1]
    assert np.isnan(result["period"]).tolist() == [False, True, True]
    assert "cannot turn" in result["message"][2]


AGAINST = {**PRESS, "F_Y": dx.over_Y([0.15, 0.25], [-200, -200], [0, 0])}  # 3.2 N m in the mean
# A force against the stroke inward is positive; with the wrong sign it gives 240 J on its 40 mm.
DRIVING = dx.over_stroke([0.0, 0.03, 0.04], [0, 0, 0], [-8e3, -6e3, 0], dead_centre="inner")
DRIVEN = {**PRESS, "F_Y": DRIVING, "mu": 0.05}
EDGE, *_ = drawn(56)  # no friction, and a table that ends without torque
TOLD = "; the loads themselves drive the crank, 240 J a period: check their signs$"


@pytest.mark.parametrize(
    ("torque", "inputs", "said"),
    [
        (dx.kloss(0.1, 0.15, 157.08, gear=12), AGAINST, "too weak, it stalls near theta"),
        (lambda omega: 50.0 + omega, AGAINST, "too strong, it runs away"),
        (30.0, AGAINST, "too strong, it runs away: a torque that does not depend on the speed must balance"),
        (-30.0, AGAINST, "too weak"),
        (0.0, PRESS, "balances the loads at every speed"),
        # Beyond its last speed this motor has no torque, nor has the load a mean.
        (dx.over_omega([0.0, 5.0, 14.0], [300.0, 400.0, 0.0]), PRESS, "balances the loads"),
        (dx.over_omega([0.0, 5.0], [300.0, 400.0]), {**PRESS, "fluctuation": 0.01}, "too strong"),
        # The same, where the slowest motion without torque is an edge: energy comes back from below alone.
        (EDGE.pop("torque"), EDGE, "balances the loads"),
        (MOTOR, {"ec": 0.0, "AB": 0.05, "BC": 0.2, "m_slider": 1.0}, "inertia vanishes"),
        (dx.kloss(2.0, 0.2, 157.08, gear=15), DRIVEN, TOLD),
        (dx.kloss(2.0, 0.2, -157.08, gear=15), DRIVEN, TOLD),
    ],
)
def test_without_a_steady_state_the_message_says_why(torque, inputs, said):
    result = dx.steady(torque=torque, **inputs)
    assert result["status"] == 1
    assert re.search(said, result["message"])
    assert np.isnan([result[key] for key in KEYS]).all()
    assert np.isnan(result["omega"]).all()
    assert np.isnan(result["flywheel_inertia"]) == ("fluctuation" in inputs)


@pytest.mark.thorough
def test_an_unstable_motion_alone_is_no_steady_state():
    result = dx.steady(torque=lambda omega: 10.0 * (omega - 20.0), flywheel_inertia=5.0, **PRESS)
    assert result["status"] == 1
    assert result["message"] == "no steady state: below some 20 rad/s it slows down, above it runs away"
    assert not result["others"]


def test_a_number_finds_a_speed_where_friction_grows_with_it():
    inputs = {"ec": 0.01, "AB": 0.05, "BC": 0.2, "m_slider": 20.0, "I_crank": 2.0, "mu": 0.2}
    result = dx.steady(torque=5.0, **inputs)
    assert result["status"] == 0
    assert result["work"] == pytest.approx(10.0 * pi, rel=1e-12)
    mean = dx.drive(omega0=result["omega_mean"], fluctuation=1.0, **inputs)["torque_mean"]
    assert mean == pytest.approx(5.0, rel=0.05)


def test_the_flywheel_for_a_wanted_fluctuation():
    at = 0.01
    result = dx.steady(torque=MOTOR, fluctuation=at, **PRESS)
    assert result["fluctuation"] == pytest.approx(at, rel=1e-12)
    again = dx.steady(torque=MOTOR, flywheel_inertia=result["flywheel_inertia"], **PRESS)
    assert again["period"] == pytest.approx(result["period"], rel=1e-12)
    by = result["gradient"]["flywheel_inertia"]
    h = 1e-3 * at
    near = dx.steady(torque=MOTOR, fluctuation=at + h * STEPS, **PRESS)["flywheel_inertia"]
    assert by["fluctuation"] == pytest.approx(WEIGHTS @ near / h, rel=1e-7)
    press = {**PRESS, "m_slider": 20.0 + 0.02 * STEPS}
    near = dx.steady(torque=MOTOR, fluctuation=at, **press)["flywheel_inertia"]
    assert by["m_slider"] == pytest.approx(WEIGHTS @ near / 0.02, rel=1e-6)


def test_a_machine_that_stores_enough_needs_no_flywheel():
    result = dx.steady(torque=MOTOR, fluctuation=0.5, **PRESS)
    assert result["flywheel_inertia"] == 0.0
    assert result["fluctuation"] < 0.5


def test_a_crank_without_inertia_needs_some_flywheel():
    """M_eff vanishes at the dead centres; with next to no flywheel the speed is even."""
    light = {"AB": 0.05, "BC": 0.2, "ec": 0.01, "m_slider": 4.0, "F_Y": -500.0}
    result = dx.steady(torque=MOTOR, fluctuation=0.02, **light)
    assert result["status"] == 0
    assert 0.0 < result["flywheel_inertia"] < 0.1
    again = dx.steady(torque=MOTOR, flywheel_inertia=result["flywheel_inertia"], **light)
    assert again["fluctuation"] == pytest.approx(result["fluctuation"], rel=1e-9)
    assert again["fluctuation"] <= 0.02


def test_motors_of_a_machine_are_in_its_units():
    press = dx.Machine(units="mm, rpm", ec=10, AB=50, BC=200, m_slider=20.0, I_crank=2.0)
    result = press.steady(torque=press.kloss(40.0, 0.15, 1500, gear=12), flywheel_inertia=3.0)
    plain = dx.steady(torque=dx.kloss("40 N m", 0.15, "1500 rpm", 12), flywheel_inertia=3.0, **press)
    assert result["omega_mean"] == pytest.approx(plain["omega_mean"] * 30 / pi, rel=1e-12)
    by, own = (one["gradient"]["omega_mean"]["AB"] for one in (result, plain))
    assert by == pytest.approx(own * 30 / pi / 1000, rel=1e-9)
    table = press.over_omega([0, 100, 200], [30, 40, 0], "smooth")
    assert table(100) == pytest.approx(40.0, rel=1e-12)
    with pytest.raises(ValueError, match=r"machine\.kloss"):
        press.steady(torque=dx.kloss(40.0, 0.15, 157.08, 12))


def test_designs_of_a_machine_are_in_its_units():
    pump = dx.Machine(units="mm, rpm", ec=10, AB=50, BC=200, m_slider=2, I_crank=3)
    load = pump.over_stroke([0, 100], [-1200, -1200], [1200, 1200], dead_centre="outer")
    call = {"torque": pump.kloss(5, 0.1, 1500, gear=12), "F_Y": load}
    many = pump.steady(flywheel_inertia=[2, 4], **call)
    plain = dx.steady(**{**pump, **call}, flywheel_inertia=[2, 4])
    np.testing.assert_allclose(many["omega_mean"], plain["omega_mean"] * 30 / pi, rtol=1e-12)
    for k in range(2):
        one = pump.steady(flywheel_inertia=[2, 4][k], **call)
        assert many["omega_mean"][k] == pytest.approx(one["omega_mean"], rel=1e-9)
        assert many["message"][k] == one["message"] == "ok"


SLENDER = {"ec": 0.0, "AB": 0.0934, "BC": 0.5423, "m_rod": 5.9, "m_slider": 27.6, "g_Y": -9.81}
LIGHT = {"ec": 0.015, "AB": 0.06, "BC": 0.3, "m_slider": 120.0, "m_rod": 40.0}  # no I_crank
NEARLY = {"ec": -0.0543, "AB": 0.0658, "BC": 0.32, "m_rod": 0.69, "m_slider": 42.9}


def punched(press, depth, first, last):
    """A press whose load over the end of its stroke goes from `first` to `last`, also for the free bodies."""
    outer = sqrt((press["AB"] + press["BC"]) ** 2 - press["ec"] ** 2)

    def force(theta, Y, way):
        d = outer - Y
        return first + (last - first) * d / depth if d < depth and way > 0.0 else 0.0

    load = dx.over_stroke([0.0, depth, depth], [first, last, 0.0], [0.0] * 3, dead_centre="outer")
    return {**press, "F_Y": load}, {**press, "F_Y": force}


def same(press):
    return press, press


@pytest.mark.parametrize(
    ("machine", "motor", "settles"),
    first(
        2,
        [
            (
                punched({**SLENDER, "I_crank": 0.039}, 0.013, -322.0, -193.0),
                (65.0, 0.218, 104.7, 5.766),
                True,
            ),
            (
                punched({**SLENDER, "I_crank": 0.039, "mu": 0.08}, 0.013, -322.0, -193.0),
                (65, 0.218, 104.7, 5.766),
                True,
            ),
            (same(LIGHT), (40.0, 0.15, 50 * pi, 25.0), True),
            (same(LIGHT), (400.0, 0.15, 50 * pi, 25.0), True),
            (punched(LIGHT, 0.008, -5e3, -5e3), (100.0, 0.15, 50 * pi, 25.0), True),
            # Next to a stall the crank all but stands four times a turn.
            (punched(NEARLY, 0.0165, -7950.0, -7950.0), (108.0, 0.261, 162.9, 5.0), True),
            (punched(LIGHT, 0.008, -80e3, -80e3), (100.0, 0.15, 50 * pi, 25.0), False),
            (punched({**LIGHT, "I_crank": 0.1}, 0.008, -80e3, -80e3), (100.0, 0.15, 50 * pi, 25.0), False),
            (punched({**LIGHT, "I_crank": 1.0}, 0.008, -80e3, -80e3), (100.0, 0.15, 50 * pi, 25.0), True),
        ],
    ),
)
def test_a_light_crank_settles_or_stalls_as_its_free_bodies_do(machine, motor, settles):
    """By SciPy's Radau from the motor's speed: a stiff turn forgets where it starts."""
    call, raw = machine
    result = dx.steady(torque=dx.kloss(*motor), **call)
    bodies, (most, slip, top, gear) = FreeBodies(**raw), motor

    def rate(t, y):
        u = (1.0 - gear * y[1] / top) / slip
        return [y[1], bodies.alpha(y[0], y[1] ** 2, 2.0 * gear * most * u / (1.0 + u * u))]

    def stalls(t, y):
        return y[1] - 1e-5 * top

    def turns(t, y):
        return y[0] - 2 * pi

    stalls.terminal = turns.terminal = True
    speed, times, turn_time = top / gear, [], 2 * pi * gear / top
    for _ in range(2):
        how = {"method": "Radau", "rtol": 1e-8, "atol": 1e-10, "max_step": turn_time / 100}
        run = solve_ivp(rate, (0.0, 50 * turn_time), [0.0, speed], events=[stalls, turns], **how)
        speed = run.y[1, -1]
        times.append(run.t[-1])
        if run.t_events[0].size:
            break
    assert (len(run.t_events[0]) == 0) == settles
    assert result["status"] == (0 if settles else 1), result["message"]
    if settles:
        assert result["period"] == pytest.approx(times[-1], rel=2e-6)
    else:
        assert "too weak, it stalls near theta" in result["message"]


def test_simulate_takes_motors_of_arrays():
    motor = dx.kloss([30.0, 40.0], 0.15, 157.08, gear=[[12.0], [9.0]])
    call = {"t_end": 0.3, **PRESS, "I_crank": [2.0, 3.0]}
    many = dx.simulate(torque=motor, **call)
    assert many["omega"].shape[:2] == (2, 2)
    for row, gear in enumerate((12.0, 9.0)):
        for column, (most, inertia) in enumerate(((30.0, 2.0), (40.0, 3.0))):
            alone = dx.simulate(
                torque=dx.kloss(most, 0.15, 157.08, gear), **{**call, "I_crank": inertia}, times=many["t"]
            )
            np.testing.assert_allclose(many["omega"][row, column], alone["omega"], rtol=1e-10)


@pytest.mark.parametrize("units", ["m, deg, rpm", ""])
def test_a_torque_over_theta_of_a_machine_is_that_in_si(units):
    press = dx.Machine(units=units, ec=0.0, AB=0.05, BC=0.2, m_slider=2.0, I_crank=0.5, mu=0.1)
    turn = 360.0 if units else 2 * pi
    made = press.over_theta(np.linspace(0, turn, 13)[:-1], 8.0 + np.sin(np.linspace(0, 2 * pi, 13)[:-1]))
    plain = dx.over_theta(np.linspace(0, 2 * pi, 13)[:-1], 8.0 + np.sin(np.linspace(0, 2 * pi, 13)[:-1]))
    right = dx.steady(torque=plain, ec=0.0, AB=0.05, BC=0.2, m_slider=2.0, I_crank=0.5, mu=0.1)["omega_mean"]
    result = press.steady(torque=made)["omega_mean"] * (pi / 30 if units else 1.0)
    assert result == pytest.approx(right, rel=1e-12)


@pytest.mark.parametrize("name", ["F_Y", "torque"])
def test_a_function_knows_its_period(name):
    """A load of a four-stroke engine as a function is that as a table, and a turn is not its period."""
    size = 300.0 if name == "F_Y" else 100.0

    def function(theta):
        return size * (1.0 + np.cos(0.5 * theta) ** 3)

    angles = np.linspace(0.0, 4 * pi, 97)[:-1]
    call = {"torque": MOTOR, **PRESS, "mu": 0.1}
    loads = [dx.over_theta(function, period=4 * pi), dx.over_theta(angles, function(angles), period=4 * pi)]
    exact, table = (dx.steady(**{**call, name: load}) for load in loads)
    assert exact["theta"][-1] == pytest.approx(4 * pi)
    for key in KEYS:
        assert exact[key] == pytest.approx(table[key], rel=1e-4)
    with pytest.raises(ValueError, match=f"{name}: steady is over at most 4 turns"):
        dx.steady(**{**call, name: dx.over_theta(function)})


HALF_WAY = ([0.0, 0.06, 0.06, 0.1], [0.0, 0.0, -9e3, -9e3], [0.0] * 4)


@pytest.mark.thorough
@pytest.mark.parametrize(
    "load",
    [
        {"F_Y": dx.over_stroke(*HALF_WAY, dead_centre="outer")},
        {"F_Y": dx.over_stroke(HALF_WAY[0], [0.0] * 4, [0, 0, 9e3, 9e3], dead_centre="inner"), "mu": 0.1},
        {"F_Y": dx.over_Y([0.1, 0.19, 0.19, 0.3], [-9e3, -9e3, 0, 0], [0.0] * 4)},
    ],
)
def test_an_extreme_of_the_speed_at_a_jump_of_the_load_moves_with_it(load):
    """Central differences of order 6: the load jumps at the slowest or at the fastest point."""
    press = {**PRESS, "flywheel_inertia": 3.0, "m_rod": 3.0, **load}
    result = dx.steady(torque=MOTOR, **press)
    for name in ("ec", "AB", "BC", "m_rod"):
        h = 1e-3 * press[name] if name != "ec" else 5e-5
        near = dx.steady(torque=MOTOR, **{**press, name: press[name] + h * STEPS})["fluctuation"]
        slope = result["gradient"]["fluctuation"][name]
        assert slope == pytest.approx(WEIGHTS @ near / h, rel=1e-6, abs=1e-9), name
