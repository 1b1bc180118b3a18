"""Reductions of a grid (largest, mean, ...) along some of its axes: steps of a plan.

    steps = reduced_of(outer, branch, accuracy, reductions)   # the kinds of all names, then each measure

Which kernel a reduction compiles is decided here, in `_kernel_of`. Where one knows the first kinds, it takes
one axis on the way, and the grid is never stored; the rest is folded in memory. Where all kinds combine, what
is taken of pieces of an axis is merged; of others (std, percentiles, one kind after another) axes are whole.
"""

from collections.abc import Mapping, Sequence
from math import prod
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...compiler.languages.numba.reductions import KINDS, outputs_of
from ...mechanism.own import Definition
from ...runtime.kernels import KernelKey, has_large_angles
from ...runtime.threads import fill_reduced
from ...runtime.tiers import COMPILED, tier_of
from ..axes import Outer
from ..labels import Output, attributes, input_attributes, side_attributes
from ..points import Points, points_of
from ..under_loads.kernel import UnderLoads, each_point, region_of
from ..under_loads.sides import sides_of
from .argument import Chain, Reductions, chain_name, extremes_at_end
from .in_memory import Field, combined, field_of, folded
from .kinds import EXTREMES, kind_called
from .measures import AtPlace, OfDesign

Array = NDArray[Any]
FLOAT = np.dtype(np.float64)


class Reduced(NamedTuple):
    """Kinds of names over the axes that are left.

    names       those of which a kind is taken
    dims        the axes that are left
    reductions  what is taken
    of          the values of `names`; the last of its axes is the one that a kernel reduces
    key         that kernel, if there is one
    """

    names: tuple[str, ...]
    dims: tuple[str, ...]
    reductions: Reductions
    of: Points
    key: KernelKey | None

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
        """The reduced axes whose points are in memory: those that no kernel reduces on the way."""
        return tuple(name for name in self.reductions.axes if self.key is None or name != self.of.dims[-1])

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

    def cut(self, lengths: Mapping[str, int]) -> "Reduced":
        """Prepare the step for blocks of these lengths."""
        return self._replace(of=self.of.cut(lengths))

    def compute(self, values: Mapping[str, Array], threads: int | None = 1) -> dict[str, Array]:
        """The outputs of a block by name, from the values along each of its `axes`."""
        compiled = self.key is not None and tier_of(self.key, self._points(values, self.of.dims)) == COMPILED
        compiled = compiled and not ("theta" in values and has_large_angles(values["theta"]))
        fields, counts = self._chained(self.of, values, compiled, threads)
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
                found[f"{variable}_side"] = self._side(self.of, name, field, values)
            found[f"{name}_skipped"] = skipped[name]
        return found

    def _chained(
        self, of: Points, values: Mapping[str, Array], compiled: bool, threads: int | None
    ) -> tuple[dict[str, Field], dict[str, Array]]:
        """The results of all chains, one stage after the other; and how many points of each name count."""
        found: dict[str, Field] = {}
        counts: dict[str, Array] = {}
        firsts = self._firsts(of, values, compiled, threads)
        for name, chain in self._chains:
            (axes, kind), *rest = chain
            first = firsts[name, kind]
            field = folded(first, [axis for axis in axes if axis in first.dims], kind, values)
            for axes, kind in rest:
                field = folded(field.counted_anew(), axes, kind, values)
            found[chain_name(name, chain)] = field
            left = tuple(number for number, axis in enumerate(first.dims) if axis not in self.dims)
            counts[name] = first.counts.sum(axis=left)
        return found, counts

    def _firsts(
        self, of: Points, values: Mapping[str, Array], compiled: bool, threads: int | None
    ) -> dict[tuple[str, str], Field]:
        """The values by name and kind of the first stage; where a kernel can, reduced along its axis."""
        stage = self.reductions.stages[0]
        kinds = tuple(dict.fromkeys(kind for name in self.names for kind in stage.kinds_of(name)))
        rest, along = of.dims[:-1], of.dims[-1]
        shape, length = tuple(values[name].size for name in rest), values[along].size
        if self.key is not None and compiled and length and all(shape):
            return self._fused(self.key, values, threads)
        fields = {name: field_of(of.dims, array) for name, array in of.compute(values, threads).items()}
        first = () if self.key is None else (along,)
        return {(n, kind): folded(fields[n], first, kind, values) for n in self.names for kind in kinds}

    def _fused(
        self, key: KernelKey, values: Mapping[str, Array], threads: int | None
    ) -> dict[tuple[str, str], Field]:
        """The values by name and kind, reduced along the last axis by the kernel."""
        rest, along = self.of.dims[:-1], self.of.dims[-1]
        shape, axis = tuple(values[name].size for name in rest), values[along]
        outs = {name: np.empty(shape or (1,), kind) for name, kind in outputs_of(self.names, key.reduce)}
        inside = self.of.inside
        if inside is None:
            inputs = {name: np.ascontiguousarray(values[name]) for name, _ in key.axis_of}
            given: dict[str, Any] = {**dict(self.of.numbers), **inputs}
        else:
            given = inside.arguments(values)
        fill_reduced(key, given, axis.size, list(outs.values()), threads)
        arrays = {name: out if shape else out.reshape(()) for name, out in outs.items()}
        places = np.append(axis, np.nan)  # place -1
        found = {}
        for name in self.names:
            for kind in key.reduce:
                own = f"{name}_{kind}"
                at = {along: np.asarray(places[arrays[f"{own}_place"]])} if kind in EXTREMES else {}
                found[name, kind] = Field(rest, arrays[own], arrays[f"{name}_count"], at)
        if inside is not None:
            self._repair(self.of, inside, values, found)
        return found

    def _repair(
        self, of: Points, inside: UnderLoads, values: Mapping[str, Array], found: Mapping[Any, Field]
    ) -> None:
        """Reduce the rows anew in which rounding may decide on the side of a jump."""
        rest, along = of.dims[:-1], of.dims[-1]
        index = inside.open(values)
        some = [name for name in index or () if name in rest]
        if index is not None:
            alone = np.unique(np.stack([index[name] for name in some]), axis=1) if some else ()
            index = dict(zip(some, alone, strict=True))
        some = some or list(rest[:1])  # row by row
        for point in each_point(index, {name: values[name].size for name in some}):
            block = {n: values[n][point[n] : point[n] + 1] if n in point else values[n] for n in of.dims}
            shape, region = tuple(block[name].size for name in of.dims), region_of(point, rest)
            rows = [np.empty(shape) for _ in of.names]
            of.fill_inside(block, rows, 1)
            lines = {name: field_of(of.dims, row) for name, row in zip(of.names, rows, strict=True)}
            for (name, kind), field in found.items():
                new = folded(lines[name], [along], kind, values)
                field.values[region], field.counts[region] = new.values, new.counts
                for axis, places in new.places.items():
                    field.places[axis][region] = places

    def _side(self, of: Points, name: str, field: Field, values: Mapping[str, Array]) -> Array:
        """The sides of jumps on which extremes over theta are; 0 where other inputs were averaged."""
        shape = field.values.shape
        grids = np.meshgrid(*(values[axis] for axis in self.dims), indexing="ij")
        points = dict(zip(self.dims, grids, strict=True)) | dict(field.places)
        flat = {axis: np.ascontiguousarray(column).reshape(-1) for axis, column in points.items()}
        if not set(self.axes) <= set(flat):
            return np.zeros(shape, np.int8)
        return sides_of(name, of, flat).reshape(shape)


