"""Loads in the units of a machine, and loads of plain numbers that meet other units."""

import warnings

import numpy as np
import pytest

import desaxe as dx
from desaxe.scenes.schema import SceneError
from tests.effort import cases

UNITS = "mm, deg, rpm, kN"
PRESS = dx.Machine(ec=15, AB=75, BC=300, omega0=60, m_slider=120, mu=0.08, units=UNITS)
SCENE = {
    "outputs": ["T_in"],
    "mechanism": {"ec": "15 mm", "AB": "75 mm", "BC": "300 mm"},
    "motion": {"theta": ["0 deg", "90 deg"], "omega0": "60 rpm"},
    "masses": {"m_slider": 120},
}
BOTH = r"F_Y: plain numbers of desaxe\.{0} .* give machine\.{0}\(\.\.\.\).*or desaxe\.{0}\(\.\.\.\) of texts"


@pytest.mark.sampled
def test_plain_numbers_of_a_machine_are_the_texts_in_its_units():
    rng = np.random.default_rng(4)
    for _ in range(cases(20, 300)):
        places = np.sort(rng.uniform(200.0, 380.0, 4)).round(3).tolist()
        forth, back = rng.uniform(-90.0, 5.0, (2, 4)).round(3).tolist()
        angles = np.sort(rng.uniform(0.0, 359.0, 4)).round(3).tolist()
        kind = rng.choice(["linear", "step"])
        of_Y = PRESS.over_Y(places, forth, back, kind=str(kind))
        of_theta = PRESS.over_theta(angles, forth, str(kind), 720)
        forth, back = ([f"{force!r} kN" for force in way] for way in (forth, back))
        assert of_Y == dx.over_Y([f"{place!r} mm" for place in places], forth, back, kind=str(kind))
        texts = [f"{angle!r} deg" for angle in angles]
        assert of_theta == dx.over_theta(texts, forth, str(kind), "720 deg")
        for load in (of_Y, of_theta):
            assert PRESS.replace(F_Y=load)["F_Y"] == load


def test_a_function_of_a_machine_is_in_its_units():
    """Degrees in, kilonewtons out, and its slope per degree; a bare function stays in SI units."""

    def force(angle):
        return -80.0 * np.sin(np.radians(angle)) ** 2

    def slope(angle):
        return -80.0 * np.sin(2.0 * np.radians(angle)) * np.pi / 180.0

    result = PRESS.over_theta(force, slope, nodes=[180])
    theta = np.linspace(0.0, 7.0, 29)
    value, by_theta = result.both(theta)
    np.testing.assert_allclose(value, -80e3 * np.sin(theta) ** 2, rtol=1e-13, atol=1e-9)
    np.testing.assert_allclose(by_theta, -80e3 * np.sin(2.0 * theta), rtol=1e-12, atol=1e-8)
    assert result.angles == (np.pi,)
    assert "the function force" in repr(result)


def test_files_of_a_machine(tmp_path):
    """Without units they are in those of the machine; what a heading or an argument says holds."""
    file = tmp_path / "press.csv"
    rows = "225, 0, 0\n250, -0.1, 0\n475, -2, 0.5\n"
    expected = dx.over_Y(
        ["225 mm", "250 mm", "475 mm"], ["0 N", "-100 N", "-2000 N"], ["0 N", "0 N", "500 N"]
    )
    file.write_text(rows, encoding="utf-8")
    assert PRESS.over_Y.read(file) == expected
    file.write_text(f"Y [mm], out [kN], in [kN]\n{rows}", encoding="utf-8")
    assert PRESS.over_Y.read(file) == dx.over_Y.read(file) == expected
    file.write_text("0, 0\n90, -0.5\n180, 0\n", encoding="utf-8")
    turned = dx.over_theta(["0 deg", "90 deg", "180 deg"], ["0 N", "-500 N", "0 N"], "linear")
    assert PRESS.over_theta.read(file, kind="linear") == turned
    newtons = dx.over_theta(["0 deg", "90 deg", "180 deg"], ["0 N", "-0.5 N", "0 N"], "linear")
    assert PRESS.over_theta.read(file, value="N", kind="linear") == newtons


