"""Arrays: threads, far angles, states; the cache folder."""

import math

import numpy as np
import pytest
import xarray

import desaxe as dx
from tests.ways import POINT, SIZES, close, columns

# ---- threads, far angles, a state -----------------------------------------------------


def test_labelled_arrays_of_other_dimensions_are_refused_where_arrays_are_filled():
    """A place to fill has no labels by which to broadcast."""
    theta, ec = xarray.DataArray([0.1, 0.2], dims="t"), xarray.DataArray([0.0, 0.01], dims="e")
    with pytest.raises(ValueError, match=r"theta \('t',\), ec \('e',\); use grid"):
        dx.evaluate("V_C", **POINT | {"theta": theta, "ec": ec}, out=np.empty((2, 2)))
    assert dx.evaluate("V_C", **POINT | {"theta": theta}, out=np.empty(2)).shape == (2,)


def test_a_masked_array_is_refused():
    with pytest.raises(TypeError, match="theta: a masked array; fill it first"):
        dx.evaluate("V_C", **POINT | {"theta": np.ma.masked_invalid([0.1, math.nan])})


@pytest.mark.parametrize("size", [39_999, 40_001, 100_003])
def test_threads_change_no_bit(size):
    theta, ec = columns(size)
    one, two, free = (dx.evaluate("V_C", theta=theta, ec=ec, **SIZES, threads=n) for n in (1, 2, None))
    assert np.array_equal(one, two)
    assert np.array_equal(one, free)


@pytest.mark.parametrize("largest", [1.6e6, 1e7, 1e15])
def test_an_angle_may_be_far(largest):
    """Its sine is that of the C library; the others of its column keep theirs."""
    theta = np.array([largest, -largest / 3, 1.0])
    result = dx.evaluate("V_C", theta=theta, ec=np.zeros(3), **SIZES)
    assert close(result, [dx.evaluate("V_C", theta=t, ec=0.0, **SIZES) for t in theta.tolist()])
    near = dx.evaluate("V_C", theta=np.array([2.0, 1.0]), ec=np.zeros(2), **SIZES)
    assert result[2] == near[1]


def test_one_element_is_as_good_as_a_number():
    theta, ec = columns(3)
    expected = dx.evaluate("V_C", theta=theta, ec=ec, **SIZES)
    one = SIZES | {"AB": np.array([0.125]), "BC": [[0.35]]}
    result = dx.evaluate("V_C", theta=theta, ec=ec, **one)
    assert result.shape == (1, 3)
    assert np.array_equal(result[0], expected)


STATE = {"theta": 1.1, "ec": 0.01, "AB": 0.125, "BC": 0.35, "omega": -20.0, "alpha": 7.0}
STATED = ["V_C", "a_C_wrt_omega", "V_C_wrt_theta_omega", "omega_wrt_omega", "status"]


def test_a_state_has_derivatives_by_omega():
    result = dx.evaluate(STATED, **STATE)
    step = 2.0**-20
    up, down = (dx.evaluate("a_C", **STATE | {"omega": -20.0 + s}) for s in (step, -step))
    assert list(result) == STATED
    assert math.isclose(result["a_C_wrt_omega"], (up - down) / (2 * step), rel_tol=1e-8)
    assert result["omega_wrt_omega"] == 1.0


def test_a_state_of_arrays():
    omega = np.array([-20.0, 0.0, 3.0])
    result = dx.evaluate(STATED, **STATE | {"omega": omega})
    for index, speed in enumerate(omega.tolist()):
        one = dx.evaluate(STATED, **STATE | {"omega": speed})
        assert all(math.isclose(result[q][index], one[q], rel_tol=1e-14, abs_tol=1e-15) for q in STATED)


def test_a_state_fills_out_by_its_own_names():
    out = {"a_C_wrt_omega": np.empty(2)}
    dx.evaluate("a_C_wrt_omega", **STATE | {"omega": np.array([1.0, 2.0])}, out=out)
    assert np.isfinite(out["a_C_wrt_omega"]).all()


def test_a_state_has_none_by_omega0():
    with pytest.raises(ValueError, match="'V_C_wrt_omega0' has no meaning for a given state omega="):
        dx.evaluate("V_C_wrt_omega0", **STATE)


def test_a_state_never_stalls():
    assert dx.evaluate("status", **STATE | {"theta": 100.0, "alpha": -1e9}) == 0
