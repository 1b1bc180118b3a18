"""`desaxe CALL`: the words of a command line ask what the call of Python asks."""

import csv
import json
import shlex
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import desaxe as dx
from desaxe.cli.calls import CALLS
from desaxe.cli.command import main

ROOT = Path(__file__).parents[2]
LENGTHS = "ec=10mm AB=125mm BC=350mm"
MACHINE = dx.Machine(ec=0.01, AB=0.125, BC=0.35, omega0=157.0, m_slider=1.0)
WORDS = f"{LENGTHS} omega0=157 m_slider=1kg"
# The words of a command, and the same call in Python.
SAME = {
    "evaluate a_C,V_C theta=0deg:90deg:4": lambda m: m.evaluate(
        ["a_C", "V_C", "status"], theta=np.radians([0.0, 30.0, 60.0, 90.0])
    ),
    "evaluate a_C theta=1 branch=-1": lambda m: m.replace(branch=-1).evaluate(["a_C", "status"], theta=1.0),
    "grid a_C theta=0,1,2 reduce.theta=absmax": lambda m: m.grid(
        ["a_C"], theta=[0.0, 1.0, 2.0], reduce={"theta": "absmax"}
    ),
    "peak T_in kind=max theta=0:180deg": lambda m: m.peak("T_in", kind="max", theta=(0.0, np.pi)),
    "inverse Y=400mm": lambda m: m.inverse(Y=0.4),
    "harmonics T_in orders=4": lambda m: m.harmonics("T_in", orders=4),
    "drive fluctuation=0.05": lambda m: m.drive(fluctuation=0.05),
    "tolerance a_C theta=1 'ec=10 mm +- 0.1 mm' samples=1000": lambda m: m.tolerance(
        "a_C", theta=1.0, ec="10 mm +- 0.1 mm", samples=1000
    ),
    "enclose V_C theta=1 ec=9.9mm:10.1mm": lambda m: m.enclose(
        "V_C", theta=1.0, ec=dx.between("9.9 mm", "10.1 mm")
    ),
    "optimize minimize=absmax:a_C over.BC=300mm:400mm keep.stroke=250mm:260mm": lambda m: m.optimize(
        minimize=("absmax", "a_C"), over={"BC": (0.3, 0.4)}, keep={"stroke": (0.25, 0.26)}
    ),
    "solve over.AB=10:150 where.stroke=200 --units mm ec=10 BC=350": lambda m: dx.Machine(
        units="mm", ec=10, BC=350
    ).solve(over={"AB": ("10 mm", "150 mm")}, where={"stroke": "200 mm"}),
    "simulate torque=20 t_end=0.1s I_crank=0.1": lambda m: m.simulate(torque=20.0, t_end=0.1, I_crank=0.1),
}


def numbers(value):
    """The numbers of a nested answer, of whatever types."""
    if isinstance(value, dict):
        return [n for key, part in value.items() if key != "units" for n in numbers(part)]
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [n for part in value for n in numbers(part)]
    return [float(value)] if isinstance(value, (int, float)) and not isinstance(value, bool) else []


@pytest.mark.parametrize("line", SAME)
def test_the_numbers_are_those_of_the_call(line, capsys):
    words = shlex.split(line)
    given = {word.partition("=")[0] for word in words}
    machine = [word for word in WORDS.split() if word.partition("=")[0] not in given]
    assert main([*words, *machine, "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    answer = SAME[line](MACHINE)
    if isinstance(answer, xr.Dataset):
        answer = {str(name): answer[name].values for name in answer.variables}
        result = {name: result[name] for name in answer}
    expected = numbers(dict(answer))
    assert expected
    assert numbers(result) == pytest.approx(expected, rel=1e-12, abs=1e-12, nan_ok=True)


def test_designs_are_columns_of_a_table(capsys):
    assert main(["peak", "a_C", "ec=0mm,10mm", *LENGTHS.split()[1:], "omega0=157", "--csv"]) == 0
    rows = list(csv.DictReader(capsys.readouterr().out.splitlines()))
    assert [float(row["ec [m]"]) for row in rows] == [0.0, 0.01]
    peaks = [dx.peak("a_C", ec=ec, AB=0.125, BC=0.35, omega0=157.0)["value"] for ec in (0.0, 0.01)]
    assert [float(row["value [m/s^2]"]) for row in rows] == pytest.approx(peaks, rel=1e-12)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (
            "fit examples/feeder.toml examples/measured.csv --over AB BC --loss huber ec=20mm --json",
            "fit examples/measured.csv over=AB,BC loss=huber ec=20mm --machine examples/feeder.toml --json",
        ),
        (
            "fit examples/measured.csv --over AB=30mm:60mm --sigma Y=1mm --machine examples/motor.toml",
            "fit examples/measured.csv over.AB=30mm:60mm sigma.Y=1mm --machine examples/motor.toml",
        ),
        (f"point a_C theta=1 --quality {WORDS}", f"evaluate a_C theta=1 quality=true {WORDS}"),
    ],
)
def test_options_of_a_call_may_be_written_as_those_of_a_command(options, words, capsys, monkeypatch):
    monkeypatch.chdir(ROOT)
    printed = []
    for line in (options, words):
        assert main(shlex.split(line)) == 0
        printed.append(capsys.readouterr().out)
    assert printed[0] == printed[1]


