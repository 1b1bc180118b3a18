"""Pictures: labels from the dataset, gaps where infeasible, no pyplot."""

import matplotlib.figure
import numpy as np
import pytest
from matplotlib.colors import to_hex

import desaxe as dx
from desaxe.plot import curves, polar, save

THETA = np.linspace(0, 2 * np.pi, 181)
MACHINE = {"AB": 0.125, "BC": 0.35, "omega0": 157.08}


def family(ecs, names=("a_C",)):
    return dx.grid(list(names), ec=np.asarray(ecs), theta=THETA, **MACHINE)


def texts(legend):
    return [text.get_text() for text in legend.get_texts()]


def test_family():
    dataset = family([0, 0.05, 0.15])
    lines = curves(dataset, "a_C", over="theta", family="ec")
    axes = lines[0].axes
    assert len(lines) == 3
    assert axes.get_xlabel() == "crank angle, theta [deg]"
    assert axes.get_ylabel() == "acceleration of the slider, a_C [m/s$^{2}$]"
    assert axes.get_legend().get_title().get_text() == "ec [m]"
    assert texts(axes.get_legend()) == ["0", "0.05", "0.15"]
    assert len({to_hex(line.get_color()) for line in lines}) == 3
    np.testing.assert_allclose(lines[1].get_xdata(), np.degrees(THETA))
    np.testing.assert_array_equal(lines[1].get_ydata(), dataset.a_C.values[1])
    assert axes.get_xlim() == pytest.approx((0, 360))
    assert set(np.diff(axes.get_xticks())) == {45.0}


def test_family_is_the_other_dimension():
    dataset = family([0, 0.05]).transpose("theta", "ec")
    assert [len(line.get_ydata()) for line in curves(dataset, "a_C")] == [181, 181]
    over_ec = curves(dataset.isel(theta=[0, 45, 90]), "a_C", over="ec")
    assert over_ec[0].axes.get_xlabel().endswith(", ec [m]")
    assert texts(over_ec[0].axes.get_legend()) == ["0", "90", "180"]
    assert over_ec[0].axes.get_legend().get_title().get_text() == "theta [deg]"


def test_single_curve_has_no_legend():
    dataset = dx.grid(["phi"], ec=0.05, theta=THETA, **MACHINE)
    (line,) = dx.plot.curves(dataset, "phi")
    assert line.axes.get_legend() is None
    assert line.axes.get_ylabel() == "angle of the rod to the slider axis, phi [rad]"


def test_given_axes_are_drawn_on():
    axes = matplotlib.figure.Figure().add_subplot()
    lines = curves(family([0, 0.1]), "a_C", ax=axes)
    assert lines == list(axes.lines)


def test_infeasible_points_are_gaps_and_do_not_squash_the_rest():
    dataset = family([0.0, 0.2, 0.23])
    lines = curves(dataset, "a_C")
    assert np.isnan(lines[2].get_ydata()).any()
    assert not np.isnan(lines[1].get_ydata()).any()
    low, high = lines[0].axes.get_ylim()
    whole = dataset.a_C.sel(ec=0.2)
    assert float(whole.max()) < high < 2 * float(whole.max())
    assert 2 * float(whole.min()) < low < float(whole.min())
    assert np.nanmin(lines[2].get_ydata()) < low


def test_nothing_feasible_still_draws():
    lines = curves(family([1.0, 2.0]), "a_C")
    assert np.isnan(lines[0].get_ydata()).all()
    lines[0].figure.canvas.draw()


def test_many_curves_get_a_colour_bar(tmp_path):
    lines = curves(family(np.linspace(0, 0.2, 21)), "a_C")
    axes = lines[0].axes
    assert axes.get_legend() is None
    labels = [other.get_ylabel() for other in axes.figure.axes if other is not axes]
    assert labels == ["ec [m]"]
    save(axes.figure, tmp_path / "many.png")


PRESS = {"AB": 0.04, "BC": 0.064, "omega0": 251.0, "m_rod": 0.5, "m_slider": 0.8, "theta": THETA}


