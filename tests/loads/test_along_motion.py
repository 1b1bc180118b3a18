"""Functions, springs, dampers and sums of loads: arguments by their names, units, derivatives by numbers."""

import itertools
from functools import partial

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import desaxe as dx
from tests.effort import first
from tests.loads.truth import slider

LENGTHS = {"ec": 0.01, "AB": 0.04, "BC": 0.13}
DESIGN = {**LENGTHS, "m_slider": 2.0, "I_crank": 0.05}
TURNING = {**LENGTHS, "m_slider": 2.0, "omega0": 30.0}
MOTOR = dx.over_omega([0.0, 300.0], [120.0, -330.0])
NUMBERS = {"stiffness": 4000.0, "free": 0.12, "linear": 200.0, "quadratic": 3.0}


def force(theta, omega, Y, V):
    return -2000.0 * (Y - 0.1) - 60.0 * V + 5.0 * np.sin(theta) - 0.1 * omega


def by_keyword(*, V_C, theta, omega, Y, k=1.0):
    return k * force(theta, omega, Y, V_C)


FUNCTIONS = {
    "in another order": lambda V_C, Y, omega, theta: force(theta, omega, Y, V_C),
    "by keyword": by_keyword,
    "partial": partial(lambda k, omega, theta, Y, V_C: k * force(theta, omega, Y, V_C), 1.0),
    "of numbers alone": lambda Y, V_C, theta, omega: float(force(theta, omega, Y, V_C)),
    "from the dead centre": lambda s, V_C, theta, omega: force(theta, omega, REACH - s, V_C),
}
REACH = float(np.sqrt((LENGTHS["AB"] + LENGTHS["BC"]) ** 2 - LENGTHS["ec"] ** 2))


def torque(theta):
    """Newton's law of the slider, and virtual work."""
    Y, slope, bend = slider(theta, LENGTHS, 1)
    return (2.0 * 30.0**2 * bend - force(theta, 30.0, Y, 30.0 * slope)) * slope


@pytest.mark.parametrize("load", first(1, FUNCTIONS.values()))
def test_a_function_takes_what_its_arguments_name_in_every_call(load):
    theta = np.linspace(0.1, 6.0, 9)
    result = dx.evaluate("T_in", theta=theta, F_Y=load, **TURNING)
    assert result == pytest.approx(torque(theta), rel=1e-12, abs=1e-11)
    assert dx.evaluate("T_in", theta=1.0, F_Y=load, **TURNING) == pytest.approx(torque(1.0), rel=1e-12)
    turn = np.linspace(0.0, 2.0 * np.pi, 20_001)
    assert dx.peak("T_in", F_Y=load, **TURNING)["value"] == pytest.approx(
        np.abs(torque(turn)).max(), rel=1e-7
    )
    assert dx.drive(F_Y=load, **TURNING)["torque_mean"] == pytest.approx(torque(turn[:-1]).mean(), rel=1e-9)
    run = dx.simulate(torque=5.0, t_end=0.5, omega_start=30.0, F_Y=load, names="F_C_Y", **DESIGN)
    same = dx.simulate(torque=5.0, t_end=0.5, omega_start=30.0, F_Y=FUNCTIONS["by keyword"], **DESIGN)
    assert run["omega"] == pytest.approx(same["omega"], rel=1e-9)
    assert run["status"] == 0
    speed = dx.steady(torque=MOTOR, F_Y=load, **DESIGN)["omega"]
    assert speed == pytest.approx(dx.steady(torque=MOTOR, F_Y=by_keyword, **DESIGN)["omega"], rel=1e-9)


