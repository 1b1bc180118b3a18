"""Kernels from disk without numba: the machine code that numba made, loaded by llvmlite alone.

Importing numba and filling its tables of types takes many times longer than loading a kernel. So when
a kernel has been compiled, its machine code is kept beside its module, without numba's wrappers for
Python, and the next process calls it through ctypes. This is done only for code that calls nothing
but the C library's mathematics; any other kernel, another CPU or another version of LLVM goes the
ordinary way.

A kernel's native arguments are those of numba's calling convention: a pointer for the answer and one
for an error, then each number, and of each array (meminfo, parent, size, itemsize, data, shape,
strides). Our kernels answer a count or nothing, and raise nothing.
"""

import ctypes
import hashlib
import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

SUFFIX = ".code"
LIBRARY = ("atan2", "cos", "floor", "floorf", "sin", "sqrt", "sqrtf")  # of the C library
Kernel = Callable[..., int]


def _machine() -> dict[str, str]:
    """What machine code depends on."""
    import llvmlite
    import llvmlite.binding as llvm

    features = ",".join(sorted(llvm.get_host_cpu_features().flatten().split(",")))
    return {"llvmlite": llvmlite.__version__, "cpu": llvm.get_host_cpu_name(), "features": features}


def save(dispatcher: Any, module: Path) -> None:
    """Keep the machine code of a kernel that has just been compiled, if it stands alone."""
    from numba import types

    from ._cache import write_bytes

    (compiled,) = dispatcher.overloads.values()
    name = compiled.fndesc.mangled_name
    code = _alone(compiled.library, name)
    if code is None:
        return
    ranks = [given.ndim if isinstance(given, types.Array) else -1 for given in compiled.signature.args]
    head = {"machine": _machine(), "name": name, "ranks": ranks, "sha256": _digest(code)}
    write_bytes(module.with_suffix(SUFFIX), json.dumps(head).encode() + b"\n" + code)


def _alone(library: Any, name: str) -> bytes | None:
    """The machine code of one function of a library; None if it calls more than mathematics."""
    import llvmlite.binding as llvm

    if getattr(library, "_disable_inspection", True):  # from numba's own cache: its text is not there
        return None
    module = llvm.parse_assembly(library.get_llvm_str())
    for function in module.functions:
        if not function.is_declaration and function.name != name:
            function.linkage = "internal"
    target = library.codegen._tm
    passes = llvm.create_new_module_pass_manager()
    passes.add_global_dead_code_eliminate_pass()
    passes.add_strip_dead_prototype_pass()
    passes.run(module, llvm.create_pass_builder(target, llvm.create_pipeline_tuning_options()))
    outside = [f.name for f in module.functions if f.is_declaration and not f.name.startswith("llvm.")]
    found: bytes | None = target.emit_object(module) if set(outside) <= set(LIBRARY) else None
    return found


def load(module: Path) -> Kernel | None:
    """The kernel whose machine code is kept beside a module; None where there is none for this machine."""
    try:
        head, _, code = module.with_suffix(SUFFIX).read_bytes().partition(b"\n")
        told = json.loads(head)
    except (OSError, ValueError):
        return None
    if told.get("machine") != _machine() or told.get("sha256") != _digest(code):
        return None
    mathematics = _mathematics()
    if mathematics is None:
        return None
    import llvmlite.binding as llvm

    for name, place in mathematics.items():  # LLVM ends the process where one that is called lacks
        llvm.add_symbol(name, place)
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    target = llvm.Target.from_default_triple().create_target_machine()
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), target)
    engine.add_object_file(llvm.object_file.ObjectFileRef.from_data(code))
    engine.finalize_object()
    address = engine.get_function_address(told["name"])
    return _function(address, told["ranks"], engine) if address else None


def _digest(code: bytes) -> str:
    return hashlib.sha256(code).hexdigest()


def _mathematics() -> dict[str, int] | None:
    """Where the functions of the C library are, with which Python's `math` is linked; None if unknown."""
    try:
        library = ctypes.CDLL(getattr(math, "__file__", None))
        places = {name: ctypes.cast(getattr(library, name), ctypes.c_void_p).value for name in LIBRARY}
    except (AttributeError, OSError, TypeError):
        return None
    return {name: place for name, place in places.items() if place}


def _function(address: int, ranks: list[int], engine: Any) -> Kernel:
    """The native function as one of Python, which lets go of the GIL."""
    pointer, whole = ctypes.c_void_p, ctypes.c_ssize_t
    kinds: list[Any] = [pointer, pointer]
    for rank in ranks:
        array = [pointer, pointer, whole, whole, pointer, *([whole] * (2 * rank))]
        kinds += [ctypes.c_double] if rank < 0 else array
    native = ctypes.CFUNCTYPE(ctypes.c_int, *kinds)(address)

    def kernel(*arguments: Any) -> int:
        flat: list[Any] = []
        for given, rank in zip(arguments, ranks, strict=True):
            if rank < 0:
                flat.append(given)
            else:
                shape, strides = given.shape, given.strides
                data = given.__array_interface__["data"][0]  # `ctypes.data` takes three times as long
                flat += [None, None, given.size, given.itemsize, data, *shape, *strides]
        answer, error = ctypes.c_void_p(), ctypes.c_void_p()
        native(ctypes.addressof(answer), ctypes.addressof(error), *flat)
        return answer.value or 0

    _ENGINES.append(engine)
    return kernel


_ENGINES: list[Any] = []  # code lives as long as its engine
