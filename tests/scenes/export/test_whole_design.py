"""Quantities of a whole design in modules of every language, against the raw triangle at 60 digits."""

import math
import random
from functools import cache

import numpy as np
import pytest

import desaxe as dx
from desaxe.mechanism.closed.dead_centres import SENSITIVITIES
from desaxe.mechanism.names import LENGTHS, WHOLE
from tests.compiler.languages.runners import RUNNERS, SLOW, compiled
from tests.compiler.languages.tools import es_module, imported, jax_in_doubles
from tests.effort import cases, first
from tests.mechanism.closed.test_closed_forms import check
from tests.mechanism.closed.truth import design, truths

NAMES = (*WHOLE, *SENSITIVITIES)
OTHER = {"advance_angle": "return_angle", "return_angle": "advance_angle"}
TWO = [0.1, 0.2]


def scene(names, way=1, branch=1, **axes):
    """A scene in which the lengths are left open, with the crank turning one way."""
    lengths = {name: axes.pop(name, TWO) for name in LENGTHS}
    motion = {"omega0": 2.0 * way, **axes}
    return {"outputs": list(names), "mechanism": {**lengths, "branch": branch}, "motion": motion}


@cache
def known(branch, number=None):
    """Random designs and border ones, with what is known of each."""
    rng = random.Random(f"whole design {branch}")
    rows = [design(rng)[:3] for _ in range(number or cases(60, 1_000, 50_000))]
    return rows, [truths(*row, branch) for row in rows]


def is_taken(row):
    """True for lengths in the range of `evaluate`."""
    return all(abs(length) <= 1e60 for length in row) and row[-1] >= 1e-60


def confirm(result, branch, way, least=0.0, taken=lambda row: True):
    """Every value keeps the promise; turning backwards, advance and return change places.

    least   smaller ones may be 0, as of XLA, which has no subnormal numbers
    """
    rows, exact = known(branch)
    for name in NAMES:
        base, *by = name.split("_wrt_")
        own = "_wrt_".join([OTHER.get(base, base) if way < 0 else base, *by])
        for row, value, there in zip(rows, np.asarray(result[name]).tolist(), exact, strict=True):
            if not taken(row):
                assert math.isnan(value)
                continue
            exact_value = there.get(own, (None,))[0]
            if not (value == 0.0 and exact_value is not None and abs(exact_value) < least):
                check(own, value, there, row)


def columns(branch):
    return [np.array(column) for column in zip(*known(branch)[0], strict=True)]


@pytest.mark.sampled
@pytest.mark.parametrize(("branch", "way"), [(1, -1), (-1, 1)])
@pytest.mark.parametrize(
    "language", [pytest.param(name, marks=pytest.mark.thorough if name in SLOW else ()) for name in RUNNERS]
)
def test_every_language_keeps_the_promise(language, branch, way, tmp_path):
    least = np.finfo(float).tiny if language == "jax" else 0.0
    module = compiled(language, tmp_path, scene(NAMES, way, branch), LENGTHS)
    confirm(module(columns(branch)), branch, way, least)


@pytest.mark.sampled
@pytest.mark.parametrize(("branch", "way"), [(1, 1), (-1, -1)])
def test_arrays_and_numbers_of_evaluate_do(branch, way):
    given = dict(zip(LENGTHS, columns(branch), strict=True))
    confirm(dx.evaluate(NAMES, **given, omega0=2.0 * way, branch=branch), branch, way, taken=is_taken)
    rows = [dict(zip(LENGTHS, row, strict=True)) if is_taken(row) else None for row in known(branch)[0]]
    assert sum(map(bool, rows)) > len(rows) / 4
    nothing = dict.fromkeys(NAMES, math.nan)
    points = [(row and dx.evaluate(NAMES, **row, omega0=2.0 * way, branch=branch)) or nothing for row in rows]
    confirm({name: [point[name] for point in points] for name in NAMES}, branch, way, taken=is_taken)


# ---- what they take, and the dimensions that they have ---------------------------------------------


