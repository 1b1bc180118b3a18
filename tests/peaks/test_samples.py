"""Peaks of random designs under every kind of load: no dense sample is better, and each is attained."""

import numpy as np
import pytest

import desaxe as dx
from tests.effort import cases

TURN, BLOCK = 2.0 * np.pi, 500
ANGLES, FORCES = [0.0, 1.0, 2.5, 4.0, 5.0], [0.0, 300.0, -200.0, 500.0, 100.0]
PLACES, ALONG = [0.1, 0.2, 0.3, 0.5], [0.0, -300.0, -500.0, 100.0]
AWAY, FROM_CENTRE = [0.0, 0.03, 0.08, 0.3], [-400.0, -100.0, 0.0, 0.0]
STEPS = dx.over_Y(PLACES, ALONG, kind="step")
LINES = dx.over_theta(ANGLES, FORCES, "linear")
FALLING = dx.over_stroke(AWAY, FROM_CENTRE, kind="step", dead_centre="outer")
LOADS = {
    "none": 0.0,
    "a number": -300.0,
    "cubic": dx.over_theta(ANGLES, FORCES),
    "linear": LINES,
    "steps": dx.over_theta(ANGLES, FORCES, "step"),
    "two turns": dx.over_theta(ANGLES, FORCES, "linear", period=2.0 * TURN),
    "a function": dx.over_theta(lambda theta: 300.0 * np.sin(2.0 * theta) + 100.0 * np.cos(5.0 * theta)),
    "over Y": dx.over_Y(PLACES, ALONG),
    "over Y, each way": dx.over_Y(PLACES, ALONG, [0.0, 10.0, 50.0, 0.0], kind="linear"),
    "steps over Y": STEPS,
    "stroke, each way": dx.over_stroke(
        AWAY, FROM_CENTRE, [0.0, 0.0, 50.0, 0.0], kind="linear", dead_centre="inner"
    ),
    "steps over the stroke": FALLING,
    "over V": dx.over_V([-4.0, 0.0, 3.0], [200.0, 0.0, -300.0]),
    "damper": dx.damper(linear=20.0, quadratic=3.0),
    "spring and lines": dx.spring(3000.0, free=0.3) + LINES,
    "steps and steps over Y": STEPS + dx.over_theta(ANGLES, FORCES, "step"),
}
FORCED, RATES = ("T_in", "N_C"), ("a_C", "V_C", "j_C", "alpha_BC", "a_C_wrt_ec")
CASES = [("rates", RATES, 0.0, 0.0), *((label, FORCED, load, 0.0) for label, load in LOADS.items())]
CASES += [(f"friction, {n}", FORCED, LOADS[n], 0.25) for n in ("a number", "steps", "steps over the stroke")]
CASES.append(("friction that jams", ("T_in", "N_C", "F_friction", "F_B_Y"), -300.0, 1.5))
SIDES = (0.0, -3e-12, 3e-12, -1e-9, 1e-9)  # rad: next to a jump or kink, rounding may take the other side


def designs(count, mu, seed):
    """Designs that turn fully, down to margins of 0.25 % of the crank, turning either way."""
    rng = np.random.default_rng(seed)
    AB = rng.uniform(0.03, 0.12, count)
    ec = rng.uniform(-0.9, 0.9, count) * AB * (rng.uniform(size=count) > 0.15)
    BC = AB + np.abs(ec) + AB * np.exp(rng.uniform(-6.0, 1.2, count))
    omega0 = rng.choice([-1, 1], count) * rng.uniform(5.0, 60.0, count)
    bodies = {"m_slider": 2.0, "m_rod": 1.0, "I_rod": 0.004, "g_Y": -9.81}
    friction = {"mu": rng.uniform(0.02, mu, count)} if mu else {}
    return {"ec": ec, "AB": AB, "BC": BC, "omega0": omega0, **bodies, **friction}


@pytest.mark.sampled
@pytest.mark.parametrize(("label", "names", "load", "mu"), CASES, ids=[case[0] for case in CASES])
def test_no_sample_is_better_and_each_peak_is_a_value(label, names, load, mu):
    span = TURN * (2.0 if label == "two turns" else 1.0)
    theta = np.linspace(0.0, span, 1201)
    for name, branch in zip(names[: cases(1, 5)], (1, -1, 1, -1, 1), strict=False):
        inputs = {**designs(cases(40, 10_000), mu, 7), "F_Y": load}
        rows = {n: value for n, value in inputs.items() if isinstance(value, np.ndarray)}
        samples = np.concatenate([
            dx.evaluate(name, theta=theta, branch=branch,
                        **{**inputs, **{n: v[k : k + BLOCK, None] for n, v in rows.items()}})
            for k in range(0, rows["ec"].size, BLOCK)
        ])  # fmt: skip
        scale = np.nanmax(np.abs(samples), axis=1)
        for kind, sign in (("max", 1.0), ("min", -1.0)):
            peak = dx.peak(name, kind=kind, branch=branch, **inputs)
            best = np.nanmax(sign * samples, axis=1)
            assert (sign * peak["value"] >= best - 1e-11 * scale).all()
            near = np.clip(peak["theta"] + np.array(SIDES)[:, None], 0.0, span)
            there = dx.evaluate(name, theta=near, branch=branch, **inputs)
            away = np.nanmin(np.abs(there - peak["value"]), axis=0)
            bounded = np.isfinite(peak["value"])  # where friction jams it is not
            assert bounded.mean() > (0.1 if mu > 1.0 else 0.8)
            room = (1e-5 if mu else 1e-7) * np.maximum(scale, np.abs(peak["value"]))  # steep next to a jam
            assert (away <= room)[bounded].all()


def test_a_maximum_before_a_kink_of_a_load_that_differs_each_way():
    """The slope at the kink is that of the other side: 30.32 N m was returned, at the maximum behind it."""
    design = {"ec": 0.04918138260831362, "AB": 0.10622985335703566, "BC": 0.16220386688678315}
    inputs = {**designs(1, 0.0, 7), **design, "omega0": -38.69243766804411, "F_Y": LOADS["over Y, each way"]}
    peak, theta = dx.peak("T_in", kind="max", **inputs), np.linspace(0.0, TURN, 100_001)
    assert peak["value"] >= np.max(dx.evaluate("T_in", theta=theta, **inputs))
    assert peak["theta"] == pytest.approx(0.5851, abs=1e-3)


@pytest.mark.parametrize("mu", [0.0, 0.08])
def test_a_sum_of_loads_jumps_where_its_member_does(mu):
    """The side of the jump is that of the member alone: nothing is added to it."""
    press = {"ec": 0.015, "AB": 0.075, "BC": 0.3, "omega0": 6.0, "m_slider": 120.0, "mu": mu}
    die = dx.over_Y([0.2, 0.366, 0.38], [0.0, -8e4, -8e4], [0.0] * 3, kind="step")
    nothing = dx.over_theta([0.0, 3.0], [0.0, 0.0], "linear")
    alone, summed = (dx.peak("T_in", F_Y=load, **press) for load in (die, die + nothing))
    assert alone["side"] == summed["side"] != 0
    assert summed["value"] == pytest.approx(alone["value"], rel=1e-12)
    assert summed["theta"] == pytest.approx(alone["theta"], abs=1e-14)
    for parameter in ("ec", "AB", "BC", "mu"):
        slope = alone["gradient"][parameter]
        assert summed["gradient"][parameter] == pytest.approx(slope, rel=1e-9), parameter
