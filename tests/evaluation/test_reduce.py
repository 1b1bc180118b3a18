"""Reductions of an axis: against NumPy on the stored grid, from small and from compiled grids."""

import warnings

import numpy as np
import pytest

import desaxe as dx
from desaxe.compiler.languages.numba.reductions import LONGEST
from desaxe.runtime import kernels as _kernels

MACHINE = {"AB": 0.125, "omega0": 157.08}
TURN = np.linspace(0.0, 2.0 * np.pi, 721)
KINDS = ["max", "min", "absmax", "mean", "rms"]


def by_numpy(kind, values, axis):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        return {
            "max": lambda: np.nanmax(values, axis),
            "min": lambda: np.nanmin(values, axis),
            "absmax": lambda: np.nanmax(np.abs(values), axis),
            "mean": lambda: np.nanmean(values, axis),
            "rms": lambda: np.sqrt(np.nanmean(values * values, axis)),
        }[kind]()


def compare(names, reduced_axis, **inputs):
    """Every kind against the stored grid; the reduced dataset."""
    found = dx.grid(names, reduce={reduced_axis: KINDS}, **inputs)
    whole = dx.grid(names, **inputs)
    for name in names:
        values, axis = whole[name].values, whole[name].get_axis_num(reduced_axis)
        scale = np.nanmax(np.abs(values))
        for kind in KINDS:
            wanted = by_numpy(kind, values, axis)
            if kind in ("mean", "rms"):
                np.testing.assert_allclose(found[f"{name}_{kind}"], wanted, rtol=1e-13, atol=1e-14 * scale)
            else:
                np.testing.assert_array_equal(found[f"{name}_{kind}"], wanted)
        turned = {"max": values, "min": -values, "absmax": np.abs(values)}
        for kind, its in turned.items():
            at = np.argmax(np.where(np.isnan(its), -np.inf, its), axis)
            place = np.where(np.isnan(its).all(axis), np.nan, np.asarray(inputs[reduced_axis])[at])
            np.testing.assert_array_equal(found[f"{name}_{kind}_{reduced_axis}"], place)
        np.testing.assert_array_equal(found[f"{name}_skipped"], np.isnan(values).sum(axis))
    return found


@pytest.mark.usefixtures("way")
def test_over_theta_with_infeasible_designs():
    # Up to a fully infeasible design; rows of 40 leave a rest after the lanes.
    found = compare(
        ["a_C", "V_C"], "theta", theta=TURN[::18], ec=[0.0, 0.2, 0.24, 0.6], BC=[0.35, 0.4], **MACHINE
    )
    assert found.a_C_absmax.dims == ("ec", "BC")
    assert int(found.a_C_skipped.sel(ec=0.6, BC=0.35)) == 41
    assert np.isnan(found.a_C_rms.sel(ec=0.6, BC=0.35))
    assert 0 < int(found.a_C_skipped.sel(ec=0.24, BC=0.35)) < 41


@pytest.mark.thorough
@pytest.mark.usefixtures("way")
def test_over_another_axis():
    found = compare(["a_C"], "ec", ec=np.linspace(-0.2, 0.24, 23), theta=TURN[::60], BC=0.35, **MACHINE)
    assert found.a_C_max.dims == ("theta",)
    assert found.a_C_max_ec.units == "m"


@pytest.mark.usefixtures("way")
def test_of_one_design():
    found = compare(["a_C"], "theta", theta=TURN[::10], ec=0.01, BC=0.35, **MACHINE)
    assert found.a_C_absmax.dims == ()


@pytest.mark.thorough
@pytest.mark.usefixtures("way")
def test_bad_elements_are_skipped():
    theta = TURN[::10].copy()
    theta[[3, 50]] = np.nan, np.inf
    found = compare(["a_C"], "theta", theta=theta, ec=[0.01, 0.02], BC=0.35, **MACHINE)
    assert found.a_C_skipped.values.tolist() == [2, 2]


@pytest.mark.thorough
def test_rows_longer_than_the_scratch():
    theta = np.linspace(0.0, 7.0, 3 * LONGEST + 5)
    compare(["a_C"], "theta", theta=theta, ec=[0.0, 0.2, 0.23], BC=[0.35, 0.4], **MACHINE)


