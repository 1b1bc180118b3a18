"""Scatter by derivatives, Monte Carlo and enclosures, against each other and known cases."""

import math
import pickle
import re
from typing import NamedTuple

import numpy as np
import pytest
from scipy import stats

import desaxe as dx

plus_minus = dx.plus_minus
POINT = {
    "theta": 1.0,
    "ec": plus_minus(0.1, 1e-3),
    "AB": "125 mm ± 0.1 mm",
    "BC": plus_minus(0.35, 1e-3),
    "omega0": 157.08,
}


@pytest.fixture(scope="module")
def point():
    return dx.tolerance("a_C", **POINT)


def test_it_prints_three_lines_and_the_rest_on_request(point):
    nominal, spread, causes = repr(point).splitlines()
    assert nominal == f"a_C is {point['value']:.6g} m/s^2 with every input at its mean"
    assert f"{point['monte_carlo']['std']:.4g} m/s^2" in spread
    first, share = next(iter(point["contributions"].items()))
    assert causes.startswith(f"driven by {first} {100 * share:.0f} %")
    assert all(key in point.report() for key in point)
    assert repr(pickle.loads(pickle.dumps(point))) == repr(point)
    peak = dx.tolerance(("absmax", "a_C"), ec="10 mm ± 1 mm", AB=0.1, BC=0.3, omega0=10.0, samples=9)
    assert repr(peak).startswith("absmax of a_C is 1")
    machine = dx.Machine(ec=100, AB=125, BC=350, omega0=157.08, units="mm")
    shown = machine.tolerance("a_C", theta=1.0, AB="125 mm ± 0.1 mm", samples=99)
    assert " mm/s^2 with" in repr(shown)
    blocked = dx.tolerance("stroke", ec="10 mm ± 0.1 mm", AB=0.3, BC=0.1, samples=99)
    assert "nan m with every input at its mean; status 1: no value at the means" in repr(blocked)


def test_the_ways_agree(point):
    assert abs(point["agreement"]["mean"]) < 4
    assert abs(point["agreement"]["std"]) < 4
    assert point["first_order"]["std"] == pytest.approx(point["monte_carlo"]["std"], rel=0.01)
    worst, drawn = point["worst_case"], point["monte_carlo"]
    assert worst["guaranteed"]
    assert worst["lower"] < drawn["percentiles"][0.135] < drawn["percentiles"][99.865] < worst["upper"]
    assert (point["status"], drawn["infeasible"]) == (0, 0.0)


def test_what_is_guaranteed_and_what_is_not(point):
    """At three sigmas a few in a thousand inputs are beyond their tolerance, at one a third of them."""
    worst = point["worst_case"]
    assert (worst["guaranteed"], worst["sigmas"]) == (True, 3.0)
    assert worst["outside"] < 1e-3
    wide = dx.tolerance("a_C", sigmas=1.0, samples=2000, **{**POINT, "AB": 0.125, "BC": 0.35})
    assert wide["worst_case"]["sigmas"] == 1.0
    assert wide["worst_case"]["outside"] == pytest.approx(2 * stats.norm.sf(1.0), abs=0.04)
    assert wide["monte_carlo"]["largest"] > wide["worst_case"]["upper"]
    even = dx.tolerance("a_C", distribution="uniform", samples=2000, **POINT)
    assert (even["worst_case"]["sigmas"], even["worst_case"]["outside"]) == (None, 0.0)


def test_a_range_and_a_tolerance_are_the_same_in_both_calls():
    rest = {"theta": 1.0, "AB": "125 mm", "BC": 0.35, "omega0": 157.08}
    given = [dx.plus_minus("10 mm", "0.1 mm"), dx.between("9.9 mm", "10.1 mm"), dx.plus_minus(0.01, "1 %")]
    given.append(dx.plus_minus("10 mm", "0.1"))  # in the unit of its value
    boxes = [dx.enclose("a_C", ec=ec, **rest) for ec in given]
    assert all(box == boxes[0] for box in boxes)
    texts = ["10 mm +- 0.1", "10 mm ± 0.1 mm", "10 mm +- 1 %"]
    scatter = [dx.tolerance("a_C", ec=ec, samples=10, **rest) for ec in (*given, *texts)]
    assert all(result == scatter[0] for result in scatter)
    worst = scatter[0]["worst_case"]
    assert (worst["lower"], worst["upper"]) == (boxes[0]["lower"], boxes[0]["upper"])


