"""Labelled inputs: DataArrays broadcast by their dimensions, Series by the name of their index."""

import numpy as np
import pytest

import desaxe as dx
from tests.effort import first

pd, xr = pytest.importorskip("pandas"), pytest.importorskip("xarray")

MACHINE = {"AB": 0.125, "BC": 0.35, "omega0": 157.08}
ANGLES, ECS = np.linspace(0.0, 6.0, 5), np.array([0.0, 0.1, 0.2])
THETA = xr.DataArray(ANGLES, dims="theta", coords={"theta": ANGLES})
EC = xr.DataArray(ECS, dims="design", coords={"design": list("abc"), "maker": ("design", [1, 2, 3])})
LOADED = {"m_slider": 2.0, "mu": 0.05}


@pytest.mark.parametrize(
    ("names", "inputs"),
    [
        (["a_C", "status"], {}),
        (["T_in", "T_in_wrt_ec"], {**LOADED, "F_Y": -50.0}),
        (["T_in", "T_in_wrt_ec"], {**LOADED, "F_Y": dx.over_theta([0.0, 2.0, 4.0], [0.0, -500.0, 0.0])}),
        (
            ["T_in"],
            {**LOADED, "F_Y": dx.over_Y([0.2, 0.3, 0.4], outward=[0.0, -9.0, -9.0], inward=[0.0] * 3)},
        ),
        (["T_in"], {**LOADED, "F_Y": dx.over_theta(np.sin)}),
    ],
)
def test_dimensions_broadcast_by_name(names, inputs):
    result = dx.evaluate(names, theta=THETA, ec=EC, **MACHINE, **inputs)
    expected = dx.evaluate(names, theta=ANGLES[:, None], ec=ECS, **MACHINE, **inputs)
    turned = dx.evaluate(names, theta=ANGLES, ec=ECS[:, None], **MACHINE, **inputs)
    for name in names:
        assert result[name].dims == ("theta", "design")
        assert result[name].dtype == expected[name].dtype
        np.testing.assert_allclose(result[name], expected[name], rtol=1e-12)
        np.testing.assert_allclose(result[name], turned[name].T, rtol=1e-12)
        assert result[name].maker.values.tolist() == [1, 2, 3]
    quantity = names[0]
    assert result[quantity].attrs["units"] == dx.quantities()[quantity].unit
    one = dx.evaluate(quantity, theta=THETA, ec=EC, **MACHINE, **inputs)
    xr.testing.assert_allclose(one, result[quantity], rtol=1e-12)
    assert one.attrs == result[quantity].attrs


def test_a_design_alone_has_its_dimension():
    result = dx.evaluate("stroke", ec=EC, AB=0.125, BC=0.35)
    assert result.dims == ("design",)
    assert result.sel(design="b").item() == dx.events(ec=0.1, AB=0.125, BC=0.35)["stroke"]


def test_units_of_attributes_and_of_a_machine():
    """An attribute `units` counts; without one the units of the machine do, and answers are in them."""
    millimetres = (1e3 * EC).assign_attrs(units="mm")
    result = dx.evaluate("V_C", theta=THETA, ec=millimetres, **MACHINE)
    np.testing.assert_allclose(result, dx.evaluate("V_C", theta=THETA, ec=EC, **MACHINE), rtol=1e-14)
    machine = dx.Machine(ec=0, AB=125, BC=350, omega0="157.08 rad/s", units="mm, deg, rpm")
    for given in (millimetres, 1e3 * EC):
        shown = machine.evaluate(["V_C", "status"], theta=np.rad2deg(THETA), ec=given)
        np.testing.assert_allclose(shown["V_C"], 1e3 * result, rtol=1e-12)
        assert shown["V_C"].attrs["units"] == "mm/s"
        assert shown["status"].dims == ("theta", "design")


@pytest.mark.parametrize("labelled", [True, False])
@pytest.mark.parametrize("call", [dx.evaluate, dx.peak])
def test_a_dask_array_is_refused_with_the_remedy(call, labelled):
    pytest.importorskip("dask.array")
    ec = EC.chunk(2) if labelled else EC.chunk(2).data
    with pytest.raises(TypeError, match=r"^ec: a Dask array; give ec\.compute\(\), or grid\(..., chunks=\)"):
        call("a_C", **{"theta": THETA[0].item()} if call is dx.evaluate else {}, ec=ec, **MACHINE)


