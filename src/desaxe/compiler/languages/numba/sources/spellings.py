"""Functions that numba spells in its own way, or needs besides.

A fused multiply-add keeps the whole product, where there is one; with the bits of a number a sign costs no
comparison.
"""

from numba import types
from numba.extending import intrinsic


@intrinsic
def mul_add(typingctx, a, b, c):
    """a * b + c, rounded once where the machine can, else twice."""

    def code(context, builder, signature, args):
        # One instruction for LLVM: a product that it moved out of a loop would not be fused any more.
        number = args[0].type
        kind = type(builder.function.ftype)(number, [number] * 3)
        return builder.call(builder.module.declare_intrinsic("llvm.fmuladd", [number], kind), args)

    return types.float64(types.float64, types.float64, types.float64), code


def _turned(quarter):
    """The sine of an angle and a whole number of quarter turns, and `quarter` more: an intrinsic."""

    @intrinsic
    def rotated(typingctx, sine, cosine, quarters):
        def code(context, builder, signature, args):
            sine, cosine, quarters = args
            integer = context.get_value_type(types.int64)
            # Beyond 2^52 the last bits of a number are those of the whole number that was added.
            shift = context.get_constant(types.float64, 1.5 * 2.0**52)
            bits = builder.bitcast(builder.fadd(quarters, shift), integer)
            odd = builder.trunc(bits, context.get_value_type(types.boolean))
            either = (sine, cosine) if quarter else (cosine, sine)
            value = builder.bitcast(builder.select(odd, *either), integer)
            turns = builder.add(bits, integer(1)) if quarter else bits
            sign = builder.shl(builder.lshr(turns, integer(1)), integer(63))
            return builder.bitcast(builder.xor(value, sign), args[0].type)

        return types.float64(types.float64, types.float64, types.float64), code

    return rotated


rotated_sin, rotated_cos = _turned(0), _turned(1)


@intrinsic
def fused(typingctx, a, b, c):
    """a * b + c, rounded once."""

    def code(context, builder, signature, args):
        return builder.fma(*args)

    return types.float64(types.float64, types.float64, types.float64), code


def two_product_error(a, b):
    """The rounding error of a * b, exactly."""
    return fused(a, b, -(a * b))


@intrinsic
def apart(typingctx):
    """The promise that what is written to shares no memory with anything else; the widest vectors."""

    def code(context, builder, signature, args):
        for argument in context.call_conv.get_arguments(builder.function):
            if argument.type.is_pointer:
                argument.add_attribute("noalias")
        # past llvmlite's list of attributes, which has none with a value
        set.add(builder.function.attributes, '"prefer-vector-width"="512"')
        return context.get_dummy_value()

    return types.none(), code
