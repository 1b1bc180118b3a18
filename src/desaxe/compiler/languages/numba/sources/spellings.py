"""Functions that numba spells in its own way, or needs besides.

A fused multiply-add keeps the whole product, where there is one; with the bits of a number a sign costs no
comparison.
"""

from numba import types
from numba.extending import intrinsic
from numpy import float64, int64


def _multiply_add(name):
    """a * b + c as one instruction: a product that LLVM moved out of a loop would not be fused any more."""

    @intrinsic
    def function(typingctx, a, b, c):
        def code(context, builder, signature, args):
            number = args[0].type
            kind = type(builder.function.ftype)(number, [number] * 3)
            return builder.call(builder.module.declare_intrinsic(name, [number], kind), args)

        return types.float64(types.float64, types.float64, types.float64), code

    return function


# The first is rounded once where the machine can, else twice; the second always once.
mul_add, fused = _multiply_add("llvm.fmuladd"), _multiply_add("llvm.fma")


def rotated(odd, even, quarters):
    """The one or the other by the parity of a whole number, with the sign of half of it."""
    # Beyond 2^52 the last bits of a number are those of the whole number that was added.
    bits = float64(quarters + 6755399441055744.0).view(int64)
    value = float64(odd if bits & 1 else even).view(int64)
    return int64(value ^ (bits >> 1 << 63)).view(float64)


def rotated_sin(sine, cosine, quarters):
    """The sine of an angle and a whole number of quarter turns."""
    return rotated(cosine, sine, quarters)


def rotated_cos(sine, cosine, quarters):
    """The cosine of an angle and a whole number of quarter turns."""
    return rotated(cosine, sine, quarters + 1.0)


def two_product_error(a, b):
    """The rounding error of a * b, exactly."""
    return fused(a, b, -(a * b))


@intrinsic
def apart(typingctx):
    """Mark the arrays that a function takes as separate (noalias), and ask for the widest vectors."""

    def code(context, builder, signature, args):
        for argument in context.call_conv.get_arguments(builder.function):
            if argument.type.is_pointer:
                argument.add_attribute("noalias")
        # past llvmlite's list of attributes, which has none with a value
        set.add(builder.function.attributes, '"prefer-vector-width"="512"')
        return context.get_dummy_value()

    return types.none(), code
