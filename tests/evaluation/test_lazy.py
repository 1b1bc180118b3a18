"""`grid(..., chunks=)`: lazy Dask arrays with the digits of the whole grid."""

import pickle

import dask
import numpy as np
import pytest

import desaxe as dx
from tests.ways import take_way

TURN = np.linspace(0.0, 2.0 * np.pi, 65)
LAST = np.arcsin(0.75)  # of AB = 0.2, BC = 0.1, ec = -0.05: the rod just reaches
ANGLES = np.concatenate([TURN, LAST + np.arange(-3, 4) * np.spacing(LAST)])
INPUTS = {"theta": ANGLES, "ec": [-0.05, 0.0, 0.02, 0.9], "AB": 0.2, "BC": [0.1, 0.5, 0.2], "omega0": 3.0}
NAMES = ["a_C", "V_C_wrt_ec"]


@pytest.fixture(autouse=True)
def _compiled(monkeypatch):
    take_way(monkeypatch, "compiled")


def bits(dataset):
    """The bytes of all values; a NaN has no digits, and processors choose its sign."""
    return {n: np.where(np.isnan(a.values), np.nan, a.values).tobytes() for n, a in dataset.variables.items()}


@pytest.mark.parametrize(
    "chunks", ["auto", {"theta": 1, "ec": 3}, {"ec": 1, "BC": 1}, {"theta": 16, "BC": 2}, 5]
)
def test_a_chunk_has_the_bits_of_the_whole(chunks):
    whole = dx.grid(NAMES, **INPUTS)
    lazy = dx.grid(NAMES, **INPUTS, chunks=chunks)
    assert all(lazy[name].chunks is not None for name in lazy.data_vars)
    assert bits(lazy.compute(scheduler="synchronous")) == bits(whole)
    assert np.isnan(whole["a_C"].sel(ec=0.9)).all()  # chunks without a value are among them
    assert lazy.attrs == whole.attrs
    assert [lazy[n].attrs.keys() for n in lazy.variables] == [whole[n].attrs.keys() for n in whole.variables]


def test_a_reduced_grid():
    whole = dx.grid(NAMES, **INPUTS, reduce={"theta": ["absmax", "mean"]})
    lazy = dx.grid(NAMES, **INPUTS, reduce={"theta": ["absmax", "mean"]}, chunks={"ec": 1})
    assert lazy["a_C_mean"].chunks == ((1, 1, 1, 1), (3,))
    assert bits(lazy.compute(scheduler="synchronous")) == bits(whole)


def test_one_of_many_names_in_common_ways():
    lazy = dx.grid(NAMES, **INPUTS, chunks={"theta": 20})
    whole = dx.grid(NAMES, **INPUTS)
    with dask.config.set(scheduler="synchronous"):
        picked = lazy["a_C"].sel(ec=0.02).isel(theta=slice(3, 50)).max("theta")
        np.testing.assert_array_equal(picked, whole["a_C"].sel(ec=0.02).isel(theta=slice(3, 50)).max("theta"))
        assert bits(lazy[["status"]].persist())["status"] == bits(whole)["status"]


def test_names_follow_from_the_request_and_nothing_is_computed(monkeypatch):
    monkeypatch.setattr("desaxe.evaluation.points.Points.compute", None)  # what nobody may call here
    first, again, other = (dx.grid(NAMES, **INPUTS, chunks={"theta": n}) for n in (20, 20, 30))
    assert first["a_C"].data.name == again["a_C"].data.name != other["a_C"].data.name
    assert first["a_C"].dtype == np.float64
    assert first["status"].dtype == np.int8
    assert len(pickle.dumps(first["a_C"].data.dask)) < 20_000


def test_chunks_and_out_are_not_for_each_other():
    with pytest.raises(TypeError, match="chunks= and out=: give one of them"):
        dx.grid("a_C", **INPUTS, chunks=3, out=np.empty(3))
