"""Searches under tables in machine code: loads as lines of their Programs, tables as their arguments.

A table over the crank angle is unrolled over the range: all designs share its nodes. Of one over the
slider's place each design has nodes of its own. Where that jumps, the arcs of each design tell the piece,
exactly; else it is looked up at the slider's place.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from ..evaluation.under_loads.loaded import MOTION, plan_for
from ..evaluation.under_loads.request import under_loads
from ..loads.load import Load, OverY, TableOverTheta
from ..mechanism.load_lines import LoadLines
from .compiled import Groups, Tables
from .course import Course
from .nodes import Array
from .programs import Search
from .special import SearchedDesigns


def search_under(
    search: Search, names: Sequence[str], designs: SearchedDesigns, course: Course
) -> Search | None:
    """The search of total derivatives under tables; None under a function, which nothing compiles.

    names   the quantity, its slope over theta, its gradient
    """
    if search.extended or not all(isinstance(a, (TableOverTheta, OverY)) for a in designs.loads.values()):
        return None
    inputs = {**dict.fromkeys(MOTION), "alpha": 0.0, "theta": 0.0, **designs.columns}
    _, plan = plan_for(names, {**inputs, **designs.loads})
    under = under_loads(plan, inputs, designs.branch, "standard").form.under
    if under is None or len(plan.loads) < len(designs.loads):
        return None
    held = tuple(load.force for load in under.loads if load.force in course.arcs)
    lines = tuple(_line(load, load.force in held) for load in under.loads)
    return search._replace(form=search.form._replace(under=under._replace(loads=lines)), held=held)


def _line(load: LoadLines, held: bool) -> LoadLines:
    return load._replace(over=load.over or "theta", period=0.0, ways=load.ways and not held)


def tables_under(search: Search, designs: SearchedDesigns, course: Course) -> Tables:
    """The tables of a search, and the rows of its designs."""
    assert search.form.under is not None
    loads = [designs.loads[load.force] for load in search.form.under.loads]
    arcs = [course.arcs[name] for name in search.held]
    of_designs = any(isinstance(load, OverY) for load in loads)
    own = course.nodes.T if of_designs else course.nodes.T[:0]
    parts = [np.array([len(own), *(own_arcs.starts.shape[1] for own_arcs in arcs)], float)]
    for load in loads:
        parts += _arrays(load, *designs.theta)
    rows = [own]
    for held in reversed(arcs):
        changes = np.diff(held.pieces, axis=1, prepend=0)
        rows[:0] = [held.starts.T, changes.T]
    starts = len(parts) + 1 + np.cumsum([0, *(part.size for part in parts)])
    return Tables(np.concatenate([starts, *parts]), np.concatenate(rows))


def _arrays(load: Load, low: float, high: float) -> list[Array]:
    """Knots and coefficients; of a table over theta those of all pieces in a range."""
    if isinstance(load, OverY):
        return list(map(np.array, load.arrays()))
    assert isinstance(load, TableOverTheta)
    table, period = load.table, load.period
    knots = load.nodes(low - period, high, smooth=True)
    rows = [table.rows[table.piece(table.reduced(knot))] for knot in knots]
    return [np.array(knots), np.array([rows[0], *rows]).reshape(-1)]


def with_own(groups: Groups, nodes: Array) -> Groups:
    """Groups whose nodes are theirs and those of a load, which all designs share."""
    cuts = groups.node_starts
    grids = [np.union1d(groups.nodes[a:b], nodes) for a, b in pairwise(cuts)]
    ends: Any = np.cumsum([0, *(grid.size for grid in grids)])
    return groups._replace(nodes=np.concatenate(grids), node_starts=ends)
