"""Cost: operations, the longest chain, and a throughput estimate from the table."""

from desaxe.compiler.cost import Cost, cost_of
from desaxe.compiler.operations import OPERATIONS
from desaxe.compiler.program import Program
from tests.compiler.coverage_set import coverage
from tests.compiler.programs import committed, program_of_nested


def test_golden():
    program = program_of_nested(("add", ("mul", "x", "y"), ("sqrt", ("mul", "z", "z"))))
    throughput = 2 * OPERATIONS["mul"].cost + OPERATIONS["sqrt"].cost + OPERATIONS["add"].cost
    assert cost_of(program) == Cost(4, 3, throughput, (("add", 1), ("mul", 2), ("sqrt", 1)))


def test_nothing_costs_nothing():
    assert cost_of(Program(("x",), (), ("x",), {})) == Cost(0, 0, 0, ())


def test_a_copy_is_free():
    assert cost_of(program_of_nested(("copy", "x"))).throughput == 0


def test_the_kinds_add_up():
    cost = cost_of(coverage())
    assert sum(count for _, count in cost.by_kind) == cost.operations


def test_less_is_asked_for_less_is_paid():
    alone, together = cost_of(committed("V_C")), cost_of(committed("V_C", "a_C"))
    assert alone.operations < together.operations
    assert alone.throughput < together.throughput
    assert alone.depth <= together.depth
