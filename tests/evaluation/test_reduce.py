"""Reductions of an axis: against NumPy on the stored grid, from small and from compiled grids."""

import warnings

import numpy as np
import pytest

import desaxe as dx
from desaxe.evaluation.points import Points
from desaxe.evaluation.reductions import kinds
from desaxe.evaluation.reductions.reduced import BLOCK

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
    result = dx.grid(names, reduce={reduced_axis: KINDS}, **inputs)
    whole = dx.grid(names, **inputs)
    for name in names:
        values, axis = whole[name].values, whole[name].get_axis_num(reduced_axis)
        scale = np.nanmax(np.abs(values))
        for kind in KINDS:
            expected = by_numpy(kind, values, axis)
            if kind in ("mean", "rms"):
                np.testing.assert_allclose(result[f"{name}_{kind}"], expected, rtol=1e-13, atol=1e-14 * scale)
            else:
                np.testing.assert_array_equal(result[f"{name}_{kind}"], expected)
        turned = {"max": values, "min": -values, "absmax": np.abs(values)}
        for kind, its in turned.items():
            at = np.argmax(np.where(np.isnan(its), -np.inf, its), axis)
            place = np.where(np.isnan(its).all(axis), np.nan, np.asarray(inputs[reduced_axis])[at])
            np.testing.assert_array_equal(result[f"{name}_{kind}_{reduced_axis}"], place)
        np.testing.assert_array_equal(result[f"{name}_skipped"], np.isnan(values).sum(axis))
    return result


# Up to a fully infeasible design. One kernel serves all that reduce these.
NAMES, DESIGNS = ["a_C", "V_C"], {"ec": [0.0, 0.2, 0.24, 0.6], "BC": [0.35, 0.4], **MACHINE}


def test_over_theta_with_infeasible_designs():
    result = compare(NAMES, "theta", theta=TURN[::18], **DESIGNS)  # rows of 40 leave a rest after the lanes
    assert result.a_C_absmax.dims == ("ec", "BC")
    assert int(result.a_C_skipped.sel(ec=0.6, BC=0.35)) == 41
    assert np.isnan(result.a_C_rms.sel(ec=0.6, BC=0.35))
    assert 0 < int(result.a_C_skipped.sel(ec=0.24, BC=0.35)) < 41


@pytest.mark.thorough
def test_over_another_axis():
    result = compare(["a_C"], "ec", ec=np.linspace(-0.2, 0.24, 23), theta=TURN[::60], BC=0.35, **MACHINE)
    assert result.a_C_max.dims == ("theta",)
    assert result.a_C_max_ec.units == "m"


@pytest.mark.thorough
def test_of_one_design():
    result = compare(["a_C"], "theta", theta=TURN[::10], ec=0.01, BC=0.35, **MACHINE)
    assert result.a_C_absmax.dims == ()


@pytest.mark.thorough
def test_bad_elements_are_skipped():
    theta = TURN[::10].copy()
    theta[[3, 50]] = np.nan, np.inf
    result = compare(["a_C"], "theta", theta=theta, ec=[0.01, 0.02], BC=0.35, **MACHINE)
    assert result.a_C_skipped.values.tolist() == [2, 2]


@pytest.mark.thorough
def test_rows_longer_than_a_block():
    theta = np.linspace(0.0, 7.0, BLOCK + 5)
    compare(["a_C"], "theta", theta=theta, ec=[0.0, 0.2, 0.23], BC=[0.35, 0.4], **MACHINE)


def test_squares_of_any_scale():
    unit = dx.grid(NAMES, theta=TURN[::30], **{**DESIGNS, "omega0": 1.0})
    expected = by_numpy("rms", unit.a_C, 0)
    for speed in (1e-59, 1e59):
        result = dx.grid(NAMES, reduce={"theta": KINDS}, theta=TURN[::30], **{**DESIGNS, "omega0": speed})
        np.testing.assert_allclose(result.a_C_rms / speed / speed, expected, rtol=1e-14)


def test_the_sum_keeps_what_rounding_takes():
    # V_C is 20 m/s; its mean over angles that are symmetric to 0 is 0, exactly.
    theta = np.arange(-100_000, 100_001) * 2.0**-15
    result = dx.grid(NAMES, reduce={"theta": KINDS}, theta=theta, **DESIGNS)
    assert (abs(result.V_C_mean.sel(ec=0.0)) < 1e-22).all()


def test_threads_change_nothing():
    inputs = {"theta": TURN, "ec": np.linspace(-0.1, 0.24, 301), "BC": [0.35, 0.36], **MACHINE}
    one, two, five = (
        dx.grid(["a_C", "V_C"], reduce={"theta": KINDS}, threads=threads, **inputs) for threads in (1, 2, 5)
    )
    assert one.identical(two)
    assert one.identical(five)


def test_threads_leave_the_filters_of_warnings():
    """Filters are of all threads: rows without a number are NaN without changing any."""
    filters = list(warnings.filters)
    designs = {**MACHINE, "ec": np.linspace(0.0, 0.9, 40), "BC": 0.35}
    for _ in range(4):
        dx.grid(["a_C"], reduce={"theta": KINDS}, theta=TURN, threads=4, **designs)
    assert warnings.filters == filters


