"""Peaks against mpmath on the closed form, also where they are as narrow as the root of the margin."""

import math
from fractions import Fraction

import mpmath
import numpy as np
import pytest

import desaxe as dx
from desaxe.oracle.truth import truth

OMEGA = 157.08
MACHINE = {"AB": 0.125, "BC": 0.35, "omega0": OMEGA}


def rate(order, ec, AB, BC):
    """The `order`-th time derivative of Y at speed 1, as a function of theta, from Y itself."""

    def position(theta):
        return AB * mpmath.cos(theta) + mpmath.sqrt(BC**2 - (ec + AB * mpmath.sin(theta)) ** 2)

    return lambda theta: mpmath.diff(position, theta, order) if order else position(theta)


def exact_peak(order, near, ec, AB, BC):
    """The extreme value next to an angle, by mpmath."""
    with mpmath.workdps(50):
        lengths = [mpmath.mpf(x) for x in (ec, AB, BC)]
        theta = mpmath.findroot(rate(order + 1, *lengths), mpmath.mpf(near))
        return theta, rate(order, *lengths)(theta)


@pytest.mark.parametrize("ec", [0.05, 0.15, -0.2, 0.2249])
@pytest.mark.parametrize(("name", "order"), [("Y", 0), ("V_C", 1), ("a_C", 2)])
@pytest.mark.parametrize("kind", ["max", "min", "absmax"])
def test_value_and_angle(name, order, kind, ec):
    result = dx.peak(name, ec=ec, kind=kind, **MACHINE)
    theta, value = exact_peak(order, result["theta"], ec, 0.125, 0.35)
    value = abs(value) if kind == "absmax" else value
    assert result["status"] == 0
    assert abs(result["value"] / (value * mpmath.mpf(OMEGA) ** order) - 1) < 1e-13
    assert abs(result["theta"] - theta) < 1e-7


@pytest.mark.parametrize("power", [10, 20, 30, 40])
@pytest.mark.parametrize("side", [1, -1])
def test_peaks_as_narrow_as_the_root_of_the_margin(power, side):
    """Jerk next to the change point: a uniform sweep of 720 sees nothing of it."""
    design = {"ec": side * 0.5, "AB": 1.0, "BC": 1.5 + 2.0**-power, "omega0": 1.0}
    result = dx.peak("j_C", **design)
    exact = [
        abs(truth("j_C", theta=result["theta"] + step * 2.0 ** (-power / 2), **design))
        for step in (-0.01, 0, 0.01)
    ]
    assert abs(result["value"] / exact[1] - 1) < 1e-13
    assert exact[1] > max(exact[0], exact[2])
    # R = sqrt(m + x^2/2), x the distance to the quarter: the jerk is extreme at x = sqrt(m/2), as 1/m.
    distance = abs(result["theta"] - (np.pi / 2 if side > 0 else 3 * np.pi / 2))
    assert distance == pytest.approx(2.0 ** (-(power + 1) / 2), rel=1e-3)


def test_gradient_is_that_of_the_peak():
    """The envelope theorem against differences of the peak itself."""
    design = {"ec": 0.15, "AB": 0.125, "BC": 0.35, "omega0": OMEGA, "alpha": 40.0}
    gradient = dx.peak("a_C", **design)["gradient"]
    assert set(gradient) == set(design)
    for name, value in design.items():
        step = 1e-6 * max(value, 1.0)
        up, down = (dx.peak("a_C", **{**design, name: value + s})["value"] for s in (step, -step))
        assert gradient[name] == pytest.approx((up - down) / (2 * step), rel=1e-6)


def test_ends_of_the_range_count():
    result = dx.peak("a_C", ec=0.0, theta=(0.3, 1.0), kind="min", **MACHINE)
    assert result["theta"] == 0.3
    assert dx.peak("a_C", ec=0.1, theta=("0 deg", "90 deg"), **MACHINE)["theta"] <= np.pi / 2
    assert result["value"] == pytest.approx(dx.evaluate("a_C", theta=0.3, ec=0.0, **MACHINE), rel=1e-15)