@pytest.mark.parametrize("call", [dx.enclose, dx.tolerance])
@pytest.mark.parametrize("p", ["ec", "AB", "omega0", "m_slider", "theta"])
@pytest.mark.parametrize("pair", [(0.1, 0.001), [0.3, 0.4], ("10 mm", "0.1 mm"), (1.0, 1.0), (0.2, 0)])
def test_a_bare_pair_is_refused_with_both_spellings(call, p, pair):
    """Whatever the input and the numbers: in one call it once meant this, in the other that."""
    first, second = pair
    message = (
        f"{p} = {pair!r}: a pair must say what it means: dx.plus_minus({first!r}, {second!r}) is a value"
    )
    with pytest.raises(ValueError, match=re.escape(message)) as raised:
        call("T_in", **{"theta": 1.0, "ec": 0.01, "AB": 0.125, "BC": 0.35, "omega0": 20.0, p: pair})
    assert f"dx.between({first!r}, {second!r}) both ends of a range" in str(raised.value)


@pytest.mark.parametrize("call", ["enclose", "tolerance"])
def test_a_machine_refuses_it_in_its_own_units(call):
    press = dx.Machine(AB=40, BC=160, ec=10, omega0=100, m_slider=2, units="mm, deg, rpm")
    with pytest.raises(ValueError, match=re.escape("dx.plus_minus(10, 0.1) is a value and its tolerance")):
        getattr(press, call)("T_in", theta=60, ec=(10, 0.1))


@pytest.mark.parametrize("ec", [dx.between(0.2, 0.1), dx.plus_minus(0.1, -0.1), dx.plus_minus(0.1, None)])
@pytest.mark.parametrize("call", [dx.enclose, dx.tolerance])
def test_a_bad_range_names_its_input(call, ec):
    with pytest.raises((ValueError, TypeError), match=r"^ec"):
        call("margin", ec=ec, AB=0.125, BC=0.35)


def test_values_by_hand(point):
    """With differences of evaluate alone."""
    centre = {"theta": 1.0, "ec": 0.1, "AB": 0.125, "BC": 0.35, "omega0": 157.08}
    std = {"ec": 1e-3 / 3, "AB": 1e-4 / 3, "BC": 1e-3 / 3}
    variance = 0.0
    for name, s in std.items():
        up, down = (dx.evaluate("a_C", **{**centre, name: centre[name] + side * 1e-5}) for side in (1, -1))
        assert point["gradient"][name] == pytest.approx((up - down) / 2e-5, rel=1e-4)
        variance += ((up - down) / 2e-5 * s) ** 2
    assert point["value"] == dx.evaluate("a_C", **centre)
    assert point["first_order"]["std"] == pytest.approx(math.sqrt(variance), rel=1e-4)
    assert list(point["contributions"]) == ["ec", "BC", "AB"]
    assert sum(point["contributions"].values()) == pytest.approx(1.0)


def test_a_curved_quantity():
    """Y's slope by theta is 0 at the dead centre: the first order sees nothing, and says so.

    Y - Y_o = -k theta^2/2: mean -k s^2/2, standard deviation k s^2/sqrt(2) of a normal theta.
    """
    result = dx.tolerance("Y", theta=plus_minus(0.0, 0.03), ec=0.0, AB=0.1, BC=0.4, samples=200_000)
    k, s = 0.1 * (1 + 0.25), 0.01
    assert result["first_order"]["std"] == 0.0
    drawn = result["monte_carlo"]
    assert abs(drawn["mean"] - (0.5 - k * s**2 / 2)) < 4 * drawn["mean_error"]
    assert drawn["std"] == pytest.approx(k * s**2 / math.sqrt(2), rel=0.02)
    assert result["agreement"]["mean"] < -100
    assert "(0 to first order: see monte_carlo), 95 %" in repr(result)
    assert "driven by nothing; theta 0 to first order: see monte_carlo" in repr(result)
    assert result["monte_carlo"]["largest"] <= 0.5


