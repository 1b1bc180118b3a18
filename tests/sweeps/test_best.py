"""The best designs of a grid, without the grid."""

import shutil
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import desaxe as dx
from desaxe.sweeps.kept import NAME, Kept
from desaxe.sweeps.ranking import BestDesigns, Ranking
from desaxe.sweeps.sweep import NotStoredError
from tests.effort import cases
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


@pytest.mark.parametrize(
    ("by", "order", "sign"),
    [
        ("a_C", "largest", 1.0),
        pytest.param(("min", "a_C"), None, -1.0, marks=pytest.mark.thorough),
        (("absmax", "a_C"), "largest", None),
    ],
)
def test_they_are_those_of_the_whole_grid(grid, monkeypatch, by, order, sign):
    monkeypatch.setattr("desaxe.sweeps.layout.REDUCED", (400, 400))  # several chunks
    best = dx.sweep("V_C", best=7, by=by, order=order, **INPUTS)
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


TAKEN = {
    "max": np.nanmax, "min": np.nanmin, "absmax": lambda rows, axis: np.nanmax(abs(rows), axis=axis),
    "mean": np.nanmean, "rms": lambda rows, axis: np.sqrt(np.nanmean(rows**2, axis=axis)), "std": np.nanstd,
    "median": np.nanmedian,
}  # fmt: skip


@pytest.mark.thorough
def test_either_end_of_every_kind_is_that_of_the_grid(monkeypatch):
    """Random designs, all of which turn, by NumPy's own reductions."""
    monkeypatch.setattr("desaxe.sweeps.layout.REDUCED", (400, 400))
    rng = np.random.default_rng(264)
    for _ in range(cases(1, 40)):
        inputs = {
            **INPUTS,
            "ec": np.sort(rng.uniform(-0.02, 0.02, 5)),
            "BC": np.sort(rng.uniform(0.3, 0.6, 4)),
        }
        rows = dx.grid("a_C", **inputs)["a_C"].transpose("ec", "BC", "theta").values.reshape(20, -1)
        for kind, taken in TAKEN.items():
            every = np.sort(taken(rows, axis=-1))
            for order, wanted in (("smallest", every), ("largest", every[::-1])):
                found = dx.sweep("a_C", best=6, by=(kind, "a_C"), order=order, **inputs)[f"a_C_{kind}"].values
                np.testing.assert_allclose(found, wanted[:6], rtol=1e-9)


@pytest.mark.parametrize("order", ["smallest", "largest"])
def test_either_end_of_a_magnitude_at_points(grid, order):
    inputs = {**INPUTS, "theta": INPUTS["theta"][7]}
    best = dx.sweep("a_C", best=4, by=("absmax", "a_C"), order=order, **inputs)
    sizes = abs(grid["a_C"].isel(theta=7).values.reshape(-1))
    wanted = np.sort(sizes[~np.isnan(sizes)])
    np.testing.assert_array_equal(abs(best["a_C"]), wanted[:4] if order == "smallest" else wanted[:-5:-1])


ASKED = [
    ({"by": "a_C"}, None),
    ({"by": ("max", "a_C")}, None),
    ({"by": ("absmax", "a_C")}, None),
    ({"by": ("rms", "a_C")}, None),
    ({"by": ("std", "a_C")}, None),
    ({"by": "a_C_rms", "reduce": {"theta": ["rms", "min"]}}, None),
    ({"by": "a_C", "reduce": {"theta": "min"}}, None),
    ({"by": ("min", "Y")}, "smallest"),
    ({"by": ("mean", "Y")}, "largest"),
    ({"by": "Y_mean", "reduce": {"theta": "mean"}}, "largest"),
]


@pytest.mark.parametrize(("options", "default"), ASKED)
def test_which_end_is_the_best_must_be_said(options, default):
    """But where the kind says it; a scene's `[results] order` says it, too."""
    if default is None:
        with pytest.raises(ValueError, match='give order="smallest" or order="largest"'):
            dx.sweep("a_C", best=3, **options, **INPUTS)
        return
    found = dx.sweep("Y", best=3, **options, **INPUTS)
    assert found.equals(dx.sweep("Y", best=3, **options, order=default, **INPUTS))
    assert not found.equals(dx.sweep("Y", best=3, **options, order=other(default), **INPUTS))


