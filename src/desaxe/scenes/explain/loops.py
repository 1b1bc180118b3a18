"""Operations per loop of a kernel: runs of each body, operations per run and per point."""

from collections import Counter
from collections.abc import Mapping, Sequence
from math import prod
from typing import NamedTuple

from ...compiler.kernel import Kernel
from ...compiler.program import Line


class LoopCost(NamedTuple):
    """A loop body: its operations and how often it runs.

    `along` are the axes that it runs over, the outermost first; a `table` runs before the main loops
    and keeps what they read. A `close` one runs in the innermost loop instead of what the plain form has
    there, for the designs whose margins are not wide.
    """

    table: bool
    along: tuple[str, ...]
    runs: int
    operations: int
    kinds: Mapping[str, int]
    values: tuple[str, ...]
    close: bool = False

    @property
    def work(self) -> int:
        """Total operations, without those of the stable form."""
        return 0 if self.close else self.runs * self.operations


def loops_of(kernel: Kernel, axes: Sequence[str], sizes: Sequence[int]) -> list[LoopCost]:
    """Every loop that has operations: tables first, then the main nest from outside in."""
    found = []
    for table in kernel.tables:
        own = [axes[axis] for axis in table.along]
        found += _nest(table.kernel, own, [sizes[axis] for axis in table.along], True)
    found += _nest(kernel, axes, sizes, False)
    if kernel.close is not None:
        loop = _loop(kernel.close.lines, False, tuple(axes), prod(sizes), kernel)
        found.append(loop._replace(close=True))
    return found


def _nest(kernel: Kernel, axes: Sequence[str], sizes: Sequence[int], table: bool) -> list[LoopCost]:
    return [
        _loop(lines, table, tuple(axes[:level]), prod(sizes[:level]), kernel)
        for level, lines in enumerate(kernel.levels)
        if lines
    ]


def _loop(lines: Sequence[Line], table: bool, along: tuple[str, ...], runs: int, kernel: Kernel) -> LoopCost:
    kinds = Counter(line.op for line in lines if line.op != "copy")
    values = tuple(line.name for line in lines if line.name in kernel.notes or line.name in kernel.outputs)
    return LoopCost(table, along, runs, kinds.total(), dict(sorted(kinds.items())), values)