def test_a_mechanism_that_cannot_turn():
    """Acceleration grows without bound at the limit angle; the position has its extremum there."""
    result = dx.peak("a_C", ec=0.23, **MACHINE)
    assert result["value"] == math.inf
    assert result["status"] == 2
    assert math.isnan(result["gradient"]["ec"])
    limit = math.asin(0.12 / 0.125)
    assert result["theta"] == pytest.approx(limit, abs=1e-9) or result["theta"] == pytest.approx(
        math.pi - limit, abs=1e-9
    )
    lowest = dx.peak("Y", ec=0.23, kind="min", AB=0.125, BC=0.35)
    assert lowest["value"] == pytest.approx(-0.125 * math.cos(limit), abs=1e-7)
    assert lowest["status"] == 2


@pytest.mark.thorough
@pytest.mark.parametrize("name", ["V_C", "a_C", "j_C"])
@pytest.mark.parametrize("digits", [2, 17])
def test_rates_of_a_mechanism_that_cannot_turn_have_no_bound(name, digits):
    """Whichever side of the limit angle rounding puts its last double on; with round numbers, too."""
    rng = np.random.default_rng(7)
    ranges = (0.02, 0.3), (0.05, 0.4), (-0.4, 0.4)
    AB, BC, ec = (np.round(rng.uniform(*ends, 1200), digits) for ends in ranges)
    rockers = (AB + np.abs(ec) - 1e-6 > BC) & (np.abs(ec) < AB + BC - 1e-6)
    result = dx.peak(name, AB=AB[rockers], BC=BC[rockers], ec=ec[rockers], omega0=90.0)
    assert np.count_nonzero(rockers) > 500
    assert np.isinf(result["value"]).all()
    assert (result["status"] == 2).all()


def test_a_margin_below_zero_by_less_than_its_rounding():
    """BC - AB - |ec| in exact fractions decides: below zero there are limit angles, however near."""
    grid = [(k / 1000.0, j / 1000.0) for k in range(5, 400, 23) for j in range(5, 400, 31)]
    AB, ec = np.array(grid).T
    BC = AB + ec
    exact = [Fraction(c) - Fraction(a) - Fraction(e) for a, e, c in zip(AB, ec, BC, strict=True)]
    short = np.array([margin < 0 for margin in exact])
    changes = np.array([margin == 0 for margin in exact])  # V_C is greatest there and jumps, a_C elsewhere
    assert np.count_nonzero(short & (BC - AB - ec >= 0.0)) > 0
    for name, special in (("V_C", short | changes), ("a_C", short)):
        result = dx.peak(name, AB=AB, ec=ec, BC=BC, omega0=90.0)
        assert np.array_equal(np.isinf(result["value"]), short)
        assert np.array_equal(result["status"] == 2, special)


@pytest.mark.parametrize("name", ["V_C", "a_C"])
def test_an_arc_narrower_than_a_microradian_has_no_bound_either(name):
    short = 10.0 ** -np.arange(9.0, 15.5, 0.5)  # |ec| short of AB + BC by this share: arcs down to 1e-7 rad
    result = dx.peak(name, AB=1.0, BC=2.0, ec=-3.0 * (1.0 - short), omega0=90.0)
    assert np.isinf(result["value"]).all()
    assert (result["status"] == 2).all()


def test_a_limit_angle_at_the_end_of_the_range_is_one():
    """|ec| = BC: theta = 0 is assembled, and the last angle that is; rounding has no say in it."""
    result = dx.peak("V_C", AB=np.linspace(0.1, 0.3, 61), BC=0.37, ec=0.37, omega0=90.0)
    assert (result["status"] == 2).all()
    assert np.isinf(result["value"]).all()


