"""One machine gives one number through every front end.

Function, Machine, scene, command, sweep, report, exported languages, FMU; the page of `explore` in
`explorer/test_numbers.py`.
"""

import json
import math
import re
from functools import cache

import numpy as np
import pytest

import desaxe as dx
from desaxe.cli import main
from desaxe.compiler.languages import language_of
from desaxe.mechanism.own import using
from tests.compiler.languages.runners import caller
from tests.effort import first
from tests.scenes.export.test_fmu import simulated

SCENE = """
title = "press"
units = "mm, deg, rpm, kN"
outputs = ["Y", "a_C", "T_in", "N_C"]
[motion]
theta = {{ start = 0, stop = {turn}, num = 73 }}
omega0 = 300
[masses]
m_slider = 4
m_rod = 1
I_rod = "0.01 kg m2"
[mechanism]
ec = 10
AB = 50
BC = 200
branch = {branch}
[loads]
mu = {mu}
F_Y = {load}
"""
PV = '[quantities.pv]\nexpression = "abs(N_C*V_C)/A"\nunit = "W/m2"\nconstants = { A = "2 cm2" }\n'
FOUR = (
    "{ over_theta = [[0, -2], [20, -8], [90, -3], [200, -0.2], [700, -1.5]], period = 720, kind = 'linear' }"
)
PUSHED = "{ over_Y = [[150, -1, 0], [200, -0.5, 0.1], [250, 0, 0.2]], kind = 'linear' }"
STROKE = "{ over_stroke = [[0, -5, 0], [20, -1, 0]], dead_centre = 'outer' }"


def text(load="-0.6", turn=360, branch=1, mu=0):
    return SCENE.format(load=load, turn=turn, branch=branch, mu=mu)


SCENES = {
    "number": text(),
    "branch -1, friction, gravity": text("0.6", branch=-1, mu=0.1) + 'g_Y = "-9.81 m/s^2"\n',
    "two turns": text(FOUR, 720),
    "over Y": text(PUSHED),
    "over the stroke": text(STROKE, mu=0.05),
    "user-defined": text().replace('"N_C"]', '"N_C", "pv"]') + PV,
    "designs": text().replace("ec = 10", "ec = [0, 10, 20]"),
}
DESIGNS = "designs"


@pytest.fixture
def command(capsys):
    """The JSON of a command line."""

    def run(*words):
        assert main([*map(str, words), "--json"]) == 0, capsys.readouterr().err
        return json.loads(capsys.readouterr().out)

    return run


@pytest.fixture(params=first(6, SCENES))
def case(request, tmp_path, monkeypatch):
    """The name of a case, the path of its scene, its machine; the scene has two equal peaks of T_in."""
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "press.toml"
    path.write_text(SCENES[request.param] + 2 * '[[peak]]\nquantity = "T_in"\n')
    return request.param, path, dx.Machine.read(path)


@cache
def values_of(name, outputs, machine):
    """The quantities over the motion by `grid`, in the units of the machine."""
    theta = np.radians(np.linspace(0, 720 if name == "two turns" else 360, 73))
    with using(machine.definitions):
        result = dx.grid(list(outputs), theta=theta, **machine)
    return {n: machine.units.of(n).shown(result[n].transpose("theta", ...).values) for n in outputs}


def assert_same(result, known):
    known = np.asarray(known, float)
    np.testing.assert_allclose(np.asarray(result, float), known, 1e-12, 1e-12 * np.abs(known).max())


def test_values(case, command):
    name, path, machine = case
    scene = dx.scene(path)
    known = values_of(name, scene.outputs, machine)
    run = scene.run()
    stored = dx.sweep(path, store="press.zarr")
    last = 720 if name == "two turns" else 360
    answer = command("grid", ",".join(scene.outputs), f"theta=0:{last}:73", "--machine", path)
    of_machine = machine.grid(scene.outputs, theta=np.linspace(0, last, 73))
    point = machine.evaluate(scene.outputs, theta=last / 8)
    for n in scene.outputs:
        for dataset in (run.dataset, of_machine):
            assert_same(dataset[n].transpose("theta", ...), known[n])
        scale = 1.0 if stored[n].units == machine.units.of(n).unit else float(machine.units.of(n).si)
        assert_same(stored[n].transpose("theta", ...) / scale, known[n])
        assert_same(np.moveaxis(np.array(answer[n]), answer["dims"][n].index("theta"), 0), known[n])
        assert_same(point[n], known[n][9])
    if name != DESIGNS:
        by_words = command("evaluate", ",".join(scene.outputs), f"theta={last / 8}", "--machine", path)
        assert_same([by_words[n] for n in scene.outputs], [point[n] for n in scene.outputs])


LANGUAGES = ["javascript", "octave", "c", "numba", "jax"]