def test_uniform_and_given_distributions():
    """The margin is linear: its variance is the sum of theirs."""
    given = {"ec": stats.gamma(4.0, scale=0.001), "AB": plus_minus(0.1, 0.003), "BC": 0.4}
    result = dx.tolerance("margin", distribution="uniform", samples=50_000, **given)
    expected = math.sqrt(4.0 * 0.001**2 + 0.003**2 / 3)
    assert result["first_order"]["std"] == pytest.approx(expected, rel=1e-12)
    assert result["first_order"]["mean"] == pytest.approx(0.296)
    assert result["monte_carlo"]["std"] == pytest.approx(expected, rel=0.02)
    assert result["worst_case"] is None
    uniform = dx.tolerance("margin", distribution="uniform", ec=0.01, AB=plus_minus(0.1, 0.003), BC=0.4)
    assert uniform["monte_carlo"]["largest"] <= uniform["worst_case"]["upper"] == pytest.approx(0.293)


def test_of_a_design_and_of_forces():
    stroke = dx.tolerance("stroke", ec=plus_minus(0.02, 1e-3), AB=plus_minus(0.04, 5e-5), BC=0.064)
    assert abs(stroke["agreement"]["std"]) < 4
    press = {"AB": plus_minus(0.04, 5e-5), "BC": 0.064, "omega0": 100.0, "m_slider": plus_minus(0.8, 0.05)}
    torque = dx.tolerance("T_in", theta=1.0, ec=plus_minus(0.01, 1e-3), **press)
    assert abs(torque["agreement"]["std"]) < 4
    assert next(iter(torque["contributions"])) == "m_slider"
    peak = dx.tolerance(
        ("absmax", "a_C"),
        ec=plus_minus(0.1, 0.01),
        AB=plus_minus(0.125, 5e-4),
        BC=0.35,
        omega0=157.08,
        samples=4000,
    )
    assert abs(peak["agreement"]["std"]) < 4


def test_samples_without_a_value_are_counted():
    result = dx.tolerance("Y", theta=math.pi / 2, ec=plus_minus(0.22, 0.03), AB=0.125, BC=0.35, samples=2000)
    assert result["status"] == 2
    share = stats.norm.sf(0.225, 0.22, 0.01)
    assert result["monte_carlo"]["infeasible"] == pytest.approx(share, abs=0.04)


@pytest.mark.parametrize(
    ("name", "ec", "kink"),
    [
        ("time_ratio", 0.0, True),
        (("max", "a_C"), 0.0, True),
        ("stroke", 0.0, False),
        ("time_ratio", 0.05, False),
    ],
)
def test_a_kink_is_told(name, ec, kink):
    """In line the time ratio is 1 on both sides of a kink; its worst case is at the ends all the same."""
    lengths = {"AB": 0.125, "BC": 0.35}
    speed = {"omega0": 157.08} if isinstance(name, tuple) else {}
    result = dx.tolerance(name, ec=plus_minus(ec, 3e-3), samples=500, **lengths, **speed)
    assert result["status"] == (3 if kink else 0)
    assert np.isfinite(result["monte_carlo"]["std"])
    if name == "time_ratio":
        end = dx.events(ec=ec + 3e-3, **lengths)["time_ratio"]
        assert result["worst_case"]["upper"] == pytest.approx(end, rel=1e-12)
        assert result["worst_case"]["lower"] == pytest.approx(
            1.0 if kink else dx.events(ec=ec - 3e-3, **lengths)["time_ratio"], rel=1e-12
        )


