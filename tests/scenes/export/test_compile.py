"""Compiled modules: they run without desaxe, give what desaxe gives, and are the same every time."""

import inspect
import math
import os
import pickle
import re
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import mpmath
import numpy as np
import pytest

import desaxe as dx
from desaxe.scenes.export.compile import generated
from desaxe.scenes.export.fmu.write import texts_of_fmu
from desaxe.scenes.schema import SceneError
from desaxe.support.files import locked
from tests.compiler.languages.tools import imported
from tests.effort import first
from tests.example_scenes import COMPACTOR, SMALL

TURN = {"start": 0, "stop": "360 deg", "num": 121}
GRID = {
    "title": 'A press \\ with """ in its title',
    "outputs": ["V_C", "a_C_wrt_ec"],
    "mechanism": {"ec": [0, 0.1, 0.24], "AB": 0.125, "BC": {"start": 0.35, "stop": 0.4, "num": 7}},
    "motion": {"theta": TURN, "omega0": 157.08, "alpha": 3},
}
REDUCED = {**GRID, "outputs": ["a_C"], "reduce": {"theta": ["absmax", "min", "mean", "rms"]}}
STATE = {
    "outputs": ["a_C_wrt_omega", "phi"],
    "mechanism": {"ec": 0.01, "AB": 0.125, "BC": 0.35},
    "motion": {"theta": TURN, "omega": [10, 20], "alpha": 2},
}
FORCES = {
    "outputs": ["T_in", "N_C"],
    "mechanism": {"ec": 0.02, "AB": 0.04, "BC": 0.064, "branch": -1},
    "motion": {"theta": TURN, "omega0": 250},
    "masses": {"m_slider": [0.4, 0.8]},
    "loads": {"F_Y": -50, "mu": 0.1},
}
SCENES = {
    "grid": GRID,
    "reduced": REDUCED,
    "state": STATE,
    "forces": FORCES,
    "extended": {**STATE, "accuracy": "extended"},
    "one_axis": {**SMALL, "mechanism": {"ec": 0, "AB": 0.125, "BC": 0.35}},
    "one_row_reduced": {
        **SMALL, "mechanism": {"ec": 0, "AB": 0.125, "BC": 0.35}, "reduce": {"theta": "absmax"}
    },
    "no_axis": {
        **SMALL, "mechanism": {"ec": 0, "AB": 0.125, "BC": 0.35}, "motion": {"theta": 1, "omega0": 2}
    },
    "far": {**STATE, "motion": {"theta": [1e9, 2e9], "omega": 3}},
}  # fmt: skip

SEARCHED = {**SMALL, "peak": [{"quantity": "a_C", "kind": kind} for kind in ("absmax", "max")]}
ALLOWED = {
    "__future__", "concurrent.futures", "inspect", "math", "os", "threading", "typing", "numba", "numba.core",
    "numba.extending", "numpy",
}  # fmt: skip
# Runs in a process of its own, where importing desaxe fails.
ALONE = """
import importlib, pickle, sys
sys.modules["desaxe"] = None
sys.path.insert(0, sys.argv[1])
found = {}
for name, points in pickle.load(sys.stdin.buffer).items():
    module = importlib.import_module("kernels_" + name)
    number = {n: v[0] for n, v in points.items()}
    found[name] = {
        "run": module.run(threads=1) if points else module.run(),
        "arrays": module.evaluate(**points),
        "point": list(module.point(**number)),
        "number": module.evaluate(**number),
        "scalars": [getattr(module, n)(*(number[i] for i in module.INPUTS)) for n in module.OUTPUTS],
    }
pickle.dump(found, sys.stdout.buffer)
"""


def points_of(scene):
    """Sixty random points for every input that the scene leaves open."""
    rng = np.random.default_rng(5)
    axes = {n: v for n, v in dx.scene(scene).inputs.items() if isinstance(v, tuple)}
    return {name: rng.uniform(min(v), max(v), 60) for name, v in axes.items()}


@pytest.fixture(scope="module")
def alone():
    """The results of every module in a process without desaxe, shared by the workers of a test run."""
    folder = Path(os.environ["DESAXE_TESTS_FOLDER"]) / "modules"
    folder.mkdir(exist_ok=True)
    kept = folder / "found"
    with locked(folder, 600.0):  # one worker makes the modules
        if not kept.exists():
            for name, scene in SCENES.items():
                dx.compile(scene, folder / f"kernels_{name}.py")
            points = pickle.dumps({name: points_of(scene) for name, scene in SCENES.items()})
            command = [sys.executable, "-W", "error", "-c", ALONE, str(folder)]
            done = subprocess.run(command, input=points, capture_output=True, check=False)
            assert done.returncode == 0, done.stderr.decode()
            kept.write_bytes(done.stdout)
    return pickle.loads(kept.read_bytes())


