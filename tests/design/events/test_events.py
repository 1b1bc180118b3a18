"""Dead centres, strokes and extremes against roots of the raw loop closure at 50 digits."""

import math

import mpmath as mp
import numpy as np
import pytest
from hypothesis import HealthCheck, assume, example, given, settings
from hypothesis import strategies as st

import desaxe as dx

DESIGNS = [
    (0.02, 0.04, 0.064), (-0.02, 0.04, 0.064), (0.0, 0.125, 0.35), (1e-9, 0.125, 0.35),
    (1e-300, 0.125, 0.35), (0.2249, 0.125, 0.35), (0.225 - 1e-12, 0.125, 0.35),
    (-(0.225 - 1e-15), 0.125, 0.35), (0.1, 1e-6, 0.35), (0.3, 2.0**-40, 0.35),
    (2.0**-30, 1.0, 1.0 + 2.0**-29), (0.0, 1.0, 1.0 + 2.0**-52), (5.0, 0.5, 1e6),
    (1e-58, 2e-58, 4e-58), (1e58, 2e58, 4e58),
]  # fmt: skip
SLOPES = (
    "theta_outer", "theta_inner", "Y_outer", "Y_inner", "stroke", "advance_angle", "return_angle",
    "time_ratio", "max_pressure_angle", "min_transmission_angle",
)  # fmt: skip
LENGTHS = ("ec", "AB", "BC")


class Oracle:
    """Dead centres: dY/dtheta = 0 on the raw loop, |C - B| = BC, by bisection between quarters."""

    def __init__(self, ec, AB, BC):
        self.ec, self.AB, self.BC = mp.mpf(ec), mp.mpf(AB), mp.mpf(BC)
        self.outer, self.inner = self.stop(-1), self.stop(1)
        self.stroke = self.Y(self.outer) - self.Y(self.inner)
        self.back = self.inner - self.outer
        self.ahead = 2 * mp.pi - self.back
        self.ratio = max(self.ahead / self.back, self.back / self.ahead)

    def rise(self, theta):
        """From B up to C."""
        return mp.sqrt(self.BC**2 - (self.ec + self.AB * mp.sin(theta)) ** 2)

    def Y(self, theta):
        return self.AB * mp.cos(theta) + self.rise(theta)

    def slope(self, theta):
        """(C - B) . (dC - dB) = 0 gives dY, here times the rod's rise."""
        across = self.ec + self.AB * mp.sin(theta)
        return -self.rise(theta) * self.AB * mp.sin(theta) - across * self.AB * mp.cos(theta)

    def stop(self, quarter):
        a, b = quarter * mp.pi / 2, (quarter + 2) * mp.pi / 2
        left = mp.sign(self.slope(a))
        for _ in range(190):
            middle = (a + b) / 2
            if mp.sign(self.slope(middle)) == left:
                a = middle
            else:
                b = middle
        return (a + b) / 2

    def quantities(self):
        steep = mp.pi / 2 * (1 if self.ec >= 0 else -1)
        pressure = abs(mp.asin((self.ec + self.AB * mp.sin(steep)) / self.BC))
        return {
            "theta_outer": self.outer, "theta_inner": self.inner, "Y_outer": self.Y(self.outer),
            "Y_inner": self.Y(self.inner), "stroke": self.stroke, "advance_angle": self.ahead,
            "return_angle": self.back, "time_ratio": self.ratio, "max_pressure_angle": pressure,
            "min_transmission_angle": mp.pi / 2 - pressure,
        }  # fmt: skip


def close(value, exact, bound):
    """Relative, or absolute where the exact value is far below 1."""
    return abs(mp.mpf(value) - exact) <= bound * abs(exact)


