"""Multiples, sums and shifts of loads: at every angle those of their values, in every call."""

import pickle

import numpy as np
import pytest

import desaxe as dx

TURN = 2.0 * np.pi
MACHINE = {"ec": 0.01, "AB": 0.04, "BC": 0.13, "omega0": 20.0, "m_slider": 0.5}
LINE = dx.over_theta([0.5, 2.0, 4.0], [10.0, -30.0, 5.0], kind="linear")
OTHER = dx.over_theta([0.1, 3.0, 5.0], [1.0, 2.0, -7.0], kind="linear")
STEP = dx.over_theta([0.0, 1.0, 2.5], [3.0, -4.0, 9.0], kind="step")
SLOW = dx.over_theta([0.0, 3.0, 9.0], [3.0, -4.0, 9.0], kind="step", period=2 * TURN)
CUBIC = dx.over_theta(np.linspace(0.0, 6.0, 9), np.sin(np.linspace(0.0, 9.0, 9)))
SMOOTH = dx.over_theta(np.linspace(0.3, 6.2, 9), np.cos(np.linspace(0.0, 5.0, 9)))
WAVE = dx.over_theta(np.sin, derivative=np.cos)
GAS = dx.over_Y([0.1, 0.13, 0.17], [-900, -200, -50], [-90, -40, -15])
SPRING = dx.over_Y([0.09, 0.12, 0.12, 0.16], [10, 20, 50, 60])
DIE = dx.over_stroke([0.0, 0.02, 0.02], [-80.0, -80.0, 0.0], [0.0, 0.0, 0.0], dead_centre="outer")
PUSH = dx.over_stroke([0.0, 0.05], [-5.0, 0.0], dead_centre="outer")
# A load, and what it is a sum of: factor, load, angle that it lags.
CASES = {
    "a multiple": (2.5 * LINE, [(2.5, LINE, 0.0)]),
    "a number of NumPy": (np.float64(2.5) * LINE, [(2.5, LINE, 0.0)]),
    "negative": (-CUBIC, [(-1.0, CUBIC, 0.0)]),
    "a function": (WAVE * 3, [(3.0, WAVE, 0.0)]),
    "linear and linear": (LINE + OTHER, [(1.0, LINE, 0.0), (1.0, OTHER, 0.0)]),
    "steps of other periods": (STEP - SLOW, [(1.0, STEP, 0.0), (-1.0, SLOW, 0.0)]),
    "cubic and cubic": (CUBIC + 2 * CUBIC, [(3.0, CUBIC, 0.0)]),
    "other cubics": (CUBIC + SMOOTH, [(1.0, CUBIC, 0.0), (1.0, SMOOTH, 0.0)]),
    "of other kinds": (STEP + LINE, [(1.0, STEP, 0.0), (1.0, LINE, 0.0)]),
    "a function and a table": (WAVE + LINE, [(1.0, WAVE, 0.0), (1.0, LINE, 0.0)]),
    "shifted": (CUBIC.shifted("120 deg"), [(1.0, CUBIC, TURN / 3)]),
    "a shifted function": (WAVE.shifted(1.0), [(1.0, WAVE, 1.0)]),
    "three cylinders": (
        SLOW + SLOW.shifted("240 deg") + SLOW.shifted("480 deg"),
        [(1.0, SLOW, 0.0), (1.0, SLOW, 4 * TURN / 6), (1.0, SLOW, 8 * TURN / 6)],
    ),
    "over Y": (GAS + 2 * SPRING, [(1.0, GAS, 0.0), (2.0, SPRING, 0.0)]),
    "over the stroke": (DIE - PUSH, [(1.0, DIE, 0.0), (-1.0, PUSH, 0.0)]),
}


def torque(load, theta, name="T_in"):
    return dx.evaluate(name, theta=theta, F_Y=load, **MACHINE)