def test_a_stall_is_an_end_but_no_pole():
    """At the stall a_C is alpha dY/dtheta, finite, although nothing goes on beyond."""
    result = dx.peak("a_C", ec=0.01, AB=0.04, BC=0.1, omega0=10.0, alpha=-50.0, kind="max", theta=(0.0, 2.0))
    slope = dx.evaluate("V_C", theta=1.0, ec=0.01, AB=0.04, BC=0.1, omega=1.0)
    assert result["theta"] == pytest.approx(1.0, abs=1e-9)
    assert result["value"] == pytest.approx(-50.0 * slope, rel=1e-9)
    assert result["status"] == 2


def test_what_needs_no_motion_and_what_is_nothing():
    """Statics: virtual work, T_in = -F_Y dY/dtheta. No speed is needed, and a given one changes nothing."""
    design = {"ec": 0.06, "AB": 0.14, "BC": 0.31}
    speed = dx.peak("V_C", omega0=1.0, **design)
    for motion in ({}, {"omega0": 0.0}, {"omega0": OMEGA}):
        torque = dx.peak("T_in", F_Y=-50.0, **design, **motion)
        assert torque["value"] == pytest.approx(50.0 * speed["value"], rel=1e-13)
        assert torque["theta"] == pytest.approx(speed["theta"], abs=1e-9)
        assert torque["gradient"]["F_Y"] == pytest.approx(-speed["value"], rel=1e-13)
        assert torque["gradient"]["ec"] == pytest.approx(50.0 * speed["gradient"]["ec"], rel=1e-9)
        assert "omega0" not in torque["gradient"]
    assert dx.peak("T_in", **design)["value"] == 0.0
    crank = dx.peak("T_in", m_crank=2.0, g_Y=-10.0, **design)
    assert crank["value"] == pytest.approx(2.0 * 10.0 * 0.07)
    assert dx.peak("V_B", omega0=3.0, **design)["value"] == pytest.approx(0.42)


def test_designs_broadcast_and_what_cannot_be_is_told():
    result = dx.peak("a_C", ec=[[0.0], [0.15], [0.9]], AB=[0.125, 0.1], BC=0.35, omega0=OMEGA)
    assert result["value"].shape == result["theta"].shape == result["gradient"]["AB"].shape == (3, 2)
    assert result["status"].tolist() == [[0, 0], [0, 0], [1, 1]]
    assert np.isnan([result[key][2] for key in ("value", "theta")]).all()
    one = dx.peak("a_C", ec=0.15, AB=0.1, BC=0.35, omega0=OMEGA)
    assert result["value"][1, 1] == pytest.approx(one["value"], rel=1e-14)


def test_of_two_equal_peaks_the_first_is_told():
    assert dx.peak("V_C", ec=0.0, **MACHINE)["theta"] == pytest.approx(1.26120, abs=1e-5)
    assert dx.peak("a_C", ec=0.0, kind="max", **MACHINE)["theta"] < np.pi


def test_a_state_has_a_peak_too():
    law = dx.peak("a_C", ec=0.1, **MACHINE)
    state = dx.peak("a_C", ec=0.1, AB=0.125, BC=0.35, omega=OMEGA)
    assert state["value"] == pytest.approx(law["value"], rel=1e-14)
    assert state["gradient"]["omega"] == pytest.approx(law["gradient"]["omega0"], rel=1e-12)


@pytest.mark.parametrize(
    ("name", "arguments", "words"),
    [
        ("a_C", {"kind": "largest"}, "kind = 'largest': it is one of absmax, max, min"),
        ("a_C", {"theta": (1.0, 0.0)}, r"theta = \(1.0, 0.0\)"),
        ("a_C", {"theta": 1.0}, r"theta = 1.0: expected a range \(lower end, upper end\)"),
        ("a_C", {"AB": -1.0}, "AB = -1.0"),
        ("margin", {}, "margin has no peak over theta"),
        ("a_D", {}, "unknown quantity 'a_D'"),
    ],
)
def test_wrong_input_is_named(name, arguments, words):
    with pytest.raises(ValueError, match=words):
        dx.peak(name, **{"ec": 0.0, **MACHINE, **arguments})


