"""Every line has the unit it says: scaling lengths and times scales it by the powers in its unit."""

import math
import re
from functools import cache

import pytest

from desaxe._program import _text
from desaxe.compiler.interpret import run_in_doubles
from desaxe.derive.units import ANGLE, JERK, NONE, PARAMETER_UNITS, Unit, unit_text

POINT = {"theta": 1.1, "ec": 0.02, "AB": 0.125, "BC": 0.35, "omega0": 157.0, "alpha": -3.0, "branch": 1.0}
SCALED = {
    "m": {"ec": 1, "AB": 1, "BC": 1},
    "s": {"omega0": -1, "alpha": -2},
}


def powers(unit):
    """`m/s^2/rad` as {"m": 1, "s": -2, "rad": -1}."""
    found = {"m": 0, "s": 0, "rad": 0}
    for sign, name, power in re.findall(r"([*/]|^)(m|s|rad)(?:\^(\d+))?(?=[*/]|$)", unit):
        found[name] += (-1 if sign == "/" else 1) * int(power or 1)
    return found


@cache
def program(name):
    return _text(name).read()


@cache
def values(unit=""):
    """Every name of the law, with lengths or times counted in halves of the unit; powers of 2 are exact."""
    scale = {name: 2.0**power for name, power in SCALED.get(unit, {}).items()}
    return run_in_doubles(program("program"), {name: x * scale.get(name, 1.0) for name, x in POINT.items()})


def number(value):
    return float(value) if isinstance(value, (bool, int)) else value


@pytest.mark.parametrize("unit", ["m", "s"])
def test_every_named_line_scales_as_its_unit_says(unit):
    before, after = values(), values(unit)
    notes = program("program").notes
    wrong = [
        name
        for name, note in notes.items()
        if number(after[name]) != number(before[name]) * 2.0 ** powers(note.unit)[unit]
    ]
    assert not wrong


def test_every_named_line_has_a_value_to_scale():
    """So that the test above compares more than zeros and NaN."""
    found = [number(values()[name]) for name in program("program").notes]
    assert not any(math.isnan(value) for value in found)
    assert sum(value != 0 for value in found) > 0.7 * len(found)


def test_every_unit_can_be_read():
    for name in ("program", "state"):
        for note in program(name).notes.values():
            assert unit_text(Unit(**powers(note.unit))) == note.unit


def test_the_state_has_the_units_of_the_law():
    law, state = program("program").notes, program("state").notes
    assert {name: note.unit for name, note in state.items()} == {name: law[name].unit for name in state}


@pytest.mark.parametrize(
    ("unit", "text"),
    [
        (NONE, "1"),
        (ANGLE, "rad"),
        (JERK, "m/s^3"),
        (Unit(-1, -2, -1), "1/m/s^2/rad"),
        (Unit(1, 2, 0), "m*s^2"),
    ],
)
def test_the_text_of_a_unit(unit, text):
    assert unit_text(unit) == text


@pytest.mark.parametrize("parameter", PARAMETER_UNITS)
def test_a_derivative_is_over_the_unit_of_its_parameter(parameter):
    assert PARAMETER_UNITS[parameter].over(parameter) == NONE
