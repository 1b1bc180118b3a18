"""A kernel over arrays of any stride: the inner loop of a NumPy ufunc, also used for single points.

A kernel wants its columns contiguous and apart. `bind` puts a loop in front of it that hands contiguous
arrays on as they are and the others in blocks that stay in the first-level cache. So every caller runs the
same machine code, and a point has the same digits in an array of any shape.

The loop is `void loop(char **args, intptr *dimensions, intptr *steps, int64 *data)`: NumPy's convention.
`data` describes the kernel's packed table (see `machine_code`): which argument each address is. Points that
need another kernel (an angle that only the C library reduces, a reach that hangs on rounding) are left to a
function of the caller's, which the loop calls once, after the kernel.
"""

import ctypes
import math
import struct
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from ...compiler.builder import module_text
from ...compiler.languages.numba.module import numba_parts
from .modules import Native, native

LOOP = Path(__file__).with_name("strided_loop.py")
BLOCK = 512  # points
# What `loop` reads of `data`: words before the arrays, words of each array.
HEAD, EACH = 7, 4
Repair = Callable[[int, int, int], None]
_Repair = ctypes.CFUNCTYPE(None, ctypes.c_int64, ctypes.c_int64, ctypes.c_int64)

SIGNATURE = """signature = types.int64(types.int64, types.int64, types.int64, types.int64)
function = loop.py_func
"""


class Bound(NamedTuple):
    """The address of the loop and of its data for one kernel; `kept` keeps both alive."""

    loop: int
    data: int
    kept: Any


@cache
def loop() -> Native:
    """The inner loop; it returns the number of points left for a repair."""
    parts = [f"HEAD, EACH, BLOCK = {HEAD}, {EACH}, {BLOCK}\n", SIGNATURE]
    text = module_text("A kernel over arrays of any stride.", numba_parts(parts, LOOP))
    return native("any_stride", text)


def data_of(
    kernel: Native,
    places: Sequence[int | float],
    inputs: int,
    angle: int | None,
    limit: float,
    repair: int = 0,
) -> tuple[bytes, str]:
    """The head of the loop's data, and the format of the kernel's table that follows; see `bind`."""
    arrays: list[int] = []
    words = ""
    for place, rank, size in zip(places, kernel.ranks, kernel.item_sizes, strict=True):
        if rank >= 0:
            arrays += [int(place), len(words), size, int(place >= inputs)]
        words += "d" if rank < 0 else "qqq"
    head = [kernel.address, len(words), len(arrays) // EACH, -1 if angle is None else angle]
    packed = struct.pack(f"{len(head)}q", *head) + struct.pack("d", limit)
    return packed + struct.pack(f"{2 + len(arrays)}q", repair, _clear_flags(), *arrays), words


def bind(
    kernel: Native,
    places: Sequence[int | float],
    inputs: int,
    angle: int | None,
    limit: float,
    repair: Repair,
) -> Bound:
    """A kernel behind the loop.

    places   for each parameter of the kernel the number of the loop's argument, or a float, which is a number
             for all points
    inputs   how many arguments are inputs; the others are outputs
    angle    the argument whose magnitudes are held against `limit`
    repair   called with the addresses that the loop has been called with, (args, size, steps), if an angle is
             beyond the limit or the kernel's answer is not 0
    """
    callback = _Repair(repair)
    back = ctypes.cast(callback, ctypes.c_void_p).value or 0
    head, format_ = data_of(kernel, places, inputs, angle, limit, back)
    words: list[int | float] = []
    for place, rank in zip(places, kernel.ranks, strict=True):
        words += [place] if rank < 0 else [0, 0, 0]
    packed = head + struct.pack(format_, *words)
    data = ctypes.create_string_buffer(packed, len(packed))
    inner = loop()
    return Bound(inner.address, ctypes.addressof(data), (kernel, callback, data, inner))


@cache
def _clear_flags() -> int:
    """The address of the C library's `feclearexcept`; 0 if it has none."""
    with suppress(AttributeError, OSError, TypeError):
        library = ctypes.CDLL(getattr(math, "__file__", None))
        return ctypes.cast(library.feclearexcept, ctypes.c_void_p).value or 0
    return 0
