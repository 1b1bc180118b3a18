"""The page in a real browser: figures of designs, units, loads, and what it gives away."""

import csv
import io
import math

import pytest

import desaxe as dx
from tests.example_scenes import FEEDER
from tests.scenes.explorer.page import (
    MINUS,
    NONE,
    design,
    figure,
    reading,
    saved,
    settle,
    verdict,
)


@pytest.mark.thorough
def test_turning_is_that_of_feasibility(visit, one_design):
    """0.35 - 0.125 - 0.225 is -2.8e-17 in doubles: so near its change point, yet it cannot turn fully."""
    page = visit(one_design)
    page.fill("#number-ec", "225")
    settle(page)
    assert not dx.feasibility(ec=0.225, AB=0.125, BC=0.35)["can_turn"]
    assert figure(page, "turns") == ["no"]
    assert "it cannot turn fully" in verdict(page)[1]


@pytest.mark.parametrize("branch", [1, -1])
def test_the_figures_of_a_design(branch, numbers_of, folder):
    inputs = {"AB": 0.125, "BC": 0.35, "omega0": 157.0, "branch": branch}
    page = numbers_of(dx.explore(path=folder / "figures.html", ec=[0.0, 0.1, -0.2], **inputs))
    for k, ec in enumerate((0.0, 0.1, -0.2)):
        result = page.evaluate(f"desaxe.turnOf(desaxe.state.designs[{k}])")
        expected = dx.events(ec=ec, AB=0.125, BC=0.35, branch=branch)
        assert result["stroke"] == pytest.approx(expected["stroke"], rel=1e-14)
        assert result["ratio"] == pytest.approx(expected["time_ratio"], rel=1e-13)
        assert result["pressure"] == pytest.approx(expected["max_pressure_angle"], rel=1e-13)
        for which in ("outer", "inner"):
            apart = (result[which] - expected[f"theta_{which}"] + math.pi) % (2 * math.pi) - math.pi
            assert abs(apart) < 1e-12
        top = "((d) => desaxe.peakOf('a_C', d, desaxe.curve('a_C', d)))"
        peak = page.evaluate(f"{top}(desaxe.state.designs[{k}])")
        exact = dx.peak("a_C", ec=ec, **inputs)
        assert abs(peak["value"]) == pytest.approx(exact["value"], rel=1e-12)
    assert figure(page, "stroke")[1] == f"{1e3 * dx.events(ec=0.1, AB=0.125, BC=0.35)['stroke']:.3f} mm"


@pytest.mark.thorough
def test_a_peak_without_bound_is_told(visit, several_designs):
    page = visit(several_designs)
    page.click("[data-take='2']")
    assert figure(page, "stroke")[0] == NONE
    assert figure(page, "peak-a_C")[0].split("\n") == ["no bound", "next to a limit angle"]


@pytest.mark.thorough
def test_tables_and_files_in_other_units(visit, several_designs):
    page = visit(several_designs)
    page.select_option("#units", "mm")
    theta, inputs = page.evaluate("desaxe.state.theta"), design(page)
    scale = {"Y": 1e3, "a_C": 1e3, "phi": 180 / math.pi, "omega_BC": 30 / math.pi, "a_C_wrt_ec": 1.0}
    for name, times in scale.items():
        expected = times * dx.evaluate(name, theta=theta, **inputs)
        assert reading(page, name)[0] == pytest.approx(expected, rel=1e-7)
    units = page.locator("#readings td.unit").all_inner_texts()
    assert units == ["mm/s²", "1/s²", "mm", "mm/s", "°", "rpm", "rad/s²"]
    rows = list(csv.reader(io.StringIO(page.evaluate("desaxe.valuesText()"))))
    assert rows[0][:3] == ["theta [deg]", "a_C [mm/s^2] (ec = 0 mm)", "a_C_wrt_ec [1/s^2] (ec = 0 mm)"]
    assert float(rows[-1][0]) == pytest.approx(360.0)
    assert float(rows[1][1]) == pytest.approx(1e3 * dx.evaluate("a_C", theta=0.0, **inputs), rel=1e-12)
    page.select_option("#units", "all")
    assert float(page.input_value("#number-AB")) == 0.125
    assert "m" in page.inner_text("#field-AB .unit")


