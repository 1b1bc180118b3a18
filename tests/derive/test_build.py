"""The whole derivation: every name that can be asked for is there, once, and computed."""

import math

import pytest

from desaxe.compiler.interpret import run_in_doubles
from desaxe.compiler.program import validate
from desaxe.derive.build import INPUTS, _define_constant, public_names
from desaxe.derive.quantities import FACTS, QUANTITIES, SECOND_ORDER, build_sheet
from desaxe.generated.index import NAMES
from desaxe.names import PARAMETERS
from tests.derive.derived import derivation
from tests.truth import all_names

POINT = {"theta": 1.1, "ec": 0.02, "AB": 0.125, "BC": 0.35, "omega0": 157.0, "alpha": -3.0, "branch": 1.0}


def test_how_many_names():
    first, second = len(PARAMETERS), len(PARAMETERS) * (len(PARAMETERS) + 1) // 2
    assert (len(QUANTITIES), len(SECOND_ORDER), len(FACTS)) == (18, 5, 2)
    assert len(public_names()) == 18 * (1 + first) + 5 * second + 2


def test_no_name_comes_twice():
    assert len(set(public_names())) == len(public_names())


def test_they_are_the_names_of_the_truth():
    assert set(public_names()) == {*all_names(), "status"}


def test_they_are_the_names_that_can_be_asked_for():
    assert tuple(NAMES) == public_names() == derivation().names


def test_the_programs_are_canonical():
    assert validate(derivation().program).inputs == INPUTS
    assert validate(derivation().state).inputs == ("omega",)


def test_every_name_is_computed():
    found = run_in_doubles(derivation().program, POINT)
    assert not [name for name in public_names() if not math.isfinite(found[name])]


def test_every_public_name_says_what_it_is():
    notes = derivation().program.notes
    assert all(notes[name].unit and notes[name].meaning for name in public_names())


def test_every_quantity_of_the_papers_says_where():
    notes = derivation().program.notes
    own = ("j_C", "transmission_angle", "pressure_angle", "alpha_BC", "omega_BC")
    assert not [name for name in QUANTITIES if not notes[name].source and name not in own]


def test_the_state_replaces_lines_of_the_law():
    assert set(derivation().state.outputs) <= {line.name for line in derivation().program.lines}


def test_a_derivative_that_is_a_constant_but_not_0_is_refused():
    with pytest.raises(ValueError, match="Y_wrt_ec is the constant 2"):
        _define_constant(build_sheet(), "Y_wrt_ec", "Y", 2)
