"""Optima against a fine scan, their multipliers against optima with moved limits, and where there is none."""

import math

import numpy as np
import pytest

import desaxe as dx
from tests.effort import first

A = {"AB": 0.125, "BC": 0.350, "omega0": 157.08}


def test_the_optimum_at_a_bound_of_the_margin():
    best = dx.optimize(
        maximize=("absmax", "a_C"), over={"ec": (0, 0.25)}, keep={"margin": (0.005, None)}, **A
    )
    assert best["ec"] == pytest.approx(0.22, abs=1e-9)
    assert best["value"] == pytest.approx(dx.peak("a_C", ec=0.22, **A)["value"], rel=1e-9)
    assert best["active"] == {"margin": "lower"}
    assert (best["status"], best["multipliers"]["ec"]) == (0, 0.0)
    # Relaxing the margin by d lets ec grow by d.
    slope = dx.peak("a_C", ec=0.22, **A)["gradient"]["ec"]
    assert best["multipliers"]["margin"] == pytest.approx(slope, rel=1e-6)
    assert "margin (lower)" in best["message"]


def test_at_a_bound_of_a_parameter_and_units():
    best = dx.optimize(
        maximize=("absmax", "V_C"), over={"ec": ("0 mm", "150 mm")}, keep={"margin": ("5 mm", None)}, **A
    )
    assert best["ec"] == pytest.approx(0.15, abs=1e-12)
    assert best["active"] == {"ec": "upper"}
    assert best["multipliers"] == {
        "margin": 0.0,
        "ec": pytest.approx(dx.peak("V_C", ec=0.15, **A)["gradient"]["ec"]),
    }


@pytest.mark.thorough
def test_paper_a_has_no_highest_peak():
    result = dx.optimize(maximize=("absmax", "a_C"), over={"ec": (0, 0.25)}, **A)
    assert (result["status"], result["value"]) == (2, np.inf)
    same = dx.optimize(maximize=("absmax", "a_C"), over={"ec": (0, 0.25)}, keep={"margin": (0, None)}, **A)
    assert same["status"] == 2
    assert result["ec"] == pytest.approx(0.225, abs=1e-6)
    assert "grows without bound" in result["message"]
    # The rod is flung round there in one direction: the acceleration has no bound along +Y only.
    assert dx.optimize(maximize=("max", "a_C"), over={"ec": (0, 0.25)}, **A)["value"] == np.inf
    down = dx.optimize(minimize=("min", "a_C"), over={"ec": (0, 0.25)}, **A)
    assert (down["status"], np.isfinite(down["value"])) == (3, True)


@pytest.mark.thorough
def test_what_is_bounded_at_the_limit_of_turning():
    """Paper A: max |V_C| stays below AB omega (1 + sqrt(BC/AB)) = 52.5 m/s."""
    result = dx.optimize(maximize=("absmax", "V_C"), over={"ec": (0, 0.25)}, **A)
    assert result["status"] == 3
    assert result["value"] == pytest.approx(0.125 * 157.08 * (1 + np.sqrt(2.8)), rel=1e-4)
    assert result["ec"] == pytest.approx(0.225, abs=1e-9)
    assert "bounded" in result["message"]


def test_a_kink_between_two_signs():
    """The largest speed is least in line, where both strokes share it."""
    result = dx.optimize(minimize=("absmax", "V_C"), over={"ec": (-0.1, 0.2)}, **A)
    assert result["ec"] == pytest.approx(0.0, abs=1e-9)
    assert (result["status"], result["active"]) == (0, {})


def test_a_kink_between_two_angles():
    """In line, the largest acceleration along +Y is reached at two angles; either side of it is worse."""
    result = dx.optimize(minimize=("max", "a_C"), over={"ec": (-0.1, 0.14)}, **A)
    assert result["ec"] == pytest.approx(0.0, abs=1e-6)
    assert (result["status"], result["active"]) == (0, {})
    assert "at a kink of the objective, inside of all limits" in result["message"]
    assert np.isnan(result["multipliers"]["ec"])


