"""Every line has the unit it says: scaling lengths and times scales it by the powers in its unit."""

import math
import re
from functools import cache

import pytest

from desaxe.compiler.interpret import run_in_doubles
from desaxe.mechanism.inputs import INPUTS
from desaxe.mechanism.names import per
from desaxe.mechanism.program import _text
from desaxe.units.dimensions import ANGLE, ENERGY, FORCE, JERK, NONE, POWER, TORQUE, Unit, unit_text
from desaxe.units.parse import coherent_unit

POINT = {"theta": 1.1, "ec": 0.02, "AB": 0.125, "BC": 0.35, "omega0": 157.0, "alpha": -3.0, "branch": 1.0}
POINT |= {"m_crank": 1.5, "m_rod": 0.7, "m_slider": 0.9, "I_crank": 0.02, "I_rod": 0.01, "mu": 0.2}
POINT |= {"r_crank": 0.03, "r_rod": 0.2, "F_X": 30.0, "F_Y": -50.0, "g_X": 2.0, "g_Y": -9.0}
# The power of a base unit in each input.
SCALED = {
    "m": {"ec": 1, "AB": 1, "BC": 1, "r_crank": 1, "r_rod": 1, "I_crank": 2, "I_rod": 2}
    | {"F_X": 1, "F_Y": 1, "g_X": 1, "g_Y": 1},
    "s": {"omega0": -1, "alpha": -2, "F_X": -2, "F_Y": -2, "g_X": -2, "g_Y": -2},
    "kg": {"m_crank": 1, "m_rod": 1, "m_slider": 1, "I_crank": 1, "I_rod": 1, "F_X": 1, "F_Y": 1},
}
NAMED = {"J": "N*m", "W": "N*m/s"}


def powers(unit):
    """`m/s^2/rad` as {"m": 1, "s": -2, "rad": -1}; N is kg m/s^2."""
    result = {"m": 0, "s": 0, "rad": 0, "kg": 0}
    bases = {name: {name: 1} for name in result} | {"N": {"kg": 1, "m": 1, "s": -2}}
    terms = re.findall(r"([*/]|^)(m|s|rad|kg|N)(?:\^(\d+))?(?=[*/]|$)", NAMED.get(unit, unit))
    for sign, name, power in terms:
        for base, exponent in bases[name].items():
            result[base] += (-1 if sign == "/" else 1) * int(power or 1) * exponent
    return result


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


@pytest.mark.parametrize("unit", SCALED)
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
    result = [number(values()[name]) for name in program("program").notes]
    assert not any(math.isnan(value) for value in result)
    assert sum(value != 0 for value in result) > 0.7 * len(result)


def test_every_unit_can_be_read():
    for name in ("program", "state", "centres"):
        for note in program(name).notes.values():
            assert unit_text(Unit(**powers(note.unit))) == NAMED.get(note.unit, note.unit)


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
        (TORQUE, "N*m"),
        (per(TORQUE, "theta"), "N*m/rad"),
        (per(TORQUE, "m_rod"), "m^2/s^2"),
        (per(TORQUE, "alpha"), "kg*m^2/rad"),
        (per(FORCE, "BC"), "N/m"),
        (ENERGY, "J"),
        (per(POWER, "ec"), "N/s"),
    ],
)
def test_the_text_of_a_unit(unit, text):
    assert unit_text(unit) == text


@pytest.mark.parametrize("parameter", INPUTS)
def test_a_derivative_is_over_the_unit_of_its_parameter(parameter):
    assert per(coherent_unit(INPUTS[parameter].unit), parameter) == NONE
