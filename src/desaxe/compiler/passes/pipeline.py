"""The passes in their order, and the operations that each of them leaves."""

from collections.abc import Callable, Iterator, Mapping

from ..program import Program
from .bind import bind_constants
from .fold import fold_constants
from .slicing import drop_unused
from .value_numbering import value_numbering

PASSES: Mapping[str, Callable[[Program], Program]] = {
    "fold": fold_constants,
    "number": value_numbering,
    "slice": drop_unused,
}


def optimise(program: Program, fixed: Mapping[str, float] | None = None) -> Program:
    """The program with `fixed` inputs bound, after every pass."""
    *_, (_, last) = _stages(program, fixed or {})
    return last


def optimise_in_steps(
    program: Program, fixed: Mapping[str, float] | None = None
) -> tuple[Program, list[tuple[str, int]]]:
    """The program after every pass; the operations before the first and after each, by its name."""
    stages = list(_stages(program, fixed or {}))
    return stages[-1][1], [(name, len(stage.lines)) for name, stage in stages]


def _stages(program: Program, fixed: Mapping[str, float]) -> Iterator[tuple[str, Program]]:
    """The program before and after each pass."""
    program = bind_constants(program, fixed)
    yield "sliced", program
    for name, run in PASSES.items():
        program = run(program)
        yield name, program
