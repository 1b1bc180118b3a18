"""A load as lines of a Program, and totals of a plan as its outputs."""

from ..mechanism.load_lines import LoadLines, Total
from .along_motion import OfMotion, OverSpeed
from .arithmetic import parts_of
from .load import Load, OverY, TableOverTheta
from .resolve import LoadPlan


def line_of(name: str, load: Load) -> LoadLines:
    """The place at which the table of a load is looked up; a function stays an input."""
    if isinstance(load, TableOverTheta):
        return LoadLines(name, "theta", load.period, load.table.knots[0])
    if isinstance(load, OverY):
        return LoadLines(name, load.centre or "Y", ways=load.inward is not None)
    return LoadLines(name, "")


def lines_of(name: str, load: Load) -> LoadLines:
    """The lines of a load; those of its parts where each is a table."""
    if not isinstance(load, OfMotion) or not tables_of(name, load):
        return line_of(name, load)
    parts = [
        LoadLines(part, "V_C", ways=False) if isinstance(table, OverSpeed) else line_of(part, table)
        for part, table in tables_of(name, load).items()
    ]
    return LoadLines(name, "sum", parts=tuple(parts))


def tables_of(name: str, load: Load) -> dict[str, Load]:
    """The tables of a load by the names that its lines have; nothing of a function."""
    if not isinstance(load, OfMotion):
        return {name: load} if isinstance(load, (TableOverTheta, OverY)) else {}
    parts = parts_of(load) or ()
    return {f"{name}_part_{number}": table for number, table in enumerate(parts, 1)}


def totals_of(plan: LoadPlan) -> tuple[Total, ...]:
    """The outputs of a plan, with the terms of each derivative that come through a load."""
    return tuple(
        Total(name, plan.forces_of.get(name, ()), tuple((*term,) for term in plan.terms.get(name, ())))
        for name in plan.shown
    )
