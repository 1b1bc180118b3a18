"""Answers know the units of their numbers: those of a machine are those in SI units, by pint alone."""

import pickle
from collections.abc import Mapping

import numpy as np
import pytest

import desaxe as dx
from desaxe.mechanism.ranges import Between, PlusMinus
from desaxe.plot.style import title_of
from desaxe.units.pint_units import registry

SI = {"ec": 0.01, "AB": 0.05, "BC": 0.2, "omega0": 31.0, "m_slider": 4.0, "I_crank": 0.5, "F_Y": -600.0}
PRESS = dx.Machine(**SI).replace(
    units={"length": "mm", "angle": "deg", "omega0": "rpm", "torque": "kN m", "a_C": "cm/s^2"}
)
NARROW = {"ec": (0, 0.06), "AB": (0.02, 0.05)}
TORQUE = {"torque": 50.0, "t_end": 0.05, "times": [0.0, 0.05], "mu": 0.0}
CALLS = {
    "evaluate": {
        "names": [
            "Y", "V_C", "a_C", "j_C", "phi", "omega_BC", "alpha_BC", "T_in", "N_C", "kinetic_energy",
            "a_C_wrt_ec", "T_in_wrt_AB", "a_C_wrt_theta", "V_C_wrt_omega0", "phi_wrt_ec", "status",
        ],
        "theta": 1.0,
    },
    "peak": {"name": "a_C"},
    "events": {},
    "feasibility": {},
    "inverse": {"Y": 0.2, "V_C": 1.0},
    "simulate": {**TORQUE, "names": ["Y"], "wrt": ["ec", "torque"]},
    "optimize": {
        "maximize": "stroke", "minimize": ("absmax", "a_C"), "over": NARROW, "points": 3,
        "keep": {"margin": (0.1, None)},
    },
    "synthesize": {"stroke": 0.09, "time_ratio": 1.1, "max_pressure_angle": 0.01},
    "tolerance": {"name": ("absmax", "T_in"), "AB": dx.plus_minus(0.05, 1e-4), "samples": 64},
    "harmonics": {"name": "T_in"},
    "counterweight": {"radius": 0.05},
    "drive": {},
    "steady": {"torque": dx.over_omega(["0 rad/s", "60 rad/s"], ["80 N m", "0 N m"])},
    "enclose": {"name": "Y", "theta": 1.0, "AB": dx.between(0.0499, 0.0501)},
}  # fmt: skip
NEEDS = {"optimize": ("BC", "omega0"), "synthesize": (), "inverse": ("ec", "AB", "BC")}
ONLY = {"events": ("ec", "AB", "BC", "omega0"), "feasibility": ("ec", "AB", "BC")}


def leaves(value, unit, key=()):
    """Key, number and unit of every number that has a unit."""
    if isinstance(unit, Mapping) and isinstance(value, Mapping):
        for name, inside in unit.items():
            if name in value:
                yield from leaves(value[name], inside, (*key, name))
    elif isinstance(value, Mapping):
        for name, part in value.items():
            yield from leaves(part, unit, (*key, name))
    elif isinstance(value, (list, tuple)):
        for k, part in enumerate(value):
            inside = part._asdict() if hasattr(part, "_asdict") else part
            yield from leaves(inside, unit, (*key, k))
    elif value is not None and not isinstance(value, str):
        yield key, np.asarray(value, float), unit


def in_si(name):
    """The answer of the function itself."""
    names = NEEDS.get(name) or ONLY.get(name) or tuple(SI)
    given = {} if name == "synthesize" else {n: SI[n] for n in names if n in SI}
    if name == "simulate":
        given["omega_start"] = given.pop("omega0")
    return getattr(dx, name)(**{**given, **CALLS[name]})


