"""The plan of a grid: steps, each of which computes some of its variables in any block of it.

    plan = plan_of(outer, branch, accuracy, reduce)
    plan.dataset(plan.values(threads))               # `grid`: one block
    for block in plan.blocks(lengths):  # chunks of Dask, of a store, of a search
        for part in block.parts:
            part.step.compute(block.values, threads)

A step is `Points` (values by one kernel, loads included), `Reduced` (what is taken of axes), `AtPlace` or
`OfDesign`; a sweep adds peaks. It tells its outputs, their types and attributes, and what it needs. A step
has no arrays and travels.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from math import prod
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..mechanism.names import LENGTHS
from ..support.extras import needed
from .axes import Outer
from .chunks import Slices, blocks_of, slices_of
from .labels import Output, labelled, with_loads
from .points import Points, Step, points_of
from .reductions.argument import Reductions
from .reductions.reduced import reduced_of

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[Any]


class Part(NamedTuple):
    """A step in a block: its place among the blocks that it has, and the region of its outputs."""

    step: Step
    place: tuple[int, ...]
    region: tuple[slice, ...]


class Block(NamedTuple):
    """A block of a plan: its slice of each dimension, the parts computed in it, the values that they need."""

    regions: Slices
    parts: tuple[Part, ...]
    values: dict[str, Array]


class Plan(NamedTuple):
    """The plan of a grid.

    outer       its checked arguments
    branch      the assembly
    accuracy    as it was asked for
    steps       those of its own variables
    dims        the dimensions of the result
    reductions  what is taken of the others
    beside      steps whose variables come beside the grid: peaks, the margin of a reduced one
    """

    outer: Outer
    branch: int
    accuracy: Any
    steps: tuple[Step, ...]
    dims: tuple[str, ...]
    reductions: Reductions | None = None
    beside: tuple[Step, ...] = ()

    @property
    def all(self) -> tuple[Step, ...]:
        """All steps."""
        return (*self.steps, *self.beside)

    @property
    def variables(self) -> Iterator[tuple[str, list[int], Output]]:
        """The name, shape and type of each variable."""
        for step in self.all:
            for name, output in step.outputs.items():
                yield name, [self.outer.axes[n].size for n in step.dims], output

    @property
    def sizes(self) -> dict[str, int]:
        """The length of each dimension of the result."""
        return {name: self.outer.axes[name].size for name in self.dims}

    @property
    def points(self) -> int:
        """Points of the grid, those behind a reduced one included."""
        return prod(self.outer.axes[name].size for name in self.outer.dimensions)

    def points_in(self, block: Block) -> int:
        """Points of the grid in a block, those behind a reduced one included."""
        lengths: list[int] = [region.stop - region.start for region in block.regions.values()]
        return self.points // max(1, prod(self.sizes.values())) * prod(lengths)

    @property
    def behind(self) -> int:
        """Points of the reduced axes behind each point of the result."""
        axes = () if self.reductions is None else self.reductions.axes
        return prod(self.outer.axes[name].size for name in axes)

    @property
    def bytes(self) -> int:
        """Bytes of all variables."""
        return sum(output.dtype.itemsize * prod(shape) for _, shape, output in self.variables)

    def blocks(self, lengths: Mapping[str, int]) -> Iterator[Block]:
        """All blocks in order; a step of fewer dimensions is a part of the first block that has its place."""
        sizes, axes = self.sizes, self.outer.axes
        for place in blocks_of(sizes, lengths):
            regions = slices_of(place, sizes, lengths)
            places = dict(zip(sizes, place, strict=True))
            parts = tuple(
                Part(s, tuple(places[n] for n in s.dims), tuple(regions[n] for n in s.dims))
                for s in self.all
                if not any(number for name, number in places.items() if name not in s.dims)
            )
            needed = dict.fromkeys(name for part in parts for name in part.step.axes)
            yield Block(regions, parts, {n: axes[n][regions[n]] if n in regions else axes[n] for n in needed})

    def values(self, threads: int | None) -> dict[str, Array]:
        """All variables by name."""
        return {n: a for step in self.all for n, a in step.compute(self.outer.axes, threads).items()}

    def values_by_blocks(
        self, threads: int | None, lengths: Mapping[str, int], before: Callable[[], None]
    ) -> dict[str, Array]:
        """All variables by name, from blocks of these lengths; `before` is called before each."""
        result = {name: np.empty(shape, output.dtype) for name, shape, output in self.variables}
        for block in self.blocks(lengths):
            before()
            for part in block.parts:
                for name, array in part.step.compute(block.values, threads).items():
                    result[name][part.region] = array
        return result

    def empty(self) -> "xr.Dataset":
        """The labelled Dataset with lazy variables, of which none is computed."""
        with needed("a sweep", "scale"):
            import dask.array as da

        lazy = {
            name: da.empty(shape, dtype=output.dtype, chunks=-1) for name, shape, output in self.variables
        }
        return self.dataset(lazy)

    def dataset(self, arrays: Mapping[str, Array]) -> "xr.Dataset":
        """The variables as a labelled Dataset."""
        outer, reduced = self.outer, self.reductions is not None
        kept = {n: array for n, array in outer.axes.items() if not array.ndim or n in self.dims}
        own, beside = (
            {n: (s.dims, arrays[n], told.attributes) for s in some for n, told in s.outputs.items()}
            for some in (self.steps, self.beside)
        )
        shown = own if reduced else {name: own[name] for name in outer.shown if name in own}
        result = labelled(shown, kept, self.branch, self.accuracy, outer.names if reduced else ())
        result = with_loads(result, outer.loads if self.steps else {})
        return result.assign(beside) if beside else result


def plan_of(outer: Outer, branch: int, accuracy: Any, reductions: Reductions | None = None) -> Plan:
    """The plan of a grid, or of what is taken of it; it chooses all kernels, and runs nothing."""
    if reductions is not None:
        dims = tuple(name for name in outer.dimensions if name not in reductions.axes)
        steps = reduced_of(outer, branch, accuracy, reductions)
        return Plan(outer, branch, accuracy, steps, dims, reductions)
    groups = outer.groups()
    steps = tuple(points_of(names, outer, along, branch, accuracy) for names, along in groups)
    return Plan(outer, branch, accuracy, steps, tuple(outer.dimensions))


def margin_of(outer: Outer, branch: int, accuracy: Any, dims: Sequence[str]) -> tuple[Points, ...]:
    """The step of the margin, if all lengths are given and none of them is reduced."""
    if not all(name in outer.axes and (name in dims or name not in outer.dimensions) for name in LENGTHS):
        return ()
    return (points_of(["margin"], outer, outer.lengths, branch, accuracy),)