@pytest.mark.parametrize(
    ("load", "message"),
    [
        (lambda x: x, "arguments, t, theta, omega, Y, s, V_C, but <lambda> has x"),
        (lambda *several: 1.0, "has none without a default"),
        (lambda Y=1.0: Y, "has none without a default"),
        (lambda t, Y: Y, "a function of t is not served by this call, which passes theta, omega, Y, s, V_C"),
        (max, "max does not say what its arguments are"),
    ],
)
def test_other_functions_are_refused(load, message):
    with pytest.raises(TypeError, match=message):
        dx.evaluate("T_in", theta=1.0, F_Y=load, **TURNING)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: dx.over_Y(lambda a, b: a), "over_Y: a function of one argument is expected.* a, b"),
        (lambda: dx.over_V([1, 0], [1, 2]), "over_V: the speeds must ascend, but 0 follows 1"),
        (lambda: dx.over_V([0, 1], ["1 Pa", "2 Pa"]), "a pressure needs the size of the piston"),
        (lambda: dx.over_V([0, 1]), "over_V: forces is missing"),
        (lambda: dx.spring(-1.0, 0.1), "stiffness = -1.0: it must be a stiffness >= 0"),
        (lambda: dx.spring("3 N", 0.1), "stiffness"),
        (lambda: dx.damper(linear=np.nan), "linear = nan"),
        (lambda: dx.spring([1.0, 2.0], 0.1), "stiffness"),
        (lambda: dx.spring(1.0, 0.1) + float("inf"), "the number must be finite"),
        (lambda: 10**400 * dx.spring(1.0, 0.1), "the factor must be finite"),
        (lambda: dx.simulate(torque=dx.spring(1.0, 0.1), t_end=1.0, **DESIGN), "torque = <spring"),
        (
            lambda: dx.steady(torque=lambda omega, V_C: 1.0, **DESIGN),
            "a function of V_C is not served by this call, which passes theta, omega$",
        ),
        (lambda: dx.steady(torque=dx.over_V([0, 1], [1, 0]), **DESIGN), "torque = <load over V_C"),
        (lambda: dx.evaluate("T_in_wrt_AB", theta=1.0, F_Y=lambda V_C: V_C, **TURNING), "desaxe.over_V"),
        (
            lambda: dx.simulate(torque=1.0, t_end=1.0, F_Y=dx.spring(1.0, 0.1), wrt="F_Y.stif", **DESIGN),
            "wrt: no parameter 'F_Y.stif'.*F_Y.stiffness",
        ),
        (lambda: dx.Machine(units="mm, N", F_Y=dx.spring(4e3, 0.1)), "machine.spring"),
        (lambda: dx.Machine(units="mm, N", F_Y=5 - dx.spring(4e3, 0.1)), "machine.spring"),
        (lambda: dx.Machine(units="mm, N", F_Y=dx.over_Y(["1 m", "2 m"], ["0 N", "9 N"])
                            + dx.over_Y([1, 2], [3, 4])), "machine.over_Y"),
    ],
)  # fmt: skip
def test_what_makers_refuse(make, message):
    with pytest.raises((TypeError, ValueError), match=message):
        make()


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: dx.spring(800, free=200), 'free = 200 m, write free = "200 mm"'),
        (lambda: dx.Machine(units="cm").spring(800, free=3000), 'free = 3000 cm, write free = "3000 mm"'),
        (lambda: dx.simulate(torque=1, t_end=0.01, theta0=20, **DESIGN), 'write theta0 = "20 deg"'),
        (lambda: dx.simulate(torque=1, t_end=0.01, until=90, **DESIGN), 'write until = "90 deg"'),
        (lambda: dx.simulate(torque=1, t_end=1e-4, omega_start=3000, **DESIGN), 'omega_start = "3000 rpm"'),
    ],
)
def test_slips_of_units(make, words, monkeypatch):
    monkeypatch.setattr("desaxe.mechanism.slips.WARNED", set())
    monkeypatch.setattr("desaxe.mechanism.public.LOOKS", [1000])
    with pytest.warns(dx.UnitWarning) as caught:
        make()
    assert words in str(caught[0].message)
    assert caught[0].filename == __file__


