"""Units of a machine and of a scene: round trips, quotients, labels, pint quantities, slips."""

import csv
import math
import pickle
import tomllib
import warnings

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

import desaxe as dx
from desaxe.cli.command import warnings_in_a_line
from desaxe.scenes.schema import SceneError
from desaxe.units.pint_units import registry

SI = {
    "ec": 0.01, "AB": 0.05, "BC": 0.2, "omega0": "300 rpm", "m_slider": 4.0, "m_crank": 0.5, "F_Y": -600.0,
    "mu": 0.12,
}  # fmt: skip
PLAIN = {**SI, "ec": 10, "AB": 50, "BC": 200, "omega0": 300}
PRESS = dx.Machine(**PLAIN, units="mm, deg, rpm")
RPM = 2 * math.pi / 60


def si(name, value):
    """A value with the unit that the machine shows, by pint alone."""
    unit = PRESS.units.of(name).unit
    base = dx.quantities()[name].unit
    return registry().Quantity(value, unit).to(base).magnitude


def test_plain_numbers_are_the_doubles_of_texts():
    assert dict(PRESS) == dict(dx.Machine(**SI))
    assert PRESS.in_units() == PLAIN
    assert dx.Machine(AB=350, units="mm")["AB"] == 0.35
    lengths = dx.Machine(AB=np.arange(1.0, 501.0), units="mm")["AB"]
    assert lengths.tolist() == [float(f"{k}e-3") for k in range(1, 501)]
    assert PRESS.replace(ec="12 mm")["ec"] == PRESS.replace(ec=12)["ec"] == 0.012
    assert PRESS.replace(units="cm").in_units()["AB"] == 5.0


def test_only_what_is_named_changes():
    units = PRESS.units
    assert [units.of(n).unit for n in ("Y", "V_C", "a_C", "phi", "omega_BC")] == [
        "mm",
        "mm/s",
        "mm/s^2",
        "deg",
        "rpm",
    ]
    assert [units.of(n).unit for n in ("T_in", "F_Y", "alpha", "m_rod", "I_rod")] == [
        "N*m", "N", "rad/s^2", "kg", "kg*m^2",
    ]  # fmt: skip
    assert units.of("a_C_wrt_ec").unit == "1/s^2"
    assert units.of("T_in_wrt_ec").unit == "N*m/mm"
    assert units.of("a_C_wrt_theta").unit == "mm/s^2/deg"
    own = dx.Machine(SI, units={"a_C": "standard_gravity", "torque": "kN m", "energy": "kJ"})
    assert own.evaluate("a_C", theta=1.0) == pytest.approx(
        dx.evaluate("a_C", theta=1.0, **SI) / 9.80665, rel=1e-14
    )
    assert own.evaluate("T_in", theta=1.0) == pytest.approx(
        dx.evaluate("T_in", theta=1.0, **SI) / 1e3, rel=1e-14
    )
    assert own.drive()["work_in"] == pytest.approx(dx.drive(**SI)["work_in"] / 1e3, rel=1e-14)
    assert own["AB"] == 0.05


def test_the_solution_of_a_motion():
    how = {"torque": 50.0, "t_end": 0.2, "I_crank": 0.5, "times": [0.0, 0.1]}
    shown = PRESS.simulate(theta0=10, omega_start=60, **how)
    bodies = {k: v for k, v in SI.items() if k != "omega0"}
    plain = dx.simulate(theta0="10 deg", omega_start=60 * RPM, **how, **bodies)
    angles = [one["solution"](0.05)["theta"] for one in (shown, plain)]
    assert angles[0] == pytest.approx(math.degrees(angles[1]), rel=1e-9)


