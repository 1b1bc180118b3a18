"""A load as lines of a Program, and totals of a plan as its outputs."""

from ..mechanism.load_lines import LoadLines, Total
from .load import Load, OverY, TableOverTheta
from .resolve import LoadPlan


def line_of(name: str, load: Load) -> LoadLines:
    """The place at which the table of a load is looked up; a function of theta stays an input."""
    if isinstance(load, TableOverTheta):
        return LoadLines(name, "theta", load.period, load.table.knots[0])
    if isinstance(load, OverY):
        return LoadLines(name, load.centre or "Y", ways=load.inward is not None)
    return LoadLines(name, "")


def totals_of(plan: LoadPlan) -> tuple[Total, ...]:
    """The outputs of a plan, with the terms of each derivative that come through a load."""
    return tuple(
        Total(name, plan.forces_of.get(name, ()), tuple((*term,) for term in plan.terms.get(name, ())))
        for name in plan.shown
    )