@pytest.mark.parametrize("dask_way", ["parallelized", "allowed"])
def test_apply_ufunc_goes_chunk_by_chunk(dask_way):
    pytest.importorskip("dask.array")
    result = xr.apply_ufunc(
        lambda theta, ec: dx.evaluate("a_C", theta=theta, ec=ec, **MACHINE),
        *((THETA.chunk(2), EC) if dask_way == "parallelized" else (THETA, EC)),
        dask=dask_way, output_dtypes=[float],
    )  # fmt: skip
    np.testing.assert_allclose(result, dx.evaluate("a_C", theta=THETA, ec=EC, **MACHINE), rtol=1e-12)


def test_a_variable_has_no_coordinates_and_broadcasts_by_position():
    result, plain = (
        dx.evaluate(["a_C", "status"], theta=theta, ec=ECS[0], **MACHINE)
        for theta in (xr.Variable("k", ANGLES), ANGLES)
    )
    np.testing.assert_allclose(result["a_C"], plain["a_C"], rtol=1e-12)


def test_what_does_not_fit_is_refused():
    with pytest.raises(ValueError, match=r"theta \('theta',\), ec \('design',\); .*xarray\.broadcast"):
        dx.evaluate("a_C", theta=THETA, ec=EC, out=np.empty((5, 3)), **MACHINE)  # it has no labels
    with pytest.raises(ValueError, match="theta"):
        dx.evaluate("a_C", theta=THETA, ec=0.0 * THETA[1:], **MACHINE)
    with pytest.raises(ValueError, match=r"BC: an array without labels beside"):
        dx.evaluate("a_C", theta=THETA, ec=EC, AB=0.125, BC=[0.3, 0.35, 0.4], omega0=1.0)
    with pytest.raises(ValueError, match="labelled arrays of different dimensions"):
        dx.evaluate("a_C", theta=THETA, ec=EC, quality=True, **MACHINE)


@pytest.mark.parametrize(
    "load", first(1, [dx.over_theta([0.0, 2.0, 4.0], [0.0, -500.0, 0.0]), dx.over_theta(np.sin), None])
)
@pytest.mark.parametrize("kind", [pd.Series, lambda *columns: pd.Series(*columns).to_xarray()])
def test_inputs_of_one_index_or_dimension_vary_together_in_a_grid(kind, load):
    designs = pd.Index(["first", "second"], name="design")
    ec, AB = (kind(numbers, designs) for numbers in ([0.0, 0.1], [0.12, 0.1]))
    inputs = {"theta": ANGLES, "BC": [0.35, 0.4], "omega0": 10.0, "m_slider": 2.0}
    inputs |= {} if load is None else {"F_Y": load}
    result = dx.grid(["T_in", "a_C"], ec=ec, AB=AB, **inputs)
    assert dict(result.sizes) == {"theta": 5, "BC": 2, "design": 2}
    assert result.ec.dims == result.AB.dims == ("design",)
    for k, name in enumerate(designs):
        alone = dx.grid(["T_in", "a_C"], ec=float(ec.values[k]), AB=float(AB.values[k]), **inputs)
        for variable in ("T_in", "a_C", "status", "margin"):
            here = result[variable].sel(design=name)
            np.testing.assert_allclose(here.transpose(*alone[variable].dims), alone[variable], rtol=1e-12)
            assert result[variable].attrs.get("units") == alone[variable].attrs.get("units")
    machine = dx.Machine(AB=1, BC=350, omega0="10 rad/s", m_slider=2, units="mm")
    of_machine = machine.grid("a_C", theta=ANGLES, ec=1e3 * ec, AB=1e3 * AB, BC=[350, 400])
    np.testing.assert_allclose(of_machine.a_C.transpose(*result.a_C.dims), 1e3 * result.a_C, rtol=1e-12)
    assert of_machine.ec.values.tolist() == [0.0, 100.0]
    with pytest.raises(ValueError, match="design"):
        dx.grid("a_C", ec=ec[:1], AB=AB, **inputs)