@pytest.mark.parametrize("call", CALLS)
def test_the_example_of_its_help_runs(call, capsys, monkeypatch):
    monkeypatch.chdir(ROOT)
    _, example = CALLS[call]
    assert main([call, "--help"]) == 0
    assert f"desaxe {call} {example}" in capsys.readouterr().out
    assert main([call, *shlex.split(example)]) == 0
    assert capsys.readouterr().out.strip()


def test_a_scene_brings_machine_motor_and_units(tmp_path, capsys):
    scene = tmp_path / "press.toml"
    motor = "torque = { kloss = { breakdown_torque = 40, breakdown_slip = 0.15, synchronous_speed = 1500 } }"
    scene.write_text(
        f'units = "mm, rpm"\n[mechanism]\nAB = 50\nBC = 200\nec = 10\n'
        f"[masses]\nm_slider = 20\nI_crank = 2\n[loads]\nF_Y = -900\n[steady]\n{motor}\n"
    )
    assert main(["steady", "--machine", str(scene), "flywheel_inertia=3", "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    machine = dx.Machine.read(scene)
    answer = machine.steady(torque=dx.kloss(40.0, 0.15, "1500 rpm"), flywheel_inertia=3.0)
    assert result["omega_mean"] == pytest.approx(answer["omega_mean"], rel=1e-12)
    assert result["units"]["omega_mean"] == "rpm"
    assert main(["events", "--machine", str(scene), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["stroke"] == pytest.approx(machine.events()["stroke"])


PRESS = {"AB": 50, "BC": 200, "ec": 10, "m_slider": 20, "I_crank": 2, "F_Y": -900}
KLOSS = "breakdown_torque=40 breakdown_slip=0.15 synchronous_speed=1500 gear=12"


def test_a_motor_in_words(tmp_path, capsys):
    """By its numbers, in the units of the call, or by a table: as of the objects."""
    file, press = tmp_path / "motor.csv", [f"{name}={value}" for name, value in PRESS.items()]
    file.write_text("omega [rpm],torque [N m]\n0,30\n60,45\n100,-20\n")
    machine = dx.Machine(units="mm, rpm", **PRESS)
    kloss = dx.kloss(40.0, 0.15, "1500 rpm", gear=12)
    for words, motor in (
        ([f"torque.kloss.{word}" for word in KLOSS.split()], kloss),
        ([f"torque.over_omega={file}"], dx.over_omega(["0 rpm", "60 rpm", "100 rpm"], [30, 45, -20])),
    ):
        assert main(["steady", *press, "--units", "mm, rpm", *words, "--json"]) == 0
        assert numbers(json.loads(capsys.readouterr().out)) == numbers(machine.steady(torque=motor))
        assert main(["simulate", *press, "--units", "mm, rpm", *words, "t_end=0.1s", "--json"]) == 0
        omega = json.loads(capsys.readouterr().out)["omega"]
        assert omega == machine.simulate(torque=motor, t_end="0.1 s")["omega"].tolist()
    assert main(["steady", *press, "--units", "mm, rpm", *words]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines[:4]] == ["status", "message", "period", "omega_mean"]
    assert all(line.startswith("    ") for line in lines[lines.index("gradient") + 1 :])


@pytest.mark.parametrize(
    ("written", "words", "inputs"),
    [
        ("fluctuation = 0.001", "", {"fluctuation": 0.001}),
        ("flywheel_inertia = 3", "", {"flywheel_inertia": 3.0}),
        ("flywheel_inertia = [3, 6]", "", {"flywheel_inertia": [3.0, 6.0]}),
        ("flywheel_inertia = [3, 6]", "fluctuation=0.001", {"fluctuation": 0.001}),
        ("fluctuation = 0.001", "flywheel_inertia=5", {"flywheel_inertia": 5.0}),
    ],
)
def test_steady_takes_all_of_its_scene(written, words, inputs, tmp_path, capsys):
    scene = tmp_path / "press.toml"
    motor = "{ kloss = { breakdown_torque = 40, breakdown_slip = 0.15, synchronous_speed = 157 } }"
    lengths = "[mechanism]\nAB = 0.05\nBC = {}\nec = 0\n[masses]\nm_slider = 20\nI_crank = 2\n"
    more = f"[steady]\ntorque = {motor}\n{written}\n"
    scene.write_text(lengths.format(0.2) + more)
    assert main(["steady", "--machine", str(scene), *words.split(), "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    design = {"AB": 0.05, "BC": 0.2, "ec": 0.0, "m_slider": 20.0, "I_crank": 2.0}
    answer = dx.steady(torque=dx.kloss(40.0, 0.15, 157.0), **design, **inputs)
    for name in ("flywheel_inertia", "fluctuation", "omega_mean"):
        np.testing.assert_allclose(result[name], answer[name], rtol=1e-12)
    if not words:
        own = dx.scene(scene).run().steady.dataset
        np.testing.assert_allclose(result["flywheel_inertia"], own["flywheel_inertia"], rtol=1e-12)
    scene.write_text(lengths.format("[0.2, 0.3]") + more)
    refused = "[" in written and not words
    assert main(["steady", "--machine", str(scene), *words.split(), "--json"]) == (2 if refused else 0)
    assert ("give flywheel_inertia as NAME=VALUE" in capsys.readouterr().err) == refused


def test_files_and_tables(tmp_path, capsys):
    words = ["grid", "a_C", "theta=0deg:360deg:5", *LENGTHS.split(), "omega0=157"]
    assert main([*words, "--csv"]) == 0
    rows = list(csv.reader(capsys.readouterr().out.splitlines()))
    assert rows[0][:2] == ["theta [rad]", "a_C [m/s^2]"]
    assert len(rows) == 6
    path = tmp_path / "values.nc"
    assert main([*words, "-o", str(path)]) == 0
    with xr.open_dataset(path) as stored:
        assert stored.a_C.values.tolist() == [float(row[1]) for row in rows[1:]]
    assert main(["events", *LENGTHS.split(), "--csv"]) == 0
    out = capsys.readouterr().out.splitlines()
    assert "name,value,unit" in out
    assert any(line.startswith("gradient.stroke.AB,") for line in out)
    drawings = {
        f"grid a_C V_C theta=0deg:360deg:5 omega0=157 {LENGTHS}": 0,
        "design_map stroke ec=0mm:20mm:3 AB=100mm,120mm BC=350mm": 0,
        "design_map stroke ec=0mm:20mm:3 AB=100mm,120mm BC=350mm,360mm": 2,
        f"events {LENGTHS}": 2,
        f"fit {ROOT}/examples/measured.csv over=AB,BC sigma.Y=0.05mm --machine {ROOT}/examples/motor.toml": 0,
    }
    for number, (line, code) in enumerate(drawings.items()):
        picture = tmp_path / f"{number}.svg"
        assert main([*line.split(), "-o", str(picture)]) == code
        assert picture.exists() == (code == 0)
    assert "not stroke over ec, AB, BC" in capsys.readouterr().err
    path.write_text("a measurement")
    assert main([*words, "-o", str(path)]) == 2
    assert path.read_text() == "a measurement"


COMPLAINTS = {
    f"peak a_C V_C {LENGTHS}": "desaxe peak takes one quantity, got 2",
    f"events a_C {LENGTHS}": "a_C: desaxe events takes no quantity",
    f"peak a_C kind=bogus {LENGTHS} omega0=1": "kind = 'bogus': it is one of absmax, max, min",
    f"peak a_C knd=max {LENGTHS}": "did you mean kind?",
    "grid a_C theta=0:b:3 ec=0": "theta=0:b:3: expected FIRST:LAST:COUNT, such as 0deg:360deg:73",
    "grid a_C ec=0 ec=1": "ec=1: ec is given twice",
    f"steady {LENGTHS}": "desaxe steady: missing torque; each is given as NAME=VALUE; a motor as torque.o",
    "drive ec=0,0.01 AB=1 BC=3 omega0=1": "drive expects one number, for one design: give one, as NAME=VALUE",
    f"tolerance stroke {LENGTHS}": 'give one as "NAME=VALUE +- TOLERANCE"',
    f"solve stroke=100mm {LENGTHS}": "desaxe solve: missing over; each is given as over.AB=LOW:HIGH",
    "solve over.AB=10mm:60mm absmax:T_in=1750": "absmax:T_in: a measure is given as where.absmax:T_in=VALUE",
    "fit examples/measured.csv": "desaxe fit: missing over; each is given as over=AB,BC",
    "optimize keep.margin=10:": "keep.margin=10:: an open side is none: keep.margin=10:none",
    "simulate V_C T_in": "V_C: desaxe simulate takes no quantity, only NAME=VALUE, such as names=V_C,T_in",
    "steady torque=kloss:40,0.15,1500": "torque = kloss: a motor is given as torque.over_omega=motor.csv, or",
    "simulate torque.kloss.gear=4": "torque.kloss: kloss() missing 3 required positional arguments",
    "steady torque.kloss=40 torque.kloss.gear=4": "torque.kloss.gear: torque.kloss has a value already",
    "steady torque.kind=smooth": "torque: a motor has over_omega",
    "optimize over.AB=0:1 absmax:a_C=3": "given as keep.absmax:a_C=LOW:HIGH, or minimize=absmax:a_C",
    "optimize over.ec=0:1 over=2": "over=2: over has a value already",
    "events -o values.txt": "-o values.txt: its name must end in .json, .csv",
}


@pytest.mark.parametrize("line", COMPLAINTS)
def test_complaints(line, capsys):
    assert main(line.split()) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert COMPLAINTS[line] in err
    assert err.count("\n") == 1
