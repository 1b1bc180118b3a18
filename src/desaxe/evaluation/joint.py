"""Reductions over several axes, of single names, and of kinds that no kernel takes on the way."""

from collections.abc import Mapping, Sequence
from functools import partial
from math import prod
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiler.languages.numba.reductions import EXTREMES, KINDS
from ..mechanism.catalogue import quantity
from ..mechanism.own import Definition
from ..runtime.compiled_only import compiled_only
from .chunks import blocks_of, chunk_lengths, slices_of
from .fold import Field, field_of, folded
from .labels import attributes, input_attributes, labelled, provenance, side_attributes, with_loads
from .outer import Outer
from .reduce import reduced
from .reductions import Chain, Reduction, Reductions, chain_name, extremes_at_end, method_of
from .sides import sides_of
from .sources import Loaded, Plain, Source, source_of

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[Any]
POINTS = 2**22  # of a grid that are in memory at once, where what is left of it allows that


class JointPart(NamedTuple):
    """The reductions of a grid, block by block of the axes that are left.

    names       those of which a kind is taken
    dims        the axes that are left
    reductions  what is taken
    numbers     the inputs that are numbers
    source      of the values of `names`
    at          for each `At` the source of its name
    slopes      the parameters by which functions of a design give derivatives
    """

    names: tuple[str, ...]
    dims: tuple[str, ...]
    reductions: Reductions
    numbers: tuple[tuple[str, float], ...]
    source: Source | None
    at: tuple[Source, ...]
    slopes: tuple[tuple[str, ...], ...]

    @property
    def axes(self) -> tuple[str, ...]:
        """The dimensions whose values the part needs."""
        return (*self.dims, *self.reductions.axes)

    @property
    def reduction(self) -> Reduction | None:
        """The reductions as kinds along one axis, if they are no more than that."""
        return self.reductions.alone

    @property
    def own(self) -> tuple[Definition, ...]:
        """The definitions that it needs."""
        return () if self.source is None else self.source.wanted.form.own

    @property
    def outputs(self) -> dict[str, np.dtype[Any]]:
        """The outputs by name, and their types."""
        found: dict[str, type] = {}
        for name in self.names:
            for chain in self.reductions.chains(name):
                own = chain_name(name, chain)
                found |= dict.fromkeys(
                    (own, *(f"{own}_{axis}" for axis in extremes_at_end(chain))), np.float64
                )
                found |= {f"{own}_side": np.int8} if self._has_side(chain) else {}
            found[f"{name}_skipped"] = np.int64
        found |= {one.variable: np.float64 for one in self.reductions.at}
        for function, slopes in zip(self.reductions.functions, self.slopes, strict=True):
            found |= dict.fromkeys((function.name, *(f"{function.name}_wrt_{p}" for p in slopes)), np.float64)
        return {name: np.dtype(kind) for name, kind in found.items()}

    def _has_side(self, chain: Chain) -> bool:
        """True if the result of a chain is a sample over theta under loads that may jump."""
        return isinstance(self.source, Loaded) and "theta" in extremes_at_end(chain)

    def compute(self, values: Mapping[str, Array], threads: int | None = 1) -> dict[str, Array]:
        """The outputs of a block by name, from the values along each of its `axes`."""
        with compiled_only():
            found = self._taken(values, threads)
        return found | self._sides(found, values)

    def taken(self, values: Mapping[str, Array], threads: int | None) -> dict[str, Array]:
        """The outputs of a block; other than in `compute`, few points may be computed in plain Python."""
        found = self._taken(values, threads)
        return found | self._sides(found, values)

    def _sides(self, found: Mapping[str, Array], values: Mapping[str, Array]) -> dict[str, Array]:
        """The sides of jumps on which extremes over theta are; 0 where other inputs were averaged."""
        sides = {}
        for name in self.names:
            for chain in self.reductions.chains(name):
                if not self._has_side(chain):
                    continue
                assert isinstance(self.source, Loaded)
                own = chain_name(name, chain)
                shape = found[own].shape
                grids = np.meshgrid(*(values[axis] for axis in self.dims), indexing="ij")
                points = dict(zip(self.dims, grids, strict=True))
                points |= {axis: found[f"{own}_{axis}"] for axis in extremes_at_end(chain)}
                flat = {axis: np.ascontiguousarray(column).reshape(-1) for axis, column in points.items()}
                known = set(self.axes) <= set(flat)
                side = sides_of(name, self.source, flat) if known else np.zeros(shape, np.int8)
                sides[f"{own}_side"] = side.reshape(shape)
        return sides

    def _taken(self, values: Mapping[str, Array], threads: int | None) -> dict[str, Array]:
        found: dict[str, Array] = {}
        if self.source is not None:
            found |= self._kinds(self.source, values, threads)
        for one, source in zip(self.reductions.at, self.at, strict=True):
            columns = {name: values[name] for name in self.dims}
            columns[self.reductions.axes[0]] = np.array([one.place])
            array = source.values(columns, (*self.dims, self.reductions.axes[0]), threads)[one.name]
            found[one.variable] = array[..., 0]
        for function, slopes in zip(self.reductions.functions, self.slopes, strict=True):
            grids = np.meshgrid(*(values[name] for name in self.dims), indexing="ij")
            shape = tuple(values[name].size for name in self.dims)
            value, gradient = function({**dict(self.numbers), **dict(zip(self.dims, grids, strict=True))})
            found[function.name] = np.array(np.broadcast_to(value, shape))
            for p in slopes:
                found[f"{function.name}_wrt_{p}"] = np.array(np.broadcast_to(gradient.get(p, 0.0), shape))
        return found

    def _kinds(self, source: Source, values: Mapping[str, Array], threads: int | None) -> dict[str, Array]:
        found: dict[str, Array] = {}
        firsts = _first(source, self, values, threads)
        total = np.prod([values[axis].size for axis in self.reductions.axes], dtype=np.int64)
        for name in self.names:
            for chain in self.reductions.chains(name):
                (axes, kind), *rest = chain
                first = firsts[name, kind]
                field = folded(first, [axis for axis in axes if axis in first.dims], kind, values)
                for axes, kind in rest:
                    field = folded(field.counted_anew(), axes, kind, values)
                own = chain_name(name, chain)
                found[own] = field.values
                found |= {f"{own}_{axis}": field.places[axis] for axis in extremes_at_end(chain)}
            left = tuple(number for number, axis in enumerate(first.dims) if axis not in self.dims)
            found[f"{name}_skipped"] = total - first.counts.sum(axis=left)
        return found


