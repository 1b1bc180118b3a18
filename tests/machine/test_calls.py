"""Methods that are more than one formula: fits, prepared callables, plans, modules, syntheses, scenes."""

import inspect
import math

import numpy as np
import pytest

import desaxe as dx
from desaxe.units.pint_units import registry
from tests.compiler.languages.tools import imported

SI = {"ec": 0.01, "AB": 0.05, "BC": 0.2, "omega0": 30.0, "m_slider": 4.0}
PRESS = dx.Machine(SI)
IN_MM = dx.Machine(PRESS, units="mm, deg, rpm")
RPM = math.pi / 30.0
THETA = np.linspace(0.0, 6.0, 40)
SLIDER = dx.evaluate("Y", theta=THETA, **SI)


def test_fits():
    start = {"ec": 0.0, "AB": (0.04, 0.07)}
    fixed = {"BC": 0.2, "omega0": 30.0, "m_slider": 4.0}
    noisy = SLIDER + 1e-5 * np.cos(7.0 * THETA)
    plain = dx.fit({"theta": THETA, "Y": noisy}, start, nuisance=["theta_offset", "Y_bias"], **fixed)
    own = PRESS.fit({"theta": THETA, "Y": noisy}, start, nuisance=["theta_offset", "Y_bias"])
    assert own["value"] == pytest.approx(plain["value"], rel=1e-6)
    shown = IN_MM.fit(
        {"theta": np.degrees(THETA), "Y": 1e3 * noisy},
        {"ec": 0.0, "AB": (40, 70)},
        nuisance=["theta_offset", "Y_bias"],
    )
    scale = {"ec": 1e3, "AB": 1e3, "theta_offset": 180 / math.pi, "Y_bias": 1e3}
    for name, times in scale.items():
        assert shown["value"][name] == pytest.approx(times * plain["value"][name], rel=1e-4)
        assert shown["std_error"][name] == pytest.approx(times * plain["std_error"][name], rel=1e-6)
        assert shown["interval"][name][1] == pytest.approx(times * plain["interval"][name][1], rel=1e-6)
    variance = np.diag(shown["covariance"])
    np.testing.assert_allclose(np.sqrt(variance), list(shown["std_error"].values()), rtol=1e-12)
    value, error = shown.predict(theta=60)["Y"]
    expected, own = plain.predict(theta=math.pi / 3)["Y"]
    np.testing.assert_allclose([value, error], [1e3 * expected, 1e3 * own], rtol=1e-6)
    assert "AB [mm]" in shown.report()
    assert "AB [m]" in plain.report()
    axes = shown.plot().axes
    assert (axes[0].get_ylabel(), axes[-1].get_xlabel()) == ("Y [mm]", "crank angle [deg]")
    held = IN_MM.fit({"theta": np.degrees(THETA), "Y": 1e3 * noisy}, {"ec": 0.0}, as_quantity=True)
    assert held["value"]["ec"].to("m").magnitude == pytest.approx(1e-3 * float(held["value"]["ec"].magnitude))


def test_prepared_callables():
    f, g = (
        PRESS.function(["V_C", "a_C"], inputs=("theta", "ec")),
        dx.function(["V_C", "a_C"], inputs=("theta", "ec"), AB=0.05, BC=0.2, omega0=30.0),
    )
    for one, other in zip(f(THETA, 0.012), g(THETA, 0.012), strict=True):
        np.testing.assert_array_equal(one, other)
    h = IN_MM.function(["V_C", "a_C"], inputs=("theta", "ec"))
    assert h.units == {"V_C": "mm/s", "a_C": "mm/s^2", "theta": "deg", "ec": "mm"}
    V, a = h(np.degrees(THETA), ec=12)
    np.testing.assert_allclose(V, 1e3 * g(THETA, 0.012)[0], rtol=1e-9, atol=1e-6)
    np.testing.assert_allclose(h("60 deg", "12 mm")[1], 1e3 * g(math.pi / 3, 0.012)[1], rtol=1e-12)
    out = {"V_C": np.empty(40), "a_C": np.empty(40)}
    h(np.degrees(THETA), 12, out=out)
    np.testing.assert_array_equal(out["a_C"], a)
    slopes, own = h.jacobian(60, 12), g.jacobian(math.pi / 3, 0.012)
    assert slopes["a_C"]["ec"] == pytest.approx(own["a_C"]["ec"], rel=1e-12)
    assert slopes["V_C"]["theta"] == pytest.approx(1e3 * own["V_C"]["theta"] * math.pi / 180, rel=1e-12)
    assert h.si(math.pi / 3, 0.012)[0] == g(math.pi / 3, 0.012)[0]
    one = IN_MM.function("Y", as_quantity=True)
    assert one(60).to("m").magnitude == pytest.approx(dx.evaluate("Y", theta=math.pi / 3, **SI), rel=1e-12)
    assert one(registry().Quantity(60, "deg")) == one(60)


