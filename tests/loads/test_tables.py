"""Tables of loads: what they are between their points, and what is refused."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import desaxe as dx

TURN = 2 * np.pi
FORCES = [-4000.0, -5000.0, -900.0, 0.0, 50.0, -1500.0]


@pytest.mark.parametrize("count", [2, 3, 4, 40])
def test_the_periodic_spline_is_scipys(count):
    random = np.random.default_rng(count)
    x, y = np.sort(random.random(count)) * 6.0, random.normal(size=count)
    right = CubicSpline(np.append(x, x[0] + TURN), np.append(y, y[0]), bc_type="periodic")
    load = dx.over_theta(x, y) if count > 3 else dx.over_theta(x * 1.0, y)
    at = random.uniform(-20.0, 20.0, 200)
    scale = np.abs(right(at)).max()
    np.testing.assert_allclose(load(at), right(at), atol=1e-12 * scale)
    np.testing.assert_array_equal(load(at), [load(float(theta)) for theta in at])


def test_a_table_repeats_after_its_period_whether_its_end_point_is_given_or_not():
    x = np.linspace(0.0, 4 * np.pi, 9)
    y = np.cos(x / 2)
    whole, open_end = dx.over_theta(x, y, period=4 * np.pi), dx.over_theta(x[:-1], y[:-1], period=4 * np.pi)
    assert whole == open_end
    assert whole(1.0 + 4 * np.pi) == pytest.approx(whole(1.0))
    assert whole(1.0 + TURN) != pytest.approx(whole(1.0))


@pytest.mark.parametrize("first", [-720.0, -360.0, 0.0, 360.0, 720.0])
def test_a_table_may_begin_in_any_turn(first):
    """Whole turns before or behind, it is the same cycle; around the angle 0 doubles are too many to walk."""
    machine = {"ec": 0.003, "AB": 0.045, "BC": 0.14, "omega0": 200.0, "m_slider": 0.5}
    begin = np.radians(first)
    angles = np.radians([0.0, 20.0, 90.0, 200.0, 450.0, 700.0])
    load = dx.over_theta(begin + angles, FORCES, "linear", period="720 deg")
    result = dx.peak("T_in", F_Y=load, **machine)
    theta = np.linspace(0.0, 4.0 * np.pi, 20001)
    force = np.interp((theta - begin) % (4.0 * np.pi), [*angles, 4.0 * np.pi], [*FORCES, -4000.0])
    torque = np.abs(dx.evaluate("T_in", theta=theta, F_Y=force, **machine))
    assert result["value"] == pytest.approx(torque.max(), rel=1e-5)
    assert result["theta"] == pytest.approx(theta[torque.argmax()], abs=1e-3)


@pytest.mark.parametrize("kind", ["cubic", "linear", "step"])
def test_both_ends_of_a_period_alone_are_a_load_that_is_the_same_everywhere(kind):
    load = dx.over_theta(["10 deg", "370 deg"], [5.0, 5.0], kind=kind)
    assert len(load.arrays().knots) == 2  # which modules take: one is no table
    assert set(load(np.linspace(-9.0, 9.0, 50)).tolist()) == {5.0}
    machine = {"theta": 1.0, "ec": 0.01, "AB": 0.04, "BC": 0.1}
    names = ["T_in", "T_in_wrt_theta"]
    assert dx.evaluate(names, F_Y=load, **machine) == dx.evaluate(names, F_Y=5.0, **machine)


def test_over_Y_holds_its_ends_and_may_be_given_downwards():
    up, down = dx.over_Y([0.1, 0.2, 0.4], [1.0, 3.0, 2.0]), dx.over_Y([0.4, 0.2, 0.1], [2.0, 3.0, 1.0])
    assert up == down
    np.testing.assert_allclose(up(np.array([0.0, 0.15, 0.3, 9.0])), [1.0, 2.0, 2.5, 2.0])


def test_units():
    load = dx.over_theta(["0 deg", "90 deg", "180 deg"], ["0 kN", "-2 kN", "0.1 kN"], kind="linear")
    assert load(np.pi / 2) == -2000.0
    torque = dx.over_theta([0.0, 1.0], ["1 N*m", "2 N*m"], kind="step")
    with pytest.raises(ValueError, match=r"F_Y: the load is in N\*m, expected N"):
        dx.evaluate("T_in", theta=0.0, F_Y=torque, ec=0.0, AB=0.1, BC=0.3)


@pytest.mark.parametrize(
    ("angles", "values", "more", "message"),
    [
        ([0, 1, 1], [1, 2, 3], {}, "the angles must ascend, but 1 follows 1"),
        ([0, 1], [1, 2, 3], {}, "2 angles and 3 values"),
        ([0], [1], {}, "at least two points"),
        ([0, 7], [1, 2], {}, "the angles go over 7 rad"),
        ([0, 3, TURN], [1, 2, 3], {}, "at the end of the period the value is 3.0, but 1.0"),
        ([0, np.nan], [1, 2], {}, "angles: nan"),
        ([0, 1], [1, np.inf], {}, "values: inf"),
        ([0, 1], [1, 2], {"kind": "quadratic"}, "kind = 'quadratic': it is one of cubic, linear, step"),
        ([0, 1], [1, 2], {"period": -1.0}, "period = -1.0"),
        ([0, 1], [1, 2], {"derivative": np.cos}, "belong to a function"),
        ([0, 1], ["a", "b"], {}, "values"),
        ([0, 1], None, {}, "values is missing"),
        (np.sin, [1, 2], {}, "beside a function"),
        ("0 deg", [1], {}, "a list or array"),
    ],
)
def test_tables_that_are_no_periodic_function_are_refused(angles, values, more, message):
    with pytest.raises((ValueError, TypeError), match=message):
        dx.over_theta(angles, values, **more)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: dx.over_Y([0.2], [5.0]), "the number of positions is 1, expected at least two"),
        (lambda: dx.over_Y([[0.2, 5], [0.3, 6]]), r"desaxe\.over_Y\(\*zip\(\*rows\)\)"),
        (lambda: dx.over_stroke(np.ones((3, 2)), dead_centre="outer"), r"desaxe\.over_stroke\(\*zip"),
        (lambda: dx.over_theta([(0, 1), (1, 2)]), r"desaxe\.over_theta\(\*zip"),
        (lambda: dx.over_Y([0.2, 0.3]), "outward is missing: the load at each of the positions"),
        (lambda: dx.over_Y(["0,2 m", "0,3 m"], [1, 2]), "a decimal point is a point, not a comma"),
        (lambda: from_outer([0.0, 0.1], dead_centre="upper"), "= 'upper': it is one of outer, inner"),
        (lambda: from_outer([-0.1, 0.1]), "over_stroke: the distance -0.1 m is below 0"),
        (lambda: from_outer([0.0, 0.1, 0.1, 0.1]), "over_stroke: .* given three times"),
        (lambda: from_outer([0.0, 0.1, 0.1], kind="step"), "over_stroke: .* but 0.1 follows 0.1: a jump"),
        (lambda: from_outer([0.0, 0.1, 0.05]), "must ascend or descend, but 0.05 follows 0.1"),
        (
            lambda: from_outer([0, 1], dead_centre=None),
            "^over_stroke: dead_centre is missing: dead_c",
        ),
    ],
)
def test_other_tables_are_refused_with_the_remedy(make, message):
    with pytest.raises((TypeError, ValueError), match=message):
        make()


def from_outer(distances, kind="linear", dead_centre="outer"):
    return dx.over_stroke(distances, [1.0] * len(distances), kind=kind, dead_centre=dead_centre)


def test_a_wide_gap_under_a_spline_is_warned_of():
    with pytest.warns(dx.LoadWarning, match="a gap of"):
        dx.over_theta(np.linspace(0.0, 1.0, 11), np.ones(11))
    dx.over_theta(np.linspace(0.0, 1.0, 11), np.ones(11), kind="linear")


def test_files(tmp_path):
    path = tmp_path / "press.csv"
    path.write_text("angle; force; note\n# a remark\n0;0;x\n90;-400;y\n\n180;-50;z\n360;0;w\n", "utf-8")
    load = dx.over_theta.read(path, theta="deg", value="N", kind="linear")
    assert load == dx.over_theta(["0 deg", "90 deg", "180 deg"], ["0 N", "-400 N", "-50 N"], kind="linear")
    path.write_text("Y out in\n10 1 2\n20 3 4\n", "utf-8")
    assert dx.over_Y.read(path, Y="mm", value="N") == dx.over_Y(["10 mm", "20 mm"], ["1 N", "3 N"], [2, 4])
    path.write_text("0, 1\n1, one\n", "utf-8")
    with pytest.raises(
        ValueError, match=r"press.csv, line 2, column 2 \(value\): 'one' is not a finite number"
    ):
        dx.over_theta.read(path)
    path.write_text("0, 1\n9, 2\n", "utf-8")
    with pytest.raises(ValueError, match=r"press.csv: over_theta: the angles go over 9 rad"):
        dx.over_theta.read(path)
    with pytest.raises(OSError, match="nowhere"):
        dx.over_theta.read(tmp_path / "nowhere.csv")


ODD = ["1_0", "\u0661", "\uff11", "1,5,2", "0x1", "1e", "1__0", "\u00b2"]


@pytest.mark.parametrize("odd", ODD)
def test_what_python_alone_reads_as_a_number_is_refused(odd, tmp_path):
    """In every column, with and without a unit, and in lists."""
    path = tmp_path / "press.csv"
    for row in (f"{odd};-400;3", f"90;{odd};3", f"90;-400;{odd}"):
        path.write_text(f"0;1;2\n{row}\n120;2;4\n", encoding="utf-8")
        for units in ({"Y": "mm"}, {"Y": "mm", "value": "kN"}):
            with pytest.raises(
                (ValueError, TypeError), match=r"line 2, column [123] .* is not a finite number"
            ):
                dx.over_Y.read(path, **units)
        if not row.endswith(odd):  # it has two columns
            with pytest.raises(
                ValueError, match=r"press\.csv, line 2, column [12] .* is not a finite number"
            ):
                dx.over_theta.read(path, theta="deg")
    with pytest.raises((ValueError, TypeError)):
        dx.over_theta([0.0, odd, 3.0], [1.0, 2.0, 3.0], kind="linear")
    with pytest.raises((ValueError, TypeError)):
        dx.over_Y([0.1, 0.2, 0.3], ["1", odd, "3"])


def test_points_that_are_too_close_are_named():
    for close in (1e-300, 5e-324):
        with pytest.raises(ValueError, match=rf"over_theta: 0.0 and {close} are too close"):
            dx.over_theta([0.0, close, 2.0, 4.0], [1.0, 2.0, 3.0, 4.0])
    for load in (dx.over_theta, dx.over_Y):
        with pytest.raises(ValueError, match=r"over_\w+: 0.0 and 5e-324 are too close"):
            load([0.0, 5e-324, 2.0, 4.0], [1.0, 2.0, 3.0, 4.0], kind="linear")
        with pytest.raises(ValueError, match=r"over_\w+: 1.0 and 2.0 are too close"):
            load([0.0, 1.0, 2.0, 4.0], [1.0, 1.7e308, -1.7e308, 1.0], kind="linear")
        assert load([0.0, 1e-300, 2.0, 4.0], [1.0, 2.0, 3.0, 4.0], kind="linear")(1e-300) == 2.0


@pytest.mark.parametrize(
    "columns",
    [
        b"012",
        bytearray(b"012"),
        memoryview(b"012"),
        {0.0, 1.0, 2.0},
        "012",
        frozenset((0.0, 1.0, 2.0)),
        {0.0: 1, 1.0: 2, 2.0: 3},
        [b"0", b"1", b"2"],
    ],
)
def test_what_has_no_order_or_no_numbers_is_no_column(columns):
    good = [0.0, 1.0, 2.0]
    for make in (
        lambda: dx.over_theta(columns, good, kind="linear"),
        lambda: dx.over_theta(good, columns, kind="linear"),
        lambda: dx.over_theta(abs, nodes=columns),
        lambda: dx.over_Y(columns, good),
        lambda: dx.over_Y(good, columns),
        lambda: dx.over_Y(good, good, columns),
    ):
        with pytest.raises(TypeError, match="number"):
            make()


def test_a_heading_gives_the_units_of_a_file(tmp_path):
    file = tmp_path / "press.csv"
    file.write_text("Y [mm], F_Y [kN]\n225, 0\n250, -0.1\n475, -2\n", encoding="utf-8")
    expected = dx.over_Y(["225 mm", "250 mm", "475 mm"], ["0 N", "-100 N", "-2000 N"])
    assert dx.over_Y.read(file) == dx.over_Y.read(file, Y="mm", value="kN") == expected
    with pytest.raises(ValueError, match=r"Y = 'm', but its heading is 'Y \[mm\]'"):
        dx.over_Y.read(file, Y="m")
    file.write_text("theta [deg]; F_Y\n0; 0\n90; -500\n180; 0\n", encoding="utf-8")
    assert dx.over_theta.read(file) == dx.over_theta(["0 deg", "90 deg", "180 deg"], [0, -500, 0])


def test_positions_that_are_almost_surely_millimetres():
    with pytest.warns(dx.UnitWarning, match='write Y = "475 mm"'):
        dx.over_Y([225, 475], [0, -1])
