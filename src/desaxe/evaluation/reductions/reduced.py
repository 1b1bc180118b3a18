"""Reductions of a grid (largest, mean, ...) along some of its axes: steps of a plan.

    steps = reduced_of(outer, branch, accuracy, reductions)   # the kinds of all names, then each measure

The grid is never stored: its points are computed and reduced block by block. Where all kinds combine, a long
axis is cut, too; for others (std, percentiles) the axes that are reduced first are whole in every block.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from math import inf, prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...loads.along_motion import members_of
from ...loads.angles import crossings
from ...loads.load import Load, OverTheta, OverY
from ...loads.table import SAME
from ...mechanism.catalogue import quantity
from ...mechanism.closed import TURN
from ...mechanism.closed.angles import dead_centres
from ...mechanism.inputs import INPUTS
from ...mechanism.names import LENGTHS
from ...mechanism.own import Definition
from ...runtime.threads import run_parts
from ..chunks import Slices, blocks_of, chunk_lengths, longest
from ..labels import Output, attributes, input_attributes, side_attributes
from ..points import Outer, Points, Step, outer_arrays, points_of
from .argument import At, Chain, Reductions, chain_name, extremes_at_end
from .kinds import Field, combined, field_of, folded, kind_of
from .own_measure import OwnMeasure

Array = NDArray[Any]
Fields = dict[tuple[str, tuple[tuple[str, ...], str]], Field]  # by name, axes and kind
FLOAT = np.dtype(np.float64)
BLOCK = 2**16  # points whose values stay in the second-level cache
PIECE = 2**20  # points behind a number that are in memory at once, where pieces combine
NEAR = 1e-11  # of 1 + theta: more than what is rounded of the angle of a jump
LEAST, LONGEST = 2 * BLOCK, 64 * BLOCK  # points of a part: worth a thread; an interrupt is heard after it


@dataclass(frozen=True)
class Reduced(Step):
    """Kinds of names over the axes that are left.

    names       those of which a kind is taken
    reductions  what is taken
    of          the values of `names`: over the axes that are left, those reduced later, those reduced first
    """

    names: tuple[str, ...]
    reductions: Reductions
    of: Points

    @property
    def own(self) -> tuple[Definition, ...]:
        """The definitions that it needs."""
        return self.of.own

    @property
    def identity(self) -> str:
        """A text that tells the step from all others, by what its loads are too."""
        return f"{self!r} {self.of.identity}"

    @property
    def outputs(self) -> dict[str, Output]:
        """The outputs by name: their types and CF attributes."""
        result: dict[str, Output] = {}
        along = ", ".join(self.reductions.axes)
        for name in self.names:
            for chain in self.reductions.chains(name):
                result |= self._outputs(name, chain)
            words = f"points along {along} without a {name} (infeasible, stalled, bad)"
            result[f"{name}_skipped"] = Output(np.dtype(np.int64), {"units": "1", "long_name": words})
        return result

    def _outputs(self, name: str, chain: Chain) -> dict[str, Output]:
        """The result of a chain, where it is, and on which side of a jump."""
        variable = chain_name(name, chain)
        method = " ".join(": ".join((*axes, kind_of(kind).method)) for axes, kind in chain)
        about = attributes(name, self.of.call.asked.form.state)
        result = {variable: Output(FLOAT, {**about, "quantity": name, "cell_methods": method})}
        for axis in extremes_at_end(chain):
            place = input_attributes(axis)
            what = place["long_name"] if axis in INPUTS else f"position along {axis}"
            words = f"{what} of the {variable.removeprefix(f'{name}_')} of {name}"
            result[f"{variable}_{axis}"] = Output(FLOAT, {**place, "long_name": words, "quantity": axis})
        if self._has_side(chain):
            result[f"{variable}_side"] = Output(np.dtype(np.int8), side_attributes())
        return result

    def _has_side(self, chain: Chain) -> bool:
        """True if the result of a chain is a sample over theta under loads that may jump."""
        return self.of.call.loads is not None and "theta" in extremes_at_end(chain)

    def compute(self, values: Mapping[str, Array], threads: int | None = 1) -> dict[str, Array]:
        """The outputs of a block by name, from the values along its `columns`."""
        result: dict[str, Array] = {}
        firsts = self._firsts(values, threads)
        for name in self.names:
            for chain in self.reductions.chains(name):
                (axes, kind), *rest = chain
                first = firsts[name, chain[0]]
                field = folded(first, [axis for axis in axes if axis in first.dims], kind, values)
                for axes, kind in rest:
                    field = folded(field_of(field.dims, field.values, field.places), axes, kind, values)
                variable = chain_name(name, chain)
                result[variable] = field.values
                result |= {f"{variable}_{axis}": field.places[axis] for axis in extremes_at_end(chain)}
                if self._has_side(chain):
                    result[f"{variable}_side"] = self._side(name, field, values)
            later = tuple(range(len(self.dims), len(first.dims)))
            points = prod(values[axis].size for axis in self.reductions.axes)
            result[f"{name}_skipped"] = np.asarray(points - first.points.sum(axis=later))
        return result

    def _firsts(self, values: Mapping[str, Array], threads: int | None) -> Fields:
        """The values, reduced along the first axes of each chain, or along those of the first stage."""
        dims, reductions = self.of.dims, self.reductions
        keys = dict.fromkeys((name, chain[0]) for name in self.names for chain in reductions.chains(name))
        combines = all(kind_of(kind).combines for _, (_, kind) in keys)
        first = reductions.first if combines else reductions.axes
        rest = tuple(name for name in dims if name not in first)
        taken = {key: [name for name in dims if name in first and name in key[1][0]] for key in keys}
        columns = self.columns
        sizes = {dim: values[name].size for name, dim in columns.items()}
        sizes = {dim: sizes[dim] for dim in dims}
        regions = [*self._regions(sizes, rest, combines)]
        parts: list[Fields] = [{}] * len(regions)

        def part(start: int, stop: int) -> None:
            for k in range(start, stop):
                block = {name: values[name][regions[k][dim]] for name, dim in columns.items()}
                fields = {n: field_of(dims, a) for n, a in self.of.compute(block, 1).items()}
                parts[k] = {
                    key: folded(fields[key[0]], axes, key[1][1], block) for key, axes in taken.items()
                }

        points = max([1, *(prod(one.stop - one.start for one in region.values()) for region in regions[:1])])
        run_parts(part, len(regions), threads, max(1, LEAST // points), max(1, LONGEST // points))
        result = {key: _empty(dims, sizes, axes, key[1][1]) for key, axes in taken.items()}
        for place, group in groupby(range(len(regions)), lambda k: [regions[k][name] for name in rest]):
            pieces = [parts[k] for k in group]
            for key, field in result.items():
                _fill(field, tuple(place), combined([one[key] for one in pieces], key[1][1]))
        return result

    def _regions(self, sizes: Mapping[str, int], rest: Sequence[str], combines: bool) -> Iterator[Slices]:
        """The blocks of a grid: pieces of the axes that are reduced first, in their order, for some others.

        The pieces depend on these axes alone, so that sums have one order however a grid is cut.
        """
        first = {name: size for name, size in sizes.items() if name not in rest}
        pieces = longest(chunk_lengths("auto" if combines else -1, first, PIECE))
        points = prod(min(pieces[name], max(size, 1)) for name, size in first.items())
        others = chunk_lengths("auto", {name: sizes[name] for name in rest}, max(1, BLOCK // points))
        lengths = {**longest(others), **pieces}
        whole = {name: max(size, 1 if name in first else 0) for name, size in sizes.items()}
        return (regions for _, regions in blocks_of(whole, lengths))

    def _side(self, name: str, field: Field, values: Mapping[str, Array]) -> Array:
        """The sides of jumps on which extremes over theta are; 0 where other inputs were averaged."""
        shape, along = field.values.shape, self.of.columns
        left = {n: dim for n, dim in along.items() if dim in self.dims}
        points = dict(outer_arrays(values, left, self.dims))
        for n, dim in along.items():
            if dim in field.places:
                at = field.places[dim]
                points[n] = at if n == dim else values[n][np.nan_to_num(at).astype(np.intp)]
        if points.keys() != along.keys():
            return np.zeros(shape, np.int8)
        flat = {n: np.broadcast_to(column, shape).reshape(-1) for n, column in points.items()}
        return _sides_of(name, self.of, flat).reshape(shape)


def _empty(dims: Sequence[str], sizes: Mapping[str, int], axes: Sequence[str], kind: str) -> Field:
    """A field to be filled, of values that are reduced along axes."""
    left = tuple(name for name in dims if name not in axes)
    shape = [sizes[name] for name in left]
    places = {axis: np.empty(shape) for axis in axes} if kind_of(kind).score else {}
    return Field(left, np.empty(shape), np.empty(shape, np.int64), places)


def _fill(field: Field, region: tuple[slice, ...], part: Field) -> None:
    """Fill a region of a field."""
    for own, values in zip((field.values, field.points), (part.values, part.points), strict=True):
        own[region] = values
    for axis, places in part.places.items():
        field.places[axis][region] = places


def _sides_of(name: str, source: Points, points: Mapping[str, Array]) -> NDArray[np.int8]:
    """-1 for a sample that is the last one before a jump, 1 for the first one after it, else 0."""
    size = points["theta"].size
    points = {**{n: np.full(size, value) for n, value in source.numbers}, **points}
    side = np.zeros(size, np.int8)
    call = source.call
    loads = members_of(() if call.loads is None else call.loads.loads.values())
    branch = int(dict(call.asked.fixed)["branch"])
    near = np.logical_or.reduce([_near(load, points, branch) for load in loads])
    rows = np.flatnonzero(near)
    if rows.size:
        some = {n: column[rows] for n, column in points.items()}
        beside = [np.nextafter(some["theta"], end) for end in (-inf, inf)]
        before, here, after = (
            source.at({**some, "theta": theta})[name] for theta in (beside[0], some["theta"], beside[1])
        )
        side[rows] = 1 * _differ(here, before) - 1 * _differ(here, after)
    return side


def _differ(one: Array, other: Array) -> NDArray[np.bool_]:
    apart: NDArray[np.bool_] = ~(np.abs(one - other) <= SAME * np.maximum(np.abs(one), np.abs(other)))
    return apart


def _near(load: Load, points: Mapping[str, Array], branch: int) -> NDArray[np.bool_]:
    """Mask of the samples that are within rounding of a jump of a load."""
    theta = points["theta"]
    if isinstance(load, OverTheta):
        return _near_nodes(np.array(load.nodes(0.0, load.period, smooth=False)), load.period, theta)
    if not isinstance(load, OverY):
        return np.zeros(theta.size, np.bool_)
    lengths = [points[n] for n in LENGTHS]
    angles = [crossings(load, load.jumps, lengths, branch), *([dead_centres(lengths)] if load.turns else [])]
    away = theta[:, None] - np.concatenate(angles, axis=1)
    away -= TURN * np.round(away / TURN)
    near: NDArray[np.bool_] = (np.abs(away) <= NEAR * (1.0 + np.abs(theta[:, None]))).any(axis=1)
    return near


def _near_nodes(nodes: Array, period: float, theta: Array) -> NDArray[np.bool_]:
    """Mask of the angles that are within rounding of one of the sorted nodes of a period."""
    if not nodes.size:
        return np.zeros(theta.size, np.bool_)
    nodes = np.concatenate([nodes[-1:] - period, nodes, nodes[:1] + period])
    rest = theta - period * np.floor(theta / period)
    after = np.searchsorted(nodes, rest).clip(1, nodes.size - 1)
    away = np.minimum(np.abs(rest - nodes[after - 1]), np.abs(rest - nodes[after]))
    near: NDArray[np.bool_] = away <= NEAR * (1.0 + np.abs(theta))
    return near


@dataclass(frozen=True)
class AtPlace(Points):
    """The values of a name at one place of an axis, which is a number there."""

    place: At

    @property
    def outputs(self) -> dict[str, Output]:
        """The output: its type and CF attributes."""
        name, state = self.place.name, self.call.asked.form.state
        words = f"{quantity(name, state).meaning} at {self.place.axis} = {self.place.text}"
        about = {**attributes(name, state), "long_name": words, "quantity": name}
        return {self.place.variable: Output(FLOAT, about)}

    def compute(
        self, values: Mapping[str, Array], threads: int | None = 1, out: Any = None
    ) -> dict[str, Array]:
        """The output of a block, from the values of its `columns`."""
        return {self.place.variable: super().compute(values, threads, out)[self.place.name]}


@dataclass(frozen=True)
class OfDesign(Step):
    """A user's function of the design, with its derivatives with respect to some parameters."""

    function: OwnMeasure
    numbers: tuple[tuple[str, float], ...]
    slopes: tuple[str, ...]

    @property
    def outputs(self) -> dict[str, Output]:
        """The outputs by name: their types and CF attributes."""
        name = self.function.name
        slopes = [f"{name}_wrt_{p}" for p in self.slopes]
        first = {name: Output(FLOAT, {"long_name": f"{name} of the design"})}
        return first | {slope: Output(FLOAT, {"long_name": slope}) for slope in slopes}

    def compute(self, values: Mapping[str, Array], threads: int | None = 1) -> dict[str, Array]:
        """The outputs of a block by name, from the values along its `columns`."""
        columns = outer_arrays(values, self.columns, self.dims)
        value, gradient = self.function({**dict(self.numbers), **columns})
        shape = np.broadcast_shapes(*(array.shape for array in columns.values()))
        arrays = [value, *(gradient.get(p, 0.0) for p in self.slopes)]
        return {n: np.array(np.broadcast_to(a, shape)) for n, a in zip(self.outputs, arrays, strict=True)}


