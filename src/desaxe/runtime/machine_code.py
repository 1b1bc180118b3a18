"""Self-contained machine code: made once by numba, later loaded by llvmlite alone.

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
from collections.abc import Mapping
from contextlib import suppress
from functools import cache
from importlib import import_module
from typing import Any, NamedTuple

from ..support.forks import wait_first

ENTRY = "desaxe_entry"
NO_MEMORY = -1
DOUBLE, WHOLE = -1, -2  # the ranks of numbers
MATHEMATICS = (
    "asin", "atan2", "cos", "exp", "floor", "floorf", "fmod", "frexp", "log", "nextafter", "pow", "sin",
    "sqrt", "sqrtf",
)  # fmt: skip
MEMORY = ("PyMem_RawMalloc", "PyMem_RawFree")
# What numba's runtime would do for our texts. A view of another shape is only taken of contiguous arrays.
_SUPPORT = """
declare ptr @PyMem_RawMalloc(i64)
declare void @PyMem_RawFree(ptr)
declare double @frexp(double, ptr)
declare double @nextafter(double, double)

define ptr @NRT_MemInfo_alloc_aligned(i64 %size, i32 %align) {
  %wide = zext i32 %align to i64
  %head = add i64 %wide, 64
  %room = add i64 %size, %head
  %block = call ptr @PyMem_RawMalloc(i64 %room)
  %none = icmp eq ptr %block, null
  br i1 %none, label %end, label %fill
fill:
  %start = ptrtoint ptr %block to i64
  %past = add i64 %start, %head
  %down = sub i64 0, %wide
  %place = and i64 %past, %down
  %data = inttoptr i64 %place to ptr
  store i64 1, ptr %block
  %dtor = getelementptr i64, ptr %block, i64 1
  store ptr null, ptr %dtor
  %info = getelementptr i64, ptr %block, i64 2
  store ptr null, ptr %info
  %field = getelementptr i64, ptr %block, i64 3
  store ptr %data, ptr %field
  %length = getelementptr i64, ptr %block, i64 4
  store i64 %size, ptr %length
  br label %end
end:
  ret ptr %block
}

define void @NRT_MemInfo_call_dtor(ptr %block) {
  call void @PyMem_RawFree(ptr %block)
  ret void
}

define i32 @numba_attempt_nocopy_reshape(i64 %nd, ptr %dims, ptr %strides, i64 %newnd, ptr %newdims,
                                         ptr %newstrides, i64 %itemsize, i32 %fortran) {
  br label %next
next:
  %left = phi i64 [ %newnd, %0 ], [ %k, %body ]
  %stride = phi i64 [ %itemsize, %0 ], [ %more, %body ]
  %done = icmp eq i64 %left, 0
  br i1 %done, label %end, label %body
body:
  %k = sub i64 %left, 1
  %place = getelementptr i64, ptr %newstrides, i64 %k
  store i64 %stride, ptr %place
  %length = getelementptr i64, ptr %newdims, i64 %k
  %count = load i64, ptr %length
  %more = mul i64 %stride, %count
  br label %next
end:
  ret i32 1
}

define double @numba_frexp(double %x, ptr %exponent) {
  %part = call double @frexp(double %x, ptr %exponent)
  ret double %part
}