@pytest.mark.thorough
def test_a_machine_brings_its_units(visit, folder):
    """Fields, values, tables and files in inches and standard gravities; the scene is the same machine."""
    units = {"length": "in", "angle": "deg", "a_C": "standard_gravity"}
    press = dx.Machine(ec=1, AB=2, BC=7.3, omega0="300 rpm", m_slider=3, F_Y=-50, units=units)
    page = visit(press.explore(path=folder / "inches.html"))
    page.select_option("#quantity-0", "a_C")
    page.select_option("#quantity-1", "a_C")
    page.select_option("#by-1", "a_C_wrt_ec")
    theta, inputs = page.evaluate("desaxe.state.theta"), design(page)
    assert inputs["BC"] == press["BC"] == 7.3 * 0.0254
    assert page.input_value("#number-BC") == "7.3"
    assert "4.3 in" in page.inner_text("#margin-words")
    assert page.inner_text("#loads-words") == f"m_slider = 3 kg, F_Y = {MINUS}50 N"
    si = {name: dx.evaluate(name, theta=theta, **inputs) for name in ("a_C", "a_C_wrt_ec", "Y", "omega_BC")}
    scale = {"a_C": 1 / 9.80665, "a_C_wrt_ec": 0.0254 / 9.80665, "Y": 1 / 0.0254, "omega_BC": 1.0}
    for name, times in scale.items():
        assert reading(page, name)[0] == pytest.approx(times * si[name], rel=1e-7)
    heads = next(csv.reader(io.StringIO(page.evaluate("desaxe.valuesText()"))))
    assert heads[1:3] == [f"{n} (this design)" for n in (
        "a_C [standard_gravity]", "a_C_wrt_ec [standard_gravity/in]"
    )]  # fmt: skip
    saved = folder / "inches.toml"
    saved.write_text(page.evaluate("desaxe.sceneText()"), encoding="utf-8")
    assert dx.Machine.read(saved) == press
    assert dx.scene(saved).run().dataset.a_C.units == "standard_gravity"


@pytest.mark.thorough
def test_loads_can_be_set(visit, folder):
    page = visit(
        dx.explore(path=folder / "loaded.html", ec=0.01, AB=0.04, BC=0.064, omega0=100.0, m_slider=1.0)
    )
    page.click("#more summary")
    page.fill("#number-F_Y", "-50")
    page.fill("#number-mu", "0.1")
    settle(page)
    given = design(page)
    assert (given["F_Y"], given["mu"], given["m_rod"]) == (-50.0, 0.1, 0.0)
    theta = page.evaluate("desaxe.state.theta")
    for name in ("T_in", "F_A_X", "M_shaking"):
        result = page.evaluate("([n, d, t]) => desaxe.valueAt(n, d, t)", [name, given, theta])
        assert result == pytest.approx(dx.evaluate(name, theta=theta, **given), rel=1e-12)


@pytest.mark.thorough
def test_the_scene_runs(visit, several_designs, tmp_path):
    page = visit(several_designs)
    download = saved(page, "#save-scene")
    assert download.suggested_filename == "scene.toml"
    download.save_as(tmp_path / "scene.toml")
    scene = dx.scene(tmp_path / "scene.toml")
    assert scene.inputs["ec"] == (0.0, 0.1, 0.23)
    assert scene.outputs == ("a_C", "a_C_wrt_ec")
    dataset = scene.run().dataset
    curve = page.evaluate("desaxe.valuesText()")
    rows = list(csv.reader(io.StringIO(curve)))
    column = [float(row[1]) for row in rows[1:]]
    assert column == pytest.approx(dataset["a_C"].isel(ec=0).values, rel=1e-11)


