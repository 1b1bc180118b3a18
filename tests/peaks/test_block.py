"""Peaks beside the grid of a sweep."""

import dask
import numpy as np
import pytest

import desaxe as dx

EC = np.array([0.0, 0.05, 0.2, 0.3, np.nan, 0.1, np.nan])
MACHINE = {"AB": 0.125, "BC": 0.35, "omega0": 157.08}


@pytest.fixture(autouse=True)
def _synchronous():
    with dask.config.set(scheduler="synchronous"):
        yield


@pytest.mark.thorough
def test_peaks_in_a_store(tmp_path):
    ec, BC = EC[:4], np.array([0.3, 0.35])
    inputs = {"ec": ec, "AB": 0.125, "BC": BC, "omega0": 157.08}
    peaks = {"a_C": ["absmax", "min"]}
    stored = dx.sweep([], store=tmp_path / "peaks.zarr", peaks=peaks, chunks={"ec": 3}, **inputs)
    for kind in peaks["a_C"]:
        own = dx.peak("a_C", kind=kind, ec=ec[:, None], AB=0.125, BC=BC, omega0=157.08)
        stem = f"peak_{kind}_a_C"
        assert stored[stem].dims == ("ec", "BC")
        np.testing.assert_allclose(stored[stem], own["value"], rtol=1e-9)
        np.testing.assert_array_equal(stored[f"{stem}_status"], own["status"])
        np.testing.assert_allclose(stored[f"{stem}_wrt_ec"], own["gradient"]["ec"], rtol=1e-6)
    assert stored.peak_absmax_a_C_side.dtype == np.int8
    assert stored["peak_min_a_C"].attrs["units"] == "m/s^2"
    assert "margin" in stored
    with pytest.raises(ValueError, match="kind = 'mean' of a_C"):
        dx.sweep([], store=tmp_path / "no.zarr", peaks={"a_C": "mean"}, **inputs)


def test_a_derivative_of_a_peak_and_a_peak_of_a_derivative_do_not_share_a_name():
    inputs = {"ec": [0.01, 0.02], "AB": 0.05, "BC": 0.2, "omega0": 30.0, "m_slider": 2.0}
    with pytest.raises(ValueError, match="peak_max_T_in_wrt_ec would be two variables"):
        dx.sweep([], store=None, peaks={"T_in": "max", "T_in_wrt_ec": "max"}, **inputs)
    result = dx.sweep([], store=None, peaks={"T_in": "max", "T_in_wrt_ec": "min"}, **inputs)
    assert float(result.peak_max_T_in_wrt_ec[0]) != float(result.peak_min_T_in_wrt_ec[0])


def test_a_peak_under_a_load_over_the_speed_has_its_derivative_by_the_speed():
    """In a sweep it had none: no mass needs the speed, but the load does."""
    damper = dx.over_V([-2.0, 0.0, 2.0], [-80.0, 0.0, 200.0])
    inputs = {"ec": [0.01, 0.02], "AB": 0.1, "BC": 0.3, "F_Y": damper}
    at = {speed: dx.peak("T_in", omega0=speed, **inputs)["value"] for speed in (10.0 - 1e-4, 10.0 + 1e-4)}
    low, high = at.values()
    swept = dx.sweep([], store=None, peaks="T_in", omega0=10.0, **inputs)
    np.testing.assert_allclose(swept.peak_absmax_T_in_wrt_omega0, (high - low) / 2e-4, rtol=1e-7)


@pytest.mark.parametrize("units", ["mm, deg, rpm, kN, N mm", {"torque": "kN m", "length": "cm"}])
@pytest.mark.parametrize("name", ["T_in", "a_C", "T_in_wrt_ec"])
def test_a_machine_has_the_gradients_of_its_sweep_in_the_units_of_its_peaks(units, name):
    press = dx.Machine(ec="10 mm", AB="50 mm", BC="200 mm", omega0="300 rpm", m_slider=2, units=units)
    swept = press.sweep([], store=None, peaks=name, ec=[press.in_units()["ec"]])
    peak = press.peak(name)
    stem = f"peak_absmax_{name}"
    assert swept[stem].attrs["units"] == peak.units["value"]
    for parameter, slope in peak["gradient"].items():
        variable = swept[f"{stem}_wrt_{parameter}"]
        assert variable.attrs["units"] == peak.units["gradient"][parameter]
        assert float(variable[0]) == pytest.approx(slope, rel=1e-9)