@pytest.mark.parametrize("kind", CASES)
def test_torques_and_slopes_are_sums(kind):
    load, parts = CASES[kind]
    theta = np.random.default_rng(2).uniform(-9.0, 20.0, 300)
    free = torque(0.0, theta)
    expected = free.copy()
    lever = torque(1.0, theta) - free  # of a force of 1 N at this angle
    for factor, part, lag in parts:
        if lag:
            expected += factor * lever * part.value(theta - lag)
        else:
            expected += factor * (torque(part, theta) - free)
    np.testing.assert_allclose(torque(load, theta), expected, rtol=1e-11, atol=1e-11)
    for points in theta[:5]:
        assert torque(load, float(points)) == pytest.approx(
            expected[np.flatnonzero(theta == points)[0]], abs=1e-10
        )
    h, inner = 1e-6, theta[:40]
    ends = [torque(load, inner + s * h) for s in (1, -1)]
    smooth = np.abs(torque(load, inner + h) + torque(load, inner - h) - 2 * torque(load, inner)) < 1e-6
    result = torque(load, inner, "T_in_wrt_theta")
    np.testing.assert_allclose(result[smooth], ((ends[0] - ends[1]) / (2 * h))[smooth], rtol=1e-5, atol=1e-4)
    again = pickle.loads(pickle.dumps(load))
    np.testing.assert_array_equal(torque(again, theta), torque(load, theta))


@pytest.mark.parametrize("kind", CASES)
def test_peaks_and_drives(kind):
    load, _ = CASES[kind]
    period = 2 * TURN if "SLOW" in kind or kind in ("steps of other periods", "three cylinders") else TURN
    theta = np.linspace(0.0, period, 20_001)
    values = torque(load, theta)
    top = dx.peak("T_in", F_Y=load, kind="max", theta=(0.0, period), **MACHINE)["value"]
    assert top == pytest.approx(values.max(), abs=2e-4 * np.ptp(values))
    assert top >= values.max() - 1e-9
    drive = dx.drive(F_Y=load, **MACHINE)
    middle = (np.arange(100_000) + 0.5) * period / 100_000
    assert drive["torque_mean"] == pytest.approx(torque(load, middle).mean(), abs=1e-3 * np.ptp(values))


def test_scenes_hold_multiples_and_sums_of_tables(tmp_path):
    for k, load in enumerate((2 * LINE, LINE + OTHER, STEP.shifted(1.0), GAS + 2 * SPRING)):
        path = tmp_path / f"{k}.toml"
        dx.Machine(F_Y=load, **MACHINE).to_scene(path)
        theta = np.linspace(0.0, 12.0, 101)
        back = dx.Machine.read(path)["F_Y"]
        np.testing.assert_allclose(torque(back, theta), torque(load, theta), rtol=1e-12, atol=1e-12)


def test_the_units_of_a_machine():
    press = dx.Machine(units="mm, deg, kN", ec=10, AB=40, BC=130, omega0=20, m_slider=0.5)
    load = press.over_theta([0, 90, 180, 270], [1, 2, 1, 0], kind="linear")
    assert (2 * load)(45) == pytest.approx(3.0)
    assert load.shifted(90)(135) == pytest.approx(1.5)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda: dx.over_theta([0, 1], ["1 N", "2 N"]) + dx.over_theta([0, 1], ["1 N m", "2 N m"]),
            r"a load in N and one in N\*m do not add up",
        ),
        (lambda: LINE * float("nan"), "the factor must be finite"),
        (lambda: LINE + float("nan"), "the number must be finite"),
        (lambda: LINE + "3", "unsupported operand|can only concatenate"),
        (lambda: LINE * "2", "can't multiply|unsupported"),
        (lambda: LINE.shifted("1 m"), "angle|rad"),
        (lambda: LINE + dx.over_theta([0, 1], [1, 2], period=2.0), "never repeat together"),
    ],
)
def test_what_is_refused(make, message):
    with pytest.raises((TypeError, ValueError), match=message):
        make()
