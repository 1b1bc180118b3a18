"""Scenes: what a file may say, and what is complained about."""

import math
import sys
import tomllib

import numpy as np
import pytest

import desaxe as dx
from desaxe.scenes.parts.checks import read_percentage, read_printed
from desaxe.scenes.schema import SceneError
from desaxe.units.text import quantity_text
from tests.example_scenes import COMPACTOR, SMALL, changed

# ---- mistakes ------------------------------------------------------------------------------------

# A line of TOML -> what is said of it, beside the line itself; several words: without the whole line.
MISTAKES = {
    'results.data = "x.xls"': "must end in one of .nc, .zarr",
    'picture = [{quantity = "a_C", file = "x.xyz"}]': ('picture #1.file = "x.xyz"', ".png, .svg, .pdf"),
    'titel = "x"': ("titel", "did you mean title?", "allowed: title, outputs"),
    "mechanism.Bc = 1": "did you mean BC?",
    "motion.speed = 1": "did you mean omega0?",
    "mechanism.CD = 1": "allowed: AB, BC, ec, branch",
    "title = 3": "it must be text",
    "mechanism = 3": "a table, [mechanism]",
    "mechanism.AB = true": "a number in SI units, text with a unit",
    "mechanism.ec = [0, [1]]": ("mechanism.ec #2 = [1]", "a number in SI units, or text"),
    "mechanism.ec = []": ("mechanism.ec", "at least one value"),
    "mechanism.ec = {start = 0, num = 3}": ("mechanism.ec.stop is missing",),
    "mechanism.ec = {start = 0, stop = 1, num = 1}": ("mechanism.ec.num = 1", "a whole number, at least 2"),
    "mechanism.ec = {start = 0, stop = 1}": ("mechanism.ec", "num (how many) or step"),
    "mechanism.ec = {start = 0, stop = 1, num = 3, step = 1}": (
        "mechanism.ec", "either num (how many) or step",
    ),
    'mechanism.ec = {start = 0, stop = "10 mm", step = "3 mm"}': (
        'mechanism.ec.step = "3 mm"', "whole number of steps",
    ),
    "mechanism.ec = {start = 0, stop = 1, step = 0}": ("mechanism.ec.step = 0",),
    "mechanism.ec = {start = 0, stop = 1, num = 1000000000}": ("1000000000 values are too many",),
    'mechanism.ec = {start = 0, stop = "230 mmm", num = 3}': (
        'mechanism.ec.stop = "230 mmm"', "unknown unit",
    ),
    'mechanism.AB = "3 kg"': "it must be a quantity in m",
    'mechanism.AB = "1,5 m"': "a number with a unit such as",
    'mechanism.AB = "1 m + 2 m"': "a number with a unit such as",
    "mechanism.AB = \"__import__('os')\"": "a number with a unit such as",
    'mechanism.AB = "-1 mm"': "a finite length >= 0",
    "mechanism.BC = 0": "a finite length > 0",
    "motion.omega0 = inf": "a finite number",
    "mechanism.branch = 2": "1 (the papers) or -1",
    'accuracy = "best"': "one of standard, extended",
    "accuracy = 1e-20": ": the smallest error is",
    "accuracy = [1]": '"extended", or an error such as 1e-9',
    'outputs = "a_C"': "a list of names of quantities",
    'outputs = ["V_C", "aC"]': ('outputs #2 = "aC"', "did you mean a_C"),
    'motion.omega = "30 rpm"': "not both",
    "masses.m_piston = 1": (
        "masses.m_piston = 1", "unknown key", "allowed: m_crank, m_rod, m_slider, I_crank, I_rod, r_crank",
    ),
    "masses.mu = 0.1": "unknown key",
    "loads = [1]": "a table, [loads]",
    'masses.m_rod = "-1 kg"': "a finite mass >= 0",
    "masses.m_rod = true": '"0.5 kg"',
    "loads.mu = -0.1": "a finite number >= 0",
    'loads.F_Y = ["5 kg"]': ('loads.F_Y #1 = "5 kg"', 'in N, such as "50 N"'),
    'masses.I_rod = "1 kg m"': 'in kg m^2, such as "80.6 kg mm2"',
    'loads.mu = "1 N"': "a plain number, such as 0.1",
    'masses.m_rod = {start = "1 kg", stop = 0, step = "-0.3 kg"}': (
        'masses.m_rod.step = "-0.3 kg"', "whole number of steps",
    ),
    "masses.m_rod = {start = 0, stop = 1, step = inf}": ("masses.m_rod.step = inf", "a finite number"),
    'masses.m_rod = {start = 0, stop = 1, step = "1 mm"}': (
        'masses.m_rod.step = "1 mm"', "a quantity in kg",
    ),
    'peak = [{quantity = "a_C", sensitivities = ["m_piston"]}]': (
        "peak #1.sensitivities.m_piston: unknown input",
    ),
    'peak = [{quantity = "a_C", sensitivities = ["m_rod"]}]': (
        "peak #1.sensitivities: a_C has no sensitivity by m_rod, it does not depend on it",
    ),
    'peak = [{quantity = "a_C", sensitivities = ["theta"]}]': (
        "a_C has no sensitivity by theta, a peak is taken over it",
    ),
    'peak = [{quantity = "T_in", sensitivities = ["r_rod"]}]': (
        "peak #1.sensitivities: r_rod is half a length", "give masses.r_rod",
    ),
    'peak = [{quantity = "a_C", baseline = {ec = 0, m_rod = 1}}]': (
        "peak #1.baseline.m_rod: the peak does not depend on it",
    ),
    'peak = [{quantity = "a_C", baseline.ec = 0, claim = [{at = {ec = 1, mu = 1}, increase = "3 %"}]}]': (
        "peak #1.claim #1.at.mu: the peak does not depend on it",
    ),
    'peak = [{quantity = "aC"}]': ('peak #1.quantity = "aC"', "did you mean a_C"),
    'peak = [{quantity = "a_C"}, {}]': ("peak #2.quantity is missing", "the name of a quantity"),
    'peak = {quantity = "a_C"}': ("peak = a table", "a list of tables, [[peak]]"),
    'peak = [{quantity = "a_C", kind = "most"}]': ('peak #1.kind = "most"', "one of absmax, max, min"),
    'peak = [{quantity = "a_C", over.theta = [0, 1]}]': ("peak #1.over.theta", "taken over theta"),
    'peak = [{quantity = "a_C", over.CD = [1]}]': ("peak #1.over.CD: unknown input",),
    'peak = [{quantity = "V_B", over.ec = [0, 1]}]': ("peak #1.over.ec: V_B does not depend on it",),
    'peak = [{quantity = "margin"}]': ('"margin"', "it has no peak"),
    'peak = [{quantity = "a_C", theta = [1]}]': ("peak #1.theta = [1]", "two angles"),
    'peak = [{quantity = "a_C", theta = [2, 1]}]': ("peak #1.theta = [2", "lower end comes first"),
    'peak = [{quantity = "a_C", baseline.AB = 1}]': ("give peak #1.baseline.ec",),
    'peak = [{quantity = "a_C", claim = [{at.ec = 0, increase = "3 %"}]}]': (
        "peak #1.claim #1.increase", "needs the peak's baseline",
    ),
    'peak = [{quantity = "a_C", baseline.ec = 0, claim = [{at.ec = 0.1, increase = "much"}]}]': (
        'peak #1.claim #1.increase = "much"', "a percentage",
    ),
    "check = [{printed = {}}]": ("check #1.printed", "at least one printed value"),
    "check = [{printed.aC = 1}]": ("check #1.printed.aC",),
    "check = [{printed.a_C = [1]}]": ("check #1.printed.a_C = [1]",),
    'check = [{printed.a_C = "fast"}]': ('check #1.printed.a_C = "fast"',),
    'check = [{at = {ec = 0, theta = 1}, printed.a_C = "3 m/s"}]': (
        'check #1.printed.a_C = "3 m/s"', "m/s^2",
    ),
    "check = [{at.ec = 0, printed.a_C = 1}]": ("theta has 5 values", "give at.theta"),
    "check = [{at.CD = 0, printed.a_C = 1}]": ("check #1.at.CD: unknown",),
    'picture = [{quantity = "a_C"}]': ("picture #1.file is missing",),
    'picture = [{file = "a.png", quantity = "a_C", over = "AB", family.ec = [0]}]': (
        'picture #1.over = "AB"', "a list or range",
    ),
    'picture = [{file = "a.png", quantity = "a_C", over = "CD"}]': (
        'picture #1.over = "CD"', "unknown input",
    ),
    'picture = [{file = "a.png", quantity = "a_C", family = {ec = [0], AB = [1]}}]': (
        "picture #1.family", "one input",
    ),
    "results.data = 3": "the path of a file",
}  # fmt: skip