def text_of(scene):
    """The text of the module of a scene."""
    (text,) = generated(dx.scene(scene), Path("my_kernels.py")).texts.values()
    return text


def same(result, right):
    """Compare results to rounding: the library runs fewer lines, in another order."""
    scale = np.nanmax(np.abs(right), initial=0.0)
    np.testing.assert_allclose(result, right, rtol=1e-13, atol=1e-14 * scale)


def inputs_of(scene):
    content = dx.scene(scene).content
    fixed = {n: v for n, v in content.inputs.items() if isinstance(v, float)}
    return {**fixed, "branch": content.branch, "accuracy": content.accuracy}


@pytest.mark.thorough
@pytest.mark.parametrize("name", SCENES)
def test_a_module_alone_gives_what_desaxe_gives(name, alone):
    """A run, arrays, a point, and one function for each output, for the @njit functions of others."""
    points, result = points_of(SCENES[name]), alone[name]
    dataset = dx.scene(SCENES[name]).run().dataset
    assert set(result["run"]) == set(dataset.data_vars) - {"margin"}
    for output, values in result["run"].items():
        assert np.shape(values) == dataset[output].shape
        same(values, dataset[output])
    names, fixed = list(result["number"]), inputs_of(SCENES[name])
    many = dx.evaluate(names, **fixed, **points)
    one = dx.evaluate(names, **fixed, **{n: v[0] for n, v in points.items()})
    for output in names:
        same(result["arrays"][output], many[output])
    for way in ("point", "scalars"):
        np.testing.assert_allclose(result[way], [float(one[n]) for n in names], rtol=1e-13)
    assert [float(result["number"][n]) for n in names] == result["point"]


def test_a_function_of_ones_own_calls_them(tmp_path):
    import numba

    module = imported(dx.compile(SCENES["forces"], tmp_path / "kernels_own.py"))
    a, b = module.T_in, module.N_C

    @numba.njit
    def work(mass, angle):
        return a(angle, mass) + b(1, mass)  # a whole number is a number, too

    names, fixed = ["T_in", "N_C"], inputs_of(SCENES["forces"])
    expected = [
        dx.evaluate(n, theta=t, m_slider=0.5, **fixed) for n, t in zip(names, (0.3, 1.0), strict=True)
    ]
    assert module.INPUTS == ("theta", "m_slider")
    assert work(0.5, 0.3) == pytest.approx(sum(expected), rel=1e-13)
    assert np.isnan(a(np.inf, 0.5))


@pytest.mark.parametrize(
    ("written", "rule"),
    [
        ({"start": 0, "stop": "360 deg", "num": 100_001}, "spaced(0.0, 0.0, "),
        ({"start": "-17 deg", "stop": "1 turn", "num": 3601}, "spaced(-0.29"),
        ({"start": 0, "stop": 1, "num": 1025}, "linspace(0.0, 1.0, 1025)"),
        ({"start": 7, "stop": 0.1, "num": 70}, "(7.0, "),
        ([0.1, 0.2, 0.7], "array(["),
        ([0.25, 0.5], "array(["),
    ],
)
def test_ranges_are_written_as_ranges(written, rule, tmp_path):
    """And give the scene's own values, to the last bit."""
    scene = {**SMALL, "mechanism": {"ec": 0, "AB": 0.125, "BC": 0.35}}
    scene = {**scene, "motion": {**scene["motion"], "theta": written}}
    place = dx.compile(scene, tmp_path / "kernels_axes.py")
    assert rule in place.read_text(encoding="utf-8")
    assert place.stat().st_size < 60_000
    np.testing.assert_array_equal(imported(place).AXES["theta"], dx.scene(scene).inputs["theta"])


