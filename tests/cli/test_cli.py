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
from desaxe.cli import command, doctor, main
from desaxe.mechanism.inputs import INPUTS

COMPACTOR = str(Path(__file__).parents[2] / "examples" / "compactor.toml")
POINT = ["theta=60deg", "ec=10mm", "AB=125mm", "BC=300mm", "omega0=1500rpm"]
COMMANDS = (
    "point",
    "scene",
    "run",
    "explain",
    "compile",
    "explore",
    "fit",
    "derive",
    "errata",
    "audit",
    "doctor",
)


def test_point(capsys):
    assert main(["point", "a_C", *POINT]) == 0
    out, err = capsys.readouterr()
    name, value, unit, meaning = re.fullmatch(r"(\S+) = (\S+) (\S+) +(.*)\n", out).groups()
    point = {"theta": "60 deg", "ec": 0.01, "AB": 0.125, "BC": 0.3, "omega0": "1500 rpm"}
    assert (name, unit, meaning) == ("a_C", "m/s^2", "acceleration of the slider")
    assert float(value) == pytest.approx(dx.evaluate("a_C", **point), rel=1e-15)
    assert err == ""


def test_blanks_around_equals(capsys):
    main(["point", "a_C", *POINT])
    main(["point", "a_C", *(word.replace("=", " = ") for word in POINT)])
    first, second = capsys.readouterr().out.splitlines()
    assert first == second


def test_the_best_designs_are_in_the_units_of_the_scene(tmp_path, capsys):
    text = """
units = "mm, deg, rpm"
outputs = ["a_C"]
mechanism = { AB = 75, BC = [300, 310], ec = [0, 15, 280] }
motion = { omega0 = 60, theta = { start = 0, stop = 360, num = 37 } }
"""
    (tmp_path / "press.toml").write_text(text, encoding="utf-8")
    main(["sweep", f"{tmp_path}/press.toml", "--best", "1", "--by", "absmax:a_C", "--order", "smallest"])
    head, _, row = capsys.readouterr().out.splitlines()
    assert re.findall(r"(?:AB|omega0|a_C_absmax) \S+", head) == [
        "AB [mm]",
        "omega0 [rpm]",
        "a_C_absmax [mm/s^2]",
    ]
    assert row.split()[1] == "75.0"


