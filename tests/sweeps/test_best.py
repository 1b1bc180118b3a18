"""The best designs of a grid, without the grid."""

import numpy as np
import pytest
import xarray as xr

import desaxe as dx
from desaxe.sweeps import best
from desaxe.sweeps.kept import NAME, Found, Kept
from desaxe.sweeps.sweep import NotStoredError
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


@pytest.mark.thorough
def test_by_a_reduction(grid):
    best = dx.sweep("V_C", best=3, by="V_C_mean", reduce={"theta": ["max", "mean"]}, **INPUTS)
    expected = np.sort(grid["V_C"].mean("theta").values.reshape(-1))[::-1][:3]
    np.testing.assert_allclose(best["V_C_mean"], expected, rtol=1e-9)


def test_points_are_designs_where_theta_is_a_number(grid, tmp_path):
    inputs = {**INPUTS, "theta": INPUTS["theta"][7]}
    root = tmp_path / "best.zarr"
    best = dx.sweep(["V_C", "a_C"], best=4, by="V_C", store=root, **inputs)
    flat = grid["V_C"].isel(theta=7).values.reshape(-1)
    np.testing.assert_array_equal(best["V_C"], np.sort(flat[~np.isnan(flat)])[::-1][:4])
    assert xr.open_zarr(root).identical(best)
    assert best.attrs["state"] == "complete"
    before = {path: path.stat().st_mtime_ns for path in root.rglob("*")}
    assert dx.sweep(["V_C", "a_C"], best=4, by="V_C", store=root, **inputs).identical(best)
    assert {path: path.stat().st_mtime_ns for path in root.rglob("*")} == before
    with pytest.raises(FileExistsError, match="best is 4 there and 5 here"):
        dx.sweep(["V_C", "a_C"], best=5, by="V_C", store=root, **inputs)


def files(root):
    return {path.relative_to(root): path.read_bytes() for path in root.rglob("*") if path.is_file()}


def test_a_search_that_was_stopped_goes_on(tmp_path, monkeypatch):
    """The chunks that are done are not computed again, and the store has the same bytes."""
    monkeypatch.setattr("desaxe.sweeps.layout.REDUCED", (400, 400))
    whole, stopped = tmp_path / "whole.zarr", tmp_path / "stopped.zarr"
    dx.sweep(NAMES, best=5, by="a_C", store=whole, threads=1, **INPUTS)
    block, begun = best._best_of_block, []

    def stop(task):
        begun.append(task.number)
        if len(begun) == 5:
            raise KeyboardInterrupt
        return block(task)

    monkeypatch.setattr(best, "_best_of_block", stop)
    with pytest.raises(KeyboardInterrupt):
        dx.sweep(NAMES, best=5, by="a_C", store=stopped, threads=1, **INPUTS)
    assert xr.open_zarr(stopped).attrs["state"] == "incomplete"
    first, begun[:] = begun[:2], range(5, 50)  # others may have been done at that moment
    dx.sweep(NAMES, best=5, by="a_C", store=stopped, threads=1, **INPUTS)
    assert begun[45:]
    assert not set(first) & set(begun[45:])
    assert files(stopped) == files(whole)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["stopped.zarr", "whole.zarr"]


def test_a_damaged_state_is_not_used(tmp_path):
    kept = Kept(3, tmp_path)
    kept.add(1, Found(np.array([4]), np.array([2.0]), np.array([0.1]), np.array([0]), 7, 9))
    kept.close()
    assert Kept(3, tmp_path).done.tolist() == [False, True, False]
    assert Kept(3, tmp_path).points == 9
    assert Kept(4, tmp_path).points == 0
    path = tmp_path / NAME
    path.write_bytes(path.read_bytes()[:-1] + b"x")
    assert Kept(3, tmp_path).points == 0


def test_what_cannot_be_stored_is_not_lost(tmp_path, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("desaxe.sweeps.store.write_whole", full)
    with pytest.raises(NotStoredError, match=r"best\.zarr: not written: No space") as raised:
        dx.sweep(NAMES, best=2, by="a_C", store=tmp_path / "best.zarr", **INPUTS)
    assert raised.value.result.sizes["rank"] == 2


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