# ---- completeness, other ways of the same, sensitivities without a derived slope ------------------


def random_designs(seed, count, near):
    """Lengths, speed and law; `near` draws margins down to 2^-45 crank lengths."""
    rng = np.random.default_rng(seed)
    AB = rng.uniform(0.05, 2.0, count)
    margin = 2.0 ** -rng.uniform(0.0, 45.0, count) if near else rng.uniform(0.05, 4.0, count)
    ec = rng.uniform(-1.0, 1.0, count) * AB * (rng.uniform(size=count) > 0.15)  # some are centric
    omega0 = rng.choice([-1.0, 1.0], count) * rng.uniform(1.0, 200.0, count)
    alpha = rng.uniform(-0.07, 0.5, count) * omega0**2 * (rng.uniform(size=count) > 0.5)
    return {"ec": ec, "AB": AB, "BC": AB + np.abs(ec) + margin * AB, "omega0": omega0, "alpha": alpha}


def dense_angles():
    """A uniform sweep, and one graded towards both quarters: 60 angles an octave of distance."""
    graded = 2.0 ** -np.arange(0.0, 40.0, 1 / 15)
    quarters = [q + side * graded for q in (np.pi / 2, 3 * np.pi / 2) for side in (-1, 1)]
    every = np.concatenate([np.linspace(0.0, 2 * np.pi, 1501), *quarters])
    return np.sort(every[(every >= 0.0) & (every <= 2 * np.pi)])


@pytest.mark.thorough
@pytest.mark.parametrize("near", [False, True])
@pytest.mark.parametrize("name", ["V_C", "a_C", "j_C", "alpha_BC", "a_C_wrt_ec"])
def test_no_extremum_is_missed(name, near):
    """Random designs against thousands of angles each, close to the change point too."""
    designs, theta = random_designs(3, 150, near), dense_angles()
    branch = -1 if name in ("V_C", "alpha_BC") else 1
    columns = {n: column[:, None] for n, column in designs.items()}
    swept = dx.evaluate(name, theta=theta, branch=branch, **columns)
    scale = np.nanmax(np.abs(swept), axis=1)
    for kind, best in (
        ("max", np.nanmax(swept, axis=1)),
        ("min", np.nanmin(swept, axis=1)),
        ("absmax", scale),
    ):
        result = dx.peak(name, kind=kind, branch=branch, **designs)["value"]
        short = (result - best if kind == "min" else best - result) / scale
        assert short.max() <= 1e-13, np.argmax(short)


def test_two_maxima_next_to_the_inner_dead_centre():
    """They become one where Y = 0 at theta = pi: -1 + 4/l - 3/l^3 = 0, l = BC/AB = (3 + sqrt(21))/2."""
    ratio = np.linspace(3.3, 4.1, 400)
    result = dx.peak("a_C", ec=0.0, AB=1.0, BC=ratio, omega0=1.0, kind="max")
    centre = 1.0 - 1.0 / ratio  # a_C at theta = pi
    assert np.all(result["value"] >= centre * (1.0 - 1e-15))
    apart = np.abs(result["theta"] - np.pi) > 1e-6
    assert np.all(apart[ratio < 3.7905])
    assert not apart[ratio > 3.7915].any()
    theta = result["theta"][ratio < 3.7905]
    for angle, value, BC in zip(
        theta[::40], result["value"][ratio < 3.7905][::40], ratio[::40], strict=False
    ):
        _, exact = exact_peak(2, angle, 0.0, 1.0, BC)
        assert abs(value / exact - 1) < 1e-14