@pytest.mark.thorough
def test_a_kink_that_a_search_reaches_from_one_side():
    """Two peaks of the torque are equal under one side force, by the torque at fixed angles."""
    points = [0.26, 3.16, 3.2, 4.18, 5.25], [1550.0, -1060.0, 180.0, 1220.0, 930.0]
    press = {"ec": 0.00523, "AB": 0.0542, "BC": 0.188, "omega0": 5.63, "m_slider": 2.74, "m_rod": 1.98}
    press |= {"mu": 0.0719, "F_Y": dx.over_theta(*points, kind="linear")}
    result = dx.optimize(minimize=("max", "T_in"), over={"F_X": (-3000, 3000)}, starts=1, **press)
    assert (result["status"], result["active"]) == (0, {})
    assert "at a kink of the objective" in result["message"]
    theta = np.linspace(0.0, 2 * np.pi, 4001)
    force = (result["F_X"] + np.array([-1.0, 0.0, 1.0]))[:, None]
    left, best, right = dx.evaluate("T_in", theta=theta, F_X=force, **press).max(axis=1)
    assert best < min(left, right)
    assert result["value"] == pytest.approx(best, rel=1e-5)


def scanned(kind, name, ec, BC, keep, sense):
    """The best of a fine grid, by values alone."""
    ec, BC = np.meshgrid(ec, BC, indexing="ij")
    value = dx.peak(name, kind=kind, ec=ec, BC=BC, AB=0.125, omega0=157.08)["value"]
    ratio = dx.events(ec=ec, AB=0.125, BC=BC)["time_ratio"]
    value = np.where((0.35 - 0.125 > 0) & (ratio >= keep), sense * value, -np.inf)
    best = np.unravel_index(np.argmax(value), value.shape)
    return ec[best], BC[best], sense * value[best]


@pytest.mark.thorough
def test_against_a_scan_and_moved_limits():
    ec, BC = np.linspace(0.0, 0.15, 301), np.linspace(0.3, 0.5, 201)
    expected = scanned("absmax", "a_C", ec, BC, 1.2, -1)
    problem = {
        "minimize": ("absmax", "a_C"),
        "over": {"ec": (0.0, 0.15), "BC": (0.3, 0.5)},
        "AB": 0.125,
        "omega0": 157.08,
    }
    best = dx.optimize(keep={"time_ratio": (1.2, None)}, **problem)
    assert best["status"] == 0
    assert best["value"] <= expected[2]
    assert best["value"] == pytest.approx(expected[2], rel=2e-3)
    assert (best["ec"], best["BC"]) == (
        pytest.approx(expected[0], abs=2e-3),
        pytest.approx(expected[1], abs=5e-3),
    )
    d = 1e-4
    looser = dx.optimize(keep={"time_ratio": (1.2 - d, None)}, **problem)
    tighter = dx.optimize(keep={"time_ratio": (1.2 + d, None)}, **problem)
    gain = (tighter["value"] - looser["value"]) / (2 * d)
    assert best["multipliers"]["time_ratio"] == pytest.approx(gain, rel=1e-4)
    wider = dx.optimize(
        keep={"time_ratio": (1.2, None)}, **{**problem, "over": {"ec": (0.0, 0.15 + d), "BC": (0.3, 0.5)}}
    )
    assert best["multipliers"]["ec"] == pytest.approx((best["value"] - wider["value"]) / d, rel=5e-3)


@pytest.mark.thorough
def test_equal_and_upper_limits():
    problem = {
        "minimize": ("absmax", "a_C"),
        "over": {"AB": (0.05, 0.2), "BC": (0.3, 0.5)},
        "ec": 0.05,
        "omega0": 157.08,
    }
    best = dx.optimize(keep={"stroke": ("==", 0.25), "max_pressure_angle": (None, "30 deg")}, **problem)
    assert dx.events(ec=0.05, AB=best["AB"], BC=best["BC"])["stroke"] == pytest.approx(0.25, rel=1e-9)
    more = dx.optimize(keep={"stroke": ("==", 0.2501), "max_pressure_angle": (None, "30 deg")}, **problem)
    assert best["multipliers"]["stroke"] == pytest.approx((best["value"] - more["value"]) / 1e-4, rel=1e-2)
    fast = dx.optimize(
        maximize="time_ratio", over={"ec": (0, 0.2)}, keep={("absmax", "V_C"): (None, 25.0)}, **A
    )
    assert dx.peak("V_C", ec=fast["ec"], **A)["value"] == pytest.approx(25.0, rel=1e-9)
    assert fast["active"] == {("absmax", "V_C"): "upper"}


