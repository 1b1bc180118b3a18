"""Names under loads by one kernel: tables are its arguments, and a point has what it has alone.

A point alone is in plain Python.
"""

import numpy as np
import pytest

import desaxe as dx
from desaxe.evaluation.points import outer_of, points_of
from tests.effort import cases

MACHINE = {"AB": 0.1, "BC": 0.35, "omega0": 30.0, "m_slider": 2.0, "m_rod": 1.0}
AXES = {"theta": np.linspace(0.0, 2.0 * np.pi, 61), "ec": np.linspace(-0.05, 0.05, 41)}
NAMES = ["T_in", "T_in_wrt_ec", "T_in_wrt_theta", "status"]
POSITIONS, DISTANCES = [0.27, 0.33, 0.40], [0.0, 0.008, 0.1]
OUT, BACK = [0.0, -100.0, -400.0], [0.0, -10.0, -50.0]
EVEN = np.linspace(0.0, 6.2, 40)
thorough = pytest.mark.thorough
LOADS = {
    "steps over Y, both ways": dx.over_Y(POSITIONS, OUT, BACK, kind="step"),
    "steps over the stroke": dx.over_stroke(DISTANCES, OUT, kind="step", dead_centre="inner"),
    "a jump given twice": dx.over_stroke([0.0, 0.008, 0.008], [-80.0, -80.0, 0.0], dead_centre="outer"),
    "lines over Y": dx.over_Y(POSITIONS, OUT, kind="linear"),
    "forty lines over Y": dx.over_Y(0.25 + 0.2 * (EVEN / 6.2) ** 2, 100.0 * np.sin(EVEN)),
    "even cubics over theta": dx.over_theta(EVEN, 100.0 * np.sin(EVEN)),
    "uneven steps over theta": dx.over_theta(EVEN**2 / 6.2, 100.0 * np.cos(EVEN), kind="step"),
    "a function": dx.over_theta(
        lambda theta: np.cos(np.nan_to_num(theta)), lambda theta: -np.sin(np.nan_to_num(theta))
    ),
}
FIRST = "steps over Y, both ways"
CASES = [pytest.param(name, marks=() if name == FIRST else thorough) for name in LOADS]


def alone(names, load, **inputs):
    """The values at points, one after the other."""
    columns = np.broadcast_arrays(*inputs.values())
    rows = [
        dict(zip(inputs, map(float, row), strict=True)) for row in zip(*map(np.ravel, columns), strict=True)
    ]
    machine = {name: value for name, value in MACHINE.items() if name not in inputs}
    result = [dx.evaluate(names, **row, **machine, F_Y=load) for row in rows]
    return {name: np.reshape([one[name] for one in result], columns[0].shape) for name in names}


def assert_same(result, expected):
    for name in expected:
        scale = np.nanmax(np.abs(expected[name]), initial=0.0)
        np.testing.assert_allclose(result[name], expected[name], rtol=1e-11, atol=1e-13 * scale, err_msg=name)


def test_a_key_has_the_kind_of_a_load_and_not_its_content():
    def key(load):
        outer = outer_of(["T_in"], {**MACHINE, **AXES, "F_Y": load}, 1, None, always=False)
        return points_of(outer.names, outer, outer.dimensions, 1, "standard").key

    one = dx.over_Y([0.3, 0.33, 0.4], [0.0, -100.0, -400.0], kind="step")
    other = dx.over_Y([0.27, 0.3, 0.33, 0.4], [0.0, -10.0, 3.0, -40.0], kind="step")
    both_ways = dx.over_Y([0.3, 0.4], [0.0, -100.0], [0.0, 10.0])
    keys = [key(load) for load in (one, other, both_ways)]
    assert keys[0] == keys[1] != keys[2]
    assert key(-300.0).form.under is None


@pytest.mark.sampled
@pytest.mark.parametrize("name", CASES)
def test_arrays_have_the_values_of_points_alone(name):
    """In every shape, next to change points, at large and bad angles; in parts as in one call."""
    load, rng = LOADS[name], np.random.default_rng(5)
    for _ in range(cases(1, 2, 100)):
        theta = np.append(rng.uniform(-20.0, 20.0, 60), [0.0, np.pi, 2.0 * np.pi])
        close = 0.25 - 10.0 ** -rng.uniform(3.0, 12.0)  # AB + |ec| < BC by so much less
        for ec in (rng.uniform(-0.05, 0.05), close, np.append(rng.uniform(-0.05, 0.05, 62), close)):
            result = dx.evaluate(NAMES, theta=theta, ec=ec, F_Y=load, **MACHINE)
            assert_same(result, alone(NAMES, load, theta=theta, ec=ec))
            halves = [
                dx.evaluate(NAMES, theta=t, ec=ec if np.ndim(ec) == 0 else ec[s], F_Y=load, **MACHINE)
                for t, s in ((theta[:31], slice(31)), (theta[31:], slice(31, None)))
            ]
            for key in NAMES:
                np.testing.assert_array_equal(np.concatenate([half[key] for half in halves]), result[key])
    bad = dx.evaluate(NAMES, theta=[1.0, np.nan, np.inf], ec=0.01, F_Y=load, **MACHINE)
    assert bad["status"].tolist() == [0, 4, 4]
    out = np.empty((3, 5))
    ec = np.array([-0.05, 0.0, 0.5, 0.0, 0.01])
    assert dx.evaluate("T_in", theta=AXES["theta"][:3, None], ec=ec, F_Y=load, out=out, **MACHINE) is out
    assert np.isnan(out[:, 2]).all()
    assert_same({"T_in": out}, alone(["T_in"], load, theta=AXES["theta"][:3, None], ec=ec))
