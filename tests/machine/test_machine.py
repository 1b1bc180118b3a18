"""Machines: methods equal functions, `**machine` works everywhere, frozen, shown, written and read."""

import copy
import inspect
import pickle

import numpy as np
import pytest

import desaxe as dx
from tests.effort import first

INPUTS = {
    "ec": 0.01, "AB": 0.05, "BC": 0.2, "omega0": 30.0, "m_crank": 0.5, "m_rod": 1.0, "m_slider": 4.0,
    "F_Y": -600.0, "g_Y": -9.81, "mu": 0.12,
}  # fmt: skip
PRESS = dx.Machine(**INPUTS)
# A call of each function: what is given besides the inputs of the machine.
CALLS = {
    "evaluate": {"names": ["T_in", "status", "T_in_wrt_ec"], "theta": [0.3, 1.0]},
    "grid": {"names": "T_in", "theta": [0.0, 1.0, 2.0], "ec": [0.0, 0.02]},
    "peak": {"name": "T_in", "kind": "min"},
    "events": {},
    "feasibility": {},
    "inverse": {"Y": 0.2, "V_C": 1.0},
    "simulate": {"torque": 50.0, "t_end": 0.01, "I_crank": 1.0, "names": ["a_C"]},
    "optimize": {"maximize": "time_ratio", "over": {"ec": (0.0, 0.1)}, "keep": {"margin": (0.02, None)}},
    "design_map": {"names": "stroke", "ec": [0.0, 0.02]},
    "tolerance": {"name": "stroke", "AB": dx.plus_minus(0.05, 0.0001), "samples": 100},
    "enclose": {"name": "Y", "theta": dx.between(1.0, 1.01)},
    "harmonics": {"name": "F_shaking_Y", "orders": 2},
    "counterweight": {"radius": 0.03},
    "drive": {"fluctuation": 0.05},
    "steady": {"torque": dx.kloss(40.0, 0.15, 157.08, gear=12), "flywheel_inertia": 2.0},
    "synthesize": {"stroke": 0.1, "time_ratio": 1.1, "BC": 0.3},
}


def same(result, expected):
    if isinstance(expected, dict):
        assert type(result) is type(expected)
        assert list(result) == list(expected)
        for key in expected:
            if key != "solution":
                same(result[key], expected[key])
    elif hasattr(expected, "identical"):
        assert result.attrs == expected.attrs
        assert list(result.variables) == list(expected.variables)
        for name, array in expected.variables.items():
            assert (result[name].dims, str(result[name].attrs)) == (array.dims, str(array.attrs))
            np.testing.assert_allclose(result[name], array, rtol=1e-9, atol=1e-9)
    elif expected is None or isinstance(expected, str):
        assert result == expected
    elif isinstance(expected, (list, tuple)):
        assert len(result) == len(expected)
        for one, other in zip(result, expected, strict=True):
            same(one, other)
    else:
        np.testing.assert_allclose(result, expected, rtol=1e-9, atol=1e-9)  # plain Python or compiled


@pytest.mark.parametrize("name", CALLS)
def test_a_method_is_its_function(name):
    function, given = getattr(dx, name), CALLS[name]
    result = getattr(PRESS, name)(**given)
    takes = inspect.signature(function).parameters
    anything = any(p.kind is p.VAR_KEYWORD for p in takes.values())
    free = {**given, **given.get("over", {})}
    inputs = {k: v for k, v in INPUTS.items() if k not in free and (anything or k in takes)}
    inputs = {} if name == "synthesize" else inputs
    inputs |= {"omega_start": INPUTS["omega0"]} if name == "simulate" else {}
    same(result, function(**given, **inputs))
    if name not in ("optimize", "synthesize"):  # a machine can be unpacked everywhere
        same(result, function(**given, **{k: v for k, v in PRESS.items() if k not in given}))


def test_signatures_and_documentation_are_those_of_the_functions():
    for name in CALLS:
        function, method = getattr(dx, name), getattr(dx.Machine, name)
        own, theirs = inspect.signature(method).parameters, inspect.signature(function).parameters
        assert set(theirs) - {"sliders"} <= set(own)
        assert "sliders" not in own  # a crankshaft fills them in
        assert [n for n in own if n not in theirs] == ["self", "as_quantity"]
        assert inspect.getdoc(function).splitlines()[0] in method.__doc__
        assert method.__name__ == name
        assert not [p for p in own.values() if p.name in ("ec", "AB", "BC") and p.default is p.empty]
        assert name in dir(PRESS)
    assert "source" not in inspect.signature(PRESS.explore).parameters


