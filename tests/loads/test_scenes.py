"""Loads that vary with the motion in scenes: files and points, grids, peaks, checks, plans."""

import re

import jsonschema
import numpy as np
import pytest

import desaxe as dx
from desaxe.scenes.schema import SceneError, json_schema
from tests.compiler.languages.tools import imported

SCENE = """
outputs = ["T_in", "T_in_wrt_theta"]
[mechanism]
ec = [0.0, 0.01]
AB = 0.04
BC = 0.064
[motion]
theta = {{ start = 0, stop = "360 deg", num = 25 }}
omega0 = 200.0
[masses]
m_slider = 0.8
[loads]
F_Y = {load}
[[peak]]
quantity = "T_in"
[[check]]
at = {{ ec = 0.01, theta = 1.0 }}
printed = {{ T_in = "{printed}" }}
"""
ANGLES, FORCES = [0.0, 90.0, 180.0, 270.0], [0.0, -400.0, -50.0, 20.0]
DESIGN = {"AB": 0.04, "BC": 0.064, "omega0": 200.0, "m_slider": 0.8}


def write(folder, load):
    path = folder / "press.toml"
    right = dx.evaluate("T_in", theta=1.0, ec=0.01, F_Y=expected(), **DESIGN)
    path.write_text(SCENE.format(load=load, printed=f"{right:.6g} N m"), "utf-8")
    return path


def expected():
    return dx.over_theta([f"{angle} deg" for angle in ANGLES], FORCES, kind="linear")


LOADS = {
    "file": '{ over_theta = "press.csv", theta = "deg", value = "N", kind = "linear" }',
    "points": '{ over_theta = [["0 deg", "0 N"], ["90 deg", -400], ["180 deg", -50], ["270 deg", "0.02 kN"]]'
    ', kind = "linear" }',
    "two lists": '{ over_theta = [0, 90, 180, 270], values = [0, -400, -50, 20], theta = "deg"'
    ', kind = "linear" }',
}


@pytest.mark.parametrize("kind", LOADS)
def test_a_scene_gives_what_the_calls_give(kind, tmp_path):
    (tmp_path / "press.csv").write_text("\n".join(f"{a}, {f}" for a, f in zip(ANGLES, FORCES, strict=True)))
    scene = dx.scene(write(tmp_path, LOADS[kind]))
    assert scene.inputs["F_Y"](1.0) == pytest.approx(expected()(1.0))
    result = scene.run()
    theta = result.dataset.theta.values
    grid = dx.grid(["T_in", "T_in_wrt_theta"], ec=[0.0, 0.01], theta=theta, F_Y=scene.inputs["F_Y"], **DESIGN)
    for name in ("T_in", "T_in_wrt_theta"):
        np.testing.assert_array_equal(result.dataset[name], grid[name])
    peak = dx.peak("T_in", ec=np.array([0.0, 0.01]), F_Y=scene.inputs["F_Y"], **DESIGN)
    np.testing.assert_allclose(result.peaks[0].dataset.value, peak["value"], rtol=1e-14)
    assert result.checks[0].agrees
    assert "F_Y: over theta, " in str(dx.explain(scene))


def test_over_Y_and_objects_in_a_mapping():
    load = dx.over_Y([0.03, 0.06, 0.1], [-900, -200, -30], [-90, -20, -3])
    base = {
        "outputs": ["T_in"],
        "mechanism": {"ec": 0.01, "AB": 0.04, "BC": 0.064},
        "motion": {"theta": [0.5, 1.0, 4.0], "omega0": 200.0},
    }
    rows = [[0.03, -900, -90], [0.06, -200, -20], [0.1, -30, -3]]
    written = dx.scene({**base, "loads": {"F_Y": {"over_Y": rows}}})
    given = dx.scene({**base, "loads": {"F_Y": load}})
    assert written == given
    right = dx.evaluate(
        "T_in", theta=np.array([0.5, 1.0, 4.0]), ec=0.01, AB=0.04, BC=0.064, omega0=200.0, F_Y=load
    )
    np.testing.assert_allclose(written.run().dataset.T_in, right, rtol=1e-14)


