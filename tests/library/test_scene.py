"""Scenes: what a file may say, what is complained about, and the numbers that come out."""

import contextlib
import copy
import io
import math
import sys
import time
import tomllib
from pathlib import Path

import numpy as np
import pytest
import xarray

import desaxe as dx
from desaxe._quantity_text import quantity_text
from desaxe._scene import run as scene_run
from desaxe._scene.printed import read_percentage, read_printed
from desaxe._scene.progress import progress_bar
from desaxe._scene.schema import SceneError

COMPACTOR = Path(__file__).parents[2] / "examples" / "compactor.toml"

SMALL = {
    "title": "small",
    "outputs": ["V_C", "a_C"],
    "mechanism": {"ec": [0, "50 mm"], "AB": "125 mm", "BC": 0.35},
    "motion": {"theta": {"start": 0, "stop": "360 deg", "num": 5}, "omega0": "1500 rpm"},
}


def changed(path, value):
    """The small scene with one key set, or removed where the value is None."""
    data = copy.deepcopy(SMALL)
    *sections, last = path.split(".")
    place = data
    for section in sections:
        place = place.setdefault(section, {})
    if value is None:
        del place[last]
    else:
        place[last] = value
    return data


@pytest.fixture(scope="module")
def compactor(tmp_path_factory):
    """The example, run in a folder of its own: that folder, the result and the steps it told."""
    folder = tmp_path_factory.mktemp("compactor")
    steps = []
    with contextlib.chdir(folder):
        result = dx.scene(COMPACTOR).run(lambda *step: steps.append(step))
    return folder, result, steps


# ---- mistakes ------------------------------------------------------------------------------------