def _first(
    source: Source, part: JointPart, values: Mapping[str, Array], threads: int | None
) -> dict[tuple[str, str], Field]:
    """The values by name and kind of the first step; where a kernel can, reduced along one axis already."""
    step = part.reductions.steps[0]
    kinds = tuple(dict.fromkeys(kind for name in part.names for kind in step.kinds_of(name)))
    columns = {name: values[name] for name in part.axes}
    dims = part.axes
    if set(kinds) - set(KINDS) or not isinstance(source, Plain):
        whole = source.values(columns, dims, threads)
        return {(n, kind): field_of(dims, whole[n]) for n in part.names for kind in kinds}
    along = "theta" if "theta" in step.axes else max(step.axes, key=lambda name: values[name].size)
    rest = [name for name in dims if name != along]
    fill = partial(source.values, columns, (*rest, along), threads)
    arrays = reduced(
        source.wanted, source.axes(columns), [*rest, along], Reduction(along, kinds), threads, fill
    )
    found = {}
    for name in part.names:
        counts = values[along].size - arrays[f"{name}_skipped"][1]
        for kind in kinds:
            at = {along: arrays[f"{name}_{kind}_{along}"][1]} if kind in EXTREMES else {}
            found[name, kind] = Field(tuple(rest), arrays[f"{name}_{kind}"][1], counts, at)
    return found


