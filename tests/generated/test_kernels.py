"""The committed kernels: self-contained modules that give what `desaxe.evaluate` gives."""

import inspect
import random
from importlib import import_module
from math import inf, nan, nextafter

import numpy as np
import pytest
from desaxe.derive.groups import GROUPS
from desaxe.generated.program import law

import desaxe as dx
from desaxe.mechanism.constants import constants
from desaxe.mechanism.program import _text
from tests.compiler.programs import LINKS, LOADS

NAMES = [group.name for group in GROUPS]
OUTPUTS = {group.name: group.outputs for group in GROUPS}
INPUTS = ("theta", "ec", "AB", "BC", "omega0", "alpha")


def evaluate(group, **inputs):
    """The function of a group; what it does not take is left out."""
    function = import_module(f"desaxe.generated.{group}").evaluate
    taken = inspect.signature(function).parameters
    return function(**{name: value for name, value in inputs.items() if name in taken})


def points(count, seed=7):
    """Random points: mechanisms that turn fully, and a few that cannot be assembled at all."""
    rng = np.random.default_rng(seed)
    BC = rng.uniform(0.2, 1.0, count)
    columns = {
        "theta": rng.uniform(-9, 9, count),
        "ec": BC * rng.uniform(-0.3, 0.3, count),
        "AB": BC * rng.uniform(0.05, 0.5, count),
        "BC": BC,
        "omega0": rng.choice([-1, 1], count) * rng.uniform(50, 200, count),
        "alpha": rng.uniform(-50, 50, count),
        **{name: rng.uniform(0.1, 2.0, count) for name in ("m_crank", "m_rod", "m_slider")},
        **{name: rng.uniform(0.001, 0.1, count) for name in ("I_crank", "I_rod")},
        **{name: rng.uniform(-50, 50, count) for name in ("F_X", "F_Y", "g_X", "g_Y")},
        **{"r_crank": BC * rng.uniform(-0.2, 0.5, count), "r_rod": BC * rng.uniform(0, 1, count)},
        "mu": rng.uniform(0, 0.3, count),
    }
    columns["ec"][::7] = 2 * BC[::7]
    return columns


BAD = [("theta", nan), ("ec", inf), ("AB", -0.1), ("BC", -0.35), ("BC", 0.0), ("BC", inf), ("omega0", nan), ("alpha", -inf)]


@pytest.mark.parametrize("group", NAMES)
@pytest.mark.parametrize("branch", [1, pytest.param(-1, marks=pytest.mark.thorough)])
def test_a_kernel_gives_what_evaluate_gives(group, branch):
    """Where there is nothing to give, too: NaN, and the same status."""
    columns, taken = points(60), inspect.signature(import_module(f"desaxe.generated.{group}").evaluate).parameters
    for place, (name, value) in enumerate(BAD):
        columns[name][10 + place] = value
    columns = {name: column for name, column in columns.items() if name in taken}
    found = evaluate(group, **columns, branch=branch)
    wanted = dx.evaluate(list(OUTPUTS[group]), **columns, branch=branch)
    for name in OUTPUTS[group]:
        assert np.isnan(wanted[name]).any() or found[name].dtype == np.int8
        scale = np.nanmax(np.abs(wanted[name]))
        np.testing.assert_allclose(found[name], wanted[name], rtol=1e-11, atol=1e-13 * scale, err_msg=name)


@pytest.mark.parametrize("group", NAMES)
def test_it_broadcasts(group):
    columns = points(5)
    grid = {name: values[:, None] for name, values in columns.items()} | {"theta": np.array([0.1, 0.2, 0.3])}
    found = evaluate(group, **grid)
    for column, theta in enumerate(grid["theta"]):
        row = evaluate(group, **columns | {"theta": float(theta)})
        assert {name: values.shape for name, values in found.items()} == dict.fromkeys(OUTPUTS[group], (5, 3))
        assert all(np.array_equal(found[name][:, column], row[name], equal_nan=True) for name in row)


@pytest.mark.parametrize("group", NAMES)
def test_its_outputs_are_those_of_the_group(group):
    assert OUTPUTS[group] == import_module(f"desaxe.generated.{group}").OUTPUTS


@pytest.mark.parametrize("group", NAMES)
def test_an_angle_beyond_the_written_out_sine_is_nan(group):
    limit = constants().limit
    theta = np.array([limit, nextafter(limit, inf), -2 * limit])
    centres = {"r_crank": 0.06, "r_rod": 0.2}
    found = evaluate(group, theta=theta, ec=0.0, AB=0.125, BC=0.35, omega0=10.0, alpha=0.0, **centres)
    first = OUTPUTS[group][0]
    assert np.isnan(found[first]).tolist() == [False, True, True]


@pytest.mark.parametrize("group", NAMES)
def test_numbers_and_integers_are_taken(group):
    point = {"theta": 1, "ec": 0, "AB": 1, "BC": 3, "omega0": 2, "alpha": 0, "m_rod": 5, "r_crank": 0, "r_rod": 2}
    found = evaluate(group, **point)
    wanted = evaluate(group, **{name: float(value) for name, value in point.items()})
    assert all(found[name].shape == () and found[name] == wanted[name] for name in OUTPUTS[group])


def feasible_points(count):
    rng = random.Random("law")
    for _ in range(count):
        BC, speed = rng.uniform(0.2, 1.0), rng.choice([-1, 1]) * rng.uniform(50, 200)
        values = rng.uniform(-9, 9), BC * rng.uniform(-0.3, 0.3), BC * rng.uniform(0.05, 0.6), BC, speed
        yield dict(zip(INPUTS, (*values, rng.choice([0.0, rng.uniform(-50, 50)])), strict=True))


@pytest.mark.parametrize("branch", [1, -1])
def test_the_text_itself_runs_as_python(branch):
    names = _text("program").outputs()
    public = list(dx.quantities())
    for point in feasible_points(25):
        found = dict(zip(names, law(**point, **LINKS, **LOADS, branch=float(branch)), strict=True))
        found["status"] = found["force_status"]
        wanted = dx.evaluate(public, **point, **LINKS, **LOADS, branch=branch)
        assert {name: found[name] for name in public} == wanted