def test_over_masses():
    press = {"ec": 0.01, "AB": 0.04, "BC": 0.1, "omega0": 100.0, "m_slider": 0.5}
    best = dx.optimize(minimize=("absmax", "F_B_Y"), over={"m_rod": (0.1, 2.0)}, **press)
    assert best["active"] == {"m_rod": "lower"}
    assert best["m_rod"] == 0.1


@pytest.mark.parametrize(
    "goal",
    [
        {"minimize": "max_pressure_angle"}, {"maximize": "min_transmission_angle"},
        {"minimize": "time_ratio"}, {"maximize": "margin"}, {"minimize": "stroke"},
    ],
)  # fmt: skip
def test_kinks_at_no_eccentricity(goal):
    best = dx.optimize(over={"ec": (-0.1, 0.2)}, **goal, **A)
    assert best["ec"] == pytest.approx(0.0, abs=1e-12)
    assert (best["status"], best["active"]) == (0, {})
    assert "inside of all limits" in best["message"]


def test_inside_of_all_limits():
    """Against a closed form: of a stroke and time ratio, the largest pressure angle has a least."""
    limits = dx.synthesize(stroke=0.1, time_ratio=1.3, max_pressure_angle=0.1)["limits"]
    expected, _ = limits["max_pressure_angle"]
    over = {"ec": (0.0, 0.2), "AB": (0.01, 0.1), "BC": (0.05, 0.4)}
    best = dx.optimize(
        minimize="max_pressure_angle", over=over, keep={"stroke": ("==", 0.1), "time_ratio": ("==", 1.3)}
    )
    assert best["value"] == pytest.approx(expected, rel=1e-10)
    assert set(best["active"]) == {"stroke", "time_ratio"}


def test_no_design_keeps_the_limits():
    result = dx.optimize(
        maximize="stroke", over={"ec": (0, 0.3)}, keep={"margin": (0.5, None)}, AB=0.125, BC=0.35
    )
    assert result["status"] == 1
    assert "margin misses its lower limit by 0.275" in result["message"]
    assert np.isnan(result["value"])


@pytest.mark.parametrize("low", first(1, [0.005, 0.0]))
def test_where_no_design_keeps_the_limits_the_nearest_is_told(low):
    """The pressure angle grows with the eccentricity: the least one is the nearest."""
    keep = {"max_pressure_angle": (None, "5 deg")}
    result = dx.optimize(minimize="time_ratio", over={"ec": (low, 0.04)}, keep=keep, AB=0.075, BC=0.3)
    miss = math.asin((0.075 + low) / 0.3) - math.radians(5.0)
    assert result["ec"] == pytest.approx(low, abs=1e-9)
    assert f"misses its upper limit by {miss:.3g} rad at the nearest" in result["message"]
    machine = dx.Machine(ec=15, AB=75, BC=300, omega0=60, units="mm, deg, rpm")
    limits = {("absmax", "a_C"): (None, 1), "max_pressure_angle": (None, 90)}
    message = machine.optimize(minimize="time_ratio", over={"ec": (1000 * low, 40)}, keep=limits)
    assert "absmax a_C misses its upper limit by" in message["message"]
    assert message["message"].count("mm") == 2
    message = machine.optimize(
        minimize="time_ratio", over={"ec": (1000 * low, 40)}, keep={"stroke": (1500, None)}
    )
    assert "stroke misses its lower limit by 1.35e+03 mm at" in message["message"]


def test_pareto_front():
    result = dx.optimize(
        minimize=("absmax", "a_C"), maximize="time_ratio", over={"ec": (0, 0.1), "BC": (0.25, 0.5)}, points=5,
        AB=0.125, omega0=157.08, starts=1,
    )  # fmt: skip
    peak, ratio = result["value"][("absmax", "a_C")], result["value"]["time_ratio"]
    assert len(peak) == 5
    order = np.argsort(peak)
    assert (np.diff(ratio[order]) > 0).all()  # none is beaten
    for ec, BC, value, T in zip(result["ec"], result["BC"], peak, ratio, strict=True):
        assert dx.peak("a_C", ec=ec, BC=BC, AB=0.125, omega0=157.08)["value"] == pytest.approx(
            value, rel=1e-9
        )
        assert dx.events(ec=ec, BC=BC, AB=0.125)["time_ratio"] == pytest.approx(T, rel=1e-9)
    # Nothing of a scan beats a design of the front.
    ec, BC = (g.reshape(-1) for g in np.meshgrid(np.linspace(0, 0.1, 41), np.linspace(0.25, 0.5, 41)))
    every = dx.peak("a_C", ec=ec, BC=BC, AB=0.125, omega0=157.08)["value"]
    ratios = dx.events(ec=ec, BC=BC, AB=0.125)["time_ratio"]
    for value, T in zip(peak, ratio, strict=True):
        assert not ((every < value * (1 - 1e-6)) & (ratios > T * (1 + 1e-6))).any()