def of_machine(name):
    """The answer of the machine, asked by texts and pairs with units."""
    given = dict(CALLS[name])
    shown = PRESS.units
    for key in {"theta", "Y", "V_C", "stroke", "max_pressure_angle", "radius", "torque"} & {*given}:
        if isinstance(given[key], float):
            given[key] = shown.of(key if key != "stroke" else "ec").shown(given[key])
    if name == "optimize":
        given["over"] = {n: tuple(shown.of(n).shown(end) for end in ends) for n, ends in NARROW.items()}
        given["keep"] = {"margin": (100.0, None)}
    for key, value in given.items():
        if isinstance(value, (Between, PlusMinus)):
            given[key] = type(value)(*(shown.of(key).shown(part) for part in value))
    return getattr(PRESS, name)(**given)


@pytest.mark.parametrize("name", CALLS)
def test_numbers_have_the_units_that_the_answer_says(name):
    plain, shown = in_si(name), of_machine(name)
    wanted = {key: (value, unit) for key, value, unit in leaves(plain, plain.units)}
    result = {key: (value, unit) for key, value, unit in leaves(shown, shown.units)}
    assert wanted
    assert result.keys() == wanted.keys()
    changed = 0
    for key, (value, unit) in result.items():
        expected, base = wanted[key]
        changed += unit != base
        scale = float(registry().Quantity(1.0, unit).to(base).magnitude)
        size = np.max(np.abs(expected), initial=0.0, where=~np.isnan(expected))
        np.testing.assert_allclose(scale * value, expected, rtol=2e-6, atol=2e-6 * size, err_msg=str(key))
    assert changed


@pytest.mark.parametrize("name", ["peak", "optimize", "drive", "tolerance"])
def test_answers_keep_their_units_in_a_pickle(name):
    result = in_si(name)
    assert pickle.loads(pickle.dumps(result)).units == result.units
    assert all(isinstance(unit, (str, Mapping)) for unit in result.units.values())


def test_an_objective_of_ones_own_has_no_unit_and_can_be_pickled():
    def twice(design):
        return 2.0 * design["ec"], {"ec": 2.0}

    result = dx.optimize(maximize=twice, over={"ec": (0.0, 0.01)}, AB=0.05, BC=0.2)
    assert result.units["value"] == "1"
    assert result.units["ec"] == "m"
    assert pickle.loads(pickle.dumps(result)) == result


def test_messages_are_in_the_units_of_the_machine():
    steep = PRESS.synthesize(stroke=90, time_ratio=1.1, max_pressure_angle=0.5)["message"]
    assert "max_pressure_angle = 0.5 deg" in steep
    assert " to 90 deg" in steep
    assert PRESS.synthesize(stroke=90, time_ratio=1.1, BC=10)["message"].startswith("none: BC = 10 mm, ")
    grows = PRESS.optimize(maximize=("absmax", "a_C"), over={"ec": (0, 250)})
    assert " keep={'margin': ('5 mm', None)}" in grows["message"]
    assert "near ec = 1" in grows["message"]
    assert " mm;" in grows["message"]


def test_titles_and_attributes_have_the_loads_in_the_units_of_the_machine():
    press = dx.Machine(**SI).replace(units="kN, mm")
    press = press.replace(F_Y=press.over_theta(["0 deg", "30 deg", "180 deg"], [-3, 0, 0], kind="step"))
    result = press.grid("T_in", theta=[0.0, 1.0])
    assert result.attrs["loads"] == "F_Y: <load over theta: 3 points, step, -3 to 0 kN>"
    assert "F_Y over theta, -3 to 0 kN" in title_of(result, ["T_in"]).replace("\u00a0", " ")
    words = "over theta, -3 to 0 kN"
    assert words in repr(press)
    assert words in str(press.explain("T_in", theta=[0.0, 1.0]))
    assert "F_Y over theta, -3 to 0 kN" in str(press.drive())
    assert "-3000 to 0" in dx.grid("T_in", theta=[0.0, 1.0], **press).attrs["loads"]


def test_a_workbook_of_an_answer_in_other_units(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    path = dx.to_excel(dx.peak("Y", ec=0.01, AB=0.05, BC=0.2), tmp_path / "a.xlsx", units="mm, deg")
    rows = {row[0]: row[1:] for row in openpyxl.load_workbook(path)["values"].values}
    assert rows["value"] == (pytest.approx(249.8, abs=0.1), "mm")
    assert rows["theta"][1] == "deg"