@pytest.mark.parametrize(("ec", "AB", "BC"), DESIGNS)
def test_values(ec, AB, BC):
    with mp.workdps(60 if AB > 1e-100 else 420):
        oracle = Oracle(ec, AB, BC)
        exact = oracle.quantities()
        result = dx.events(ec=ec, AB=AB, BC=BC)
        arrays = dx.events(ec=np.array([ec, 0.0]), AB=AB, BC=BC)
        for name, value in exact.items():
            tiny = name == "theta_outer" and abs(ec) < 1e-20 * AB  # the bisection ends at 1e-57
            for own in (result[name], float(arrays[name][0])):
                assert close(own, value, 2e-15) or (tiny and abs(own - value) < 1e-50), name
    assert result["status"] == 0
    assert result["slow_stroke"] == (ec > 0) - (ec < 0)


@pytest.mark.parametrize(
    ("ec", "AB", "BC"), [*DESIGNS[:2], *DESIGNS[5:7], (0.1, 1e-6, 0.35), (-3e-3, 0.1, 0.11)]
)
def test_gradients(ec, AB, BC):
    with mp.workdps(60):
        h = mp.mpf(2) ** -90
        result = dx.events(ec=ec, AB=AB, BC=BC)["gradient"]
        for k, parameter in enumerate(LENGTHS):
            up, down = (
                [mp.mpf(x) + (j == k) * side * h for j, x in enumerate((ec, AB, BC))] for side in (1, -1)
            )
            up, down = Oracle(*up).quantities(), Oracle(*down).quantities()
            for name in SLOPES:
                exact = (up[name] - down[name]) / (2 * h)
                assert close(result[name][parameter], exact, 1e-13), (name, parameter)


@pytest.mark.parametrize(
    ("ec", "AB", "BC"), [*DESIGNS[:3], DESIGNS[5], (0.05, 0.01, 0.35), (-0.1, 0.3, 0.41)]
)
@pytest.mark.parametrize("omega0", [157.0, -3.0])
@pytest.mark.parametrize("branch", [1, -1])
def test_velocities_are_the_peaks(ec, AB, BC, omega0, branch):
    design = {"ec": ec, "AB": AB, "BC": BC, "omega0": omega0, "branch": branch}
    result = dx.events(**design)
    for name, kind in (
        ("V_outward", "max" if branch > 0 else "min"),
        ("V_inward", "min" if branch > 0 else "max"),
    ):
        top = dx.peak("V_C", kind=kind, **design)
        assert result[name] == pytest.approx(abs(top["value"]), rel=1e-13)
        assert math.cos(result[f"theta_{name}"] - top["theta"]) == pytest.approx(1.0, abs=1e-12)
        if ec:  # else the peak is one of two
            for p, slope in top["gradient"].items():
                sign = math.copysign(1.0, top["value"])
                assert result["gradient"][name][p] == pytest.approx(
                    sign * slope, rel=1e-6, abs=1e-8 * omega0**2
                )
    assert "omega0" not in dx.events(**{**design, "omega0": None})["gradient"]["V_inward"]


@pytest.mark.parametrize("ec", [1e-3, -1e-9, 1e-14])
def test_a_small_angle_keeps_its_digits_on_the_other_branch(ec):
    """There the slider is nearest to the crank next to theta = 0."""
    with mp.workdps(60):
        exact = mp.asin(mp.mpf(ec) / (mp.mpf(0.35) - mp.mpf(0.125)))
        assert close(dx.events(ec=ec, AB=0.125, BC=0.35, branch=-1)["theta_inner"], exact, 1e-15)
        many = dx.events(ec=[ec, 0.0], AB=0.125, BC=0.35, branch=-1)["theta_inner"]
        assert close(float(many[0]), exact, 1e-15)


lengths = st.floats(1e-3, 1e3)


@settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])  # a busy machine
@given(AB=lengths, BC=lengths, share=st.floats(-1.0, 1.0))
@example(AB=1.0, BC=2.0, share=1.0)
@example(AB=1.0, BC=1.0, share=0.0)
def test_symmetries(AB, BC, share):
    assume(BC >= AB)
    ec = share * (BC - AB)
    assume(dx.feasibility(ec=ec, AB=AB, BC=BC)["can_turn"])
    one, other = dx.events(ec=ec, AB=AB, BC=BC), dx.events(ec=-ec, AB=AB, BC=BC)
    for name in ("stroke", "time_ratio", "Y_outer", "Y_inner", "max_pressure_angle"):
        assert one[name] == other[name]
    assert (one["advance_angle"], one["slow_stroke"]) == (other["return_angle"], -other["slow_stroke"])
    assert one["theta_outer"] == -other["theta_outer"]
    assert one["advance_angle"] + one["return_angle"] == pytest.approx(2 * math.pi, rel=1e-15)
    assert one["V_outward"] == pytest.approx(other["V_inward"], rel=1e-9)
    large = dx.events(ec=1024 * ec, AB=1024 * AB, BC=1024 * BC)
    assert large["stroke"] == 1024 * one["stroke"]
    assert large["time_ratio"] == one["time_ratio"]
    assert 1.0 <= one["time_ratio"] < 3.0


def test_in_line():
    result = dx.events(ec=0.0, AB=0.125, BC=0.35)
    assert (result["stroke"], result["time_ratio"], result["slow_stroke"]) == (0.25, 1.0, 0)
    assert (result["theta_outer"], result["theta_inner"]) == (0.0, math.pi)
    assert result["gradient"]["stroke"] == {"ec": 0.0, "AB": 2.0, "BC": 0.0}


def test_change_points():
    result = dx.events(ec=0.25, AB=0.5, BC=0.75)
    assert result["status"] == 2
    assert (result["Y_inner"], result["theta_inner"]) == (0.0, math.pi / 2)
    assert result["stroke"] == pytest.approx(math.sqrt(1.25**2 - 0.25**2), rel=1e-15)
    assert result["gradient"]["stroke"]["ec"] == math.inf
    # Towards it the largest speed is AB omega (1 + sqrt(BC/AB)), from below.
    assert result["V_inward"] == pytest.approx(0.5 * (1 + math.sqrt(1.5)), rel=1e-12)
    equal = dx.events(ec=0.0, AB=0.5, BC=0.5)
    assert (equal["stroke"], equal["time_ratio"], equal["theta_inner"]) == (1.0, 1.0, math.pi)


@pytest.mark.parametrize("branch", [1, -1])
@pytest.mark.parametrize("omega0", [3.0, -3.0])
@pytest.mark.parametrize(("ec", "AB"), [(0.25, 0.5), (-0.25, 0.5), (1.0, 0.5), (-0.75, 0.25)])
def test_at_a_change_point_the_speed_is_that_within_the_stroke(ec, AB, omega0, branch):
    """It jumps there: from the other side it would be that of the other stroke."""
    BC = AB + abs(ec)
    result = dx.events(ec=ec, AB=AB, BC=BC, omega0=omega0, branch=branch)
    arrays = dx.events(ec=[ec], AB=AB, BC=BC, omega0=omega0, branch=branch)
    limit = AB * abs(omega0) * (1 + math.sqrt(BC / AB))
    speeds = result["V_outward"], result["V_inward"]
    assert max(speeds) == pytest.approx(limit, rel=1e-14)
    theta = np.linspace(0.0, 2 * np.pi, 1_501)[:-1] + 1e-4
    swept = dx.evaluate("V_C", theta=theta, ec=ec, AB=AB, BC=BC, omega0=omega0, branch=branch) * branch
    assert speeds == pytest.approx((swept.max(), -swept.min()), rel=1e-2)
    assert [arrays[name][0] for name in ("V_outward", "V_inward")] == pytest.approx(speeds, rel=1e-14)