def test_a_motion_starts_at_the_speed_of_the_machine():
    how = {"torque": 50.0, "t_end": 0.02, "I_crank": 0.5}
    for machine in (PRESS, dx.Machine(PRESS, units="mm, deg, rad/s"), dx.Machine(SI)):
        speed = machine.in_units()["omega0"]
        result = machine.simulate(**how)
        assert result["omega"][0] == pytest.approx(speed, rel=1e-12)
        assert result["theta"][0] == 0.0
        np.testing.assert_array_equal(result["omega"], machine.simulate(omega_start=speed, **how)["omega"])
        assert machine.simulate(omega_start=0.0, **how)["omega"][0] == 0.0
    state = dx.Machine({k: v for k, v in SI.items() if k != "omega0"}, omega=7.0)
    assert state.simulate(**how)["omega"][0] == pytest.approx(7.0, rel=1e-12)
    assert dx.simulate(**how, **state)["omega"][0] == pytest.approx(7.0, rel=1e-12)
    assert dx.simulate(omega_start=1.0, **how, **state)["omega"][0] == pytest.approx(1.0, rel=1e-12)
    several = PRESS.simulate(ec=[0.0, 10.0], mu=0.0, times=[0.0], **how)
    np.testing.assert_allclose(several["omega"], PRESS.in_units()["omega0"], rtol=1e-12)


@pytest.mark.parametrize(
    ("given", "meant"), [("theta", "theta0"), ("omega", "omega_start"), ("omega0", "omega_start")]
)
def test_other_names_of_the_start_are_refused_with_the_right_one(given, meant):
    bodies = {k: v for k, v in SI.items() if k != "omega0"}
    for simulate, inputs in ((PRESS.simulate, {}), (dx.simulate, bodies)):
        with pytest.raises(TypeError, match=f"has no input '{given}'; did you mean {meant}( or \\w+)?\\?$"):
            simulate(torque=50.0, t_end=0.02, I_crank=0.5, **{given: 1.0}, **inputs)


def test_labelled_results_carry_their_units():
    result = PRESS.grid(["a_C", "a_C_wrt_ec"], theta=[0, 60, 90], ec=[0, 10])
    assert result.theta.values.tolist() == [0.0, 60.0, 90.0]
    assert result.ec.values.tolist() == [0.0, 10.0]
    assert result.theta.units == "deg"
    assert float(result.AB) == 50.0
    assert result.AB.units == "mm"
    assert result.a_C.units == "mm/s^2"
    assert result.margin.units == "mm"
    assert result.status.dtype == np.int8
    assert float(result.a_C[1, 1]) == pytest.approx(PRESS.evaluate("a_C", theta=60), rel=1e-12)
    reduced = PRESS.grid("a_C", theta=np.arange(360.0), ec=[0, 10], reduce={"theta": "absmax"})
    assert reduced.a_C_absmax.units == "mm/s^2"
    assert reduced.a_C_absmax_theta.units == "deg"
    axes = {"theta": np.arange(0.0, 360.0, 5.0), "ec": [0.0, 10.0]}
    slopes = PRESS.grid(["T_in_wrt_ec", "a_C_wrt_ec"], **axes)
    both = PRESS.grid(["T_in_wrt_ec", "a_C_wrt_ec"], **axes, reduce={("theta", "ec"): "absmax"})
    for name in ("T_in_wrt_ec", "a_C_wrt_ec"):
        values = slopes[name]
        row, column = np.unravel_index(np.abs(values.values).argmax(), values.shape)
        for axis, index in (("theta", row), ("ec", column)):
            position = both[f"{name}_absmax_{axis}"]
            assert position.units == PRESS.units.of(axis).unit
            assert float(position) == pytest.approx(axes[axis][index], rel=1e-15)
        assert both[f"{name}_absmax"].units == values.units
    designs = PRESS.design_map(["stroke", ("absmax", "a_C")], ec=[0, 10], derivatives=True)
    assert designs.stroke.units == "mm"
    assert designs.absmax_a_C.units == "mm/s^2"
    assert float(designs.stroke_wrt_ec[1]) == pytest.approx(PRESS.events()["gradient"]["stroke"]["ec"])
    out = np.empty(2)
    assert PRESS.evaluate("Y", theta=[0, 90], out=out) is out
    np.testing.assert_allclose(out, PRESS.evaluate("Y", theta=[0, 90]))


def test_sweeps(tmp_path):
    press = dx.Machine(AB=50, omega0=300, units="mm, deg, rpm")
    axes = {"theta": [0, 60, 90], "ec": [0, 160], "BC": [200, 210]}
    result = press.sweep(["V_C", "a_C"], store=tmp_path / "press.zarr", **axes)
    assert result.a_C.units == "mm/s^2"
    expected = press.grid(["V_C", "a_C"], **axes)
    np.testing.assert_allclose(result.a_C, expected.a_C, rtol=1e-12)
    assert result.theta.values.tolist() == [0.0, 60.0, 90.0]


