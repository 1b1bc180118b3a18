"""Totals under loads in machine code: loads as lines of the Programs of a search, tables as their arguments.

A load over the crank angle is an input, as its derivative is. A table over the slider's place that jumps has
the number of its piece as an input, which the arcs of each design tell; any other is looked up.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from ..evaluation.under_loads.columns import MOTION, plan_for
from ..evaluation.under_loads.request import under_loads
from ..loads.load import Load, OverTheta, OverY
from ..mechanism.load_lines import LoadLines
from .nodes import Array
from .programs import Search
from .special import SearchedDesigns


def search_under(search: Search, names: Sequence[str], designs: SearchedDesigns) -> Search | None:
    """The search of total derivatives under loads; None in double-double arithmetic, which looks nothing up.

    names   the quantity, its slope over theta, its gradient
    """
    if search.extended:
        return None
    inputs = {**dict.fromkeys(MOTION), "alpha": 0.0, "theta": 0.0, **designs.columns}
    _, plan = plan_for(names, {**inputs, **designs.loads})
    under = under_loads(plan, inputs, designs.branch, "standard").wanted.form.under
    if under is None or len(plan.loads) < len(designs.loads):
        return None
    lines = (_line(line, designs.loads[line.force]) for line in under.loads)
    return search._replace(form=search.form._replace(under=under._replace(loads=tuple(lines))))


def _line(line: LoadLines, load: Load) -> LoadLines:
    if isinstance(load, OverY):
        return line._replace(held=True, ways=False) if load.jumping else line
    return LoadLines(line.force, "")


def over_theta_at(loads: Mapping[str, Load], theta: Array) -> dict[str, Any]:
    """Values and derivatives at crank angles of the loads over them."""
    found: dict[str, Any] = {}
    for name, load in loads.items():
        if isinstance(load, OverTheta):
            for key, values in zip((name, f"{name}_by_theta"), load.both(theta.reshape(-1)), strict=True):
                found[key] = values.reshape(theta.shape)
    return found