def test_sums_of_the_same_columns_do_not_share_what_is_remembered():
    """A sum of one table, one of two and one with a function, each after the other, at points and arrays."""
    damper, resistance = dx.damper(linear=3.0, quadratic=1.0), dx.over_V([-2.0, 2.0], [8.0, -8.0])
    throttle = dx.over_V(lambda V_C: -V_C)
    theta, V_C = np.array([1.0, 2.0]), dx.evaluate("V_C", theta=np.array([1.0, 2.0]), **TURNING)
    forces = [
        (2.0 * damper, -6.0 * V_C - 2.0 * V_C * abs(V_C)),
        (damper + resistance, -7.0 * V_C - V_C * abs(V_C)),
        (damper + throttle, -4.0 * V_C - V_C * abs(V_C)),
        (damper + damper + damper, -9.0 * V_C - 3.0 * V_C * abs(V_C)),
    ]
    for load, force in [*forces, *forces[::-1]]:
        expected = dx.evaluate("T_in", theta=theta, F_Y=force, **TURNING)
        np.testing.assert_allclose(
            dx.evaluate("T_in", theta=theta, F_Y=load, **TURNING), expected, rtol=1e-12
        )
        assert dx.evaluate("T_in", theta=1.0, F_Y=load, **TURNING) == pytest.approx(expected[0], rel=1e-12)


def test_loads_and_motors_are_called_with_texts():
    press = dx.Machine(units="mm, rpm, N")
    motor = dx.over_omega(["0 rpm", "300 rpm"], ["60 N m", "0 N m"])
    assert motor("250 rpm") == pytest.approx(10.0)
    assert press.over_omega([0, 300], [60, 0])("250 rpm") == pytest.approx(10.0)
    assert dx.spring(800, "0.2 m")("300 mm") == pytest.approx(-80.0)
    assert press.damper(0.2)("1 m/s") == pytest.approx(-200.0)
    assert dx.over_Y([0, 1], [0, 10])("30 cm") == pytest.approx(3.0)
    assert dx.over_theta(np.sin)("30 deg") == pytest.approx(0.5)


def test_the_units_of_a_machine():
    press = dx.Machine(units="mm, deg, rpm, N, kg", AB=40, BC=130, ec=10, omega0=300, m_slider=2)
    Y, V = press.evaluate("Y", theta=60), press.evaluate("V_C", theta=60)
    forces = {
        -4.0 * (Y - 120.0): [
            press.spring(4, free=120), press.spring("4000 N/m", "12 cm"), lambda Y: -4 * (Y - 120),
        ],
        -0.2 * V - 1e-5 * V * abs(V): [
            press.damper(0.2, 1e-5), press.damper("200 N s/m", "10 N s^2/m^2"),
            lambda V_C: -0.2 * V_C - 1e-5 * V_C * abs(V_C),
            press.over_V(lambda V: -0.2 * V - 1e-5 * V * abs(V)),
        ],
        -300.0 * 60.0: [lambda omega, theta: -omega * theta],
        2.0 * Y + 7.0: [2 * press.over_Y(lambda y: y, derivative=lambda y: 1.0) + 7],
    }  # fmt: skip
    for number, loads in forces.items():
        for load in loads:
            result = press.evaluate("T_in", theta=60, F_Y=load)
            assert result == pytest.approx(press.evaluate("T_in", theta=60, F_Y=number), rel=1e-12)
            held = press.replace(F_Y=load).evaluate("T_in", theta=60)
            assert held == pytest.approx(result, rel=1e-12)
    assert str(press.spring(4, free=120)) == "<spring: stiffness = 4 N/mm, free = 120 mm>"
    assert press.damper(0.2)(1000.0) == pytest.approx(-200.0)
    turning = press.simulate(torque=lambda omega: 40 - 0.1 * omega, t_end=0.5, I_crank="0.05 kg m^2")
    right = dx.simulate(
        torque=lambda omega: 40 - 3.0 / np.pi * omega, t_end=0.5, omega_start=10 * np.pi, **DESIGN
    )
    assert turning["omega"] == pytest.approx(right["omega"] * 30.0 / np.pi, rel=1e-9)


def loads_of(numbers):
    return dx.spring(numbers["stiffness"], numbers["free"]) + dx.damper(
        numbers["linear"], numbers["quadratic"]
    )


