"""Numbers behind an address: read, written, and those of an array from an element on."""

from numba import types
from numba.extending import intrinsic


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


@intrinsic
def from_element(typingctx, array, place):
    """The elements of an array from one of them on, counted in memory, as a room."""

    def code(context, builder, signature, args):
        own = context.make_array(signature.args[0])(context, builder, args[0])
        return builder.gep(own.data, [args[1]])

    return types.CPointer(types.float64)(array, types.uint64), code
