"""Sums over sliders and their sensitivities, against places of all masses at 60 digits."""

import numpy as np
import pytest
from mpmath import mp, mpf

import desaxe as dx
from tests.crankshaft.truth import DIGITS, TrueSlider, shaft
from tests.effort import first

CYLINDER = {
    "ec": 0.004, "AB": 0.045, "BC": 0.15, "m_crank": 1.1, "m_rod": 0.5, "m_slider": 0.4, "I_crank": 1e-3,
    "I_rod": 2e-3, "r_crank": 0.01, "r_rod": 0.05,
}  # fmt: skip
PUMP = CYLINDER | {"AB": 0.03, "ec": -0.01, "m_slider": 0.9, "r_crank": 0.015, "r_rod": 0.075}
GRAVITY = {"g_X": 1.5, "g_Y": -9.81}
GAS = dx.over_theta(
    lambda t: -900.0 * np.sin(t / 2) ** 4,
    lambda t: -1800.0 * np.sin(t / 2) ** 3 * np.cos(t / 2),
    period="720 deg",
)
# machines, phases, banks, turns by which the firing is later, positions along the shaft
SHAFTS = {
    "in line": ([CYLINDER] * 4, (0.0, 3.1, 3.2, 0.1), (0.0,) * 4, (0, 1, 0, 1), (-0.2, -0.1, 0.1, 0.2)),
    "V": ([CYLINDER] * 3, (0.0, 0.4, 2.2), (-0.7, 0.8, 0.8), (0, 0, 1), (-0.1, 0.0, 0.1)),
    "two machines": ([CYLINDER, PUMP], (0.0, 1.6), (0.2, -1.1), (0, 1), (-0.3, 0.3)),
}
STATE = {"theta": 1.1, "omega": 130.0, "alpha": 250.0}
I_SHAFT = 0.02


def crankshaft(name, **more):
    machines, phase, bank, turns, position = SHAFTS[name]
    firing = [p + b + 2 * np.pi * n for p, b, n in zip(phase, bank, turns, strict=True)]
    members = [dx.Machine(**machine, **GRAVITY, F_Y=GAS) for machine in machines]
    return dx.Crankshaft(
        members, phase=phase, bank=bank, firing=firing, position=position, I_shaft=I_SHAFT, **more
    )


def truth(name, change=None, state=STATE, only=slice(None)):
    """The sums, with inputs changed: {"AB[1]": step, "phase[0]": step, ...}; those of some sliders."""
    change = change or {}

    def moved(key, value, k=None):
        return mpf(value) + change.get(key, 0) + (0 if k is None else change.get(f"{key}[{k}]", 0))

    rows = zip(*SHAFTS[name], strict=True)
    sliders = []
    for k, (inputs, phase, bank, turns, position) in enumerate(rows):
        own = {n: moved(n, v, k) for n, v in inputs.items()}
        angles = moved("phase", phase, k), moved("bank", bank, k)
        sliders.append(TrueSlider(own, *angles, position, lambda t: -900 * mp.sin(t / 2) ** 4, turns))
    g = mp.mpc(moved("g_Y", GRAVITY["g_Y"]), moved("g_X", GRAVITY["g_X"]))
    at = [moved(n, state[n]) for n in ("theta", "omega", "alpha")]
    return shaft(sliders[only], *at, g, moved("I_shaft", I_SHAFT))


def near(value, expected, size=0.0, tolerance=1e-12):
    return abs(mpf(value) - expected) <= tolerance * max(abs(expected), size)


@pytest.mark.parametrize("name", SHAFTS)
def test_every_sum(name):
    with mp.workdps(DIGITS):
        expected = truth(name)
    answer = crankshaft(name).evaluate([*expected], **STATE)
    for quantity, value in expected.items():
        assert near(answer[quantity], value, 1.0), quantity


