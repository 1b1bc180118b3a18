"""Repair of points that a kernel cannot decide: angles beyond its limit, and undecided assembly."""

import ctypes
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..mechanism.constants import limit_of
from ..mechanism.names import STATUSES
from ..runtime.kernels import KernelKey, has_near_limit, kernel_for
from ..runtime.native.any_stride import Repair
from ..runtime.near_limit import decide

Array = NDArray[Any]


def repair_for(
    key: KernelKey, numbers: Mapping[str, float], inputs: Sequence[str], failures: list[BaseException]
) -> Repair:
    """The callback of `any_stride.bind` for a kernel; its exceptions are appended to `failures`."""
    limit = limit_of(key.accuracy)

    def repair(args: int, size: int, steps: int) -> None:
        try:
            columns, outs = _arrays(args, size, steps, key, inputs)
            _repair(key, numbers, columns, outs, limit)
        except BaseException as error:  # it cannot pass through the machine code that called
            failures.append(error)

    return repair


def _repair(
    key: KernelKey,
    numbers: Mapping[str, float],
    columns: Mapping[str, Array],
    outs: Sequence[Array],
    limit: float,
) -> None:
    """Recompute these points, each group by its own kernel."""
    size = outs[0].size
    theta = np.abs(columns["theta"]) if "theta" in columns and not key.far else np.zeros(size)
    far = (theta > limit) & (theta < np.inf)
    for rows, part in ((np.flatnonzero(far), key._replace(far=True)), (np.flatnonzero(~far), key)):
        if not rows.size or (part is key and not has_near_limit(key)):
            continue
        values: dict[str, Any] = {**numbers, **{name: column[rows] for name, column in columns.items()}}
        places = [out[rows] for out in outs]
        if part is key:
            decide(key, values, places)
        elif key.accuracy == "extended":
            _refuse(places)
        elif kernel_for(part).run(values, places):
            decide(part, values, places)
        for out, place in zip(outs, places, strict=True):
            out[rows] = place


def _refuse(places: Sequence[Array]) -> None:
    """Mark angles beyond the limit of double-double as bad input, as `evaluate` over arrays does."""
    for place in places:
        place[:] = 4 if place.dtype == np.int8 else np.nan


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