ELEMENTS = {  # a table -> Y, V_C, and the force of a spring or a damper there, by hand
    '{ spring = "4 N/mm", free = "120 mm" }': (0.1, 3.0, 80.0),
    "{ spring = 4000, free = 0.12 }": (0.15, 3.0, -120.0),
    '{ damper = "200 N s/m" }': (0.1, 3.0, -600.0),
    "{ damper = 200, quadratic = 0.8 }": (0.1, -3.0, 607.2),
    "{ damper = 200, scale = -1.5 }": (0.1, -3.0, -900.0),
    "{ over_V = [[-2, 900], [2, -400]], scale = 0.5 }": (0.1, 2.0, -200.0),
    "{ over_V = [[-2, 900], [0, 0], [2, -400]] }": (0.1, 1.0, -200.0),
    '{ over_V = [-2, 0, 2], values = [0.9, 0, -0.4], value = "kN" }': (0.1, -1.0, 450.0),
}


@pytest.mark.parametrize("load", ELEMENTS)
def test_springs_and_dampers(load, tmp_path):
    """Their work on a massless crank is that of the force along the slider's axis: T_in = -F_Y dY/dtheta."""
    at_Y, at_V, force = ELEMENTS[load]
    scene = dx.scene(write(tmp_path, load))
    element = scene.inputs["F_Y"]
    where = {"Y": at_Y, "V_C": at_V}
    assert element(*(where[name] for name in element.needs)) == pytest.approx(force, rel=1e-12)
    design = {"theta": 1.0, "ec": 0.01, "AB": 0.04, "BC": 0.064}
    motion = dx.evaluate(["Y", "V_C"], omega0=200.0, **design)
    by_hand = element(*(motion[name] for name in element.needs))
    torque = dx.evaluate("T_in", omega0=200.0, F_Y=element, **design)
    assert torque == pytest.approx(-by_hand * motion["V_C"] / 200.0, rel=1e-12)


def test_plain_numbers_of_a_spring_are_in_the_units_of_the_scene():
    scene = {"outputs": ["T_in"], "units": "mm, deg", "loads": {"F_Y": {"spring": 4, "free": 120}}}
    scene |= {"mechanism": {"ec": 10, "AB": 40, "BC": 64}, "motion": {"theta": [0, 90], "omega0": 10}}
    assert dx.scene(scene).inputs["F_Y"] == dx.spring("4 N/mm", free="120 mm")


def test_a_list_of_loads_is_their_sum(tmp_path):
    press = dx.Machine(ec=10, AB=40, BC=64, omega0=20, units="mm, deg, rad/s, kN")
    spring, damper = press.spring(0.004, 120), press.damper("200 N s/m")
    load = spring + damper + press.over_Y([30, 100], [-0.9, 0], [0, 0]) - 0.04
    for k, each in enumerate((load, 2.5 * spring, load - spring - 2 * damper)):
        path = press.replace(F_Y=each).to_scene(tmp_path / f"press_{k}.toml", "T_in")
        assert dx.Machine.read(path)["F_Y"] == each
    scene = {"outputs": ["T_in"], "units": "mm, deg", "mechanism": {"ec": 10, "AB": 40, "BC": 64}}
    scene |= {"motion": {"theta": [0, 90], "omega0": 20}}
    parts = [{"spring": 4, "free": 120}, {"damper": "200 N s/m"}, -40]
    read = dx.scene({**scene, "loads": {"F_Y": parts}}).inputs["F_Y"]
    assert read(Y=100, V_C=-500) == pytest.approx(80 + 100 - 40)
    jsonschema.validate({"outputs": ["T_in"], "loads": {"F_Y": parts}}, json_schema())
    for wrong, message in (
        ([{"spring": 4}, 5], "loads.F_Y #1.free is missing"),
        ([{"damper": 1}, {"start": 0, "stop": 1, "num": 2}], "loads.F_Y #2: a sum is of loads and numbers"),
        ([{"damper": 1}, [3]], "loads.F_Y #2"),
        ([{"damper": 1, "scale": np.inf}], "loads.F_Y #1.scale = inf: expected a finite number"),
    ):
        with pytest.raises(SceneError, match=message):
            dx.scene({**scene, "loads": {"F_Y": wrong}})
    with pytest.raises(TypeError, match="is not data"):
        press.replace(F_Y=spring + press.over_Y(np.sin)).to_scene(tmp_path / "sine.toml", "T_in")


