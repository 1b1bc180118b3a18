"""Loads that vary with the motion in lazy grids and sweeps: as in memory."""

import pickle
import subprocess
import sys

import numpy as np
import pytest

import desaxe as dx
from desaxe.sweeps.request import SweepRequest, sweep_of

ANGLES, POINTS = np.linspace(0.0, 2 * np.pi, 25), [-400.0, 200.0, -50.0, 20.0]
MACHINE = {"AB": 0.04, "BC": np.array([0.064, 0.07]), "m_slider": 0.8, "omega0": 50.0}
EC = np.linspace(0.0, 0.015, 5)
LOADS = {
    "linear": dx.over_theta([0.0, 1.0, 2.0, 4.0], POINTS, kind="linear"),
    "stroke": dx.over_Y([0.02, 0.05, 0.08, 0.1], POINTS, [0.0, 9.0, 9.0, 0.0]),
}


@pytest.mark.parametrize("kind", ["linear", pytest.param("stroke", marks=pytest.mark.thorough)])
def test_lazy_grids_and_stores_have_the_values_of_a_grid(kind, tmp_path):
    inputs = {"theta": ANGLES, "ec": EC, "F_Y": LOADS[kind], **MACHINE}
    names = ["T_in", "T_in_wrt_theta", "N_C_wrt_BC"]
    whole = dx.grid(names, **inputs)
    lazy = dx.grid(names, chunks={"theta": 7, "ec": 3}, **inputs)
    store = dx.sweep(names, store=tmp_path / "press.zarr", chunks={"theta": 10}, **inputs)
    for result in (lazy, store):
        for name in (*names, "status", "margin"):
            np.testing.assert_allclose(result[name], whole[name], rtol=1e-12, atol=1e-11, err_msg=name)
        assert result.attrs["loads"] == whole.attrs["loads"]
    other = LOADS[kind] is LOADS["linear"] and dx.over_theta(
        [0.0, 1.0, 2.0, 4.0], POINTS[::-1], kind="linear"
    )
    if other:
        with pytest.raises(FileExistsError, match="F_Y is <load over theta: 4 points, linear, -400 to 200>"):
            dx.sweep(names, store=tmp_path / "press.zarr", **{**inputs, "F_Y": other})
        again = dx.grid("T_in", chunks=-1, **{**inputs, "F_Y": other})
        assert again.T_in.data.name != lazy.T_in.data.name  # Dask knows them by their names


@pytest.mark.thorough
def test_what_travels_to_a_worker_needs_no_definitions_there(tmp_path):
    """Own quantities under a load: the steps of a sweep in a process that knows neither."""
    theta, name = ANGLES[1:-1], dx.define("shoe", "0.08 * abs(N_C * V_C)", unit="W")
    inputs = {"theta": theta, "ec": EC, "F_Y": LOADS["linear"], **MACHINE}
    try:
        made = sweep_of(SweepRequest(name, inputs, reduce={"theta": "p95"}, peaks=name))
        right = dx.grid(name, reduce={"theta": "p95"}, **inputs).shoe_p95.values
        designs = {"ec": EC[:, None], "F_Y": LOADS["linear"], **MACHINE}
        top = dx.peak(name, theta=(theta[0], theta[-1]), **designs)["value"]
        with pytest.raises(ValueError, match="peaks: each is of one design, and ec is reduced"):
            dx.sweep(name, reduce={("theta", "ec"): "p95"}, peaks=name, **inputs)
    finally:
        dx.undefine(name)
    (tmp_path / "parts").write_bytes(pickle.dumps((made.plan.all, made.plan.outer.columns)))
    code = """
import pickle, sys
steps, columns = pickle.load(open(sys.argv[1], "rb"))
found = {}
for step in steps:
    found |= step.compute({name: columns[name] for name in step.columns})
pickle.dump((found["shoe_p95"], found["peak_absmax_shoe"]), open(sys.argv[2], "wb"))
"""
    files = [str(tmp_path / file) for file in ("parts", "found")]
    subprocess.run([sys.executable, "-c", code, *files], timeout=120, check=True)
    p95, peaks = pickle.loads((tmp_path / "found").read_bytes())
    np.testing.assert_allclose(p95, right, rtol=1e-12)
    np.testing.assert_allclose(peaks, top, rtol=1e-12)