@pytest.mark.parametrize(
    "load", first(1, [dx.over_Y([0.2, 0.3, 0.4], [90.0, -400.0, 50.0], [0.0] * 3), None])
)
def test_a_shared_dimension_is_reduced_cut_filled_and_stored(load, tmp_path):
    """As each of its designs alone, and as NumPy takes extremes and means of these."""
    ec, AB = (xr.DataArray(v, dims="design", coords=EC.coords) for v in ([0.0, 0.1, 0.05], [0.12, 0.1, 0.15]))
    inputs = {"theta": ANGLES, "BC": [0.35, 0.4], "omega0": 10.0, "m_slider": 2.0}
    inputs |= {} if load is None else {"F_Y": load}
    shared = {"ec": ec, "AB": AB, **inputs}
    alone = [dx.grid("T_in", **{**inputs, "ec": ec[k].item(), "AB": AB[k].item()}).T_in for k in range(3)]
    whole = np.stack([one.transpose("theta", "BC") for one in alone])
    every = dx.grid("T_in", chunks={"design": 2, "theta": 3}, **shared).compute(scheduler="synchronous")
    np.testing.assert_array_equal(every.T_in.transpose("design", "theta", "BC"), whole)
    assert every.design.values.tolist() == ["a", "b", "c"]
    assert every.maker.values.tolist() == [1, 2, 3]
    out = np.empty((3, 5, 2))
    assert dx.grid("T_in", out=out, **shared)["T_in"] is out
    np.testing.assert_array_equal(out, whole)
    by_theta = dx.grid("T_in", reduce={"theta": ["absmax", "mean"]}, **shared)
    assert by_theta.T_in_absmax.dims == ("design", "BC")
    np.testing.assert_array_equal(by_theta.T_in_absmax, np.abs(whole).max(axis=1))
    np.testing.assert_allclose(by_theta.T_in_mean, whole.mean(axis=1), rtol=1e-12)
    by_design = dx.grid("T_in", reduce={("theta", "design"): "max"}, **shared)
    assert by_design.T_in_max.dims == ("BC",)
    np.testing.assert_array_equal(by_design.T_in_max, whole.max(axis=(0, 1)))
    place = by_design.isel(BC=0)
    design, angle = int(place.T_in_max_design), float(place.T_in_max_theta)
    assert whole[design, ANGLES.tolist().index(angle), 0] == place.T_in_max
    at = dx.grid("T_in", reduce={"theta": [("at", ANGLES[2], "T_in")]}, **shared)
    np.testing.assert_array_equal(at.to_array()[0].transpose("design", "BC"), whole[:, 2])
    with pytest.raises(TypeError, match="expected one value of design"):
        dx.grid("T_in", reduce={"design": [("at", 1.0, "T_in")]}, **shared)
    numbered = {**shared, **{n: shared[n].assign_coords(design=[4, 5, 6]) for n in ("ec", "AB")}}
    store = dx.sweep("T_in", peaks="T_in", store=tmp_path / "designs.zarr", chunks={"design": 2}, **numbered)
    np.testing.assert_array_equal(store.T_in.transpose("design", "theta", "BC"), whole)
    alone = dx.peak("T_in", **{**inputs, "theta": (ANGLES[0], ANGLES[-1]), "ec": 0.1, "AB": 0.1, "BC": 0.4})
    assert float(store.peak_absmax_T_in.sel(design=5, BC=0.4)) == pytest.approx(alone["value"], rel=1e-12)


def test_a_series_without_a_name_of_its_index_is_an_axis():
    result = dx.grid("a_C", theta=ANGLES, ec=pd.Series(ECS), **MACHINE)
    assert result.a_C.dims == ("theta", "ec")


def test_an_unknown_input_beside_series_with_an_index_is_named():
    ec = pd.Series([0.0, 0.1], pd.Index(["a", "b"], name="design"))
    with pytest.raises(TypeError, match=r"grid\(\) has no input 'thta'"):
        dx.grid("a_C", thta=1.0, ec=ec, **MACHINE)


PLAIN = {"AB": 0.125, "omega0": 157.08}
BY_POSITION = {  # calls whose arrays broadcast by position: of one shape, and the inputs that they vary
    "peak": lambda **ab: dx.peak("a_C", **ab, **PLAIN),
    "a machine's peak": lambda **ab: dx.Machine(**PLAIN).peak("a_C", **ab),
    "events": lambda **ab: dx.events(AB=0.125, **ab),
    "feasibility": lambda **ab: dx.feasibility(AB=0.125, **ab),
    "inverse": lambda **ab: dx.inverse(Y=0.4, AB=0.125, **ab),
    "crossings": lambda **ab: dx.crossings("V_C", **ab, **PLAIN),
    "simulate": lambda **ab: dx.simulate(
        torque=0.0, t_end=0.01, I_crank=1.0, omega_start=10.0, AB=0.125, **ab
    ),
    "steady": lambda **ab: dx.steady(torque=dx.kloss(40.0, 0.15, 157.08), I_crank=1.0, AB=0.125, **ab),
    "quality": lambda **ab: dx.evaluate("a_C", theta=1.0, quality=True, **ab, **PLAIN),
}
BY_NAME = {  # those that broadcast by dimensions
    "evaluate": lambda **ab: dx.evaluate("a_C", theta=1.0, **ab, **PLAIN),
    "function": dx.function("a_C", ("ec", "BC"), theta=1.0, **PLAIN),
    "jacobian": lambda **ab: dx.function("a_C", ("ec", "BC"), theta=1.0, **PLAIN).jacobian(**ab),
    "grid": lambda **ab: dx.grid("a_C", theta=1.0, **ab, **PLAIN),
    "design_map": lambda **ab: dx.design_map("stroke", **ab, **PLAIN),
}