PEAK = {"quantity": "a_C"}
MISTAKES = {
    "data file of another kind": ("results.data", "x.csv", ['results.data = "x.csv"', "must end in .nc"]),
    "picture of an unknown kind": (
        "picture",
        [{"quantity": "a_C", "file": "x.xyz"}],
        ['picture #1.file = "x.xyz"', ".png, .svg, .pdf"],
    ),
    "unknown key": ("titel", "x", ["titel", "did you mean title?", "allowed: title, outputs"]),
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
    "no such accuracy": ("accuracy", "best", ['accuracy = "best"', '"standard"']),
    "outputs that are no list": ("outputs", "a_C", ['outputs = "a_C"', "a list of names of quantities"]),
    "unknown output": ("outputs", ["V_C", "aC"], ['outputs #2 = "aC"', "did you mean a_C"]),
    "missing input": ("motion.omega0", None, ["outputs", "needs motion.omega0, which is missing"]),
    "missing length": ("mechanism.BC", None, ["outputs", "needs mechanism.BC, which is missing"]),
    "law and state": ("motion.omega", 3, ["motion.omega = 3", "not both"]),
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
    with pytest.raises(SceneError, match="nothing is asked for"):
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


# ---- what comes out ------------------------------------------------------------------------------


def test_dataset():
    dataset = dx.scene(SMALL).run().dataset
    assert dict(dataset.sizes) == {"ec": 2, "theta": 5}
    assert set(dataset.data_vars) == {"V_C", "a_C", "status", "margin"}
    assert dataset.attrs["title"] == "small"
    assert dataset.attrs["source"].startswith("desaxe ")
    point = {"theta": math.pi / 2, "ec": 0.05, "AB": 0.125, "BC": 0.35, "omega0": 50 * math.pi}
    assert float(dataset.a_C.sel(ec=0.05)[1]) == pytest.approx(dx.evaluate("a_C", **point), rel=1e-12)


def test_order_of_axes_is_that_of_the_file():
    data = {"motion": SMALL["motion"], "mechanism": SMALL["mechanism"], "outputs": ["Y"]}
    assert dx.scene(data).run().dataset.Y.dims == ("theta", "ec")


def test_one_point():
    data = {**SMALL, "mechanism": {"ec": 0, "AB": 0.125, "BC": 0.35}, "motion": {"theta": 1, "omega0": 2}}
    result = dx.scene(data).run()
    assert result.dataset.a_C.dims == ()
    assert "V_C, a_C over one point" in str(result)


def test_given_state():
    data = {**SMALL, "outputs": ["a_C", "a_C_wrt_omega"], "motion": {"theta": [0, 1], "omega": 3, "alpha": 2}}
    data["peak"] = [{"quantity": "a_C"}]
    result = dx.scene(data).run()
    point = {"theta": 1.0, "ec": 0.05, "AB": 0.125, "BC": 0.35, "omega": 3.0, "alpha": 2.0}
    assert float(result.dataset.a_C_wrt_omega[1, 1]) == pytest.approx(dx.evaluate("a_C_wrt_omega", **point))
    found = result.peaks[0].dataset
    assert found.value_wrt_omega.units == "m/s/rad"
    assert not found.status.any()


def test_large_grid_in_blocks(monkeypatch):
    whole = dx.scene(SMALL).run().dataset
    monkeypatch.setattr(scene_run, "BLOCK", 5)
    steps = []
    parts = dx.scene(SMALL).run(lambda *step: steps.append(step)).dataset
    assert xarray.testing.assert_identical(parts, whole) is None
    assert [step[:2] for step in steps] == [(0, 2), (1, 2), (2, 2)]


def test_progress(compactor):
    _, _, steps = compactor
    done, total, what = zip(*steps, strict=True)
    assert done == tuple(range(len(steps)))
    assert set(total) == {len(steps) - 1}
    assert what[0] == "values"
    assert what[-1] == ""


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_progress_bar(monkeypatch):
    """It shows up on a terminal after a while, and is silent elsewhere."""
    monkeypatch.setattr(sys, "stderr", Terminal())
    with progress_bar(delay=0.0) as progress:
        progress(3, 7, "values")
        time.sleep(0.5)
    assert "3 of 7 steps" in sys.stderr.getvalue()
    monkeypatch.setattr(sys, "stderr", Terminal())
    with progress_bar() as progress:
        progress(3, 7, "values")
    assert sys.stderr.getvalue() == ""
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    with progress_bar(delay=0.0) as progress:
        assert progress is None


@pytest.mark.parametrize("text", ["29.5 rad/s", "-20.2 m/s", "-7740 rad/s2", "-994 m/s2"])
def test_test_cases_of_paper_a(compactor, text):
    """Printed and computed stand side by side, and agree."""
    line = next(line for line in str(compactor[1]).splitlines() if text in line)
    assert line.count(text) == 2
    assert line.endswith("agrees")


def test_checks(compactor):
    found = {result.check.quantity: result for result in compactor[1].checks}
    assert found["a_C"].computed == pytest.approx(-993.6, abs=0.05)
    assert all(result.agrees for result in found.values())


def test_peaks(compactor):
    absolute, largest, velocity = (found.dataset for found in compactor[1].peaks)
    theta = np.linspace(0, 2 * np.pi, 20001)
    for ec in (0.15, 0.22):
        point = {"theta": theta, "ec": ec, "AB": 0.125, "BC": 0.35, "omega0": 50 * math.pi}
        swept = dx.evaluate(["V_C", "a_C"], **point)
        assert float(absolute.value.sel(ec=ec)) == pytest.approx(np.abs(swept["a_C"]).max(), rel=1e-6)
        assert float(largest.value.sel(ec=ec)) == pytest.approx(swept["a_C"].max(), rel=1e-6)
        assert float(velocity.value.sel(ec=ec)) == pytest.approx(np.abs(swept["V_C"]).max(), rel=1e-6)
    assert absolute.value_wrt_ec.units == "1/s^2"
    step = 1e-6
    design = {"AB": 0.125, "BC": 0.35, "omega0": 50 * math.pi}
    near = dx.peak("a_C", ec=np.array([0.15 - step, 0.15 + step]), **design)["value"]
    assert float(absolute.value_wrt_ec.sel(ec=0.15)) == pytest.approx(
        (near[1] - near[0]) / (2 * step), rel=1e-6
    )


def test_claims(compactor):
    absolute, largest, velocity = (found.claims[0] for found in compactor[1].peaks)
    assert absolute.computed == pytest.approx(9.99, abs=0.005)
    assert largest.computed == pytest.approx(95.38, abs=0.005)
    assert velocity.computed == pytest.approx(33.37, abs=0.005)
    assert (absolute.agrees, largest.agrees, velocity.agrees) == (False, False, True)


def test_two_angles_share_a_peak_at_ec_0(compactor):
    """There is a kink over ec: one angle's derivative is +, the other's -."""
    absolute, largest, velocity = compactor[1].peaks
    assert not absolute.mirrored.any()
    for found in (largest, velocity):
        assert found.mirrored.tolist() == [True, *[False] * 9]
    assert "+-20.55" in str(compactor[1])


def test_peak_over_two_axes_and_part_of_a_turn():
    peak = {
        "quantity": "V_C",
        "kind": "min",
        "over": {"BC": [0.3, 0.4], "AB": [0.1, 0.11, 0.12]},
        "theta": [0, 1],
    }
    data = {**changed("mechanism.ec", 0.01), "outputs": [], "peak": [peak]}
    result = dx.scene(data).run()
    found = result.peaks[0].dataset
    assert dict(found.sizes) == {"BC": 2, "AB": 3}
    point = {"theta": 1.0, "ec": 0.01, "AB": 0.12, "BC": 0.4, "omega0": 50 * math.pi}
    assert float(found.value[1, 2]) == pytest.approx(dx.evaluate("V_C", **point))
    assert result.dataset is None
    assert "(theta from 0 to 57.2958 deg)" in str(result)


def test_feasibility(compactor):
    found = compactor[1].feasibility
    assert (found.turning, found.designs) == (23, 24)
    assert found.limit == pytest.approx(0.225)
    (bad,) = found.infeasible
    assert bad.design["ec"] == 0.23
    (low, high) = bad.gaps[0]
    assert math.degrees(low) == pytest.approx(73.74, abs=0.005)
    assert math.degrees(high) == pytest.approx(106.26, abs=0.005)
    text = str(compactor[1])
    assert "|ec| < BC - AB = 0.225 m" in text
    assert "ec = 0.23 m cannot be assembled for theta from 73.74 to 106.26 deg" in text


@pytest.mark.parametrize(
    ("mechanism", "words"),
    [
        ({"ec": 0, "AB": 0.4, "BC": 0.3}, "no ec, since BC <= AB"),
        ({"ec": -0.05, "AB": 0.1, "BC": 0.12}, "theta from 224.43 to 315.57 deg"),
        ({"ec": 1, "AB": 0.1, "BC": 0.3}, "cannot be assembled at any angle"),
        ({"ec": 0, "AB": 0.3, "BC": 0.2}, "theta from 41.81 to 138.19 and 221.81 to 318.19 deg"),
        ({"ec": [0.3, 0.4], "AB": [0.1, 0.2, 0.3], "BC": 0.35}, "and 1 more"),
        ({"ec": 0.01, "AB": 0.1, "BC": 0.3}, "1 of 1 designs of this scene turn fully"),
    ],
)
def test_feasibility_in_words(mechanism, words):
    assert words in str(dx.scene({**SMALL, "mechanism": mechanism}).run())


def test_files(compactor):
    folder, result, _ = compactor
    names = ["out/compactor.nc", "out/compactor.png", "out/compactor_infeasible.png"]
    assert [path.as_posix() for path in result.files] == names
    assert sorted(path.name for path in (folder / "out").iterdir()) == sorted(
        Path(name).name for name in names
    )
    text = str(result)
    for name in names:
        assert name in text
        assert (folder / name).stat().st_size > 1000


def test_data_file_holds_everything(compactor):
    folder, result, _ = compactor
    path = folder / "out" / "compactor.nc"
    with xarray.open_dataset(path, engine="h5netcdf") as dataset:
        xarray.testing.assert_equal(dataset.load(), result.dataset)
        assert dataset.a_C.units == "m/s^2"
        assert dataset.status.flag_meanings.startswith("ok ")
        assert np.isnan(dataset.a_C.sel(ec=0.23)).any()
    for group, found in zip(["absmax_a_C", "max_a_C", "absmax_V_C"], result.peaks, strict=True):
        with xarray.open_dataset(path, engine="h5netcdf", group=f"peak_{group}") as dataset:
            again = dataset.rename({f"peak_{name}": name for name in found.dataset.dims})
            xarray.testing.assert_equal(again.load(), found.dataset)
            assert dataset.attrs["quantity"] == found.peak.quantity


def test_data_file_opens_as_a_tree(compactor):
    with xarray.open_datatree(compactor[0] / "out" / "compactor.nc", engine="h5netcdf") as tree:
        assert set(tree.children) == {"peak_absmax_a_C", "peak_max_a_C", "peak_absmax_V_C"}
        assert tree["a_C"].sel(ec=0.03).shape == (721,)


def test_report_fits_a_terminal(compactor):
    lines = str(compactor[1]).splitlines()
    assert max(map(len, lines)) <= 100
    assert not [line for line in lines if line != line.rstrip()]
    assert str(compactor[1]).isascii()


def test_long_table_is_thinned():
    over = {"ec": {"start": 0, "stop": 0.2, "num": 101}}
    text = str(dx.scene({**SMALL, "outputs": [], "peak": [{"quantity": "a_C", "over": over}]}).run())
    assert "24 of 101 designs are shown" in text
    assert len(text.splitlines()) < 40


def test_infeasible_peaks_are_told():
    peak = {"quantity": "a_C", "over": {"ec": [0.1, 0.23, 9.0]}}
    text = str(dx.scene({**SMALL, "outputs": [], "peak": [peak]}).run())
    assert "1 cannot be assembled at any of these angles" in text
    assert "1 reached at a limit angle or change point" in text


def test_files_are_whole_or_not_there(tmp_path, monkeypatch):
    """An interrupted run leaves the old file as it was."""
    monkeypatch.chdir(tmp_path)
    scene = dx.scene({**SMALL, "results": {"data": "values.nc"}})
    scene.run()
    before = Path("values.nc").read_bytes()

    def interrupted(self, *arguments, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr(xarray.Dataset, "to_netcdf", interrupted)
    with pytest.raises(KeyboardInterrupt):
        scene.run()
    assert Path("values.nc").read_bytes() == before
    assert [path.name for path in tmp_path.iterdir()] == ["values.nc"]
