"""Loads as they are called, shown and drawn: in the units of the machine that made them, the curve itself."""

import re

import numpy as np
import pandas as pd
import pytest

import desaxe as dx

PRESS = dx.Machine(ec=15, AB=75, BC=300, omega0=60, m_slider=120, units="mm, deg, rpm, kN")
PUMP = PRESS.replace(units="mm, deg, rpm")
DIE = PRESS.over_Y([200, 366, 380], outward=[0, -80, -80], inward=[0, 10, 0], kind="step")
SPLINE = PRESS.over_theta([0, 90, 180, 270], [0, -4, -0.5, 0])


def test_a_load_of_a_machine_is_called_in_its_units():
    assert (DIE(370), DIE(370, -1), DIE(100)) == (-80.0, 10.0, 0.0)
    np.testing.assert_array_equal(DIE([370, 300]), [-80.0, 0.0])
    assert SPLINE(90) == pytest.approx(-4.0, rel=1e-15)
    near = PRESS.over_stroke([0, 8], [-80, 0], dead_centre="outer")
    assert near(2) == pytest.approx(-60.0)
    assert PRESS.over_theta(lambda degrees: 0.1 * degrees)(90.0) == pytest.approx(9.0)
    assert dx.over_Y([0.2, 0.4], [0.0, -80e3])(0.3) == pytest.approx(-40e3)


@pytest.mark.parametrize("mu", [0.0, 0.1], ids=["energy", "panels"])
def test_it_is_the_same_load_in_every_call(mu):
    torque = PRESS.over_theta([0, 180], ["9 kN m", "8 kN m"])
    plain = dx.over_theta(["0 deg", "180 deg"], ["9 kN m", "8 kN m"])
    die = dx.over_Y(["200 mm", "380 mm"], ["0 kN", "-80 kN"])
    design = {"AB": 0.075, "BC": 0.3, "ec": 0.015, "I_crank": 2.0, "t_end": 0.1, "times": [0.0, 0.1]}
    own, other = (
        dx.simulate(torque=push, F_Y=load, mu=mu, **design)["theta"][-1]
        for push, load in ((torque, PRESS.over_Y([200, 380], [0, -80])), (plain, die))
    )
    assert own == other
    where = {"theta": np.linspace(0, 6, 9), "AB": 0.075, "BC": 0.3, "ec": 0.015, "omega0": 1.0}
    np.testing.assert_allclose(
        dx.evaluate("T_in", F_Y=SPLINE, **where),
        dx.evaluate("T_in", F_Y=1e3 * SPLINE(np.degrees(where["theta"])), **where),
        rtol=1e-12,
    )


def test_the_range_of_a_load_is_that_of_its_curve():
    low, high = (float(f(SPLINE(np.linspace(0, 360, 100_001)))) for f in (np.min, np.max))
    assert repr(SPLINE) == f"<load over theta: 4 points, cubic, {low:g} to {high:g} kN (points -4 to 0)>"
    assert repr(DIE) == "<load over Y: 3 points, step, -80 to 0 kN, inward 0 to 10 kN>"
    assert f"F_Y         over theta, {low:.4g} to {high:.4g} kN  force" in repr(PRESS.replace(F_Y=SPLINE))
    assert "F_Y         over Y, -80 to 10 kN  force" in repr(PRESS.replace(F_Y=DIE))


@pytest.mark.parametrize(
    ("load", "page"),
    [
        (PUMP.over_Y([200, 380], ["1 bar", "9 bar"], bore=30, ambient="1 bar"), False),
        (-1 * PUMP.over_Y([200, 380], [0, 4]), True),
        (PUMP.over_theta([0, 90, 180], [-0.0, -4, -1], kind="linear"), False),
    ],
    ids=["pressure", "multiple", "written"],
)
def test_a_zero_has_no_sign(load, page, tmp_path):
    press = PUMP.replace(F_Y=load)
    texts = [press.to_scene(tmp_path / "press.toml", outputs="Y").read_text(encoding="utf-8")]
    if page:
        texts.append(press.report(tmp_path / "press.md", outputs="Y").read_text(encoding="utf-8"))
    for text in (repr(load), repr(press), *texts):
        assert not re.search(r"-0(\.0)?(?![\d.])", text.replace("1e-0", ""))
    assert dx.Machine.read(tmp_path / "press.toml")["F_Y"] == load


def test_a_load_is_drawn_as_it_is_computed_with():
    drawn = dx.plot.load(DIE)
    assert list(drawn.artists) == ["outward", "inward", "points"]
    for name, way in (("outward", 1), ("inward", -1)):
        np.testing.assert_array_equal(drawn[name].get_ydata(), DIE(drawn[name].get_xdata(), way))
    assert (drawn.axes.get_xlabel(), drawn.axes.get_ylabel()) == ("Y [mm]", "load [kN]")
    assert PRESS.replace(units="m").plot.load(DIE).axes.get_ylabel() == "load [N]"
    turn = PRESS.replace(F_Y=SPLINE).plot.load()
    assert turn["load"].get_ydata().min() == pytest.approx(-4.0043, rel=1e-5)
    assert turn.axes.get_xlim() == (0.0, 360.0)
    assert list(turn["points"].get_xdata()) == [0.0, 90.0, 180.0, 270.0]
    assert list(dx.plot.load(dx.over_theta(np.sin)).artists) == ["load"]
    with pytest.raises(TypeError, match="F_Y is a number"):
        PRESS.replace(F_Y=3).plot.load()


def test_a_series_alone_gives_places_and_values():
    series = pd.Series([1.0, 2.0, 3.0], index=[0.2, 0.3, 0.4])
    assert dx.over_Y(series) == dx.over_Y([0.2, 0.3, 0.4], [1.0, 2.0, 3.0])
    assert dx.over_theta(series, kind="step") == dx.over_theta([0.2, 0.3, 0.4], [1.0, 2.0, 3.0], kind="step")


@pytest.mark.parametrize(
    "load", [DIE, SPLINE, PRESS.over_stroke([0, 8, 8], [-80, -80, 0], dead_centre="outer")]
)
def test_a_scene_has_the_points_of_a_load_in_the_units_of_the_machine(load, tmp_path):
    path = PRESS.replace(F_Y=load).to_scene(tmp_path / "press.toml")
    written = path.read_text()
    assert 'value = "kN"' in written
    assert 'theta = "deg"' in written or ' = "mm"' in written.partition("[loads]")[2]
    assert "-4.0]" in written or "-80.0" in written
    assert dx.Machine.read(path)["F_Y"] == load


def test_points_that_have_no_double_in_the_unit_stay_in_si_units(tmp_path):
    load = PRESS.over_Y([200 + k / 7 for k in range(40)], [k / 3 for k in range(40)])
    path = PRESS.replace(F_Y=load).to_scene(tmp_path / "press.toml")
    assert dx.Machine.read(path)["F_Y"] == load
    assert (tmp_path / "press_F_Y.csv").exists()
