"""`grid(..., chunks=)`: lazy Dask arrays with the digits of the whole grid."""

import pickle

import dask
import numpy as np
import pytest

import desaxe as dx
from tests.ways import bits

ANGLES = np.linspace(0.0, 2.0 * np.pi, 72)
INPUTS = {"theta": ANGLES, "ec": [-0.05, 0.0, 0.02, 0.9], "AB": 0.2, "BC": [0.1, 0.5, 0.2], "omega0": 3.0}
NAMES = ["a_C", "V_C_wrt_ec"]


def test_chunks_are_those_asked_for():
    whole, lazy = dx.grid(NAMES, **INPUTS), dx.grid(NAMES, **INPUTS, chunks={"theta": 50, "ec": 3})
    assert lazy["a_C"].chunks == ((50, 22), (3, 1), (3,))
    assert [lazy[n].attrs.keys() for n in lazy.variables] == [whole[n].attrs.keys() for n in whole.variables]
    reduced = dx.grid(NAMES, **INPUTS, reduce={"theta": "mean"}, chunks={"ec": 1})
    assert reduced["a_C_mean"].chunks == ((1, 1, 1, 1), (3,))
    assert all(dx.grid(NAMES, **INPUTS, chunks="auto")[name].chunks for name in (*NAMES, "status", "margin"))


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


@pytest.mark.parametrize("load", [dx.spring(300.0, free=0.1), dx.over_theta(np.sin), lambda Y, V_C: Y * V_C])
def test_a_chunk_of_one_point_has_the_digits_of_the_grid_under_loads(load):
    """The motion of the load, too, is that of a kernel there."""
    inputs = {**INPUTS, "theta": ANGLES[::12], "m_slider": 1.0, "F_Y": load}
    whole, lazy = dx.grid("T_in", **inputs), dx.grid("T_in", **inputs, chunks=1)
    assert bits(lazy.compute(scheduler="synchronous")) == bits(whole)


def test_chunks_and_out_are_not_for_each_other():
    with pytest.raises(TypeError, match="chunks= and out=: give one of them"):
        dx.grid("a_C", **INPUTS, chunks=3, out=np.empty(3))