def joint_part(outer: Outer, branch: int, accuracy: Any, reductions: Reductions) -> JointPart:
    """The part of a grid and what is taken of it, checked."""
    dims = tuple(name for name in outer.dimensions if name not in reductions.axes)
    names = tuple(name for name in outer.names if reductions.chains(name))
    numbers = tuple((name, float(array)) for name, array in outer.axes.items() if not array.ndim)

    def source(names: Sequence[str]) -> Source:
        return source_of(names, outer.given, outer.axes, outer.loads, branch, accuracy)

    at = tuple(source((one.name,)) for one in reductions.at)
    first = {**dict(numbers), **{n: outer.axes[n][:1] for n in dims}}
    slopes = tuple(tuple(function(first)[1]) for function in reductions.functions)
    return JointPart(names, dims, reductions, numbers, source(names) if names else None, at, slopes)


def joint_grid(part: JointPart, outer: Outer, branch: int, threads: int | None) -> "xr.Dataset":
    """A reduced grid, labelled; computed in blocks of the axes that are left."""
    sizes = {name: outer.axes[name].size for name in part.dims}
    behind = prod(outer.axes[name].size for name in part.reductions.axes)
    lengths = chunk_lengths("auto", sizes, max(1, POINTS // max(behind, 1)))
    chunk = {name: max(own, default=1) for name, own in lengths.items()}
    arrays = {name: np.empty(tuple(sizes.values()), kind) for name, kind in part.outputs.items()}
    for place in blocks_of(sizes, chunk):
        regions = slices_of(place, sizes, chunk)
        values = {name: outer.axes[name][regions.get(name, slice(None))] for name in part.axes}
        for name, array in part.taken(values, threads).items():
            arrays[name][tuple(regions.values())] = array
    return labelled_joint(part, outer, {name: (part.dims, array) for name, array in arrays.items()}, branch)


def labelled_joint(
    part: JointPart, outer: Outer, arrays: Mapping[str, tuple[Sequence[str], Any]], branch: int
) -> "xr.Dataset":
    """The outputs of a part as a Dataset."""
    state = outer.given.get("omega") is not None
    kept = {name: array for name, array in outer.coordinates.items() if name not in part.reductions.axes}
    told = joint_attributes(part, state)
    dataset = labelled({}, kept, branch, state)
    accuracy = "standard" if part.source is None else part.source.accuracy
    dataset.attrs |= provenance(arrays, kept, branch, accuracy, of=outer.names)
    dataset = dataset.assign({name: (*found, told[name]) for name, found in arrays.items()})
    return with_loads(dataset, outer.loads)


def joint_attributes(part: JointPart, state: bool) -> dict[str, dict[str, Any]]:
    """CF attributes of the outputs of a part."""
    found: dict[str, dict[str, Any]] = {}
    for name in part.names:
        own = attributes(name, state)
        for chain in part.reductions.chains(name):
            told = " ".join(": ".join((*axes, method_of(kind))) for axes, kind in chain)
            variable = chain_name(name, chain)
            found[variable] = {**own, "cell_methods": told}
            for axis in extremes_at_end(chain):
                about = input_attributes(axis)
                words = f"{about['long_name']} of the {variable.removeprefix(f'{name}_')} of {name}"
                found[f"{variable}_{axis}"] = {"units": about["units"], "long_name": words}
            found[f"{variable}_side"] = side_attributes()
        along = ", ".join(part.reductions.axes)
        found[f"{name}_skipped"] = {
            "units": "1",
            "long_name": f"points along {along} without a {name} (infeasible, stalled, bad)",
        }
    for one in part.reductions.at:
        axis = part.reductions.axes[0]
        words = f"{quantity(one.name, state).meaning} at {axis} = {one.text}"
        found[one.variable] = {**attributes(one.name, state), "long_name": words}
    for function in part.reductions.functions:
        found[function.name] = {"long_name": f"{function.name} of the design"}
    return {name: found.get(name, {"long_name": name}) for name in part.outputs}
