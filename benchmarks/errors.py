"""Everyone's errors at the same points, judged by the audit: by its `errors` against its `truth`.

The points are generic ones and ones next to a change point, at the speed that the works have.
"""

from collections.abc import Iterable

from desaxe.oracle.families import points
from desaxe.oracle.truth import conditions, truth_all

from .accuracy.contenders import INPUTS, NAMES, Run
from .accuracy.contenders import Contender as Judged
from .accuracy.errors import ULPS, Case, Judge, Statistics
from .contenders import Contender
from .race import Racer
from .work import OMEGA0, PARAMETERS, Array, Inputs

FAMILIES = ("generic", "change_point", "near_change_point")
SEED = 1


def cases(family: str, count: int) -> list[Case]:
    """Points of a family with their truth; values whose digits the inputs excuse are judged so."""
    result = []
    for drawn in points(family, count, SEED):
        point = {**drawn, "omega0": OMEGA0, "alpha": 0.0, "branch": 1}
        bounds = {name: ULPS * (1 + conditions(name, **point)) for name in NAMES}
        result.append(Case(point, truth_all(NAMES, **point), bounds, dict.fromkeys(NAMES, 0.0)))
    return result


def judged(contender: Contender, racer: Racer | None) -> Judged:
    """A contender in the audit's form: rows of inputs go to its process, rows of results come back."""

    def run(inputs: Array, _: Array) -> Iterable[Array]:
        if racer is None:
            raise RuntimeError(f"{contender.name} is not running")
        columns = {name: inputs[INPUTS.index(name)].copy() for name in PARAMETERS}
        answers: Iterable[Array] = racer.ask(
            "values", "audited", Inputs(columns, dict.fromkeys(columns, 0), {"omega0": OMEGA0})
        )
        return answers

    def make(branch: int) -> Run:
        if branch != 1:
            raise ValueError(f"branch = {branch}: the works are on branch +1")
        return run

    return Judged(contender.name, make, contender.kind)


def errors(contender: Contender, racer: Racer, families: dict[str, list[Case]]) -> dict[str, Statistics]:
    """Family -> the errors there."""
    judge = Judge(judged(contender, racer))
    return {family: judge.statistics(result) for family, result in families.items()}