def test_plans_and_modules(tmp_path):
    scene = PRESS.scene("a_C", theta=[0.0, 1.0])
    assert PRESS.explain("a_C", theta=[0.0, 1.0]).data["loops"] == dx.explain(scene).data["loops"]
    path = PRESS.compile(tmp_path / "press_kernels.py", "a_C", theta=[0.0, 1.0])
    module = imported(path)
    point = dict(zip(module.OUTPUTS, module.point(1.0), strict=True))
    assert point["a_C"] == pytest.approx(dx.evaluate("a_C", theta=1.0, **SI), rel=1e-12)
    assert PRESS.compile(tmp_path / "press", "a_C", to="c", theta=[0.0, 1.0]).is_dir()
    dx.compile(scene, path, check=True)


def test_every_option_of_compile_is_one_of_the_machine(tmp_path):
    options = inspect.signature(dx.compile).parameters
    own = inspect.signature(dx.Machine.compile).parameters
    for name in options.keys() - {"scene"}:
        assert own[name] == options[name].replace(annotation=own[name].annotation)
    press = PRESS.replace(F_Y=dx.over_stroke([0, 0.01], [-400, 0], dead_centre="outer"))
    press.compile(tmp_path / "press.py", "T_in", theta=[0.0, 1.0])
    dx.compile(press.scene("T_in", theta=[0.0, 1.0]), tmp_path / "press.py", check=True)


@pytest.mark.thorough
def test_a_synthesis_keeps_what_the_machine_has():
    """The rod; the stroke or the time ratio that is not asked for."""
    own = dx.events(ec=0.01, AB=0.05, BC=0.2)
    result = PRESS.synthesize(time_ratio=1.2)
    assert result == dx.synthesize(stroke=own["stroke"], time_ratio=1.2, BC=0.2)
    assert PRESS.synthesize()["solutions"][0]["AB"] == pytest.approx(0.05, rel=1e-12)
    assert IN_MM.synthesize(stroke=80)["solutions"][0]["AB"] == pytest.approx(
        1e3 * dx.synthesize(stroke=0.08, time_ratio=own["time_ratio"], BC=0.2)["solutions"][0]["AB"]
    )
    assert PRESS.synthesize(stroke=0.1, time_ratio=1.1, max_pressure_angle="25 deg") == dx.synthesize(
        stroke=0.1, time_ratio=1.1, max_pressure_angle="25 deg"
    )


LOADS = {
    "points": dx.over_theta([0.0, 1.5, 3.1, 4.7], [0.0, -400.0, -50.1, 0.3], kind="linear"),
    "units": dx.over_theta(["0 deg", "90 deg", "200 deg"], ["0 N", "-4 kN", "0.1 N"], kind="step"),
    "period": dx.over_theta([0.0, 3.0, 7.0, 10.0], [0.0, 1.0, -2.0, 0.5], period="720 deg"),
    "many": dx.over_theta(np.linspace(0.0, 6.2, 180), np.sin(np.linspace(0.0, 6.2, 180))),
    "stroke": dx.over_Y(["150 mm", "0.2 m", "0.25 m"], [-900.0, -200.0, -50.0], [-900.0, -400.0, -150.0]),
    "many positions": dx.over_Y(np.linspace(0.15, 0.25, 60), np.linspace(-9.0, 1.0, 60) ** 3),
}


@pytest.mark.parametrize("load", LOADS.values(), ids=LOADS)
@pytest.mark.parametrize("units", [None, "mm, deg, rpm"])
def test_loads_are_written_and_read(load, units, tmp_path):
    press = dx.Machine(PRESS.replace(F_Y=load), units=units)
    path = press.to_scene(tmp_path / "press.toml", "T_in", theta=[0.0, "60 deg"])
    assert dx.Machine.read(path) == press
    many = len(getattr(load, "outward", getattr(load, "table", None)).knots) > 24
    assert [file.name for file in tmp_path.glob("*.csv")] == (["press_F_Y.csv"] if many else [])
    assert float(press.scene("T_in", theta="1 rad").run().dataset.T_in) == pytest.approx(
        dx.evaluate("T_in", theta=1.0, F_Y=load, **SI), rel=1e-12
    )


def test_a_function_is_no_data(tmp_path):
    press = PRESS.replace(F_Y=lambda theta: 2.0 * math.sin(theta))
    with pytest.raises(TypeError, match="F_Y: <load over theta: the function <lambda>> is not data"):
        press.to_scene(tmp_path / "press.toml")
    assert not list(tmp_path.iterdir())
    assert float(press.scene("T_in", theta=1.0).run().dataset.T_in) == press.evaluate("T_in", theta=1.0)


def test_the_machine_of_a_scene_is_read_without_its_requests(tmp_path):
    """A picture of a list of designs does not know which; a call on one of them does not ask."""
    path = PRESS.to_scene(tmp_path / "press.toml", "T_in", ec=[0.0, 0.01])
    with path.open("a", encoding="utf-8") as scene:
        scene.write('[[picture]]\nfile = "a.png"\nquantity = "Y"\n[[check]]\nprinted = { stroke = 1.0 }\n')
    with pytest.raises(ValueError, match=r"give at\.ec"):
        dx.scene(path)
    assert dx.Machine.read(path).replace(ec=0.01).drive() == PRESS.replace(ec=0.01).drive()
