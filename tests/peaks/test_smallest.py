"""The smallest magnitude over a turn: where it is 0 it stays 0 as designs change, so its gradient is 0."""

import numpy as np
import pytest

import desaxe as dx
from tests.effort import cases

STEP = 1e-6  # of a value


def machines(count, seed):
    random = np.random.default_rng(seed)
    for _ in range(count):
        AB = random.uniform(0.02, 0.2)
        BC = AB * random.uniform(1.6, 4.0)
        ec = random.choice([0.0, 1.0, -1.0]) * random.uniform(0.05, 0.6) * (BC - AB)
        masses = {"m_slider": random.uniform(0.1, 5.0), "omega0": random.uniform(-100.0, 100.0)}
        yield {"ec": ec, "AB": AB, "BC": BC, "branch": int(random.choice([1, -1]))}, masses


@pytest.mark.sampled
@pytest.mark.parametrize("load", [None, "table"])
def test_a_magnitude_that_reaches_0_has_the_gradient_0(load):
    for design, masses in machines(cases(6, 30), 1):
        if load:  # along the rod, like the inertia of the slider, it changes its sign
            masses["F_Y"] = dx.over_theta([0.0, 1.5, 3.0, 4.5], [900.0, -300.0, -900.0, 400.0])
        for name in ("F_A", "F_B", "F_C"):  # without a mass of the rod they are all along it
            result = dx.peak(name, kind="min", **design, **masses)
            largest = dx.peak(name, **design, **masses)["value"]
            assert result["value"] < 1e-6 * largest
            assert result["status"] == 0
            assert set(result["gradient"].values()) == {0.0}
        if abs(design["ec"]) < design["AB"]:  # the rod is along the guide at two angles
            result = dx.peak("pressure_angle", kind="min", **design)
            assert result["value"] < 1e-6
            assert set(result["gradient"].values()) == {0.0}


@pytest.mark.sampled
def test_many_designs_have_the_gradients_of_each():
    rows = list(machines(cases(12, 200), 2))
    designs = {name: np.array([design[name] for design, _ in rows]) for name in ("ec", "AB", "BC")}
    result = dx.peak("F_B", kind="min", **designs, omega0=20.0, m_slider=1.0)
    assert all((slope == 0.0).all() for slope in result["gradient"].values())


@pytest.mark.sampled
def test_a_magnitude_above_0_keeps_its_gradient():
    for design, masses in machines(cases(4, 60), 3):
        masses |= {"m_rod": 1.0, "I_rod": 0.01, "g_X": 9.81}
        result = dx.peak("F_C", kind="min", **design, **masses)
        for name in ("AB", "BC", "m_slider"):
            step = STEP * {**design, **masses}[name]
            ahead, behind = (
                dx.peak("F_C", kind="min", **{**design, **masses, name: {**design, **masses}[name] + side})
                for side in (step, -step)
            )
            assert result["gradient"][name] == pytest.approx(
                (ahead["value"] - behind["value"]) / (2.0 * step),
                rel=1e-3,
                abs=1e-4 * result["value"] / step * STEP,
            )


def test_at_the_end_of_a_range_a_magnitude_next_to_0_keeps_its_derivative():
    design = {"ec": 0.01, "AB": 0.04, "BC": 0.1}
    end = float(np.pi + np.arcsin(0.25)) - 1e-9  # there ec + AB sin(theta) is nearly 0
    result = dx.peak("pressure_angle", kind="min", theta=(end - 1.0, end), **design)
    assert result["value"] < 1e-8
    assert result["gradient"]["ec"] == pytest.approx(10.0)  # 1/BC: with a larger offset the rod leans there
