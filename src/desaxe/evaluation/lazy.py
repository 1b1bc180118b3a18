"""`grid(..., chunks=)`: the variables of a plan as lazy Dask arrays, one task a chunk and step."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..support.extras import needed
from .chunks import chunk_lengths
from .dask_blocks import outputs_of_blocks
from .plan import Plan, Step, computed

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
        task = StepTask(step, threads or 1)
        token = tokenize(task.identity, *(axes[name] for name in step.axes), lengths)
        columns = []
        for number, name in enumerate(step.axes):
            own = lengths.get(name, (axes[name].size,))  # a reduced axis is whole
            column = da.from_array(axes[name], chunks=(own,), name=f"{name}-{token}", inline_array=True)
            columns.append((column, (number,)))
        found |= outputs_of_blocks(task, columns, tuple(range(len(step.dims))), token)
    return found


class StepTask(NamedTuple):
    """A step in a chunk, from the values of its axes."""

    step: Step
    threads: int

    @property
    def identity(self) -> str:
        """A text that tells the task from all others."""
        return self.step.identity

    @property
    def dtypes(self) -> dict[str, np.dtype[Any]]:
        """The outputs by name."""
        return {name: output.dtype for name, output in self.step.outputs.items()}

    def compute(self, *values: Array) -> dict[str, Array]:
        """The outputs of a block."""
        return computed(self.step, dict(zip(self.step.axes, values, strict=True)), self.threads)
