"""The executor: kernels by key, compiled once a process and kept as long as something can call them."""

import math
import struct
from collections.abc import Callable, Mapping, Sequence
from ctypes import CFUNCTYPE, addressof, c_char, c_char_p, c_int64
from typing import Any

import numpy as np

from ..compiler.kernel import Kernel
from ..compiler.llvm.machine import Code, compiled, lanes
from ..compiler.llvm.nest import HEAD, NAME, Entry, module_text
from ..mechanism.constants import limit_of
from ..support.forks import ForkSafeLock
from ..support.recent import Recent
from ..support.signals import finished
from .kernels import KernelKey, kernel_of

MOST_KEPT = 256  # kernels that nobody else keeps
_bytes_of = c_char.from_buffer
_CALL = CFUNCTYPE(c_int64, c_char_p, c_char_p, c_char_p, c_char_p)  # lets go of the GIL while it runs


class CompiledKernel:
    """A kernel in machine code, which lives as long as this object.

    arguments   the inputs that are arrays, in their order
    scalars     those that are numbers, in theirs
    given       the tables that it looks up
    call        the entry (see `compiler.llvm.nest`), which takes packed words
    """

    def __init__(
        self,
        kernel: Kernel,
        arguments: Sequence[str] | None = None,
        angle: str | None = None,
        limit: float = math.inf,
    ) -> None:
        """Compile it; angles beyond the limit are left to the caller."""
        if arguments is None:
            arguments = [name for name, axis in kernel.inputs.items() if axis is not None]
        self.entry = Entry(kernel, tuple(arguments), angle, limit)
        self.code: Code = compiled(module_text(self.entry, lanes()), NAME)
        self.arguments, self.scalars, self.axes = self.entry.arguments, self.entry.scalars, kernel.axes
        self.call: Callable[[bytes, bytes, bytes, bytes], int] = _CALL(self.code.address)
        self._pack_data = struct.Struct(f"{HEAD}q{len(self.scalars)}d").pack
        self._tables = [table.along for table in kernel.tables for _ in table.kernel.outputs]
        self.given = kernel.given

    def data(self, values: Mapping[str, Any], repair: int = 0, clear: int = 0) -> bytes:
        """The packed numbers of a call; `repair` and `clear` are addresses of functions (see `HEAD`)."""
        return self._pack_data(repair, clear, *[values[name] for name in self.scalars])

    def run(self, values: Mapping[str, Any], outs: Sequence[Any]) -> int:
        """Fill `outs`, arrays over the axes; return how many points are left (see `left_over`)."""
        given = [values[name] for name in self.arguments]
        arrays = [*given, *outs]
        steps = [array.strides[-1] for array in arrays]
        lengths = [*outs[0].shape]
        if self._tables:
            arrays += [np.empty([lengths[axis] for axis in along]) for along in self._tables]
        for table in self.given:
            arrays += [values[f"{table}_x"], values[f"{table}_c"]]
            lengths.append(values[f"{table}_x"].size)
        return self.call(words(_addresses(arrays)), words(lengths), words(steps), self.data(values))


def _addresses(arrays: Sequence[Any]) -> list[int]:
    """The addresses of arrays by the fastest way; read-only and strided ones take the slow one."""
    try:
        return [addressof(_bytes_of(array)) for array in arrays]
    except (TypeError, ValueError, BufferError):
        return [array.__array_interface__["data"][0] for array in arrays]


def words(numbers: Sequence[int]) -> bytes:
    """Whole numbers, packed."""
    return struct.pack(f"{len(numbers)}q", *numbers)


_LOCK = ForkSafeLock()
_KEPT: Recent[KernelKey, CompiledKernel] = Recent(MOST_KEPT)


def is_ready(key: KernelKey) -> bool:
    """True if the kernel of a key is compiled."""
    return key in _KEPT


def kernel_for(key: KernelKey) -> CompiledKernel:
    """The kernel of a key, compiled now unless it is kept."""
    found = _KEPT.get(key)
    if found is None:
        found = _KEPT[key] = finished(lambda: _compiled(key))
    return found


def _compiled(key: KernelKey) -> CompiledKernel:
    """Compile a key; several threads that want the same wait for the first."""
    with _LOCK:
        return _KEPT.get(key) or compiled_kernel(key)


def compiled_kernel(key: KernelKey, arguments: Sequence[str] | None = None) -> CompiledKernel:
    """Compile a key's kernel for one owner; `arguments` orders the inputs that are arrays."""
    written_out = key.accuracy != "extended" and not key.far
    angle = "theta" if written_out and "theta" in dict(key.axis_of) else None
    return CompiledKernel(kernel_of(key), arguments, angle, limit_of(key.accuracy))
