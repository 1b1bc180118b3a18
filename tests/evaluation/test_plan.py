"""A plan cut into blocks: each block has the digits of the whole, under loads and in reductions too."""

import numpy as np
import pytest

import desaxe as dx
from tests.ways import take_way

# One angle is beyond what a kernel's own sine reduces: all blocks then take another kernel, or none.
FAR = {"theta": [0.1, 1.0, 1e9, 2.0, 1e12, np.nan, 3.0], "ec": [0.0, 0.01, 0.02], "AB": 0.1, "BC": [0.3, 0.4]}
MASSES = {"m_slider": 0.8, "omega0": 5.0}
POINTS = [0.0, 1.0, 2.0, 4.0], [-400.0, 200.0, -50.0, 20.0]
CUTS = [{"theta": 1}, {"theta": 2, "BC": 1}, {"ec": 1}, 3]


@pytest.fixture(autouse=True)
def _compiled(monkeypatch):
    take_way(monkeypatch, "compiled")


def bits(dataset):
    """The bytes of all values; a NaN has no digits, and processors choose its sign."""
    return {n: np.where(np.isnan(a.values), np.nan, a.values).tobytes() for n, a in dataset.variables.items()}


def over_theta():
    return dx.over_theta(*POINTS, kind="linear")


def over_Y():
    return dx.over_Y([0.1, 0.25, 0.35, 0.4], POINTS[1], [0.0, 9.0, 9.0, 0.0])


@pytest.mark.parametrize(
    ("name", "load", "reduce"),
    [
        ("a_C", None, None),
        ("a_C", None, {"ec": "std"}),
        pytest.param("a_C", None, {"ec": "max", "BC": "mean"}, marks=pytest.mark.thorough),
        ("T_in", over_theta, None),
        pytest.param("T_in", over_theta, {"ec": "median"}, marks=pytest.mark.thorough),
        pytest.param("T_in", over_Y, None, marks=pytest.mark.thorough),
        pytest.param("T_in", over_Y, {"ec": ["max", "p95"]}, marks=pytest.mark.thorough),
    ],
)
def test_digits_do_not_depend_on_how_a_grid_is_cut(name, load, reduce):
    inputs = {**FAR, **MASSES, **({"F_Y": load()} if load else {})}
    whole = bits(dx.grid(name, reduce=reduce, **inputs))
    for cut in CUTS:
        left = (
            {axis: n for axis, n in cut.items() if axis not in (reduce or ())} if isinstance(cut, dict) else 2
        )
        lazy = dx.grid(name, reduce=reduce, chunks=left, **inputs)
        assert bits(lazy.compute(scheduler="synchronous")) == whole, cut


def test_blocks_of_extreme_lengths_are_those_of_common_ones():
    """Lengths times a power of two give results times that, though their squares underflow."""
    inputs = {"theta": np.linspace(0.0, 6.0, 9), "omega0": 2.0}
    lengths = {"ec": np.array([0.0, 0.01]), "AB": 0.1, "BC": np.array([0.3, 0.4])}
    common = dx.grid(["a_C", "Y"], **inputs, **lengths)
    small = {name: length * 2.0**-700 for name, length in lengths.items()}
    found = dx.grid(["a_C", "Y"], chunks={"ec": 1}, **inputs, **small).compute(scheduler="synchronous")
    assert (found.status == 0).all()
    for name in ("a_C", "Y"):
        np.testing.assert_allclose(found[name] * 2.0**700, common[name].values, rtol=1e-13)


@pytest.mark.parametrize(
    "reduce", [{"theta": "absmax"}, {"theta": "mean"}, {"ec": "std"}, {"ec": ["p95", "max"]}]
)
def test_an_empty_axis_gives_empty_results_or_none(reduce):
    inputs = {"theta": np.empty(0), "ec": [0.0, 0.1], "AB": 0.1, "BC": 0.3, "omega0": 2.0}
    found = dx.grid("a_C", reduce=reduce, **inputs)
    assert all(
        array.size == 0 or np.isnan(array).all() for n, array in found.data_vars.items() if "a_C_s" not in n
    )
    assert (found.a_C_skipped == 0).all()
    assert bits(dx.grid("a_C", chunks={"ec": 1}, **inputs).compute()) == bits(dx.grid("a_C", **inputs))
