"""The executor: kernels by key, compiled once a process, run over blocks of arrays.

A kernel lives as long as something can call it. The points that it leaves over get a second answer: large
angles, and those that rounding decides. An angle beyond what the written-out sine reduces exactly takes that
of the C library. The last angle that a mechanism reaches falls between two doubles, and next to it the sine's
last bits say on which side an angle lies: there twice the digits decide. No value depends on which other
points are in a call.
"""

import math
import struct
from collections.abc import Callable, Mapping, Sequence
from ctypes import CFUNCTYPE, addressof, c_char, c_char_p, c_int64
from typing import Any

import numpy as np

from ..compiler.kernel import Kernel
from ..compiler.llvm.machine import Code, compiled, lanes
from ..compiler.llvm.nest import HEAD, NAME, Entry, module_text
from ..mechanism.constants import double_constants, limit_of
from ..mechanism.names import LENGTHS
from ..mechanism.own_lines import not_extended
from ..mechanism.program import Variant
from ..support.forks import ForkSafeLock
from ..support.recent import Recent
from ..support.signals import finished
from .kernels import (
    REACH,
    SPARE,
    KernelKey,
    all_have_wide_margins,
    has_near_limit,
    kernel_of,
    wide_margins_of,
)
from .threads import HEAVY, LEAST_BLOCK, LEAST_LIGHT_BLOCK, LONGEST_BLOCK, run_parts

MOST_KEPT = 256  # kernels that nobody else keeps
AT_A_TIME = 2**20  # points that are answered again
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
        arrays = len(self.arguments) + len(kernel.outputs)
        self._pack_steps = struct.Struct(f"{arrays}q").pack
        self._pack_arrays = struct.Struct(f"{arrays + len(self._tables) + 2 * len(self.given)}q").pack
        self._pack_lengths = struct.Struct(f"{kernel.axes + len(self.given)}q").pack

    def data(self, values: Mapping[str, Any], repair: int = 0, clear: int = 0) -> bytes:
        """The packed numbers of a call; `repair` and `clear` are addresses of functions (see `HEAD`)."""
        return self._pack_data(repair, clear, *[values[name] for name in self.scalars])

    def run(self, values: Mapping[str, Any], outs: Sequence[Any]) -> int:
        """Fill `outs`, arrays over the axes; return how many points are left (see `settle`)."""
        arrays = [*[values[name] for name in self.arguments], *outs]
        steps = [array.strides[-1] for array in arrays]
        lengths = [*outs[0].shape]
        arrays += [np.empty([lengths[axis] for axis in along]) for along in self._tables]
        for table in self.given:
            arrays += [values[f"{table}_x"], values[f"{table}_c"]]
            lengths.append(values[f"{table}_x"].size)
        packed = self._pack_arrays(*_addresses(arrays)), self._pack_lengths(*lengths)
        return self.call(*packed, self._pack_steps(*steps), self.data(values))


def _addresses(arrays: Sequence[Any]) -> list[int]:
    """The addresses of arrays by the fastest way; read-only and strided ones take the slow one."""
    try:
        return [addressof(_bytes_of(array)) for array in arrays]
    except (TypeError, ValueError, BufferError):
        return [array.__array_interface__["data"][0] for array in arrays]


_LOCK = ForkSafeLock()
_KEPT: Recent[KernelKey, CompiledKernel] = Recent(MOST_KEPT)


def is_ready(key: KernelKey) -> bool:
    """True if the kernel of a key is compiled."""
    return key in _KEPT


def kernel_for(key: KernelKey) -> CompiledKernel:
    """The kernel of a key, compiled now unless it is kept."""
    result = _KEPT.get(key)
    if result is None:
        result = _KEPT[key] = finished(lambda: _compiled(key))
    return result


def _compiled(key: KernelKey) -> CompiledKernel:
    """Compile a key; several threads that want the same wait for the first."""
    with _LOCK:
        return _KEPT.get(key) or compiled_kernel(key)


def compiled_kernel(key: KernelKey, arguments: Sequence[str] | None = None) -> CompiledKernel:
    """Compile a key's kernel for one owner; `arguments` orders the inputs that are arrays."""
    written_out = key.accuracy != "extended" and not key.far
    angle = "theta" if written_out and "theta" in dict(key.axis_of) else None
    return CompiledKernel(kernel_of(key), arguments, angle, limit_of(key.accuracy))


