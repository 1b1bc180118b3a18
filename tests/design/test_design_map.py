"""Maps of designs: labelled, the same values as one by one, there and back through a file."""

import numpy as np
import pytest
import xarray as xr

import desaxe as dx

ECS, RODS = np.linspace(-0.3, 0.3, 7), np.array([0.1, 0.3, 0.4])


@pytest.fixture(scope="module")
def plane():
    names = ["stroke", "max_pressure_angle", ("absmax", "a_C")]
    return dx.design_map(names, ec=ECS, BC=RODS, AB="125 mm", omega0=157.08, derivatives=True)


def test_values_are_those_of_each_design(plane):
    assert plane.stroke.dims == ("ec", "BC")
    for ec in ECS:
        for BC in RODS:
            here = plane.sel(ec=ec, BC=BC)
            feasible = dx.feasibility(ec=ec, AB=0.125, BC=BC)
            assert float(here.margin) == feasible["margin"]
            assert bool(here.can_turn) == feasible["can_turn"]
            assert int(here.status) == feasible["status"]
            meanings = here.kind.attrs["flag_meanings"].split()
            assert meanings[int(here.kind)].replace("_", " ") == feasible["kind"]
            events = dx.events(ec=ec, AB=0.125, BC=BC)
            assert float(here.stroke) == pytest.approx(events["stroke"], rel=1e-14, nan_ok=True)
            slope = events["gradient"]["stroke"]["BC"]
            assert float(here.stroke_wrt_BC) == pytest.approx(slope, rel=1e-12, nan_ok=True)
            if feasible["can_turn"]:
                peak = dx.peak("a_C", ec=ec, AB=0.125, BC=BC, omega0=157.08)
                assert float(here.absmax_a_C) == pytest.approx(peak["value"], rel=1e-13)


def test_labels(plane):
    assert plane.stroke.attrs["units"] == "m"
    assert plane.absmax_a_C.attrs == {
        "units": "m/s^2",
        "quantity": "a_C",
        "long_name": "largest magnitude over a turn: " + dx.quantities()["a_C"].meaning,
    }
    assert plane.absmax_a_C_wrt_ec.attrs["quantity"] == "a_C_wrt_ec"
    assert plane.stroke_wrt_BC.attrs["units"] == "1"
    assert plane.max_pressure_angle_wrt_ec.attrs["units"] == "rad/m"
    assert plane.absmax_a_C_wrt_ec.attrs["units"] == "1/s^2"
    assert plane.absmax_a_C_wrt_omega0.attrs["units"] == dx.quantities()["a_C_wrt_omega0"].unit
    assert plane.status.dtype == np.int8
    assert len(plane.kind.attrs["flag_values"]) == len(plane.kind.attrs["flag_meanings"].split()) == 5
    assert plane.AB.attrs["units"] == "m"
    assert set(dx.design_map(ec=ECS, AB=0.125, BC=0.35).data_vars) == {"margin", "can_turn", "status", "kind"}


def test_there_and_back(plane, tmp_path):
    plane.to_netcdf(tmp_path / "map.nc", engine="h5netcdf")
    xr.testing.assert_identical(xr.load_dataset(tmp_path / "map.nc", engine="h5netcdf"), plane)


def margin(design):
    return design["ec"], {"ec": 1.0}


@pytest.mark.parametrize("names", [[("max", "T_in"), ("max", "T_in_wrt_ec")], [margin, "stroke"]])
def test_two_variables_of_one_name_are_refused(names):
    """d(max T_in)/d ec and max(d T_in/d ec) are different; a function may be called as a variable is."""
    inputs = {"ec": 0.01, "AB": 0.05, "BC": 0.2, "omega0": 30.0, "m_slider": 2.0}
    with pytest.raises(ValueError, match="two variables would be called ma"):
        dx.design_map(names, derivatives=True, **inputs)
    alone = [dx.design_map(name, derivatives=True, **inputs) for name in names if not callable(name)]
    assert {"margin", "can_turn", "status", "kind"} <= set(alone[0].data_vars)
