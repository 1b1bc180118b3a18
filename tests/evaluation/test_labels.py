"""Labelled grids in the hands of someone used to xarray: selecting, units, flags, files."""

import cf_xarray  # noqa: F401  the accessor .cf
import numpy as np
import pandas as pd
import pint
import pytest
import xarray as xr

import desaxe as dx

THETA = np.linspace(0.0, 2 * np.pi, 13)
MACHINE = {"AB": 0.125, "BC": 0.35, "omega0": 157.08}


@pytest.fixture(scope="module")
def grid():
    return dx.grid(["a_C", "a_C_wrt_ec"], theta=THETA, ec=[0.0, 0.1, 0.24], **MACHINE)


def test_every_variable_says_what_it_is(grid):
    for name, array in grid.variables.items():
        assert array.attrs["long_name"], name
        assert name == "status" or array.attrs["units"], name
    assert grid.a_C_wrt_ec.attrs["units"] == "1/s^2"
    assert grid.a_C.attrs["references"]


def test_the_dataset_says_where_it_comes_from(grid):
    assert grid.attrs["source"].startswith(f"desaxe {dx.__version__}, derivation ")
    assert (grid.attrs["branch"], grid.attrs["accuracy"]) == (1, "standard")
    assert grid.attrs["scene"] == (
        "a_C, a_C_wrt_ec over theta, ec; AB = 0.125 m, BC = 0.35 m, omega0 = 157.08 rad/s"
    )
    options = {"branch": -1, "accuracy": "extended", **MACHINE}
    for other in (
        dx.grid("a_C", theta=THETA, ec=0.0, **options),
        dx.grid("a_C", theta=THETA, ec=[0.0, 0.1], reduce={"theta": "max"}, **options),
    ):
        assert (other.attrs["branch"], other.attrs["accuracy"]) == (-1, "extended")
        assert other.attrs["scene"].startswith("a_C")
    plane = dx.design_map("stroke", ec=[0.0, 0.1], AB=0.125, BC=0.35)
    assert plane.attrs["source"] == grid.attrs["source"]
    assert plane.attrs["scene"] == "stroke over ec; AB = 0.125 m, BC = 0.35 m"


def test_a_machine_says_it_in_its_units():
    press = dx.Machine(AB=125, BC=350, ec=-7.5, omega0=1500, m_slider=2, mu=0.1, units="mm, deg, rpm")
    dataset = press.grid(["a_C", "T_in"], theta=[0, 30, 90])
    fixed = "ec = -7.5 mm, AB = 125.0 mm, BC = 350.0 mm, omega0 = 1500.0 rpm, m_slider = 2.0 kg, mu = 0.1"
    what, _, numbers = dataset.attrs["scene"].partition("; ")
    assert what == "a_C, T_in over theta"
    assert sorted(numbers.split(", ")) == sorted(fixed.split(", "))


def test_a_dataset_can_be_asked_for_again_by_what_it_says(grid):
    """Coordinates and attributes are all that `grid` was told."""
    names = [name for name in grid.data_vars if name not in ("status", "margin")]
    inputs = {name: grid[name] for name in (*grid.dims, *(n for n in grid.coords if n not in grid.dims))}
    again = dx.grid(names, branch=grid.branch, accuracy=grid.accuracy, **inputs)
    xr.testing.assert_identical(again, grid)


# ---- flags -----------------------------------------------------------------------------------------


def test_cf_flags(grid):
    stuck = grid.status.cf == "cannot_be_assembled"
    assert stuck.sum("theta").values.tolist() == [0, 0, int(np.isnan(grid.a_C.sel(ec=0.24)).sum())]
    assert int(stuck.sum()) > 0
    flags = grid.status.cf.flags
    assert (flags.ok == (grid.status == 0)).all()
    assert len(flags) == 7


# ---- files -----------------------------------------------------------------------------------------


def test_netcdf_there_and_back(grid, tmp_path):
    grid.to_netcdf(tmp_path / "grid.nc")
    with xr.open_dataset(tmp_path / "grid.nc") as file:
        again = file.load()
    unchanged(again, grid)


@pytest.mark.parametrize("version", [2, 3])
def test_zarr_there_and_back(grid, tmp_path, version):
    grid.to_zarr(tmp_path / "grid.zarr", zarr_format=version, consolidated=False)
    with xr.open_zarr(tmp_path / "grid.zarr", consolidated=False) as store:
        again = store.load()
    unchanged(again, grid)


