"""A plan cut into blocks: each block has the digits of the whole, under loads and in reductions too."""

import tracemalloc

import numpy as np
import pytest

import desaxe as dx
from tests.ways import bits

# One angle is beyond what a kernel's own sine reduces: all blocks then take another kernel, or none.
FAR = {"theta": [0.1, 1.0, 1e9, 2.0, 1e12, 3.0], "ec": [0.0, 0.01, 0.02], "AB": 0.1, "BC": [0.3, 0.4]}
TURN, LAST = np.linspace(0.0, 2.0 * np.pi, 65), np.arcsin(0.75)
# At LAST the rod of the first of these designs just reaches; the last of them have no value.
ANGLES = np.concatenate([TURN, LAST + np.arange(-3, 4) * np.spacing(LAST)])
EDGE = {"theta": ANGLES, "ec": [-0.05, 0.0, 0.02, 0.9], "AB": 0.2, "BC": [0.1, 0.5, 0.2]}
MASSES = {"m_slider": 0.8, "omega0": 5.0}
POINTS = [0.0, 1.0, 2.0, 4.0], [-400.0, 200.0, -50.0, 20.0]
CUTS = [{"theta": 1, "ec": 2}, {"theta": 5, "BC": 1}, {"ec": 1}, {}]


def over_theta():
    return dx.over_theta(*POINTS, kind="linear")


def over_Y():
    return dx.over_Y([0.1, 0.25, 0.35, 0.4], POINTS[1], [0.0, 9.0, 9.0, 0.0])


def roads(name, inputs, reduce, tmp_path, monkeypatch):
    """Compute a grid by other roads: lazy in several cuts, a store, a sweep in memory, a scene in blocks."""
    reduced = [axis for key in reduce or () for axis in ([key] if isinstance(key, str) else key)]
    for cut in CUTS:
        left = {axis: n for axis, n in cut.items() if axis not in reduced}
        yield cut, dx.grid(name, reduce=reduce, chunks=left, **inputs).compute(scheduler="synchronous")
    store = tmp_path / "store.zarr"
    yield "store", dx.sweep(name, store=store, chunks=2, reduce=reduce, **inputs).compute()
    if reduce:
        yield "memory", dx.sweep(name, reduce=reduce, **inputs)
    parts = {"motion": ("theta", "omega0"), "mechanism": ("ec", "AB", "BC"), "masses": ("m_slider",)}
    scene = {part: {n: _plain(inputs[n]) for n in names} for part, names in parts.items()}
    loads = {n: inputs[n] for n in ("F_Y",) if n in inputs}
    monkeypatch.setattr("desaxe.scenes.parts.grid.BLOCK", 5)
    text = {key if isinstance(key, str) else ", ".join(key): kinds for key, kinds in (reduce or {}).items()}
    result = dx.scene({**scene, "loads": loads, "outputs": [name], "reduce": text}).run()
    yield "scene", result.dataset


def _plain(value):
    return np.asarray(value).tolist()


@pytest.mark.parametrize(
    ("name", "inputs", "load", "reduce"),
    [
        ("a_C", EDGE, None, None),
        ("a_C", EDGE, None, {"theta": ["absmax", "mean"]}),
        ("a_C", FAR, None, {"ec": "std"}),
        pytest.param("a_C", FAR, None, {"ec": "max", "BC": "mean"}, marks=pytest.mark.thorough),
        ("T_in", FAR, over_theta, None),
        pytest.param("T_in", FAR, over_theta, {"ec": "median"}, marks=pytest.mark.thorough),
        pytest.param("T_in", FAR, over_theta, {"theta": "max"}, marks=pytest.mark.thorough),
        pytest.param("T_in", FAR, over_Y, None, marks=pytest.mark.thorough),
        pytest.param("T_in", FAR, over_Y, {"ec": ["max", "p95"]}, marks=pytest.mark.thorough),
    ],
)
def test_every_road_has_the_digits_of_the_grid(name, inputs, load, reduce, tmp_path, monkeypatch):
    inputs = {**inputs, **MASSES, **({"F_Y": load()} if load else {})}
    grid = dx.grid(name, reduce=reduce, **inputs)
    whole = bits(grid)
    for road, result in roads(name, inputs, reduce, tmp_path, monkeypatch):
        there = bits(result)
        assert {n: there[n] for n in whole} == whole, road
        assert result.attrs == grid.attrs or not isinstance(road, dict)
    if reduce is None and inputs["theta"] is EDGE["theta"]:  # a far angle has another kernel in `evaluate`
        ec, BC = np.reshape(inputs["ec"], (-1, 1)), np.array(inputs["BC"])
        there = dx.evaluate(name, **{**inputs, "theta": inputs["theta"][:, None, None], "ec": ec, "BC": BC})
        np.testing.assert_array_equal(grid[name], there)


