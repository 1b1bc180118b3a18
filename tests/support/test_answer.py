"""Answers: dicts to every caller, readable on a screen."""

import pickle
import re

import numpy as np
import pytest

import desaxe as dx
from desaxe.support.answer import Answer
from desaxe.units.text import quotient as quotient_of

SIZES = {"ec": 0.1, "AB": 0.125, "BC": 0.35}
CALLS = {
    "events": lambda: dx.events(**SIZES),
    "feasibility": lambda: dx.feasibility(**SIZES),
    "peak": lambda: dx.peak("a_C", omega0=157.0, **SIZES),
    "evaluate": lambda: dx.evaluate(["V_C", "a_C"], theta=1.0, omega0=157.0, **SIZES),
}


@pytest.mark.parametrize("name", CALLS)
def test_an_answer_is_a_dict(name):
    result = CALLS[name]()
    assert isinstance(result, dict)
    assert pickle.loads(pickle.dumps(result)) == result == dict(result)
    lines = repr(result).splitlines()
    assert [line.split()[0] for line in lines if not line.startswith(" ")] == list(result)
    assert max(map(len, lines)) < 120


def test_numbers_have_six_digits():
    assert repr(Answer(stroke=0.26279794681770396, status=0)) == "stroke  0.262798\nstatus  0"
    assert repr(Answer(gradient={"ec": -2.1535312, "AB": 1 / 3})) == "gradient  {ec: -2.15353, AB: 0.333333}"
    assert repr(Answer()) == "{}"


def test_what_rounding_leaves_of_nothing_is_printed_as_nothing():
    """At the inner dead centre Y = BC - AB: its gradient has no part along ec but by rounding of pi."""
    peak = dx.peak("Y", kind="min", ec=0.0, AB=0.05, BC=0.15)
    assert 0.0 < abs(peak["gradient"]["ec"]) < 1e-15
    assert "gradient  {ec: 0, AB: -1, BC: 1}" in repr(peak)
    assert repr(Answer(gradient={"a": -0.0, "b": 1e-20, "c": 1e-9}, x=-0.0)) == (
        "gradient  {a: 0, b: 1e-20, c: 1e-09}\nx         0"
    )
    apart = Answer({"gradient": {"ec": 1e-20, "AB": 2.0}}, {"gradient": {"ec": "m", "AB": "rad"}})
    assert "ec: 1e-20 m" in repr(apart)
    table = repr(dx.harmonics("a_C", ec=0.0, AB=0.05, BC=0.15, omega0=314.0)).splitlines()
    assert [float(x) for row in table[2:11] for x in row.split()[2:3]] == [0.0] * 9  # an even function
    assert [float(row.split()[1]) for row in table[5:11:2]] == [0.0] * 3  # of odd orders but the first


def test_arrays_are_shown_by_their_range():
    many = np.append(np.arange(9.0), np.nan)
    assert repr(Answer(a=many, few=many[:2])) == "a    10 float64 0 .. 8, 1 nan\nfew  [0, 1]"


def test_numbers_are_shown_with_their_units():
    press = dx.Machine(ec=15, AB=75, BC=300, omega0=60, m_slider=4, units="mm, deg, rpm")
    shown = repr(press.events())
    assert re.search(r"^stroke +150.2 mm$", shown, re.M)
    assert re.search(r"^    theta_outer +{ec: .*} deg/mm$", shown, re.M)
    assert re.search(r"^time_ratio +[0-9.]+$", shown, re.M)
    assert re.search(r"^value +[-0-9.]+ N m$", repr(press.peak("T_in")), re.M)
    assert re.search(
        r"^a_C +10 float64 .* \.\. .* mm/s\^2$", repr(press.evaluate(["a_C"], theta=range(10))), re.M
    )
    motion = press.replace(omega0=None, I_crank=1).simulate(torque=9, t_end="100 ms", until=2)
    assert re.search(r"^  theta .* from 0 to 2 deg$", repr(motion), re.M)
    assert re.search(r"^  t = [0-9.]+ s: .*, theta = 2 deg, omega = [0-9.]+ rpm$", repr(motion), re.M)


def test_what_has_no_value_is_shown_with_the_reason():
    bad = {"ec": 0.1, "AB": 0.3, "BC": 0.35}
    assert re.search(r"^stroke +nan$", repr(dx.events(**bad)), re.M)
    assert repr(dx.events(**bad)).endswith("1: the crank does not turn fully")
    assert repr(dx.drive(omega0=1.0, **bad)).endswith("1: the crank cannot turn fully")
    many = dx.events(ec=[0.0, 0.1], AB=0.3, BC=0.35)
    assert repr(many).endswith("[0, 1] (1: the crank does not turn fully)")
    point = dx.evaluate(["Y", "status"], theta=1.5, ec=0.1, AB=0.3, BC=0.35)
    assert repr(point) == "Y       nan\nstatus  1: cannot be assembled here"


@pytest.mark.parametrize(
    ("unit", "by", "quotient"),
    [
        ("N*m", ["m"], "N"), ("N m", ["mm"], "N*m/mm"), ("mm", ["mm"], "1"), ("m/s^2", ["rad/s"], "m/s/rad"),
        ("m", ["m", "rad"], "1/rad"), ("1", ["m", "m"], "1/m^2"), ("s", ["rad/s^2"], "s^3/rad"),
        ("standard_gravity", ["mm"], "standard_gravity/mm"), ("kg m^2", ["%"], "kg*m^2/%"),
    ],
)  # fmt: skip
def test_units_of_derivatives_are_reduced(unit, by, quotient):
    assert quotient_of(unit, by) == quotient


def test_an_answer_of_evaluate_knows_what_it_was_asked_for():
    theta = np.linspace(0.0, 1.0, 5)
    result = dx.evaluate(["V_C"], theta=theta, omega0=1.0, **SIZES)
    assert result.inputs["theta"] is theta
    assert pickle.loads(pickle.dumps(result)).inputs["ec"] == 0.1
    for loads in ({}, {"m_slider": 1.0, "F_Y": dx.over_Y([0.2, 0.4], [1.0, 2.0])}):
        still = dx.evaluate(["Y", "status"], theta=theta, **SIZES, **loads)
        assert list(still.inputs) == ["theta", *SIZES, *loads]