def reduced_of(outer: Outer, branch: int, accuracy: Any, reductions: Reductions) -> tuple[Step, ...]:
    """The steps of what is taken of a grid, checked: the kinds of all names, then each measure."""
    dims = tuple(name for name in outer.dimensions if name not in reductions.axes)
    names = tuple(name for name in outer.names if reductions.chains(name))
    steps: list[Step] = []
    if names:
        last = "theta", *sorted(outer.sizes, key=lambda dim: -outer.sizes[dim])
        end = next(dim for dim in last if dim in reductions.first)
        first = *(dim for dim in reductions.first if dim != end), end
        later = (dim for dim in reductions.axes if dim not in first)
        of = points_of(names, outer, (*dims, *later, *first), branch, accuracy)
        columns = {**of.columns, **{axis: axis for axis in reductions.axes}}  # of extremes we say where
        steps.append(Reduced(dims, tuple(columns.items()), names, reductions, of))
    for one in reductions.at:
        if [n for n, dim in outer.along.items() if dim == one.axis] != [one.axis]:
            raise ValueError(f"reduce: at {one.text}: several inputs vary along {one.axis}")
        axes = {**outer.axes, one.axis: np.array(one.place)}
        there = outer._replace(axes=axes, along={n: d for n, d in outer.along.items() if n != one.axis})
        steps.append(AtPlace(**vars(points_of((one.name,), there, dims, branch, accuracy)), place=one))
    along = {name: dim for name, dim in outer.along.items() if dim in dims}
    numbers = tuple((name, float(array)) for name, array in outer.axes.items() if not array.ndim)
    design = {**dict(numbers), **{n: outer.axes[n][:1] for n in along}}
    steps.extend(
        OfDesign(dims, tuple(along.items()), own, numbers, tuple(own(design)[1]))
        for own in reductions.functions
    )
    return tuple(steps)
