"""Scenes: what a file may say, and what is complained about."""

import math
import sys
import tomllib

import numpy as np
import pytest

import desaxe as dx
from desaxe.scenes.reading.printed import read_percentage, read_printed
from desaxe.scenes.schema import SceneError
from desaxe.support.quantity_text import quantity_text
from tests.example_scenes import COMPACTOR, SMALL, changed

# ---- mistakes ------------------------------------------------------------------------------------

PEAK = {"quantity": "a_C"}
MISTAKES = {
    "data file of another kind": (
        "results.data",
        "x.xls",
        ['results.data = "x.xls"', "must end in one of .nc, .zarr"],
    ),
    "picture of an unknown kind": (
        "picture",
        [{"quantity": "a_C", "file": "x.xyz"}],
        ['picture #1.file = "x.xyz"', ".png, .svg, .pdf"],
    ),
    "unknown key": ("titel", "x", ["titel", "did you mean title?", "allowed: title, outputs"]),
    "key in another case": ("mechanism.Bc", 1, ["mechanism.Bc = 1", "did you mean BC?"]),
    "key by another word": ("motion.speed", 1, ["motion.speed = 1", "did you mean omega0?"]),
    "unknown key of a section": ("mechanism.CD", 1, ["mechanism.CD = 1", "allowed: AB, BC, ec, branch"]),
    "wrong type": ("title", 3, ["title = 3", "it must be text"]),
    "section that is no table": ("mechanism", 3, ["mechanism = 3", "a table, [mechanism]"]),
    "truth for a number": (
        "mechanism.AB",
        True,
        ["mechanism.AB = true", "a number in SI units, text with a unit"],
    ),
    "nested list": ("mechanism.ec", [0, [1]], ["mechanism.ec #2 = [1]", "a number in SI units, or text"]),
    "empty list": ("mechanism.ec", [], ["mechanism.ec", "at least one value"]),
    "incomplete range": ("mechanism.ec", {"start": 0, "num": 3}, ["mechanism.ec.stop is missing"]),
    "one point in a range": (
        "mechanism.ec",
        {"start": 0, "stop": 1, "num": 1},
        ["mechanism.ec.num = 1", "a whole number, at least 2"],
    ),
    "range without num": (
        "mechanism.ec",
        {"start": 0, "stop": 1},
        ["mechanism.ec", "num (how many) or step"],
    ),
    "both num and step": (
        "mechanism.ec",
        {"start": 0, "stop": 1, "num": 3, "step": 1},
        ["mechanism.ec", "either num (how many) or step"],
    ),
    "step that misses the end": (
        "mechanism.ec",
        {"start": 0, "stop": "10 mm", "step": "3 mm"},
        ['mechanism.ec.step = "3 mm"', "whole number of steps"],
    ),
    "step of nothing": ("mechanism.ec", {"start": 0, "stop": 1, "step": 0}, ["mechanism.ec.step = 0"]),
    "too many values": (
        "mechanism.ec",
        {"start": 0, "stop": 1, "num": 10**9},
        ["1000000000 values are too many"],
    ),
    "unknown unit": (
        "mechanism.ec",
        {"start": 0, "stop": "230 mmm", "num": 3},
        ['mechanism.ec.stop = "230 mmm"', "unknown unit"],
    ),
    "unit of another kind": ("mechanism.AB", "3 kg", ['mechanism.AB = "3 kg"', "it must be a quantity in m"]),
    "decimal comma": ("mechanism.AB", "1,5 m", ['mechanism.AB = "1,5 m"', "a number with a unit such as"]),
    "a sum": ("mechanism.AB", "1 m + 2 m", ['mechanism.AB = "1 m + 2 m"', "a number with a unit such as"]),
    "code": ("mechanism.AB", "__import__('os')", ["mechanism.AB", "a number with a unit such as"]),
    "negative length": ("mechanism.AB", "-1 mm", ['mechanism.AB = "-1 mm"', "a finite length >= 0"]),
    "no rod": ("mechanism.BC", 0, ["mechanism.BC = 0", "a finite length > 0"]),
    "not finite": ("motion.omega0", math.inf, ["motion.omega0 = inf", "a finite number"]),
    "no such branch": ("mechanism.branch", 2, ["mechanism.branch = 2", "1 (the papers) or -1"]),
    "no such accuracy": ("accuracy", "best", ['accuracy = "best"', "one of standard, extended"]),
    "accuracy out of reach": ("accuracy", 1e-20, ["accuracy = 1e-20: the smallest error is"]),
    "accuracy that is no error": (
        "accuracy",
        [1],
        ["accuracy = [1]", '"extended", or an error such as 1e-9'],
    ),
    "outputs that are no list": ("outputs", "a_C", ['outputs = "a_C"', "a list of names of quantities"]),
    "unknown output": ("outputs", ["V_C", "aC"], ['outputs #2 = "aC"', "did you mean a_C"]),
    "missing input": ("motion.omega0", None, ["outputs", "needs motion.omega0, which is missing"]),
    "missing length": ("mechanism.BC", None, ["outputs", "needs mechanism.BC, which is missing"]),
    "law and state": ("motion.omega", 3, ["motion.omega = 3", "not both"]),
    "unknown mass": (
        "masses.m_piston",
        1,
        ["masses.m_piston = 1", "unknown key", "allowed: m_crank, m_rod, m_slider, I_crank, I_rod, r_crank"],
    ),
    "load among the masses": ("masses.mu", 0.1, ["masses.mu = 0.1", "unknown key"]),
    "loads that are no table": ("loads", [1], ["loads = [1]", "a table, [loads]"]),
    "negative mass": ("masses.m_rod", "-1 kg", ['masses.m_rod = "-1 kg"', "a finite mass >= 0"]),
    "truth for a mass": ("masses.m_rod", True, ["masses.m_rod = true", '"0.5 kg"']),
    "negative friction": ("loads.mu", -0.1, ["loads.mu = -0.1", "a finite number >= 0"]),
    "force in kilograms": ("loads.F_Y", ["5 kg"], ['loads.F_Y #1 = "5 kg"', 'in N, such as "50 N"']),
    "inertia in other units": (
        "masses.I_rod",
        "1 kg m",
        ["masses.I_rod", 'in kg*m^2, such as "80.6 kg mm2"'],
    ),
    "friction with a unit": ("loads.mu", "1 N", ['loads.mu = "1 N"', "a plain number, such as 0.1"]),
    "step of a mass that misses the end": (
        "masses.m_rod",
        {"start": "1 kg", "stop": 0, "step": "-0.3 kg"},
        ['masses.m_rod.step = "-0.3 kg"', "whole number of steps"],
    ),
    "step that is not finite": (
        "masses.m_rod",
        {"start": 0, "stop": 1, "step": math.inf},
        ["masses.m_rod.step = inf", "a finite number"],
    ),
    "step in other units": (
        "masses.m_rod",
        {"start": 0, "stop": 1, "step": "1 mm"},
        ['masses.m_rod.step = "1 mm"', "a quantity in kg"],
    ),
    "sensitivity by nothing known": (
        "peak",
        [{**PEAK, "sensitivities": ["m_piston"]}],
        ["peak #1.sensitivities.m_piston: unknown input"],
    ),
    "sensitivity that there is not": (
        "peak",
        [{**PEAK, "sensitivities": ["m_rod"]}],
        ["peak #1.sensitivities: a_C has no sensitivity by m_rod, it does not depend on it"],
    ),
    "sensitivity by theta": (
        "peak",
        [{**PEAK, "sensitivities": ["theta"]}],
        ["a_C has no sensitivity by theta, a peak is taken over it"],
    ),
    "sensitivity by a centre that is not given": (
        "peak",
        [{"quantity": "T_in", "sensitivities": ["r_rod"]}],
        ["peak #1.sensitivities: r_rod is half a length", "give masses.r_rod"],
    ),
    "baseline that changes nothing": (
        "peak",
        [{**PEAK, "baseline": {"ec": 0, "m_rod": 1}}],
        ["peak #1.baseline.m_rod: the peak does not depend on it"],
    ),
    "claim that changes nothing": (
        "peak",
        [{**PEAK, "baseline": {"ec": 0}, "claim": [{"at": {"ec": 0.1, "mu": 1}, "increase": "3 %"}]}],
        ["peak #1.claim #1.at.mu: the peak does not depend on it"],
    ),
    "unknown quantity of a peak": (
        "peak",
        [{"quantity": "aC"}],
        ['peak #1.quantity = "aC"', "did you mean a_C"],
    ),
    "peak without quantity": ("peak", [PEAK, {}], ["peak #2.quantity is missing", "the name of a quantity"]),
    "peak that is no list": ("peak", PEAK, ["peak = a table", "a list of tables, [[peak]]"]),
    "unknown kind": (
        "peak",
        [{**PEAK, "kind": "most"}],
        ['peak #1.kind = "most"', "one of absmax, max, min"],
    ),
    "peak over theta": (
        "peak",
        [{**PEAK, "over": {"theta": [0, 1]}}],
        ["peak #1.over.theta", "taken over theta"],
    ),
    "peak over nothing known": ("peak", [{**PEAK, "over": {"CD": [1]}}], ["peak #1.over.CD: unknown input"]),
    "peak that does not depend": (
        "peak",
        [{"quantity": "V_B", "over": {"ec": [0, 1]}}],
        ["peak #1.over.ec: V_B does not depend on it"],
    ),
    "peak of what has none": ("peak", [{"quantity": "margin"}], ['"margin"', "it has no peak"]),
    "one angle": ("peak", [{**PEAK, "theta": [1]}], ["peak #1.theta = [1]", "two angles"]),
    "angles the wrong way": (
        "peak",
        [{**PEAK, "theta": [2, 1]}],
        ["peak #1.theta = [2", "lower end comes first"],
    ),
    "baseline that is no design": ("peak", [{**PEAK, "baseline": {"AB": 1}}], ["give peak #1.baseline.ec"]),
    "claim without baseline": (
        "peak",
        [{**PEAK, "claim": [{"at": {"ec": 0}, "increase": "3 %"}]}],
        ["peak #1.claim #1.increase", "needs the peak's baseline"],
    ),
    "claim that is no percentage": (
        "peak",
        [{**PEAK, "baseline": {"ec": 0}, "claim": [{"at": {"ec": 0.1}, "increase": "much"}]}],
        ['peak #1.claim #1.increase = "much"', "a percentage"],
    ),
    "nothing printed": ("check", [{"printed": {}}], ["check #1.printed", "at least one printed value"]),
    "unknown quantity of a check": ("check", [{"printed": {"aC": 1}}], ["check #1.printed.aC"]),
    "printed value that is a list": ("check", [{"printed": {"a_C": [1]}}], ["check #1.printed.a_C = [1]"]),
    "printed value that is no number": (
        "check",
        [{"printed": {"a_C": "fast"}}],
        ['check #1.printed.a_C = "fast"'],
    ),
    "printed value in another unit": (
        "check",
        [{"at": {"ec": 0, "theta": 1}, "printed": {"a_C": "3 m/s"}}],
        ['check #1.printed.a_C = "3 m/s"', "m/s^2"],
    ),
    "check at a range": (
        "check",
        [{"at": {"ec": 0}, "printed": {"a_C": 1}}],
        ["theta has 5 values", "give at.theta"],
    ),
    "check at an unknown input": (
        "check",
        [{"at": {"CD": 0}, "printed": {"a_C": 1}}],
        ["check #1.at.CD: unknown"],
    ),
    "picture without file": ("picture", [{"quantity": "a_C"}], ["picture #1.file is missing"]),
    "picture over a number": (
        "picture",
        [{"file": "a.png", "quantity": "a_C", "over": "AB", "family": {"ec": [0]}}],
        ['picture #1.over = "AB"', "a list or range"],
    ),
    "picture over nothing known": (
        "picture",
        [{"file": "a.png", "quantity": "a_C", "over": "CD"}],
        ['picture #1.over = "CD"', "unknown input"],
    ),
    "picture of two families": (
        "picture",
        [{"file": "a.png", "quantity": "a_C", "family": {"ec": [0], "AB": [1]}}],
        ["picture #1.family", "one input"],
    ),
    "data that is no path": ("results.data", 3, ["results.data = 3", "the path of a file"]),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_mistake(mistake):
    path, value, words = MISTAKES[mistake]
    with pytest.raises(SceneError) as complaint:
        dx.scene(changed(path, value))
    message = str(complaint.value)
    assert message.startswith("scene: ")
    assert "\n" not in message
    for word in words:
        assert word in message


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
    with pytest.warns(DeprecationWarning, match="accuracy='standard'"):
        assert dx.scene({**SMALL, "accuracy": "fast"}) == dx.scene(SMALL)


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