def test_pint_quantities():
    length = PRESS.evaluate("Y", theta=60, as_quantity=True)
    assert length.to("m").magnitude == pytest.approx(dx.evaluate("Y", theta="60 deg", **SI), rel=1e-14)
    assert str(length.units) == "millimeter"
    press = dx.Machine(SI)
    torque = press.peak("T_in", as_quantity=True)
    assert torque["value"].check("[mass] * [length]**2 / [time]**2")
    assert torque["gradient"]["ec"].to("N").magnitude == pytest.approx(
        dx.peak("T_in", **SI)["gradient"]["ec"]
    )
    assert press.drive(as_quantity=True)["power_mean"].to("kW").magnitude == pytest.approx(
        dx.drive(**SI)["power_mean"] / 1e3
    )
    assert press.events(as_quantity=True)["status"] == 0
    values = press.grid("a_C", theta=[0.0, 1.0], as_quantity=True)
    assert str(values.a_C.data.units) == "meter / second ** 2"


def test_reports_and_pictures_of_a_drive():
    needs, plain = PRESS.drive(), dx.drive(**SI)
    assert "ec = 10 mm" in needs.report()
    assert "ec = 0.01 m" in plain.report()
    assert needs.plot()["T_in"].get_xdata().max() == pytest.approx(plain.plot()["T_in"].get_xdata().max())


SCENE = """
title = "press"
outputs = ["a_C"]
units = "mm, deg, rpm"
[mechanism]
AB = 125
BC = 350
ec = [0, "50 mm", 240]
[motion]
theta = { start = 0, stop = 360, step = 90 }
omega0 = 1500
[[check]]
printed = { a_C = -994000 }
at = { theta = 60, ec = 0 }
[[peak]]
quantity = "a_C"
over = { ec = [0, 50] }
baseline = { ec = 0 }
sensitivities = ["omega0"]
[[picture]]
file = "a_C.svg"
quantity = "a_C"
at = { ec = 50 }
[results]
data = "values.csv"
"""
LONG_HAND = """
outputs = ["a_C"]
[mechanism]
AB = "125 mm"
BC = "350 mm"
ec = [0, "50 mm", "240 mm"]
[motion]
theta = { start = 0, stop = "360 deg", step = "90 deg" }
omega0 = "1500 rpm"
"""


def test_a_scene_in_units(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "press.toml").write_text(SCENE, encoding="utf-8")
    (tmp_path / "long.toml").write_text(LONG_HAND, encoding="utf-8")
    scene = dx.scene("press.toml")
    assert scene.inputs == dx.scene("long.toml").inputs
    assert dx.Machine.read("press.toml").units == dx.Machine(units="mm, deg, rpm", AB=125).units
    result = scene.run()
    assert result.dataset.a_C.units == "mm/s^2"
    assert result.dataset.theta.values.tolist() == [0.0, 90.0, 180.0, 270.0, 360.0]
    report = result.report()
    for words in (
        "< BC - AB = 225 mm",
        "ec = 240 mm",
        "from 61.64 to 118.36 deg",
        "mm/s^2",
        "agrees",
        "mm/s^2/rpm",
    ):
        assert words in report, words
    assert " m " not in report
    top = dx.peak("a_C", ec="50 mm", AB="125 mm", BC="350 mm", omega0="1500 rpm")
    peaks = result.peaks[0].dataset
    assert float(peaks.value[1]) == pytest.approx(1e3 * top["value"], rel=1e-12)
    assert float(peaks.value_wrt_omega0[1]) == pytest.approx(1e3 * RPM * top["gradient"]["omega0"], rel=1e-12)
    with open("values.csv", encoding="utf-8") as file:
        _, heads, *rows = csv.reader(file)
    assert heads == ["ec [mm]", "theta [deg]", "a_C [mm/s^2]", "status", "margin [mm]"]
    assert [row[1] for row in rows[:2]] == ["0.0", "90.0"]