PLAIN = {
    "positions": ("over_Y", dx.over_Y([0.2, 0.37], ["0 N", "-80 kN"])),
    "forces": ("over_Y", dx.over_Y(["200 mm", "370 mm"], outward=[-80, 0])),
    "forces inward": ("over_Y", dx.over_Y(["200 mm", "370 mm"], ["1 N", "2 N"], inward=[-80, 0])),
    "an array": ("over_Y", dx.over_Y(np.array([0.2, 0.37]), np.array([0.0, -80e3]))),
    "angles": ("over_theta", dx.over_theta([0.0, 1.0, 2.0], ["0 N", "1 kN", "0 N"], "linear")),
    "values": ("over_theta", dx.over_theta(["0 deg", "90 deg"], [0, -80], "linear")),
    "a period": ("over_theta", dx.over_theta(["0 deg", "90 deg"], ["0 N", "9 N"], "linear", 4 * np.pi)),
}
ENTRANCES = {
    "a machine": lambda load: dx.Machine(ec=15, AB=75, BC=300, omega0=60, F_Y=load, units=UNITS),
    "replace": lambda load: PRESS.replace(F_Y=load),
    "a method": lambda load: PRESS.peak("T_in", F_Y=load),
    "simulate": lambda load: PRESS.simulate(torque=1.0, t_end=0.1, F_Y=load),
    "a scene": lambda load: dx.scene({**SCENE, "units": UNITS, "loads": {"F_Y": load}}),
}


@pytest.mark.parametrize("entrance", ENTRANCES)
@pytest.mark.parametrize("what", PLAIN)
def test_plain_numbers_in_other_units_are_refused_with_both_ways(what, entrance):
    call, load = PLAIN[what]
    with pytest.raises(ValueError, match=BOTH.format(call)):
        ENTRANCES[entrance](load)


TOLD = {
    "texts": dx.over_Y(["200 mm", "370 mm"], ["0 N", "-80 kN"]),
    "texts and plain zeros": dx.over_Y(["200 mm", "370 mm"], [0, "-80 kN"], inward=[0, 0]),
    "the machine's": PRESS.over_Y([200, 370], [0, -80]),
    "angles": dx.over_theta(["0 deg", "90 deg"], ["0 N", "-80 kN"], "linear"),
    "a turn": dx.over_theta(["0 deg", "90 deg"], ["0 N", "-80 kN"], "linear", 2 * np.pi),
    "a function": dx.over_theta(np.sin, np.cos),
}


@pytest.mark.parametrize("entrance", ENTRANCES)
@pytest.mark.parametrize("what", TOLD)
def test_what_says_its_units_enters_everywhere(what, entrance):
    ENTRANCES[entrance](TOLD[what])


def test_units_that_are_those_of_the_machine_are_no_doubt():
    """Newtons in a machine in mm and degrees; and a load that a machine in SI units took stays what it is."""
    load = dx.over_theta(["0 deg", "90 deg"], [0, -500], "linear")
    assert dx.Machine(ec=15, AB=75, BC=300, F_Y=load, units="mm, deg")["F_Y"] == load
    plain = dx.over_Y([0.2, 0.37], [0, -80e3])
    si = dx.Machine(ec=0.015, AB=0.075, BC=0.3, omega0=6.0, F_Y=plain)
    millimetres = si.replace(units=UNITS)
    assert PRESS.replace(F_Y=si["F_Y"])["F_Y"] == millimetres["F_Y"] == plain
    assert millimetres.evaluate("T_in", theta=90) == pytest.approx(si.evaluate("T_in", theta=np.pi / 2))
    assert millimetres.scene("T_in").inputs["F_Y"] == plain


def test_a_file_of_a_scene_in_other_units_says_its_own(tmp_path):
    (tmp_path / "press.csv").write_text("225, 0\n475, -2\n", encoding="utf-8")
    file = str(tmp_path / "press.csv")
    said = r'^scene: loads\.F_Y\.over_Y = ".*press\.csv": .*, or by Y = "mm", value = "kN" '
    with pytest.raises(SceneError, match=said):
        dx.scene({**SCENE, "units": UNITS, "loads": {"F_Y": {"over_Y": file}}})
    message = dx.scene(
        {**SCENE, "units": UNITS, "loads": {"F_Y": {"over_Y": file, "Y": "mm", "value": "kN"}}}
    )
    assert message.inputs["F_Y"] == dx.over_Y(["225 mm", "475 mm"], ["0 kN", "-2 kN"])