def test_the_grid_is_never_stored(monkeypatch):
    compute, sizes = Points.compute, []

    def computed(*args):
        arrays = compute(*args)
        sizes.append(max(array.size for array in arrays.values()))
        return arrays

    monkeypatch.setattr(Points, "compute", computed)
    result = dx.grid(
        NAMES, reduce={"theta": KINDS}, theta=TURN, **DESIGNS | {"ec": np.linspace(0.0, 0.6, 97)}
    )
    assert sum(sizes) == TURN.size * 97 * 2
    assert max(sizes) <= BLOCK
    message = [*KINDS, *(f"{kind}_theta" for kind in KINDS[:3]), "skipped"]
    assert set(result.data_vars) == {f"{name}_{what}" for name in NAMES for what in message}


def test_labels():
    result = dx.grid(
        "a_C", reduce={"theta": ["absmax", "rms"]}, theta=TURN[:9], ec=[0, 0.1], BC=0.35, **MACHINE
    )
    assert result.a_C_absmax.attrs["cell_methods"] == "theta: maximum_absolute_value"
    assert result.a_C_rms.attrs["cell_methods"] == "theta: root_mean_square"
    assert result.a_C_absmax.units == "m/s^2"
    assert result.a_C_absmax_theta.units == "rad"
    assert "theta" not in result.coords


