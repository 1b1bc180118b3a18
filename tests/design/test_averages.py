"""Averages over the turn, values at an angle and functions as measures of designs."""

import numpy as np
import pytest

import desaxe as dx
from desaxe.design.measures import checked, measured

MACHINE = {"AB": 0.125, "BC": 0.35, "omega0": 150.0, "m_slider": 0.8, "m_rod": 0.5}
MEASURES = [
    ("rms", "T_in"),
    ("at", "60 deg", "a_C"),
    *(pytest.param(m, marks=pytest.mark.thorough) for m in (("mean", "power_in"), ("rms", "F_B"))),
]


@pytest.mark.parametrize("measure", MEASURES, ids=str)
def test_values_and_derivatives(measure):
    ec = np.array([0.0, 0.03, 0.1])
    found = measured([checked(measure)], {**MACHINE, "ec": ec})[checked(measure)]
    theta = np.linspace(0, 2 * np.pi, 4096, endpoint=False) if measure[0] != "at" else np.array([np.pi / 3])
    values = dx.evaluate(measure[-1], theta=theta, ec=ec[:, None], **MACHINE)
    wanted = np.sqrt((values**2).mean(1)) if measure[0] == "rms" else values.mean(1)
    scale = np.abs(values).max()
    assert np.allclose(found.value, wanted, rtol=1e-11, atol=1e-11 * scale)
    step = 1e-6
    sides = [measured([checked(measure)], {**MACHINE, "ec": ec + s})[checked(measure)] for s in (-step, step)]
    slope = (sides[1].value - sides[0].value) / (2 * step)
    assert np.allclose(found.gradient["ec"], slope, rtol=1e-6, atol=1e-6 * scale)


def test_optimize_takes_them_and_functions():
    over, keep = {"ec": (0.0, 0.1)}, {"stroke": (0.25, 0.26)}
    best = dx.optimize(minimize=("rms", "T_in"), over=over, keep=keep, **MACHINE)
    assert best["status"] == 0
    trial = np.linspace(0.0, 0.1, 41)
    others = measured([("rms", "T_in"), "stroke"], {**MACHINE, "ec": trial})
    allowed = (others["stroke"].value >= 0.25) & (others["stroke"].value <= 0.26)
    assert best["value"] <= others[("rms", "T_in")].value[allowed].min() * (1 + 1e-9)

    def parabola(design):
        return (design["ec"] - 0.04) ** 2, {"ec": 2 * (design["ec"] - 0.04)}

    assert dx.optimize(minimize=parabola, over=over, **MACHINE)["ec"] == pytest.approx(0.04, abs=1e-7)
    own = dx.define("loss", "abs(N_C * V_C)")
    try:
        best = dx.optimize(minimize=("mean", own), over={"ec": (0.0, 0.1)}, **MACHINE)
        assert 0.0 <= best["ec"] <= 0.1
        assert best["value"] > 0
    finally:
        dx.undefine(own)
