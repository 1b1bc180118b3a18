"""Loads in a kernel: the request that names them, their tables as its arguments.

A kernel looks a load over Y or the stroke up in a pass of its own; one over theta is a column, as its
derivative is, and totals are lines of the kernel. Rounding may decide on the side of a jump for angles next
to it: those points are found from the jump's own angles, and answered again, exactly.
"""

from collections.abc import Iterator, Mapping, Sequence
from math import prod
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...loads.angles import crossings
from ...loads.load import Load, OverTheta, OverY
from ...loads.pieces import Place, piece_at
from ...loads.resolve import LoadPlan, way_of
from ...mechanism.closed import TURN
from ...mechanism.closed.angles import dead_centres
from ...mechanism.names import LENGTHS, STATUSES
from ...runtime.kernels import KernelKey, key_of, plain_of
from ...runtime.request import Request
from ...runtime.threads import run_in_blocks
from ..axes import Outer
from .request import LEAST, are_extreme_under, table_arrays, under_loads

Array = NDArray[Any]
Region = tuple[slice, ...]
SPEEDS = ("omega0", "omega", "alpha")  # of which the way of turning is that of the sign
LEAST_ANGLE = 1e-290  # rad: products with the sine of a smaller one underflow
# Where the plain forms are for, nothing is open farther from a jump's angle than this, in rad times what the
# lengths of the rod in cranks add: the root of that next to a dead centre, where positions hardly change.
BESIDE, BESIDE_DEAD_CENTRE, NEAR_DEAD_CENTRE = 2.0**-30, 2.0**-18, 2.0**-10


class UnderLoads(NamedTuple):
    """Names under loads by one kernel, over some dimensions of a grid; without arrays.

    dims     the dimensions of the outputs, in their order
    wanted   the request, whose variant names the loads
    numbers  the inputs that are numbers here
    key      the kernel of all blocks
    branch   the assembly
    plan     that of the loads
    """

    dims: tuple[str, ...]
    wanted: Request
    numbers: tuple[tuple[str, float], ...]
    key: KernelKey
    branch: int
    plan: LoadPlan

    def arguments(self, values: Mapping[str, Array]) -> dict[str, Any]:
        """The numbers, columns and tables of a block by name."""
        given = {**dict(self.numbers), **{name: np.ascontiguousarray(values[name]) for name in self.dims}}
        over_theta = {name: load for name, load in self.plan.loads.items() if isinstance(load, OverTheta)}
        if over_theta:
            theta = given["theta"]
            forces = self.plan._replace(loads=over_theta).forces(Place(theta, (), 1.0, self.branch), {})
            given |= forces.values
            given |= {f"{force}_by_{p}": slope for (force, p), slope in forces.slopes.items()}
        return {**given, **table_arrays(self.plan.loads)}

    def open(self, values: Mapping[str, Array]) -> dict[str, Array] | None:
        """The points at which rounding may decide on the side of a jump: indices along some dimensions.

        None where there is none; an empty dict where all points may be.
        """
        if not any(isinstance(load, OverY) and load.jumping for load in self.plan.loads.values()):
            return None
        own = [name for name in self.dims if name in LENGTHS]
        given = {**dict(self.numbers), **values}
        grids: Any = np.meshgrid(*(given[name] for name in own), indexing="ij")
        sides = {**given, **{name: grid.reshape(-1) for name, grid in zip(own, grids, strict=True)}}
        shape = [values[name].size for name in own]
        lengths = [np.broadcast_to(np.asarray(sides[name], float), (prod(shape),)) for name in LENGTHS]
        rows, places = open_points(
            self.plan.loads, lengths, self.branch, np.asarray(given["theta"], float).reshape(-1)
        )
        if not rows.size:
            return None
        index = dict(zip(own, np.unravel_index(rows, shape) if own else (), strict=True))
        return {**index, "theta": places} if "theta" in self.dims else index

    def settled(self, values: Mapping[str, Array]) -> Iterator[tuple[Region, list[Array]]]:
        """Regions of a block that rounding leaves open, with the values on the exact side of each jump.

        The same kernel runs on tables of one piece: no digit hangs on who asks.
        """
        index = self.open(values)
        sizes = {name: values[name].size for name in self.dims if name in (index or {}) or name in SPEEDS}
        for point in each_point(index, sizes):
            block = {n: own[point[n] : point[n] + 1] if n in point else own for n, own in values.items()}
            shape = tuple(block[name].size for name in self.dims)
            outs = [np.empty(shape, np.int8 if n in STATUSES else np.float64) for n in self.key.names]
            run_in_blocks(self.key, self.arguments(block) | self._held(block), outs, 1)
            yield region_of(point, self.dims), outs

    def _held(self, block: Mapping[str, Array]) -> dict[str, Array]:
        """The tables of one piece each, that which holds at the one place of a block."""
        own = {name: float(array.item()) for name, array in block.items() if array.size == 1}
        given = {**dict(self.numbers), **own}
        lengths = [given[name] for name in LENGTHS]
        place = Place(given["theta"], lengths, way_of(given), self.branch)
        jumping = {n: a for n, a in self.plan.loads.items() if isinstance(a, OverY) and a.jumping}
        tables = table_arrays(jumping)
        for name, load in jumping.items():
            piece, knots = piece_at(load, place), tables[f"{name}_x"]
            row = tables[f"{name}_c"].reshape(-1, 4)[piece]
            tables[f"{name}_x"] = np.full_like(knots, load.edges(0.0)[max(piece % (knots.size + 1), 1)])
            tables[f"{name}_c"] = np.tile(row, 2 * (knots.size + 1))
        return tables


