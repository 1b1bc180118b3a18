"""`evaluate` of Dask arrays stays lazy."""

import dask
import dask.array as da
import numpy as np
import pytest
import xarray as xr

import desaxe as dx
from tests.ways import take_way

THETA, EC = np.linspace(0.0, 7.0, 101), np.linspace(-0.3, 0.3, 7)
MACHINE = {"AB": 0.125, "BC": 0.35, "omega0": 157.08}
NAMES = ["a_C", "status"]


@pytest.fixture(autouse=True)
def _compiled(monkeypatch):
    take_way(monkeypatch, "compiled")
    with dask.config.set(scheduler="synchronous"):
        yield


def test_it_broadcasts_as_arrays_do():
    lazy = dx.evaluate(NAMES, theta=da.from_array(THETA, chunks=25)[:, None], ec=EC, **MACHINE)
    eager = dx.evaluate(NAMES, theta=THETA[:, None], ec=EC, **MACHINE)
    for name in NAMES:
        assert lazy[name].dtype == eager[name].dtype
        assert lazy[name].chunks == ((25, 25, 25, 25, 1), (7,))
        np.testing.assert_array_equal(lazy[name].compute(), eager[name])


def test_one_name_gives_an_array_with_a_name_of_its_own():
    theta = da.from_array(THETA, chunks=25)
    one, again = (dx.evaluate("a_C", theta=theta, ec=0.1, **MACHINE) for _ in range(2))
    other = dx.evaluate("a_C", theta=theta, ec=0.2, **MACHINE)
    assert one.name == again.name != other.name


@pytest.mark.parametrize("dask_way", ["parallelized", "allowed"])
def test_apply_ufunc(dask_way):
    theta, ec = xr.DataArray(THETA, dims="theta").chunk(theta=30), xr.DataArray(EC, dims="ec")
    found = xr.apply_ufunc(
        lambda theta, ec: dx.evaluate("a_C", theta=theta, ec=ec, **MACHINE),
        theta, ec, dask=dask_way, output_dtypes=[float],
    )  # fmt: skip
    assert found.chunks is not None
    assert found.dims == ("theta", "ec")
    np.testing.assert_array_equal(found, dx.evaluate("a_C", theta=THETA[:, None], ec=EC, **MACHINE))


def test_a_chunk_of_bad_values_is_nan():
    ec = da.from_array(np.array([0.1, np.nan, np.nan, 0.2]), chunks=1)
    found = dx.evaluate(NAMES, theta=1.0, ec=ec, **MACHINE)
    assert found["status"].compute().tolist() == [0, 4, 4, 0]
    assert np.isnan(found["a_C"].compute()).tolist() == [False, True, True, False]


def test_out_is_not_for_dask():
    with pytest.raises(TypeError, match="not with Dask arrays"):
        dx.evaluate("a_C", theta=da.zeros(3), ec=0.1, **MACHINE, out=np.empty(3))
