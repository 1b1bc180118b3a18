"""Scenes whose values are swept into a store."""

import subprocess
import sys

import numpy as np
import pytest

import desaxe as dx
from desaxe.cli.command import main
from desaxe.scenes.schema import SceneError

SCENE = {
    "outputs": ["V_C"],
    "mechanism": {"AB": 0.125, "BC": [0.3, 0.35], "ec": {"start": -0.1, "stop": 0.1, "num": 5}},
    "motion": {"theta": {"start": 0, "stop": "360 deg", "num": 25}, "omega0": 157.08},
    "peak": [{"quantity": "a_C"}],
    "results": {"store": "press.zarr", "chunks": {"theta": 10}, "memory": "100 MB"},
}
TOML = """
outputs = ["V_C"]
[mechanism]
AB = 0.125
BC = [0.3, 0.35]
ec = { start = -0.1, stop = 0.1, num = 5 }
[motion]
theta = { start = 0, stop = "360 deg", num = 25 }
omega0 = 157.08
[[peak]]
quantity = "a_C"
"""


@pytest.fixture(autouse=True)
def _here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def test_a_run_sweeps_into_the_store(capsys):
    result = dx.scene(SCENE).run()
    grid = dx.grid("V_C", **{n: np.array(v) for n, v in dx.scene(SCENE).inputs.items()})
    np.testing.assert_allclose(result.dataset["V_C"], grid["V_C"], rtol=1e-12, atol=1e-12)
    assert result.dataset["V_C"].chunks[-1] == (10, 10, 5)
    own = result.peaks[0].dataset["value"]
    np.testing.assert_allclose(result.dataset["peak_absmax_a_C"].transpose(*own.dims), own, rtol=1e-9)
    assert "in the store press.zarr" in str(result)
    again = dx.sweep(SCENE)  # the store is finished
    np.testing.assert_array_equal(again["V_C"], result.dataset["V_C"])


def test_the_command(tmp_path, capsys):
    (tmp_path / "press.toml").write_text(TOML)
    assert (
        main(["sweep", "press.toml", "-o", "one.zarr", "--chunks", "theta=10,ec=2", "--netcdf", "one.nc"])
        == 0
    )
    shown = capsys.readouterr().out
    assert "250 points, 11 variables" in shown.splitlines()[0]
    assert "free" in shown.splitlines()[0]
    assert (tmp_path / "one.nc").is_file()
    assert main(["sweep", "press.toml"]) == 2
    assert "where to?" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("results", "words"),
    [
        ({"store": "a.zarr", "data": "a.nc"}, "give a store or a file"),
        ({"store": "a.zarr", "memory": "much"}, "results.memory = 'much'"),
        ({"store": "a.zarr", "chunks": {"AB": 3}}, "results.chunks: 'AB' is not a dimension"),
    ],
)
def test_bad_results_are_refused(results, words):
    with pytest.raises(SceneError, match=words):
        dx.scene({**SCENE, "results": results})


def test_peaks_of_other_designs_are_for_a_scene_of_their_own():
    with pytest.raises(SceneError, match=r"peak #1\.over\.ec: a sweep takes peaks"):
        dx.sweep({**SCENE, "peak": [{"quantity": "a_C", "over": {"ec": [0.0, 0.2]}}]}, store="b.zarr")
    with pytest.raises(TypeError, match="a scene has its own inputs"):
        dx.sweep(SCENE, store="b.zarr", theta=1.0)


@pytest.mark.thorough
def test_a_scene_without_a_store_needs_no_zarr():
    scene = {key: value for key, value in SCENE.items() if key != "results"}
    code = f"""import sys
sys.modules["zarr"] = None
import desaxe as dx
scene = dx.scene({scene!r})
dx.explain(scene), dx.compile(scene, "press.py")
assert scene.run().peaks[0].dataset["value"].size
try:
    dx.sweep(scene, store="press.zarr")
except ImportError as error:
    print(error)
"""
    run = subprocess.run([sys.executable, "-c", code], check=False, capture_output=True, text=True)
    assert run.stdout.strip().endswith("a sweep needs zarr: python -m pip install 'desaxe[zarr]'"), run.stderr
