"""The command line as people use it."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import desaxe as dx
from benchmarks.accuracy import freeze
from desaxe.cli import accuracy, cache, command, doctor, main
from desaxe.mechanism.inputs import INPUTS

COMPACTOR = str(Path(__file__).parents[2] / "examples" / "compactor.toml")
POINT = ["theta=60deg", "ec=10mm", "AB=125mm", "BC=300mm", "omega0=1500rpm"]
COMMANDS = [
    "point",
    "scene",
    "run",
    "explain",
    "compile",
    "explore",
    "fit",
    "derive",
    "doctor",
]


@pytest.fixture
def told(capsys):
    """The output of a command line that succeeds."""

    def run(*words):
        assert main([*words]) == 0
        out, err = capsys.readouterr()
        assert err == ""
        return out

    return run


def test_point(told):
    out = told("point", "a_C", *POINT)
    name, value, unit, meaning = re.fullmatch(r"(\S+) = (\S+) (\S+) +(.*)\n", out).groups()
    point = {"theta": "60 deg", "ec": 0.01, "AB": 0.125, "BC": 0.3, "omega0": "1500 rpm"}
    assert (name, unit, meaning) == ("a_C", "m/s^2", "acceleration of the slider")
    assert float(value) == pytest.approx(dx.evaluate("a_C", **point), rel=1e-15)
    assert told("point", "a_C", *(word.replace("=", " = ") for word in POINT)) == out


def test_point_with_several_names(told):
    lines = told("point", "V_C,a_C", *POINT, "a_C_wrt_ec").splitlines()
    assert [line.split()[0] for line in lines] == ["V_C", "a_C", "a_C_wrt_ec"]
    starts = {re.search(r" {3}\w", line).start() for line in lines}
    assert len(starts) == 1


def test_point_needs_only_what_is_needed(told):
    found = told("point", "margin", "ec=220mm", "AB=.125", "BC=0.35")
    assert found.startswith("margin = 0.00499999999999")


STUCK = ["theta=90deg", "ec=.23", "AB=.125", "BC=.35", "omega0=1"]


def test_point_tells_the_status_in_words(told):
    out = told("point", "a_C", *STUCK)
    assert out.startswith("a_C = nan m/s^2")
    assert out.endswith("status 1: cannot be assembled here\n")
    assert told("point", "status", *STUCK).startswith("status = 1   ")


def test_point_in_json(told):
    found = json.loads(told("point", "a_C", *POINT, "--json"))
    assert found["a_C"]["unit"] == "m/s^2"
    assert found["a_C"]["value"] == pytest.approx(-810.4, abs=0.05)
    found = json.loads(told("point", "a_C", *STUCK, "--json"))
    assert found["a_C"]["value"] is None
    told_of = {"value": 1, "unit": "1", "meaning": "cannot be assembled here"}
    assert found["status"] == told_of
    assert json.loads(told("point", "status", *STUCK, "--json")) == {"status": told_of}
    fine = json.loads(told("point", "a_C", "status", *POINT, "--json"))
    assert fine["status"] == {"value": 0, "unit": "1", "meaning": "ok"}


def test_options_of_point_stand_anywhere(told):
    words = ["a_C", *POINT]
    texts = {told("point", *words[:place], "--json", *words[place:]) for place in range(len(words) + 1)}
    assert len(texts) == 1


def test_point_with_branch_and_state(told):
    where = ["theta=1", "ec=0.01", "AB=0.125", "BC=0.3", "branch=-1"]
    value = float(told("point", "a_C", *where, "omega=3", "alpha=2rad/s2").split()[2])
    point = {"theta": 1.0, "ec": 0.01, "AB": 0.125, "BC": 0.3, "omega": 3.0, "alpha": 2.0, "branch": -1}
    assert value == dx.evaluate("a_C", **point)


def test_point_with_masses_and_loads(told):
    loads = ["m_rod=0.5kg", "I_rod=80.6 kg mm2", "r_rod=10cm", "F_Y=-50N", "g_X=9.81m/s2", "mu=0.1"]
    name, _, value, *unit = told("point", "T_in", *POINT, *loads).partition("   ")[0].split()
    point = {"theta": "60 deg", "ec": 0.01, "AB": 0.125, "BC": 0.3, "omega0": "1500 rpm"}
    loads = {"m_rod": 0.5, "I_rod": 80.6e-6, "r_rod": 0.1, "F_Y": -50.0, "g_X": 9.81, "mu": 0.1}
    assert (name, unit) == ("T_in", ["N", "m"])
    assert float(value) == pytest.approx(dx.evaluate("T_in", **point, **loads), rel=1e-15)


def test_forces_without_a_mass_or_a_load_are_told(told):
    with pytest.warns(dx.LoadWarning, match="^T_in: 0, since neither a mass nor a load is given"):
        told("point", "T_in,V_C", "T_in_wrt_ec", *POINT)
    told("point", "T_in", *POINT, "m_slider=0")
    told("point", "V_C", *POINT)


@pytest.mark.parametrize(
    ("speed", "status"),
    [("60rpm", "6: friction: two balances of forces"), ("-60rpm", "5: friction jams: no balance of forces")],
)
def test_point_tells_what_friction_does(speed, status, told):
    design = ["theta=90deg", "ec=20mm", "AB=40mm", "BC=64mm", f"omega0={speed}", "m_slider=1kg"]
    assert told("point", "T_in", *design, "mu=1.5").endswith(f"status {status}\n")
    assert "status" not in told("point", "T_in", *design)


def test_list_of_names(told):
    lines = told("point", "--list").splitlines()
    assert len(lines) == len(dx.quantities())
    assert any(line.startswith("a_C ") and "acceleration of the slider (A (19))" in line for line in lines)


# A command line -> what is said of it; POINT stands for a good point.
COMPLAINTS = {
    "point": "which quantity?",
    "point aC POINT": "unknown quantity 'aC'; did you mean a_C?",
    "point a_C CD=3": "CD=3: no input is called 'CD', there are theta, ec",
    "point a_C rod=3": "no input is called 'rod', did you mean BC, r_rod or m_rod?",
    "point a_C theta = 60deg": "=: an input and its value are one word, such as theta=60deg",
    "point a_C theta=": "theta=: an input and its value are one word",
    "point a_C ec=10 mm": "ec=10 mm: a value and its unit are one word, ec=10mm or",
    "point a_C theta=60 a_c": "unknown quantity 'a_c'; did you mean a_C",
    "compile SCENE -o kern": "but kern.py, for example",
    "compile SCENE -o my-k.py": "my-k.py: Python cannot import a module",
    "point a_C POINT ec=3": "ec=3: ec is given twice",
    "point a_C theta=60deg ec=10mm AB=125mm BC=300mm": "a_C: omega0 is missing",
    "point a_C AB=-1 theta=60deg ec=10mm BC=300mm omega0=1": "it must be a finite length >= 0",
    "point Y theta=[1,2]": "theta=[1,2]: it must be a number",
    "point Y theta=1,5": "theta=1,5: it must be a number",
    "point Y theta=1kg ec=10mm AB=125mm BC=300mm": "it must be a quantity in rad",
    "point T_in POINT m_rod=1 F_Y=5kg": 'in N, such as "50 N"',
    "point T_in POINT m_rod=5N": "it must be a quantity in kg",
    "point T_in POINT m_rod=-5kg": "it must be a finite mass >= 0",
    "point T_in POINT m_rod=1 mu=0.1N": "a plain number, such as 0.1",
    "point Y branch=2": "branch=2: it is 1 or -1",
    "point --exact": "unrecognized arguments: --exact",
    "frobnicate": "invalid choice: 'frobnicate'",
    "pont": "'pont' (did you mean point? choose from",
    "run": "required: SCENE (see desaxe run --help)",
    "run missing.toml": "missing.toml: No such file or directory",
}


@pytest.mark.parametrize("line", COMPLAINTS)
def test_complaint(line, capsys):
    assert main(line.replace("POINT", " ".join(POINT)).replace("SCENE", COMPACTOR).split()) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("desaxe: error: ")
    assert COMPLAINTS[line] in err
    assert err.count("\n") == 1


def test_scene_that_is_wrong(tmp_path, capsys):
    path = tmp_path / "press.toml"
    path.write_text('outputs = ["a_C"]\n[mechanism]\nec = { start = 0, stop = "3 kg", num = 3 }\n')
    assert main(["run", str(path)]) == 2
    err = capsys.readouterr().err
    assert 'press.toml: mechanism.ec.stop = "3 kg": it must be a quantity in m' in err
    assert err.count("\n") == 1


def test_scene_that_is_fine(tmp_path, capsys):
    assert main(["scene", COMPACTOR]) == 0
    assert capsys.readouterr().out == f"{COMPACTOR}: OK (outputs: V_C, a_C, omega_BC, alpha_BC)\n"
    assert main(["scene"]) == 2
    assert "give the path of a file, or --schema" in capsys.readouterr().err
    wrong = tmp_path / "wrong.toml"
    wrong.write_text('outputs = ["a_D"]', encoding="utf-8")
    assert main(["scene", str(wrong)]) == 2
    assert "did you mean" in capsys.readouterr().err


def test_explain(told):
    assert told("explain", COMPACTOR) == f"{dx.explain(COMPACTOR)}\n"
    assert json.loads(told("explain", COMPACTOR, "--json"))["operations"]["per_point"] > 0


def test_compile(tmp_path, told):
    place = tmp_path / "kernels.py"
    out = told("compile", COMPACTOR, "-o", str(place))
    text = place.read_text(encoding="utf-8")
    assert out == f"{place}: {len(text.splitlines())} lines\n"
    compile(text, "kernels.py", "exec")
    (tmp_path / "new").touch()
    assert place.stat().st_mode == (tmp_path / "new").stat().st_mode


def test_run(tmp_path, monkeypatch, told):
    monkeypatch.chdir(tmp_path)
    out = told("run", COMPACTOR)
    for text in ("29.5 rad/s", "-20.2 m/s", "-7740 rad/s2", "-994 m/s2"):
        assert out.count(text) == 2
    assert "Written\n  out/compactor.nc" in out.replace(os.sep, "/")
    assert (tmp_path / "out" / "compactor.nc").exists()


@pytest.mark.parametrize("command", [(), *((name,) for name in COMMANDS)])
def test_help(command, told):
    out = told(*command, "--help")
    assert out.startswith("usage: ")
    assert max(map(len, out.splitlines())) <= 100


def test_help_of_derive_calls_itself_by_its_name(told):
    out = told("derive", "--help")
    assert out.startswith("usage: desaxe derive [-h] [--check] [--report]")
    assert "python -m" not in out


def test_a_name_that_is_a_unit_too_may_follow_a_number(told):
    assert told("point", "theta=60deg", "s", *POINT[1:]).startswith("s = ")


def test_help_has_signs_and_examples(told):
    out = told("point", "--help")
    assert "V_C and a_C are positive along +Y" in out
    assert "desaxe point a_C theta=60deg ec=10mm AB=125mm BC=300mm omega0=1500rpm" in out
    assert "5 friction jams" in out


@pytest.mark.parametrize("command", ["point", "run"])
def test_help_names_all_inputs(command, told):
    assert set(re.findall(r"\w+", told(command, "--help"))) >= set(INPUTS)


def test_no_command_gives_help(told):
    out = told()
    assert all(f"    {command} " in out for command in COMMANDS)


def test_version(told):
    assert told("--version") == f"desaxe {dx.__version__}\n"


def test_derive_hands_its_options_on(monkeypatch):
    given = []

    class Fake:
        @staticmethod
        def main(words):
            given.append(words)
            return 7

    monkeypatch.setitem(sys.modules, "desaxe.derive.__main__", Fake)
    assert main(["derive", "--check", "-o", "x"]) == 7
    assert given == [["--check", "-o", "x"]]


@pytest.mark.parametrize(
    ("stopped", "code", "line"),
    [
        (KeyboardInterrupt(), 130, "desaxe: interrupted"),
        (KeyboardInterrupt("a.zarr: 2 of 3"), 130, "desaxe: interrupted: a.zarr: 2 of 3"),
        (command.Terminated("a.zarr: 2 of 3"), 143, "desaxe: terminated: a.zarr: 2 of 3"),
    ],
)
def test_interruption_is_no_traceback(monkeypatch, capsys, stopped, code, line):
    def interrupted(words):
        raise stopped

    monkeypatch.setattr(command, "_run", interrupted)
    assert main(["point"]) == code
    assert capsys.readouterr().err == f"{line}\n"


# ---- real processes ------------------------------------------------------------------------------


def desaxe(*words, **options):
    command = [sys.executable, "-m", "desaxe.cli", *words]
    return subprocess.run(command, capture_output=True, text=True, check=False, **options)


def test_process(tmp_path):
    done = desaxe("point", "a_C", *POINT, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("a_C = -810.39")
    done = desaxe("point", "a_C", "theta=1", cwd=tmp_path)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr


def test_start_is_light():
    """One point with plain numbers loads neither NumPy nor any optional dependency."""
    heavy = ("numpy", "numba", "pint", "msgspec", "xarray", "matplotlib", "sympy", "tqdm")
    code = f"""
