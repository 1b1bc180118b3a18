"""Names under loads at the points of large arrays: a kernel has what a few points have."""

import numpy as np
import pytest

import desaxe as dx
from desaxe.evaluation.under_loads import loaded
from tests.effort import cases

DESIGN = {"AB": 0.1, "BC": 0.35, "m_slider": 2.0, "omega0": -30.0}
POSITIONS, DISTANCES = [0.27, 0.33, 0.40], [0.0, 0.008, 0.1]
OUT, BACK = [0.0, -100.0, -400.0], [0.0, -10.0, -50.0]
EVEN = np.linspace(0.0, 6.2, 40)
UNEVEN = 6.2 * np.linspace(0.0, 1.0, 30) ** 2
thorough = pytest.mark.thorough
LOADS = {
    "steps over Y, both ways": dx.over_Y(POSITIONS, OUT, BACK, kind="step"),
    "steps over the stroke": dx.over_stroke(DISTANCES, OUT, kind="step", dead_centre="inner"),
    "lines over Y": dx.over_Y(POSITIONS, OUT, kind="linear"),
    "even cubics over theta": dx.over_theta(EVEN, 100.0 * np.sin(EVEN)),
    "uneven steps over theta": dx.over_theta(UNEVEN, 100.0 * np.cos(UNEVEN), kind="step"),
    "a function": dx.over_theta(np.cos, lambda theta: -np.sin(theta)),
}
FIRST = "uneven steps over theta"  # the quickest to compile
CASES = [pytest.param(name, marks=() if name == FIRST else thorough) for name in LOADS]
NAMES = ["T_in", "T_in_wrt_ec", "T_in_wrt_theta"]


def next_to_jumps(load, ec):
    """The doubles on both sides of the angles at which the slider passes jumps or turns."""
    angles = [dx.events(ec=ec, AB=0.1, BC=0.35)[key] for key in ("theta_outer", "theta_inner")]
    for place in load.positions(smooth=True) if load.over == "Y" else ():
        angles += np.ravel(dx.inverse(Y=place, ec=ec, AB=0.1, BC=0.35)["theta"]).tolist()
    found = np.array([angle for angle in map(float, angles) if np.isfinite(angle)])
    return (found + np.arange(-4.0, 5.0)[:, None] * np.spacing(found)).reshape(-1)


@pytest.mark.sampled
@pytest.mark.parametrize("name", CASES)
def test_a_kernel_has_the_values_of_few_points(name, monkeypatch):
    monkeypatch.setattr(loaded, "MANY", 500)
    monkeypatch.setattr("desaxe.evaluation.under_loads.points.LEAST", 500)
    load, rng = LOADS[name], np.random.default_rng(5)
    names = [*NAMES, "status"]
    for _ in range(cases(1, 2, 100)):
        ec = rng.uniform(-0.05, 0.05)
        near = next_to_jumps(load, ec)
        theta = np.append(near, [np.nan, *rng.uniform(-20.0, 20.0, 1_000)])
        found = dx.evaluate(names, theta=theta, ec=np.full(theta.size, ec), F_Y=load, **DESIGN)
        monkeypatch.setattr(loaded, "MANY", 10**9)
        few = dx.evaluate(names, theta=theta, ec=ec, F_Y=load, **DESIGN)
        monkeypatch.setattr(loaded, "MANY", 500)
        np.testing.assert_array_equal(found["status"], few["status"])
        for key in NAMES:
            scale = np.nanmax(np.abs(few[key]))
            np.testing.assert_allclose(found[key], few[key], rtol=1e-11, atol=1e-13 * scale, err_msg=key)
        for k in rng.choice(near.size, 4):  # a point alone is in plain Python, exactly on its side
            alone = dx.evaluate("T_in", theta=float(theta[k]), ec=ec, F_Y=load, **DESIGN)
            assert found["T_in"][k] == pytest.approx(alone, rel=1e-9, abs=1e-12)
        halves = [
            dx.evaluate("T_in", theta=part, ec=np.full(part.size, ec), F_Y=load, threads=1, **DESIGN)
            for part in np.split(theta[: theta.size // 2 * 2], 2)
        ]
        again = dx.evaluate("T_in", theta=theta, ec=np.full(theta.size, ec), F_Y=load, **DESIGN)
        np.testing.assert_array_equal(np.concatenate(halves), again[: theta.size // 2 * 2])


def test_shapes_and_out_are_those_of_few_points(monkeypatch):
    monkeypatch.setattr(loaded, "MANY", 50)
    monkeypatch.setattr("desaxe.evaluation.under_loads.points.LEAST", 50)
    theta, ec = np.linspace(0.0, 6.0, 12)[:, None], np.array([-0.05, 0.0, 0.3, 0.0, 0.01])
    load = LOADS["lines over Y"]
    monkeypatch.setattr(loaded, "_by_kernel", lambda *given: pytest.fail("two forms are no one kernel"))
    out = np.empty((12, 5))
    monkeypatch.setattr(loaded, "MANY", 10**9)
    assert dx.evaluate("F_A_X", theta=theta, ec=ec, F_Y=load, out=out, **DESIGN) is out
    assert np.isnan(out[:, 2]).any()
