"""The result of each plot; titles, room at jumps, and the tornado that a machine draws by itself."""

import numpy as np
import pytest
from matplotlib.figure import Figure

import desaxe as dx
from desaxe.plot import Picture

SIZES = {"ec": 10, "AB": 50, "BC": 200, "omega0": 300, "m_slider": 4}
PRESS = dx.Machine(SIZES, units="mm, deg, rpm")
STEP = PRESS.over_theta([0, 30, 180], [-3000, 0, 0], kind="step")  # jumps at 0 and at 30 deg
LOADED = PRESS.replace(F_Y=STEP)
MOTOR = dx.kloss("40 N m", 0.15, "1500 rpm", gear=5)
NARROW = "\u00a0"


def title(picture):
    axes = picture.axes[0] if isinstance(picture.axes, list) else picture.axes
    return (picture.figure.get_suptitle() or axes.get_title(loc="left")).replace(NARROW, " ")


DRAWN = {
    "curves": lambda plot, ax: plot("T_in", ax=ax),
    "panels": lambda plot, ax: plot(["T_in"], ax=ax),
    "polar": lambda plot, ax: plot.polar("T_in", ax=ax),
    "mechanism": lambda plot, ax: plot.mechanism(30, ax=ax),
    "tornado": lambda plot, ax: plot.tornado("T_in", ax=ax),
    "drive": lambda plot, ax: plot.drive(ax=ax),
    "steady": lambda plot, ax: plot.steady(torque=MOTOR, flywheel_inertia=2.0, ax=ax),
    "animate": lambda plot, ax: plot.animate(frames=2, ax=ax),
}


@pytest.mark.parametrize("name", DRAWN)
def test_each_plot_returns_a_picture(name, tmp_path):
    figure = Figure()
    ax = figure.add_subplot(projection="polar" if name == "polar" else None)
    picture = DRAWN[name](LOADED.plot, ax)
    assert isinstance(picture, Picture)
    assert picture.figure is figure
    assert picture.axes is ax or picture.axes == [ax]
    assert len(picture.artists) == len(picture) > 0
    path = picture.save(tmp_path / ("a.gif" if name == "animate" else "a.png"), dpi=30)
    assert path.stat().st_size > 500
    assert picture._repr_png_().startswith(b"\x89PNG")


def test_a_design_map_is_a_picture():
    ax = Figure().add_subplot()
    picture = PRESS.plot.design_map("stroke", ec=[0, 10, 20], BC=[150, 200], ax=ax)
    assert isinstance(picture, Picture)
    assert picture.axes is ax
    assert picture[0].levels is picture.levels


def test_a_picture_is_its_artists():
    one, several = PRESS.plot("a_C", ec=[0, 10]), PRESS.plot(["Y", "V_C"])
    first, second = one
    assert one == [first, second] == list(one.axes.lines)[:2]
    assert (one[0], len(one), first in one) == (first, 2, True)
    assert list(several) == ["Y", "V_C"] == list(several.keys())
    assert [ax.lines[0] for ax in several.axes] == [several["Y"][0], several["V_C"][0]]
    with pytest.raises(AttributeError, match="no_such_thing"):
        _ = one.no_such_thing
    with pytest.raises(ValueError, match="expected 2 Axes, one for each of Y, V_C; got 1"):
        PRESS.plot(["Y", "V_C"], ax=Figure().add_subplot())
    with pytest.raises(TypeError, match="names = 60: expected the name of a quantity"):
        PRESS.plot.polar(60)


def push(Y):
    return -3.0 * Y


def test_titles_tell_what_matters():
    forces = title(LOADED.plot("T_in"))
    for words in ("ec = 10 mm", "omega0 = 300 rpm", "m_slider = 4 kg"):
        assert words in forces
    assert "F_Y over theta, -3000 to 0 N" in forces
    assert "F_Y" not in title(LOADED.plot("a_C"))
    assert "m_slider" not in title(LOADED.plot("a_C"))
    both = dx.Machine(PRESS, F_Y=dx.spring("4 N/mm", free="0.12 m") + dx.damper("200 N s/m") + 5)
    words = "F_Y spring: stiffness = 4 N/mm, free = 120 mm + damper: linear = 0.2 N s/mm, quadratic = 0"
    for picture in (both.plot("T_in"), both.plot.drive()):
        assert f"{words} N s^2/mm^2 + 5 N" in title(picture).replace("\n", " ").replace("$^{2}$", "^2")
    assert title(PRESS.replace(F_Y=push).plot("T_in")).endswith("F_Y over Y: the function push")
    constant = dx.Machine(PRESS, F_Y="-2 kN", mu=0, branch=-1)
    assert "F_Y = -2000 N" in title(constant.plot("T_in"))
    assert "branch = -1" in title(constant.plot("Y"))
    assert "mu" not in title(constant.plot("N_C"))
    for picture in (LOADED.plot(["Y", "T_in"]), LOADED.plot.polar("T_in"), LOADED.plot.drive()):
        assert "F_Y over theta, -3000 to 0 N" in title(picture).replace("\n", " ")


