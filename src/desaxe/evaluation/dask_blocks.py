"""A task of many outputs over the chunks of Dask arrays: one task a chunk, one more per output."""

import warnings
from collections.abc import Mapping, Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ..support.extras import needed

Array = NDArray[Any]


class ChunkTask(Protocol):
    """The work in each chunk; it pickles."""

    @property
    def identity(self) -> str:
        """A text that tells the task from all others, in every process."""

    @property
    def dtypes(self) -> Mapping[str, np.dtype[Any]]:
        """The outputs by name."""

    def compute(self, *blocks: Array) -> Mapping[str, Array]:
        """The outputs of a chunk, from a block of each argument."""


def outputs_of_blocks(
    task: ChunkTask, arguments: Sequence[tuple[Any, tuple[int, ...]]], along: tuple[int, ...], token: str
) -> dict[str, Any]:
    """The outputs of a task over blocks, each a lazy array.

    arguments  Dask arrays, each with the numbers of its dimensions, which broadcast
    along      the numbers of the outputs' dimensions
    token      what the names of the arrays end in: the same for the same request, in every process
    """
    with needed("lazy arrays"):
        import dask.array as da

    flat = [part for argument in arguments for part in argument]
    shape = (0,) * len(along)
    with warnings.catch_warnings():
        # An outer product has more chunks than each of its arguments, of which Dask would warn.
        warnings.simplefilter("ignore", da.PerformanceWarning)
        blocks = da.blockwise(
            task.compute, along, *flat, dtype=object, concatenate=True,
            name=f"desaxe-{token}", meta=np.empty(shape, object),
        )  # fmt: skip
    return {
        name: da.blockwise(
            _output, along, blocks, along, name, None, dtype=dtype, name=f"{name}-{token}",
            meta=np.empty(shape, dtype),
        )
        for name, dtype in task.dtypes.items()
    }  # fmt: skip


def _output(block: Any, name: str) -> Array:
    """One output of a computed block."""
    array: Array = block[name]
    return array