@pytest.mark.parametrize("mu", first(1, [0.1, 0.0]))
def test_motions_and_steady_states_have_derivatives_by_the_numbers_of_loads(mu):
    def run(numbers, **more):
        load = loads_of(numbers)
        return dx.simulate(
            torque=6.0, t_end=0.7, omega_start=20.0, F_Y=load, mu=mu, rtol=1e-12, **DESIGN, **more
        )

    def orbit(numbers):
        return dx.steady(torque=MOTOR, F_Y=loads_of(numbers), mu=mu, **DESIGN)

    whole, turning = run(NUMBERS, wrt=[f"F_Y.{name}" for name in NUMBERS]), orbit(NUMBERS)
    for name, value in NUMBERS.items():
        h = 1e-4 * value
        ends = [{**NUMBERS, name: value + side * h} for side in (1, -1)]
        one, other = map(run, ends)
        for key in ("theta", "omega"):
            slope = (one[key][-1] - other[key][-1]) / (2.0 * h)
            assert whole[f"{key}_wrt_F_Y.{name}"][-1] == pytest.approx(slope, rel=1e-4), name
        assert whole[f"work_wrt_F_Y.{name}"] == pytest.approx(
            (one["work"] - other["work"]) / (2.0 * h), rel=1e-3
        )
        one, other = map(orbit, ends)
        for key in ("omega_mean", "fluctuation", "power_mean"):
            slope = (one[key] - other[key]) / (2.0 * h)
            assert turning["gradient"][key][f"F_Y.{name}"] == pytest.approx(slope, rel=1e-4, abs=1e-12), name


def back(theta, Y, V):
    return -80.0 * (Y - 0.1)


def oil(theta, Y, V):
    return -5.0 * V - 0.4 * V * np.abs(V)


def slow(theta, Y, V):
    return np.interp(V, [-0.2, 0.0, 0.3], [4.0, 0.0, -6.0])


SPRING, DAMPER, OVER_V = dx.spring(80, "0.1 m"), dx.damper(5, 0.4), dx.over_V([-0.2, 0, 0.3], [4, 0, -6])
DRAG = dx.over_V(lambda V: -4.0 * V, derivative=lambda V: -4.0 + 0.0 * V)
OVER_ANGLE = dx.over_theta(lambda theta: 3.0 * np.cos(theta), derivative=lambda theta: -3.0 * np.sin(theta))
MOVING = {  # load, and what it is at an angle, a position and a speed
    "spring": (SPRING, back),
    "damper": (DAMPER, oil),
    "over_V": (OVER_V, slow),
    "function of V": (DRAG, lambda theta, Y, V: -4.0 * V),
    "function of Y and V": (lambda Y, V_C: 30.0 * Y - 3.0 * V_C, lambda theta, Y, V: 30.0 * Y - 3.0 * V),
    "spring and damper": (SPRING + DAMPER, lambda *now: back(*now) + oil(*now)),
    "number": (SPRING + 3.0, lambda *now: back(*now) + 3.0),
    "multiple": (-2 * SPRING, lambda *now: -2.0 * back(*now)),
    "multiple of a damper": (3 * DAMPER, lambda *now: 3.0 * oil(*now)),
    "with over_theta": (SPRING + OVER_ANGLE, lambda theta, *now: back(theta, *now) + 3.0 * np.cos(theta)),
    "damper, over_theta": (DAMPER + OVER_ANGLE, lambda theta, *now: oil(theta, *now) + 3.0 * np.cos(theta)),
    "with over_Y": (
        SPRING + dx.over_Y([0.08, 0.12, 0.2], [1, 3, -2]),
        lambda theta, Y, V: back(theta, Y, V) + np.interp(Y, [0.08, 0.12, 0.2], [1.0, 3.0, -2.0]),
    ),
    "with over_stroke": (
        DAMPER + dx.over_stroke([0, 0.09], [1, -3], dead_centre="outer"),
        lambda theta, Y, V: oil(theta, Y, V) + np.interp(REACH - Y, [0.0, 0.09], [1.0, -3.0]),
    ),
    "with over_V": (DAMPER + OVER_V, lambda *now: oil(*now) + slow(*now)),
    "functions": (DRAG + SPRING, lambda theta, Y, V: back(theta, Y, V) - 4.0 * V),
    "many": (
        2 * (SPRING + DAMPER) + OVER_V + 2.0,
        lambda *now: 2 * (back(*now) + oil(*now)) + slow(*now) + 2,
    ),
}
TORQUES = {  # and what it is at an instant and a speed
    "number": (3.0, lambda t, omega: 3.0),
    "kloss": (dx.kloss(4.0, 0.4, 30.0), lambda t, omega: 8.0 * (u := (1 - omega / 30) / 0.4) / (1 + u * u)),
    "motor": (
        dx.over_omega([0, 10, 40], [4, 3, -1]), lambda t, omega: np.interp(omega, [0, 10, 40], [4, 3, -1]),
    ),
    "of omega": (lambda omega: 4.0 - 0.2 * omega, lambda t, omega: 4.0 - 0.2 * omega),
    "of t": (lambda t: 3.0 + np.sin(3.0 * t), lambda t, omega: 3.0 + np.sin(3.0 * t)),
}  # fmt: skip
KINDS = [*itertools.product(MOVING, TORQUES)]
MOTIONS = first(
    len(KINDS),
    [
        *((*kind, 12.0 * (k % 2)) for k, kind in enumerate(KINDS)),
        *((*kind, 12.0 * (k % 2 == 0)) for k, kind in enumerate(KINDS)),
    ],
)