@pytest.mark.parametrize(
    "reduce", [{"theta": "absmax"}, {"theta": "mean"}, {"ec": "std"}, {"ec": ["p95", "max"]}]
)
def test_an_empty_axis_gives_empty_results_or_none(reduce):
    inputs = {"theta": np.empty(0), "ec": [0.0, 0.1], "AB": 0.1, "BC": 0.3, "omega0": 2.0}
    result = dx.grid("a_C", reduce=reduce, **inputs)
    assert all(
        array.size == 0 or np.isnan(array).all() for n, array in result.data_vars.items() if "a_C_s" not in n
    )
    assert (result.a_C_skipped == 0).all()
    assert bits(dx.grid("a_C", chunks={"ec": 1}, **inputs).compute()) == bits(dx.grid("a_C", **inputs))


# ---- axes that are cut while they are reduced ------------------------------------------------------

ALL = {("theta", "ec"): ["absmax", "max", "min", "mean", "rms"]}


PLAIN, LOADED = ("a_C", None), pytest.param("F_C_Y", over_Y, marks=pytest.mark.thorough)


@pytest.mark.parametrize(("quantity", "load"), [PLAIN, LOADED])
@pytest.mark.parametrize("most", [1, 2, 3])  # designs behind a result that are in memory at once
def test_pieces_of_a_reduced_axis_combine_to_the_whole(quantity, load, most, monkeypatch):
    inputs = {**EDGE, **MASSES, **({"F_Y": load()} if load else {})}
    whole = dx.grid(quantity, reduce=ALL, **inputs)
    monkeypatch.setattr("desaxe.evaluation.reductions.reduced.PIECE", most)
    result = dx.grid(quantity, reduce=ALL, threads=1, **inputs)
    assert bits(dx.grid(quantity, reduce=ALL, threads=3, **inputs)) == bits(result)
    assert result.attrs == whole.attrs
    for name in whole.variables:
        if name.endswith(("_mean", "_rms")):
            np.testing.assert_allclose(result[name], whole[name], rtol=1e-14)
        else:  # extremes, where they are and on which side of a jump, and how many points count
            np.testing.assert_array_equal(result[name], whole[name])


def test_a_function_over_theta_is_cut_along_it(monkeypatch):
    inputs = {**EDGE, **MASSES, "F_Y": dx.over_theta(lambda theta: 90.0 * np.cos(theta))}
    names = [f"F_C_Y_{kind}" for kind in ("absmax", "absmax_theta", "min", "skipped")]
    whole = dx.grid("F_C_Y", reduce={"theta": ["absmax", "min", "rms"]}, **inputs)
    monkeypatch.setattr("desaxe.evaluation.reductions.reduced.PIECE", 7)
    result = dx.grid("F_C_Y", reduce={"theta": ["absmax", "min", "rms"]}, **inputs)
    for name in names:
        np.testing.assert_array_equal(result[name], whole[name])
    np.testing.assert_allclose(result.F_C_Y_rms, whole.F_C_Y_rms, rtol=1e-14)


@pytest.mark.parametrize(
    "reduce",
    [{("theta", "ec"): "std"}, pytest.param({"theta": "max", "ec": "mean"}, marks=pytest.mark.thorough)],
)
def test_what_does_not_combine_has_its_axes_whole(reduce, monkeypatch):
    whole = dx.grid("a_C", reduce=reduce, **EDGE, omega0=5.0)
    monkeypatch.setattr("desaxe.evaluation.reductions.reduced.PIECE", 1)
    assert bits(dx.grid("a_C", reduce=reduce, **EDGE, omega0=5.0)) == bits(whole)


@pytest.mark.thorough
def test_a_long_reduction_fits_into_memory(monkeypatch):
    """Many designs behind one number: a few arrays of some of them at a time."""
    monkeypatch.setattr("desaxe.evaluation.reductions.reduced.PIECE", 2**13, raising=False)
    lengths = {"ec": np.linspace(0.0, 0.01, 512), "BC": np.linspace(0.3, 0.4, 512)}
    asked = {"theta": [0.5, 1.0], "AB": 0.1, **lengths, "reduce": {("theta", "ec", "BC"): ["max", "mean"]}}
    dx.grid("Y", **asked)  # compiles
    tracemalloc.start()
    result = dx.grid("Y", **asked)
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert most < 6e6  # 8 bytes a design are 2e6
    assert result.Y_max_BC == 0.4
    assert result.Y_skipped == 0


def test_a_stopped_sweep_has_the_digits_of_the_grid(tmp_path, monkeypatch):
    monkeypatch.setattr("desaxe.evaluation.reductions.reduced.PIECE", 2)
    inputs = {**EDGE, **MASSES, "F_Y": over_Y()}
    whole = bits(dx.grid("F_C_Y", reduce=ALL, **inputs))
    asked = {"store": tmp_path / "store.zarr", "chunks": {"BC": 1}, "reduce": ALL, **inputs}
    calls = []

    def stop(*_):
        calls.append(0)
        if len(calls) > 1:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        dx.sweep("F_C_Y", progress=stop, **asked)
    there = bits(dx.sweep("F_C_Y", **asked).compute())
    assert {name: there[name] for name in whole} == whole