@pytest.mark.parametrize(
    ("reduce", "message"),
    [
        ({"BC": "max"}, "reduce: 'BC' is not an axis of this grid; axes: theta, ec"),
        ({"thta": "max"}, "did you mean theta?"),
        ({"theta": "absmx"}, "did you mean absmax?"),
        ({"theta": []}, "nothing is taken of theta"),
        ({"theta": "max", ("ec", "theta"): "max"}, "reduce: 'theta' is reduced twice"),
        ("theta", "it must map an axis to a reduction"),
        ({}, "it must map an axis to a reduction"),
        ({"theta": "p101"}, "a percentile is from p0 to p100"),
        ({"theta": ("max", "V_C")}, "reduce: nothing is taken of a_C"),
        ({"theta": ["max", ("max", "a_D")]}, "unknown quantity 'a_D'"),
        (
            {"theta": [lambda d: (1.0, {}), "max", lambda d: (2.0, {})]},
            "two results would be called <lambda>",
        ),
        ({"theta": ("rms", "a_C"), "ec": "max"}, "a measure of one name goes along one axis"),
        ({("theta", "ec"): ("at", 1.0, "a_C")}, "goes along one axis, not theta, ec"),
        ({"theta": np.max}, "reduce: nothing is taken of a_C"),
        ({"theta": ["max", np.max]}, "must give (value, {parameter: derivative}) of numbers"),
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


# ---- several axes, single names, functions --------------------------------------------------------

BOTH = {"theta": TURN[::40], "ec": [0.0, 0.1, 0.24, 0.6], "BC": [0.35, 0.4], **MACHINE}
FEASIBLE = {**BOTH, "ec": [0.0, 0.1, 0.2]}


@pytest.mark.thorough
def test_two_axes_at_once_are_all_their_points():
    result = dx.grid(
        "a_C", reduce={("theta", "ec"): [*KINDS, "std", "median", "p95", ("percentile", 12.5)]}, **BOTH
    )
    values = dx.grid("a_C", **BOTH).a_C.transpose("BC", "theta", "ec").values.reshape(2, -1)
    assert result.a_C_rms.dims == ("BC",)
    for kind in KINDS:
        np.testing.assert_allclose(result[f"a_C_{kind}"], by_numpy(kind, values, -1), rtol=1e-13)
    np.testing.assert_allclose(result.a_C_std, np.nanstd(values, -1), rtol=1e-13)
    for name, q in (("median", 50), ("p95", 95), ("p12.5", 12.5)):
        np.testing.assert_allclose(result[f"a_C_{name}"], np.nanpercentile(values, q, -1), rtol=1e-13)
    np.testing.assert_array_equal(result.a_C_skipped, np.isnan(values).sum(-1))
    for BC, most, theta, ec in zip(
        [0.35, 0.4], result.a_C_absmax, result.a_C_absmax_theta, result.a_C_absmax_ec, strict=True
    ):
        there = dx.evaluate("a_C", theta=float(theta), ec=float(ec), BC=BC, **MACHINE)
        assert abs(there) == pytest.approx(float(most), rel=1e-13)
    assert result.a_C_rms.attrs["cell_methods"] == "theta: ec: root_mean_square"
    assert result.a_C_rms.attrs["units"] == "m/s^2"


def test_one_axis_after_the_other_in_the_order_given():
    whole = dx.grid("a_C", **FEASIBLE).a_C
    result = dx.grid("a_C", reduce={"theta": ["max", "mean"], "ec": ["min", "mean"]}, **FEASIBLE)
    np.testing.assert_allclose(result.a_C_max_min, whole.max("theta").min("ec"), rtol=1e-14)
    np.testing.assert_allclose(result.a_C_max_mean, whole.max("theta").mean("ec"), rtol=1e-14)
    np.testing.assert_allclose(result.a_C_mean, whole.mean(["theta", "ec"]), rtol=1e-12)  # of all points
    np.testing.assert_array_equal(result.a_C_max_min_ec, whole.max("theta").idxmin("ec"))
    there = whole.sel(ec=result.a_C_max_min_ec, theta=result.a_C_max_min_theta)
    np.testing.assert_allclose(there, result.a_C_max_min, rtol=1e-13)
    assert "a_C_max_mean_theta" not in result
    all_points = dx.grid("a_C", reduce={"theta": ["std", "p20"], "ec": ["std", "p20", "max"]}, **FEASIBLE)
    np.testing.assert_allclose(all_points.a_C_std, whole.std(["theta", "ec"]), rtol=1e-12)
    np.testing.assert_allclose(all_points.a_C_p20, whole.quantile(0.2, ["theta", "ec"]), rtol=1e-12)
    np.testing.assert_allclose(all_points.a_C_std_max, whole.std("theta").max("ec"), rtol=1e-12)
    other = dx.grid("a_C", reduce={"ec": "min", "theta": "max"}, **FEASIBLE)
    np.testing.assert_allclose(other.a_C_min_max, whole.min("ec").max("theta"), rtol=1e-14)


def test_measures_of_single_names_and_a_function_of_the_design():
    def squares(design):
        """ec^2 + BC, and its derivatives."""
        return design["ec"] ** 2 + design["BC"], {"ec": 2 * design["ec"], "BC": 1.0}

    inputs = {**FEASIBLE, "m_slider": 2.0}
    asked = [("rms", "T_in"), ("at", "60 deg", "Y"), (("percentile", 95), "T_in"), squares]
    result = dx.grid([], reduce=asked, **inputs)
    whole = dx.grid("T_in", **inputs).T_in
    np.testing.assert_allclose(result.T_in_rms, np.sqrt((whole**2).mean("theta")), rtol=1e-13)
    np.testing.assert_allclose(result.T_in_p95, whole.quantile(0.95, "theta"), rtol=1e-12)
    sixty = dx.grid("Y", **{**FEASIBLE, "theta": "60 deg"}).Y
    np.testing.assert_allclose(result.Y_at_60_deg, sixty, rtol=1e-15)
    np.testing.assert_array_equal(result.squares_wrt_ec, np.broadcast_to([[0.0], [0.2], [0.4]], (3, 2)))
    assert result.squares_wrt_BC.dims == ("ec", "BC")
    assert set(result.sizes) == {"ec", "BC"}


def test_a_large_one_is_computed_in_blocks(monkeypatch):
    whole = dx.grid("a_C", reduce={("theta", "ec"): ["p95", "max"]}, **FEASIBLE)
    monkeypatch.setattr("desaxe.evaluation.reductions.reduced.BLOCK", 1)
    assert whole.identical(dx.grid("a_C", reduce={("theta", "ec"): ["p95", "max"]}, **FEASIBLE))


def test_own_quantities_are_told_in_a_reduced_result():
    dx.define("shoe", "0.08 * abs(N_C * V_C)", unit="W")
    try:
        result = dx.grid("shoe", reduce={"theta": "mean"}, **{**FEASIBLE, "m_slider": 1.0})
        assert "0.08 * abs(N_C * V_C)" in result.attrs["quantities"]
    finally:
        dx.undefine("shoe")


def test_in_units_every_result_is_that_of_its_quantity():
    machine = dx.Machine(AB="125 mm", BC="350 mm", ec="10 mm", omega0="1500 rpm", units="mm")
    result = machine.grid("Y", theta=TURN[::40], reduce={"theta": ["std", ("at", "60 deg", "Y")]})
    in_metres = dx.grid("Y", theta=TURN[::40], AB=0.125, BC=0.35, ec=0.01).Y
    assert result.Y_std.units == result.Y_at_60_deg.units == "mm"
    assert float(result.Y_std) == pytest.approx(1000.0 * float(in_metres.std()), rel=1e-12)


def test_a_new_kind_of_reduction_is_one_row(monkeypatch):
    row = kinds.Kind("range", lambda rows, counts: np.nanmax(rows, -1) - np.nanmin(rows, -1), combines=False)
    monkeypatch.setitem(kinds.KINDS, "range", row)
    inputs = {"theta": np.linspace(0.0, 6.0, 13), "ec": [0.0, 0.02], "AB": 0.1, "BC": 0.3, "omega0": 5.0}
    values = dx.grid("a_C", **inputs).a_C
    result = dx.grid("a_C", reduce={"theta": "range"}, **inputs).a_C_range
    np.testing.assert_array_equal(result, values.max("theta") - values.min("theta"))
    assert result.attrs["cell_methods"] == "theta: range"
    with pytest.raises(ValueError, match="reduce: 'rang': did you mean range"):
        dx.grid("a_C", reduce={"theta": "rang"}, **inputs)
