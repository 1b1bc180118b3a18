"""Prepared functions: any shape, the same digits, and the ways in from NumPy, numba, C, xarray and Dask."""

import ctypes
import gc
import pickle
import subprocess
import sys
import warnings
import weakref

import numpy as np
import pytest
import xarray

import desaxe as dx
from desaxe.runtime import native_calls

SIZES = {"AB": 0.125, "BC": 0.35, "omega0": 157.08}
NAMES = ["V_C", "a_C", "status"]


@pytest.fixture(scope="module")
def f():
    return dx.function(NAMES, inputs=("theta", "ec"), **SIZES)


@pytest.fixture(scope="module")
def one():
    return dx.function("a_C", inputs="theta", ec=0.01, **SIZES)


@pytest.fixture(autouse=True)
def loud():
    """A warning fails the test."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        yield


def points(size, seed=0):
    """Angles and eccentricities; some cannot be assembled, some angles are far, some values are bad."""
    rng = np.random.default_rng(seed)
    theta, ec = rng.uniform(-7.0, 7.0, size), rng.uniform(-0.3, 0.3, size)
    theta[::50], theta[7::101], ec[3::71] = 1e9 + theta[::50], np.inf, np.nan
    return theta, ec


def test_what_it_says(f, one):
    assert f.names == ("V_C", "a_C", "status")
    assert f.inputs == ("theta", "ec")
    assert f.units["a_C"] == "m/s^2"
    assert f.units["theta"] == "rad"
    assert (one.names, one.inputs) == (("a_C",), ("theta",))
    assert "inputs=('theta', 'ec'), AB=0.125" in repr(f)


def test_values_are_those_of_evaluate(f):
    theta, ec = points(3000)
    result = dict(zip(NAMES, f(theta, ec), strict=True))
    expected = dx.evaluate(NAMES, theta=theta, ec=ec, **SIZES)
    assert result["status"].dtype == np.int8
    assert np.array_equal(result["status"], expected["status"])
    for name, scale in (("V_C", 40.0), ("a_C", 1e4)):
        assert np.allclose(result[name], expected[name], rtol=1e-12, atol=1e-14 * scale, equal_nan=True)


def test_a_point_has_the_same_digits_in_any_array(f):
    theta, ec = points(2100)
    whole = f(theta, ec)
    order = np.random.default_rng(1).permutation(theta.size)
    for values, again in zip(whole, f(theta[order], ec[order]), strict=True):
        assert values[order].tobytes() == again.tobytes()
    table = f(theta.reshape(3, 700).T, ec.reshape(3, 700).T)
    for values, again in zip(whole, table, strict=True):
        assert values.reshape(3, 700).T.tobytes() == again.tobytes()
    for values, again in zip(whole, f(theta[::-3], ec[::-3]), strict=True):
        assert values[::-3].tobytes() == again.tobytes()
    for k in range(0, theta.size, 83):
        alone = f(theta[k], ec[k])
        assert all(a.tobytes() == v[k].tobytes() for a, v in zip(alone, whole, strict=True))


def test_a_reach_that_hangs_on_rounding_has_the_status_of_evaluate(f):
    ec = 0.25
    last = np.arcsin((0.35 - ec) / 0.125)
    theta = last + 2.0**-52 * np.arange(-40, 40)
    assert np.array_equal(f(theta, ec)[2], dx.evaluate("status", theta=theta, ec=ec, **SIZES))
    assert [int(f(t, ec)[2]) for t in theta] == f(theta, ec)[2].tolist()


@pytest.mark.thorough
def test_another_process_has_the_same_digits(f):
    theta, ec = points(300)
    code = (
        "import sys, pickle, numpy as np\n"
        "f, theta, ec = pickle.load(sys.stdin.buffer)\n"
        "sys.stdout.buffer.write(b''.join(a.tobytes() for a in f(theta, ec)))\n"
    )
    given = pickle.dumps((f, theta, ec))
    done = subprocess.run([sys.executable, "-c", code], input=given, capture_output=True, check=True)
    assert done.stdout == b"".join(a.tobytes() for a in f(theta, ec))


def test_broadcasts_and_takes_any_numbers(f, one):
    theta = np.linspace(0.0, 6.0, 11)
    assert f(theta, np.zeros((3, 1)))[0].shape == (3, 11)
    assert isinstance(one(1.0), float)
    assert one(1) == one(np.float32(1.0)) == one(1.0) == one([1.0])[0]
    assert one(theta.astype(np.float32)).dtype == np.float64
    assert one(np.empty((0, 3))).shape == (0, 3)
    assert isinstance(dx.function(["a_C"], ec=0.01, **SIZES)(theta), tuple)
    assert one("60 deg") == pytest.approx(one(np.pi / 3), rel=1e-13)


def test_keywords_in_any_order(f):
    a = f(0.3, 0.01)
    assert f(ec=0.01, theta=0.3) == f(0.3, ec=0.01) == a
    for call, message in (
        (lambda: f(0.3), "1 arguments were given"),
        (lambda: f(theta=0.3), "ec is missing"),
        (lambda: f(0.3, 0.01, theta=1.0), "theta was given twice"),
        (lambda: f(0.3, BC=1.0), "no input 'BC'"),
        (lambda: f(0.3, 1j), "ec: expected real numbers"),
        (lambda: dx.function("a_C", ec=0.0, AB=[1.0, 2.0], BC=3.0, omega0=1.0), "AB is fixed"),
        (lambda: dx.function("a_C", inputs=("ec",), ec=0.0, **SIZES), "it cannot be fixed too"),
        (lambda: dx.function("a_C", ec=0.0, AB=0.1, BC=0.3), "omega0 is missing"),
        (lambda: dx.function("a_C", inputs="thta", ec=0.0, **SIZES), "no input 'thta'"),
    ):
        with pytest.raises(TypeError, match=message):
            call()
    with pytest.raises(ValueError, match=r"AB = -1\.0"):
        dx.function("a_C", ec=0.0, AB=-1.0, BC=0.3, omega0=1.0)


def test_out(f, one):
    theta = np.linspace(0.0, 6.0, 1000)
    expected = one(theta)
    place = np.empty(2000)[::2]
    assert one(theta, out=place) is place
    assert np.array_equal(place, expected)
    own = theta.copy()
    one(own, out=own)
    assert np.array_equal(own, expected)
    outs = {"status": np.empty(1000, np.int8), "a_C": np.empty(1000), "V_C": np.empty(1000)}
    result = f(theta, 0.01, out=outs)
    assert result[1] is outs["a_C"]
    assert np.array_equal(outs["a_C"], f(theta, 0.01)[1])
    with pytest.raises(ValueError, match="expected 3 arrays, got 1"):
        f(theta, 0.01, out=place)


def test_jacobian_is_the_derivatives():
    f = dx.function(["V_C", "margin"], inputs=("theta", "ec"), **SIZES)
    theta, ec = np.linspace(0.0, 6.0, 9), np.array([[0.01], [0.4]])
    result = f.jacobian(theta, ec)
    expected = dx.evaluate(["V_C_wrt_theta", "V_C_wrt_ec"], theta=theta, ec=ec, **SIZES)
    for parameter in ("theta", "ec"):
        slopes = expected[f"V_C_wrt_{parameter}"]
        assert result["V_C"][parameter].shape == (2, 9)
        assert np.allclose(result["V_C"][parameter], slopes, rtol=1e-12, atol=1e-11, equal_nan=True)
    assert set(result["margin"]) == {"theta", "ec"}
    assert np.all(result["margin"]["theta"] == 0.0)
    assert np.all(result["margin"]["ec"] == -1.0)
    with pytest.raises(ValueError, match="the derivative of status with respect to theta is not derived"):
        dx.function("status", ec=0.0, **SIZES).jacobian(1.0)


def test_by_a_given_state():
    f = dx.function("a_C", inputs=("omega", "alpha"), theta=1.0, ec=0.01, AB=0.125, BC=0.35)
    result = f.jacobian(2.0, 3.0)["a_C"]
    state = {"theta": 1.0, "ec": 0.01, "AB": 0.125, "BC": 0.35, "omega": 2.0, "alpha": 3.0}
    for parameter in ("omega", "alpha"):
        assert result[parameter] == pytest.approx(dx.evaluate(f"a_C_wrt_{parameter}", **state), rel=1e-13)


def test_inside_of_compiled_code_and_from_c(f, one):
    from numba import njit

    several, single = f.scalar, one.scalar

    @njit
    def both(theta):
        return several(theta, 0.01)[1] + several(theta, 0.01)[2], single(theta)

    expected = f(1.0, 0.01)[1]
    assert both(1.0) == (expected, expected)
    function = ctypes.CFUNCTYPE(ctypes.c_int64, *[ctypes.POINTER(ctypes.c_double)] * 2)(f.address)
    out = (ctypes.c_double * 3)()
    assert function((ctypes.c_double * 2)(1.0, 0.5), out) == 0
    assert np.isnan(out[0])
    assert out[2] == 1.0
    assert function((ctypes.c_double * 2)(1.0, 0.01), out) == 0
    assert out[1] == expected


ADDRESS = """
import ctypes, gc
import desaxe as dx
address = dx.function("V_C", ec=0.01, AB=0.125, BC=0.35, omega0=157.08).address
gc.collect()
bytes(10_000_000)
others = [dx.function("V_C", ec=0.01 * k, AB=0.125, BC=0.35, omega0=157.08).address for k in range(3)]
out = ctypes.c_double()
ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p, ctypes.c_void_p)(address)(
    ctypes.byref(ctypes.c_double(1.0)), ctypes.byref(out))
