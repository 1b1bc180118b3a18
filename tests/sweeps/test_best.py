"""The best designs of a grid, without the grid."""

import numpy as np
import pytest
import xarray as xr

import desaxe as dx
from tests.ways import take_way

INPUTS = {
    "theta": np.linspace(0.0, 2.0 * np.pi, 61),
    "ec": np.linspace(-0.3, 0.3, 13),
    "AB": 0.125,
    "BC": np.linspace(0.2, 0.4, 5),
    "omega0": 157.08,
}
NAMES = ["V_C", "a_C"]


@pytest.fixture(autouse=True)
def _compiled(monkeypatch):
    take_way(monkeypatch, "compiled")


@pytest.fixture(scope="module")
def grid():
    return dx.grid(NAMES, **INPUTS)


@pytest.mark.parametrize(("by", "sign"), [("a_C", 1.0), (("min", "a_C"), -1.0), (("absmax", "a_C"), None)])
def test_they_are_those_of_the_whole_grid(grid, monkeypatch, by, sign):
    monkeypatch.setattr("desaxe.sweeps.layout.REDUCED", (400, 400))  # several chunks
    best = dx.sweep("V_C", best=7, by=by, **INPUTS)
    kind = by[0] if isinstance(by, tuple) else "max"
    compared = abs(grid["a_C"]) if sign is None else sign * grid["a_C"]
    every = compared.max("theta").values.reshape(-1)
    expected = np.sort(every[~np.isnan(every)])[::-1][:7]
    np.testing.assert_array_equal(best[f"a_C_{kind}"], expected if sign is None else sign * expected)
    for rank in range(7):
        there = {name: best[name].values[rank] for name in ("ec", "BC", "theta")}
        point = grid.sel(there)
        value = best[f"a_C_{kind}"].values[rank]
        assert float(abs(point["a_C"]) if sign is None else point["a_C"]) == value
        assert float(point["V_C"]) == best["V_C"].values[rank]
        angles = grid["a_C"].sel(ec=there["ec"], BC=there["BC"])
        assert best["feasible_fraction"].values[rank] == pytest.approx(float(np.isfinite(angles).mean()))
    assert float(best["feasible"]) == pytest.approx(float(np.isfinite(grid["a_C"]).mean()))
    assert best["rank"].values.tolist() == [1, 2, 3, 4, 5, 6, 7]
    assert best["a_C_" + kind].attrs["units"] == "m/s^2"


def test_by_a_reduction(grid):
    best = dx.sweep("V_C", best=3, by="V_C_mean", reduce={"theta": ["max", "mean"]}, **INPUTS)
    expected = np.sort(grid["V_C"].mean("theta").values.reshape(-1))[::-1][:3]
    np.testing.assert_allclose(best["V_C_mean"], expected, rtol=1e-9)


def test_points_are_designs_where_theta_is_a_number(grid, tmp_path):
    inputs = {**INPUTS, "theta": INPUTS["theta"][7]}
    best = dx.sweep(["V_C", "a_C"], best=4, by="V_C", store=tmp_path / "best.zarr", **inputs)
    flat = grid["V_C"].isel(theta=7).values.reshape(-1)
    np.testing.assert_array_equal(best["V_C"], np.sort(flat[~np.isnan(flat)])[::-1][:4])
    assert xr.open_zarr(tmp_path / "best.zarr").identical(best.assign_attrs(state="complete").chunk())
    with pytest.raises(FileExistsError, match="it is there already"):
        dx.sweep("V_C", best=4, by="V_C", store=tmp_path / "best.zarr", **inputs)


def test_fewer_designs_than_asked_for():
    best = dx.sweep("a_C", best=9, by="a_C", **{**INPUTS, "ec": [0.0, 0.9], "BC": 0.35})
    assert best.sizes["rank"] == 1
    assert best["ec"].values.tolist() == [0.0]
    assert float(best["feasible"]) == 0.5


@pytest.mark.parametrize(
    ("options", "error", "words"),
    [
        ({"best": 0, "by": "a_C"}, ValueError, "best = 0: a whole number, at least 1"),
        ({"best": 3}, TypeError, "best= and by= belong together"),
        ({"best": 3, "by": "a_D"}, ValueError, "a_D"),
        ({"best": 3, "by": ("rms", "a_C")}, ValueError, "'rms'.*allowed: max"),
        ({"best": 3, "by": 7}, TypeError, "by = 7: the name of a quantity"),
        ({}, TypeError, "store= is missing"),
    ],
)
def test_bad_requests_are_refused(options, error, words):
    with pytest.raises(error, match=words):
        dx.sweep("a_C", **INPUTS, **options)
