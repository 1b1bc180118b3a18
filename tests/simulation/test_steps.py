"""No bad step is accepted, where one error estimate vanishes by accident."""

import re

import numpy as np
import pytest

import desaxe as dx
from benchmarks.steps import designs, spread
from tests.effort import cases
from tests.motions import true_end

ISSUE = {
    "AB": 0.11988839743156843, "BC": 0.32893073102304915, "ec": 0.0061792077930540226, "m_crank": 0.5,
    "m_rod": 0.8, "m_slider": 0.9734310771225674, "I_crank": 6e-4, "I_rod": 7e-3, "r_crank": 0.04,
    "r_rod": 0.11, "F_X": 7.0, "F_Y": -50.0, "g_X": 3.0, "g_Y": -9.81,
}  # fmt: skip
START = {"torque": 1.5, "theta0": 0.3, "omega_start": 20.0}


@pytest.mark.thorough
def test_a_step_where_one_estimate_vanishes():
    """The error of order 5 passes through 0 in a step of .9 rad: 5.2e-3 rad off at the end."""
    theta, omega = true_end(ISSUE, *START.values(), 1.0, 800)
    for design in (ISSUE, {**ISSUE, "m_slider": np.array([ISSUE["m_slider"]])}):
        for rtol in (3e-6, 1e-6, 3e-7):
            found = dx.simulate(t_end=1.0, rtol=rtol, times=[1.0], **START, **design)
            assert abs(found["theta"].item() - theta) < rtol
            assert abs(found["omega"].item() - omega) < 100.0 * rtol


@pytest.mark.sampled
@pytest.mark.parametrize("power", [4, 5, 6, 8, 10])
def test_the_worst_error_beside_the_usual_one(power):
    """With one estimate alone some are thousands of times worse."""
    found = spread(designs(cases(200, 1_000, 10_000), seed=11), 10.0**-power)
    assert found["theta"].ratio <= 100.0
    assert found["omega"].ratio <= 100.0


@pytest.mark.thorough
def test_one_design_takes_the_steps_of_many():
    drawn = designs(cases(4, 40), seed=3)
    many = dx.simulate(t_end=1.0, rtol=1e-8, times=[1.0], **drawn)
    for row in range(len(drawn["AB"])):
        one = {name: float(np.broadcast_to(v, drawn["AB"].shape)[row]) for name, v in drawn.items()}
        alone = dx.simulate(t_end=1.0, rtol=1e-8, times=[1.0], **one)
        assert many["theta"][row, 0] == pytest.approx(alone["theta"][0], rel=1e-9)
        assert many["omega"][row, 0] == pytest.approx(alone["omega"][0], rel=1e-8)


def fast(t, theta, omega):
    return 40.0 * np.sin(300.0 * theta)


def test_an_unusual_energy_residual_ends_the_message(monkeypatch):
    told = dx.simulate(t_end=1.0, rtol=1e-6, atol=1.0, **START, **ISSUE)
    assert told["energy_residual"] > 1e-3
    assert re.fullmatch(
        r"reached t_end = 1 s; energy_residual 0\.0\d+: repeat with rtol = 1e-08", told["message"]
    )
    assert told["status"] == 0
    load = dx.over_theta([0, 1, 2], [1.0, 2.0, 1.0], "linear")
    each = dx.simulate(
        t_end=0.2, rtol=1e-3, **START | {"torque": fast}, **ISSUE | {"F_Y": load, "ec": [0.0, 0.01]}
    )
    assert each["message"].endswith("in 2 of 2 designs: repeat with rtol = 1e-05")
    monkeypatch.setattr("desaxe.simulation.residual.TOLD", 0.1)
    some = designs(3, seed=4) | {"m_slider": [1.0, 2.0, np.nan]}
    many = dx.simulate(t_end=0.2, rtol=1e-3, method="DOP853", **some)
    assert many["status"].tolist() == [0, 0, 6]
    worst = f"{np.nanmax(many['energy_residual']):.2g}"
    ends = f"; energy_residual {worst} at most, in 2 of 3 designs: repeat with rtol = 0.01"
    assert many["message"].endswith(ends)


@pytest.mark.thorough
def test_a_usual_energy_residual_is_not_told():
    light = {"AB": 0.05, "BC": 0.2, "ec": 0.0, "m_slider": 1e5, "g_Y": -9.81, "m_crank": 1.0}
    drawn = designs(8, seed=4)
    for rtol in (1e-4, 1e-8, 1e-13):
        assert "energy" not in dx.simulate(t_end=1.0, rtol=rtol, times=[1.0], **drawn)["message"]
    swings = dx.simulate(t_end=0.1, theta0=np.pi - 1e-6, rtol=1e-13, torque=0.0, **light)
    assert swings["energy_residual"] > 1e-6
    assert "energy" not in swings["message"]  # nearly at rest: rounding of m g Y, not of what moves
