"""Quantities of a whole design: in every call, over the lengths alone, as `events` has them."""

import numpy as np
import pytest

import desaxe as dx
from desaxe.mechanism.names import LENGTHS, WHOLE
from tests.effort import first

DESIGN = {"ec": 0.02, "AB": 0.04, "BC": 0.064}
ECS = np.array([-0.02, 0.0, 0.01, 0.024, 0.03, 0.2])
LONG = {"AB": 0.04, "BC": 0.064}
NAMES = [*WHOLE, *(f"{name}_wrt_{p}" for name in WHOLE for p in LENGTHS)]


def expected(name, result):
    base, _, p = name.partition("_wrt_")
    return result["gradient"][base][p] if p else result[name]


@pytest.mark.parametrize("branch", [1, -1])
@pytest.mark.parametrize("omega0", [None, 3.0, -3.0])
def test_they_are_those_of_events(branch, omega0):
    one = dx.events(branch=branch, omega0=omega0, **DESIGN)
    result = dx.evaluate(NAMES, branch=branch, omega0=omega0, **DESIGN)
    assert dict(result) == {name: expected(name, one) for name in NAMES}
    many = dx.events(branch=branch, omega0=omega0, ec=ECS, **LONG)
    arrays = dx.evaluate([*NAMES, "status"], branch=branch, omega0=omega0, ec=ECS, **LONG)
    for name in NAMES:
        np.testing.assert_allclose(arrays[name], expected(name, many), rtol=1e-14, err_msg=name)
    np.testing.assert_array_equal(arrays["status"], many["status"])


def test_without_theta_the_status_is_that_of_the_design():
    assert dx.evaluate(["stroke", "status"], ec=0.03, **LONG)["status"] == 1
    assert dx.evaluate(["stroke", "status"], theta=0.0, ec=0.03, **LONG)["status"] == 0
    assert np.isnan(dx.evaluate("stroke", theta=0.0, ec=0.03, **LONG))
    assert dx.evaluate(["stroke", "status"], ec=[0.0, np.nan], **LONG)["status"].tolist() == [0, 4]


def test_they_need_neither_theta_nor_speed_and_have_the_dimensions_of_the_lengths():
    theta = np.linspace(0.0, 6.0, 5)
    alone = dx.grid(["stroke", "time_ratio"], ec=ECS, **LONG)
    assert alone.stroke.dims == alone.status.dims == ("ec",)
    both = dx.grid(["stroke", "Y"], theta=theta, ec=ECS, AB=[0.03, 0.04], BC=0.064)
    assert set(both.stroke.dims) == {"ec", "AB"}
    assert set(both.Y.dims) == set(both.status.dims) == {"theta", "ec", "AB"}
    lazy = dx.grid(["stroke", "Y"], theta=theta, ec=ECS, AB=[0.03, 0.04], BC=0.064, chunks=2)
    np.testing.assert_array_equal(lazy.stroke.transpose(*both.stroke.dims), both.stroke)


@pytest.mark.parametrize("name", ["stroke", "theta_outer_wrt_AB", "margin"])
def test_over_theta_they_have_no_peak_and_no_reduction(name):
    with pytest.raises(ValueError, match=f"{name}"):
        dx.peak(name, omega0=1.0, **DESIGN)
    with pytest.raises(ValueError, match=f"{name}"):
        dx.grid([name], theta=[0.0, 1.0], ec=ECS, reduce={"theta": "max"}, **LONG)


def test_a_derivative_by_theta_is_unknown():
    for name in ("stroke_wrt_theta", "time_ratio_wrt_omega0", "Y_outer_wrt_alpha"):
        with pytest.raises(ValueError, match="unknown"):
            dx.evaluate(name, **DESIGN)
        assert name not in dx.quantities()


def test_strokes_hang_on_the_sign_of_each_speed():
    speeds = np.array([1.0, -1.0, 2.0, np.nan])
    strokes = ["advance_angle", "return_angle", "advance_angle_wrt_BC"]
    known = dx.events(omega0=speeds, **DESIGN)
    result = dx.evaluate(strokes, omega0=speeds, **DESIGN)
    for name in strokes:
        np.testing.assert_allclose(result[name], expected(name, known), rtol=1e-15)
    both = dx.grid(["advance_angle", "stroke"], ec=ECS, omega0=speeds, **LONG)
    assert both.advance_angle.dims == ("ec", "omega0")
    assert both.stroke.dims == ("ec",)
    many = dx.events(ec=ECS[:, None], omega0=speeds, **LONG)
    np.testing.assert_allclose(both.advance_angle, many["advance_angle"], rtol=1e-14)
    state = dx.evaluate("return_angle", omega=-3.0, **DESIGN)
    assert state == dx.evaluate("advance_angle", **DESIGN)
    one = dx.grid(["advance_angle"], ec=ECS, omega0=-speeds[:1:2], **LONG)
    assert one.advance_angle.dims == ("ec",)
    assert one.advance_angle[0] == dx.evaluate("return_angle", ec=ECS[0], **LONG)