MEASURES = {  # what a wrong search of peaks gave, by the value of ec: value and slope
    "a jump at the means": (lambda ec: np.where(ec < 0.1, 5.0, 9.0) + ec, np.ones_like, 4),
    "a wrong value on one side": (lambda ec: np.where(ec > 0.1, 0.5, 1.0) * ec, np.ones_like, 4),
    "slopes of another curve": (lambda ec: ec, lambda ec: np.where(ec > 0.1, 30.0, 1.0), 4),
    "a kink": (lambda ec: np.abs(ec - 0.1), lambda ec: np.where(ec < 0.1, -1.0, 1.0), 3),
    "a kink one step and a half away": (lambda ec: np.maximum(ec, OFF), lambda ec: 1.0 * (ec > OFF), 3),
    "a steep kink": (lambda ec: np.maximum(1e6 * (ec - 0.1), 0.0), lambda ec: 1e6 * (ec > 0.1), 3),
    "no slope": (lambda ec: ec, lambda ec: np.full_like(ec, np.nan), 5),
    "no slope on one side": (lambda ec: ec, lambda ec: np.where(ec > 0.1, np.nan, 1.0), 5),
    "smooth": (lambda ec: np.exp(20.0 * ec), lambda ec: 20.0 * np.exp(20.0 * ec), 0),
    "a large smooth one": (lambda ec: 1e12 + ec**3, lambda ec: 3.0 * ec**2, 0),
}  # fmt: skip
OFF = 0.1 + 1.5e-3 * 1e-3 / 3.0


@pytest.mark.parametrize("what", MEASURES)
def test_the_reason_is_the_right_one(what, monkeypatch):
    value, slope, status = MEASURES[what]

    def measured(measures, given, branch):
        ec = np.asarray(given["ec"], float)
        return {measures[0]: Peak(value(ec), {"ec": slope(ec)})}

    monkeypatch.setattr("desaxe.design.tolerance.function.measured", measured)
    result = dx.tolerance("stroke", ec=plus_minus(0.1, 1e-3), AB=0.125, BC=0.35, samples=50)
    assert result["status"] == status


class Peak(NamedTuple):
    """A measure of designs."""

    value: np.ndarray
    gradient: dict


@pytest.mark.parametrize(("sigmas_away", "status"), [(0.5, 4), (2.5, 4), (12.0, 0)])
def test_a_jump_within_the_tolerance_is_told(sigmas_away, status):
    """A force that sets in at a position: T = -F dY/dtheta for the share of the rods beyond it."""
    theta, std = 1.0, 1e-4
    along = dx.evaluate(["Y", "Y_wrt_BC", "Y_wrt_theta"], theta=theta, ec=0.0, AB=0.1, BC=0.3)
    at = along["Y"] + sigmas_away * std * along["Y_wrt_BC"]
    load = dx.over_Y([0.2, at, 0.4], [0.0, -900.0, -900.0], kind="step")
    press = {"theta": theta, "ec": 0.0, "AB": 0.1, "omega0": 1.0, "F_Y": load}
    result = dx.tolerance("T_in", BC=plus_minus(0.3, 3.0 * std), samples=20_000, **press)
    share, drawn = stats.norm.sf(sigmas_away), result["monte_carlo"]
    expected = 900.0 * abs(along["Y_wrt_theta"])
    assert abs(drawn["mean"]) == pytest.approx(share * expected, abs=0.01 * expected)
    assert result["status"] == status
    assert ("jumps within the tolerances" in repr(result)) == (status == 4)


def test_a_peak_at_a_limit_angle_has_no_derivative():
    rocker = {"AB": 0.125, "BC": 0.35, "theta": 1.0}
    ec = plus_minus(0.3, 1e-4)
    result = dx.tolerance(("max", "phi"), ec=ec, AB=0.125, BC=0.35, samples=50)
    assert dx.peak("phi", kind="max", ec=0.3, AB=0.125, BC=0.35)["status"] == 2
    assert result["status"] == 5
    assert dx.tolerance("phi", ec=plus_minus(0.2, 1e-4), samples=50, **rocker)["status"] == 0


def test_nothing_is_told_of_what_has_no_value():
    result = dx.tolerance("Y", theta=math.pi / 2, ec=plus_minus(0.3, 1e-3), AB=0.125, BC=0.35, samples=10)
    assert (result["status"], result["monte_carlo"]["infeasible"]) == (1, 1.0)


