"""A load as lines of a Program, and totals of a plan as its outputs."""

from ..mechanism.load_lines import LoadLines, Total
from .load import Load, OverY, TableOverTheta
from .resolve import LoadPlan


def line_of(name: str, load: Load, is_open: bool = False) -> LoadLines:
    """The place at which the table of a load is looked up; a function of theta stays an input.

    Where the table is open, inputs say where its period begins, and whether it is one.
    """
    valid = f"{name}_valid" if is_open else ""
    if isinstance(load, TableOverTheta):
        first = f"{name}_first" if is_open else load.table.knots[0]
        return LoadLines(name, "theta", load.period, first, valid=valid)
    if isinstance(load, OverY):
        return LoadLines(name, load.centre or "Y", ways=load.inward is not None, valid=valid)
    return LoadLines(name, "")


def totals_of(plan: LoadPlan) -> tuple[Total, ...]:
    """The outputs of a plan, with the terms of each derivative that come through a load."""
    return tuple(
        Total(name, plan.forces_of.get(name, ()), tuple((*term,) for term in plan.terms.get(name, ())))
        for name in plan.shown
    )