@pytest.mark.parametrize("over", ["over_theta", "over_Y", "over_stroke"])
def test_the_units_that_are_proposed_for_a_file_serve(over, tmp_path):
    file, lines = tmp_path / "die.csv", "0.1, -4, 0\n2, -3, 0\n5, 0.5, 0\n"
    lines = lines.replace(", 0\n", "\n") if over == "over_theta" else lines  # every column has a heading
    load = {over: str(file), "kind": "linear"} | ({"dead_centre": "outer"} if over == "over_stroke" else {})
    scene = {**SCENE, "units": UNITS, "loads": {"F_Y": load}}
    file.write_text("place, force, back\n" + lines, encoding="utf-8")
    with pytest.raises(SceneError, match=r"die\.csv") as message:
        dx.scene(scene)
    assert str(message.value).startswith(f"scene: loads.F_Y.{over} = ")
    place = "deg" if over == "over_theta" else "mm"
    file.write_text(f"place [{place}], force [kN], back [kN]\n{lines}", encoding="utf-8")
    expected = dx.scene(scene).inputs["F_Y"]
    file.write_text("place, force, back\n" + lines, encoding="utf-8")
    keys = str(message.value).split(" or by ")[1].removesuffix(" beside the file").split(", ")
    load |= {key: unit.strip('"') for key, unit in (one.split(" = ") for one in keys)}
    assert dx.scene(scene).inputs["F_Y"] == expected


def test_a_load_in_the_units_of_nothing_names_its_input_once():
    load = dx.over_Y([0.2, 0.3], [-80, 0])
    with pytest.raises(SceneError, match=r"^scene: loads\.F_Y: plain numbers of desaxe\.over_Y"):
        dx.scene({**SCENE, "units": UNITS, "loads": {"F_Y": load}})


def test_the_period_of_a_table_is_in_the_unit_of_its_angles():
    table = {"over_theta": [[0, 0], [90, -500]], "theta": "deg", "period": 720, "kind": "linear"}
    load = dx.scene({**SCENE, "loads": {"F_Y": table}}).inputs["F_Y"]
    assert load.period == pytest.approx(4.0 * np.pi, rel=1e-15)


def test_a_load_says_the_ranges_of_both_ways():
    there_and_back = PRESS.over_Y([200, 300], [-80, 0], [0.0, 0.4], kind="linear")
    assert repr(there_and_back) == "<load over Y: 2 points, linear, -80 to 0 kN, inward 0 to 0.4 kN>"
    assert there_and_back.told() == "<load over Y: 2 points, linear, -80000 to 0 N, inward 0 to 400 N>"
    assert repr(dx.over_Y([0.2, 0.3], [-80, 0], kind="linear")) == "<load over Y: 2 points, linear, -80 to 0>"


@pytest.mark.parametrize("inward", [None, [0.0, 400.0]])
def test_titles_show_loads_in_the_units_of_the_machine(inward):
    load = dx.over_Y(["200 mm", "300 mm"], ["-80 kN", "-1e-3 kN"], inward and ["0 N", "400 N"], kind="linear")
    machine = PRESS.replace(F_Y=load, F_X=PRESS.over_theta([0, 180], [1e-3, 2e3], "step"))
    result = machine.grid("T_in", theta=np.linspace(0.0, 360.0, 5))
    ways = "-80 to -0.001 kN" + ("" if inward is None else ", inward 0 to 0.4 kN")
    assert f"F_Y: <load over Y: 2 points, linear, {ways}>" in result.attrs["loads"]
    assert "F_X: <load over theta: 2 points, step, 0.001 to 2000 kN>" in result.attrs["loads"]
    title = dx.plot.curves(result, "T_in")[0].axes.get_title(loc="left").replace("\u00a0", " ")
    assert f"F_Y over Y, {ways}" in " ".join(title.split())
    assert "F_X over theta, 0.001 to 2000 kN" in " ".join(title.split())
    assert " N" not in title


def test_an_offset_in_metres_on_a_machine_in_millimetres_is_told():
    with pytest.warns(dx.UnitWarning, match=r'ec = 0.015 mm, write ec = "0.015 m"'):
        dx.Machine(ec=0.015, AB=75, BC=300, omega0=60, units=UNITS)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for ec in (0, 1, -15, 0.1, "0.015 mm"):
            dx.Machine(ec=ec, AB=75, BC=300, omega0=60, units=UNITS)
        dx.Machine(ec=1.5e-5, AB=0.075, BC=0.3, omega0=60.0)