@pytest.mark.parametrize(("name", "torque", "start"), MOTIONS)
def test_motions_under_loads_along_the_motion(name, torque, start):
    """Alone, of machine and shaft, with derivatives and a last angle, of designs; values by scipy."""
    (load, push), (turn, drive) = MOVING[name], TORQUES[torque]

    def rates(t, y):
        Y, slope, bend = slider(y[0], LENGTHS, 1)
        work = drive(t, y[1]) + push(y[0], Y, slope * y[1]) * slope
        return y[1], (work - 2.0 * slope * bend * y[1] ** 2) / (0.05 + 2.0 * slope**2)

    right = solve_ivp(rates, (0.0, 0.2), [0.3, start], "DOP853", rtol=1e-9, atol=1e-9).y[:, -1]
    run = {"torque": turn, "theta0": 0.3, "omega_start": start, "t_end": 0.2, "times": [0.2]}
    numbers = [f"F_Y.{number}" for number in getattr(load, "numbers", ())]
    known = getattr(load, "has_slope", False) and not torque.startswith("of")
    shaft = dx.Crankshaft(dx.Machine(**LENGTHS, m_slider=2.0, F_Y=load), phase=[0.0], I_shaft=0.05)
    motions = [
        dx.simulate(F_Y=load, until=30.0 * np.pi, wrt=["AB", *numbers] if known else (), **run, **DESIGN),
        dx.Machine(**DESIGN, F_Y=load).simulate(**run),
        shaft.simulate(**{**run, "theta0": 0.3}),
    ]
    for moved in motions:
        assert [moved["theta"][-1], moved["omega"][-1]] == pytest.approx(right, rel=1e-6)
    many = dx.simulate(F_Y=load, **run, **{**DESIGN, "AB": [0.04, 0.03]})
    assert [many["theta"][0, -1], many["omega"][0, -1]] == pytest.approx(right, rel=1e-6)
    across = dx.simulate(F_X=load, **run, **DESIGN, mu=0.0)
    free = dx.simulate(**run, **DESIGN)
    assert across["omega"] == pytest.approx(free["omega"], rel=1e-8)  # the guide takes it