@pytest.mark.parametrize("language", first(2, LANGUAGES))
def test_languages(case, language, tmp_path):
    """Of every design of the grid, to some ulp of the largest value."""
    name, path, machine = case
    scene = dx.scene(path)
    axes = {n: value for n, value in scene.inputs.items() if isinstance(value, tuple)}
    columns = [column.ravel() for column in np.meshgrid(*axes.values(), indexing="ij")]
    place = tmp_path / f"press{language_of(language).suffix}"
    dx.compile(path, place, to=language)
    values = caller(language, place, list(axes), scene.outputs)(columns)
    for n, known in values_of(name, scene.outputs, machine).items():
        assert_same(machine.units.of(n).shown(values[n]), known.ravel())


@pytest.mark.parametrize("name", first(2, dict.fromkeys(["two turns", "user-defined", *SCENES])))
def test_fmu(name, tmp_path):
    """At a given speed, whose angles are those that the importer integrated; of designs the first."""
    path = tmp_path / "press.toml"
    path.write_text(SCENES[name])
    machine, outputs = dx.Machine.read(path), dx.scene(path).outputs
    place = dx.compile(path, tmp_path / "press.fmu", to="fmu", input="omega")
    speed, end = 10 * np.pi, 0.4 if name == "two turns" else 0.2
    result = simulated(str(place), "ModelExchange", end, 0.01, ["theta", *outputs], omega=speed, theta0=0.0)
    design = {n: np.ravel(v)[0] if hasattr(v, "tolist") else v for n, v in machine.items() if n != "omega0"}
    with using(machine.definitions):
        known = dx.evaluate(list(outputs), theta=result["theta"], omega=speed, alpha=0.0, **design)
    for n in outputs:
        assert_same(result[n], known[n])


def test_peaks(case, command):
    """The search is that of the whole cycle everywhere, and no less than any value of a fine grid."""
    name, path, machine = case
    known = machine.peak("T_in")
    theta = np.linspace(0, 720 if name == "two turns" else 360, 20_001)
    fine = np.abs(machine.grid(["T_in"], theta=theta)["T_in"].transpose("theta", ...).values).max(0)
    np.testing.assert_allclose(known["value"], fine, 1e-5)
    for result in dx.scene(path).run().peaks:
        assert_same(result.dataset["value"], known["value"])
        assert_same(result.dataset["theta"], known["theta"])
        assert_same(result.dataset["value_wrt_ec"], known["gradient"]["ec"])
    if name != DESIGNS:
        assert_same(command("peak", "T_in", "--machine", path)["value"], known["value"])
        assert_same(
            command("tolerance", "absmax:T_in", "ec=10 +- 0.1", "samples=9", "--machine", path)["value"],
            known["value"],
        )
    assert main(["run", str(path), "--report", "press.md"]) == 0
    page = path.with_name("press.md").read_text()
    for number in np.ravel(known["value"]):
        assert page.count(f"| {number:.6g} |") >= 2
    cycle = 720 if name == "two turns" else 360
    assert page.count(f"(theta from 0 to {cycle} deg)") == 1 + len(dx.scene(path).outputs)


def test_cycles_and_fits(case, command):
    name, path, machine = case
    if name == DESIGNS:
        return
    for call, words in (("drive", ["fluctuation=0.03"]), ("harmonics", ["T_in"]), ("counterweight", [])):
        options = {"fluctuation": 0.03} if call == "drive" else {}
        known = getattr(machine, call)(*(["T_in"] if call == "harmonics" else []), **options)
        result = command(call, *words, "--machine", path)
        for key, value in known.items():
            if isinstance(value, float) and math.isfinite(value):
                assert_same(result[key], value)
    theta = np.arange(0, 720 if name == "two turns" else 360, 17)
    rows = zip(theta, machine.evaluate("T_in", theta=theta), strict=True)
    path.with_name("run.csv").write_text("theta [deg],T_in [N m]\n" + "".join(f"{a},{b}\n" for a, b in rows))
    result = command("fit", "run.csv", "over.m_slider=1:9", "sigma.T_in=1", "--machine", path)
    assert result["value"]["m_slider"] == pytest.approx(4.0, rel=1e-6)
    torque = re.search(r"torque, mean \| (\S+) N m", _report(machine))[1]
    assert float(torque) == pytest.approx(machine.drive()["torque_mean"], rel=1e-5, abs=1e-9)


def _report(machine):
    return machine.report("drive.md", "T_in", theta=[0.0, 60.0]).read_text()


def test_a_scene_of_a_machine_is_that_machine(case):
    _, path, machine = case
    again = machine.to_scene(path.with_name("again.toml"), dx.scene(path).outputs)
    assert dx.Machine.read(again) == machine
    assert dx.scene(again).run().dataset["T_in"].units == dx.scene(path).run().dataset["T_in"].units