def unchanged(again, grid):
    xr.testing.assert_identical(again, grid)
    assert again.status.dtype == np.int8
    assert tuple(again.a_C.dims) == tuple(grid.a_C.dims)
    assert ((again.status.cf == "cannot_be_assembled") == (grid.status == 1)).all()


# ---- units -----------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def units():
    """The registry of the accessor .pint, which half a second goes into."""
    from pint_xarray import unit_registry

    return unit_registry


def test_pint_there_and_back(grid, units):
    with_units = grid.pint.quantify()
    assert with_units.a_C.pint.units == units("m/s^2").units
    shown = with_units.pint.to({"theta": units.deg, "ec": units.mm, "a_C": "km/s^2"})
    bare = shown.pint.dequantify(format="~C")
    np.testing.assert_allclose(bare.theta, np.degrees(THETA), rtol=1e-15)
    np.testing.assert_allclose(bare.a_C.values, grid.a_C.values / 1000.0, rtol=1e-15)
    assert (bare.theta.attrs["units"], bare.a_C.attrs["units"]) == ("deg", "km/s**2")
    plain = with_units.pint.dequantify(format="~C")
    np.testing.assert_array_equal(plain.a_C, grid.a_C)
    assert plain.a_C.attrs["units"] == "m/s**2"


def test_pint_knows_every_unit():
    registry = pint.UnitRegistry()
    for name, row in dx.quantities().items():
        assert registry.Quantity(1.0, row.unit).to_base_units().magnitude == pytest.approx(1.0), name


DEGREES = np.array([0.0, 90.0, 180.0])


@pytest.fixture(scope="module")
def own_units():
    return pint.UnitRegistry()


@pytest.mark.parametrize(
    "theta",
    [
        ["0 deg", "90 deg", "180 deg"],
        lambda own, units: DEGREES * own.deg,
        lambda own, units: DEGREES * units.deg,
        xr.DataArray(DEGREES, dims="theta", attrs={"units": "deg"}),
        lambda own, units: xr.DataArray(DEGREES * own.deg, dims="theta"),
        xr.DataArray(np.radians(DEGREES), dims="theta", attrs={"units": "rad"}),
        xr.DataArray(np.radians(DEGREES), dims="theta"),
    ],
    ids=["text", "pint", "pint-xarray", "units", "quantified", "radians", "bare"],
)
def test_units_at_the_border(theta, units, own_units):
    theta = theta(own_units, units) if callable(theta) else theta
    result = dx.grid("a_C", theta=theta, ec="10 mm", AB=125 * own_units.mm, BC="0.35 m", omega0="1500 rpm")
    np.testing.assert_allclose(result.theta, np.radians(DEGREES), rtol=1e-15)
    assert result.theta.attrs["units"] == "rad"
    assert (result.ec.item(), result.AB.item(), result.BC.item()) == (0.01, 0.125, 0.35)
    assert result.omega0.item() == pytest.approx(50 * np.pi, rel=1e-15)


def test_a_coordinate_in_other_units_is_converted_everywhere():
    ec = xr.DataArray(np.array([0.0, 100.0]), dims="ec", attrs={"units": "mm"})
    metres = dx.evaluate("a_C", theta=1.0, ec=np.array([0.0, 0.1]), **MACHINE)
    np.testing.assert_array_equal(dx.evaluate("a_C", theta=1.0, ec=ec, **MACHINE), metres)
    alone = dx.evaluate("a_C", theta=1.0, ec=0.1, **MACHINE)
    assert dx.evaluate("a_C", theta=1.0, ec=ec[1], **MACHINE) == alone


@pytest.mark.parametrize(
    ("unit", "words"),
    [
        ("kg", "theta in 'kg': it must be a quantity in rad"),
        ("of a turn", "theta in 'of a turn': unknown unit"),
    ],
)
def test_units_that_do_not_fit(unit, words):
    with pytest.raises(ValueError, match=words):
        dx.grid("Y", theta=xr.DataArray(DEGREES, dims="t", attrs={"units": unit}), ec=0, AB=0.1, BC=0.3)


def test_series_of_different_rows_are_not_paired_by_position():
    theta, ec = pd.Series([0.0, 1.0, 2.0]), pd.Series([0.0, 0.1, 0.2])
    together = dx.evaluate("a_C", theta=theta, ec=ec, **MACHINE)
    np.testing.assert_array_equal(together, dx.evaluate("a_C", theta=theta.values, ec=ec.values, **MACHINE))
    with pytest.raises(ValueError, match=r"theta and ec: their labels differ along their rows"):
        dx.evaluate("a_C", theta=theta, ec=ec[::-1], **MACHINE)
