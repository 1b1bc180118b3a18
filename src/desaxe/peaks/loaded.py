"""Peaks under loads that vary with the motion: the same search, with values and slopes under these loads.

The text of `search` runs by NumPy, many designs at once, each with nodes of its own; what it calls has total
derivatives. Between jumps the piece of a load over Y is held, so that next to one a value is the limit
from its side; there are nodes on both.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..evaluation.under_loads.loaded import MOTION, forces_at, plan_for
from ..evaluation.values import values
from ..loads.resolve import Forces, LoadPlan
from ..mechanism.names import parts, sensitivity
from ..support.progress import Portions
from .compiled import NO_TABLES, Groups, plain_finish, search_by_rows
from .course import Course
from .nodes import Array
from .programs import Search, needs_own, programs_of
from .special import SearchedDesigns

Rows = NDArray[np.intp]


MOST = 2**18  # angles at once: the arrays of a block are a few megabytes each


def with_nodes(groups: Groups, own: Array) -> Iterator[tuple[Rows, Array]]:
    """Blocks of designs, and for each of them a row of nodes: those of its group and its own, ascending."""
    order, starts, shared, node_starts = groups
    widest = int(np.diff(node_starts).max())
    size = max(1, MOST // (widest + own.shape[1]))
    for first in range(0, order.size, size):
        rows = order[first : first + size]
        nodes = np.repeat(own[rows, :1], widest, axis=1)
        for g in range(starts.size - 1):
            here = nodes[max(starts[g] - first, 0) : max(starts[g + 1] - first, 0)]
            grid = shared[node_starts[g] : node_starts[g + 1]]
            here[:, : grid.size] = grid
        yield rows, np.sort(np.append(nodes, own[rows], axis=1), axis=1)


class ValuesUnderLoads:
    """A quantity, its slope over theta and its gradient, for designs under loads.

    Its methods are the functions that a search calls (declared in `search`), whose only input is the
    design's number.
    """

    def __init__(
        self, name: str, search: Search, designs: SearchedDesigns, course: Course, told: Portions
    ) -> None:
        self.designs, self.course, self.search, self.told = designs, course, search, told
        self.curve = [name, sensitivity(name, "theta")]
        self.all = [*self.curve, *(sensitivity(name, p) for p in search.parameters)]
        self.bad = np.isnan(np.array(list(designs.columns.values()))).any(axis=0)
        self.derived = not needs_own(search.name, ("theta", *search.parameters))
        self.plans: dict[int, LoadPlan] = {}

    def run(self, rows: Rows, nodes: Array, kind: int, theta: Array, out: Array) -> None:
        """Search designs with a row of nodes each; `theta` and `out` are filled at these designs."""
        numbers = np.arange(float(self.designs.size))[None]
        search = search_by_rows(self.sweep, self.points, self.finish)
        size, widths = max(1, MOST // nodes.shape[1]), np.array([0, nodes.shape[1]])
        for first in range(0, rows.size, size):
            part = rows[first : first + size]
            grid = np.ascontiguousarray(nodes[first : first + size].T)
            starts = np.array([0, part.size])
            search(numbers, part, starts, grid, widths, NO_TABLES, kind, theta, out)

    def at(self, count: int, rows: Rows, theta: Array, pieces: dict[str, Rows] | None = None) -> list[Array]:
        """Value, slope and gradient, the first `count` of them, at an angle of each of some designs.

        pieces   of the loads that jump, without those that hold at these angles
        """
        bad = np.isnan(theta) | self.bad[rows]
        some = bool(bad.any())
        theta = np.where(bad, 1.0, theta) if some else theta  # a value that any input can have
        held = self.course.pieces(rows, theta) if pieces is None else pieces
        aside = self.course.aside(rows, theta) if pieces is None and self.designs.rubs else theta
        inputs: dict[str, Any] = {"alpha": 0.0, "theta": aside}
        for name, column in self.designs.columns.items():
            inputs[name] = np.where(bad, 1.0, column[rows]) if some else column[rows]
        found = self._of_plan(count, inputs, held) if self.derived else self._of_search(inputs, held)
        if aside is not theta:
            found[0] = np.where(aside == theta, found[0], found[0] + found[1] * (theta - aside))
        return [np.where(bad, np.nan, row) for row in found[:count]] if some else found[:count]

    def _of_plan(self, count: int, inputs: dict[str, Any], held: dict[str, Rows]) -> list[Array]:
        names = list(dict.fromkeys(self.all[:count]))
        given = {**dict.fromkeys(MOTION), **inputs}
        plan, forces = self._forces(names, inputs, held)
        branch, accuracy = self.designs.branch, self.designs.accuracy
        found = plan.totals(values(list(plan.names), {**given, **forces.values}, branch, accuracy), forces)
        return [found[name] for name in self.all[:count]]

    def _of_search(self, inputs: dict[str, Any], held: dict[str, Rows]) -> list[Array]:
        """By the search's Program: of a name whose own derivatives are not derived."""
        base = parts(self.curve[0])[0]
        names = [base, *(sensitivity(base, p) for p in ("theta", *self.search.parameters))]
        _, forces = self._forces(names, inputs, held)
        columns = {**inputs, **forces.values}
        out = np.empty((len(self.all), inputs["theta"].size))
        rows = programs_of(self.search, False).inputs
        block = np.stack([columns[n] for n in rows])
        plain_finish(self.search)(out.shape[1], inputs["theta"], block, NO_TABLES, out)
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

    def sweep(
        self, count: int, nodes: Array, block: Array, tables: Array, work: Array, value: Array, slope: Array
    ) -> None:
        """Value and slope at every node, for `count` designs."""
        self.points(len(nodes), count, nodes, block, tables, value, slope)
        self.told.add(count)

    def points(
        self, rows: int, count: int, theta: Array, block: Array, tables: Array, value: Array, slope: Array
    ) -> None:
        """Value and slope, each at its own angle."""
        if count:
            here, own = theta[:rows, :count].reshape(-1), np.tile(block[0, :count].astype(np.intp), rows)
            for out, found in zip((value, slope), self.at(2, own, here), strict=True):
                out[:rows, :count] = found.reshape(rows, count)

    def finish(self, count: int, theta: Array, block: Array, tables: Array, out: Array) -> None:
        """Value, slope and gradient."""
        found = self.at(len(self.all), block[0, :count].astype(np.intp), theta[:count])
        for row, values_ in zip(out, found, strict=True):
            row[:count] = values_