def test_what_is_left_out_is_told(tmp_path, capsys):
    from desaxe.cli import main

    place = tmp_path / "press.h"
    assert main(["compile", str(COMPACTOR), "--to", "c", "-o", str(tmp_path / "press")]) == 0
    assert "not compiled (`desaxe run` has it): [[peak]] a_C, [[peak]] V_C" in capsys.readouterr().err
    rubbing = {**FORCES, "peak": [{"quantity": "T_in"}, {"quantity": "a_C"}]}
    text = text_of(rubbing)
    assert "Not in here (`desaxe run` has it): [[peak]] T_in." in text
    assert "def peak_absmax_T_in" not in text
    stuck = {**GRID, "peak": [{"quantity": "V_C", "over": {"ec": [0, 0.24], "BC": [0.35]}}]}
    assert "Not in here (`desaxe run` has it): [[peak]] V_C." in text_of(stuck)
    place = tmp_path / "compactor_kernels.py"
    assert main(["compile", str(COMPACTOR), "-o", str(place)]) == 0
    assert "not compiled" not in capsys.readouterr().err
    assert main(["compile", str(COMPACTOR), "-o", str(place), "--check"]) == 0
    place.write_text(place.read_text(encoding="utf-8") + "\n", encoding="utf-8")
    assert main(["compile", str(COMPACTOR), "-o", str(place), "--check"]) == 1
    with pytest.raises(ValueError, match="not what the scene gives"):
        dx.compile(COMPACTOR, place, check=True)


@pytest.mark.thorough
def test_peaks_of_a_scene(tmp_path):
    """Of its own designs and of others, next to a change point too: as `desaxe.peak` has them."""
    module = imported(dx.compile(COMPACTOR, tmp_path / "peak_kernels.py"))
    design = {"AB": 0.125, "BC": 0.35, "omega0": "1500 rpm"}
    ecs = np.array(dx.scene(COMPACTOR).content.peaks[0].axes["ec"])
    near = 0.225 - 2.0 ** -np.arange(8.0, 40.0, 4.0)
    for name, kind, quantity in (
        ("peak_absmax_a_C", "absmax", "a_C"),
        ("peak_max_a_C", "max", "a_C"),
        ("peak_absmax_V_C", "absmax", "V_C"),
    ):
        function = getattr(module, name)
        for result, ec in ((function(), ecs), (function(ec=near, threads=1), near)):
            expected = dx.peak(quantity, ec=ec, kind=kind, **design)
            np.testing.assert_allclose(result["value"], expected["value"], rtol=1e-13)
            np.testing.assert_allclose(
                result["value_wrt_ec"], expected["gradient"]["ec"], rtol=1e-7, atol=1e-6
            )
            assert not result["status"].any()
    with pytest.raises(ValueError, match=r"'ec': 0.23.*cannot turn fully"):
        module.peak_absmax_a_C(ec=[0.0, 0.23])
    text = (tmp_path / "peak_kernels.py").read_text(encoding="utf-8")
    assert "    peak_max_a_C(): maximum of a_C [m/s^2]" in text


def test_reductions_skip_nan_take_the_first_of_equals_and_keep_any_scale(tmp_path):
    """Rows of numbers that no scene has, by the functions of a written module, against exact sums."""
    module = imported(dx.compile(REDUCED, tmp_path / "kernels_rows.py"))
    rows = np.array([
        [3.0, -3.0, math.nan, 3.0], [math.nan] * 4, [-math.inf, math.nan, -math.inf, -math.inf],
        [1e200, -2e200, 1e200, 0.0], [1e-200, 3e-200, 0.0, 2e-200], [1e16, 1.0, -1e16, 1.0],
    ])  # fmt: skip
    places = np.array([0.5, 1.5, 2.5, 3.5])
    result = module.reductions("x", rows, "theta", places, ("max", "min", "absmax", "mean", "rms"))
    for k, row in enumerate(rows.tolist()):
        good = [(value, place) for value, place in zip(row, places, strict=True) if value == value]
        assert result["x_skipped"][k] == len(row) - len(good)
        for kind, score in (("max", float), ("min", lambda x: -x), ("absmax", abs)):
            value, place = max(good, key=lambda pair: score(pair[0]), default=(math.nan, math.nan))
            value = abs(value) if kind == "absmax" else value
            np.testing.assert_array_equal(
                [result[f"x_{kind}"][k], result[f"x_{kind}_theta"][k]], [value, place]
            )
        if good and np.isfinite([value for value, _ in good]).all():
            values = [Fraction(value) for value, _ in good]
            square = mpmath.mpf(sum(v * v for v in values).numerator) / sum(v * v for v in values).denominator
            assert result["x_mean"][k] == pytest.approx(float(sum(values) / len(values)), rel=1e-15)
            assert result["x_rms"][k] == pytest.approx(float(mpmath.sqrt(square / len(values))), rel=1e-15)


# ---- the text ------------------------------------------------------------------------------------


