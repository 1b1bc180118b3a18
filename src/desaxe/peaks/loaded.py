"""Peaks under loads that vary with the motion: the same search, with values and slopes under these loads.

The text of `search` runs in plain Python; what it calls evaluates many angles of many designs at once, with
total derivatives. Where a load has a kink or a jump there is a node, and next to a jump one on either side:
both one-sided limits take part. A kink of a load over Y moves with the design: the gradient of an extreme
value that is reached there is that at a fixed angle, and the slope over theta times the kink's derivative.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from math import inf, nextafter
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..evaluation.evaluate import evaluate
from ..evaluation.loaded import forces_at, plan_for
from ..loads.angles import dead_centres, passages, repeated
from ..loads.load import FunctionOverTheta, Load, OverTheta, OverY
from ..mechanism.names import LENGTHS, parts, sensitivity
from .compiled import Groups, plain_finish, search_with
from .nodes import Array
from .programs import Search, needs_own, programs_of
from .special import AT_KINK, Designs

NEXT = 2.0 ** -np.array([49.0, 46.0, 43.0])  # rad: nodes on either side of a jump whose angle is rounded
STEP = 2.0**-6  # rad, of a difference
# Of a derivative from eight neighbours: (distance in steps, weight), exact for polynomials of degree 8.
STENCIL = ((1, 4 / 5), (2, -1 / 5), (3, 4 / 105), (4, -1 / 280))


def with_slopes(loads: Mapping[str, Load]) -> dict[str, Load]:
    """The loads, with the derivative of a user's function by differences where it was not given.

    They only lead the search: what it finds is a value of the function itself.
    """
    return {
        name: replace(load, derivative=_Differences(load).at)
        if isinstance(load, FunctionOverTheta) and not load.has_slope
        else load
        for name, load in loads.items()
    }


class _Differences(NamedTuple):
    """The derivative of a load by differences."""

    load: FunctionOverTheta

    def at(self, theta: Any) -> Any:
        """Load and derivative at a number or an array."""
        theta = np.asarray(theta, float)
        total = np.zeros(theta.shape)
        for steps, weight in STENCIL:
            ahead, behind = (self.load(theta + side * steps * STEP) for side in (1.0, -1.0))
            total += weight * (ahead - behind)
        return total / STEP


class Kinks(NamedTuple):
    """Angles at which a load has a kink, a row for each design, padded with NaN.

    fixed    whether the angle stays where it is when the lengths change
    turning  whether it is a dead centre
    """

    angles: Array
    fixed: NDArray[np.bool_]
    turning: NDArray[np.bool_]


def kinks_of(designs: Designs) -> tuple[Kinks, Array]:
    """The kinks of the loads in the range, and all nodes that they need: angles for each design."""
    low, high = designs.theta
    size = designs.size
    nodes, parts = [np.full((size, 1), low)], []
    for load in designs.loads.values():
        if isinstance(load, OverTheta):
            kinks = load.nodes(low, high, smooth=False)
            beside = [nextafter(angle, -inf) for angle in kinks if angle > low]
            every = np.array([*load.nodes(low, high, smooth=True), *beside])
            nodes.append(np.broadcast_to(every, (size, every.size)))
            parts.append((np.broadcast_to(np.array(kinks), (size, len(kinks))), True, False))
        elif isinstance(load, OverY):
            lengths = [designs.columns[name] for name in LENGTHS]
            at = repeated(passages(load.positions(smooth=True), lengths, designs.branch), low, high)
            ends = repeated(dead_centres(lengths), low, high)
            steep = ends if load.inward is not None else ends[:, :0]
            if load.jumps:
                jumps = passages(load.jumps, lengths, designs.branch)
                steep = np.concatenate([steep, repeated(jumps, low, high)], axis=1)
            near = [steep + side * gap for gap in NEXT for side in (-1.0, 1.0)]
            nodes += [at, steep, *near]
            bent = repeated(passages(load.positions(smooth=False), lengths, designs.branch), low, high)
            parts += [(bent, False, False), (ends, False, True)]
    angles = np.concatenate([np.empty((size, 0)), *(part for part, _, _ in parts)], axis=1)
    fixed, turning = (
        np.concatenate([np.empty(0, bool), *(np.full(p[0].shape[1], p[k]) for p in parts)]) for k in (1, 2)
    )
    every = np.concatenate(nodes, axis=1)
    return Kinks(angles, fixed, turning), np.where(np.isnan(every), low, np.clip(every, low, high))


def with_nodes(groups: Groups, nodes: Array) -> Groups:
    """A group of its own for each design: the nodes of its class and its own."""
    order, starts, shared, node_starts = groups
    grids = []
    for g in range(starts.size - 1):
        common = shared[node_starts[g] : node_starts[g + 1]].tolist()
        grids += [
            np.array(sorted({*common, *nodes[row].tolist()})) for row in order[starts[g] : starts[g + 1]]
        ]
    if all(np.array_equal(grid, grids[0]) for grid in grids):
        return Groups(order, np.array([0, order.size]), grids[0], np.array([0, grids[0].size]))
    ends = np.cumsum([0, *(grid.size for grid in grids)])
    return Groups(order, np.arange(order.size + 1), np.concatenate(grids), ends)


def run_under_loads(
    name: str, search: Search, designs: Designs, groups: Groups, kind: int, theta: Array, out: Array
) -> None:
    """Search groups of designs; `theta` and the rows of `out` are filled at these designs."""
    order, starts, nodes, node_starts = groups
    table = np.stack(list(designs.columns.values()))
    values = _Values(name, search, designs)
    run = search_with(values.sweep, values.points, values.finish)
    run(table, order, starts, nodes, node_starts, kind, theta, out)


def moved_with_kinks(
    kind: int, designs: Designs, kinks: Kinks, theta: Array, out: Array, p: tuple[str, ...]
) -> None:
    """Complete gradients of extrema at kinks that move with the lengths; p are the gradient's parameters.

    A kink stays at a position, Y(theta, p) = Y_k, or at a dead centre, Y_wrt_theta = 0.
    """
    gaps = np.abs(kinks.angles - theta[:, None])
    gaps[:, kinks.fixed] = np.nan
    for turning in (False, True):
        rows = np.flatnonzero((gaps[:, kinks.turning == turning] <= AT_KINK).any(axis=1))
        if not rows.size:
            continue
        name = "Y_wrt_theta" if turning else "Y"
        names = [sensitivity(name, q) for q in ("theta", *LENGTHS)]
        found = designs.part(rows)._replace(loads={}).values(tuple(names), np.arange(rows.size), theta[rows])
        for length, by in zip(LENGTHS, names[1:], strict=True):
            if length in p:
                moved = -out[1, rows] * found[by] / found[names[0]]
                sign = np.where(out[0, rows] < 0.0, -1.0, 1.0) if kind == 0 else 1.0
                out[2 + p.index(length), rows] += sign * moved


class _Values:
    """The functions that a search calls, for designs under loads: see `_peaks.stand_ins`."""

    def __init__(self, name: str, search: Search, designs: Designs) -> None:
        self.designs = designs
        self.curve = [name, sensitivity(name, "theta")]
        self.all = [*self.curve, *(sensitivity(name, p) for p in search.parameters)]
        own = needs_own(search.name, ("theta", *search.parameters))
        self.plain = _plain(name, search) if own else None

    def _at(self, names: list[str], theta: Array, block: Array) -> list[Any]:
        bad = np.isnan(theta) | np.isnan(block).any(axis=0)  # 1 is a value that any input can have
        block, theta = (np.where(bad, 1.0, array) for array in (block, theta))
        inputs: dict[str, Any] = dict(zip(self.designs.columns, block, strict=True))
        inputs |= {**self.designs.loads, "theta": theta}
        how: dict[str, Any] = {"branch": self.designs.branch, "accuracy": self.designs.accuracy}
        if self.plain is not None:
            rows = self.plain(inputs, how)[: len(names)]
        else:
            found = evaluate(list(dict.fromkeys(names)), **inputs, **how)
            rows = [found[name] for name in names]
        return [np.where(bad, np.nan, row) for row in rows]

    def sweep(self, count: int, nodes: Array, block: Array, work: Array, value: Array, slope: Array) -> None:
        """Value and slope at every node, for `count` designs."""
        theta = np.repeat(nodes, count)
        columns = np.tile(block[:, :count], (1, nodes.size))
        for out, found in zip((value, slope), self._at(self.curve, theta, columns), strict=True):
            out[: nodes.size, :count] = found.reshape(nodes.size, count)

    def points(self, rows: int, count: int, theta: Array, block: Array, value: Array, slope: Array) -> None:
        """Value and slope, each at its own angle."""
        if count:
            here, columns = theta[:rows, :count].reshape(-1), np.tile(block[:, :count], (1, rows))
            for out, found in zip((value, slope), self._at(self.curve, here, columns), strict=True):
                out[:rows, :count] = found.reshape(rows, count)

    def finish(self, count: int, theta: Array, block: Array, out: Array) -> None:
        """Value, slope and gradient."""
        for row, found in zip(out, self._at(self.all, theta[:count], block[:, :count]), strict=True):
            row[:count] = found


def _plain(name: str, search: Search) -> Callable[..., list[Array]]:
    """Value, slope and gradient of a name whose own derivatives are not derived, by the search's Program."""
    base, own = parts(name)[0], ("theta", *search.parameters)
    finish, rows = plain_finish(search), programs_of(search, False).inputs

    def at(inputs: Mapping[str, Any], how: Mapping[str, Any]) -> list[Array]:
        numbers, plan = plan_for([base, *(sensitivity(base, p) for p in own)], inputs)
        forces = forces_at(plan, numbers, how["branch"], how["accuracy"])
        columns = {**numbers, **forces.values}
        out = np.empty((2 + len(search.parameters), numbers["theta"].size))
        finish(out.shape[1], numbers["theta"], np.stack([columns[row] for row in rows]), out)
        fixed = out.copy()
        for (force, parameter), slope in forces.slopes.items():
            place = 1 if parameter == "theta" else 2 + search.parameters.index(parameter)
            out[place] += fixed[2 + search.parameters.index(force)] * slope
        return list(out)

    return at
