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
from desaxe.cli import command, doctor, main
from desaxe.mechanism.inputs import INPUTS

COMPACTOR = str(Path(__file__).parents[2] / "examples" / "compactor.toml")
POINT = ["theta=60deg", "ec=10mm", "AB=125mm", "BC=300mm", "omega0=1500rpm"]
COMMANDS = [
    "evaluate",
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
def message(capsys):
    """The output of a command line that succeeds."""

    def run(*words):
        assert main([*words]) == 0
        out, err = capsys.readouterr()
        assert err == ""
        return out

    return run


def test_a_point(message):
    out = message("evaluate", "a_C", *POINT)
    assert out == "a_C     -810.395 m/s^2\nstatus  0\n"
    assert message("evaluate", "a_C", *(word.replace("=", " = ") for word in POINT)) == out
    lines = message("evaluate", "V_C,a_C", *POINT, "a_C_wrt_ec").splitlines()
    assert [line.split()[0] for line in lines] == ["V_C", "a_C", "a_C_wrt_ec", "status"]
    assert message("evaluate", "margin", "ec=210mm", "AB=.125", "BC=0.35") == "margin  0.015 m\nstatus  0\n"
    assert message("evaluate", "stroke", "ec=0", "AB=.125", "BC=0.35").startswith("stroke  0.25 m\n")


STUCK = ["theta=90deg", "ec=.23", "AB=.125", "BC=.35", "omega0=1"]


def test_a_point_has_its_status_also_in_json(message):
    out = message("evaluate", "a_C", *STUCK)
    assert out == "a_C     nan\nstatus  1: cannot be assembled here\n"
    result = json.loads(message("evaluate", "a_C", *STUCK, "--json"))
    assert result == {"a_C": None, "status": 1, "units": {"a_C": "m/s^2"}}
    result = json.loads(message("evaluate", "a_C", *POINT, "--json"))
    assert result.keys() == {"a_C", "status", "units"}
    point = {"theta": "60 deg", "ec": 0.01, "AB": 0.125, "BC": 0.3, "omega0": "1500 rpm"}
    assert (result["a_C"], result["status"]) == (dx.evaluate("a_C", **point), 0)


def test_options_of_a_call_stand_anywhere(message):
    words = ["a_C", *POINT]
    texts = {message("evaluate", *words[:k], "--json", *words[k:]) for k in range(len(words) + 1)}
    assert len(texts) == 1


POINTS = {
    "a_C theta=1 ec=0.01 AB=0.125 BC=0.3 branch=-1 omega=3 alpha=2rad/s2": {
        "theta": 1.0, "ec": 0.01, "AB": 0.125, "BC": 0.3, "omega": 3.0, "alpha": 2.0, "branch": -1,
    },
    "T_in theta=60deg ec=10mm AB=125mm BC=300mm omega0=1500rpm m_rod=0.5kg I_rod=80.6kgmm2 r_rod=10cm "
    "F_Y=-50N g_X=9.81m/s2 mu=0.1": {
        "theta": "60 deg", "ec": 0.01, "AB": 0.125, "BC": 0.3, "omega0": "1500 rpm", "m_rod": 0.5,
        "I_rod": 80.6e-6, "r_rod": 0.1, "F_Y": -50.0, "g_X": 9.81, "mu": 0.1,
    },
}  # fmt: skip


@pytest.mark.parametrize("line", POINTS)
def test_a_point_is_that_of_the_function(line, message):
    name, *words = line.replace("kgmm2", " kg mm2").replace(" kg mm2", "_kg_mm2").split()
    words = [word.replace("_kg_mm2", " kg mm2") for word in words]
    assert json.loads(message("evaluate", name, *words, "--json"))[name] == dx.evaluate(name, **POINTS[line])


def test_forces_without_a_mass_or_a_load_are_told(message):
    with pytest.warns(dx.LoadWarning, match="^T_in: 0, since neither a mass nor a load is given"):
        message("evaluate", "T_in,V_C", "T_in_wrt_ec", *POINT)
    message("evaluate", "T_in", *POINT, "m_slider=0")
    message("evaluate", "V_C", *POINT)


@pytest.mark.parametrize(
    ("speed", "status"),
    [("60rpm", "6: friction: two balances of forces"), ("-60rpm", "5: friction jams: no balance of forces")],
)
def test_a_point_tells_what_friction_does(speed, status, message):
    design = ["theta=90deg", "ec=20mm", "AB=40mm", "BC=64mm", f"omega0={speed}", "m_slider=1kg"]
    assert message("evaluate", "T_in", *design, "mu=1.5").endswith(f"status  {status}\n")
    assert message("evaluate", "T_in", *design).endswith("status  0\n")


def test_list_of_names(message):
    lines = message("evaluate", "--list").splitlines()
    assert len(lines) == len(dx.quantities())
    assert any(line.startswith("a_C ") and "acceleration of the slider (A (19))" in line for line in lines)


# A command line -> what is said of it; POINT stands for a good point.
COMPLAINTS = {
    "evaluate": "which quantity?",
    "evaluate aC POINT": "unknown quantity 'aC'; did you mean a_C?",
    "evaluate a_C CD=3": "evaluate() has no input 'CD'; there are theta, ec",
    "evaluate a_C rod=3": "evaluate() has no input 'rod'; did you mean",
    "evaluate a_C theta = 60deg": "=: an input and its value are one word, such as theta=60deg",
    "evaluate a_C theta=": "theta=: an input and its value are one word",
    "evaluate a_C ec=10 mm": "ec=10 mm: a value and its unit are one word, ec=10mm or",
    "evaluate a_C theta=60 a_c": "unknown quantity 'a_c'; did you mean a_C",
    "compile SCENE -o kern": "but kern.py, for example",
    "compile SCENE -o my-k.py": "my-k.py: Python cannot import a module",
    "evaluate a_C POINT ec=3": "ec=3: ec is given twice",
    "evaluate a_C theta=60deg ec=10mm AB=125mm BC=300mm": "a_C: omega0 is missing",
    "evaluate a_C AB=-1 theta=60deg ec=10mm BC=300mm omega0=1": "it must be a finite length >= 0",
    "evaluate Y theta=[1,2] ec=0 AB=1 BC=3": "theta = '[1': it must be a number",
    "evaluate Y theta=1;5": "theta = '1;5': it must be a number",
    "evaluate Y theta=1kg ec=10mm AB=125mm BC=300mm": "it must be a quantity in rad",
    "evaluate T_in POINT m_rod=1 F_Y=5kg": 'in N, such as "50 N"',
    "evaluate T_in POINT m_rod=5N": "it must be a quantity in kg",
    "evaluate T_in POINT m_rod=-5kg": "it must be a finite mass >= 0",
    "evaluate T_in POINT m_rod=1 mu=0.1N": "a plain number, such as 0.1",
    "evaluate Y branch=2 theta=1 ec=0 AB=1 BC=3": "branch = 2: it is +1 or -1",
    "evaluate --exact": "unrecognized arguments: --exact",
    "peak a_C POINT --unit mm": "unrecognized arguments: --unit; did you mean --units? (see desaxe peak",
    "peak a_C POINT --mach SCENE": "unrecognized arguments: --mach; did you mean --machine?",
    "run SCENE --over": "unrecognized arguments: --over",
    "frobnicate": "invalid choice: 'frobnicate'",
    "evaluat": "'evaluat' (did you mean evaluate? choose from",
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


def test_explain(message):
    assert message("explain", COMPACTOR) == f"{dx.explain(COMPACTOR)}\n"
    assert json.loads(message("explain", COMPACTOR, "--json"))["operations"]["per_point"] > 0


def test_compile(tmp_path, message):
    place = tmp_path / "kernels.py"
    out = message("compile", COMPACTOR, "-o", str(place))
    text = place.read_text(encoding="utf-8")
    assert out == f"{place}: {len(text.splitlines())} lines\n"
    compile(text, "kernels.py", "exec")
    (tmp_path / "new").touch()
    assert place.stat().st_mode == (tmp_path / "new").stat().st_mode


@pytest.mark.parametrize("command", [(), *((name,) for name in COMMANDS)])
def test_help(command, message):
    out = message(*command, "--help")
    assert out.startswith("usage: ")
    assert max(map(len, out.splitlines())) <= 100


def test_help_of_derive_calls_itself_by_its_name(message):
    out = message("derive", "--help")
    assert out.startswith("usage: desaxe derive [-h] [--check] [--report]")
    assert "python -m" not in out


def test_a_name_that_is_a_unit_too_may_follow_a_number(message):
    assert message("evaluate", "theta=60deg", "s", *POINT[1:]).startswith("s ")


def test_help_has_signs_and_examples(message):
    out = message("evaluate", "--help")
    assert "V_C and a_C are positive along +Y" in out
    assert "desaxe evaluate a_C,V_C theta=0deg:90deg:4 ec=10mm" in out
    assert "5 friction jams" in out


@pytest.mark.parametrize("command", ["evaluate", "run"])
def test_help_names_all_inputs(command, message):
    assert set(re.findall(r"\w+", message(command, "--help"))) >= set(INPUTS)


def test_no_command_gives_help(message):
    out = message()
    assert all(f"    {command} " in out for command in COMMANDS)


def test_version(message):
    assert message("--version") == f"desaxe {dx.__version__}\n"


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


INTERRUPTED = """
import sys

class Finder:
    def find_spec(self, name, *_):
        if name == "desaxe.cli.parser":
            raise KeyboardInterrupt

sys.meta_path.insert(0, Finder())
import desaxe.cli
"""


def test_interruption_while_the_command_starts_is_no_traceback():
    result = subprocess.run([sys.executable, "-c", INTERRUPTED], check=False, capture_output=True, text=True)
    assert (result.returncode, result.stderr) == (130, "desaxe: interrupted\n")


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
    assert main(["evaluate"]) == code
    assert capsys.readouterr().err == f"{line}\n"


# ---- real processes ------------------------------------------------------------------------------


def desaxe(*words, **options):
    command = [sys.executable, "-m", "desaxe.cli", *words]
    return subprocess.run(command, capture_output=True, text=True, check=False, **options)


def test_process(tmp_path):
    done = desaxe("evaluate", "a_C", *POINT, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("a_C     -810.395")
    done = desaxe("evaluate", "a_C", "theta=1", cwd=tmp_path)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr


def test_start_is_light():
    """One point with plain numbers loads neither NumPy nor any optional dependency."""
    heavy = ("numpy", "numba", "pint", "xarray", "matplotlib", "sympy")
    code = f"""
import sys
from desaxe.cli import main
code = main(["evaluate", "a_C", "theta=1", "ec=0", "AB=1", "BC=3", "omega0=1"])
print([name for name in {heavy!r} if name in sys.modules])
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"


def test_broken_pipe():
    """Whoever reads our output may stop reading."""
    read, write = os.pipe()
    os.close(read)
    code = [sys.executable, "-m", "desaxe.cli", "evaluate", "--list"]
    with os.fdopen(write, "w") as closed:
        done = subprocess.run(code, stdout=closed, stderr=subprocess.PIPE, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


def test_closed_output(tmp_path):
    """What is written to files is there, what cannot be shown is an error in a line."""
    (tmp_path / "a.toml").write_text(
        'outputs = ["Y"]\n[mechanism]\nec = 0\nAB = 1\nBC = 3\n[motion]\ntheta = [0, 1]\n'
        '[results]\ndata = "a.npz"\n'
    )
    point = ["evaluate", "a_C", "theta=1", "ec=0", "AB=1", "BC=3", "omega0=1"]
    for words in (point, ["run", "a.toml"]):
        code = ["sh", "-c", 'exec "$@" >&-', "sh", sys.executable, "-m", "desaxe.cli", *words]
        done = subprocess.run(code, stderr=subprocess.PIPE, text=True, check=False, cwd=tmp_path)
        assert (done.returncode, done.stderr) == (2, "desaxe: error: standard output: it is closed\n")
    with np.load(tmp_path / "a.npz") as values:
        assert values["Y"].tolist() == dx.evaluate("Y", theta=[0.0, 1.0], ec=0.0, AB=1.0, BC=3.0).tolist()


def test_missing_extra():
    code = f"""
import sys
sys.modules["xarray"] = None
from desaxe.cli import main
sys.exit(main(["run", {COMPACTOR!r}]))
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr == "desaxe: error: outputs needs xarray: python -m pip install 'desaxe[labelled]'\n"


@pytest.mark.parametrize(
    ("words", "module", "message"),
    [
        (["derive", "--check"], "sympy", "desaxe derive needs sympy: python -m pip install 'desaxe[derive]'"),
    ],
)
def test_a_bare_install_says_what_to_install(words, module, message):
    code = (
        f"import sys; sys.modules[{module!r}] = None; from desaxe.cli import main; sys.exit(main({words!r}))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1] == f"desaxe: error: {message}"


# ---- doctor --------------------------------------------------------------------------------------


def test_doctor(capsys):
    assert main(["doctor"]) == 0
    out = capsys.readouterr().out
    assert f"place        {Path(dx.__file__).parent}\n" in out
    assert max(len(line) for line in out.splitlines() if "/" not in line) <= 100
    assert "python-flint" in out
    assert "flint" not in out.replace("python-flint", "")
    for word in ("numba", "llvmlite", "xarray", "threads", "freshness", "arrays"):
        assert f"\n  {word} " in out
    assert out.endswith("desaxe can be used.\n")


def test_doctor_where_something_is_missing(monkeypatch):
    real = doctor.version

    def version(name):
        if name in ("pint", "numba"):
            raise doctor.PackageNotFoundError(name)
        return real(name)

    monkeypatch.setattr(doctor, "version", version)
    result = doctor.examine()
    assert "missing: python -m pip install 'desaxe[units]'" in result.text
    assert not result.usable


def test_doctor_where_nothing_compiles(monkeypatch):
    def broken(*args, **inputs):
        raise RuntimeError("no LLVM")

    monkeypatch.setattr(doctor, "evaluate", broken)
    result = doctor.examine()
    assert "arrays       FAILED: RuntimeError: no LLVM" in result.text
    assert not result.usable


@pytest.mark.thorough
def test_doctor_compares_with_the_truth(monkeypatch):
    result = doctor.examine(accuracy=True)
    assert result.usable
    assert len(re.findall(r"200 frozen truths: 0\.\d+ of the promised error at most", result.text)) == 2
    wrong = [*doctor.truths()]
    wrong[7] = wrong[7]._replace(value=wrong[7].value * (1 + 2.0**-40))
    monkeypatch.setattr(doctor, "truths", lambda: wrong)
    assert not doctor.examine(accuracy=True).usable


def test_frozen_truths_are_fresh():
    assert freeze.TABLE.read_text(encoding="utf-8") == freeze.text(), freeze.__doc__