def test_derivatives_by_the_numbers_of_loads_are_in_the_units_of_the_machine():
    """kN/mm, mm, kN s/mm, kN s2/mm2 and rpm; those in SI units are held by differences above."""
    sizes = {"stiffness": 1e6, "free": 1e-3, "linear": 1e6, "quadratic": 1e9}
    spelled = {"stiffness": "mm/kN", "free": "1/mm", "linear": "mm/kN/s", "quadratic": "mm^2/kN/s^2"}
    load, names = loads_of(NUMBERS), [f"F_Y.{name}" for name in NUMBERS]
    press = dx.Machine(**DESIGN, F_Y=load).replace(units="mm, kN, rpm")
    motor = dx.over_omega(["0 rad/s", "300 rad/s"], ["120 N m", "-330 N m"])
    turning, shown = dx.steady(torque=MOTOR, F_Y=load, **DESIGN), press.steady(torque=motor)
    run = {"t_end": 0.7, "wrt": names, "times": [0.0, 0.7]}
    moves = dx.simulate(torque=6.0, omega_start=20.0, F_Y=load, **run, **DESIGN)
    of_press = press.simulate(torque="6 N m", omega_start="20 rad/s", **run)
    for name, size in sizes.items():
        by = f"F_Y.{name}"
        for key, of_key in (("omega_mean", 30.0 / np.pi), ("fluctuation", 1.0)):
            result = shown["gradient"][key][by]
            assert result == pytest.approx(turning["gradient"][key][by] * of_key * size, rel=1e-12)
        assert shown.units["gradient"]["omega_mean"][by] == f"rpm*{spelled[name]}".replace("*1/", "/")
        for base, of_key in (("theta", 1.0), ("omega", 30.0 / np.pi), ("t_last", 1.0), ("work", 1.0)):
            key = f"{base}_wrt_{by}"
            assert of_press[key] == pytest.approx(moves[key] * of_key * size, rel=1e-12)
        for one, other in zip(of_press["events"], moves["events"], strict=True):
            assert one.wrt[by] == pytest.approx(other.wrt[by] * size, rel=1e-12)
    assert moves.units["work_wrt_F_Y.linear"] == "J*m/N/s"
    assert turning.units["gradient"]["omega_mean"]["F_Y.stiffness"] == "rad*m/s/N"


def test_a_drag_takes_its_power():
    """The mean power of a damper is that of linear V^2 + quadratic |V|^3."""
    theta = 2.0 * np.pi * (np.arange(40_000) + 0.5) / 40_000
    V = 30.0 * slider(theta, LENGTHS, 1)[1]
    power = np.mean(200.0 * V**2 + 3.0 * np.abs(V) ** 3)
    result = dx.drive(F_Y=dx.damper(linear=200.0, quadratic=3.0), **TURNING)
    assert result["power_mean"] == pytest.approx(power, rel=1e-8)
    assert result["gradient"]["power_mean"]["omega0"] == pytest.approx(
        np.mean(400.0 * V**2 + 9.0 * np.abs(V) ** 3) / 30.0, rel=1e-7
    )


def test_a_die_and_a_spring_jump_where_the_die_does():
    die = dx.over_stroke([0.0, 0.008, 0.008], [-8e3, -8e3, 0.0], [0.0, 0.0, 0.0], dead_centre="outer")
    load = die + dx.spring(2e3, free=0.1)
    theta = np.linspace(0.0, 2.0 * np.pi, 400_001)
    Y, slope, bend = slider(theta, LENGTHS, 1)
    pushed = np.where((REACH - Y < 0.008) & (slope > 0.0), -8e3, 0.0)
    right = (2.0 * 30.0**2 * bend - pushed + 2e3 * (Y - 0.1)) * slope
    result = dx.peak("T_in", F_Y=load, **TURNING)
    assert result["value"] == pytest.approx(np.abs(right).max(), rel=1e-4)
    assert dx.drive(F_Y=load, **TURNING)["torque_mean"] == pytest.approx(right[:-1].mean(), rel=1e-4)
    one, other = (dx.peak("T_in", F_Y=load, **{**TURNING, "AB": 0.04 + h})["value"] for h in (1e-6, -1e-6))
    assert result["gradient"]["AB"] == pytest.approx((one - other) / 2e-6, rel=1e-4)