@pytest.mark.thorough
def test_the_scene_of_a_feeder_comes_back(visit, folder, tmp_path):
    page = visit(dx.explore(FEEDER, folder / "feeder.html"))
    saved(page, "#save-scene").save_as(tmp_path / "scene.toml")
    again, before = dx.scene(tmp_path / "scene.toml"), dx.scene(FEEDER)
    assert {n: v for n, v in again.inputs.items() if n not in ("theta", "alpha")} == {
        n: v for n, v in before.inputs.items() if n != "theta"
    }
    assert page.evaluate("desaxe.state.shown") == ["T_in", "N_C"]
    page.click("#more summary")
    page.fill("#number-m_slider", "2")
    settle(page)
    expected = dx.evaluate("T_in", theta=page.evaluate("desaxe.state.theta"), **design(page))
    assert reading(page, "T_in")[0] == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize("where", ["scene", "session"])
def test_the_saved_scene_has_the_quantities_of_the_user(where, numbers_of, folder, tmp_path):
    own = {"shoe": {"expression": "f * abs(N_C * V_C)", "unit": "W", "meaning": 'a "shoe"'}}
    own["both"] = {"expression": "shoe + power_in", "unit": "W"}
    machine = {"ec": 0.01, "AB": 0.125, "BC": 0.35, "omega0": 150.0, "m_slider": 0.8}
    if where == "scene":
        own["shoe"]["constants"] = {"f": 0.08}
        sections = {"mechanism": ("ec", "AB", "BC"), "motion": ("omega0",), "masses": ("m_slider",)}
        scene = {section: {n: machine[n] for n in names} for section, names in sections.items()}
        scene["motion"]["theta"] = [0.0, 6.0]
        path = dx.explore({**scene, "outputs": ["both"], "quantities": own}, folder / "of_scene.html")
    else:
        dx.define("shoe", **own["shoe"], f=0.08)
        dx.define("both", **own["both"])
        path = dx.explore(path=folder / "of_session.html", names=["both"], **machine)
        dx.undefine("both")
        dx.undefine("shoe")
    text = numbers_of(path).evaluate("desaxe.state.shown = ['both'], desaxe.sceneText()")
    (tmp_path / "saved.toml").write_text(text, encoding="utf-8")
    values = dx.scene(tmp_path / "saved.toml").run().dataset.both
    result = dx.evaluate(["N_C", "V_C", "power_in"], theta=values.theta.values, **machine)
    assert values.values == pytest.approx(
        0.08 * abs(result["N_C"] * result["V_C"]) + result["power_in"], rel=1e-12
    )


@pytest.mark.thorough
def test_the_table_of_values_has_every_digit(visit, several_designs, tmp_path):
    page = visit(several_designs)
    saved(page, "#save-csv").save_as(tmp_path / "values.csv")
    head, *rows = csv.reader(io.StringIO((tmp_path / "values.csv").read_text()))
    assert head[:3] == ["theta [rad]", "a_C [m/s^2] (ec = 0 mm)", "a_C_wrt_ec [1/s^2] (ec = 0 mm)"]
    assert len(rows) == 721
    for row in rows[::60]:
        for k in range(3):
            value = dx.evaluate("a_C", theta=float(row[0]), **design(page, k))
            text = row[1 + 3 * k]
            assert (text == "") == math.isnan(value)
            assert not text or float(text) == pytest.approx(value, rel=1e-12)


@pytest.mark.thorough
def test_the_picture_is_one(visit, several_designs, tmp_path):
    saved(visit(several_designs), "#save-png").save_as(tmp_path / "picture.png")
    data = (tmp_path / "picture.png").read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    width, height = (int.from_bytes(data[at : at + 4]) for at in (16, 20))
    assert width == 1800
    assert height > 1500
    assert len(data) > 50_000  # not an empty one
