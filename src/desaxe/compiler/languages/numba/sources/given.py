"""A function of the user's behind an address, so that kernels that call it stand in the cache.

It takes the address of rows of numbers, how far apart they are and how many numbers each has: the first three
rows are read, the fourth is written. Its answer is 0 if it could. A kernel has the address as a number.
"""

from __future__ import annotations

from math import nan
from typing import TYPE_CHECKING

from numba import types
from numba.extending import intrinsic
from numpy import int64, uint64

if TYPE_CHECKING:
    from typing import Any

    def get(room: Any, place: Any) -> float:
        """The value at a place of a room."""

    def put(room: Any, place: Any, value: float) -> None:
        """Keep a value at a place of a room."""

    def from_element(array: Any, place: Any) -> Any:
        """The elements of an array from one of them on, counted in memory, as a room."""


@intrinsic
def room_at(typingctx, address):
    """The room at an address."""

    def code(context, builder, signature, args):
        return builder.inttoptr(args[0], context.get_value_type(types.float64).as_pointer())

    return types.CPointer(types.float64)(types.int64), code


@intrinsic
def four(typingctx):
    """Room for four numbers, once in a call of what it is inlined in."""

    def code(context, builder, signature, args):
        with builder.goto_entry_block():
            return builder.alloca(
                context.get_value_type(types.float64), size=context.get_constant(types.int64, 4)
            )

    return types.CPointer(types.float64)(), code


@intrinsic
def answer_of(typingctx, address, rows, apart, count):
    """Call the function at an address; its answer."""

    def code(context, builder, signature, args):
        address, rows, *sizes = args
        integer = context.get_value_type(types.int64)
        kind = type(builder.function.ftype)(integer, [integer] * 3)
        function = builder.inttoptr(builder.fptosi(address, integer), kind.as_pointer())
        return builder.call(function, [builder.ptrtoint(rows, integer), *sizes])

    return types.int64(types.float64, rows, types.int64, types.int64), code


def asked(address: float, a: float, b: float, c: float) -> float:
    """The function at an address, of three numbers; NaN where it cannot."""
    rows: Any = four()
    put(rows, uint64(0), a)
    put(rows, uint64(1), b)
    put(rows, uint64(2), c)
    return get(rows, uint64(3)) if answer_of(address, rows, int64(1), int64(1)) == 0 else nan


def asked_at_nodes(address: float, room: Any, first: Any, count: Any) -> bool:
    """Fill the fourth of the rows of a room from one on by the function at an address; True if it could."""
    apart = room.shape[1]
    rows = from_element(room, uint64(first * apart))
    return bool(answer_of(address, rows, int64(apart), int64(count)) == 0)
