"""One reader: an input is the same number, or refused in the same words, by whichever way it comes."""

import json
import math

import numpy as np
import pytest

import desaxe as dx
from desaxe.cli import main

pd, xr = pytest.importorskip("pandas"), pytest.importorskip("xarray")
pytest.importorskip("pint")
UNITS = "mm, deg, rpm, kN"
SIZES = {"AB": 0.04, "BC": 0.13}
IN_MM = {"AB": 40, "BC": 130, "units": UNITS}


def labelled(values, unit):
    return xr.DataArray(np.asarray(values, float), dims="k", attrs={"units": unit})


def series(values, unit):
    found = pd.Series(np.asarray(values, float))
    found.attrs["units"] = unit
    return found


# Forms of values in a unit; the last two alone say nothing of it and are in the caller's units.
FORMS = {
    "text": lambda values, unit: f"{values[0]} {unit}",
    "texts": lambda values, unit: [f"{value} {unit}" for value in values],
    "pint": lambda values, unit: dx.units.registry().Quantity(values[0], unit),
    "pint array": lambda values, unit: dx.units.registry().Quantity(np.array(values, float), unit),
    "DataArray": labelled,
    "Series with units": series,
    "numbers": lambda values, unit: list(values),
    "number": lambda values, unit: values[0],
    "NumPy's number": lambda values, unit: np.float64(values[0]),
    "array": lambda values, unit: np.array(values, float),
    "Series": lambda values, unit: pd.Series(np.array(values, float)),
}
PLAIN = ("numbers", "number", "NumPy's number", "array", "Series")


def position(theta, ec):
    """The slider's position from the loop closure."""
    return SIZES["AB"] * np.cos(theta) + np.sqrt(SIZES["BC"] ** 2 - (ec + SIZES["AB"] * np.sin(theta)) ** 2)


def of_machine(theta, ec):
    return dx.Machine(**IN_MM).evaluate("Y", theta=theta, ec=ec) * 1e-3


def of_its_function(theta, ec):
    return dx.Machine(**IN_MM).function("Y", inputs=("theta", "ec"))(theta, ec) * 1e-3


def of_evaluate(theta, ec):
    return dx.evaluate("Y", theta=theta, ec=ec, **SIZES)


# A front end: its call, the units of plain numbers.
FRONTS = {
    "evaluate": (of_evaluate, ("rad", "m")),
    "function": (dx.function("Y", ("theta", "ec"), **SIZES), ("rad", "m")),
    "Machine": (of_machine, ("deg", "mm")),
    "its function": (of_its_function, ("deg", "mm")),
}
VALUES = {"rad": [math.pi / 3, math.pi / 6], "deg": [60, 30], "m": [0.01, 0.0021], "mm": [10, 2.1]}


@pytest.mark.parametrize("front", FRONTS)
@pytest.mark.parametrize("form", FORMS)
def test_values_of_a_form_are_the_same_number_everywhere(front, form):
    call, units = FRONTS[front]
    own = units if form in PLAIN else ("deg", "mm")
    theta, ec = (FORMS[form](VALUES[unit], unit) for unit in own)
    expected = position(np.array(VALUES["rad"]), np.array(VALUES["m"]))
    found = np.asarray(call(theta, ec), float)
    assert found == pytest.approx(expected if found.ndim else expected[0], rel=1e-14)


@pytest.mark.parametrize("front", FRONTS)
@pytest.mark.parametrize("form", [form for form in FORMS if form not in PLAIN])
def test_another_kind_of_unit_is_refused_in_the_same_words(front, form):
    call, _ = FRONTS[front]
    ec = FORMS[form]([3, 4], "kg")
    with pytest.raises(ValueError, match=r"^ec (=|in) .*(kg|kilogram).*: it must be a quantity in m"):
        call(1.0, ec)


@pytest.mark.parametrize("form", FORMS)
def test_a_machine_and_a_scene_hold_the_same_numbers(form):
    ec = FORMS[form](VALUES["mm"], "mm")
    held = np.asarray(dx.Machine(**IN_MM, ec=ec)["ec"])
    assert held.tolist() == ([0.01, 0.0021] if held.ndim else 0.01)
    if "pint" in form or "units" in form or form == "DataArray":
        return  # a scene is data: numbers, texts and lists of these
    mechanism = {"ec": list(ec) if form == "Series" else ec, "AB": 40, "BC": 130}
    scene = dx.scene({"units": UNITS, "outputs": ["Y"], "mechanism": mechanism, "motion": {"theta": 60}})
    assert scene.inputs["ec"] == (tuple(held.tolist()) if held.ndim else held)
    assert scene.inputs["theta"] == 1.0471975511965979  # the double nearest to pi/3