@pytest.mark.thorough
def test_pareto_front_of_three():
    """What the third objective can have is not what the best of the first leaves of it."""
    result = dx.optimize(
        maximize=(("absmax", "a_C"), "time_ratio"), minimize="max_pressure_angle",
        over={"ec": (0, 0.2), "BC": (0.33, 0.5)}, keep={"margin": (0.005, None)}, points=3,
        AB=0.125, omega0=157.08, starts=1,
    )  # fmt: skip
    lean = result["value"]["max_pressure_angle"]
    assert lean.min() == pytest.approx(np.arcsin(0.125 / 0.5), rel=1e-9)  # in line, with the longest rod
    assert lean.max() > 1.3
    assert len(lean) >= 3
    gains = np.stack([result["value"][("absmax", "a_C")] / 1e4, result["value"]["time_ratio"], -lean], axis=1)
    for one in gains:
        assert not ((gains >= one).all(axis=1) & (gains > one + 1e-6).any(axis=1)).any()
    assert f"{len(lean)} designs" in result["message"]


def test_how_far_a_design_is_from_turning():
    result = dx.optimize(maximize="stroke", over={"ec": (0.23, 0.25)}, AB=0.125, BC=0.35)
    assert result["status"] == 1
    assert "the crank turns, by 0.005 m at the nearest, ec = 0.23" in result["message"]
    near = dx.optimize(maximize=("absmax", "a_C"), over={"ec": (0, 0.25)}, keep={"margin": (1e-9, None)}, **A)
    assert "ec = 0.224999999" in near["message"]


@pytest.mark.parametrize(
    ("over", "keep", "message"),
    [
        ({"ec": (0.2, 0.3), "AB": (0.05, 0.4)}, {}, "misses 0, from which on the crank turns, by 0.05 m"),
        ({"ec": (-0.3, 0.2), "AB": (0.05, 0.4)}, {"margin": (0.2, None)}, "misses its lower limit by 0.05 m"),
    ],
)
def test_bounds_within_which_nothing_turns_are_told_without_a_search(over, keep, message, monkeypatch):
    monkeypatch.setattr("desaxe.design.optimisation.optimize.LocalSearch", None)
    for goal in (("absmax", "a_C"), ["stroke", ("absmax", "a_C")]):
        result = dx.optimize(minimize=goal, over=over, keep=keep, BC=0.2, omega0=10.0)
        assert np.all(result["status"] == 1)
        assert message in result["message"]


def test_where_an_objective_has_no_slope_nothing_is_called_an_optimum():
    """Such as a peak where friction turns round: the search ended where it began, "inside of all limits"."""

    def steep(design):
        return abs(design["ec"] - 0.013) + abs(design["AB"] - 0.118), {"ec": math.nan, "AB": math.nan}

    result = dx.optimize(minimize=steep, over={"ec": (-0.1, 0.1), "AB": (0.1, 0.13)}, starts=2, BC=0.35)
    assert result["status"] == 4
    assert "the optimality conditions hold to 1 only" in result["message"]
    assert result["value"] < 5e-3  # 0.016 at the middle of the bounds; how near hangs on SciPy


def test_an_optimum_on_a_bound_that_does_not_hold_it_back_is_not_inside():
    result = dx.optimize(minimize="time_ratio", over={"ec": (0, 0.1)}, AB=0.075, BC=0.3)
    assert result["message"] == "optimum at ec = 0 m, on the bound of ec (lower), which does not hold it back"
    assert result["active"] == {}