def test_torques():
    dataset = dx.grid(["T_in", "M_eff"], ec=[0, 0.01, 0.02], **PRESS)
    lines = curves(dataset, "T_in")
    assert lines[0].axes.get_ylabel() == "torque that the drive applies to the crank, T_in [N m]"
    np.testing.assert_array_equal(lines[2].get_ydata(), dataset.T_in.values[2])
    assert curves(dataset, "M_eff")[0].axes.get_ylabel().endswith("M_eff [kg m$^{2}$]")


def test_over_a_mass_and_a_long_label():
    dataset = dx.grid("F_shaking_X", ec=0.01, m_crank=[0.0, 0.1, 0.2], **{**PRESS, "theta": 1.0})
    (line,) = curves(dataset, "F_shaking_X", over="m_crank")
    assert line.axes.get_xlabel() == "mass of the crank, m_crank [kg]"
    assert line.axes.get_ylabel() == "force of the mechanism on the frame along X,\nF_shaking_X [N]"


def test_a_derivative_by_the_speed_of_a_state_under_a_step():
    """It is that of the inertia, which knows no step: (T_in(2 w) - T_in(w)) / 3 is w^2 times a constant."""
    press = {**PRESS, "ec": 0.01, "alpha": 0.0, "F_Y": dx.over_theta([0.0, 1.0], [-100.0, -3000.0], "step")}
    del press["omega0"]
    (line,) = curves(dx.grid("T_in_wrt_omega", omega=30.0, **press), "T_in_wrt_omega")
    theta, values = np.radians(line.get_xdata()), line.get_ydata()
    slow, fast = (dx.evaluate("T_in", omega=w, **{**press, "theta": theta, "F_Y": 0.0}) for w in (30.0, 60.0))
    assert theta.size > THETA.size
    np.testing.assert_allclose(values, 2.0 * (fast - slow) / 3.0 / 30.0, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("draw", [curves, polar])
def test_friction_that_jams_does_not_squash_the_rest(draw):
    jammed = dx.grid("T_in", ec=0.02, mu=[1.0, 1.5], **{**PRESS, "theta": np.linspace(0, 2 * np.pi, 20_001)})
    assert float(jammed.T_in.max()) > 1e5
    lines = draw(jammed, "T_in")
    low, high = lines[0].axes.get_ylim()
    assert np.isnan(lines[0].get_ydata()).any()
    assert -1000 < low < float(jammed.T_in.quantile(0.05, skipna=True))
    assert float(jammed.T_in.quantile(0.8, skipna=True)) < high < 2000


def test_polar():
    dataset = dx.grid("T_in", ec=[0, 0.01, 0.02], **PRESS)
    lines = polar(dataset, "T_in", family="ec")
    axes = lines[0].axes
    np.testing.assert_array_equal(lines[1].get_xdata(), THETA)
    np.testing.assert_array_equal(lines[1].get_ydata(), dataset.T_in.values[1])
    assert texts(axes.get_legend()) == ["0", "0.01", "0.02"]
    assert axes.get_xlabel().split("\n") == [
        "torque that the drive applies to the crank, T_in [N m]",
        "over the crank angle, theta [deg]",
    ]
    circle = axes.lines[-1]
    assert set(circle.get_ydata()) == {0.0}
    low, high = axes.get_ylim()
    assert low < float(dataset.T_in.min())
    assert high > float(dataset.T_in.max())


def test_polar_turns_like_the_crank():
    """At theta = 0 the crank is up, at 90 deg at the right."""
    axes = polar(dx.grid("T_in", ec=0.01, **PRESS), "T_in")[0].axes
    assert axes.get_legend() is None
    up, right = (axes.transData.transform((angle, 0.0)) for angle in (0.0, np.pi / 2))
    centre = axes.transAxes.transform((0.5, 0.5))
    assert up[0] == pytest.approx(centre[0])
    assert up[1] > centre[1]
    assert right[0] > centre[0]
    assert right[1] == pytest.approx(centre[1])


@pytest.mark.parametrize("turn", [0.0, np.pi / 4.0, np.pi])
def test_the_numbers_of_a_polar_axis_lie_beside_the_curves(turn):
    """Two lobes, a half turn apart: the numbers are not there."""
    dataset = dx.grid("T_in", ec=0.01, **PRESS)
    dataset["T_in"][:] = np.abs(np.cos(THETA - turn)) ** 8 + 0.01
    angle = np.radians(polar(dataset, "T_in").axes.get_rlabel_position())
    assert np.abs(np.cos(angle - turn)) < 0.75


def test_polar_of_a_joint_force():
    dataset = dx.grid(["F_B_X", "F_B_Y"], ec=0.01, **PRESS)
    (line,) = polar(dataset, ("F_B_X", "F_B_Y"))
    np.testing.assert_allclose(line.get_ydata(), np.hypot(dataset.F_B_X, dataset.F_B_Y))
    assert line.axes.get_xlabel().startswith("magnitude of the force of the crank on the rod, F_B [N]\n")
    assert line.axes.get_ylim()[0] == 0.0
    assert list(line.axes.lines) == [line]


def test_polar_on_given_axes():
    figure = matplotlib.figure.Figure()
    dataset = dx.grid("T_in", ec=[0, 0.01], **PRESS)
    axes = figure.add_subplot(projection="polar")
    assert polar(dataset, "T_in", ax=axes) == list(axes.lines)[:2]
    with pytest.raises(ValueError, match="expected polar Axes"):
        polar(dataset, "T_in", ax=figure.add_subplot())
    with pytest.raises(ValueError, match="two components of a vector, got 1"):
        polar(dataset, ("T_in",))
    with pytest.raises(ValueError, match="T_in and V_C are not components of one vector"):
        polar(dx.grid(["T_in", "V_C"], ec=0.0, **PRESS), ("T_in", "V_C"))
    with pytest.raises(ValueError, match="T_in has no dimension 'theta', it has: ec"):
        polar(dataset.isel(theta=0), "T_in")


@pytest.mark.parametrize("draw", [curves, polar])
def test_nothing_but_gaps_or_nought(draw, tmp_path):
    for ec, m_slider in ((0.15, 0.8), (0.0, 0.0)):
        dataset = dx.grid("T_in", ec=ec, **{**PRESS, "m_slider": m_slider, "m_rod": 0.0})
        save(draw(dataset, "T_in")[0].figure, tmp_path / "empty.png")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"name": "V_C"}, "no 'V_C' in this dataset, it has: a_C, status, margin"),
        ({"name": "a_C", "over": "BC"}, "a_C has no dimension 'BC', it has: ec, theta"),
        ({"name": "a_C", "family": "AB"}, "a_C has no dimension 'AB'"),
        ({"name": "a_C", "family": "theta"}, "another dimension than over"),
        ({"name": "margin"}, "margin has no dimension 'theta', it has: ec"),
    ],
)
def test_complaints(options, words):
    with pytest.raises(ValueError, match=words):
        curves(family([0, 0.1]), **options)