def other(order):
    return "largest" if order == "smallest" else "smallest"


@pytest.mark.parametrize("order", ["smallest", "largest"])
def test_a_scene_says_which_end_is_the_best(order):
    scene = {
        "outputs": ["a_C"],
        "results": {"order": order},
        "mechanism": {"ec": [0.0, 0.01, 0.3], "AB": 0.125, "BC": [0.3, 0.35]},
        "motion": {"theta": {"start": 0, "stop": "360 deg", "num": 61}, "omega0": 150},
    }
    found = dx.sweep(scene, best=2, by=("absmax", "a_C"))
    inputs = dx.scene(scene).inputs
    assert found.equals(dx.sweep("a_C", best=2, by=("absmax", "a_C"), order=order, **inputs))
    stated = dx.sweep(scene, best=2, by=("absmax", "a_C"), order=other(order))
    assert stated.equals(dx.sweep("a_C", best=2, by=("absmax", "a_C"), order=other(order), **inputs))
    with pytest.raises(ValueError, match=r'results\.order = "best": it must be "smallest" or "largest"'):
        dx.scene({**scene, "results": {"order": "best"}})


@pytest.mark.thorough
def test_by_a_reduction(grid):
    best = dx.sweep("V_C", best=3, by="V_C_mean", reduce={"theta": ["max", "mean"]}, **INPUTS)
    expected = np.sort(grid["V_C"].mean("theta").values.reshape(-1))[::-1][:3]
    np.testing.assert_allclose(best["V_C_mean"], expected, rtol=1e-9)


def test_points_are_designs_where_theta_is_a_number(grid, tmp_path):
    inputs = {**INPUTS, "theta": INPUTS["theta"][7]}
    root = tmp_path / "best.zarr"
    best = dx.sweep(["V_C", "a_C"], best=4, by="a_C", order="largest", store=root, **inputs)
    flat = grid["a_C"].isel(theta=7).values.reshape(-1)
    np.testing.assert_array_equal(best["a_C"], np.sort(flat[~np.isnan(flat)])[::-1][:4])
    assert xr.open_zarr(root).identical(best)
    assert best.attrs["state"] == "complete"
    before = {path: path.stat().st_mtime_ns for path in root.rglob("*")}
    assert dx.sweep(["V_C", "a_C"], best=4, by="a_C", order="largest", store=root, **inputs).identical(best)
    assert {path: path.stat().st_mtime_ns for path in root.rglob("*")} == before
    with pytest.raises(FileExistsError, match="best is 4 there and 5 here"):
        dx.sweep(["V_C", "a_C"], best=5, by="a_C", order="largest", store=root, **inputs)


def files(root):
    return {path.relative_to(root): path.read_bytes() for path in root.rglob("*") if path.is_file()}


def test_a_search_that_was_stopped_goes_on(tmp_path, monkeypatch):
    """The chunks that are done are not computed again, and the store has the same bytes."""
    monkeypatch.setattr("desaxe.sweeps.layout.REDUCED", (400, 400))
    whole, stopped = tmp_path / "whole.zarr", tmp_path / "stopped.zarr"
    dx.sweep(NAMES, best=5, by="a_C", order="largest", store=whole, threads=1, **INPUTS)
    take, begun = Ranking.take, []

    def stop(ranking, block, part, *rest):
        begun.append(part.place)
        if len(begun) == 5:
            raise KeyboardInterrupt
        return take(ranking, block, part, *rest)

    monkeypatch.setattr(Ranking, "take", stop)
    with pytest.raises(
        KeyboardInterrupt, match=r"stopped\.zarr: \d+ of [\d,]+ chunks are kept; the same sweep"
    ):
        dx.sweep(NAMES, best=5, by="a_C", order="largest", store=stopped, threads=1, **INPUTS)
    assert xr.open_zarr(stopped).attrs["state"] == "incomplete"
    first, begun[:] = begun[:2], range(5, 50)  # others may have been done at that moment
    dx.sweep(NAMES, best=5, by="a_C", order="largest", store=stopped, threads=1, **INPUTS)
    assert begun[45:]
    assert not set(first) & set(begun[45:])
    assert files(stopped) == files(whole)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["stopped.zarr", "whole.zarr"]