def told_of(data):
    """The complaint of a wrong scene, a line."""
    with pytest.raises(SceneError) as complaint:
        dx.scene(data)
    message = str(complaint.value)
    assert message.startswith("scene: ")
    assert "\n" not in message
    return message


@pytest.mark.parametrize("line", MISTAKES)
def test_mistake(line):
    value, path = tomllib.loads(line), line.partition(" =")[0]
    for key in path.split("."):
        value = value[key]
    words = MISTAKES[line]
    message = told_of(changed(path, value))
    for word in (line, words) if isinstance(words, str) else words:
        assert word in message


@pytest.mark.parametrize("path", ["motion.omega0", "mechanism.BC"])
def test_what_is_missing(path):
    message = told_of(changed(path, None))
    assert "outputs" in message
    assert f"needs {path}, which is missing" in message


def test_nothing_asked_for():
    with pytest.raises(SceneError, match="the scene requests nothing"):
        dx.scene({"mechanism": {"AB": 1}})
    check = {"at": {"theta": 1, "ec": 0}, "printed": {"Y": 1}}
    data = {**changed("outputs", []), "check": [check], "results": {"data": "a.nc"}}
    with pytest.raises(SceneError, match=r"results\.data = \"a\.nc\": there is nothing to write"):
        dx.scene(data)


