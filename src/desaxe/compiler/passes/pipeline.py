"""The passes in their order, with what each of them saved."""

from collections.abc import Callable, Collection, Iterator, Mapping
from typing import NamedTuple

from ..cost import Cost, cost_of
from ..program import Program
from .bind import bind_constants
from .fold import fold_constants
from .slicing import drop_unused
from .value_numbering import value_numbering


class Pass(NamedTuple):
    """A named pass; a name can be switched off."""

    name: str
    run: Callable[[Program], Program]


class PassCost(NamedTuple):
    """The name of a pass and the cost of the program after it."""

    name: str
    cost: Cost


PASSES = (
    Pass("fold", fold_constants),
    Pass("number", value_numbering),
    Pass("slice", drop_unused),
)


def optimise(program: Program, fixed: Mapping[str, float] | None = None) -> Program:
    """The program with `fixed` inputs bound, after every pass."""
    *_, (_, last) = _stages(program, fixed or {}, ())
    return last


def optimise_in_steps(
    program: Program, fixed: Mapping[str, float] | None = None, without: Collection[str] = ()
) -> tuple[Program, list[PassCost]]:
    """The program after every pass that is not switched off; the cost after each."""
    unknown = set(without) - {step.name for step in PASSES}
    if unknown:
        raise ValueError(f"no pass {', '.join(sorted(unknown))}: {', '.join(step.name for step in PASSES)}")
    stages = list(_stages(program, fixed or {}, without))
    return stages[-1][1], [PassCost(name, cost_of(stage)) for name, stage in stages]


def _stages(
    program: Program, fixed: Mapping[str, float], without: Collection[str]
) -> Iterator[tuple[str, Program]]:
    """The program before and after each pass."""
    program = bind_constants(program, fixed)
    yield "sliced", program
    for step in PASSES:
        if step.name not in without:
            program = step.run(program)
            yield step.name, program