def test_report_and_pictures_are_in_the_units_of_the_texts(tmp_path, monkeypatch):
    """The values are in SI units all the same, in files too, and so are sensitivities."""
    monkeypatch.chdir(tmp_path)
    figures = []
    monkeypatch.setattr("desaxe.plot.save", lambda figure, file, **more: figures.append(figure))
    peak = {"quantity": "phi", "over": {"ec": ["10 mm", "2 cm"]}, "sensitivities": ["ec"]}
    picture = {"file": "phi.svg", "quantity": "phi", "family": {"ec": [0, "50 mm"]}}
    asked = {"peak": [peak], "picture": [picture], "results": {"data": "values.csv"}}
    scene = dx.scene({**tomllib.loads(LONG_HAND), **asked})
    result = scene.run()
    lines = [line.split() for line in result.report().splitlines()]
    heads = lines.index(["ec", "|phi|", "at", "theta", "d/d(ec)"])
    largest = math.degrees(math.asin((20 + 125) / 350))
    assert lines[heads + 1] == ["mm", "deg", "deg", "rad/m"]
    assert lines[heads + 3][:2] == ["20", f"{largest:.6g}"]
    (axes,) = figures[0].axes
    assert "[deg]" in axes.get_ylabel()
    assert axes.get_legend().get_title().get_text() == "ec [mm]"
    assert result.peaks[0].dataset.ec.units == "m"
    with open("values.csv", encoding="utf-8") as file:
        assert file.readlines()[1].split(",")[:2] == ["ec [m]", "theta [rad]"]
    assert pickle.loads(pickle.dumps(scene)).shown_in == scene.shown_in
    assert scene == dx.scene({**tomllib.loads(LONG_HAND.replace('"125 mm"', "0.125")), **asked})


def test_units_of_a_scene_that_are_none():
    data = {"outputs": ["a_C"], "mechanism": {"ec": 0, "AB": 1, "BC": 3}, "motion": {"theta": 1, "omega0": 1}}
    with pytest.raises(SceneError, match="units"):
        dx.scene({**data, "units": "mmm"})
    with pytest.raises(SceneError, match="lenght"):
        dx.scene({**data, "units": {"lenght": "mm"}})


@pytest.mark.parametrize(
    ("inputs", "words"),
    [
        ({"AB": 0.125, "units": "mm"}, 'AB = 0.125 mm, write AB = "0.125 m"'),
        ({"g_Y": -9.81, "units": "mm"}, '"-9.81 m/s^2"'),
        ({"AB": " 0.125", "units": "mm"}, 'AB = 0.125 mm, write AB = "0.125 m"'),
        (
            {"omega0": 60000, "units": "mm, deg, rpm"},
            "omega0 = 60000 rpm, where more than 9549.3 rpm is unus",
        ),
        (
            {"omega0": 60000, "units": "deg/s"},
            "omega0 = 60000 deg/s, where more than 57295.8 deg/s is unusual",
        ),
        ({"AB": 50000, "units": "mm"}, "AB = 50000 mm, where more than 20000 mm is unusual"),
        ({"BC": 5000, "units": "cm"}, 'BC = 5000 cm, write BC = "5000 mm"'),
    ],
)
def test_slips_of_a_machine(inputs, words):
    with pytest.warns(dx.UnitWarning) as caught:
        dx.Machine(**inputs)
    assert len(caught) == 1
    assert words in str(caught[0].message)
    assert caught[0].filename == __file__


FORGE = {"ec": 0, "AB": 40, "BC": 64, "units": "mm, kN"}


@pytest.mark.parametrize("force", ["number", "over_Y", "over_theta"])
def test_a_force_that_no_rod_carries_is_told(force):
    """80 kN as 80000 in a machine in kN: 80 MN on a rod of 64 mm."""
    press = dx.Machine(**FORGE)
    loads = {
        "number": -80e3,
        "over_Y": press.over_Y([30, 100], [-80e3, 0]),
        "over_theta": press.over_theta([0, 3], [10, -80e3], kind="step"),
    }
    message = "almost certainly a slip: F_Y up to 80000 kN on a rod of 64 mm: half as thick .* carry 78 GPa$"
    with pytest.warns(dx.UnitWarning, match=message) as caught:
        press.replace(F_Y=loads[force])
    assert caught[0].filename == __file__
    with pytest.warns(dx.UnitWarning, match=message):
        dx.Machine(**FORGE, F_Y=loads[force])
    if force == "number":
        data = {"outputs": ["T_in"], "units": "mm, kN", "mechanism": {"ec": 0, "AB": 40, "BC": 64}}
        with pytest.warns(dx.UnitWarning, match="F_Y up to 80000 kN on a rod of 64 mm"):
            dx.scene({**data, "motion": {"theta": 1, "omega0": 1}, "loads": {"F_Y": -80e3}})


