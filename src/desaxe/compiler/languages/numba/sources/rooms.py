"""Rooms and flags of a block of points, for a kernel in two forms.

Rooms are on the stack: the compiler knows that nothing else points there, and nothing has to be allocated.
"""

from numba import types
from numba.core import cgutils
from numba.extending import intrinsic


@intrinsic(prefer_literal=True)
def room(typingctx, size):
    """Room for `size` numbers, on the stack."""

    def code(context, builder, signature, args):
        kind = context.get_value_type(types.float64)
        place = builder.alloca(kind, size=context.get_constant(types.int64, size.literal_value))
        place.align = 64
        return place

    return types.CPointer(types.float64)(size), code


@intrinsic
def put(typingctx, room, place, value):
    """Keep a value at a place of a room."""

    def code(context, builder, signature, args):
        room, place, value = args
        builder.store(value, builder.gep(room, [place]))
        return context.get_dummy_value()

    return types.none(room, types.uint64, types.float64), code


@intrinsic
def get(typingctx, room, place):
    """The value at a place of a room."""

    def code(context, builder, signature, args):
        return builder.load(builder.gep(args[0], [args[1]]))

    return types.float64(room, types.uint64), code


@intrinsic(prefer_literal=True)
def flags(typingctx, size):
    """Room for a word for each point of a block: -1 where it is flagged, else 0."""

    def code(context, builder, signature, args):
        kind = context.get_value_type(types.int64)
        place = builder.alloca(kind, size=context.get_constant(types.int64, size.literal_value))
        place.align = 64
        return place

    return types.CPointer(types.int64)(size), code


@intrinsic
def put_flag(typingctx, flags, place, flag):
    """Flag a point of a block, or not."""

    def code(context, builder, signature, args):
        flags, place, flag = args
        word = builder.sext(flag, context.get_value_type(types.int64))
        builder.store(word, builder.gep(flags, [place]))
        return context.get_dummy_value()

    return types.none(flags, types.uint64, types.boolean), code


@intrinsic
def eight_flags(typingctx, flags, eight):
    """The flags of eight points in a row, a bit each."""

    def code(context, builder, signature, args):
        kind = cgutils.ir.VectorType(context.get_value_type(types.int64), 8)
        place = builder.gep(builder.bitcast(args[0], kind.as_pointer()), [args[1]])
        bits = builder.icmp_signed("<", builder.load(place, align=64), kind([0] * 8))
        return builder.zext(builder.bitcast(bits, cgutils.int8_t), context.get_value_type(types.uint64))

    return types.uint64(flags, types.uint64), code


@intrinsic
def is_flagged(typingctx, flags, place):
    """The flag of a point of a block."""

    def code(context, builder, signature, args):
        word = builder.load(builder.gep(args[0], [args[1]]))
        return builder.icmp_signed("<", word, word.type(0))

    return types.boolean(flags, types.uint64), code


@intrinsic
def count_flags(typingctx, eight):
    """The number of flags that are set, of eight."""

    def code(context, builder, signature, args):
        return builder.ctpop(args[0])

    return types.uint64(types.uint64), code


@intrinsic
def put_places(typingctx, room, count, flags, first):
    """Keep the places of the points of eight that are flagged; what follows is not for use."""

    def code(context, builder, signature, args):
        room, count, flags, first = args
        word, byte = (context.get_value_type(kind) for kind in (types.uint64, types.uint8))
        rows = [[k for k in range(8) if flags >> k & 1] for flags in range(256)]
        table = cgutils.create_constant_array(byte, [k for row in rows for k in (row + [0] * 8)[:8]])
        kept = builder.bitcast(cgutils.global_constant(builder, "places", table), byte.as_pointer())
        # As vectors: LLVM leaves eight single additions alone.
        vector, undefined = cgutils.ir.VectorType, cgutils.ir.Undefined
        row = builder.gep(builder.bitcast(kept, vector(byte, 8).as_pointer()), [flags])
        own = builder.zext(builder.load(row, align=1), vector(word, 8))
        none = cgutils.ir.Constant(vector(word, 8), undefined)
        start = builder.insert_element(none, first, cgutils.int32_t(0))
        starts = builder.shuffle_vector(start, none, vector(cgutils.int32_t, 8)([0] * 8))
        to = builder.bitcast(builder.gep(room, [count]), vector(word, 8).as_pointer())
        builder.store(builder.add(own, starts), to, align=8)
        return context.get_dummy_value()

    return types.none(room, types.uint64, types.uint64, types.uint64), code


@intrinsic
def place_at(typingctx, room, k):
    """A place that is kept."""

    def code(context, builder, signature, args):
        words = builder.bitcast(args[0], context.get_value_type(types.uint64).as_pointer())
        return builder.load(builder.gep(words, [args[1]]))

    return types.uint64(room, types.uint64), code


@intrinsic
def from_element(typingctx, array, place):
    """The elements of an array from one of them on, counted in memory, as a room."""

    def code(context, builder, signature, args):
        own = context.make_array(signature.args[0])(context, builder, args[0])
        return builder.gep(own.data, [args[1]])

    return types.CPointer(types.float64)(array, types.uint64), code


@intrinsic
def clear_flags(typingctx, flags, eight):
    """Clear the flags of eight points in a row."""

    def code(context, builder, signature, args):
        kind = cgutils.ir.VectorType(context.get_value_type(types.int64), 8)
        place = builder.gep(builder.bitcast(args[0], kind.as_pointer()), [args[1]])
        builder.store(kind([0] * 8), place, align=64)
        return context.get_dummy_value()

    return types.none(flags, types.uint64), code