REFUSED = {
    "{ spring = 4000 }": "loads.F_Y.free is missing: the position along Y",
    "{ spring = -1, free = 0 }": "loads.F_Y: stiffness = -1",
    "{ damper = 1, free = 0 }": "loads.F_Y.free = 0: it has no place beside damper",
    '{ over_V = "throttle.csv" }': "loads.F_Y: expected points such as [[-2, 900]",
    '{ over_theta = "nowhere.csv" }': 'loads.F_Y.over_theta = "nowhere.csv": No such file',
    "{ over_theta = [[0, 1], [1, 2, 3]] }": "points such as",
    "{ over_theta = [0, 1] }": "over_theta: point 1 has 1 number: expected points such as [[0, 0], [1.57",
    '{ over_stroke = [[0, 1, 0], [5, 1, 0], [9, 1]], dead_centre = "outer" }': "point 3 has 2 numbers",
    "{ over_Y = [[0, 1], [5, 1, 0], [6, 1], [7, 0, 0], [9, 0]] }": "over_Y: point 2 has 3 numbers, most 2",
    "{ over_Y = [[0, -400, 1, 2], [5, -300, 0, 3]] }": "point 1 has 4 numbers: expected points such as [[0.2",
    "{ over_Y = [] }": "loads.F_Y: over_Y: no points: expected points such as [[0.2",
    "{ over_theta = [[0, 1], [9, 2]] }": "the angles go over 9 rad",
    "{ over_theta = [[0, 1], [1, 2]], step = 3 }": "loads.F_Y.step = 3: it has no place beside over_theta",
    '{ start = 0, stop = 1, num = 3, kind = "linear" }': 'loads.F_Y.kind = "linear": it belongs to',
    "{ start = 0, num = 3 }": "loads.F_Y.stop is missing",
    "{ over = 3 }": "loads.F_Y.over = 3: unknown key",
}


@pytest.mark.parametrize("load", REFUSED)
def test_what_is_no_load_is_refused(load, tmp_path):
    path = write(tmp_path, load)
    with pytest.raises(SceneError, match=re.escape(REFUSED[load])):
        dx.scene(path)


def test_what_no_module_can_hold_is_refused(tmp_path):
    inside = {
        "mechanism": {"ec": 0.0, "AB": 0.04, "BC": 0.064},
        "motion": {"theta": [0.5, 1.0], "omega0": 1.0},
    }
    scene = {"outputs": ["F_C_Y"], **inside, "loads": {"F_Y": dx.over_theta(np.sin)}}
    with pytest.raises(SceneError, match=r"loads.F_Y = .* holds tables over theta"):
        dx.compile(scene, tmp_path / "press.py")
    with pytest.raises(SceneError, match=r"loads.F_Y = .* holds tables over theta"):
        dx.compile(scene, tmp_path / "press", to="c")
    with pytest.raises(TypeError, match="a page holds numbers, tables, springs"):
        dx.explore(scene, tmp_path / "press.html")


def test_the_schema_knows_loads():
    rules = json_schema()
    scene = {"outputs": ["T_in"], "loads": {"F_Y": {"over_theta": "press.csv", "theta": "deg"}}}
    jsonschema.validate(scene, rules)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({"loads": {"F_Y": {"over_phi": "press.csv"}}}, rules)