def test_arguments_may_stand_without_their_names():
    assert PRESS.peak("T_in") == PRESS.peak(name="T_in") == dx.peak("T_in", **INPUTS)
    assert PRESS.evaluate("a_C", theta="60 deg") == dx.evaluate("a_C", theta="60 deg", **INPUTS)
    with pytest.raises(TypeError, match="two values of name"):
        PRESS.peak("T_in", name="a_C")
    with pytest.raises(TypeError, match="takes 1 arguments without a name"):
        PRESS.peak("T_in", "a_C")
    with pytest.raises(TypeError, match="m_piston"):
        PRESS.peak("T_in", m_piston=1.0)


def test_inputs_in_a_call_replace_those_of_the_machine():
    assert PRESS.events(ec=0)["time_ratio"] == 1.0
    state = PRESS.evaluate("T_in", theta=1.0, omega=3.0, alpha=2.0)
    rest = {k: v for k, v in INPUTS.items() if k != "omega0"}
    assert state == dx.evaluate("T_in", theta=1.0, omega=3.0, alpha=2.0, **rest)
    assert PRESS.evaluate("T_in", theta=1.0, mu=None) == dx.evaluate(
        "T_in", theta=1.0, **{**INPUTS, "mu": 0.0}
    )


def test_it_is_a_frozen_mapping():
    assert dict(PRESS) == INPUTS
    assert dx.Machine(INPUTS) == PRESS == dx.Machine(PRESS)
    assert hash(dx.Machine(INPUTS)) == hash(PRESS)
    assert pickle.loads(pickle.dumps(PRESS)) == PRESS
    assert dx.Machine(PRESS, units="mm") != PRESS
    assert PRESS.replace(ec=0.02) != PRESS
    with pytest.raises(AttributeError, match="frozen"):
        PRESS.units = "mm"
    with pytest.raises(TypeError):
        PRESS["ec"] = 1.0
    with pytest.raises(AttributeError):
        del PRESS.units


@pytest.mark.parametrize("again", [copy.copy, copy.deepcopy, lambda m: pickle.loads(pickle.dumps(m))])
def test_its_arrays_stay_as_they_are(again):
    """Nothing changes the hash of a machine, where it comes from another process neither."""
    first = dx.Machine(ec=[0.0, 0.01], AB=0.1, BC=0.3, omega0=np.array([1.0, 2.0]))
    result = again(first.replace(m_slider=[1.0, 2.0]))
    for machine in (
        first,
        result,
        again(result),
        result.replace(AB=0.11),
        dx.Machine(result),
        dx.Machine(dict(result)),
    ):
        before = hash(machine)
        for name in ("ec", "omega0"):
            with pytest.raises(ValueError, match="read-only"):
                machine[name][0] = 5.0
        assert hash(machine) == before
        assert machine == again(machine)


def test_replace():
    other = PRESS.replace(ec="12 mm", mu=None)
    assert other["ec"] == 0.012
    assert "mu" not in other
    assert "mu" in PRESS
    running = PRESS.replace(omega=3.0)
    assert "omega0" not in running
    assert PRESS.replace(branch=-1)["branch"] == -1
    assert PRESS.replace(branch=-1).replace(branch=1) == PRESS


def test_families_of_designs():
    family = PRESS.replace(ec=["0 mm", "10 mm", "20 mm"])
    np.testing.assert_array_equal(family["ec"], [0.0, 0.01, 0.02])
    np.testing.assert_array_equal(
        family.peak("a_C")["value"], dx.peak("a_C", **{**INPUTS, "ec": [0.0, 0.01, 0.02]})["value"]
    )
    assert "3 of 3 designs" in repr(family)
    assert "(3 values)" in repr(family)
    assert hash(family) == hash(pickle.loads(pickle.dumps(family)))
    with pytest.raises(ValueError, match="read-only"):
        family["ec"][0] = 1.0