@pytest.mark.thorough
def test_a_finished_store_that_was_disturbed(tmp_path):
    """What is lost or damaged is made again, to the same bytes; changed metadata are refused by name."""
    whole, root = tmp_path / "whole.zarr", tmp_path / "again.zarr"
    how = {"best": 5, "by": ("absmax", "a_C"), "order": "smallest", **INPUTS}
    dx.sweep(NAMES, store=whole, **how).close()
    before = files(whole)
    places = [place for place in before if place != Path("zarr.json")]
    for place in places[:: cases(3, 1)]:
        data = before[place]
        disturbed = [None, b""] + ([] if place.name == "zarr.json" else [data[:-1] + b"x"])
        for other_data in disturbed:
            shutil.copytree(whole, root)
            (root / place).unlink() if other_data is None else (root / place).write_bytes(other_data)
            dx.sweep(NAMES, store=root, **how).close()
            assert files(root) == before, (place, other_data)
            shutil.rmtree(root)
    for place in ("zarr.json", "a_C_absmax/zarr.json"):
        shutil.copytree(whole, root)
        (root / place).write_bytes((root / place).read_bytes().replace(b'"m/s^2"', b'"mm/s^2"'))
        with pytest.raises(FileExistsError, match=r"again\.zarr: changed since .*a_C_absmax/zarr\.json"):
            dx.sweep(NAMES, store=root, **how)
        dx.sweep(NAMES, store=root, overwrite=True, **how).close()
        assert files(root) == before
        shutil.rmtree(root)


def test_a_damaged_state_is_not_used(tmp_path):
    kept = Kept(3, tmp_path)
    kept.add(1, BestDesigns(np.array([4]), np.array([2.0]), np.array([0.1]), np.array([0]), 7, 9))
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
        dx.sweep(NAMES, best=2, by="a_C", order="largest", store=tmp_path / "best.zarr", **INPUTS)
    assert raised.value.result.sizes["rank"] == 2


def test_fewer_designs_than_asked_for():
    best = dx.sweep("a_C", best=9, by="a_C", order="largest", **{**INPUTS, "ec": [0.0, 0.9]})
    assert best.sizes["rank"] == 5
    assert best["ec"].values.tolist() == [0.0] * 5
    assert float(best["feasible"]) == 0.5


@pytest.mark.parametrize(
    ("options", "error", "words"),
    [
        ({"best": 0, "by": "a_C"}, ValueError, "best = 0: a whole number, at least 1"),
        ({"best": 3}, TypeError, "best= and by= belong together"),
        ({"best": 3, "by": "a_D"}, ValueError, "a_D"),
        ({"best": 3, "by": ("rms", "a_C"), "theta": 1.0}, ValueError, "'rms'.*allowed: max"),
        ({"best": 3, "by": ("mode", "a_C")}, ValueError, "by: 'mode'.*allowed: max"),
        ({"best": 3, "by": "a_C", "order": "up"}, ValueError, "order = 'up': it is \"smallest\" or"),
        ({"order": "smallest"}, TypeError, "order= belongs to best= and by="),
        ({"best": 3, "by": 7}, TypeError, "by = 7: the name of a quantity"),
        ({}, TypeError, "store= is missing"),
    ],
)
def test_bad_requests_are_refused(options, error, words):
    with pytest.raises(error, match=words):
        dx.sweep("a_C", **{**INPUTS, **options})


def test_a_quantity_of_the_design_is_ranked_over_all_designs():
    """The sign of a speed decides the time ratio, not which axes a design has."""
    axes = {"ec": [0.0, 0.02, 0.04], "omega0": [2.0, -3.0]}
    whole = dx.grid("advance_angle", AB=0.1, BC=0.3, **axes)
    found = dx.sweep("Y", best=2, by="advance_angle", order="largest", theta=1.0, AB=0.1, BC=0.3, **axes)
    assert found.advance_angle.values == pytest.approx(np.sort(whole.advance_angle.values.ravel())[::-1][:2])
    assert set(found.coords) >= {"ec", "omega0"}