def designs(labels, kind="DataArray", dim="design", values=(0.35, 0.4, 0.3)):
    """Values of designs by label."""
    if kind == "Series":
        return pd.Series(values, pd.Index(list(labels), name=dim))
    return xr.DataArray(list(values), {dim: list(labels)}, dim)


@pytest.mark.parametrize("kind", ["DataArray", "Series"])
@pytest.mark.parametrize("name", [*BY_POSITION, *BY_NAME])
def test_other_labels_are_refused_by_name(name, kind):
    call, ec = (BY_POSITION | BY_NAME)[name], designs("abc", kind, values=[0.0, 0.05, 0.1])
    words = r"(ec and BC|BC and ec): their labels differ along (design|their rows), \['[ac]', '[ab]'"
    for other in ("cab", "xyz"):
        with pytest.raises(ValueError, match=words if other == "cab" else "their labels differ"):
            call(ec=ec, BC=designs(other, kind))
    call(ec=ec, BC=designs("abc", kind))


@pytest.mark.parametrize("name", BY_POSITION)
def test_other_dimensions_are_refused_where_arrays_broadcast_by_position(name):
    ec, BC = designs("abc", values=[0.0, 0.05, 0.1]), designs("abc", dim="lot")
    with pytest.raises(ValueError, match=r"(ec \('design',\)|BC \('lot',\)), (ec|BC) .*xarray\.broadcast"):
        BY_POSITION[name](ec=ec, BC=BC)


def test_broadcast_labelled_designs_of_a_peak_are_those_of_each_alone():
    ec, BC = xr.broadcast(designs("ab", values=[0.0, 0.05]), designs("xy", dim="lot", values=[0.35, 0.4]))
    alone = [[dx.peak("a_C", ec=e, BC=b, **PLAIN)["value"] for b in (0.35, 0.4)] for e in (0.0, 0.05)]
    np.testing.assert_array_equal(dx.peak("a_C", ec=ec, BC=BC, **PLAIN)["value"], alone)


def test_other_sizes_and_rows_beside_labels_are_refused_by_name():
    with pytest.raises(ValueError, match="ec and BC: 3 and 2 values along design"):
        dx.evaluate("a_C", theta=1.0, ec=designs("abc"), BC=designs("ab", values=[0.3, 0.4]), **PLAIN)
    for call in (dx.evaluate, dx.peak):
        angle = {"theta": 1.0} if call is dx.evaluate else {}
        with pytest.raises(ValueError, match="BC and ec: their labels differ along their rows"):
            call("a_C", ec=designs("abc"), BC=designs("cab", "Series"), **angle, **PLAIN)


@pytest.mark.parametrize("kind", ["DataArray", "Series"])
def test_a_design_map_has_one_axis_for_inputs_of_one_dimension(kind):
    ec, BC = designs("abc", kind, values=[0.0, 0.05, 0.1]), designs("abc", kind)
    result = dx.design_map([("absmax", "a_C"), "stroke"], ec=ec, BC=BC, **PLAIN)
    assert dict(result.sizes) == {"design": 3}
    assert list(result.design.values) == ["a", "b", "c"]
    assert result.ec.dims == result.BC.dims == result.stroke.dims == ("design",)
    alone = [dx.peak("a_C", ec=e, BC=b, **PLAIN)["value"] for e, b in zip(ec.values, BC.values, strict=True)]
    np.testing.assert_allclose(result.absmax_a_C, alone, rtol=1e-14)


def test_other_labels_of_a_shaft_are_refused_by_name():
    shaft = dx.Crankshaft([dx.Machine(ec=0.0, AB=0.125, BC=0.35, m_slider=1.0)] * 2, phase=[0.0, 3.0])
    with pytest.raises(ValueError, match=r"(omega0 and alpha|alpha and omega0): their labels differ"):
        shaft.peak("F_shaking_Y", omega0=designs("abc"), alpha=designs("cab"))
