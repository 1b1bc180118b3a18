"""A function of many outputs over the chunks of Dask arrays: one task a chunk, one more per output."""

import warnings
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..support.extras import needed
from ..support.forks import IMPORTS

Array = NDArray[Any]
Function = Callable[..., Mapping[str, Array]]


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


def outputs_of_blocks(
    function: Function,
    arguments: Sequence[tuple[Any, tuple[int, ...]]],
    along: tuple[int, ...],
    outputs: Mapping[str, np.dtype[Any]],
    token: str,
) -> dict[str, Any]:
    """The outputs of a function of blocks, each a lazy array.

    function   takes a block of each argument, gives a dict output -> array; it must pickle
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
            function, along, *flat, dtype=object, concatenate=True,
            name=f"desaxe-{token}", meta=np.empty(shape, object),
        )  # fmt: skip
    return {
        name: da.blockwise(
            _output, along, blocks, along, name, None, dtype=dtype, name=f"{name}-{token}",
            meta=np.empty(shape, dtype),
        )
        for name, dtype in outputs.items()
    }  # fmt: skip


def numbered(arrays: Mapping[str, Any]) -> tuple[list[tuple[Any, tuple[int, ...]]], tuple[int, ...]]:
    """Dask arrays that broadcast like NumPy's with the numbers of their dimensions, and all numbers."""
    rank = max(array.ndim for array in arrays.values())
    return [(array, tuple(range(rank - array.ndim, rank))) for array in arrays.values()], tuple(range(rank))


def _output(block: Any, name: str) -> Array:
    """One output of a computed block."""
    array: Array = block[name]
    return array