@pytest.mark.parametrize("text", ["60 deg", "60deg", "1.0471975511965976", "0.16666666666666666 turn"])
def test_the_command_line_reads_the_same_numbers(text, capsys):
    assert main(["point", "Y", f"theta={text}", "ec=10mm", "AB=40 mm", "BC=0.13", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["Y"]["value"]
    assert found == dx.evaluate("Y", theta=text, ec=0.01, **SIZES)
    assert found == pytest.approx(position(math.pi / 3, 0.01), rel=1e-14)


@pytest.mark.parametrize("form", FORMS)
def test_a_load_and_a_motor_read_the_same_numbers(form):
    angles, speeds = ([0, 60, 120], [1500, 750])
    maker = dx.Machine(**IN_MM) if form in PLAIN else dx
    if form not in ("text", "pint", "number", "NumPy's number"):
        load = maker.over_theta(FORMS[form](angles, "deg"), [f"{k} kN" for k in range(3)], kind="linear")
        force = load(60.0) if form in PLAIN else 1e-3 * load(math.pi / 3)
        assert float(force) == pytest.approx(1.0, rel=1e-14)
    motor = maker.kloss("40 N m", 0.15, FORMS[form](speeds, "rpm"))
    expected = np.array(speeds) * math.pi / 30
    held = np.asarray(motor.synchronous_speed)
    assert held == pytest.approx(expected if held.ndim else expected[0], rel=1e-15)


def test_a_measure_at_a_plain_angle_is_in_the_callers_units():
    machine = dx.Machine(**IN_MM, ec=10, omega0=60)
    expected = 1e3 * position(math.pi / 3, 0.01)
    grid = machine.grid(["Y"], theta=[0, 60, 90], reduce=[("at", 60, "Y")])
    assert float(grid["Y_at_60_deg"]) == pytest.approx(expected, rel=1e-14)
    found = machine.optimize(minimize=("at", 60, "Y"), over={"AB": (40, 41)})
    assert found["value"] == pytest.approx(expected, rel=1e-9)
    assert machine.tolerance(("at", 60, "Y"), ec=dx.plus_minus(10, 0.1))["value"] == pytest.approx(
        expected, rel=1e-5
    )


@pytest.mark.parametrize("heads", ["theta [deg],Y [mm]", "theta,Y"])
def test_the_command_line_reads_plain_numbers_of_a_fit_in_the_units_of_the_scene(heads, tmp_path, capsys):
    scene, data = tmp_path / "press.toml", tmp_path / "press.csv"
    mechanism = "mechanism = {ec = 10, AB = 40, BC = 130}"
    scene.write_text(f'units = "{UNITS}"\noutputs = ["Y"]\nmotion = {{theta = 1}}\n{mechanism}')
    angles = np.arange(0, 360, 15)
    shifts = 5e-5 * (-1.0) ** np.arange(angles.size)  # 0.05 mm to either side
    measured = 1e3 * (position(np.radians(angles), 0.01) + shifts)
    rows = [f"{angle},{value}" for angle, value in zip(angles, measured, strict=True)]
    data.write_text("\n".join([heads, *rows]))
    assert main(["fit", str(scene), str(data), "--sigma", "Y=0.05", "--over", "AB=35:50", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)  # in SI units
    assert found["value"]["AB"] == pytest.approx(0.04, rel=1e-3)
    assert found["chi_square"] == pytest.approx(angles.size / (angles.size - 1), rel=1e-2)


def test_a_scene_reads_a_plain_angle_of_a_measure_in_its_units():
    table = {"units": UNITS, "outputs": ["Y"], "mechanism": {"ec": 10, "AB": 40, "BC": 130}}
    scene = dx.scene({**table, "motion": {"theta": [0, 60, 90]}, "reduce": {"theta": [["at", 60, "Y"]]}})
    found = scene.run().dataset["Y_at_60_deg"]
    assert float(found) == pytest.approx(1e3 * position(math.pi / 3, 0.01), rel=1e-14)
