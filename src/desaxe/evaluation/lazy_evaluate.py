"""`evaluate` of Dask arrays: lazy, chunk by chunk, by compiled kernels."""

from collections.abc import Mapping
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..runtime.compiled_only import compiled_only
from ..runtime.request import Request
from .arrays import broadcast_shape, dtype_of, fill
from .dask_blocks import lazily
from .loops import loops_over

Array = NDArray[Any]


def evaluate_lazily(
    wanted: Request, given: Mapping[str, Any], threads: int | None, out: Any
) -> dict[str, Any]:
    """The values by requested name, as Dask arrays of the broadcast shape.

    An input that is all bad is an error elsewhere; here nobody has seen its values: they are NaN.
    """
    if out is not None:
        raise TypeError("out= is for arrays in memory, not with Dask arrays")
    return lazily(partial(ValuesTask, wanted, threads or 1), wanted.inputs, given, wanted.shown)


class ValuesTask(NamedTuple):
    """A request, applied to a block of each array."""

    wanted: Request
    threads: int
    scalars: dict[str, float]
    names: tuple[str, ...]

    @property
    def identity(self) -> str:
        """A text that tells the task from all others."""
        return repr(self)

    @property
    def dtypes(self) -> dict[str, np.dtype[Any]]:
        """The outputs by name."""
        return {name: dtype_of(name) for name in self.wanted.shown}

    def compute(self, *blocks: Array) -> dict[str, Array]:
        """The values by name, in the shape to which the blocks broadcast."""
        arrays = {n: np.asarray(block, np.float64) for n, block in zip(self.names, blocks, strict=True)}
        shape = broadcast_shape(arrays)
        outs = {name: np.empty(shape, dtype) for name, dtype in self.dtypes.items()}
        if all(shape):
            with compiled_only():
                loops = loops_over(arrays, shape)
                fill(self.wanted, dict(self.scalars), loops, list(outs.values()), self.threads)
        return outs