@pytest.mark.parametrize("name", SHAFTS)
def test_what_each_slider_adds_to_a_couple(name):
    count = len(SHAFTS[name][0])
    answer = crankshaft(name).evaluate([f"C_inertia_{n}[{k}]" for n in "XY" for k in range(count)], **STATE)
    with mp.workdps(DIGITS):
        for k in range(count):
            alone = truth(name, only=slice(k, k + 1))
            for n in ("C_inertia_X", "C_inertia_Y"):
                assert near(answer[f"{n}[{k}]"], alone[n], 1.0), (n, k)


INPUTS = (
    "AB", "ec", "m_rod", "r_rod", "I_crank", "g_X", "g_Y", "I_shaft", "theta", "omega", "alpha",
    "AB[1]", "BC[0]", "m_slider[1]", "phase[1]", "bank[0]", "bank[1]",
)  # fmt: skip


@pytest.mark.parametrize("name", first(1, SHAFTS))
def test_every_sensitivity(name):
    four = crankshaft(name)
    with mp.workdps(DIGITS):
        h = mpf(10) ** -8
        for parameter in INPUTS:
            points = {k: truth(name, {parameter: k * h}) for k in (-2, -1, 1, 2)}
            answer = four.evaluate([f"{q}_wrt_{parameter}" for q in points[1]], **STATE)
            for q, value in answer.items():
                base = q.partition("_wrt_")[0]
                slope = (8 * (points[1][base] - points[-1][base]) - points[2][base] + points[-2][base]) / (
                    12 * h
                )
                assert near(value, slope, 1.0, 1e-11), q


def test_the_law_is_that_of_the_shaft():
    """omega^2 = omega0^2 + 2 alpha theta with the shaft's theta, not a slider's; derivatives are total."""
    law = {"theta": 1.1, "omega0": 130.0, "alpha": 250.0}
    four = crankshaft("V")
    omega = np.sqrt(130.0**2 + 2 * 250.0 * 1.1)
    by_state = four.evaluate("T_in", theta=1.1, omega=omega, alpha=250.0)
    assert four.evaluate("T_in", **law) == pytest.approx(by_state, rel=1e-14)
    for parameter, value in law.items():
        h = 1e-6 * value
        steps = [four.evaluate("T_in", **law | {parameter: value + k * h}) for k in (1, -1)]
        slope = (steps[0] - steps[1]) / (2 * h)
        assert four.evaluate(f"T_in_wrt_{parameter}", **law) == pytest.approx(slope, rel=1e-7)
    rest = {"theta": 0.0, "omega0": 0.0, "alpha": 5.0}
    limit = four.evaluate("T_in_wrt_theta", **rest | {"theta": 1e-12})
    assert four.evaluate("T_in_wrt_theta", **rest) == pytest.approx(limit, rel=1e-9)
    assert four.evaluate(["T_in", "status"], theta=0.4, omega0=1.0, alpha=-5.0)["status"] == 3
    stalled = four.evaluate(["T_in", "status"], theta=[0.0, 0.4], omega0=1.0, alpha=-5.0)
    assert (np.isnan(stalled["T_in"]).tolist(), stalled["status"].tolist()) == ([False, True], [0, 3])