@pytest.mark.thorough
def test_a_module_of_given_states_has_its_inputs_in_one_order(tmp_path):
    """Speeds of both signs and none, where alpha decides the way; F_Y as a load and as an axis."""
    stroke = dx.over_Y([0.02, 0.05, 0.1], [-900, -200, -30], [-90, -40, -3])
    for count, force in enumerate((stroke, [-100.0, 50.0])):
        scene = dx.scene({
            "outputs": ["T_in", "T_in_wrt_AB"],
            "mechanism": {"AB": 0.04, "BC": 0.064, "ec": 0.01},
            "motion": {"omega": [-50.0, 0.0, 50.0], "alpha": -3.0, "theta": [0.5, 2.0, 4.0, 5.0]},
            "masses": {"m_slider": 0.8},
            "loads": {"F_Y": force},
        })  # fmt: skip
        name = f"states_{count}"
        module = imported(dx.compile(scene, tmp_path / f"{name}.py"))
        right, result = scene.run().dataset, module.run()
        axes = np.meshgrid(*module.AXES.values(), indexing="ij")
        points = module.evaluate(**dict(zip(module.AXES, axes, strict=True)))
        for key in ("T_in", "T_in_wrt_AB"):
            for values in (result[key], points[key]):
                np.testing.assert_allclose(values, right[key].transpose(*module.AXES), rtol=1e-12)


@pytest.mark.parametrize(
    ("table", "expected"),
    [
        ({"over_Y": [[225, 0, 0], [475, -2, -0.05]]}, ([0, -2000], [0, -50])),
        ({"over_Y": [225, 475], "outward": [0, -2], "inward": [0, "-50 N"]}, ([0, -2000], [0, -50])),
        ({"over_Y": [[0.225, 0], [0.475, -2000]], "Y": "m", "value": "N"}, ([0, -2000], None)),
    ],
)
def test_plain_points_are_in_the_units_of_the_scene(table, expected):
    scene = {"outputs": ["N_C"], "units": {"length": "mm", "force": "kN"}, "loads": {"F_Y": table}}
    scene |= {"mechanism": {"ec": 12, "AB": 125, "BC": 350}, "motion": {"theta": [0.0, 1.0], "omega0": 10.0}}
    load = dx.scene(scene).inputs["F_Y"]
    plain = dx.over_Y(["225 mm", "475 mm"], *(None if part is None else part for part in expected))
    assert (load.outward, load.inward) == (plain.outward, plain.inward)


def test_angles_of_a_table_are_in_the_units_of_the_scene(tmp_path):
    machine = dx.Machine(
        ec=12, AB=125, BC=350, omega0=1500, m_slider=0.8, units="mm, deg, rpm",
        F_Y=dx.over_theta(["0 deg", "90 deg", "180 deg"], [0, -500, 0], kind="linear"),
    )  # fmt: skip
    written = dx.scene(machine.to_scene(tmp_path / "press.toml", outputs=["T_in"]))
    assert written.inputs["F_Y"] == machine["F_Y"]
    scene = {
        "outputs": ["T_in"], "units": "mm, deg", "mechanism": {"ec": 12, "AB": 125, "BC": 350},
        "motion": {"theta": [0, 90], "omega0": 157.0},
        "loads": {"F_Y": {"over_theta": [[0, 0], [90, -500], [180, 0]], "kind": "linear", "period": 360}},
    }  # fmt: skip
    assert dx.scene(scene).inputs["F_Y"] == machine["F_Y"]
    (tmp_path / "gas.csv").write_text("theta [deg];F_Y [kN]\n0;0\n90;-0.5\n180;0\n", "utf-8")
    of_file = {"over_theta": str(tmp_path / "gas.csv"), "kind": "linear", "period": 360}
    for units, more in (("mm, deg", {}), ("mm, rad", {"theta": "deg"})):
        read = dx.scene({**scene, "units": units, "loads": {"F_Y": {**of_file, **more}}}).inputs["F_Y"]
        assert read.table == machine["F_Y"].table
