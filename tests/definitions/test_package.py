"""`desaxe derive --quantities`: a package of its own, in a process that has neither desaxe nor SymPy."""

import json
import re
import subprocess
import sys

import pytest

import desaxe as dx
from desaxe.cli.files import derive
from desaxe.definitions.tables import read_definitions
from desaxe.mechanism.own import using

TABLES = {
    "shoe": {"expression": "f * abs(N_C * V_C)", "unit": "W", "constants": {"f": 0.08}},
    "arm": {"expression": "hypot(Y, ec) - r_pin", "constants": {"r_pin": "1 mm"}},
}
TEXT = """
[quantities.shoe]
expression = "f * abs(N_C * V_C)"
unit = "W"
constants = { f = 0.08 }

[quantities.arm]
expression = "hypot(Y, ec) - r_pin"
constants = { r_pin = "1 mm" }
"""
POINT = {"theta": 1.0, "ec": 0.01, "AB": 0.125, "BC": 0.35, "omega0": 150.0, "m_slider": 0.8, "m_rod": 0.5}
NAMES = ["shoe", *(f"shoe_wrt_{p}" for p in ("ec", "AB", "BC", "m_rod")), "arm", "arm_wrt_ec_BC", "status"]
SCRIPT = """
import json, sys
sys.modules["desaxe"] = sys.modules["sympy"] = None  # importing either is an error
import own_kernels
names, point = json.loads(sys.argv[1])
found = [own_kernels.evaluate(names, **point)]
found.append(own_kernels.evaluate("arm", theta=1.0, ec=0.01, AB=0.125, BC=0.35))
import numpy as np
turn = point | {"theta": np.linspace(0, 6, 700), "BC": 0.13}
arrays = own_kernels.evaluate(["arm", "arm_wrt_theta", "status"], **turn)
found.append({name: array[::70].tolist() for name, array in arrays.items()})
state = {k: v for k, v in point.items() if k != "omega0"} | {"omega": 150.0}
found.append(own_kernels.evaluate("shoe_wrt_omega", **state))
few = own_kernels.evaluate("shoe", **point | {"theta": [1.0, 2.0], "AB": [-1.0, 0.125]})
found.append(few.tolist())
text = ({"theta": "1"}, {"AB": ["0.125", "0.13"]}, {"m_slider": b"1"}, {"ec": np.array(1j)})
for wrong in ({"theta": 1.0}, {"thet": 1.0}, *(point | one for one in ({"BC": -1.0}, {"omega": 1.0}, *text))):
    try:
        own_kernels.evaluate("shoe", **wrong)
    except (TypeError, ValueError) as error:
        found.append(str(error))
print(json.dumps(found))
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("package")
    (folder / "mine.toml").write_text(TEXT, encoding="utf-8")
    assert derive(["--quantities", str(folder / "mine.toml"), "-o", str(folder / "own_kernels")]) == 0
    return folder


@pytest.mark.thorough
def test_it_answers_as_the_library_does(folder):
    command = [sys.executable, "-c", SCRIPT, json.dumps([NAMES, POINT])]
    done = subprocess.run(command, capture_output=True, text=True, cwd=folder, check=False)
    assert not done.stderr
    values, alone, arrays, by_omega, few, *errors = json.loads(done.stdout)
    with using(read_definitions(TABLES)):
        for name, expected in dx.evaluate(NAMES, **POINT).items():
            assert values[name] == pytest.approx(expected, rel=1e-12), name
        assert alone == pytest.approx(values["arm"], rel=1e-14)
        others = {p: value for p, value in POINT.items() if p != "omega0"}
        assert by_omega == pytest.approx(dx.evaluate("shoe_wrt_omega", omega=150.0, **others), rel=1e-12)
        names = ["arm", "arm_wrt_theta", "status"]
        for index in range(10):
            at = {"theta": 6 * index * 70 / 699, "BC": 0.13}
            for name, expected in dx.evaluate(names, **POINT | at).items():
                assert arrays[name][index] == pytest.approx(expected, rel=1e-9, abs=1e-12, nan_ok=True)
        assert few[1] == pytest.approx(dx.evaluate("shoe", **POINT | {"theta": 2.0}), rel=1e-12)
    assert few[0] != few[0]
    words = ["ec is missing", "no input 'thet'", "BC = -1", "not both"]
    words += [f"{p} = .*: expected numbers in SI units, not text$" for p in ("theta", "AB", "m_slider", "ec")]
    assert [bool(re.search(word, error)) for word, error in zip(words, errors, strict=True)] == [True] * 8


def test_check_sees_every_change(folder, capsys):
    order = ["--quantities", str(folder / "mine.toml"), "-o", str(folder / "own_kernels"), "--check"]
    assert derive(order) == 0
    place = folder / "own_kernels" / "index.py"
    text = place.read_text(encoding="utf-8")
    place.write_text(text.replace("'W'", "'N'"), encoding="utf-8")
    assert derive(order) == 1
    assert "+" in capsys.readouterr().out
    place.write_text(text, encoding="utf-8")
    assert derive(order) == 0


def test_an_edited_file_is_replaced_with_overwrite_alone(tmp_path, capsys, monkeypatch):
    """Of a package from another machine, too; a file that is left over goes if nobody edited it."""
    (tmp_path / "mine.toml").write_text(TEXT, encoding="utf-8")
    order = ["--quantities", str(tmp_path / "mine.toml"), "-o", str(tmp_path / "own")]
    assert derive(order) == 0
    place = tmp_path / "own" / "arm_0_law.py"
    first = place.read_bytes()
    place.write_bytes(first.replace(b"0.001", b"0.002"))
    (tmp_path / "mine.toml").write_text(TEXT.replace("1 mm", "2 mm"), encoding="utf-8")
    assert derive(order) == 2
    assert "arm_0_law.py exists and was not written by desaxe" in capsys.readouterr().err
    assert derive([*order, "--overwrite"]) == 0
    assert b"0.002" in place.read_bytes()
    (tmp_path / "mine.toml").write_text(TEXT.partition("[quantities.arm]")[0], encoding="utf-8")
    assert derive(order) == 0
    assert not place.exists()
    for name in ("numpy", "class", "random"):
        assert derive([*order[:3], str(tmp_path / name)]) == 2


@pytest.mark.parametrize(
    "text",
    ["", "x = [", '[quantities.x]\nexpression = "V_D"', "quantities = 3", '[quantities.x]\nunit="W"'],
)
def test_a_wrong_file_writes_nothing(tmp_path, capsys, text):
    (tmp_path / "mine.toml").write_text(text, encoding="utf-8")
    assert derive(["--quantities", str(tmp_path / "mine.toml"), "-o", str(tmp_path / "own")]) == 2
    assert "desaxe derive: " in capsys.readouterr().err
    assert not (tmp_path / "own").exists()


def test_a_folder_with_other_things_is_left_alone(tmp_path, capsys):
    (tmp_path / "mine.toml").write_text(TEXT, encoding="utf-8")
    (tmp_path / "own").mkdir()
    (tmp_path / "own" / "mine.py").write_text("x = 1\n", encoding="utf-8")
    assert derive(["--quantities", str(tmp_path / "mine.toml"), "-o", str(tmp_path / "own")]) == 2
    assert "other things" in capsys.readouterr().err