def test_one_slider_and_arrays():
    four = crankshaft("V")
    theta = np.linspace(0.0, 12.0, 9)
    answer = four.evaluate(
        ["a_C[1]", "a_C[1]_wrt_AB", "a_C[1]_wrt_AB[0]", "margin", "T_in"], theta=theta, omega=130.0
    )
    own = dx.evaluate(["a_C", "a_C_wrt_AB", "margin"], theta=theta - 0.4 - 0.8, omega=130.0, **CYLINDER)
    np.testing.assert_allclose(answer["a_C[1]"], own["a_C"], rtol=1e-12)
    np.testing.assert_allclose(answer["a_C[1]_wrt_AB"], own["a_C_wrt_AB"], rtol=1e-12)
    assert not answer["a_C[1]_wrt_AB[0]"].any()
    np.testing.assert_array_equal(answer["margin"], own["margin"])
    grid = four.grid(["T_in", "a_C[1]"], theta=theta, AB=[0.045, 0.05], omega=130.0)
    np.testing.assert_allclose(grid.T_in.sel(AB=0.045), answer["T_in"], rtol=1e-14)
    assert grid["a_C[1]"].units == "m/s^2"
    taken = ["absmax", "rms", ("at", 1.5, "T_in")]
    reduced = four.grid(["T_in"], theta=theta, AB=[0.045, 0.05], omega=130.0, reduce={"theta": taken})
    np.testing.assert_array_equal(reduced.T_in_absmax, abs(grid.T_in).max("theta"))
    np.testing.assert_allclose(reduced.T_in_rms, (grid.T_in**2).mean("theta") ** 0.5, rtol=1e-14)
    np.testing.assert_array_equal(reduced["T_in_at_1.5"], grid.T_in[1])
    assert reduced.T_in_absmax_theta.values[0] in theta
    how = {"theta": theta, "AB": [0.045, 0.05], "omega": 130.0}
    mean = four.grid("T_in", **how, reduce={"theta": "max", "AB": "mean"})
    np.testing.assert_allclose(mean.T_in_max_mean, grid.T_in.max("theta").mean(), rtol=1e-14)


def pair(machine, call="evaluate", name="T_in", **inputs):
    return getattr(dx.Crankshaft(machine, phase=[0, 1]), call)(name, **inputs)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda m: dx.Crankshaft(m, phase=[0, 3], firing=[0, 1.5]),
            r"1\] = 1.5, phase\[1\] \+ bank\[1\] = 3:",
        ),
        (lambda m: dx.Crankshaft([m, m.replace(omega0=3.0)], phase=[0, 1]), "omega0 is one for all"),
        (lambda m: dx.Crankshaft([m, m], phase=[0, 1, 2]), "2 machines and 3 phases"),
        (lambda m: dx.Crankshaft(m, phase=[0, 1], bank=[0, 1, 2]), "phase: .* number for each of 3"),
        (lambda m: dx.Crankshaft(m, phase=[0, 1], spacing=1, position=[0, 1]), "spacing=, or position="),
        (lambda m: dx.Crankshaft(m.replace(AB=[0.04, 0.05]), phase=[0, 1]), "AB is an array"),
        (lambda m: dx.Crankshaft({"AB": 1.0}, phase=[0, 1]), "expected a Machine"),
        (lambda m: pair(m, name="a_C", theta=1.0), r"a_C\[0\] to a_C\[1\]"),
        (lambda m: pair(m, name="a_C[2]", theta=1.0), "sliders 0 to 1"),
        (lambda m: pair(m, name="C_inertia_Y_wrt_AB", theta=1.0), "C_inertia_Y: .* spacing= or position="),
        (lambda m: pair(m, name="M_piston", theta=1.0), "unknown quantity 'M_piston'"),
        (lambda m: pair(m, "peak", **{"AB[3]": 1.0}), "sliders 0 to 1"),
        (lambda m: pair(m, "peak", speed=1.0), "no input 'speed'"),
        (lambda m: pair(m, "fit", {}), "fit is of one slider"),
        (lambda m: dx.peak("T_in", sliders=3.0, **m), "sliders = 3.0: those of a desaxe.Crankshaft"),
        (lambda m: dx.harmonics("T_in", sliders="four", **m), "sliders = 'four': those of"),
        (lambda m: dx.Crankshaft(m, phase=[[0.0], [1.0, 2.0]]), "phase"),
        (lambda m: pair(m, "compile", to="fmu"), "an FMU is of one slider"),
    ],
)
def test_what_is_wrong_is_said(call, message):
    with pytest.raises((ValueError, TypeError), match=message):
        call(dx.Machine(**CYLINDER, omega0=100.0))
