"""`evaluate` of Dask arrays: lazy, chunk by chunk, by compiled kernels."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..runtime.compiled_only import compiled_only
from ..runtime.request import Request, as_number
from ..support.extras import needed
from .arrays import as_array, broadcast_shape, dtype_of, fill
from .dask_blocks import as_dask, is_lazy, numbered, outputs_of_blocks
from .loops import loops_over

Array = NDArray[Any]


def evaluate_lazily(
    wanted: Request, given: Mapping[str, Any], threads: int | None, out: Any
) -> dict[str, Any]:
    """The values by requested name, as Dask arrays of the broadcast shape.

    An input that is all bad is an error elsewhere; here nobody has seen its values: they are NaN.
    """
    with needed("Dask arrays"):
        from dask.base import tokenize

    if out is not None:
        raise TypeError("out= is for arrays in memory, not with Dask arrays")
    scalars: dict[str, float] = {}
    arrays: dict[str, Any] = {}
    for name in wanted.inputs:
        value = given.get(name)
        if is_lazy(value):
            arrays[name] = as_dask(name, value)
            continue
        number = as_number(name, value, wanted.inputs, wanted.shown)
        if number is None:
            arrays[name] = as_dask(name, as_array(name, value, wanted.inputs, wanted.shown))
        else:
            scalars[name] = number
    broadcast_shape(arrays)
    arguments, along = numbered(arrays)
    block = _Block(wanted, scalars, tuple(arrays), threads or 1)
    outputs = {name: dtype_of(name) for name in wanted.shown}
    token = tokenize(repr(wanted), scalars, *(array.name for array, _ in arguments))
    return outputs_of_blocks(block, arguments, along, outputs, token)


class _Block:
    """The task of one chunk: a request, applied to a block of each array."""

    def __init__(
        self, wanted: Request, scalars: Mapping[str, float], names: tuple[str, ...], threads: int
    ) -> None:
        self.wanted, self.scalars, self.names, self.threads = wanted, scalars, names, threads

    def __call__(self, *blocks: Array) -> dict[str, Array]:
        arrays = {n: np.asarray(block, np.float64) for n, block in zip(self.names, blocks, strict=True)}
        shape = broadcast_shape(arrays)
        outs = {name: np.empty(shape, dtype_of(name)) for name in self.wanted.shown}
        if all(shape):
            with compiled_only():
                loops = loops_over(arrays, shape)
                fill(self.wanted, dict(self.scalars), loops, list(outs.values()), self.threads)
        return outs

    def __dask_tokenize__(self) -> Any:
        return "desaxe.evaluate", repr(self.wanted), tuple(self.scalars.items()), self.names