@pytest.mark.usefixtures("way")
def test_squares_of_any_scale():
    for speed in (1e-120, 1e100):
        found = dx.grid(
            "a_C", reduce={"theta": "rms"}, theta=TURN[::30], ec=0.01, AB=0.125, BC=0.35, omega0=speed
        )
        unit = dx.grid("a_C", theta=TURN[::30], ec=0.01, AB=0.125, BC=0.35, omega0=1.0)
        wanted = np.sqrt(np.mean(unit.a_C.values**2))
        assert float(found.a_C_rms) / speed / speed == pytest.approx(wanted, rel=1e-14)


def test_the_sum_keeps_what_rounding_takes():
    # V_C is 20 m/s; its mean over angles that are symmetric to 0 is 0, exactly.
    theta = np.arange(-100_000, 100_001) * 2.0**-15
    found = dx.grid("V_C", reduce={"theta": "mean"}, theta=theta, ec=0.0, BC=0.35, **MACHINE)
    assert abs(float(found.V_C_mean)) < 1e-22


def test_threads_change_nothing():
    inputs = {"theta": TURN, "ec": np.linspace(-0.1, 0.24, 301), "BC": [0.35, 0.36], **MACHINE}
    one, two, five = (
        dx.grid(["a_C", "V_C"], reduce={"theta": KINDS}, threads=threads, **inputs) for threads in (1, 2, 5)
    )
    assert one.identical(two)
    assert one.identical(five)


def test_the_grid_is_never_stored(monkeypatch):
    from desaxe.evaluation import grid as _grid

    monkeypatch.setenv("DESAXE_TIER", "compiled")
    monkeypatch.setattr(_grid, "_filled", lambda *_: pytest.fail("the whole grid was computed"))
    found = dx.grid("a_C", reduce={"theta": "absmax"}, theta=TURN, ec=[0, 0.1], BC=0.35, **MACHINE)
    assert set(found.data_vars) == {"a_C_absmax", "a_C_absmax_theta", "a_C_skipped"}


def test_labels():
    found = dx.grid(
        "a_C", reduce={"theta": ["absmax", "rms"]}, theta=TURN[:9], ec=[0, 0.1], BC=0.35, **MACHINE
    )
    assert found.a_C_absmax.attrs["cell_methods"] == "theta: maximum_absolute_value"
    assert found.a_C_rms.attrs["cell_methods"] == "theta: root_mean_square"
    assert found.a_C_absmax.units == "m/s^2"
    assert found.a_C_absmax_theta.units == "rad"
    assert "theta" not in found.coords


def test_small_grids_compile_nothing(monkeypatch):
    monkeypatch.setattr(_kernels, "_load", None)
    theta = np.linspace(0.0, 3.0, 7)
    dx.grid("phi", theta=theta, ec=[0.01, 0.02], AB=0.11, BC=0.37)
    dx.grid("phi", reduce={"theta": "max"}, theta=theta, ec=[0.01, 0.02], AB=0.11, BC=0.37)


@pytest.mark.parametrize(
    ("reduce", "message"),
    [
        ({"BC": "max"}, "reduce: 'BC' is no axis of this grid; axes: theta, ec"),
        ({"thta": "max"}, "did you mean theta?"),
        ({"theta": "absmx"}, "did you mean absmax?"),
        ({"theta": []}, "nothing is taken of theta"),
        ({"theta": "max", "ec": "max"}, "one axis and what is taken of it"),
        ("theta", "one axis and what is taken of it"),
        ({"theta": np.max}, "expected the name of a reduction or a list of names, of max, min,"),
        ({"theta": 3}, "reduce: theta = 3: expected the name of a reduction"),
    ],
)
def test_complaints(reduce, message):
    with pytest.raises((ValueError, TypeError)) as error:
        dx.grid("a_C", reduce=reduce, theta=[0, 1], ec=[0, 0.1], BC=0.35, **MACHINE)
    assert message in str(error.value)


def test_a_status_is_not_reduced():
    with pytest.raises(ValueError, match="leave it out; each name has a count of skipped points"):
        dx.grid(["a_C", "status"], reduce={"theta": "max"}, theta=[0, 1], ec=0, BC=0.35, **MACHINE)
