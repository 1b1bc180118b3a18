"""Self-contained machine code: made once by numba, later loaded by LLVM alone.

Importing numba and filling its tables of types takes many times longer than loading a kernel. So the machine
code is taken out of numba, with an entry that follows our own calling convention, and linked with the few
functions of numba's runtime that it may call (memory for tables, a view of another shape). What is left
calls nothing but the C library's mathematics and Python's allocator: any process on the machine can load it.

The entry is `int64 entry(const int64 *table)`. The table has a word for each number (a double or an int64)
and, for each array, its address, its shape and its strides in bytes, in the order of the function's
parameters. The answer is the function's whole number, 0 where it has none, or -1 if there was no memory.
A function of whole numbers alone has an entry that takes them as they are, without a table.
"""

import ctypes
import math
from contextlib import suppress
from functools import cache
from typing import Any, NamedTuple

from ...support.forks import IMPORTS
from .loader import LLVM, loader

ENTRY = "desaxe_entry"
NO_MEMORY = -1
DOUBLE, WHOLE = -1, -2  # the ranks of numbers
MATHEMATICS = (
    "asin", "atan2", "cos", "exp", "floor", "floorf", "fmod", "frexp", "log", "nextafter", "pow", "sin",
    "sqrt", "sqrtf",
)  # fmt: skip
MEMORY = ("PyMem_RawMalloc", "PyMem_RawFree")


class StoredCode(NamedTuple):
    """Machine code, the ranks of what its entry takes (see `DOUBLE`, `WHOLE`), and the bytes of an item."""

    ranks: tuple[int, ...]
    item_sizes: tuple[int, ...]
    machine: bytes


class Loaded(NamedTuple):
    """A loaded entry point; its code stays in memory as long as `keeper`."""

    address: int
    ranks: tuple[int, ...]
    item_sizes: tuple[int, ...]
    keeper: Any


@cache
def machine() -> str:
    """A text that identifies the LLVM version and the processor, on which machine code depends."""
    with IMPORTS:
        import llvmlite

    with LLVM:
        return f"llvmlite {llvmlite.__version__}, {loader().host()}"


@cache
def outside() -> dict[str, int]:
    """Addresses of the functions that machine code may call: those that this Python is linked with."""
    found: dict[str, int] = {}
    with suppress(AttributeError, OSError, TypeError):
        mathematics = ctypes.CDLL(getattr(math, "__file__", None))
        for library, names in ((mathematics, MATHEMATICS), (ctypes.pythonapi, MEMORY)):
            places = {name: ctypes.cast(getattr(library, name), ctypes.c_void_p).value for name in names}
            found |= {name: place for name, place in places.items() if place}
    return found


def load(code: StoredCode) -> Loaded | None:
    """Load machine code; None if this process cannot."""
    address, keeper = loader().load(code.machine, ENTRY, outside())
    return Loaded(address, code.ranks, code.item_sizes, keeper) if address else None
