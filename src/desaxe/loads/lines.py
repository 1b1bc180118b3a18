"""A load as lines of a Program and as the arrays of its table; totals of a plan as its outputs."""

from itertools import chain
from typing import NamedTuple

from ..mechanism.load_lines import LoadLines, Total
from .load import Load, OverY, TableOverTheta
from .resolve import Plan


class Arrays(NamedTuple):
    """Knots of a table, and the coefficients of its pieces, those inward behind those outward."""

    knots: tuple[float, ...]
    coefficients: list[float]


def arrays_of(load: Load) -> Arrays:
    """The table of a load."""
    if isinstance(load, TableOverTheta):
        return Arrays(load.table.knots, [*chain.from_iterable(load.table.rows)])
    assert isinstance(load, OverY)
    ways = load.outward, load.outward if load.inward is None else load.inward
    return Arrays(load.outward.knots, [*chain.from_iterable(row for table in ways for row in table.rows)])


def line_of(name: str, load: Load) -> LoadLines:
    """The place at which the table of a load is looked up; a function of theta stays an input."""
    if isinstance(load, TableOverTheta):
        return LoadLines(name, "theta", load.period, load.table.knots[0])
    if isinstance(load, OverY):
        return LoadLines(name, load.centre or "Y", ways=load.inward is not None)
    return LoadLines(name, "")


def totals_of(plan: Plan) -> tuple[Total, ...]:
    """The outputs of a plan, with the terms of each derivative that come through a load."""
    return tuple(
        Total(name, plan.forces_of.get(name, ()), tuple((*term,) for term in plan.terms.get(name, ())))
        for name in plan.shown
    )