def test_provenance(tmp_path):
    text = dx.compile(COMPACTOR, tmp_path / "compactor_kernels.py").read_text(encoding="utf-8")
    for line in (
        "Paper A: the compactor of Siswanto and Ibrahim: V_C, a_C, omega_BC, alpha_BC.",
        "Generated by `desaxe compile compactor.toml -o compactor_kernels.py`",
        f"desaxe {dx.__version__}, derivation ",
        "inputs   theta [rad]: crank angle",
        "outputs  V_C [m/s]: velocity of the slider",
        "AB = 0.125 m",
        "SPDX-License-Identifier: MIT",
    ):
        assert line in text
    assert "import desaxe" not in text
    assert str(tmp_path) not in text


def test_only_numpy_and_numba_are_imported(tmp_path):
    for name, scene in SCENES.items():
        text = dx.compile(scene, tmp_path / "module.py").read_text(encoding="utf-8")
        lines = [
            line.split()[1] for line in text.splitlines() if line.strip().startswith(("from ", "import "))
        ]
        assert set(lines) <= ALLOWED, name


def test_ruff_finds_nothing_undefined_or_unused(tmp_path):
    """In modules of numba and of jax."""
    for name, scene in {**SCENES, "searched": SEARCHED}.items():
        dx.compile(scene, tmp_path / f"{name}.py")
    for name in ("grid", "state", "forces"):
        dx.compile(SCENES[name], tmp_path / f"{name}_jax.py", to="jax")
    command = [sys.executable, "-m", "ruff", "check", "--isolated", "--select", "F", str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout


@pytest.mark.thorough
def test_bytes_depend_on_the_scene_alone(tmp_path):
    code = "import sys, desaxe as dx; dx.compile(sys.argv[1], sys.argv[2])"
    texts = set()
    for seed in ("0", "1", "2"):
        place = tmp_path / seed / "kernels.py"
        place.parent.mkdir()
        environment = {**os.environ, "PYTHONHASHSEED": seed}
        subprocess.run([sys.executable, "-c", code, str(COMPACTOR), str(place)], env=environment, check=True)
        texts.add(place.read_bytes())
    assert len(texts) == 1


@pytest.mark.parametrize("to", ["numba", "c", "octave", "javascript", "fmu"])
def test_every_number_of_a_table_is_in_the_digest(to, tmp_path):
    """Two tables of one range: a host that caches by the token of an FMU must not take one for the other."""
    suffix, digests = ".py" if to == "numba" else "", set()
    for middle in (-100.0, -100.00000000000001):
        load = dx.over_theta([0.0, 1.0, 3.0], [-500.0, middle, 0.0])
        scene = dx.scene({**SMALL, "outputs": ["T_in"], "masses": {"m_slider": 1.0}, "loads": {"F_Y": load}})
        if to == "fmu":
            text = texts_of_fmu(scene, tmp_path / "press.fmu")["modelDescription.xml"]
        else:
            path = dx.compile(scene, tmp_path / f"{middle}" / f"press{suffix}", to=to)
            text = "".join(
                p.read_text(encoding="utf-8") for p in sorted(path.parent.rglob("*")) if p.is_file()
            )
        digests |= set(re.findall(r'scene ([0-9a-f]{16})|guid="\{(.*?)\}', text))
    assert len(digests) == 2


def test_fixed_values_are_folded_in(tmp_path):
    path = dx.compile(SCENES["one_axis"], tmp_path / "m.py")
    text = path.read_text(encoding="utf-8")
    assert "def point(theta):" in text
    assert str(inspect.signature(imported(path).evaluate)) == "(theta, out=None, threads=None)"
    assert "ec" not in text[text.index("def stable(theta, sin_theta, cos_theta, branch):") :].split()
    assert "AB *" not in text


@pytest.mark.thorough
def test_an_angle_of_any_size_is_taken(tmp_path):
    module = imported(dx.compile(SCENES["one_axis"], tmp_path / "kernels_reach.py"))
    angles = np.array([1.0, 1e12, 2e6, np.nan, np.inf])
    result = module.evaluate(angles)
    right = dx.evaluate(list(module.OUTPUTS), theta=angles, **inputs_of(SCENES["one_axis"]))
    for name in module.OUTPUTS:
        np.testing.assert_allclose(result[name], right[name], rtol=1e-13)
    assert result["status"].tolist() == [0, 0, 0, 4, 4]
    for text in ("60 deg", ["60 deg", "61 deg"]):
        with pytest.raises(TypeError, match="theta: expected real numbers, got <U6"):
            module.evaluate(text)


@pytest.mark.parametrize(
    ("name", "better"),
    [
        ("kern", "kern.py"),
        ("my-k.py", "my_k.py"),
        ("2d.py", "kernels_2d.py"),
        ("class.py", "kernels_class.py"),
    ],
)
def test_a_name_that_python_cannot_import(name, better, tmp_path):
    with pytest.raises(ValueError, match=rf"{name}: Python cannot import .*, but {better}, for example"):
        dx.compile(SMALL, tmp_path / name)
    assert not list(tmp_path.iterdir())


def test_a_scene_without_outputs(tmp_path):
    with pytest.raises(SceneError, match=r"nothing to compile.* \[\[peak\]\] a_C is searched for by"):
        dx.compile({**SMALL, "outputs": [], "peak": [{"quantity": "a_C"}]}, tmp_path / "m.py")
    assert not list(tmp_path.iterdir())


@pytest.mark.thorough
@pytest.mark.parametrize("name", first(1, ["grid", "reduced", "one_axis"]))
def test_run_takes_other_axes(name, tmp_path):
    """The axes of the scene are only what holds where none are given."""
    module = imported(dx.compile(SCENES[name], tmp_path / f"axes_{name}.py"))
    own, theta = module.run(), np.linspace(0.3, 2.0, 5)
    result = module.run(theta=theta)
    other = {**SCENES[name], "motion": {**SCENES[name]["motion"], "theta": theta.tolist()}}
    dataset = dx.scene(other).run().dataset
    for key, values in result.items():
        if key in dataset:
            np.testing.assert_allclose(values, dataset[key].values, rtol=1e-12)
    one = module.run(theta=0.3)
    assert [values.shape for values in module.run().values()] == [values.shape for values in own.values()]
    if name == "grid":
        assert result["V_C"].shape == (3, 7, 5)
        np.testing.assert_array_equal(one["V_C"][..., 0], result["V_C"][..., 0])
        assert module.run(ec=[0.01], theta=theta)["V_C"].shape == (1, 7, 5)
        with pytest.raises(TypeError, match="ec: expected real numbers, got <U4"):
            module.run(ec="1 mm")
        with pytest.raises(ValueError, match="ec: expected a number or one dimension"):
            module.run(ec=[[0.0]])


LISTS = {
    "outputs": ["a_C"],
    "mechanism": {"ec": [0.01, 0.02], "AB": [0.04, 0.05], "BC": [0.1, 0.2]},
    "motion": {"theta": [0.0, 1.0], "omega0": [3.0, 4.0], "alpha": [1.0, 2.0]},
}
LOADED = {"masses": {"m_slider": [1.0, 2.0]}, "loads": {"F_Y": [-50.0, -60.0], "mu": [0.05, 0.1]}}
MASS = {**LISTS, "outputs": ["T_in"], "masses": {"m_slider": 2}}
OVER_THETA = dx.over_theta([0.0, 2.0, 4.0], [-50.0, -200.0, -80.0], kind="linear")
OVER_Y = dx.over_Y([0.0, 0.1, 0.3], [-50.0, -200.0, -80.0], [0.0, 0.0, -10.0])
BAD = {
    "motion": LISTS,
    "a given state": {**LISTS, "motion": {"theta": [0.0, 1.0], "omega": [3.0, 4.0]}},
    "forces": {**LISTS, "outputs": ["T_in"], **LOADED},
    "twice the digits": {**LISTS, "accuracy": "extended"},
    "a load over theta": {**MASS, "loads": {"F_Y": OVER_THETA}},
    "a load over Y": {**MASS, "loads": {"F_Y": OVER_Y}},
}  # fmt: skip


@pytest.mark.thorough
@pytest.mark.parametrize("scene", BAD.values(), ids=BAD)
def test_every_bad_input_is_status_4(scene, tmp_path):
    """NaN, an infinity, a length below zero: of a point, a number and an element, as `evaluate` says."""
    module = imported(dx.compile(scene, tmp_path / "press.py"))
    (output,) = scene["outputs"]
    good = {name: float(value[0]) for name, value in points_of(scene).items()}
    place = list(module.OUTPUTS).index("status")
    for name in module.INPUTS:
        for value in (math.nan, math.inf, -math.inf, *([-0.1] if name in ("AB", "BC", "m_slider") else [])):
            inputs = [{**good, name: value}[n] for n in module.INPUTS]
            rows = [np.array([bad, good[n]]) for n, bad in zip(module.INPUTS, inputs, strict=True)]
            alone, number, array = module.point(*inputs), module.evaluate(*inputs), module.evaluate(*rows)
            assert (alone[place], number["status"], *array["status"]) == (4, 4, 4, 0), (name, value)
            assert math.isnan(number[output])
            assert np.isnan(array[output]).tolist() == [True, False]
