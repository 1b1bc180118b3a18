"""Definitions in scenes and stored results, and where they travel."""

import json
import pickle
import subprocess
import sys

import numpy as np
import pytest

import desaxe as dx
from desaxe.definitions.tables import read_definitions
from desaxe.mechanism.own import definitions, using

TABLES = {
    "of_both": {"expression": "2 * shoe + 0 * power_in"},
    "shoe": {"expression": "f * abs(N_C * V_C)", "unit": "W", "meaning": "lost", "constants": {"f": 0.08}},
}
SCENE = {
    "outputs": ["of_both", "shoe_wrt_ec"],
    "mechanism": {"AB": 0.125, "BC": 0.35, "ec": [0.0, 0.01]},
    "motion": {"theta": [0.5, 1.0, 1.5], "omega0": 150.0},
    "masses": {"m_slider": 0.8},
    "quantities": TABLES,
}
POINT = {"theta": 1.0, "ec": 0.01, "AB": 0.125, "BC": 0.35, "omega0": 150.0, "m_slider": 0.8}


@pytest.fixture(autouse=True)
def forget():
    yield
    for name in ("of_both", "shoe"):
        if name in definitions():
            dx.undefine(name)


def test_a_scene_defines_its_quantities(tmp_path):
    scene = dx.scene(SCENE)
    data = scene.run().dataset
    result = dx.evaluate(["N_C", "V_C", "of_both"], **POINT)
    assert result["of_both"] == pytest.approx(0.16 * abs(result["N_C"] * result["V_C"]), rel=1e-14)
    assert float(data.of_both.sel(ec=0.01, theta=1.0)) == pytest.approx(result["of_both"], rel=1e-14)
    assert json.loads(data.attrs["quantities"])["shoe"]["constants"] == {"f": 0.08}
    dx.define("shoe", "abs(N_C * V_C)")  # the scene keeps its own
    assert np.array_equal(scene.run().dataset.of_both, data.of_both)
    assert dx.evaluate("shoe", **POINT) == pytest.approx(result["of_both"] / 0.16, rel=1e-14)


def test_a_pickled_scene_brings_its_quantities_with_it(tmp_path):
    scene = dx.scene(SCENE)
    (tmp_path / "scene").write_bytes(pickle.dumps(scene))
    code = "import pickle, sys; scene = pickle.load(open(sys.argv[1], 'rb')); import desaxe as dx;"
    command = [sys.executable, "-c", f"{code} print(dx.evaluate('of_both', **{POINT}))", tmp_path / "scene"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert float(done.stdout) == dx.evaluate("of_both", **POINT)


def test_a_pickled_function_brings_its_quantities_with_it(tmp_path):
    dx.define("shoe", "0.08 * abs(N_C * V_C)")
    fixed = {p: value for p, value in POINT.items() if p != "theta"}
    prepared = dx.function("shoe", ("theta",), **fixed)
    data = pickle.dumps(prepared)
    value = prepared(1.0)
    dx.undefine("shoe")
    assert pickle.loads(data)(1.0) == value
    dx.define("shoe", "abs(N_C * V_C)")
    assert pickle.loads(data)(1.0) == value  # it has its own
    assert dx.evaluate("shoe", **POINT) == pytest.approx(value / 0.08, rel=1e-14)


@pytest.mark.thorough
def test_a_compiled_module_has_them(tmp_path):
    dx.compile(SCENE, tmp_path / "own_kernels.py")
    code = "import own_kernels, sys; print(own_kernels.point(1.0, 0.01)[0], 'desaxe' in sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=tmp_path
    )
    value, loaded = done.stdout.split()
    assert float(value) == pytest.approx(dx.evaluate("of_both", **POINT), rel=1e-14)
    assert loaded == "False"


def test_definitions_for_a_while():
    made = read_definitions(TABLES)
    before = definitions()
    with using(made):
        assert "shoe" in dx.quantities()
    assert definitions() == before


@pytest.mark.parametrize(
    ("tables", "problem"),
    [
        ({"x": {"expression": "y"}, "y": {"expression": "x"}}, "unknown name 'y'"),
        ({"x": {"expression": "V_C +"}}, "too early"),
        ({"x": {"text": "V_C"}}, "x.text = .*unknown key"),
        ({"x": {"unit": "W"}}, "x.*expression"),
        ({"x": 3}, "x = 3.*table"),
        ({"x": {"expression": "V_C", "constants": 3}}, "x.constants = 3.*table of constants"),
        ({"V_C": {"expression": "2 * V_C"}}, "quantity of desaxe already"),
        ({"x": {"expression": "V_C", "meaning": "</script>"}}, "one line"),
    ],
)
def test_wrong_tables(tables, problem):
    with pytest.raises(ValueError, match=f"quantities.*{problem}"):
        dx.scene(SCENE | {"quantities": tables, "outputs": ["V_C"]})