import sys
from desaxe.cli import main
code = main(["point", "a_C", "theta=1", "ec=0", "AB=1", "BC=3", "omega0=1"])
print([name for name in {heavy!r} if name in sys.modules])
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"


def test_broken_pipe():
    """Whoever reads our output may stop reading."""
    read, write = os.pipe()
    os.close(read)
    code = [sys.executable, "-m", "desaxe.cli", "point", "--list"]
    with os.fdopen(write, "w") as closed:
        done = subprocess.run(code, stdout=closed, stderr=subprocess.PIPE, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


def test_closed_output(tmp_path):
    """What is written to files is there, what cannot be shown is an error in a line."""
    (tmp_path / "a.toml").write_text(
        'outputs = ["Y"]\n[mechanism]\nec = 0\nAB = 1\nBC = 3\n[motion]\ntheta = [0, 1]\n'
        '[results]\ndata = "a.npz"\n'
    )
    point = ["point", "a_C", "theta=1", "ec=0", "AB=1", "BC=3", "omega0=1"]
    for words in (point, ["run", "a.toml"]):
        code = ["sh", "-c", 'exec "$@" >&-', "sh", sys.executable, "-m", "desaxe.cli", *words]
        done = subprocess.run(code, stderr=subprocess.PIPE, text=True, check=False, cwd=tmp_path)
        assert (done.returncode, done.stderr) == (2, "desaxe: error: standard output: it is closed\n")
    with np.load(tmp_path / "a.npz") as values:
        assert values["Y"].tolist() == dx.evaluate("Y", theta=[0.0, 1.0], ec=0.0, AB=1.0, BC=3.0).tolist()


def test_missing_extra():
    code = f"""
import sys
sys.modules["msgspec"] = None
from desaxe.cli import main
sys.exit(main(["run", {COMPACTOR!r}]))
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr == "desaxe: error: desaxe run needs msgspec: python -m pip install 'desaxe[scene]'\n"


@pytest.mark.parametrize(
    ("words", "module", "told"),
    [
        (
            ["scene", "--schema"],
            "msgspec",
            "desaxe scene needs msgspec: python -m pip install 'desaxe[scene]'",
        ),
        (["derive", "--check"], "sympy", "desaxe derive needs sympy: python -m pip install 'desaxe[derive]'"),
    ],
)
def test_a_bare_install_says_what_to_install(words, module, told):
    code = (
        f"import sys; sys.modules[{module!r}] = None; from desaxe.cli import main; sys.exit(main({words!r}))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1] == f"desaxe: error: {told}"


# ---- doctor --------------------------------------------------------------------------------------


def test_doctor(capsys):
    assert main(["doctor"]) == 0
    out = capsys.readouterr().out
    assert f"place        {Path(dx.__file__).parent}\n" in out
    assert max(len(line) for line in out.splitlines() if "/" not in line) <= 100
    for word in ("numba", "llvmlite", "xarray", "folder", "threads", "freshness", "arrays"):
        assert f"\n  {word} " in out
    assert out.endswith("desaxe can be used.\n")


def test_doctor_where_something_is_missing(monkeypatch):
    real = doctor.version

    def version(name):
        if name in ("pint", "numba"):
            raise doctor.PackageNotFoundError(name)
        return real(name)

    monkeypatch.setattr(doctor, "version", version)
    found = doctor.examine()
    assert "missing: python -m pip install 'desaxe[units]'" in found.text
    assert not found.usable


def test_doctor_where_nothing_compiles(monkeypatch):
    def broken(*args, **inputs):
        raise RuntimeError("no LLVM")

    monkeypatch.setattr(doctor, "evaluate", broken)
    found = doctor.examine()
    assert "arrays       FAILED: RuntimeError: no LLVM" in found.text
    assert not found.usable


def test_doctor_compares_with_the_truth(monkeypatch):
    found = doctor.examine(accuracy=True)
    assert found.usable
    assert len(re.findall(r"200 frozen truths: 0\.\d+ of the promised error at most", found.text)) == 2
    wrong = [*accuracy.truths()]
    wrong[7] = wrong[7]._replace(value=wrong[7].value * (1 + 2.0**-40))
    monkeypatch.setattr(accuracy, "truths", lambda: wrong)
    assert not doctor.examine(accuracy=True).usable


def test_frozen_truths_are_fresh():
    assert freeze.TABLE.read_text(encoding="utf-8") == freeze.text(), freeze.__doc__


def test_the_cache_is_listed_without_its_locks(tmp_path, capsys):
    for ending in ("code", "lock"):
        (tmp_path / f"kernel_{'0' * 40}.{ending}").touch()
    cache._list(tmp_path)
    text = capsys.readouterr().out
    assert ".lock" not in text
    assert "1 files, " in text