@pytest.mark.thorough
@pytest.mark.parametrize("special", [False, True], ids=["all turn", "one is bad, one does not turn"])
def test_the_same_in_parts_and_on_threads(monkeypatch, special):
    designs = {name: column.copy() for name, column in random_designs(6, 400, False).items()}
    designs["alpha"][:] = 0.0  # none stalls
    if special:
        designs["AB"][7], designs["BC"][300] = -1.0, 0.5 * designs["AB"][300]
    whole = dx.peak("a_C", threads=1, **designs)
    assert (whole["status"] != 0).sum() == 2 * special
    for part in ("USUAL_PART", "COSTLY_PART"):
        monkeypatch.setattr(f"desaxe.peaks.designs.{part}", (100, 100))
    parts = dx.peak("a_C", threads=2, **designs)
    for name in ("value", "theta", "status"):
        np.testing.assert_array_equal(whole[name], parts[name])
    for name, slope in whole["gradient"].items():
        np.testing.assert_array_equal(slope, parts["gradient"][name])


def test_a_design_alone_has_the_peak_that_it_has_among_others():
    designs = random_designs(7, 1000, True)
    many = dx.peak("a_C", **designs)
    for k in range(0, 1000, 125):
        alone = dx.peak("a_C", **{n: float(column[k]) for n, column in designs.items()})
        for name in ("value", "theta", "side", "status"):
            assert alone[name] == many[name][k], name
        for name, slope in alone["gradient"].items():
            assert slope == many["gradient"][name][k], name


@pytest.mark.parametrize(
    ("name", "near"), [("Y_wrt_ec_ec", 1e-7), ("a_C_wrt_ec_BC", 1e-7), ("T_in_wrt_m_slider", 1e-7)]
)
def test_sensitivities_have_peaks_too(name, near):
    """Where no derivative by theta is derived, it is that of the program; so is a missing gradient."""
    design = {"ec": 0.04, "AB": 0.125, "BC": 0.35, "omega0": 20.0}
    design |= {"m_rod": 0.5, "m_slider": 0.8} if name.startswith("T_in") else {}
    swept = np.abs(dx.evaluate(name, theta=np.linspace(0, 2 * np.pi, 20_001), **design)).max()
    result = dx.peak(name, **design)
    assert swept <= result["value"] * (1 + 1e-15)
    assert result["value"] == pytest.approx(swept, rel=near)
    for parameter in ("ec", "BC"):
        step = 1e-6
        up, down = (
            dx.peak(name, **{**design, parameter: design[parameter] + s})["value"] for s in (step, -step)
        )
        assert result["gradient"][parameter] == pytest.approx((up - down) / (2 * step), rel=1e-6)


@pytest.mark.parametrize(
    ("name", "order", "design"),
    [
        ("a_C", 2, (0.15, 0.125, 0.35)),
        ("a_C", 2, (0.5, 1.0, 1.5 + 2.0**-20)),
        ("V_C", 1, (-0.1, 0.125, 0.35)),
        ("j_C", 3, (0.3, 1.0, 1.3 + 2.0**-10)),
    ],
)
def test_gradient_is_exact(name, order, design):
    """Against differences of the peak in 50 digits."""
    result = dx.peak(name, **dict(zip(("ec", "AB", "BC"), design, strict=True)), omega0=1.0)
    with mpmath.workdps(60):
        exact = [mpmath.mpf(x) for x in design]
        step = mpmath.mpf(10) ** -25
        sign = mpmath.sign(rate(order, *exact)(mpmath.mpf(result["theta"])))
        for place, parameter in enumerate(("ec", "AB", "BC")):
            ends = []
            for side in (1, -1):
                moved = list(exact)
                moved[place] += side * step
                near = mpmath.mpf(result["theta"])  # the peak is narrow: two starts next to each other
                theta = mpmath.findroot(rate(order + 1, *moved), (near, near + 1e-10), verify=False)
                ends.append(sign * rate(order, *moved)(theta))
            slope = (ends[0] - ends[1]) / (2 * step)
            assert result["gradient"][parameter] == pytest.approx(float(slope), rel=1e-9), parameter


