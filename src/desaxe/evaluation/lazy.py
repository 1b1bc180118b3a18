"""`grid(..., chunks=)`: a grid of lazy Dask arrays, one task a chunk and kernel."""

from collections.abc import Mapping, Sequence
from math import prod
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from ..support.extras import needed
from .blocks import LoadedPart, Part, grid_parts, margin_parts, reduced_parts
from .chunks import chunk_lengths
from .dask_blocks import outputs_of_blocks
from .joint import JointPart, joint_part, labelled_joint
from .labels import input_attributes, labelled, provenance, with_loads
from .outer import Outer
from .reduce import reduced_attributes
from .reductions import Reductions, reductions_of
from .sources import Loaded

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[Any]
AnyPart = Part | LoadedPart | JointPart
AUTO = 2**21  # points of a chunk: 16 MiB of doubles


def lazy_grid(
    outer: Outer, chunks: Any, branch: int, accuracy: Any, threads: int | None, reduce: Any = None
) -> "xr.Dataset":
    """The grid of checked arguments as lazy arrays, computed chunk by chunk."""
    sizes = {name: outer.axes[name].size for name in outer.dimensions}
    state = outer.given.get("omega") is not None
    if reduce is None:
        lengths = chunk_lengths(chunks, sizes, AUTO)
        parts = grid_parts(outer, branch, accuracy, _longest(lengths))
        arrays = lazy_arrays(parts, outer.axes, lengths, threads or 1)
        named = {n: arrays[n] for n in outer.shown}
        return with_loads(labelled(named, outer.coordinates, branch, state, accuracy), outer.loads)
    reductions = reductions_of(reduce, outer.dimensions, outer.names)
    length = prod(sizes.pop(axis) for axis in reductions.axes)
    lengths = chunk_lengths(chunks, sizes, max(1, AUTO // max(length, 1)))
    reduction = None if outer.loads else reductions.alone
    if reduction is None:
        joint = joint_part(outer, branch, accuracy, reductions)
        return labelled_joint(joint, outer, lazy_arrays([joint], outer.axes, lengths, threads or 1), branch)
    part = reduced_parts(outer, branch, accuracy, reduction, _longest(lengths))[0]
    arrays = lazy_arrays([part], outer.axes, lengths, threads or 1)
    kept = {name: array for name, array in outer.coordinates.items() if name != reduction.axis}
    told = reduced_attributes(outer.names, reduction, input_attributes(reduction.axis), state)
    dataset = labelled({}, kept, branch, state)
    dataset.attrs |= provenance(arrays, kept, branch, part.key.accuracy, of=outer.names)
    return dataset.assign({name: (*found, told[name]) for name, found in arrays.items()})


def parts_of_reduced(
    outer: Outer, branch: int, accuracy: Any, reductions: Reductions, block: Mapping[str, int]
) -> tuple[AnyPart, ...]:
    """The part of a reduced grid, and that of its margin where all lengths are given."""
    alone = None if outer.loads else reductions.alone
    if alone is not None:
        return reduced_parts(outer, branch, accuracy, alone, block)
    margin = margin_parts(outer, branch, accuracy, block, reductions.axes)
    return joint_part(outer, branch, accuracy, reductions), *margin


def _longest(lengths: Mapping[str, Sequence[int]]) -> dict[str, int]:
    return {name: max(own, default=1) for name, own in lengths.items()}


def lazy_arrays(
    parts: Sequence[AnyPart],
    axes: Mapping[str, Array],
    lengths: Mapping[str, tuple[int, ...]],
    threads: int,
) -> dict[str, tuple[tuple[str, ...], Any]]:
    """The outputs of parts by name, each with its dimensions and as a Dask array.

    A chunk of a part is one task, whose outputs further tasks take apart. Names follow from the kernels
    and the values of the axes, so the same request has the same names in every process.
    """
    with needed("chunks="):
        import dask.array as da
        from dask.base import tokenize

    found: dict[str, tuple[tuple[str, ...], Any]] = {}
    for part in parts:
        token = tokenize(_Block(part, threads), *(axes[name] for name in part.axes), dict(lengths))
        columns = []
        for number, name in enumerate(part.axes):
            own = lengths.get(name, (axes[name].size,))  # a reduced axis is whole
            column = da.from_array(axes[name], chunks=(own,), name=f"{name}-{token}", inline_array=True)
            columns.append((column, (number,)))
        along = tuple(range(len(part.dims)))
        arrays = outputs_of_blocks(_Block(part, threads), columns, along, part.outputs, token)
        found |= {name: (part.dims, array) for name, array in arrays.items()}
    return found


class _Block:
    """A chunk of a part from the values of its axes: a function that pickles small."""

    def __init__(self, part: AnyPart, threads: int) -> None:
        self.part, self.threads = part, threads

    def __call__(self, *values: Array) -> dict[str, Array]:
        return self.part.compute(dict(zip(self.part.axes, values, strict=True)), self.threads)

    def __dask_tokenize__(self) -> Any:
        return "desaxe.block", identity_text(self.part)


def identity_text(part: AnyPart) -> str:
    """A text that tells a part from all others, by what its loads are too."""
    sources = [] if isinstance(part, Part) else [part.source, *getattr(part, "at", ())]
    plans = [source.plan for source in sources if isinstance(source, Loaded)]
    return " ".join([repr(part), *(load.identity for plan in plans for load in plan.loads.values())])