def test_a_load_that_is_a_function_stays_it():
    def force(theta):
        return -600.0 * (np.cos(theta) > 0.5)

    press = PRESS.replace(F_Y=force)
    assert press["F_Y"] is force
    assert press.harmonics("T_in")["mean"] == dx.harmonics("T_in", **{**INPUTS, "F_Y": force})["mean"]
    assert "function" in repr(press)
    with pytest.raises(TypeError, match="F_Y"):
        press.to_scene("nowhere.toml")


def test_it_shows_itself():
    text = repr(PRESS)
    for words in (
        "0.05 m",
        "30 rad/s",
        "-600 N",
        "stroke      0.100134 m",
        "time_ratio",
        "turns       yes",
    ):
        assert words in text, words
    assert max(map(len, text.splitlines())) <= 100
    page = PRESS._repr_html_()
    for words in ("<img", "0.05 m", "friction of the guide", "stroke"):
        assert words in page
    stuck = dx.Machine(ec=0.1, AB=0.2, BC=0.25)
    assert "no (rocker)" in repr(stuck)
    assert "stroke" not in repr(stuck)
    impossible = dx.Machine(ec=1.0, AB=0.2, BC=0.25)
    assert "cannot be assembled" in repr(impossible)
    assert "<img" not in impossible._repr_html_()
    assert repr(dx.Machine(m_slider=2.0)).endswith("mass of the slider")


def test_from_a_scene_and_back(tmp_path):
    for machine in (
        PRESS,
        dx.Machine(PRESS, units="mm, deg, rpm"),
        PRESS.replace(branch=-1, ec=[0.0, 0.01]),
        dx.Machine(PRESS, units={"length": "in", "force": "lbf"}),
    ):
        path = machine.to_scene(tmp_path / "press.toml", outputs="T_in", title="a press", theta=[0, "60 deg"])
        assert dx.Machine.read(path) == machine
        assert dx.scene(path).outputs == ("T_in",)
        assert dx.Machine(dx.Machine.read(path)) == machine
    assert dx.Machine.read(path, units="mm").units.units == {"length": "mm"}
    mapping = {"mechanism": {"ec": 0, "AB": "50 mm", "BC": 0.2}, "motion": {"omega0": 3}, "outputs": ["a_C"]}
    with pytest.raises(ValueError, match="theta"):
        dx.scene(mapping)
    for more in ({}, {"outputs": []}, {"motion": {"omega0": 3, "theta": 1}}):  # a machine needs neither
        assert dict(dx.Machine({**mapping, **more})) == {"ec": 0.0, "AB": 0.05, "BC": 0.2, "omega0": 3.0}


def test_a_scene_of_a_machine_runs():
    values = PRESS.scene(["T_in"], theta=[0, "60 deg"]).run().dataset
    assert float(values.T_in[1]) == pytest.approx(PRESS.evaluate("T_in", theta="60 deg"), rel=1e-13)


def test_a_scene_of_a_machine_takes_other_inputs_as_a_grid_does(tmp_path):
    """As `replace` takes them, in its units; with omega0 there is no omega."""
    press = dx.Machine(ec="1 mm", AB="40 mm", BC="100 mm", omega="3 rad/s", units="mm")
    load = press.over_Y([60.0, 150.0], [-10.0, 90.0])
    for more in ({"ec": [0, 5]}, {"ec": ["0.5 cm", "5 mm"], "BC": 120}, {"omega0": 2.0}, {"F_Y": load}):
        assert press.scene("Y", **more) == press.replace(**more).scene("Y")
        press.to_scene(tmp_path / "press.toml", "Y", **more)
        assert dx.scene(tmp_path / "press.toml") == press.scene("Y", **more)
    result = press.scene("Y", ec=[0, 5], theta=[0.0, 1.0]).run().dataset
    grid = press.grid("Y", ec=[0, 5], theta=[0.0, 1.0]).Y
    np.testing.assert_array_equal(result.Y, grid.transpose(*result.Y.dims))
    with pytest.raises(ValueError, match="AB = -1"):
        press.scene("Y", AB=-1)