def test_one_input_and_seeds():
    one = {"theta": 1.0, "ec": plus_minus(0.1, 1e-3), "AB": 0.125, "BC": 0.35}
    first, again, other = (dx.tolerance("Y", samples=100, seed=seed, **one) for seed in (0, 0, 1))
    assert first == again
    assert first["monte_carlo"]["mean"] != other["monte_carlo"]["mean"]


def test_an_input_that_a_quantity_does_not_depend_on_counts_for_nothing():
    varied = POINT | {"m_slider": plus_minus(1.0, 0.1)}
    with_mass = dx.tolerance("a_C", samples=200, **varied)
    assert with_mass["gradient"].pop("m_slider") == with_mass["contributions"].pop("m_slider") == 0.0
    without = dx.tolerance("a_C", samples=200, **POINT)
    for key in ("value", "gradient", "contributions", "worst_case"):
        assert with_mass[key] == without[key]
    alone = {name: value for name, value in varied.items() if name in ("theta", "omega0")}
    for name in ("stroke", "margin", ("max", "phi"), ("rms", "Y")):
        free = dx.tolerance(name, ec=0.0, AB=0.125, BC=0.35, omega0=plus_minus(9.0, 1.0), samples=20)
        assert (free["status"], free["first_order"]["std"], free["gradient"]["omega0"]) == (0, 0.0, 0.0)
    exact = dx.tolerance("a_C", ec=0.0, AB=0.125, BC=0.35, m_slider=plus_minus(1.0, 0.1), **alone)
    assert exact["first_order"]["std"] == 0.0
    assert exact["monte_carlo"]["std"] < 1e-12 * abs(exact["value"])  # that of equal numbers rounds


@pytest.mark.parametrize(
    ("name", "shape", "unit"),
    [("theta", stats.norm(60, 1), math.pi / 180), ("omega0", stats.gamma(4.0, 280, 10), math.pi / 30)],
)
def test_distributions_are_in_the_units_of_the_machine(name, shape, unit):
    """Against the loop closure in mm; the numbers of a distribution are degrees, or rpm."""
    machine = dx.Machine(ec=10, AB=50, BC=200, omega0=300, units="mm, deg, rpm")
    result = machine.tolerance("V_C", samples=2000, **{"theta": 60, name: shape})

    def speed(theta, omega):
        s, c = np.sin(theta), np.cos(theta)
        lean = 10.0 + 50.0 * s
        return -(50.0 * s + lean * 50.0 * c / np.sqrt(200.0**2 - lean**2)) * omega

    at = {"theta": 60.0 * math.pi / 180, "omega0": 300.0 * math.pi / 30}
    at[name] = shape.mean() * unit
    assert result["value"] == pytest.approx(speed(at["theta"], at["omega0"]), rel=1e-12)
    step = {"theta": 1e-6, "omega0": 1e-3}[name]
    ends = [speed(*{**at, name: at[name] + side * step}.values()) for side in (1, -1)]
    slope = (ends[0] - ends[1]) / (2 * step) * unit
    assert result["gradient"][name] == pytest.approx(slope, rel=1e-6)
    assert result["first_order"]["std"] == pytest.approx(abs(slope) * shape.std(), rel=1e-6)
    drawn = speed(*{**at, name: shape.ppf((np.arange(20000) + 0.5) / 20000) * unit}.values())
    assert result["monte_carlo"]["std"] == pytest.approx(drawn.std(), rel=0.06)
    assert result["monte_carlo"]["mean"] == pytest.approx(drawn.mean(), abs=0.1 * drawn.std())


@pytest.mark.parametrize("name", ["stroke", "margin", ("absmax", "a_C"), ("rms", "a_C"), ("at", 1.0, "Y")])
@pytest.mark.parametrize("inputs", [{"AB": None, "BC": 0.3}, {"BC": 0.3}, {"AB": 0.1}])
def test_a_missing_length_is_named(name, inputs):
    missing = "AB" if inputs.get("AB") is None else "BC"
    with pytest.raises(TypeError, match=f"tolerance: {missing} is missing"):
        dx.tolerance(name, ec=plus_minus(0.01, 0.001), omega0=10.0, **inputs)