@pytest.mark.parametrize("branch", [1, -1])
@pytest.mark.parametrize("omega0", [3.0, -3.0])
@pytest.mark.parametrize("AB", [0.5, 7e-9])
def test_a_crank_as_long_as_its_rod_is_fastest_where_the_slider_comes_to_rest_at_A(AB, omega0, branch):
    """Y = 2 AB cos(theta) for half of the turn, else 0: 2 AB omega is a limit from one side."""
    one = dx.events(ec=0.0, AB=AB, BC=AB, omega0=omega0, branch=branch)
    many = dx.events(ec=[0.0, 0.0, 0.3 * AB], AB=AB, BC=[AB, 2 * AB, 2 * AB], omega0=omega0, branch=branch)
    limit = fastest(AB, 0, branch)
    assert abs(fastest(AB, mp.mpf(2) ** -80, branch) / limit - 1) < 1e-11  # that of longer rods
    for result in (one, {n: v[0] for n, v in many.items() if n != "gradient"}):
        for name, way in (("V_outward", -1), ("V_inward", 1)):
            assert result[name] == pytest.approx(float(abs(omega0) * limit), rel=1e-15)
            quarter = branch * way * math.copysign(math.pi / 2, omega0)
            assert abs(math.remainder(result[f"theta_{name}"] - quarter, 2 * math.pi)) < 4e-15
    for name in ("V_outward", "V_inward"):
        slopes = one["gradient"][name]
        assert slopes["omega0"] == pytest.approx(math.copysign(2 * AB, omega0), rel=1e-15)
        assert (slopes["AB"], slopes["BC"]) == (math.inf, -math.inf)  # as a root of the margin
        assert slopes == {p: column[0] for p, column in many["gradient"][name].items()}
    assert one["status"] == many["status"][0] == 2


def fastest(AB, longer, branch):
    """The largest |dY/dtheta| of the raw loop without eccentricity, by differences at 200 digits.

    longer   by how much of its length the rod is longer than the crank
    """
    with mp.workdps(200):
        AB, h = mp.mpf(AB), mp.mpf(10) ** -60
        BC = AB * (1 + longer)

        def position(theta):
            return AB * mp.cos(theta) + branch * mp.sqrt(BC**2 - (AB * mp.sin(theta)) ** 2)

        quarter = mp.pi / 2 if branch > 0 else 3 * mp.pi / 2
        near = [quarter - mp.mpf(2) ** -k for k in range(1, 100)]
        return max(abs(position(theta + h) - position(theta - h)) / (2 * h) for theta in near)


def test_a_crank_that_only_rocks_has_dead_centres_but_no_stroke():
    lengths = {"ec": 0.1, "AB": 0.5, "BC": 0.3}
    long_crank = dx.events(**lengths)
    assert long_crank["status"] == 1
    for name in ("outer", "inner"):
        Y, slope = dx.evaluate(
            ["Y", "Y_wrt_theta"], theta=long_crank[f"theta_{name}"], ec=0.1, AB=0.5, BC=0.3
        ).values()
        assert slope == pytest.approx(0.0, abs=1e-15)
        assert pytest.approx(long_crank[f"Y_{name}"], rel=1e-14) == Y
    assert all(math.isnan(long_crank[n]) for n in ("stroke", "time_ratio", "advance_angle", "V_inward"))
    assert math.isnan(dx.events(ec=0.9, AB=0.5, BC=0.3)["theta_outer"])


@pytest.mark.parametrize("omega0", [251.0, -251.0])
@pytest.mark.parametrize("branch", [1, -1])
def test_advance_is_outward(branch, omega0):
    """Sampled: the share of a turn in which the slider moves away from the crank."""
    design = {"ec": 0.02, "AB": 0.04, "BC": 0.064, "branch": branch}
    theta = (np.arange(200_000) + 0.5) * 2 * np.pi / 200_000
    outward = np.mean(branch * dx.evaluate("V_C", theta=theta, omega0=omega0, **design) > 0)
    result = dx.events(omega0=omega0, **design)
    assert result["advance_angle"] == pytest.approx(2 * np.pi * outward, abs=1e-4)
    assert result["slow_stroke"] == (1 if outward > 0.5 else -1)
    for name in ("outer", "inner"):
        at = dx.evaluate("Y", theta=result[f"theta_{name}"], **design)
        assert at == pytest.approx(result[f"Y_{name}"], rel=1e-14)
        assert -math.pi / 2 <= result[f"theta_{name}"] <= 1.5 * math.pi


