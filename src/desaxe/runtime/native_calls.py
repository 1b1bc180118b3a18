"""A kernel with its numbers, as a NumPy ufunc, as a C function of one point, and as a function for numba."""

import ctypes
import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import cache
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiler.llvm.machine import compiled
from ..mechanism.names import STATUSES
from ..support.forks import imported
from ..support.signals import finished
from .executor import CompiledKernel, compiled_kernel, settle
from .kernels import KernelKey

Array = NDArray[Any]
DOUBLE, BYTE = 12, 1  # NumPy's numbers of these types
NO_IDENTITY = -1


class Bound(NamedTuple):
    """The addresses of a kernel and of the numbers of its calls, and what keeps both alive."""

    loop: int
    data: int
    kept: Any


def bind(key: KernelKey, numbers: Mapping[str, float], inputs: Sequence[str], repair: Any) -> Bound:
    """A kernel of these inputs, in their order, which calls `repair` where it leaves points over."""
    return bind_kernel(finished(lambda: compiled_kernel(key, inputs)), numbers, repair)


def bind_kernel(kernel: CompiledKernel, numbers: Mapping[str, float], repair: Any = None) -> Bound:
    """A kernel with the numbers among its inputs."""
    address = 0 if repair is None else ctypes.cast(repair, ctypes.c_void_p).value or 0
    packed = kernel.data(numbers, address, _clear_flags())
    data = ctypes.create_string_buffer(packed, len(packed))
    return Bound(kernel.code.address, ctypes.addressof(data), (kernel, repair, data))


@cache
def _clear_flags() -> int:
    """The address of the C library's `feclearexcept`; 0 if it has none."""
    with suppress(AttributeError, OSError, TypeError):
        library = ctypes.CDLL(getattr(math, "__file__", None))
        return ctypes.cast(library.feclearexcept, ctypes.c_void_p).value or 0
    return 0


@cache
def _new_ufunc() -> Callable[..., Any]:
    """NumPy's `PyUFunc_FromFuncAndData`."""
    try:
        core = imported("numpy._core._multiarray_umath")
    except ModuleNotFoundError:  # NumPy 1
        core = imported("numpy.core._multiarray_umath")
    take = ctypes.pythonapi.PyCapsule_GetPointer
    take.restype, take.argtypes = ctypes.c_void_p, (ctypes.py_object, ctypes.c_char_p)
    table = take(core._UFUNC_API, None)
    address = ctypes.c_void_p.from_address(int(table or 0) + ctypes.sizeof(ctypes.c_void_p)).value
    pointer, whole = ctypes.c_void_p, ctypes.c_int
    kinds = (pointer, pointer, pointer, *[whole] * 4, pointer, pointer, whole)
    return ctypes.PYFUNCTYPE(ctypes.py_object, *kinds)(address or 0)


def most_arguments() -> int:
    """The largest number of inputs and outputs of a ufunc."""
    return 32 if imported("numpy").__version__.startswith("1.") else 64


def ufunc_of(bound: Bound, inputs: int, whole: Sequence[bool], name: str) -> tuple[Any, Any]:
    """A ufunc that runs a bound kernel, and the objects to keep alive; `whole` flags the int8 outputs.

    More arguments than a ufunc can have go to a function that does the same for plain arrays.
    """
    if inputs + len(whole) > most_arguments():
        return _wide(bound, whole), bound
    types = bytes([DOUBLE] * inputs + [BYTE if kind else DOUBLE for kind in whole])
    loops, data = (ctypes.c_void_p * 1)(bound.loop), (ctypes.c_void_p * 1)(bound.data)
    texts = [ctypes.create_string_buffer(text) for text in (types, name.encode(), b"")]
    parts: tuple[Any, ...] = (loops, data, *texts)
    starts = [ctypes.addressof(part) for part in parts]
    ufunc = _new_ufunc()(*starts[:3], 1, inputs, len(whole), NO_IDENTITY, *starts[3:], 0)
    return ufunc, (bound, parts)


def _wide(bound: Bound, whole: Sequence[bool]) -> Callable[..., Any]:
    """A Python function with the ufunc's behaviour, for more arguments than a ufunc can have."""
    loop = ctypes.CFUNCTYPE(ctypes.c_int64, *[ctypes.c_void_p] * 4)(bound.loop)

    def call(*args: Any, out: Sequence[Any] | None = None) -> tuple[Any, ...]:
        columns = np.broadcast_arrays(*(np.asarray(a, dtype=np.float64) for a in args))
        results = [np.empty(columns[0].shape, np.int8 if kind else np.float64) for kind in whole]
        every = [np.ascontiguousarray(a).reshape(-1) for a in (*columns, *results)]
        numbers = ([a.ctypes.data for a in every], [every[0].size], [a.itemsize for a in every])
        loop(*((ctypes.c_int64 * len(row))(*row) for row in numbers), bound.data)
        if out is None:
            return tuple(values[()] for values in results)
        for array, values in zip(out, results, strict=True):
            np.copyto(array, values, casting="same_kind")
        return tuple(out)

    return call


class PointCaller(NamedTuple):
    """The address of a C function of one point, and what keeps it alive."""

    address: int
    kept: Any