@pytest.mark.parametrize(
    ("inputs", "error", "words"),
    [
        ({"AB": -1.0}, ValueError, "AB = -1.0"),
        ({"AB": "50 kg"}, ValueError, "AB = '50 kg'"),
        ({"AB": [0.1, -0.2]}, ValueError, "AB = -0.2"),
        ({"AB": [[0.1, 0.2]]}, ValueError, "one dimension"),
        ({"theta": 1.0}, TypeError, "theta is where the crank is"),
        ({"m_piston": 1.0}, TypeError, "m_piston"),
        ({"branch": 2}, ValueError, "branch = 2"),
        ({"omega": 1.0}, ValueError, "not both"),
        ({"units": "furlong, mm"}, ValueError, "two units of length"),
        ({"units": 3}, TypeError, "units = 3"),
    ],
)
def test_bad_input(inputs, error, words):
    with pytest.raises(error, match=words):
        dx.Machine(**{**INPUTS, **inputs})
    with pytest.raises(TypeError, match=r"Machine.read"):
        dx.Machine("press.toml")


def test_pictures(tmp_path):
    assert PRESS.plot("a_C", ec=[0, 0.01, 0.02])[0].figure.axes[0].get_ylabel().startswith("acceleration")
    assert set(PRESS.plot(["V_C", "T_in"], theta=[0.0, 1.0, 2.0])) == {"V_C", "T_in"}
    press = dx.Machine(PRESS, units="mm, deg, rpm")
    (line,) = press.plot("a_C")
    assert "[mm s$^{-2}$]" in line.axes.get_ylabel() or "mm/s" in line.axes.get_ylabel()
    assert line.get_xdata()[-1] == 360.0
    assert press.plot.polar("T_in")[0].get_xdata()[-1] == pytest.approx(2 * np.pi)
    axes = press.plot.mechanism(45).axes
    assert axes.get_xlabel() == "X [mm]"
    assert "ec = 10 mm" in [text.get_text() for text in axes.texts]
    assert len(press.plot.tornado("T_in", {"ec": 0.1, "m_slider": "10 g"})[0]) == 2
    dx.plot.save(press.plot.animate("V_C", frames=2), tmp_path / "press.gif")
    assert press.plot.design_map("stroke", ec=[0, 10, 20], BC=[150, 200]) is not None
    assert "T_in" in press.plot.drive(fluctuation=0.02)


@pytest.mark.parametrize(
    ("periods", "turns"), first(1, [((720.0,), 2), ((720.0, 1080.0), 6), ((120.0, 360.0), 1)])
)
def test_peaks_curves_and_scenes_cover_the_cycle_of_the_loads(tmp_path, periods, turns):
    """The work of the last turn is the largest: its peak is among the torques at every half degree."""
    engine = dx.Machine(ec=5, AB=40, BC=130, omega0=1500, m_slider=0.5, units="mm, rpm, deg")
    shares = [0.0, 0.7, 0.9, 1.0]
    loads = [engine.over_theta(np.array(shares) * p, [0, -10, -4000, 0], "linear", p) for p in periods]
    engine = engine.replace(**dict(zip(("F_Y", "F_X"), loads, strict=False)), mu=0.1)
    theta = np.linspace(0.0, 360.0 * turns, 720 * turns + 1)
    torque = np.abs(engine.evaluate("T_in", theta=theta)).max()
    assert engine.peak("T_in")["value"] == pytest.approx(torque, rel=1e-3)
    (line,) = engine.plot("T_in")
    assert line.axes.get_xlim() == (0.0, 360.0 * turns)
    assert np.abs(line.get_ydata()).max() == pytest.approx(torque, rel=1e-3)
    run = engine.scene(["T_in"], peak=[{"quantity": "T_in"}]).run()
    assert run.dataset.theta.values[-1] == 360.0 * turns
    assert float(run.peaks[0].dataset["value"]) == pytest.approx(torque, rel=1e-3)
    page = engine.report(tmp_path / "engine.md").read_text()
    assert page.count(f"(theta from 0 to {360 * turns} deg)") == 5
    assert f"Torque of the drive over {'a turn' if turns == 1 else f'{turns} turns'}" in page or turns > 4


def test_the_explorer(tmp_path):
    path = PRESS.explore(tmp_path / "page.html", title="a press")
    assert "a press" in path.read_text(encoding="utf-8")
