"""The whole derivation: every name that can be asked for is there, once, and computed."""

import math

import pytest

from desaxe.compiler.interpret import run_in_doubles
from desaxe.compiler.program import validate
from desaxe.derive import bodies
from desaxe.derive.build import INPUTS, public_names
from desaxe.derive.dynamics import FORCES
from desaxe.derive.quantities import FACTS, KINEMATICS, SECOND_ORDER
from desaxe.generated.index import NAMES
from desaxe.mechanism.closed.dead_centres import SENSITIVITIES
from desaxe.mechanism.names import LOADS, PARAMETERS, WHOLE
from desaxe.oracle.force_truth import force_names
from desaxe.oracle.truth import all_names
from tests.compiler.programs import LINKS, POINT
from tests.compiler.programs import LOADS as LOADED
from tests.derive.derived import derivation


def test_how_many_names():
    first, second = len(PARAMETERS), len(PARAMETERS) * (len(PARAMETERS) + 1) // 2
    assert (len(KINEMATICS), len(FORCES), len(SECOND_ORDER), len(FACTS)) == (18, 26, 5, 2)
    assert len(public_names()) == 18 * (1 + first) + 26 * (1 + first + len(LOADS)) + 5 * second + 2 + 12 * 4


def test_no_name_comes_twice():
    assert len(set(public_names())) == len(public_names())


def test_they_are_the_names_of_the_truth():
    whole = {*WHOLE, *SENSITIVITIES}  # their truth: tests/mechanism/closed/truth.py
    assert set(public_names()) == {*all_names(), *force_names(), "status", *whole}


def test_they_are_the_names_that_can_be_asked_for():
    assert tuple(NAMES) == public_names() == derivation().names


def test_the_programs_are_canonical():
    assert validate(derivation().program).inputs == INPUTS
    assert validate(derivation().state).inputs == ("omega",)
    assert validate(derivation().centres).inputs == ("AB", "BC")


def test_every_name_is_computed():
    result = run_in_doubles(derivation().program, POINT | LINKS | LOADED)
    assert not [name for name in public_names() if not math.isfinite(result[name])]


def test_every_public_name_says_what_it_is():
    notes = derivation().program.notes
    assert all(notes[name].unit and notes[name].meaning for name in public_names())


def test_every_quantity_of_the_papers_says_where():
    notes = derivation().program.notes
    own = ("j_C", "transmission_angle", "pressure_angle", "alpha_BC", "omega_BC")
    assert not [name for name in KINEMATICS if not notes[name].source and name not in own]


def test_the_state_replaces_lines_of_the_law():
    assert set(derivation().state.outputs) <= {line.name for line in derivation().program.lines}


def test_the_centres_replace_inputs_and_lines_of_the_law():
    known = {line.name for line in derivation().program.lines} | set(INPUTS)
    assert set(derivation().centres.outputs) <= known


def test_what_the_free_bodies_do_not_give_is_refused():
    with pytest.raises(ArithmeticError, match="T_in is not what the free bodies give"):
        bodies.prove("T_in", bodies.solution()["T_in"] + bodies.m_rod * bodies.r_rod**2 * bodies.alpha)
    bodies.prove("T_in", bodies.solution()["T_in"])


def test_no_name_is_one_that_a_kernel_gives_its_arrays():
    names = [*INPUTS, *(line.name for line in derivation().program.lines)]
    assert not [name for name in names if name.startswith("out_") or name.endswith("_axis")]
