"""Cost of a Program: operations, depth, and a throughput estimate from the operation table."""

from collections import Counter
from typing import NamedTuple

from .operations import OPERATIONS
from .program import Program, names_in


class Cost(NamedTuple):
    """Operations in all and by kind, longest chain, throughput in additions."""

    operations: int
    depth: int
    throughput: float
    by_kind: tuple[tuple[str, int], ...]


def cost_of(program: Program) -> Cost:
    """The cost of one pass through the program."""
    kinds = Counter(line.op for line in program.lines)
    depth: dict[str, int] = {}
    for line in program.lines:
        depth[line.name] = 1 + max((depth.get(name, 0) for name in names_in(line.args)), default=0)
    throughput = sum(OPERATIONS[op].cost * count for op, count in kinds.items())
    return Cost(len(program.lines), max(depth.values(), default=0), throughput, tuple(sorted(kinds.items())))