# ---- blocks, and points that are left over -------------------------------------------------------------


def run_in_blocks(
    key: KernelKey, values: Mapping[str, Any], outs: Sequence[Any], threads: int | None
) -> None:
    """Run the kernel of a key over its outermost axis in as many blocks as there are threads."""
    kernel = kernel_for(key)
    heavy = key.accuracy == "extended" or len(outs) >= HEAVY
    least = LEAST_BLOCK if heavy else LEAST_LIGHT_BLOCK
    if outs[0].size < 2 * least:  # too few for a second thread
        _run(kernel, key, values, outs)
        return
    outer = {name for name, axis in key.axis_of if axis == 0}

    def block(start: int, stop: int) -> None:
        part = {name: v[start:stop] if name in outer else v for name, v in values.items()}
        _run(kernel, key, part, [out[start:stop] for out in outs])

    length = outs[0].shape[0]
    row = outs[0].size // length  # points of one step along the axis
    run_parts(block, length, threads, max(1, least // row), max(1, LONGEST_BLOCK // row))


def have_wide_margins(form: Variant, ec: Any, AB: Any, BC: Any) -> bool:
    """True if all designs of these columns have wide margins."""
    columns = dict(zip(LENGTHS, (ec, AB, BC), strict=True))
    if not ec.size or all_have_wide_margins(form, **columns):
        return bool(ec.size)
    wide = np.empty(ec.size, np.int8)
    key = KernelKey(*wide_margins_of(form), tuple((name, 0) for name in sorted(LENGTHS)), 1)
    run_in_blocks(key, columns, [wide], 1)
    return bool(wide.all())


def _run(kernel: CompiledKernel, key: KernelKey, values: Mapping[str, Any], outs: Sequence[Any]) -> None:
    """Run a kernel, and answer the points that it leaves over."""
    if kernel.run(values, outs):
        settle(key, values, outs)


def settle(key: KernelKey, values: Mapping[str, Any], outs: Sequence[Any]) -> None:
    """Answer again the points that a call of a key's kernel has left, a million at a time."""
    outer = {name for name, axis in key.axis_of if axis == 0}
    step = max(1, AT_A_TIME * len(outs[0]) // max(1, outs[0].size))
    for start in range(0, len(outs[0]), step):
        part = slice(start, start + step)
        here = {name: value[part] if name in outer else value for name, value in values.items()}
        _settle(key, here, [out[part] for out in outs])


def _settle(key: KernelKey, values: Mapping[str, Any], outs: Sequence[Any]) -> None:
    theta, axis = np.abs(values.get("theta", 0.0)), dict(key.axis_of).get("theta")
    if axis is not None:
        theta = theta.reshape([-1 if k == axis else 1 for k in range(key.axes)])
    if has_near_limit(key) and not not_extended(key.form.own):
        reach, unsure = (np.empty(outs[0].shape) for _ in REACH)
        kernel_for(key._replace(names=REACH, form=key.form._replace(under=None))).run(values, [reach, unsure])
        undecided = (np.abs(reach) <= SPARE * unsure) & (unsure > 0.0)  # where that is 0, the reach is exact
        undecided &= theta <= double_constants().limit  # not all angles can be reduced as well
        _answer_again(key._replace(accuracy="extended", far=False), values, outs, undecided)
    if axis is not None and not key.far and key.accuracy != "extended":
        large = np.broadcast_to((theta > limit_of(key.accuracy)) & (theta < np.inf), outs[0].shape)
        _answer_again(key._replace(far=True), values, outs, large)


def _answer_again(key: KernelKey, values: Mapping[str, Any], outs: Sequence[Any], mask: Any) -> None:
    """Compute some of the points by the kernel of another key."""
    places = np.nonzero(mask)
    if not places[0].size:
        return
    axis_of = dict(key.axis_of)
    key = key._replace(axis_of=tuple((name, 0) for name in sorted(axis_of)), axes=1)
    chosen = {n: value[places[axis_of[n]]] if n in axis_of else value for n, value in values.items()}
    answers = [np.empty(places[0].size, out.dtype) for out in outs]
    if kernel_for(key).run(chosen, answers) and key.far:
        settle(key, chosen, answers)
    for out, answer in zip(outs, answers, strict=True):
        out[places] = answer