def reduced_of(
    outer: Outer, branch: int, accuracy: Any, reductions: Reductions
) -> tuple[Reduced | AtPlace | OfDesign, ...]:
    """The steps of what is taken of a grid, checked: the kinds of all names, then each measure."""
    dims = tuple(name for name in outer.dimensions if name not in reductions.axes)
    names = tuple(name for name in outer.names if reductions.chains(name))
    steps: list[Reduced | AtPlace | OfDesign] = []
    if names:
        of, key = _kernel_of(names, dims, outer, branch, accuracy, reductions)
        steps.append(Reduced(names, dims, reductions, of, key))
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


def _kernel_of(
    names: Sequence[str],
    dims: Sequence[str],
    outer: Outer,
    branch: int,
    accuracy: Any,
    reductions: Reductions,
) -> tuple[Points, KernelKey | None]:
    """The values of names over all axes, and the kernel that reduces one of them on the way."""
    stage, axes = reductions.stages[0], (*dims, *reductions.axes)
    kinds = tuple(dict.fromkeys(kind for name in names for kind in stage.kinds_of(name)))
    along = "theta" if "theta" in stage.axes else max(stage.axes, key=lambda name: outer.axes[name].size)
    last = *(name for name in axes if name != along), along
    of = points_of(names, outer, last, branch, accuracy)
    if (of.loads is not None and of.inside is None) or set(kinds) - set(KINDS):
        return (of if axes == last else points_of(names, outer, axes, branch, accuracy)), None
    key = of.key if of.inside is None else of.inside.key
    alone = len(last) == 1  # a kernel has an axis beside the one that it reduces
    axis_of = tuple((n, last.index(n if n in last else "theta") + alone) for n, _ in key.axis_of)
    return of, key._replace(axis_of=axis_of, axes=len(last) + alone, reduce=kinds)
