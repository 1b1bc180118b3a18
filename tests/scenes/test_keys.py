"""Every key of a scene goes all roads: it is read, explained, run and reported."""

import pytest

import desaxe as dx
from desaxe.cli import main
from desaxe.scenes.schema import SCENE
from desaxe.scenes.written import toml
from tests.effort import first

LENGTHS = {"AB": "50 mm", "BC": "200 mm", "ec": "10 mm"}
SMALL = {"mechanism": LENGTHS, "motion": {"theta": {"start": 0, "stop": "360 deg", "num": 9}, "omega0": 30.0}}
HEAVY = {**SMALL, "masses": {"m_slider": 4.0, "I_crank": 2.0}, "outputs": ["T_in"]}
OVER_THETA = {"over_theta": [0, 90, 200], "values": [0, -2, -1], "period": 360, "theta": "deg", "value": "kN"}
STROKE = {"over_stroke": [[0, 9], [5, 1]], "distance": "mm", "value": "bar", "bore": "60 mm",
          "kind": "linear", "ambient": "1 bar", "dead_centre": "outer"}  # fmt: skip
SPEEDS = {"over_V": [-1, 0, 1], "V_C": "m/s", "values": [50, 0, -60], "value": "N", "kind": "linear"}
OVER_Y = {"over_Y": [0.1, 0.2], "outward": [4, 2], "inward": [3, 1], "Y": "m", "value": "bar", "area": 1e-3}
POINTS = {"over_omega": "motor.csv", "omega": "rpm", "torque": "N m", "kind": "linear"}
KLOSS = {"breakdown_torque": 90, "breakdown_slip": 0.2, "synchronous_speed": "1500 rpm", "gear": 20}
PEAK = {
    "title": "The peak", "quantity": "a_C", "kind": "max", "over": {"ec": [0, "20 mm"]}, "theta": [0, 3.0],
    "sensitivities": ["ec"], "baseline": {"ec": 0},
    "claim": [{"at": {"ec": "20 mm"}, "increase": "90 %", "source": "somebody"}],
}  # fmt: skip
CHECK = {
    "title": "A check",
    "source": "a book",
    "at": {"theta": 1, "ec": 0},
    "digits": 2,
    "printed": {"Y": "0.22 m"},
}
PICTURE = {"title": "A picture", "file": "Y.png", "quantity": "Y", "over": "theta",
           "family": {"ec": [0, 0.01]}, "at": {"AB": 0.04}}  # fmt: skip
FACTOR = {"expression": "f * abs(V_C)", "unit": "m/s", "meaning": "a share", "constants": {"f": 0.5}}

# A scene -> words that explain says of it, that the terminal and the page say of its run, and the page alone.
SCENES = {
    "a grid": (
        {**SMALL, "title": "A press", "units": "mm, deg, rpm", "outputs": ["a_C"], "accuracy": 1e-9,
         "threads": 1, "reduce": {"theta": "absmax"}, "mechanism": {**LENGTHS, "branch": -1},
         "motion": {"theta": {"start": 0, "stop": "1 rad", "step": "0.25 rad"}, "omega0": 30, "alpha": 1}},
        ["of each over theta: absmax", "standard: at", "alpha = 1 rad/s^2"],
        ["A press", "a_C (absmax over theta)"],
    ),
    "a state": (
        {**SMALL, "motion": {"theta": [0.5, 1], "omega": 3.0}, "outputs": ["V_C"],
         "results": {"data": "a.csv"}},
        ["a given state", "results  a.csv"], ["a.csv", "V_C over theta (2)"],
    ),
    "a store": (
        {**SMALL, "outputs": ["V_C"],
         "results": {"store": "a.zarr", "chunks": {"theta": 5}, "memory": "100 MB"}},
        ["2 of 5 theta, written to a.zarr"], ["in the store a.zarr"],
    ),
    "requests": (
        {**SMALL, "peak": [PEAK], "check": [CHECK], "picture": [PICTURE]},
        ["max of a_C", "picture of Y", "printed values"],
        ["The peak", "somebody 90 %", "A check", "a book", "Y.png"],
    ),
    "bodies": (
        {**HEAVY, "masses": {"m_crank": 1, "m_rod": 1, "m_slider": 4, "I_crank": 0.01, "I_rod": 0.01,
                             "r_crank": 0.01, "r_rod": 0.1},
         "loads": {"g_X": 1, "g_Y": -9.81, "mu": 0.1, "F_X": -5, "F_Y": {**OVER_THETA, "kind": "linear"}}},
        ["over theta", "r_rod"], ["T_in over theta (9)"],
    ),
    "loads": (
        {**HEAVY, "loads": {"F_Y": [{**STROKE, "scale": 0.5}, SPEEDS, "-3 N"],
                            "F_X": [OVER_Y, {"spring": "4 N/mm", "free": "120 mm"},
                                    {"damper": "20 N s/m", "quadratic": 3}]}},
        ["F_Y", "F_X"], ["T_in over theta (9)"],
    ),
    "a motor": (
        {**HEAVY, "steady": {"torque": POINTS, "flywheel_inertia": [1, 2]}},
        ["steady state on a motor", "2 designs"], ["Steady state", "omega_mean"],
    ),
    "a motor by numbers": (
        {**HEAVY, "steady": {"torque": {"kloss": KLOSS}, "fluctuation": 0.02}},
        ["steady state on a motor"], ["Steady state", "flywheel_inertia"],
        ["omega_mean [rad/s]", "its loop on the motor's curve", "for a fluctuation of 2 %"],
    ),
    "a quantity": (
        {**SMALL, "outputs": ["share"], "quantities": {"share": FACTOR}},
        ["a share"], ["share over theta (9)"],
    ),
}  # fmt: skip


def keys_of(rule):
    """The keys that a rule allows, also inside of its tables and lists."""
    for name, part in rule.get("properties", {}).items():
        yield name
        yield from keys_of(part)
    inside = [rule.get("items"), rule.get("additionalProperties"), *rule.get("anyOf", ())]
    for part in inside:
        yield from keys_of(part) if isinstance(part, dict) else ()


def keys_in(data):
    """The keys that a scene has."""
    for name, part in data.items() if isinstance(data, dict) else ((None, one) for one in data):
        yield name
        yield from keys_in(part) if isinstance(part, (dict, list)) else ()


def test_there_is_a_scene_for_every_key():
    assert {*keys_of(SCENE)} <= {key for scene, *_ in SCENES.values() for key in keys_in(scene)}


FIRST = ("requests", "loads", "a motor by numbers", "a store", "a quantity")


@pytest.mark.parametrize("name", first(len(FIRST), dict.fromkeys((*FIRST, *SCENES))))
def test_a_key_goes_all_roads(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    data, explained, reported, *of_page = SCENES[name]
    (tmp_path / "press.toml").write_text(toml(data))
    (tmp_path / "motor.csv").write_text("speed,torque\n0,90\n3000,0\n")
    scene = dx.scene(data)
    assert dx.scene("press.toml") == scene
    assert [word for word in explained if word not in str(dx.explain(scene))] == []
    assert main(["run", "press.toml", "--report", "page.md"]) == 0
    said = capsys.readouterr().out
    page = (tmp_path / "page.md").read_text().replace("\\", "")
    assert [word for word in reported if word not in said] == []
    paged = [*(word for word in reported if "." not in word), *(word for words in of_page for word in words)]
    assert [word for word in paged if word not in page] == []
