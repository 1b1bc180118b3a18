"""The loop of `any_stride`, whose text numba compiles."""

from math import inf
from typing import TYPE_CHECKING

from llvmlite import ir
from numba import types
from numba.extending import intrinsic
from numpy import int64

if TYPE_CHECKING:
    from .any_stride import BLOCK, EACH, HEAD


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
    """The address of room for `words` words on the stack."""

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


def loop(args, dimensions, steps, data):
    """A kernel over arrays of any stride; the number of points left for a repair."""
    size = word(dimensions, 0)
    words, count, angle, limit = word(data, 1), word(data, 2), word(data, 3), double(data, 4)
    arrays = data + 8 * HEAD
    template = arrays + 8 * EACH * count
    table = room(words)
    for k in range(words):
        put_word(table, k, word(template, k))
    straight = True
    for p in range(count):
        here = arrays + 8 * EACH * p
        straight &= word(steps, word(here, 0)) == word(here, 2)
    buffers = room(int64(1) if straight else count * BLOCK)
    block = size if straight else int64(BLOCK)
    left = int64(0)  # points for the repair
    start = int64(0)
    while start < size:
        length = min(block, size - start)
        for p in range(count):
            here = arrays + 8 * EACH * p
            argument = word(here, 0)
            step = word(steps, argument)
            place = word(args, argument) + start * step
            if step != word(here, 2):
                buffer = buffers + 8 * BLOCK * p
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
            here = arrays + 8 * EACH * p
            argument = word(here, 0)
            step = word(steps, argument)
            if word(here, 3) == 1 and step != word(here, 2):
                buffer = buffers + 8 * BLOCK * p
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
