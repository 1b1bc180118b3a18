"""A task of many outputs over the chunks of Dask arrays: one task a chunk, one more per output."""

import warnings
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ..runtime.request import as_number
from ..support.extras import needed
from ..support.forks import IMPORTS
from .arrays import as_array, broadcast_shape

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


def is_lazy(value: Any) -> bool:
    """True for a Dask array, or a labelled array of one."""
    graph = getattr(value, "__dask_graph__", None)
    return graph is not None and graph() is not None


def as_dask(name: str, value: Any) -> Any:
    """A Dask array of real numbers; a labelled array without its labels."""
    with IMPORTS:
        import dask.array as da

    array = da.asarray(getattr(value, "data", value) if hasattr(value, "dims") else value)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name}: expected real numbers, got a Dask array of {array.dtype}")
    return array


def lazily(
    made: Callable[[dict[str, float], tuple[str, ...]], ChunkTask],
    inputs: Sequence[str],
    given: Mapping[str, Any],
    names: Sequence[str],
) -> dict[str, Any]:
    """The outputs of a task over inputs that broadcast, as Dask arrays; some of them are Dask arrays.

    made   the task, from the inputs that are numbers and the names of the others; loads that vary with the
           motion are its own
    """
    with needed("Dask arrays"):
        from dask.base import tokenize

    scalars: dict[str, float] = {}
    arrays: dict[str, Any] = {}
    for name in (name for name in inputs if not callable(given.get(name))):
        value = given.get(name)
        number = None if is_lazy(value) else as_number(name, value, inputs, names)
        if number is None:
            array = value if is_lazy(value) else as_array(name, value, inputs, names)
            arrays[name] = as_dask(name, array)
        else:
            scalars[name] = number
    rank = len(broadcast_shape(arrays))
    task = made(scalars, tuple(arrays))
    token = tokenize(task.identity, *(array.name for array in arrays.values()))
    arguments = [(array, tuple(range(rank - array.ndim, rank))) for array in arrays.values()]
    return outputs_of_blocks(task, arguments, tuple(range(rank)), token)


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