def test_dimensions_left_over():
    dataset = dx.grid(["a_C"], ec=[0, 0.1], AB=[0.1, 0.12], BC=0.35, omega0=1, theta=THETA)
    with pytest.raises(
        ValueError, match=r"a_C varies with AB too: choose a value first, dataset\.sel\(AB=\.\.\.\)"
    ):
        curves(dataset, "a_C", family="ec")
    assert len(curves(dataset.sel(AB=0.12), "a_C")) == 2


@pytest.mark.parametrize("kind", ["png", "svg", "pdf"])
def test_save(kind, tmp_path):
    figure = curves(family([0, 0.1]), "a_C")[0].figure
    path = save(figure, tmp_path / "new" / f"picture.{kind}")
    assert path.stat().st_size > 1000
    assert [other.name for other in path.parent.iterdir()] == [path.name]


def test_unknown_kind_of_file_leaves_nothing(tmp_path):
    figure = curves(family([0, 0.1]), "a_C")[0].figure
    with pytest.raises(ValueError, match="xyz"):
        save(figure, tmp_path / "picture.xyz")
    assert not list(tmp_path.iterdir())


# ---- dicts, gaps, titles -------------------------------------------------------------------------


def test_curves_of_what_evaluate_gives():
    theta = np.linspace(0, 2 * np.pi, 91)
    result = dx.evaluate(["V_C", "a_C", "status"], theta=theta, ec=0.15, AB=0.125, BC=0.35, omega0=157.08)
    (line,) = dx.plot.curves(result, "a_C")
    np.testing.assert_array_equal(line.get_ydata(), result["a_C"])
    np.testing.assert_allclose(line.get_xdata(), np.degrees(theta))
    assert "ec = 0.15" in line.axes.get_title(loc="left").replace("\u00a0", " ")
    (again,) = dx.plot.curves(dict(result), "a_C", theta=theta)
    np.testing.assert_array_equal(again.get_ydata(), result["a_C"])
    with pytest.raises(TypeError, match="a dict does not say theta: give it"):
        dx.plot.curves(dict(result), "a_C")
    with pytest.raises(ValueError, match="theta: it varies along one axis of arrays"):
        dx.plot.curves(dict(result), "a_C", theta=theta[1:])


