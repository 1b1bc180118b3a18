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
from typing import Any, NamedTuple

from .modules import Native, native

BLOCK = 512  # points
# What `loop` reads of `data`: words before the arrays, words of each array.
HEAD, EACH = 7, 4
Repair = Callable[[int, int, int], None]
_Repair = ctypes.CFUNCTYPE(None, ctypes.c_int64, ctypes.c_int64, ctypes.c_int64)

TEXT = f'''"""A kernel over arrays of any stride."""

from math import inf

from llvmlite import ir
from numba import njit, types
from numba.extending import intrinsic


def reader(kind, result):
    """An intrinsic that reads the value at a place of an array at an address."""

    @intrinsic
    def read(typingctx, address, place):
        def code(context, builder, signature, args):
            pointer = builder.inttoptr(args[0], kind.as_pointer())
            return builder.load(builder.gep(pointer, [args[1]]))

        return result(types.int64, types.int64), code

    return read


def writer(kind, given):
    """An intrinsic that writes a value at a place of an array at an address."""

    @intrinsic
    def write(typingctx, address, place, value):
        def code(context, builder, signature, args):
            pointer = builder.inttoptr(args[0], kind.as_pointer())
            builder.store(args[2], builder.gep(pointer, [args[1]]))
            return context.get_dummy_value()

        return types.none(types.int64, types.int64, given), code

    return write


word, put_word = reader(ir.IntType(64), types.int64), writer(ir.IntType(64), types.int64)
double, put_double = reader(ir.DoubleType(), types.float64), writer(ir.DoubleType(), types.float64)
byte, put_byte = reader(ir.IntType(8), types.int8), writer(ir.IntType(8), types.int8)


@intrinsic
def room(typingctx, words):
    """The address of room for so many words on the stack."""

    def code(context, builder, signature, args):
        place = builder.alloca(ir.IntType(64), size=args[0])
        place.align = 64
        return builder.ptrtoint(place, ir.IntType(64))

    return types.int64(types.int64), code


@intrinsic
def call(typingctx, address, a, b, c):
    """The answer of a function at an address."""

    def code(context, builder, signature, args):
        word = ir.IntType(64)
        function = builder.inttoptr(args[0], ir.FunctionType(word, [word] * 3).as_pointer())
        return builder.call(function, args[1:])

    return types.int64(types.int64, types.int64, types.int64, types.int64), code


def function(args, dimensions, steps, data):
    size = word(dimensions, 0)
    words, count, angle, limit = word(data, 1), word(data, 2), word(data, 3), double(data, 4)
    arrays = data + {8 * HEAD}
    template = arrays + {8 * EACH} * count
    table = room(words)
    for k in range(words):
        put_word(table, k, word(template, k))
    straight = True
    for p in range(count):
        here = arrays + {8 * EACH} * p
        straight &= word(steps, word(here, 0)) == word(here, 2)
    buffers = room(int64(1) if straight else count * {BLOCK})
    block = size if straight else int64({BLOCK})
    left = int64(0)  # points for the repair
    start = int64(0)
    while start < size:
        length = min(block, size - start)
        for p in range(count):
            here = arrays + {8 * EACH} * p
            argument = word(here, 0)
            step = word(steps, argument)
            place = word(args, argument) + start * step
            if step != word(here, 2):
                buffer = buffers + {8 * BLOCK} * p
                if word(here, 3) == 0:
                    for k in range(length):
                        put_double(buffer, k, double(place + k * step, 0))
                place = buffer
            put_word(table, word(here, 1), place)
            put_word(table, word(here, 1) + 1, length)
            if argument == angle:
                for k in range(length):
                    left += 1 if limit < abs(double(place, k)) < inf else 0
        left += call(word(data, 0), table, 0, 0)
        for p in range(count):
            here = arrays + {8 * EACH} * p
            argument = word(here, 0)
            step = word(steps, argument)
            if word(here, 3) == 1 and step != word(here, 2):
                buffer = buffers + {8 * BLOCK} * p
                place = word(args, argument) + start * step
                if word(here, 2) == 8:
                    for k in range(length):
                        put_double(place + k * step, 0, double(buffer, k))
                else:
                    for k in range(length):
                        put_byte(place + k * step, 0, byte(buffer, k))
        start += block
    if left != 0 and word(data, 5) != 0:
        call(word(data, 5), args, size, steps)
    if word(data, 6) != 0:
        call(word(data, 6), 61, 0, 0)  # clears the processor's flags: NaN is an answer, not an accident
    return left


signature = types.int64(types.int64, types.int64, types.int64, types.int64)
int64 = types.int64
'''


class Bound(NamedTuple):
    """The address of the loop and of its data for one kernel; `kept` keeps both alive."""

    loop: int
    data: int
    kept: Any


@cache
def loop() -> Native:
    """The inner loop; it returns the number of points left for a repair."""
    return native("any_stride", TEXT)


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
