"""Reductions of a grid (largest, mean, ...) along some of its axes: steps of a plan.

    steps = reduced_of(outer, branch, accuracy, reductions)   # the kinds of all names, then each measure

Extremes, means and roots of mean squares are taken along one axis block by block, and the grid is never
stored; the rest is folded in memory. Where all kinds combine, what is taken of pieces of an axis is merged;
of others (std, percentiles, one kind after another) axes are whole.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...mechanism.own import Definition
from ...runtime.threads import run_parts
from ..axes import Outer
from ..chunks import blocks_of, chunk_lengths, longest, slices_of
from ..labels import Output, attributes, input_attributes, side_attributes
from ..points import Points, points_of
from ..step import Step
from ..under_loads.sides import sides_of
from .argument import Chain, Reductions, chain_name, extremes_at_end
from .in_memory import Field, combined, field_of, folded
from .kinds import KINDS, kind_called
from .measures import AtPlace, OfDesign

Array = NDArray[Any]
FLOAT = np.dtype(np.float64)
BLOCK = 2**16  # points whose values stay in the second-level cache
BLOCKS = 64  # of a part: an interrupt is heard after it


@dataclass(frozen=True)
class Reduced(Step):
    """Kinds of names over the axes that are left.

    names       those of which a kind is taken
    reductions  what is taken
    of          the values of `names`
    along       the last of its axes, if it is reduced first, block by block
    """

    names: tuple[str, ...]
    reductions: Reductions
    of: Points
    along: str | None

    @property
    def axes(self) -> tuple[str, ...]:
        """The dimensions whose values the step needs."""
        return (*self.dims, *self.reductions.axes)

    @property
    def own(self) -> tuple[Definition, ...]:
        """The definitions that it needs."""
        return self.of.own

    @property
    def identity(self) -> str:
        """A text that tells the step from all others, by what its loads are too."""
        return f"{self!r} {self.of.identity}"

    @property
    def _chains(self) -> list[tuple[str, Chain]]:
        """Each name with the kinds that are taken of it, one after the other."""
        return [(name, chain) for name in self.names for chain in self.reductions.chains(name)]

    def held(self) -> tuple[str, ...]:
        """The reduced axes whose points are in memory behind each number of the outputs."""
        return *(name for name in self.reductions.axes if name != self.along), *filter(None, [self.along])

    def combines(self) -> bool:
        """True if all that is taken follows from what is taken of pieces."""
        return all(len(chain) == 1 and kind_called(chain[0][1]).combines for _, chain in self._chains)

    @property
    def outputs(self) -> dict[str, Output]:
        """The outputs by name: their types and CF attributes."""
        found: dict[str, Output] = {}
        along = ", ".join(self.reductions.axes)
        for name in self.names:
            for chain in self.reductions.chains(name):
                found |= self._outputs(name, chain)
            words = f"points along {along} without a {name} (infeasible, stalled, bad)"
            found[f"{name}_skipped"] = Output(np.dtype(np.int64), {"units": "1", "long_name": words})
        return found

    def _outputs(self, name: str, chain: Chain) -> dict[str, Output]:
        """The result of a chain, where it is, and on which side of a jump."""
        variable = chain_name(name, chain)
        method = " ".join(": ".join((*axes, kind_called(kind).method)) for axes, kind in chain)
        about = attributes(name, self.of.wanted.form.state)
        found = {variable: Output(FLOAT, {**about, "quantity": name, "cell_methods": method})}
        for axis in extremes_at_end(chain):
            place = input_attributes(axis)
            words = f"{place['long_name']} of the {variable.removeprefix(f'{name}_')} of {name}"
            found[f"{variable}_{axis}"] = Output(FLOAT, {**place, "long_name": words, "quantity": axis})
        if self._has_side(chain):
            found[f"{variable}_side"] = Output(np.dtype(np.int8), side_attributes())
        return found

    def _has_side(self, chain: Chain) -> bool:
        """True if the result of a chain is a sample over theta under loads that may jump."""
        return self.of.loads is not None and "theta" in extremes_at_end(chain)

    def compute(self, values: Mapping[str, Array], threads: int | None = 1) -> dict[str, Array]:
        """The outputs of a block by name, from the values along each of its `axes`."""
        fields, counts = self._chained(values, threads)
        total = self._points(values, self.reductions.axes)
        return self._named(fields, {name: total - count for name, count in counts.items()}, values)

    def combine(
        self, parts: Sequence[Mapping[str, Array]], found: Sequence[dict[str, Array]]
    ) -> dict[str, Array]:
        """The outputs of a block from those of its pieces, in their order: sums go piece by piece."""
        totals = [self._points(part, self.reductions.axes) for part in parts]
        fields: dict[str, Field] = {}
        for name, chain in self._chains:
            variable, skipped, axes = chain_name(name, chain), f"{name}_skipped", extremes_at_end(chain)
            own = [
                Field(
                    self.dims, one[variable], total - one[skipped], {n: one[f"{variable}_{n}"] for n in axes}
                )
                for total, one in zip(totals, found, strict=True)
            ]
            fields[variable] = combined(own, chain[-1][1])
        skipped_of = {name: np.sum([one[f"{name}_skipped"] for one in found], axis=0) for name in self.names}
        return self._named(fields, skipped_of, parts[0])

    @staticmethod
    def _points(values: Mapping[str, Array], axes: Sequence[str]) -> int:
        return prod(values[axis].size for axis in axes)

    def _named(
        self, fields: Mapping[str, Field], skipped: Mapping[str, Array], values: Mapping[str, Array]
    ) -> dict[str, Array]:
        """The outputs by name, with the places of extremes and their sides of jumps."""
        found: dict[str, Array] = {}
        for name, chain in self._chains:
            variable = chain_name(name, chain)
            field = fields[variable]
            found[variable] = field.values
            found |= {f"{variable}_{axis}": field.places[axis] for axis in extremes_at_end(chain)}
            if self._has_side(chain):
                found[f"{variable}_side"] = self._side(name, field, values)
            found[f"{name}_skipped"] = skipped[name]
        return found

    def _chained(
        self, values: Mapping[str, Array], threads: int | None
    ) -> tuple[dict[str, Field], dict[str, Array]]:
        """The results of all chains, one stage after the other; and how many points of each name count."""
        found: dict[str, Field] = {}
        counts: dict[str, Array] = {}
        firsts = self._firsts(values, threads)
        for name, chain in self._chains:
            (axes, kind), *rest = chain
            first = firsts[name, kind]
            field = folded(first, [axis for axis in axes if axis in first.dims], kind, values)
            for axes, kind in rest:
                field = folded(field_of(field.dims, field.values, field.places), axes, kind, values)
            found[chain_name(name, chain)] = field
            counts[name] = first.points([axis for axis in first.dims if axis not in self.dims])
        return found, counts

    def _firsts(self, values: Mapping[str, Array], threads: int | None) -> dict[tuple[str, str], Field]:
        """The values by name and kind of the first stage, reduced along one axis if that goes by blocks."""
        stage, dims, along = self.reductions.stages[0], self.of.dims, self.along
        kinds = [(name, kind) for name in self.names for kind in stage.kinds_of(name)]
        if along is None:
            fields = {name: field_of(dims, array) for name, array in self.of.compute(values, threads).items()}
            return {(name, kind): fields[name] for name, kind in kinds}
        rest, length = dims[:-1], values[along].size
        sizes = {name: values[name].size for name in rest}
        lengths = longest(chunk_lengths("auto", sizes, max(1, BLOCK // max(1, length))))
        regions = [slices_of(index, sizes, lengths) for index in blocks_of(sizes, lengths)]
        found = {key: _empty(rest, sizes, along) for key in kinds}

        def part(start: int, stop: int) -> None:
            for region in regions[start:stop]:
                block = {**values, **{name: values[name][one] for name, one in region.items()}}
                fields = {name: field_of(dims, array) for name, array in self.of.compute(block, 1).items()}
                for name, kind in kinds:
                    one = folded(fields[name], [along], kind, values)
                    found[name, kind].fill(tuple(region.values()), one)

        run_parts(part, len(regions), threads, 2, BLOCKS)
        return found

    def _side(self, name: str, field: Field, values: Mapping[str, Array]) -> Array:
        """The sides of jumps on which extremes over theta are; 0 where other inputs were averaged."""
        shape = field.values.shape
        grids = np.meshgrid(*(values[axis] for axis in self.dims), indexing="ij")
        points = dict(zip(self.dims, grids, strict=True)) | dict(field.places)
        flat = {axis: np.ascontiguousarray(column).reshape(-1) for axis, column in points.items()}
        if not set(self.axes) <= set(flat):
            return np.zeros(shape, np.int8)
        return sides_of(name, self.of, flat).reshape(shape)


def reduced_of(outer: Outer, branch: int, accuracy: Any, reductions: Reductions) -> tuple[Step, ...]:
    """The steps of what is taken of a grid, checked: the kinds of all names, then each measure."""
    dims = tuple(name for name in outer.dimensions if name not in reductions.axes)
    names = tuple(name for name in outer.names if reductions.chains(name))
    steps: list[Step] = []
    if names:
        of, along = _values_of(names, dims, outer, branch, accuracy, reductions)
        steps.append(Reduced(dims, names, reductions, of, along))
    for one in reductions.at:
        axis = reductions.axes[0]
        there = outer._replace(axes={**outer.axes, axis: np.array([one.place])})
        steps.append(AtPlace(dims, axis, one, points_of((one.name,), there, (*dims, axis), branch, accuracy)))
    numbers = tuple((name, float(array)) for name, array in outer.axes.items() if not array.ndim)
    first = {**dict(numbers), **{n: outer.axes[n][:1] for n in dims}}
    steps += [
        OfDesign(dims, function, numbers, tuple(function(first)[1])) for function in reductions.functions
    ]
    return tuple(steps)


def _values_of(
    names: Sequence[str],
    dims: Sequence[str],
    outer: Outer,
    branch: int,
    accuracy: Any,
    reductions: Reductions,
) -> tuple[Points, str | None]:
    """The values of names over all axes, and the last of these if it is reduced first, block by block."""
    stage, axes = reductions.stages[0], (*dims, *reductions.axes)
    if {kind for name in names for kind in stage.kinds_of(name)} - set(KINDS):
        return points_of(names, outer, axes, branch, accuracy), None
    along = "theta" if "theta" in stage.axes else max(stage.axes, key=lambda name: outer.axes[name].size)
    last = *(name for name in axes if name != along), along
    return points_of(names, outer, last, branch, accuracy), along


def _empty(dims: tuple[str, ...], sizes: Mapping[str, int], along: str) -> Field:
    """A field to be filled, of values that are reduced along an axis."""
    values, places = (np.empty([*sizes.values()]) for _ in range(2))
    return Field(dims, values, np.empty(values.shape, np.int64), {along: places})
