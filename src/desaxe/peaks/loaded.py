"""A quantity under loads that vary with the motion, with total derivatives.

Loads are lines of the Programs of the search: one over the crank angle is an input, as its derivative is; a
table over the slider's place is an argument of the machine code. Between jumps the piece of such a table is
held, as the arcs of each design tell it, so that next to a jump a value is the limit from its side; there are
nodes on both. Double-double arithmetic looks nothing up, and derivatives that are not derived have no totals:
there the loads come first, then the values.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..evaluation.under_loads.columns import MOTION, forces_at, plan_for
from ..evaluation.under_loads.request import table_arrays, under_loads
from ..evaluation.values import values
from ..loads.load import Load, OverTheta, OverY
from ..loads.resolve import Forces, LoadPlan
from ..mechanism.load_lines import LoadLines
from ..mechanism.names import parts, sensitivity
from .course import Course
from .evaluations import Evaluations, compiled, totals_of
from .nodes import Array
from .programs import Search, needs_own, programs_of
from .special import SearchedDesigns

Rows = NDArray[np.intp]


class ValuesUnderLoads:
    """A quantity, its slope over theta and its gradient, for designs under loads.

    The input of a design in a block is its number.
    """

    def __init__(self, name: str, search: Search, designs: SearchedDesigns, course: Course) -> None:
        self.designs, self.course, self.search = designs, course, search
        self.all = [name, *(sensitivity(name, p) for p in ("theta", *search.parameters))]
        self.bad = np.isnan(np.array(list(designs.columns.values()))).any(axis=0)
        self.derived = not needs_own(search.name, ("theta", *search.parameters))
        self.plans: dict[int, LoadPlan] = {}
        under = search_under(search, self.all, designs) if self.derived else None
        self.under = under
        self.tables = table_arrays(designs.loads)

    def at(self, count: int, rows: Rows, theta: Array, pieces: dict[str, Rows] | None = None) -> list[Array]:
        """Value, slope and gradient, the first `count` of them, at angles that broadcast with some designs.

        pieces   of the loads that jump, without those that hold at these angles
        """
        held = self.course.pieces(rows, theta) if pieces is None else pieces
        aside = self.course.aside(rows, theta) if pieces is None and self.designs.rubs else theta
        by = self._of_totals if self.under is not None else self._of_good
        found = [*by(count, rows, aside, held)][:count]
        if aside is not theta:
            found[0] = np.where(aside == theta, found[0], found[0] + found[1] * (theta - aside))
        return found

    def _of_totals(self, count: int, rows: Rows, theta: Array, held: dict[str, Rows]) -> Sequence[Array]:
        """By machine code."""
        totals = compiled(totals_of, self.under, "curve" if count == 2 else "finish")
        inputs = {**self.tables, **over_theta_at(self.designs.loads, theta), "theta": theta}
        inputs |= {f"{force}_piece": piece.astype(float) for force, piece in held.items()}
        columns = self.designs.columns
        for name in totals.inputs:
            if name in columns:
                column = columns[name]
                inputs[name] = column[rows] if column.strides[0] else column[:1]  # or one number for all
        return totals(inputs)

    def _of_good(self, count: int, rows: Rows, theta: Array, held: dict[str, Rows]) -> Sequence[Array]:
        """By values at the angles and designs that are numbers; NaN at others."""
        theta, rows = np.broadcast_arrays(theta, rows)
        bad = np.isnan(theta) | self.bad[rows]
        shape, rows, theta = theta.shape, rows.reshape(-1), np.where(bad, 1.0, theta).reshape(-1)
        inputs: dict[str, Any] = {"alpha": 0.0, "theta": theta}
        inputs |= {n: np.where(self.bad, 1.0, column)[rows] for n, column in self.designs.columns.items()}
        held = {force: piece.reshape(-1) for force, piece in held.items()}
        found = self._of_plan(count, inputs, held) if self.derived else self._of_search(inputs, held)
        return [np.where(bad, np.nan, row.reshape(shape)) for row in found]

    def _of_plan(self, count: int, inputs: dict[str, Any], held: dict[str, Rows]) -> list[Array]:
        names = list(dict.fromkeys(self.all[:count]))
        given = {**dict.fromkeys(MOTION), **inputs}
        plan, forces = self._forces(names, inputs, held)
        branch, accuracy = self.designs.branch, self.designs.accuracy
        found = plan.totals(values(list(plan.names), {**given, **forces.values}, branch, accuracy), forces)
        return [found[name] for name in self.all[:count]]

    def _of_search(self, inputs: dict[str, Any], held: dict[str, Rows]) -> list[Array]:
        """By the search's Program: of a name whose own derivatives are not derived."""
        base = parts(self.all[0])[0]
        names = [base, *(sensitivity(base, p) for p in ("theta", *self.search.parameters))]
        _, forces = self._forces(names, inputs, held)
        columns = {**inputs, **forces.values}
        block = np.stack([columns[n] for n in programs_of(self.search).inputs])
        out = Evaluations(self.search).finish(inputs["theta"], block)
        fixed = out.copy()
        for (force, parameter), slope in forces.slopes.items():
            place = 1 if parameter == "theta" else 2 + self.search.parameters.index(parameter)
            out[place] += fixed[2 + self.search.parameters.index(force)] * slope
        return list(out)

    def _forces(
        self, names: list[str], inputs: dict[str, Any], held: dict[str, Rows]
    ) -> tuple[LoadPlan, Forces]:
        if len(names) not in self.plans:
            self.plans[len(names)] = plan_for(names, {**inputs, **self.designs.loads})[1]
        plan = self.plans[len(names)]
        return plan, forces_at(plan, inputs, self.designs.branch, self.designs.accuracy, held)

    def block(self, designs: SearchedDesigns, rows: Rows) -> Array:
        """The inputs of designs for `curve` and `finish`."""
        return rows[None].astype(float)

    def curve(self, theta: Array, block: Array) -> tuple[Array, Array]:
        """Value and slope at angles that broadcast with the rows of the block."""
        value, slope = self.at(2, block[0].astype(np.intp), theta)
        return value, slope

    def finish(self, theta: Array, block: Array) -> Array:
        """Value, slope and gradient at an angle of each design: a row each."""
        return np.array(self.at(len(self.all), block[0].astype(np.intp), theta))


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