@pytest.mark.thorough
def test_their_functions_take_lengths_alone(tmp_path):
    written = scene(["V_C", "stroke", "margin"], theta=[0.0, 1.0], AB=1.0)
    given = {"ec": 0.1, "BC": 3.0}
    value = dx.evaluate("stroke", AB=1.0, **given)
    module = imported(dx.compile(written, tmp_path / "press_both.py"))
    assert module.stroke(0.1, 3.0) == module.stroke(**given) == value
    assert module.margin(**given) == pytest.approx(1.9)
    place = dx.compile(written, tmp_path / "press.js", to="javascript")
    assert es_module(place, [["stroke", 0.1, 3.0]]) == [value]
    with jax_in_doubles():
        import jax

        module = imported(dx.compile(written, tmp_path / "press_both_jax.py", to="jax"))
        assert float(module.stroke(**given)) == pytest.approx(value, rel=1e-15)
        slope = dx.evaluate("stroke_wrt_ec", AB=1.0, **given)
        assert float(jax.grad(module.stroke)(0.1, 3.0)) == pytest.approx(slope, rel=1e-14)


@pytest.mark.thorough
def test_a_run_has_the_dimensions_of_a_grid(tmp_path):
    axes = {"ec": [0.0, 0.1, 5.0], "AB": [1.0, 1.5], "BC": 3.0, "theta": [0.0, 1.0, 2.0, 3.0]}
    names = ["V_C", "stroke", "return_angle", "margin"]
    module = imported(dx.compile(scene(names, **axes), tmp_path / "press_run.py"))
    expected = dx.scene(scene(names, **axes)).run().dataset
    result = module.run()
    for name in names:
        assert result[name].shape == expected[name].shape
        np.testing.assert_allclose(result[name], expected[name], rtol=1e-14)
    empty = module.run(theta=[])
    assert empty["stroke"].shape == (3, 2)
    assert empty["V_C"].shape[-1] == 0


@pytest.mark.parametrize("speeds", first(1, [[-1.0, 2.0], [1.0, 2.0]]))
def test_a_speed_left_open_keeps_its_sign_open(speeds, tmp_path):
    axes = {"ec": [0.0, 0.1], "AB": 1.0, "BC": 3.0, "omega0": speeds}
    module = imported(dx.compile(scene(["advance_angle", "stroke"], **axes), tmp_path / "press_way.py"))
    events = dx.events(ec=0.1, AB=1.0, BC=3.0, omega0=-7.0)
    assert module.advance_angle(0.1, -7.0) == events["advance_angle"]
    result = module.run()
    assert result["advance_angle"].shape == (2, 2)
    assert result["stroke"].shape == (2,)


@pytest.mark.parametrize("outputs", [["stroke"], ["margin", "theta_outer"], ["advance_angle", "status"]])
def test_a_scene_of_whole_designs_needs_no_angle(outputs):
    written = {"outputs": outputs, "mechanism": {"ec": [0.0, 0.1, 2.5], "AB": 1.0, "BC": 3.0}}
    result = dx.scene(written).run().dataset
    events = dx.events(ec=np.array([0.0, 0.1, 2.5]), AB=1.0, BC=3.0)
    assert result.sizes == {"ec": 3}
    np.testing.assert_array_equal(result.status, events["status"])
    for name in set(outputs) - {"status", "margin"}:
        np.testing.assert_allclose(result[name], events[name], rtol=1e-14)
    assert [axis["name"] for axis in dx.explain(written)["axes"]] == ["ec"]
    assert math.isclose(dx.explain(written)["points"], 3)


@pytest.mark.thorough
def test_a_reduction_under_a_load_that_has_no_say(tmp_path):
    """A stroke has no load, so its kernel is that of numbers alone, reduced."""
    text = scene(["stroke"], ec=[0.0, 0.01, 0.02], AB=0.2, BC=[0.5, 0.6])
    load = dx.over_theta([0.0, 1.0, 2.0], [-400.0, 200.0, -50.0], kind="linear")
    read = dx.scene({**text, "reduce": {"ec": "max"}, "loads": {"F_Y": load}})
    result = imported(dx.compile(read, tmp_path / "press.py")).run()
    np.testing.assert_array_equal(result["stroke_max"], read.run().dataset.stroke_max)