def test_paper_b():
    """Table 1: the dead centres at -11.087 and 123.557 deg, 225.355 deg outward, 134.645 inward; 88.79 mm."""
    result = dx.events(ec="20 mm", AB="40 mm", BC="64 mm", omega0="2400 rpm")
    degrees = [
        round(math.degrees(result[n]), 3)
        for n in ("theta_outer", "theta_inner", "advance_angle", "return_angle")
    ]
    assert degrees == [-11.087, 123.557, 225.355, 134.645]
    assert round(result["stroke"] * 1e3, 2) == 88.79
    assert round(dx.events(ec=0.01, AB=0.04, BC=0.064)["stroke"] * 1e3, 2) == 81.70
    assert round(dx.events(ec=0.02, AB=0.04, BC=0.064, omega0=251.0)["V_inward"], 2) == 16.97
    assert round(dx.events(ec=0.02, AB=0.04, BC=0.064, omega0=251.0)["V_outward"], 2) == 10.49


def flat(result):
    """Names and values, gradients among them."""
    for name, value in result.items():
        if name != "gradient":
            yield name, value
    for name, slopes in result["gradient"].items():
        for parameter, slope in slopes.items():
            yield f"{name} by {parameter}", slope


def test_arrays_agree_with_numbers_and_keep_bad_ones_apart():
    ec = np.array([0.02, -0.02, 0.0, 0.03, np.nan, 0.0239])
    for branch in (1, -1):
        for omega0 in (251.0, -251.0):
            many = dx.events(ec=ec, AB=0.04, BC=[[0.064], [0.08]], branch=branch, omega0=omega0)
            assert many["status"].tolist() == [[0, 0, 0, 1, 4, 0], [0, 0, 0, 0, 4, 0]]
            for i, BC in enumerate((0.064, 0.08)):
                for j in (0, 1, 2, 3, 5):
                    one = dx.events(ec=ec[j], AB=0.04, BC=BC, branch=branch, omega0=omega0)
                    for name, value in flat(one):
                        own = dict(flat(many))[name][i, j]
                        assert own == pytest.approx(value, rel=1e-7, abs=1e-9, nan_ok=True), name
    assert np.isnan(many["stroke"][0, 4])


@pytest.mark.parametrize("ec", [[1.0, 2.0], [math.nan, 1.0]])
def test_none_of_several_designs_turns(ec):
    result = dx.events(ec=ec, AB=0.125, BC=0.35)
    assert np.isnan([result["V_outward"], result["stroke"]]).all()
    assert result["status"].tolist() == [4 if math.isnan(ec[0]) else 1, 1]


@pytest.mark.parametrize("ec", [0.1, -0.1])
def test_a_crank_that_does_not_turn_has_no_slower_stroke(ec):
    one = dx.events(ec=ec, AB=0.2, BC=0.1)
    many = dx.events(ec=np.array([ec, ec]), AB=[0.2, 0.04], BC=0.15)
    assert (one["status"], one["slow_stroke"]) == (1, 0)
    assert many["status"].tolist() == [1, 0]
    assert many["slow_stroke"].tolist() == [0, round(math.copysign(1.0, ec))]


def test_velocities_without_a_speed_are_slopes_of_the_position():
    machine = dx.Machine(ec=10, AB=75, BC=300, units="mm, deg, rpm")
    result = machine.events()
    assert result.units["V_inward"] == "mm/deg"
    slopes = machine.evaluate("Y_wrt_theta", theta=np.linspace(0.0, 360.0, 36_001))
    assert result["V_inward"] == pytest.approx(np.abs(slopes).max(), rel=1e-7)
    at_speed = machine.events(omega0=300)
    assert at_speed.units["V_inward"] == "mm/s"
    assert at_speed["V_inward"] == pytest.approx(result["V_inward"] * 300 * 6, rel=1e-13)