def test_a_broadcast_is_a_family():
    theta, ec = np.linspace(0, 2 * np.pi, 31), np.array([0.0, 0.1, 0.2])
    result = dx.evaluate(["V_C"], theta=theta[:, None], ec=ec, AB=0.125, BC=0.35, omega0=157.08)
    lines = dx.plot.curves(result, "V_C")
    assert len(lines) == 3
    np.testing.assert_array_equal(lines[2].get_ydata(), result["V_C"][:, 2])


def test_gaps_are_marked():
    theta = np.linspace(0, 2 * np.pi, 721)
    machine = {"AB": 0.125, "BC": 0.35, "omega0": 157.08}
    (alone,) = dx.plot.curves(dx.grid("a_C", theta=theta, ec=0.24, **machine), "a_C")
    (gap,) = alone.axes.patches
    low, high = gap.get_x(), gap.get_x() + gap.get_width()
    ((last, first),) = [np.degrees((1.0758, 2.0658))]
    assert (low, high) == (pytest.approx(last, abs=0.6), pytest.approx(first, abs=0.6))
    lines = dx.plot.curves(dx.grid("a_C", theta=theta, ec=[0.0, 0.24], **machine), "a_C")
    assert not lines[0].axes.patches
    (mark,) = (line for line in lines[0].axes.lines if line not in lines)
    assert mark.get_color() == lines[1].get_color()
    assert tuple(mark.get_xdata()) == (low, high)


def test_panels_of_derivatives_say_which():
    grid = dx.grid(["Y_wrt_theta", "Y_wrt_theta_theta"], theta=[0.0, 1.0, 2.0], ec=0.1, AB=0.125, BC=0.35)
    titles = [lines[0].axes.get_title(loc="left") for lines in dx.plot.panels(grid).values()]
    assert titles == ["derivative of Y with respect to theta", "derivative of Y with respect to theta, theta"]


def test_a_title_does_not_break_inside_of_a_word():
    load = dx.over_stroke([0.0, 0.008, 0.02], [-8e4, -8e4, 0.0], inward=[0.0, 0.0, 1.0], dead_centre="outer")
    inputs = {"ec": 0.0, "AB": 0.075, "BC": 0.3, "omega0": 1.0, "m_slider": 1.0}
    grid = dx.grid("T_in", theta=[0.0, 1.0, 2.0], F_Y=load, **inputs)
    title = dx.plot.curves(grid, "T_in")[0].axes.get_title(loc="left").replace("\u00a0", " ")
    assert "F_Y over the distance from the outer dead centre, -80000 to 0, inward 0 to 1 N" in " ".join(
        title.split()
    )
