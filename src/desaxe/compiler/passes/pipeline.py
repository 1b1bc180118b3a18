"""The passes in their order, with what each of them saved."""

from collections.abc import Callable, Collection, Mapping
from functools import partial
from typing import NamedTuple

from ..cost import Cost, cost_of
from ..interpret import ieee_single
from ..program import Program
from .bind import bind_constants
from .fold import fold_constants
from .slicing import drop_unused
from .value_numbering import value_numbering


class Pass(NamedTuple):
    """A named pass; a name can be switched off."""

    name: str
    run: Callable[[Program], Program]


class Step(NamedTuple):
    """The name of a pass and the cost of the program after it."""

    name: str
    cost: Cost


PASSES = (
    Pass("fold", fold_constants),
    Pass("number", value_numbering),
    Pass("slice", drop_unused),
)


def optimise(
    program: Program,
    fixed: Mapping[str, float] | None = None,
    without: Collection[str] = (),
    single: bool = False,
) -> tuple[Program, list[Step]]:
    """The program with `fixed` inputs bound, after every pass not switched off; the cost after each.

    `single`: what is fixed is computed in single precision, in which the rest will run.
    """
    unknown = set(without) - {step.name for step in PASSES}
    if unknown:
        raise ValueError(f"no pass {', '.join(sorted(unknown))}: {', '.join(step.name for step in PASSES)}")
    steps = [Step("sliced", cost_of(program))]
    program = bind_constants(program, fixed or {})
    for step in PASSES:
        if step.name not in without:
            run = partial(fold_constants, apply=ieee_single) if single and step.name == "fold" else step.run
            program = run(program)
            steps.append(Step(step.name, cost_of(program)))
    return program, steps
