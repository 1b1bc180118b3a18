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

import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from math import prod
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..mechanism.names import LENGTHS
from ..support.extras import needed
from .chunks import Slices, blocks_of, chunk_lengths
from .labels import Output, labelled, with_loads
from .points import Outer, Points, Step, points_of
from .reductions.argument import Reductions
from .reductions.reduced import reduced_of

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[Any]
AUTO = 2**21  # points of a chunk: 16 MiB of doubles


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
                yield name, [self.outer.sizes[n] for n in step.dims], output

    @property
    def sizes(self) -> dict[str, int]:
        """The length of each dimension of the result."""
        return {name: self.outer.sizes[name] for name in self.dims}

    @property
    def points(self) -> int:
        """Points of the grid, those behind a reduced one included."""
        return prod(self.outer.sizes.values())

    def points_in(self, block: Block) -> int:
        """Points of the grid in a block, those behind a reduced one included."""
        lengths: list[int] = [region.stop - region.start for region in block.regions.values()]
        return self.points // max(1, prod(self.sizes.values())) * prod(lengths)

    @property
    def behind(self) -> int:
        """Points of the reduced axes behind each point of the result."""
        axes = () if self.reductions is None else self.reductions.axes
        return prod(self.outer.sizes[name] for name in axes)

    @property
    def bytes(self) -> int:
        """Bytes of all variables."""
        return sum(output.dtype.itemsize * prod(shape) for _, shape, output in self.variables)

    def blocks(self, lengths: Mapping[str, int]) -> Iterator[Block]:
        """All blocks in order; a step of fewer dimensions is a part of the first block that has its place."""
        sizes, columns = self.sizes, self.outer.columns
        for places, regions in blocks_of(sizes, lengths):
            parts = tuple(
                Part(s, tuple(places[n] for n in s.dims), tuple(regions[n] for n in s.dims))
                for s in self.all
                if not any(number for name, number in places.items() if name not in s.dims)
            )
            needed = {n: dim for part in parts for n, dim in part.step.columns.items()}
            whole = slice(None)
            yield Block(regions, parts, {n: columns[n][regions.get(d, whole)] for n, d in needed.items()})

    def values(self, threads: int | None) -> dict[str, Array]:
        """All variables by name."""
        columns = self.outer.columns
        return {n: a for step in self.all for n, a in step.compute(columns, threads).items()}

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
        own, beside = (
            {n: (s.dims, arrays[n], message.attributes) for s in some for n, message in s.outputs.items()}
            for some in (self.steps, self.beside)
        )
        shown = own if reduced else {name: own[name] for name in outer.shown if name in own}
        inputs = {n: a for n, a in outer.axes.items() if not a.ndim or outer.along[n] in self.dims}
        labels = {n: label for n, label in outer.labels.items() if {*label.dims} <= {*self.dims}}
        result = labelled(
            shown, inputs, self.branch, self.accuracy, outer.names if reduced else (), outer.along
        )
        result = with_loads(
            result.assign_coords(labels) if labels else result, outer.loads if self.steps else {}
        )
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
    along = outer.of(LENGTHS)
    if not ({*LENGTHS} <= {*outer.axes} and {*along} <= {*dims}):
        return ()
    return (points_of(["margin"], outer, along, branch, accuracy),)


# ---- lazy arrays ------------------------------------------------------------------------------------


def lazy_values(plan: Plan, chunks: Any, threads: int | None) -> dict[str, Any]:
    """The variables of a plan as Dask arrays; `chunks` as in xarray.

    Names follow from the kernels and the values of the axes, so the same request has the same names in
    every process.
    """
    with needed("chunks="):
        import dask.array as da
        from dask.base import tokenize

    lengths = chunk_lengths(chunks, plan.sizes, max(1, AUTO // max(plan.behind, 1)))
    values, result = plan.outer.columns, dict[str, Any]()
    for step in plan.all:
        token = tokenize(step.identity, *(values[name] for name in step.columns), lengths)
        columns, axes = [], [*dict.fromkeys((*step.dims, *step.columns.values()))]
        for name, dim in step.columns.items():
            own = lengths.get(dim, (values[name].size,))  # a reduced axis is whole
            column = da.from_array(values[name], chunks=(own,), name=f"{name}-{token}", inline_array=True)
            columns += [column, (axes.index(dim),)]
        along = tuple(range(len(step.dims)))
        empty = np.empty((0,) * len(along), object)
        with warnings.catch_warnings():
            # An outer product has more chunks than each of its arguments, of which Dask would warn.
            warnings.simplefilter("ignore", da.PerformanceWarning)
            blocks = da.blockwise(
                ChunkTask(step, threads or 1), along, *columns, dtype=object, concatenate=True,
                name=f"desaxe-{token}", meta=empty,
            )  # fmt: skip
        for name, output in step.outputs.items():
            result[name] = da.blockwise(
                _output, along, blocks, along, name, None, dtype=output.dtype, name=f"{name}-{token}",
                meta=empty.astype(output.dtype),
            )  # fmt: skip
    return result


class ChunkTask(NamedTuple):
    """A step in a chunk, from the values of its columns; it pickles."""

    step: Step
    threads: int

    def __call__(self, *values: Array) -> dict[str, Array]:
        """The outputs by name."""
        return self.step.compute(dict(zip(self.step.columns, values, strict=True)), self.threads)


def _output(block: Any, name: str) -> Array:
    """One output of a computed block."""
    array: Array = block[name]
    return array