print(out.value)
"""


def test_an_address_outlives_its_function_until_it_is_released():
    done = subprocess.run([sys.executable, "-c", ADDRESS], capture_output=True, text=True, check=True)
    design = {"ec": 0.01, "AB": 0.125, "BC": 0.35, "omega0": 157.08}
    assert float(done.stdout) == pytest.approx(dx.evaluate("V_C", theta=1.0, **design), rel=1e-13)
    function = dx.function("V_C", **design)
    code = weakref.ref(function._point.kept[0])
    assert function.address
    function.release()
    del function
    gc.collect()
    assert code() is None


def test_xarray_and_dask(f, one):
    import dask.array

    theta = xarray.DataArray(np.linspace(0.0, 6.0, 1000), dims="theta")
    ec = xarray.DataArray([0.0, 0.01], dims="ec")
    plain = f(theta.values[:, None], ec.values)
    labelled = f(theta, ec)
    assert labelled[1].dims == ("theta", "ec")
    applied = xarray.apply_ufunc(f, theta, ec, output_core_dims=[[], [], []])
    chunked = xarray.apply_ufunc(one, theta.chunk(theta=300), dask="parallelized", output_dtypes=[float])
    for k in range(3):
        assert labelled[k].values.tobytes() == applied[k].values.tobytes() == plain[k].tobytes()
    assert chunked.values.tobytes() == one(theta.values).tobytes()
    lazy = one(dask.array.from_array(theta.values, chunks=300))
    assert lazy.compute().tobytes() == one(theta.values).tobytes()


def test_more_outputs_than_a_ufunc_can_have(monkeypatch, f):
    monkeypatch.setattr(native_calls, "most_arguments", lambda: 4)
    wide = dx.function(NAMES, inputs=("theta", "ec"), **SIZES)
    theta, ec = points(700)
    for narrow, result in zip(f(theta, ec), wide(theta, ec), strict=True):
        assert narrow.tobytes() == result.tobytes()
    outs = [np.empty(700, np.float64), np.empty(700), np.empty(700, np.int8)]
    assert wide(theta, ec, out=outs)[0] is outs[0]
    assert outs[0].tobytes() == f(theta, ec)[0].tobytes()


def test_kept_functions_are_loaded(f):
    again = pickle.loads(pickle.dumps(f))
    assert again(0.3, 0.01) == f(0.3, 0.01)