define double @numba_nextafter(double %x, double %y) {
  %next = call double @nextafter(double %x, double %y)
  ret double %next
}
"""


class Code(NamedTuple):
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
    import llvmlite
    import llvmlite.binding as llvm

    features = ",".join(sorted(llvm.get_host_cpu_features().flatten().split(",")))
    return f"llvmlite {llvmlite.__version__}, {llvm.get_host_cpu_name()}, {features}"


# ---- making --------------------------------------------------------------------------------------


def compile_text(text: str, title: str, scope: Mapping[str, Any]) -> Code | Loaded:
    """Compile a text that defines `function` and `signature`; loaded at once if it is not self-contained.

    `scope` has names that the text uses and does not define, such as a user's own function.
    """
    wait_first()
    import llvmlite.binding as llvm

    compiler, registry, sigutils, types = (
        import_module(f"numba.core.{name}") for name in ("compiler", "registry", "sigutils", "types")
    )
    lock = import_module("numba.core.compiler_lock").global_compiler_lock
    namespace = {"__name__": "desaxe_native", **scope}
    with lock:
        exec(compile(text, f"<desaxe {title}>", "exec"), namespace)
        target, flags = registry.cpu_target, compiler.Flags()
        options = {"nopython": True, "error_model": "numpy", "nogil": True}
        wrappers = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
        target.options.parse_as_flags(flags, options | wrappers)
        flags.no_compile = True  # numba's own copy would never be called
        given, answer = sigutils.normalize_signature(namespace["signature"])
        context = target.typing_context, target.target_context
        made = compiler.compile_extra(*context, namespace["function"], given, answer, flags, {})
        library = made.library
        library._ensure_finalized()
        ranks = tuple(
            kind.ndim if isinstance(kind, types.Array) else DOUBLE if kind == types.float64 else WHOLE
            for kind in given
        )
        entry = llvm.parse_assembly(_entry(made.fndesc.mangled_name, given, ranks))
        kinds = zip(given, ranks, strict=True)
        sizes = tuple(kind.dtype.bitwidth // 8 if rank >= 0 else 8 for kind, rank in kinds)
        alone = _alone(library, entry)
        if alone is not None:
            return Code(ranks, sizes, alone)
        return Loaded(_within(library, entry), ranks, sizes, library)


def _entry(name: str, given: tuple[Any, ...], ranks: tuple[int, ...]) -> str:
    """The LLVM text of the entry: it unpacks the table into the arguments of numba's convention.

    That is a pointer for the answer and one for an error, then each number, and of each array (meminfo,
    parent, size, itemsize, data, shape, strides). A status is returned; -2 is an answer of None.
    """
    rows, passed = [], ["ptr %answer", "ptr %error"]
    word = 0
    bare = all(rank == WHOLE for rank in ranks)
    taken = ", ".join(f"i64 %a{k}" for k in range(len(ranks))) if bare else "ptr %table"

    def read(kind: str) -> str:
        nonlocal word
        rows.append(f"  %p{word} = getelementptr i64, ptr %table, i64 {word}")
        rows.append(f"  %w{word} = load {kind}, ptr %p{word}")
        word += 1
        return f"{kind} %w{word - 1}"

    for type_, rank in zip(given, ranks, strict=True):
        if bare:
            passed.append(f"i64 %a{len(passed) - 2}")
        elif rank < 0:
            passed.append(read("double" if rank == DOUBLE else "i64"))
        else:
            data, *sides = read("ptr"), *(read("i64") for _ in range(2 * rank))
            size = "1"
            for side in sides[:rank]:
                length = side.removeprefix("i64 ")
                rows.append(f"  %n{len(rows)} = mul i64 {size}, {length}")
                size = f"%n{len(rows) - 1}"
            item = type_.dtype.bitwidth // 8
            passed += ["ptr null", "ptr null", f"i64 {size}", f"i64 {item}", data, *sides]
    kinds = ", ".join(argument.split()[0] for argument in passed)
    return "\n".join(
        [
            f"declare i32 @{_quoted(name)}({kinds})",
            f"define i64 @{ENTRY}({taken}) {{",
            "  %answer = alloca i64",
            "  %error = alloca ptr",
            "  store i64 0, ptr %answer",
            *rows,
            f"  %status = call i32 @{_quoted(name)}({', '.join(passed)})",
            "  %given = load i64, ptr %answer",
            "  %whole = icmp eq i32 %status, 0",
            "  %none = icmp eq i32 %status, -2",
            "  %fine = or i1 %whole, %none",
            f"  %result = select i1 %fine, i64 %given, i64 {NO_MEMORY}",
            "  ret i64 %result",
            "}",
        ]
    )


def _quoted(name: str) -> str:
    return f'"{name}"'


def _alone(library: Any, entry: Any) -> bytes | None:
    """The machine code of a library and an entry; None if it calls functions that we cannot provide."""
    import llvmlite.binding as llvm

    module = llvm.parse_assembly(library.get_llvm_str())
    module.link_in(entry, preserve=True)
    support = llvm.parse_assembly(_SUPPORT)
    support.data_layout, support.triple = module.data_layout, module.triple
    module.link_in(support)
    for function in module.functions:
        if not function.is_declaration and function.name != ENTRY:
            function.linkage = "internal"
    target = library.codegen._tm
    passes = llvm.create_new_module_pass_manager()
    passes.add_global_dead_code_eliminate_pass()
    passes.add_strip_dead_prototype_pass()
    passes.run(module, llvm.create_pass_builder(target, llvm.create_pipeline_tuning_options()))
    outside = [f.name for f in module.functions if f.is_declaration and not f.name.startswith("llvm.")]
    found: bytes | None = target.emit_object(module) if set(outside) <= set(_outside()) else None
    return found


def _within(library: Any, entry: Any) -> int:
    """The entry address of a library that only numba can load."""
    whole = library.codegen.create_library("desaxe_entry")
    whole.add_linking_library(library)
    whole.add_llvm_module(entry)
    whole.finalize()
    _KEPT.append(whole)
    address: int = whole.get_pointer_to_function(ENTRY)
    return address


_KEPT: list[Any] = []  # what belongs to numba's engine lives as long as the process


# ---- loading -------------------------------------------------------------------------------------


@cache
def _outside() -> dict[str, int]:
    """Addresses of the functions that machine code may call: those that this Python is linked with."""
    found: dict[str, int] = {}
    with suppress(AttributeError, OSError, TypeError):
        mathematics = ctypes.CDLL(getattr(math, "__file__", None))
        for library, names in ((mathematics, MATHEMATICS), (ctypes.pythonapi, MEMORY)):
            places = {name: ctypes.cast(getattr(library, name), ctypes.c_void_p).value for name in names}
            found |= {name: place for name, place in places.items() if place}
    return found


@cache
def _target() -> Any:
    """The LLVM target with the external functions registered: calling an unknown one would crash."""
    import llvmlite.binding as llvm

    for name, place in _outside().items():
        llvm.add_symbol(name, place)
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    return llvm.Target.from_default_triple()


def load(code: Code) -> Loaded | None:
    """Load machine code; None if this process cannot."""
    import llvmlite.binding as llvm

    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), _target().create_target_machine())
    engine.add_object_file(llvm.object_file.ObjectFileRef.from_data(code.machine))
    engine.finalize_object()
    address = engine.get_function_address(ENTRY)
    return Loaded(address, code.ranks, code.item_sizes, engine) if address else None