@pytest.mark.parametrize(
    ("goal", "over", "keep", "expected"),
    [
        ("maximize", {"AB": (0.249999, 0.2499995)}, {}, {"status": 0, "AB": 0.2499995}),
        ("minimize", {"AB": (0.2, 0.25)}, {"margin": (None, 1e-6)}, {"status": 0, "AB": 0.25 - 1.1e-6}),
        ("maximize", {"AB": (0.25 - 2e-13, 0.25 - 1.9e-13)}, {"margin": (0, None)}, {"status": 1}),
    ],
)
def test_designs_of_a_tiny_margin(goal, over, keep, expected):
    """The stroke grows with the crank; no message says that a design misses a limit that it keeps."""
    ec = 1e-7 if expected["status"] == 0 else 0.0
    result = dx.optimize(**{goal: "stroke"}, over=over, keep=keep, BC=0.25, ec=ec)
    assert {name: result[name] for name in expected} == pytest.approx(expected, abs=1e-12)
    assert "by -" not in result["message"]


def finite(low, high):
    """(ec - 0.02)^2 between two eccentricities, NaN below and infinite above."""

    def square(design):
        ec = design["ec"]
        value = math.nan if ec < low else math.inf if ec > high else (ec - 0.02) ** 2
        return value, {"ec": 2.0 * (ec - 0.02)}

    return square


@pytest.mark.parametrize(
    ("goal", "low", "high", "status", "ec", "words"),
    [
        ("minimize", 0.0, 0.05, 0, 0.02, "inside of all limits; square has no finite value at 65 of 131"),
        ("maximize", 0.0, 0.05, 0, 0.05, "at the edge of the designs where square is finite"),
        ("minimize", 0.05, 1.0, 0, 0.05, "at the edge of the designs where square is finite"),
        ("maximize", 0.05, 1.0, 0, 0.1, "held back by ec (upper); square has no finite value at"),
        ("minimize", 1.0, 2.0, 5, None, "square has no finite value at any of the 131 designs"),
        ("maximize", -2.0, -1.0, 5, None, "square has no finite value at any of the 131 designs"),
    ],
)
def test_an_objective_without_a_value_is_no_design(goal, low, high, status, ec, words):
    result = dx.optimize(**{goal: finite(low, high)}, over={"ec": (0, 0.1)}, AB=0.1, BC=0.3)
    assert result["status"] == status
    assert words in result["message"]
    assert "two peaks" not in result["message"]
    if ec is None:
        assert np.isnan(result["value"])
        return
    assert result["ec"] == pytest.approx(ec, abs=1e-8)
    assert result["value"] == pytest.approx((result["ec"] - 0.02) ** 2, abs=1e-15)


@pytest.mark.parametrize(
    ("theta", "over", "still"), [(90, ("ec",), "ec"), (90, ("ec", "AB"), "ec"), (60, ("ec",), "")]
)
def test_an_objective_that_does_not_change_with_a_variable(theta, over, still):
    ends = {"ec": (0, 0.02), "AB": (0.04, 0.05)}
    fixed = {n: v for n, v in {"AB": 0.05, "BC": 0.2, "omega0": 10.0}.items() if n not in over}
    result = dx.optimize(
        maximize=("at", f"{theta} deg", "V_C"), over={name: ends[name] for name in over}, **fixed
    )
    words = f"at {theta} deg V_C does not change with {still}"
    assert result["message"].endswith(words) if still else "does not change" not in result["message"]


def test_a_function_as_an_active_limit_and_as_one_of_several_objectives():
    """By itself in `active`, `multipliers` and `value`, against the closed form of the time ratio."""

    def double(design):
        return 2.0 * design["ec"], {"ec": 2.0}

    def ratio(ec):
        advance = math.pi + math.asin(ec / 0.2) - math.asin(ec / 0.4)
        return advance / (2.0 * math.pi - advance)

    problem = {"maximize": "time_ratio", "over": {"ec": (0, 0.1)}, "AB": 0.1, "BC": 0.3}
    result = dx.optimize(keep={double: (None, 0.1)}, **problem)
    assert (result["status"], result["active"]) == (0, {double: "upper"})
    gain = (ratio(0.05 + 1e-6) - ratio(0.05 - 1e-6)) / 4e-6
    assert result["multipliers"][double] == pytest.approx(gain, rel=1e-8)
    assert "held back by double (upper)" in result["message"]
    front = dx.optimize(minimize=double, points=3, **problem)
    assert front["value"][double] == pytest.approx(2.0 * front["ec"], abs=1e-12)