def test_forces_of_real_presses_are_no_slips():
    """Rated forces and rods [N, m]: a bench press, a knuckle press, a forging press of 160 MN, a pump."""
    for force, rod in ((1e4, 0.06), (1.6e7, 1.0), (1.6e8, 2.2), (6e5, 0.25)):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            dx.Machine(ec=0, AB=0.1 * rod, BC=rod, F_Y=-force)


def test_slips_of_tolerances_and_ranges():
    small = dx.Machine(ec=0, AB=125, BC=350, units="mm")
    with pytest.warns(dx.UnitWarning, match='AB = 0.125 mm, write AB = "0.125 m"'):
        small.tolerance("stroke", AB=dx.plus_minus(0.125, 0.0001))
    with pytest.warns(dx.UnitWarning, match='"0.125 m"; AB = 0.126 mm'):
        small.enclose("stroke", AB=dx.between(0.125, 0.126))
    data = {"outputs": ["Y"], "mechanism": {"ec": 0, "AB": 0.125, "BC": 0.35}}
    with pytest.warns(dx.UnitWarning, match='"360 deg"'):
        dx.scene({**data, "motion": {"theta": {"start": 0, "stop": 360, "num": 3}}})
    with warnings_in_a_line():
        assert warnings.formatwarning("a slip", dx.UnitWarning, "command.py", 1) == "desaxe: a slip\n"
        assert "command.py" in warnings.formatwarning("another", UserWarning, "command.py", 1)


def test_pictures_of_labelled_results_in_other_units(tmp_path):
    """Bars, angles and lengths are right whatever the labels are in, and say their units."""
    top = PRESS.peak("T_in")
    bars = PRESS.plot.tornado("T_in", {"ec": 1, "AB": "0.5 mm"})
    widths = sorted(abs(bar.get_width()) for bar in bars[0])
    expected = sorted([abs(top["gradient"]["ec"]), 0.5 * abs(top["gradient"]["AB"])])
    assert widths == pytest.approx(expected, rel=1e-9)
    assert "ec ± 1 mm" in [label.get_text() for label in bars[0][0].axes.get_yticklabels()]
    (bar,) = dx.plot.tornado(PRESS.peak("a_C"), {"ec": "0.1 mm"}, name="a_C")[0]
    assert abs(bar.get_width()) == pytest.approx(0.1 * abs(PRESS.peak("a_C")["gradient"]["ec"]), rel=1e-9)
    assert "mm s" in bar.axes.get_xlabel() or "mm/s" in bar.axes.get_xlabel()
    course = PRESS.grid("T_in", theta=[0, 90, 360])
    assert dx.plot.polar(course, "T_in")[0].get_xdata() == pytest.approx([0, math.pi / 2, 2 * math.pi])
    left, right = Figure().subplots(1, 2)
    moving = dx.plot.animate(PRESS.grid("a_C", theta=[0, 90, 360]), "a_C", frames=2, ax=(left, right))
    moving.save(tmp_path / "press.gif")
    assert (left.get_xlabel(), right.get_xlim()) == ("X [mm]", (0.0, 360.0))


def test_words_of_results_in_units():
    result = PRESS.optimize(maximize="stroke", over={"ec": (0, 60)}, keep={"margin": (100, None)})
    assert "ec = 50 mm" in result["message"]
    with pytest.raises(TypeError, match=r"ec = .*one number.*\[desaxe.drive\(ec=value, ...\) for value in"):
        PRESS.drive(ec=[0, 10])
    labelled = PRESS.grid("T_in", theta=[0, 60], as_quantity=True)
    assert labelled.T_in.data.to("kN m").magnitude == pytest.approx(
        dx.evaluate("T_in", **{**SI, "theta": [0.0, math.pi / 3]}) / 1e3, rel=1e-12
    )