def test_file_that_is_no_scene(tmp_path):
    path = tmp_path / "broken.toml"
    path.write_text("[mechanism\nAB = 1", encoding="utf-8")
    with pytest.raises(SceneError, match=r"broken\.toml: not a TOML file: .*line 1"):
        dx.scene(path)
    path.write_bytes(b"title = '\xff'")
    with pytest.raises(SceneError, match="not a text in UTF-8"):
        dx.scene(path)
    with pytest.raises(FileNotFoundError):
        dx.scene(tmp_path / "missing.toml")
    with pytest.raises(TypeError, match="a TOML file or a mapping, got int"):
        dx.scene(3)


@pytest.mark.parametrize("module", ["xarray", "h5netcdf", "matplotlib"])
def test_missing_extra_is_told_before_the_work(module, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(ImportError, match=rf"needs {module}: python -m pip install 'desaxe\["):
        dx.scene(COMPACTOR).run()
    assert not list(tmp_path.iterdir())


# ---- what is read --------------------------------------------------------------------------------


def test_file_and_mapping_are_the_same():
    data = tomllib.loads(COMPACTOR.read_text(encoding="utf-8"))
    assert dx.scene(data) == dx.scene(COMPACTOR) == dx.scene(str(COMPACTOR))
    data["mechanism"]["AB"] = "126 mm"
    assert dx.scene(data) != dx.scene(COMPACTOR)


def test_numpy_and_tuples_in_a_mapping():
    one = changed("mechanism.ec", np.array([0.0, 0.05]))
    one["outputs"] = ("V_C", "a_C")
    one["mechanism"]["BC"] = np.float64(0.35)
    assert dx.scene(one) == dx.scene(SMALL)


def test_values_of_inputs():
    steps = {"start": "0 mm", "stop": "230 mm", "step": "10 mm"}
    inputs = dx.scene(changed("mechanism.ec", steps)).inputs
    assert inputs["ec"] == pytest.approx([k / 100 for k in range(24)], rel=1e-15)
    assert inputs["ec"][-1] == 0.23
    assert inputs["theta"] == pytest.approx([0, math.pi / 2, math.pi, 1.5 * math.pi, 2 * math.pi], rel=1e-15)
    assert inputs["AB"] == 0.125
    assert inputs["omega0"] == pytest.approx(50 * math.pi, rel=1e-15)
    backwards = {"start": 0.5, "stop": 0.2, "step": "-100 mm"}
    assert dx.scene(changed("mechanism.BC", backwards)).inputs["BC"] == pytest.approx([0.5, 0.4, 0.3, 0.2])


def test_an_accuracy_is_a_name_or_an_error():
    assert dx.scene({**SMALL, "accuracy": 1e-9}) == dx.scene(SMALL)
    assert dx.scene({**SMALL, "accuracy": 1e-15}) == dx.scene({**SMALL, "accuracy": "extended"})
    with pytest.raises(ValueError, match="it is one of standard, extended"):
        dx.scene({**SMALL, "accuracy": "fast"})


def test_masses_and_loads():
    data = {
        **SMALL,
        "masses": {
            "m_rod": ["500 g", 1],
            "I_rod": "80.6 kg mm2",
            "r_rod": "-2 cm",
            "m_slider": {"start": "1 kg", "stop": 0, "step": "-500 g"},
        },
        "loads": {"F_Y": "-50 N", "g_X": "9.81 m/s2", "mu": "10 %"},
    }
    inputs = dx.scene(data).inputs
    assert inputs["m_rod"] == (0.5, 1.0)
    assert inputs["m_slider"] == (1.0, 0.5, 0.0)
    assert [inputs[name] for name in ("I_rod", "r_rod")] == [80.6e-6, -0.02]
    assert [inputs[name] for name in ("F_Y", "g_X", "mu")] == [-50.0, 9.81, 0.1]
    assert list(inputs)[-7:] == ["m_rod", "I_rod", "r_rod", "m_slider", "F_Y", "g_X", "mu"]
    again = {**data, "masses": {**data["masses"], "m_rod": [0.5, "1 kg"]}}
    assert dx.scene(again) == dx.scene(data)
    assert dx.scene({**data, "loads": {**data["loads"], "mu": 0.2}}) != dx.scene(data)


@pytest.mark.parametrize(
    ("text", "read"),
    {
        "60deg": "60 deg",
        " -.5e3mm ": "-.5e3 mm",
        "10 rad/s2": "10 rad/s^2",
        "10 rad/s**2": "10 rad/s^2",
        "10 rad s^-2": "10 rad s^-2",
        "1500 rev/min": "1500 rev/min",
        "3": "3",
    }.items(),
)
def test_spelling_of_quantities(text, read):
    assert quantity_text(text) == read


@pytest.mark.parametrize(
    "text", ["", "deg", "1,5 m", "[1, 2]", "2*3 m", "1 m 2", "1 m + 1 m", "10**9 m", "nan"]
)
def test_texts_that_are_no_quantity(text):
    with pytest.raises(ValueError, match="it must be a number"):
        quantity_text(text)


@pytest.mark.parametrize(
    ("written", "digits", "computed", "shown", "agrees"),
    [
        ("-994 m/s2", None, -993.6006, "-994 m/s2", True),
        ("-994 m/s2", None, -993.4, "-993 m/s2", False),
        ("-7740 m/s^2", None, -7742.07, "-7740 m/s^2", True),
        ("-7740 m/s^2", 4, -7742.07, "-7742 m/s^2", False),
        ("29.50", None, 29.496, "29.50 m/s^2", True),
        ("29.5 m/s**2", None, 29.55, "29.6 m/s**2", False),
        (100, None, 149.0, "100 m/s^2", True),
        (0, None, 0.4, "0 m/s^2", True),
        ("1 km/s2", None, 994.0, "1 km/s2", True),
        ("1e300", None, 1e-300, "0 m/s^2", False),
        ("1", None, math.nan, "NaN m/s^2", False),
    ],
)
def test_printed_digits(written, digits, computed, shown, agrees):
    printed = read_printed("key", written, digits, "m/s^2")
    assert printed.text(printed.rounded(computed)).replace("0" * 300, "0") == shown
    assert printed.agrees(computed) is agrees


def test_percentages():
    for written in ("33 %", "33%", 33):
        printed = read_percentage("key", written)
        assert printed.text(printed.value) == "33 %"
        assert printed.agrees(33.4)
        assert not printed.agrees(33.6)


def test_a_unit_without_quotes_is_told(tmp_path):
    path = tmp_path / "bare.toml"
    path.write_text("[mechanism]\nAB = 125 mm\n", encoding="utf-8")
    with pytest.raises(SceneError, match=r'in quotes: AB = "125 mm"'):
        dx.scene(path)


@pytest.mark.parametrize(("units", "text"), [("", "m/s^2"), ("mm, deg", "mm/s^2")])
def test_a_whole_printed_number_has_no_decimals(units, text):
    """As its text has none: -7740 is printed to tens."""
    table = {"units": units, "outputs": ["Y"], "mechanism": {"ec": 0, "AB": "40 mm", "BC": "0.13 m"}}
    motion, check = {"theta": 1, "omega0": 100}, [{"printed": {"a_C": -7740}}]
    checks = dx.scene({**table, "motion": motion, "check": check}).content.of("check")[0].checks
    assert (checks[0].printed.place, checks[0].printed.unit) == (1, text)