def in_kernel(
    plan: LoadPlan, outer: Outer, along: Sequence[str], branch: int, accuracy: Any
) -> UnderLoads | None:
    """The kernel of a plan's names over dimensions of a grid; None where it takes more than one."""
    given, axes = outer.given, outer.axes
    few = prod(axes[name].size for name in along) < LEAST
    if few or accuracy == "extended" or not along or are_extreme_under(plan.loads, axes):
        return None
    wanted = under_loads(plan, given, branch, accuracy)
    made = {n for n, load in plan.loads.items() if isinstance(load, OverTheta)}
    columns, numbers = {}, {}
    for name in wanted.inputs:
        if name in axes:
            if name in along:
                columns[name] = np.ascontiguousarray(axes[name])
            elif axes[name].size:
                numbers[name] = float(axes[name].reshape(-1)[0])
        elif name.removesuffix("_by_theta") in made and "theta" in along:
            columns[name] = axes["theta"]
        else:
            return None
    places = {name: along.index(name if name in along else "theta") for name in columns}
    key = key_of(wanted, numbers, columns, places, len(along))
    if not key.form.wide_margins and plain_of(key) is not None:
        return None
    alone = [name for name in ("theta", *LENGTHS) if name not in along]
    numbers |= {name: float(axes[name].reshape(-1)[0]) for name in alone}
    return UnderLoads(tuple(along), wanted, tuple(numbers.items()), key, branch, plan)


def open_points(
    loads: Mapping[str, Load], lengths: Sequence[Array], branch: int, theta: Array
) -> tuple[Array, Array]:
    """The designs, and the places in `theta`, at which rounding may decide on the side of a jump."""
    with np.errstate(invalid="ignore"):
        reduced = np.remainder(theta, TURN)
    order = np.argsort(reduced, kind="stable")
    ascending = reduced[order]
    lost_by_turns = 2.0**-53 * np.abs(theta[np.isfinite(theta)]).max(initial=0.0)
    rows, places = [np.empty(0, np.intp)], [np.empty(0, np.intp)]
    for load in loads.values():
        if isinstance(load, OverY) and load.jumping:
            lost = np.flatnonzero((theta != 0.0) & (np.abs(theta) < LEAST_ANGLE))
            rows.append(np.repeat(np.arange(lengths[0].size), lost.size))
            places.append(np.tile(lost, lengths[0].size))
            angles, room = _jumps(load, lengths, branch)
            row, number = np.nonzero(angles == angles)
            here, beside = np.remainder(angles[row, number], TURN), room[row, number] + lost_by_turns
            for turn in (
                -TURN,
                0.0,
                TURN,
            ):  # next to an end of the turn an angle is beside the other end, too
                near = (
                    np.arange(here.size)
                    if not turn
                    else np.flatnonzero(np.abs(here - 0.5 * (TURN - turn)) <= beside)
                )
                first = np.searchsorted(ascending, here[near] + turn - beside[near])
                last = np.searchsorted(ascending, here[near] + turn + beside[near], side="right")
                for k in np.flatnonzero(last > first):
                    places.append(order[first[k] : last[k]])
                    rows.append(np.full(places[-1].size, row[near[k]]))
    return np.concatenate(rows), np.concatenate(places)


def _jumps(load: OverY, lengths: Sequence[Array], branch: int) -> tuple[Array, Array]:
    """The angles of a load's jumps in a turn, and how far beside each rounding may decide."""
    angles, ends = crossings(load, load.jumps, lengths, branch), dead_centres(lengths)
    # Half of what lies between both angles of a position is that of the crank with the line to the slider.
    first, second = np.split(angles, 2, axis=1)
    flat = np.tile(~(np.abs(np.sin(0.5 * (second - first))) > NEAR_DEAD_CENTRE), 2)
    if load.turns:
        # Without offset the sign of the slope is that of the sine, right to the last bit.
        own = np.where(lengths[0][:, None] == 0.0, np.nan, ends)
        angles, flat = np.append(angles, own, axis=1), np.append(flat, np.ones(own.shape, np.bool_), axis=1)
    ratio = (1.0 + lengths[2] / lengths[1])[:, None]
    return angles, np.where(flat, BESIDE_DEAD_CENTRE * np.sqrt(ratio), BESIDE * ratio)


def each_point(index: Mapping[str, Array] | None, sizes: Mapping[str, int]) -> Iterator[dict[str, int]]:
    """Places along dimensions, from indices along some of them and all along the others; none for None."""
    if index is None:
        return
    others = [name for name in sizes if name not in index]
    own = [dict(zip(index, map(int, row), strict=True)) for row in zip(*index.values(), strict=True)] or [{}]
    for one in own:
        for rest in np.ndindex(*(sizes[name] for name in others)):
            yield {**one, **dict(zip(others, rest, strict=True))}


def region_of(point: Mapping[str, int], dims: Sequence[str]) -> Region:
    """The region of a block at places along some of its dimensions."""
    return tuple(slice(point[n], point[n] + 1) if n in point else slice(None) for n in dims)
