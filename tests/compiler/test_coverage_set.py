"""The coverage set covers."""

from desaxe.compiler.operations import OPERATIONS
from desaxe.compiler.program import validate
from tests.compiler.coverage_set import coverage
from tests.compiler.programs import LOOKUPS


def test_every_operation_is_in_it():
    assert {line.op for line in coverage().lines} == set(OPERATIONS) - set(LOOKUPS)


def test_it_is_a_valid_program():
    assert validate(coverage()).inputs == ("x", "y", "z")
