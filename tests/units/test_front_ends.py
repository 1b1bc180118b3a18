"""Every front end reads one input to one number, refuses it in one sentence, and warns of one slip."""

import inspect
import io
import json
import math
import re
import subprocess
import sys
import warnings
from decimal import Decimal
from functools import cache

import numpy as np
import pytest

import desaxe as dx
from desaxe.cli import main
from desaxe.mechanism import public, slips
from desaxe.mechanism.inputs import INPUTS
from desaxe.mechanism.read import in_si

pd, xr = pytest.importorskip("pandas"), pytest.importorskip("xarray")
pint = pytest.importorskip("pint")
UNITS = "mm, deg, rpm, kN"
SIZES = {"AB": 0.04, "BC": 0.13}
IN_MM = {"AB": 40, "BC": 130, "units": UNITS}


def labelled(values, unit):
    return xr.DataArray(np.asarray(values, float), dims="k", attrs={"units": unit})


def series(values, unit):
    result = pd.Series(np.asarray(values, float))
    result.attrs["units"] = unit
    return result


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
    result = np.asarray(call(theta, ec), float)
    assert result == pytest.approx(expected if result.ndim else expected[0], rel=1e-14)


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
    assert main(["evaluate", "Y", f"theta={text}", "ec=10mm", "AB=40 mm", "BC=0.13", "--json"]) == 0
    result = json.loads(capsys.readouterr().out)["Y"]
    assert result == dx.evaluate("Y", theta=text, ec=0.01, **SIZES)
    assert result == pytest.approx(position(math.pi / 3, 0.01), rel=1e-14)


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
    result = machine.optimize(minimize=("at", 60, "Y"), over={"AB": (40, 41)})
    assert result["value"] == pytest.approx(expected, rel=1e-9)
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
    assert main(["fit", str(data), "--machine", str(scene), "sigma.Y=0.05", "over.AB=35:50", "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["value"]["AB"] == pytest.approx(40.0, rel=1e-3)
    assert result["chi_square"] == pytest.approx(angles.size / (angles.size - 1), rel=1e-2)


def test_a_scene_reads_a_plain_angle_of_a_measure_in_its_units():
    table = {"units": UNITS, "outputs": ["Y"], "mechanism": {"ec": 10, "AB": 40, "BC": 130}}
    scene = dx.scene({**table, "motion": {"theta": [0, 60, 90]}, "reduce": {"theta": [["at", 60, "Y"]]}})
    result = scene.run().dataset["Y_at_60_deg"]
    assert float(result) == pytest.approx(1e3 * position(math.pi / 3, 0.01), rel=1e-14)


# ---- one input, one number --------------------------------------------------------------------------

PLACE = {name: row.section for name, row in INPUTS.items()}
SAMPLE = {"theta": [0.0, 1.0], "Y": [0.4, 0.3]}


@pytest.fixture(autouse=True)
def _fresh():
    """No slip and no definition of another test."""
    slips.WARNED.clear()
    public.LOOKS[0] = 1000
    yield
    if "echo" in dx.quantities():
        dx.undefine("echo")


def echo(name):
    """The name of a quantity that is this input itself."""
    return dx.define("echo", name)


def by_evaluate(name, value, **others):
    return dx.evaluate(echo(name), **{name: value}, **others)


def by_function(name, value, **others):
    return float(dx.function(echo(name), (name,), **others)(value))


def by_machine(name, value, **others):
    if name == "theta":
        return dx.Machine(**{"AB": 0.1, **others}).evaluate(echo("theta"), theta=value)
    return dx.Machine(**{name: value}, **others)[name]


def by_scene(name, value, **others):
    inputs = {"theta": 1, "ec": 0, "AB": 0.1, "BC": 0.3, "omega0": 1, name: value} | others
    tables = {section: {} for section in PLACE.values()}
    for each, one in inputs.items():
        tables[PLACE[each]][each] = one
    return dx.scene({"outputs": [echo(name)], **tables}).inputs[name]


def by_command(name, value, **others):
    """The command line, whose error is raised."""
    words = [f"{each}={one}" for each, one in {name: value, **others}.items()]
    with pytest.MonkeyPatch.context() as patch:
        said = {stream: io.StringIO() for stream in ("stdout", "stderr")}
        for stream, buffer in said.items():
            patch.setattr(sys, stream, buffer)
        code = main(["evaluate", echo(name), *words, "--json"])
    if code:
        raise ValueError(said["stderr"].getvalue())
    return json.loads(said["stdout"].getvalue())["echo"]


READERS = {
    "evaluate": by_evaluate, "function": by_function, "Machine": by_machine, "scene": by_scene,
    "command": by_command,
}  # fmt: skip
NUMBERS = [
    ("ec", "10 mm", 0.01), ("ec", "10mm", 0.01), ("ec", "-0.5 inch", -0.0127), ("AB", "1.25e-1 m", 0.125),
    ("BC", "350 mm", 0.35), ("BC", "3e1 cm", 0.3), ("theta", "60 deg", 1.0471975511965979),
    ("theta", "-90degree", -1.5707963267948966), ("theta", "1.5", 1.5),
    ("omega0", "1500rpm", 157.07963267948966), ("omega0", "3 rad/s", 3.0), ("alpha", "2 rad/s^2", 2.0),
    ("m_slider", "500 g", 0.5), ("I_rod", "80.6 kg mm2", 8.06e-5), ("F_Y", "-4 kN", -4000.0),
    ("g_Y", "-9810 mm/s^2", -9.81), ("mu", "12 %", 0.12),
]  # fmt: skip


@pytest.mark.parametrize("reader", READERS)
@pytest.mark.parametrize(("name", "text", "number"), NUMBERS)
def test_a_text_is_the_double_nearest_to_what_it_says(reader, name, text, number):
    assert READERS[reader](name, text) == number


REFUSED = [
    ("ec", "3 kg", "it must be a quantity in m"),
    ("theta", "3 mm", "it must be a quantity in rad"),
    ("theta", "60 %", "it must be a quantity in rad"),
    ("theta", "1,5 rad", "it must be a number, or a number with a unit"),
    ("theta", "nan", "it must be a (finite )?number"),
    ("ec", "ten", "it must be a number, or a number with a unit"),
    ("ec", "", "it must be a number, or a number with a unit"),
    ("omega0", "25 Hz", 'it must be a quantity in rad/s, such as "1500 rpm"'),
    ("omega0", "1500 min^-1", "it must be a quantity in rad/s"),
    ("omega0", "1500 1/min", 'a rate "per time" does not say of what: write turns .*120 turn/min'),
    ("omega0", "120/min", 'a rate "per time" does not say of what'),
    ("omega0", "2 / s", 'a rate "per time" does not say of what'),
    ("omega0", "120 mm/1", "it must be a number, or a number with a unit"),
    ("omega0", "1/2 s", "it must be a number, or a number with a unit"),
    ("omega0", "120 rev//min", "it must be a number, or a number with a unit"),
    ("AB", "-10 mm", "it must be a finite length >= 0"),
    ("AB", "30 MM", r"did you mean mm\? it must be a quantity in m"),
    ("m_rod", "3 KG", r"unknown unit; did you mean kg\? it must"),
    ("F_Y", "3 kn", r"did you mean kN\? it must be a quantity in N"),
    ("F_X", "3 NM", "unknown unit; it must be a quantity in N"),
    ("I_rod", "3 kgm2", r"did you mean kg m\^?2\? it must"),
]


@pytest.mark.parametrize("reader", READERS)
@pytest.mark.parametrize(("name", "text", "words"), REFUSED)
def test_a_text_is_refused_with_its_name_and_the_remedy(reader, name, text, words):
    if text or reader != "command":
        with pytest.raises(ValueError, match=rf"{name}.*{words}"):
            READERS[reader](name, text)


OF_MAKERS = {
    "torque = '40 Nm': unknown unit; did you mean N m?": lambda: dx.steady(torque="40 Nm", **SIZES),
    "torque = '4kNm': unknown unit; did you mean kN m?": lambda: dx.steady(torque="4kNm", **SIZES),
    "torque = '3 Nmm': unknown unit; did you mean N mm?": lambda: dx.steady(torque="3 Nmm", **SIZES),
    "synchronous_speed = '25 Hz': it must be": lambda: dx.kloss(40, 0.1, "25 Hz"),
    "over_omega: speeds = '9 mm': it must be": lambda: dx.over_omega(["1 rpm", "9 mm"], [1, 0]),
    "over_Y: outward = '3 kn': unknown unit; did you mean kN?": lambda: dx.over_Y([0, 1], ["3 kn", 0]),
    "AB = '3 kg': it must be a quantity in m": lambda: dx.fit(SAMPLE, over={"AB": "3 kg"}, ec=0, BC=0.3),
    "ec = '3 kg': it must be a quantity in m": lambda: dx.tolerance(
        "Y", theta=1, ec=dx.plus_minus(0.1, "3 kg"), **SIZES
    ),
    "finite bounds (ec = '3 kg': it must be a quantity in m": lambda: dx.optimize(
        minimize="stroke", over={"ec": ("0 mm", "3 kg")}, **SIZES
    ),
}


@pytest.mark.parametrize("words", OF_MAKERS)
def test_loads_motors_and_requests_refuse_in_the_same_words(words):
    with pytest.raises(ValueError, match=re.escape(words)):
        OF_MAKERS[words]()


@cache
def registry(kind=float):
    """A user's registry of units, made once: it takes half a second."""
    return pint.UnitRegistry(non_int_type=kind)


@pytest.mark.parametrize(
    ("number", "unit"),
    [(350, "mm"), (12.7, "mm"), (0.1, "inch"), (60, "deg"), (1500, "rpm"), (80.6, "kg mm2")],
)
def test_a_quantity_of_pint_is_the_double_of_its_text(number, unit):
    name = {"deg": "theta", "rpm": "omega0", "kg mm2": "I_rod"}.get(unit, "BC")
    text = in_si(INPUTS[name], f"{number} {unit}")
    for kind in (float, Decimal):
        quantity = registry(kind).Quantity(kind(str(number)), unit.replace("mm2", "mm**2"))
        assert in_si(INPUTS[name], quantity) == text
    several = registry().Quantity(np.array([350.0, 12.7, 1.0]), "mm")
    assert in_si(INPUTS["BC"], several).tolist() == [0.35, 0.0127, 0.001]


def test_a_unit_of_somebody_elses_registry():
    registry().define("ell = 1.143 m")
    assert in_si(INPUTS["BC"], 2 * registry().ell) == pytest.approx(2.286)


# ---- slips of units ---------------------------------------------------------------------------------

SLIPS = [
    ({"theta": 60}, 'theta = 60 rad, write theta = "60 deg"'),
    ({"theta": -22.5}, 'theta = "-22.5 deg"'),
    ({"AB": 125, "BC": 350}, 'AB = 125 m, write AB = "125 mm"; BC = 350 m, write BC = "350 mm"'),
    ({"BC": "300"}, 'BC = 300 m, write BC = "300 mm"'),
    ({"ec": 10, "AB": 0.125, "BC": 0.35}, 'ec = 10 m beside links of 0.125 and 0.35 m, write ec = "10 mm"'),
    ({"ec": 10, "AB": "125 mm", "BC": "350 mm"}, 'write ec = "10 mm"'),
    ({"omega0": 1500}, 'omega0 = 1500 rad/s, write omega0 = "1500 rpm"'),
    ({"m_slider": 2e6}, 'm_slider = "2e+06 g"'),
    ({"g_Y": -9810}, 'write g_Y = "-9.81 m/s^2"'),
    ({"mu": 12}, "write mu = 0.12"),
    ({"F_Y": -8e7, "BC": 0.064}, "on a rod of 0.064 m: half as thick as it is long it would carry 78 GPa"),
]
NO_SLIPS = [
    {"theta": 20 * math.pi}, {"theta": 7.0}, {"theta": 59.123456789}, {"theta": "60 rad"}, {"AB": 1e6},
    {"theta": 60, "alpha": 0.5}, {"BC": 123.456789012}, {"omega0": 314.0}, {"F_Y": -6e4, "BC": 0.35},
    {"ec": 0.5, "AB": 0.1, "BC": 0.3},
]  # fmt: skip
WARNING = {key: reader for key, reader in READERS.items() if key != "function"}


@pytest.mark.parametrize("reader", WARNING)
@pytest.mark.parametrize(("inputs", "words"), SLIPS)
def test_a_slip_is_warned_of_with_its_remedy(reader, inputs, words):
    first, *others = inputs
    with pytest.warns(dx.UnitWarning) as caught:
        WARNING[reader](first, inputs[first], **{name: inputs[name] for name in others})
    assert len(caught) == 1
    assert words in str(caught[0].message)
    assert caught[0].filename == __file__ or reader == "command"


@pytest.mark.parametrize("reader", WARNING)
@pytest.mark.parametrize("inputs", NO_SLIPS)
def test_what_may_be_meant_is_no_slip(reader, inputs):
    first, *others = inputs
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        WARNING[reader](first, inputs[first], **{name: inputs[name] for name in others})


DESIGN = {"ec": 0.0, "AB": 0.1, "BC": 0.3}
WORDS = ["Y", "theta=0:360:5", "ec=0", "AB=0.1", "BC=0.3"]
OF_SEVERAL = [
    (lambda: dx.evaluate("Y", theta=[0, 90, 360], **DESIGN), 'theta = "360 deg"'),
    (lambda: dx.peak("Y", theta=(0, 180), **DESIGN), 'theta = "180 deg"'),
    (
        lambda: dx.solve(over={"AB": (30, 60)}, where={("max", "Y"): 260}, ec=0, BC=200.5),
        'AB = "60 mm"; BC = 200.5 m',
    ),
    (lambda: dx.Crankshaft(dx.Machine(**DESIGN), phase=[0, 180, 180, 0]), 'phase = "180 deg"'),
    (lambda: dx.Crankshaft(dx.Machine(**DESIGN), phase=[0, 1]).replace(**{"phase[1]": 90}), '"90 deg"'),
    (lambda: main(["evaluate", *WORDS]), 'theta = "360 deg"'),
    (lambda: main(["grid", *WORDS, "--units", "rpm"]), 'theta = "360 deg"'),
]


@pytest.mark.parametrize(("call", "words"), OF_SEVERAL)
def test_slips_in_ranges_lists_and_of_crankshafts(call, words):
    with pytest.warns(dx.UnitWarning, match=re.escape(words)):
        call()


def test_every_function_with_inputs_looks_for_slips():
    functions = {name: getattr(dx, name) for name in dx.PUBLIC if inspect.isfunction(getattr(dx, name))}
    signatures = {name: inspect.signature(function).parameters for name, function in functions.items()}
    with_inputs = {
        name
        for name, known in signatures.items()
        if "AB" in known or any(one.kind is one.VAR_KEYWORD for one in known.values())
    }
    assert with_inputs - {"define"} == {n for n, f in functions.items() if f.__module__ == "desaxe"}


def test_a_function_warns_once_of_each_kind():
    design = {"theta": 1.0, "ec": 0, **SIZES, "omega0": 1500}
    with pytest.warns(dx.UnitWarning, match="1500 rpm"):
        dx.evaluate("V_C", **design)
    with pytest.warns(dx.UnitWarning, match=r"slip: theta = 60 rad, write theta = \"60 deg\"$"):
        dx.evaluate("V_C", **design | {"theta": 60})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        dx.evaluate("V_C", **design | {"theta": np.float64(75), "AB": np.float64(125), "BC": 350.123456})
        dx.grid("V_C", **design | {"theta": np.array([60.0, 90.0]), "omega0": 1800})
        dx.Machine(**SIZES, ec=0, units="deg").evaluate("Y", theta=60)  # within it is called with radians
        slips.WARNED.clear()
        public.LOOKS[0] = 0
        dx.evaluate("V_C", **design)  # after a thousand calls, which nobody types


@pytest.mark.parametrize(
    ("words", "slip"),
    [
        (["theta=60deg", "ec=10mm", "AB=125mm", "BC=350mm", "omega0=1500rpm"], ""),
        (["theta=60", "ec=0.01", "AB=0.125", "BC=0.35", "omega0=157"], 'write theta = "60 deg"'),
    ],
)
def test_the_first_call_of_an_engineer_needs_no_unit_library(words, slip):
    code = "import sys; from desaxe.cli import main; main(); print({'pint', 'numpy'} & {*sys.modules})"
    command = [sys.executable, "-c", code, "evaluate", "a_C", *words]
    result = subprocess.run(command, capture_output=True, text=True, check=True)
    assert (slip in result.stderr, bool(result.stderr)) == (True, bool(slip)), result.stderr
    assert re.match("a_C  .*\nstatus  0\nset\\(\\)$", result.stdout)