def test_a_text_without_a_unit_is_in_that_of_the_machine():
    written = dx.Machine(**{name: str(value) for name, value in PLAIN.items()}, units="mm, deg, rpm")
    assert dict(written) == dict(PRESS)
    assert written.evaluate("Y", theta="60") == PRESS.evaluate("Y", theta=60)
    assert PRESS.replace(AB="51")["AB"] == 0.051
    given = ("12 +- 0.1", dx.plus_minus(12, 0.1))
    pairs = [PRESS.tolerance("stroke", ec=ec)["first_order"]["std"] for ec in given]
    assert pairs[0] == pairs[1]
    lengths = {"ec": "10", "AB": "50", "BC": ["200", 210]}
    scene = {"outputs": ["Y"], "mechanism": lengths, "motion": {"theta": "60"}, "units": "mm, deg, rpm"}
    dataset = dx.scene(scene).run().dataset
    assert (float(dataset.AB), dataset.BC.values.tolist()) == (50.0, [200.0, 210.0])
    assert float(dataset.theta) == pytest.approx(60.0, rel=1e-15)


@pytest.mark.parametrize(
    ("units", "problem"),
    [
        ("mm, deg, rpm, " * 1000, "3000 units are too many, at most 100"),
        ("m" * 20_000, "units: .* is not a known unit"),
        ({"length": "m*" * 10_000 + "m"}, "a unit of 20001 characters, at most 100"),
    ],
)
def test_endless_units_are_refused(units, problem):
    with pytest.raises(ValueError, match=problem) as caught:
        dx.Machine(ec=15, AB=75, BC=300, omega0=60, units=units)
    assert len(str(caught.value)) < 300


def test_a_bad_number_is_told_in_the_units_it_was_given_in():
    machine = dx.Machine(units="mm, deg, rpm, kN", ec=10, AB=40, BC=64, omega0=500)
    for call in (machine.replace, lambda **own: machine.evaluate("V_C", theta=30, **own)):
        with pytest.raises(ValueError, match=r"^AB = -75 mm: it must be a finite length >= 0$"):
            call(AB=-75)
    with pytest.raises(ValueError, match=r"^theta = nan deg: it must be a finite number$"):
        machine.evaluate("V_C", theta=float("nan"))
    with pytest.raises(ValueError, match=r"^mu = -1: it must be"):
        machine.replace(mu=-1)


def test_a_list_where_one_number_is_wanted_is_told_in_the_units_of_the_machine():
    machine = dx.Machine(units="mm, deg, rpm", ec=10, AB=40, BC=164, omega0=60, m_slider=3)
    with pytest.raises(TypeError, match=r"^ec = \(0, 15\) mm: drive expects one number"):
        machine.drive(ec=[0, 15])


@pytest.mark.parametrize("kind", [np.array, lambda texts: np.array(texts, dtype=object)])
def test_an_array_of_texts_is_in_the_units_that_they_name(kind):
    machine = dx.Machine(units="mm, deg, rpm", ec=10, AB=40, BC=164, omega0=60)
    expected = machine.evaluate("V_C", theta=[0.0, 60.0, 90.0])
    result = machine.evaluate("V_C", theta=kind(["0 deg", f"{math.pi / 3!r} rad", "90"]))
    np.testing.assert_allclose(result, expected, rtol=1e-13)
    with pytest.raises(TypeError, match=r"^theta: expected real numbers, got an array of object"):
        machine.evaluate("V_C", theta=pd.Series(["0 deg", "90"]))


def test_a_unit_in_wrong_letters_is_asked_about():
    with pytest.raises(ValueError, match="'KN' is not a known unit; did you mean kN\\? expected units"):
        dx.Machine(AB=75, BC=300, units="mm, KN")
    with pytest.raises(ValueError, match='commas stand between units, as in "mm, deg, rpm"'):
        dx.Machine(AB=75, BC=300, units="mm deg rpm")


def test_units_misspelt_are_asked_about():
    with pytest.raises(TypeError, match="has no input 'unit'; did you mean units\\?"):
        dx.Machine(AB=75, BC=300, unit="mm")
    assert dx.Machine({"AB": 75, "units": "mm"}) == dx.Machine(AB=75, units="mm")


def test_a_result_is_no_name_of_a_tornado():
    machine = dx.Machine(ec=0.01, AB=0.05, BC=0.2)
    with pytest.raises(TypeError, match=r"got a dict; a result is drawn by desaxe\.plot\.tornado"):
        machine.plot.tornado({"value": 1.0})