def test_there_is_room_where_a_load_jumps_at_an_end():
    """Both sides of the jump at 0 are drawn at both ends, inside of the frame; a smooth one ends there."""
    picture = LOADED.plot("T_in")
    low, high = picture.axes.get_xlim()
    assert low < -1.0
    assert high > 361.0
    x, y = picture[0].get_data()
    ends = dx.evaluate("T_in", **{**LOADED, "F_Y": 0.0, "theta": 0.0}), y[0]
    assert min(y[x == 0.0]) == pytest.approx(min(ends), rel=1e-9)
    assert max(y[x == 0.0]) == pytest.approx(max(ends), rel=1e-9)
    assert PRESS.plot("T_in").axes.get_xlim() == (0.0, 360.0)
    inner = PRESS.replace(F_Y=PRESS.over_theta([0, 90, 180], [0, -500, 0], kind="step"))
    assert inner.plot("T_in").axes.get_xlim() == (0.0, 360.0)


def ends_of(picture):
    larger, _ = picture
    names = [text.get_text().partition(" ")[0] for text in picture.axes.get_yticklabels()]
    return {name: bar.get_width() for name, bar in zip(names, larger, strict=True)}


def test_a_tornado_without_changes_is_of_one_percent():
    picture = PRESS.plot.tornado("T_in")
    peak = PRESS.peak("T_in")
    shown = PRESS.in_units()
    expected = {p: 0.01 * shown[p] * slope for p, slope in peak["gradient"].items()}
    assert ends_of(picture) == {p: pytest.approx(v, rel=1e-9) for p, v in expected.items()}
    assert f"largest magnitude of T_in = {peak['value']:.6g} N m at theta = " in title(picture)
    assert "ec = 10 mm" in title(picture)
    centred = PRESS.replace(ec=0)
    assert "ec ± 0.5 mm" in [t.get_text() for t in centred.plot.tornado("T_in").axes.get_yticklabels()]


@pytest.mark.parametrize("rough", ["12 mm +- 0.2 mm", "12 +- 0.2", dx.plus_minus(12, 0.2)])
def test_a_tornado_takes_inputs_with_tolerances(rough):
    picture = PRESS.plot.tornado("T_in", ec=rough, m_slider=5)
    slope = PRESS.replace(ec=12, m_slider=5).peak("T_in")["gradient"]["ec"]
    assert ends_of(picture) == {"ec": pytest.approx(0.2 * slope, rel=1e-9)}
    assert "m_slider = 5 kg" in title(picture)


def test_a_tornado_at_an_angle_and_of_the_whole_design():
    at = LOADED.plot.tornado("T_in", {"ec": 0.5}, theta=60)
    slope = LOADED.evaluate("T_in_wrt_ec", theta=60)
    assert ends_of(at) == {"ec": pytest.approx(0.5 * slope, rel=1e-9)}
    assert "at theta = 60 deg" in title(at)
    whole = ends_of(PRESS.plot.tornado("stroke", {"AB": 1}))
    assert whole == {"AB": pytest.approx(PRESS.evaluate("stroke_wrt_AB"), rel=1e-9)}
    with pytest.raises(TypeError, match=r"changes: ec = \(9, 11\): half its range is a number"):
        PRESS.plot.tornado("T_in", {"ec": (9, 11)})
    with pytest.raises(TypeError, match="expected a dict input -> half its range"):
        dx.plot.tornado(PRESS.peak("T_in"), ["ec"])


def test_a_tornado_says_which_side_of_a_jump_it_is_on():
    peak = LOADED.peak("T_in")
    assert peak["side"] == -1
    assert "before a jump" in title(LOADED.plot.tornado("T_in"))


def test_titles_of_results_that_know_less():
    peak = dx.peak("a_C", ec=0.1, AB=0.125, BC=0.35, omega0=10.0)
    assert title(dx.plot.tornado(peak, {"ec": 1e-3}, name="a_C")).startswith("a_C = ")
    assert title(dx.plot.tornado(peak, {"ec": 1e-3}, title="by drawing 7")) == "by drawing 7"
    values = dx.evaluate(["T_in"], theta=np.linspace(0, 6, 7), **dx.Machine(LOADED))
    assert "F_Y over theta" in title(dx.plot.curves(values, "T_in"))


def test_a_drive_says_the_fluctuation_of_its_flywheel():
    title = LOADED.drive(fluctuation=0.1).plot().axes[1].get_title(loc="left")
    assert title.endswith("under a constant torque, fluctuation 10 %")