def test_what_is_made_of_a_stroke_hangs_on_the_sign_too():
    dx.define("share", "advance_angle/6", unit="rad")
    try:
        speeds = np.array([2.0, -2.0])
        strokes = dx.evaluate("advance_angle", omega0=speeds, **DESIGN)
        np.testing.assert_allclose(dx.evaluate("share", omega0=speeds, **DESIGN), strokes / 6, rtol=1e-15)
        assert dx.evaluate("share", omega0=-2.0, **DESIGN) == strokes[1] / 6
    finally:
        dx.undefine("share")


def test_a_grid_has_its_axes_in_the_order_given_whatever_name_comes_first():
    for name in ("stroke", "margin", "V_C"):
        for chunks in (None, 2):
            result = dx.grid([name, "V_C"], theta=[0.0, 1.0], ec=ECS, omega0=1.0, chunks=chunks, **LONG)
            assert list(result.sizes) == ["theta", "ec"]


def test_what_is_made_of_them_is_of_the_whole_design_too():
    dx.define("slenderness", "stroke/BC", unit="1")
    try:
        assert dx.evaluate("slenderness", **DESIGN) == dx.evaluate("stroke", **DESIGN) / 0.064
        assert dx.grid(["slenderness"], ec=ECS, **LONG).slenderness.dims == ("ec",)
        with pytest.raises(ValueError, match="slenderness"):
            dx.peak("slenderness", omega0=1.0, **DESIGN)
    finally:
        dx.undefine("slenderness")


def test_enclosures_hold_what_is_in_them():
    for name in ("stroke", "time_ratio", "theta_outer", "max_pressure_angle"):
        result = dx.enclose(name, ec=dx.between(-0.01, 0.02), AB=dx.between(0.03, 0.04), BC=0.08)
        inside = [
            dx.evaluate(name, ec=ec, AB=AB, BC=0.08)
            for ec in np.linspace(-0.01, 0.02, 7)
            for AB in np.linspace(0.03, 0.04, 5)
        ]
        assert result["lower"] <= min(inside) + 1e-15  # these are rounded
        assert max(inside) - 1e-15 <= result["upper"]


@pytest.mark.parametrize(
    "name", first(1, ["time_ratio", "stroke", "Y_inner", "max_pressure_angle", "theta_inner"])
)
def test_the_equation_has_the_value(name):
    for each in (name, f"{name}_wrt_AB"):
        for form in ("textbook", "stable"):
            expression = dx.equation(each, form).expression
            values = {s: {**DESIGN, "branch": 1}[s.name] for s in expression.free_symbols}
            assert float(expression.subs(values)) == pytest.approx(dx.evaluate(each, **DESIGN), rel=1e-9)


@pytest.fixture
def slenderness():
    """A quantity of a whole design of a user's own."""
    dx.define("slenderness", "stroke/BC", unit="1")
    yield "slenderness"
    dx.undefine("slenderness")


def test_what_is_made_of_them_is_mapped_optimised_and_toleranced(slenderness):
    axes = {"ec": np.linspace(0.0, 0.02, 5), "AB": np.linspace(0.02, 0.04, 3)}
    expected = dx.evaluate("stroke", ec=axes["ec"][:, None], AB=axes["AB"], BC=0.064) / 0.064
    chart = dx.design_map([slenderness], derivatives=True, BC=0.064, **axes)
    np.testing.assert_allclose(chart[slenderness], expected, rtol=1e-14)
    slope = dx.evaluate("stroke_wrt_AB", ec=axes["ec"][:, None], AB=axes["AB"], BC=0.064) / 0.064
    np.testing.assert_allclose(chart[f"{slenderness}_wrt_AB"], slope, rtol=1e-13)
    over = {"ec": (0.0, 0.02), "AB": (0.02, 0.04)}
    result = dx.optimize(over=over, BC=0.064, maximize=slenderness, keep={"time_ratio": (None, 1.2)})
    assert result["status"] == 0
    assert result["value"] == pytest.approx(
        dx.evaluate(slenderness, ec=result["ec"], AB=result["AB"], BC=0.064)
    )
    assert dx.events(ec=result["ec"], AB=result["AB"], BC=0.064)["time_ratio"] == pytest.approx(1.2)
    spread = dx.tolerance(slenderness, ec=0.01, AB=dx.plus_minus(0.04, 0.001), BC=0.064)
    assert spread["gradient"]["AB"] == pytest.approx(dx.evaluate(f"{slenderness}_wrt_AB", ec=0.01, **LONG))


def test_a_derivative_is_no_objective():
    with pytest.raises(ValueError, match="did you mean 'stroke'"):
        dx.optimize(over={"ec": (0.0, 0.02)}, AB=0.04, BC=0.064, maximize="stroke_wrt_AB")