def point_caller(bound: Bound, inputs: int, whole: Sequence[bool]) -> PointCaller:
    """`int64_t f(const double *inputs, double *outputs)`, one point of a bound kernel.

    A status is told as a double.
    """
    slots = [("%in", k, 8) for k in range(inputs)]
    slots += [("%bytes", k, 1) if byte else ("%out", k, 8) for k, byte in enumerate(whole)]
    rows = [
        f"%args = alloca [{len(slots)} x ptr]",
        f"%steps = alloca [{len(slots)} x i64]",
        "%size = alloca i64",
        f"%bytes = alloca [{len(whole)} x i8]",
        "store i64 1, ptr %size",
    ]
    for k, (base, index, size) in enumerate(slots):
        rows += [
            f"%p{k} = getelementptr i8, ptr {base}, i64 {index * size}",
            f"%a{k} = getelementptr ptr, ptr %args, i64 {k}",
            f"store ptr %p{k}, ptr %a{k}",
            f"%s{k} = getelementptr i64, ptr %steps, i64 {k}",
            f"store i64 {size}, ptr %s{k}",
        ]
    rows += [
        f"%loop = inttoptr i64 {bound.loop} to ptr",
        f"%data = inttoptr i64 {bound.data} to ptr",
        "call void %loop(ptr %args, ptr %size, ptr %steps, ptr %data)",
    ]
    for k in [k for k, byte in enumerate(whole) if byte]:
        rows += [
            f"%b{k} = load i8, ptr %p{inputs + k}",
            f"%d{k} = sitofp i8 %b{k} to double",
            f"%o{k} = getelementptr double, ptr %out, i64 {k}",
            f"store double %d{k}, ptr %o{k}",
        ]
    body = "\n".join(f"  {row}" for row in [*rows, "ret i64 0"])
    code = finished(lambda: compiled(f"define i64 @point(ptr %in, ptr %out) {{\n{body}\n}}", "point"))
    return PointCaller(code.address, (code, bound))


def scalar_of(address: int, inputs: Sequence[str], outputs: int, one: bool, owner: Any) -> Any:
    """A function of numbers that numba can call: the C function at an address, whose `owner` is kept."""
    numba = imported("numba")
    types, ir, cgutils = numba.types, imported("llvmlite.ir"), imported("numba.core.cgutils")
    double, whole = ir.DoubleType(), ir.IntType(64)

    def point(typingctx: Any, values: Any) -> Any:
        def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            places = [cgutils.alloca_once(builder, double, size=n) for n in (len(inputs), outputs)]
            for k in range(len(inputs)):
                index = ir.Constant(whole, k)
                builder.store(builder.extract_value(args[0], k), builder.gep(places[0], [index]))
            kind = ir.FunctionType(whole, [double.as_pointer()] * 2).as_pointer()
            builder.call(builder.inttoptr(ir.Constant(whole, address), kind), places)
            found = [builder.load(builder.gep(places[1], [ir.Constant(whole, k)])) for k in range(outputs)]
            return context.make_tuple(builder, signature.return_type, found)

        result = types.UniTuple(types.float64, outputs)
        return result(types.UniTuple(types.float64, len(inputs))), code

    doubles = "".join(f"float({name}), " for name in inputs)
    text = f"def scalar({', '.join(inputs)}):\n    return point(({doubles})){'[0]' if one else ''}\n"
    scope: dict[str, Any] = {"point": imported("numba.extending").intrinsic(point)}
    exec(compile(text, "<desaxe scalar>", "exec"), scope)
    found = numba.njit(error_model="numpy")(scope["scalar"])
    found.owner = owner
    return found


# ---- repair: points that the kernel of a function leaves over ------------------------------------------


Repair = ctypes.CFUNCTYPE(None, ctypes.c_int64, ctypes.c_int64, ctypes.c_int64)


def repair_for(
    key: KernelKey, numbers: Mapping[str, float], inputs: Sequence[str], failures: list[BaseException]
) -> Any:
    """The function that a kernel calls with its arguments if it leaves points over.

    What it raises is appended to `failures`: it cannot pass through the machine code that called.
    """

    def repair(args: int, lengths: int, steps: int) -> None:
        try:
            size = ctypes.c_int64.from_address(lengths).value
            columns, outs = _arrays(args, size, steps, key, inputs)
            settle(key, {**numbers, **columns}, outs)
        except BaseException as error:
            failures.append(error)

    return Repair(repair)


def _arrays(
    args: int, size: int, steps: int, key: KernelKey, inputs: Sequence[str]
) -> tuple[dict[str, Array], list[Array]]:
    """The arguments of the loop as arrays: the inputs of the kernel, and the outputs."""
    count = len(inputs) + len(key.names)
    addresses, strides = ((ctypes.c_int64 * count).from_address(start) for start in (args, steps))
    kinds = ["<f8"] * len(inputs) + ["|i1" if name in STATUSES else "<f8" for name in key.names]
    every = [_array(*row, size) for row in zip(addresses, strides, kinds, strict=True)]
    own = dict(key.axis_of)
    columns = {name: array for name, array in zip(inputs, every, strict=False) if name in own}
    return columns, every[len(inputs) :]


def _array(address: int, stride: int, kind: str, size: int) -> Array:
    """Memory at an address as an array."""
    layout = {"data": (address, False), "shape": (size,), "strides": (stride,), "typestr": kind, "version": 3}
    return np.asarray(SimpleNamespace(__array_interface__=layout))
