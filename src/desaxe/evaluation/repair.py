"""Repair of points that the kernel of a function leaves over."""

import ctypes
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..mechanism.names import STATUSES
from ..runtime.kernels import KernelKey
from ..runtime.left_over import settle

Array = NDArray[Any]


Repair = ctypes.CFUNCTYPE(None, ctypes.c_int64, ctypes.c_int64, ctypes.c_int64)


def repair_for(
    key: KernelKey, numbers: Mapping[str, float], inputs: Sequence[str], failures: list[BaseException]
) -> Any:
    """The function that a kernel calls with its arguments if it leaves points over.

    What it raises is appended to `failures`: it cannot pass through the machine code that called.
    """

    def repair(args: int, lengths: int, steps: int) -> None:
        try:
            size = ctypes.c_int64.from_address(lengths).value
            columns, outs = _arrays(args, size, steps, key, inputs)
            settle(key, {**numbers, **columns}, outs)
        except BaseException as error:
            failures.append(error)

    return Repair(repair)


def _arrays(
    args: int, size: int, steps: int, key: KernelKey, inputs: Sequence[str]
) -> tuple[dict[str, Array], list[Array]]:
    """The arguments of the loop as arrays: the inputs of the kernel, and the outputs."""
    count = len(inputs) + len(key.names)
    addresses, strides = ((ctypes.c_int64 * count).from_address(place) for place in (args, steps))
    kinds = ["<f8"] * len(inputs) + ["|i1" if name in STATUSES else "<f8" for name in key.names]
    every = [_View(a, size, s, kind).array() for a, s, kind in zip(addresses, strides, kinds, strict=True)]
    own = dict(key.axis_of)
    columns = {name: array for name, array in zip(inputs, every, strict=False) if name in own}
    return columns, every[len(inputs) :]


class _View:
    """Memory at an address, with NumPy's array interface."""

    def __init__(self, address: int, size: int, stride: int, kind: str) -> None:
        self.__array_interface__ = {
            "version": 3, "data": (address, False), "shape": (size,), "strides": (stride,), "typestr": kind,
        }  # fmt: skip

    def array(self) -> Array:
        """The array."""
        return np.asarray(self)
