"""`grid(..., chunks=)`: the variables of a plan as lazy Dask arrays, one task for each chunk and step."""

import warnings
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..support.extras import needed
from .chunks import chunk_lengths
from .plan import Plan
from .points import Step

Array = NDArray[Any]
AUTO = 2**21  # points of a chunk: 16 MiB of doubles


def lazy_values(plan: Plan, chunks: Any, threads: int | None) -> dict[str, Any]:
    """The variables of a plan as Dask arrays; `chunks` as in xarray.

    Names follow from the kernels and the values of the axes, so the same request has the same names in
    every process.
    """
    with needed("chunks="):
        import dask.array as da
        from dask.base import tokenize

    lengths = chunk_lengths(chunks, plan.sizes, max(1, AUTO // max(plan.behind, 1)))
    axes, found = plan.outer.axes, dict[str, Any]()
    for step in plan.all:
        token = tokenize(step.identity, *(axes[name] for name in step.axes), lengths)
        columns = []
        for number, name in enumerate(step.axes):
            own = lengths.get(name, (axes[name].size,))  # a reduced axis is whole
            column = da.from_array(axes[name], chunks=(own,), name=f"{name}-{token}", inline_array=True)
            columns += [column, (number,)]
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
            found[name] = da.blockwise(
                _output, along, blocks, along, name, None, dtype=output.dtype, name=f"{name}-{token}",
                meta=empty.astype(output.dtype),
            )  # fmt: skip
    return found


class ChunkTask(NamedTuple):
    """A step in a chunk, from the values of its axes; it pickles."""

    step: Step
    threads: int

    def __call__(self, *values: Array) -> dict[str, Array]:
        """The outputs by name."""
        return self.step.compute(dict(zip(self.step.axes, values, strict=True)), self.threads)


def _output(block: Any, name: str) -> Array:
    """One output of a computed block."""
    array: Array = block[name]
    return array