def test_the_curve_up_to_the_edge_of_feasibility():
    """Values and slopes exist up to the last eccentricity; beyond it the acceleration has no bound."""
    ec = 0.225 + np.array([-1e-3, -1e-6, -1e-9, -1e-12, 1e-12, 1e-6])
    result = dx.peak("a_C", ec=ec, **MACHINE)
    assert result["status"].tolist() == [0, 0, 0, 0, 2, 2]
    assert np.isfinite(result["value"][:4]).all()
    assert np.isfinite(result["gradient"]["ec"][:4]).all()
    assert np.isinf(result["value"][4:]).all()
    assert np.isnan(result["gradient"]["ec"][4:]).all()
    assert np.all(np.diff(result["value"][:4]) > 0.0)


@pytest.mark.parametrize(
    "bad", [{"ec": math.nan}, {"ec": math.inf}, {"BC": -1.0}, {"BC": math.nan, "AB": -1.0}]
)
@pytest.mark.parametrize(("name", "loads"), [("a_C", {}), ("T_in", {"m_slider": 1.0, "mu": 0.1})])
def test_a_bad_design_is_told_alone(name, loads, bad):
    """Also where no other design of the call needs a closer look."""
    good = {"ec": 0.01, "AB": 0.06, "BC": 0.22, "omega0": 94.2}
    columns = {key: np.array([value, bad.get(key, value), value]) for key, value in good.items()}
    result = dx.peak(name, **columns, **loads)
    assert result["status"].tolist() == [0, 4, 0]
    assert np.isnan(result["value"]).tolist() == [False, True, False]
    assert np.isnan(result["gradient"]["ec"]).tolist() == [False, True, False]
    assert result["value"][0] == pytest.approx(dx.peak(name, **good, **loads)["value"], rel=1e-12)


@pytest.mark.parametrize("branch", [1, -1])
@pytest.mark.parametrize(("ec", "AB", "BC"), [(0.25, 0.5, 0.75), (-0.125, 0.375, 0.5)])
def test_the_jump_of_a_rate_at_an_eccentric_change_point_has_no_gradient(ec, AB, BC, branch):
    """AB + |ec| = BC: |dY/dtheta| is AB + sqrt(AB BC) on one side of the quarter, sqrt(AB BC) - AB beyond."""
    design = {"ec": ec, "AB": AB, "BC": BC, "omega0": 2.0, "branch": branch}
    for name, value in (("V_C", 2.0 * (AB + math.sqrt(AB * BC))), ("s", None)):
        result = dx.peak(name, **design)
        assert result["status"] == 2
        assert value is None or result["value"] == pytest.approx(value, rel=1e-9)
        assert all(np.isnan(result["gradient"][p]) for p in ("ec", "AB", "BC"))
    elsewhere = dx.peak("Y", **design)
    assert elsewhere["status"] == 0
    assert np.isfinite(list(elsewhere["gradient"].values())).all()


@pytest.mark.parametrize("kind", ["absmax", "max"])
def test_a_rate_that_jumps_at_a_change_point_has_no_gradient(kind):
    """AB = BC in line: Y = AB (cos theta + |cos theta|), so that V_C jumps from -2 AB omega to 0 across."""
    result = dx.peak("V_C", kind=kind, ec=0.0, AB=np.array([0.3, 0.3]), BC=np.array([0.3, 0.4]), omega0=2.0)
    assert result["value"][0] == pytest.approx(1.2, rel=1e-9)
    assert result["status"].tolist() == [2, 0]
    assert np.isnan(result["gradient"]["AB"]).tolist() == [True, False]
    assert result["gradient"]["omega0"][0] == pytest.approx(result["value"][0] / 2.0, rel=1e-9)
    still = dx.peak("Y", ec=0.0, AB=0.3, BC=0.3)
    assert (still["status"], still["value"], still["gradient"]["AB"]) == (0, 0.6, 1.0)