def test_point_with_several_names(capsys):
    assert main(["point", "V_C,a_C", *POINT, "a_C_wrt_ec"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == ["V_C", "a_C", "a_C_wrt_ec"]
    starts = {re.search(r" {3}\w", line).start() for line in lines}
    assert len(starts) == 1


def test_point_needs_only_what_is_needed(capsys):
    assert main(["point", "margin", "ec=220mm", "AB=.125", "BC=0.35"]) == 0
    assert capsys.readouterr().out.startswith("margin = 0.00499999999999")


def test_point_tells_the_status_in_words(capsys):
    assert main(["point", "a_C", "theta=90deg", "ec=.23", "AB=.125", "BC=.35", "omega0=1"]) == 0
    out = capsys.readouterr().out
    assert out.startswith("a_C = nan m/s^2")
    assert out.endswith("status 1: cannot be assembled here\n")
    assert main(["point", "status", "theta=90deg", "ec=.23", "AB=.125", "BC=.35", "omega0=1"]) == 0
    assert capsys.readouterr().out.startswith("status = 1   ")


def test_point_in_json(capsys):
    assert main(["point", "a_C", *POINT, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["a_C"]["unit"] == "m/s^2"
    assert found["a_C"]["value"] == pytest.approx(-810.4, abs=0.05)
    assert main(["point", "a_C", "theta=90deg", "ec=.23", "AB=.125", "BC=.35", "omega0=1", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["a_C"]["value"] is None
    assert found["status"] == "cannot be assembled here"


def test_options_of_point_stand_anywhere(capsys):
    texts = set()
    for place in range(len(POINT) + 2):
        words = ["a_C", *POINT]
        words.insert(place, "--json")
        assert main(["point", *words]) == 0
        texts.add(capsys.readouterr().out)
    assert len(texts) == 1


def test_point_with_branch_and_state(capsys):
    where = ["theta=1", "ec=0.01", "AB=0.125", "BC=0.3", "branch=-1"]
    assert main(["point", "a_C", *where, "omega=3", "alpha=2rad/s2"]) == 0
    value = float(capsys.readouterr().out.split()[2])
    point = {"theta": 1.0, "ec": 0.01, "AB": 0.125, "BC": 0.3, "omega": 3.0, "alpha": 2.0, "branch": -1}
    assert value == dx.evaluate("a_C", **point)


def test_point_with_masses_and_loads(capsys):
    loads = ["m_rod=0.5kg", "I_rod=80.6 kg mm2", "r_rod=10cm", "F_Y=-50N", "g_X=9.81m/s2", "mu=0.1"]
    assert main(["point", "T_in", *POINT, *loads]) == 0
    name, _, value, unit, *_ = capsys.readouterr().out.split()
    point = {"theta": "60 deg", "ec": 0.01, "AB": 0.125, "BC": 0.3, "omega0": "1500 rpm"}
    loads = {"m_rod": 0.5, "I_rod": 80.6e-6, "r_rod": 0.1, "F_Y": -50.0, "g_X": 9.81, "mu": 0.1}
    assert (name, unit) == ("T_in", "N*m")
    assert float(value) == pytest.approx(dx.evaluate("T_in", **point, **loads), rel=1e-15)


@pytest.mark.parametrize(
    ("speed", "status"),
    [("60rpm", "6: friction: two balances of forces"), ("-60rpm", "5: friction jams: no balance of forces")],
)
def test_point_tells_what_friction_does(speed, status, capsys):
    design = ["theta=90deg", "ec=20mm", "AB=40mm", "BC=64mm", f"omega0={speed}", "m_slider=1kg"]
    assert main(["point", "T_in", *design, "mu=1.5"]) == 0
    assert capsys.readouterr().out.endswith(f"status {status}\n")
    assert main(["point", "T_in", *design]) == 0
    assert "status" not in capsys.readouterr().out


def test_list_of_names(capsys):
    assert main(["point", "--list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == len(dx.quantities())
    assert any(line.startswith("a_C ") and "acceleration of the slider (A (19))" in line for line in lines)


COMPLAINTS = {
    "no name": (["point"], "which quantity?"),
    "no such name": (["point", "aC", *POINT], "unknown quantity 'aC'; did you mean a_C?"),
    "no such input": (["point", "a_C", "CD=3"], "CD=3: no input is called 'CD', there are theta, ec"),
    "input of another name": (
        ["point", "a_C", "rod=3"],
        "no input is called 'rod', did you mean BC? There are",
    ),
    "blanks around the sign": (
        ["point", "a_C", "theta", "=", "60deg"],
        "=: an input and its value are one word, such as theta=60deg",
    ),
    "no value": (["point", "a_C", "theta="], "theta=: an input and its value are one word"),
    "a unit apart": (
        ["point", "a_C", "ec=10", "mm"],
        "ec=10 mm: a value and its unit are one word, ec=10mm or",
    ),
    "a name after a number": (
        ["point", "a_C", "theta=60", "a_c"],
        "unknown quantity 'a_c'; did you mean a_C",
    ),
    "module without its ending": (["compile", COMPACTOR, "-o", "kern"], "but kern.py, for example"),
    "module of no name": (["compile", COMPACTOR, "-o", "my-k.py"], "my-k.py: Python cannot import a module"),
    "input twice": (["point", "a_C", *POINT, "ec=3"], "ec=3: ec is given twice"),
    "missing input": (["point", "a_C", *POINT[:-1]], "a_C: omega0 is missing"),
    "bad value": (["point", "a_C", "AB=-1", *POINT[:2], *POINT[3:]], "it must be a finite length >= 0"),
    "list": (["point", "Y", "theta=[1,2]"], "theta=[1,2]: it must be a number"),
    "decimal comma": (["point", "Y", "theta=1,5"], "theta=1,5: it must be a number"),
    "unit of another kind": (["point", "Y", "theta=1kg", *POINT[1:]], "it must be a quantity in rad"),
    "force in kilograms": (["point", "T_in", *POINT, "m_rod=1", "F_Y=5kg"], 'in N, such as "50 N"'),
    "mass of a force": (["point", "T_in", *POINT, "m_rod=5N"], "it must be a quantity in kg"),
    "negative mass": (["point", "T_in", *POINT, "m_rod=-5kg"], "it must be a finite mass >= 0"),
    "friction with a unit": (["point", "T_in", *POINT, "m_rod=1", "mu=0.1N"], "a plain number, such as 0.1"),
    "no such branch": (["point", "Y", "branch=2"], "branch=2: it is 1 or -1"),
    "no such option": (["point", "--exact"], "unrecognized arguments: --exact"),
    "no such command": (["frobnicate"], "invalid choice: 'frobnicate'"),
    "almost a command": (["pont"], "'pont' (did you mean point? choose from"),
    "no scene": (["run"], "required: SCENE (see desaxe run --help)"),
    "no such file": (["run", "missing.toml"], "missing.toml: No such file or directory"),
    "no such verdict": (["errata", "--verdict", "maybe"], "unknown verdict 'maybe'"),
    "no such entry": (["errata", "A-eq99"], "no entry for 'A-eq99'"),
    "no such document": (["errata", "--document", "Z"], "unknown document 'Z'"),
    "two forms": (["errata", "--json", "--markdown"], "not allowed with argument"),
}


@pytest.mark.parametrize("complaint", COMPLAINTS)
def test_complaint(complaint, capsys):
    words, message = COMPLAINTS[complaint]
    assert main(words) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("desaxe: error: ")
    assert message in err
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
    assert capsys.readouterr().out == f"{COMPACTOR}: fine, V_C, a_C, omega_BC, alpha_BC\n"
    assert main(["scene"]) == 2
    assert "give the path of a file, or --schema" in capsys.readouterr().err
    wrong = tmp_path / "wrong.toml"
    wrong.write_text('outputs = ["a_D"]', encoding="utf-8")
    assert main(["scene", str(wrong)]) == 2
    assert "did you mean" in capsys.readouterr().err


def test_explain(capsys):
    assert main(["explain", COMPACTOR]) == 0
    text = capsys.readouterr().out
    assert text == f"{dx.explain(COMPACTOR)}\n"
    assert main(["explain", COMPACTOR, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["operations"]["per_point"] > 0


def test_compile(tmp_path, capsys):
    place = tmp_path / "kernels.py"
    assert main(["compile", COMPACTOR, "-o", str(place)]) == 0
    out = capsys.readouterr().out
    text = place.read_text(encoding="utf-8")
    assert out == f"{place}: {len(text.splitlines())} lines\n"
    compile(text, "kernels.py", "exec")
    (tmp_path / "new").touch()
    assert place.stat().st_mode == (tmp_path / "new").stat().st_mode


def test_run(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["run", COMPACTOR]) == 0
    out, err = capsys.readouterr()
    for text in ("29.5 rad/s", "-20.2 m/s", "-7740 rad/s2", "-994 m/s2"):
        assert out.count(text) == 2
    assert "Written\n  out/compactor.nc" in out.replace(os.sep, "/")
    assert (tmp_path / "out" / "compactor.nc").exists()
    assert err == ""


@pytest.mark.parametrize("command", [(), *((name,) for name in COMMANDS)])
def test_help(command, capsys):
    assert main([*command, "--help"]) == 0
    out, err = capsys.readouterr()
    assert out.startswith("usage: ")
    assert max(map(len, out.splitlines())) <= 100
    assert err == ""


def test_help_of_derive_calls_itself_by_its_name(capsys):
    assert main(["derive", "--help"]) == 0
    out = capsys.readouterr().out
    assert out.startswith("usage: desaxe derive [-h] [--check] [--report]")
    assert "python -m" not in out


def test_a_name_that_is_a_unit_too_may_follow_a_number(capsys):
    assert main(["point", "theta=60deg", "s", *POINT[1:]]) == 0
    assert capsys.readouterr().out.startswith("s = ")


def test_help_has_signs_and_examples(capsys):
    main(["point", "--help"])
    out = capsys.readouterr().out
    assert "V_C and a_C are positive along +Y" in out
    assert "desaxe point a_C theta=60deg ec=10mm AB=125mm BC=300mm omega0=1500rpm" in out
    assert "5 friction jams" in out


@pytest.mark.parametrize("command", ["point", "run"])
def test_help_names_all_inputs(command, capsys):
    main([command, "--help"])
    words = set(re.findall(r"\w+", capsys.readouterr().out))
    assert words >= set(INPUTS)


def test_no_command_gives_help(capsys):
    assert main([]) == 0
    out = capsys.readouterr().out
    assert all(f"    {command} " in out for command in COMMANDS)


def test_version(capsys):
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"desaxe {dx.__version__}\n"


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


def test_interruption_is_no_traceback(monkeypatch, capsys):
    def interrupted(words):
        raise KeyboardInterrupt

    monkeypatch.setattr(command, "_run", interrupted)
    assert main(["doctor"]) == 130
    assert capsys.readouterr().err == "desaxe: interrupted\n"


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
    for word in ("numba", "llvmlite", "xarray", "folder", "threads", "freshness", "vectorised", "sin, cos"):
        assert f"\n  {word} " in out
    assert out.endswith("desaxe can be used.\n")


def test_doctor_where_something_is_missing(monkeypatch):
    real = doctor.version

    def version(name):
        if name in ("pint", "numba"):
            raise doctor.PackageNotFoundError(name)
        return real(name)

    monkeypatch.setattr(doctor, "version", version)
    monkeypatch.setattr(doctor, "_assembly", lambda: iter([""]))
    found = doctor.examine()
    assert "missing: python -m pip install 'desaxe[units]'" in found.text
    assert not found.usable


def test_doctor_where_nothing_compiles(monkeypatch):
    def broken():
        raise RuntimeError("no LLVM")

    monkeypatch.setattr(doctor, "_assembly", broken)
    found = doctor.examine()
    assert "compilation  FAILED: RuntimeError: no LLVM" in found.text
    assert not found.usable


@pytest.mark.parametrize(
    ("assembly", "found"),
    {
        "\tvmulpd\t%zmm1, %zmm2, %zmm3\n\tvmulsd\t%xmm1, %xmm2, %xmm3\n": (8, ()),
        "\tvfmadd231pd\t(%rax), %ymm2, %ymm3\n": (4, ()),
        "\tmulpd\t%xmm2, %xmm3\n": (2, ()),
        "\tfmul\tv0.2d, v1.2d, v2.2d\n\tbl\tsincos\n": (2, ("sincos",)),
        "\tvmulsd\t%xmm1, %xmm2, %xmm3\n\tmovabsq\t$sincos, %rax\n": (1, ("sincos",)),
        "\tfmul\td0, d1, d2\n\tbl\t_sin\n\tbl\t_cos\n": (1, ("cos", "sin")),
        '\tmovabsq\t$".const.missing", %rsi\n': (1, ()),
    }.items(),
)
def test_doctor_reads_machine_code(assembly, found):
    doubles, calls = found
    loop = doctor.examine_assembly(assembly)
    assert loop.doubles == doubles
    assert loop.library_calls == calls
    assert loop.vectorised is (doubles > 1)
