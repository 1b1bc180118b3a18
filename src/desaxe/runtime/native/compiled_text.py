"""From a text to machine code: numba compiles it, LLVM optimises all of its functions at once."""

import gc
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from importlib.util import find_spec
from typing import Any

from ...support.forks import IMPORTS, imported
from .machine_code import DOUBLE, ENTRY, NO_MEMORY, WHOLE, Loaded, StoredCode, outside

NAME = "desaxe_native"  # of the module of a text
# A text that sets it to True has loops of a few rounds that should run in vectors: LLVM unrolls such loops
# before it looks for vectors.
SHORT_LOOPS = "short_loops"
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


@contextmanager
def _collected_later() -> Iterator[None]:
    """Pause the collector of garbage: it would go through numba's many objects again and again."""
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collects:
            gc.enable()


@_collected_later()
def compile_text(text: str, title: str, scope: Mapping[str, Any]) -> StoredCode | Loaded:
    """Compile a text that defines `function` and `signature`; loaded at once if it is not self-contained.

    `scope` has names that the text uses and does not define, such as a user's own function.
    """
    with IMPORTS:
        import llvmlite.binding as llvm

    compiler, registry, sigutils, types = (
        imported(f"numba.core.{name}") for name in ("compiler", "registry", "sigutils", "types")
    )
    lock = imported("numba.core.compiler_lock").global_compiler_lock
    _load_arrays()
    with IMPORTS:
        from .parts import PartTarget, link_parts, searched_once
    namespace = {"__name__": NAME, **scope}
    with lock, searched_once():
        exec(compile(text, f"<desaxe {title}>", "exec"), namespace)
        target, flags = registry.cpu_target, compiler.Flags()
        options = {"nopython": True, "error_model": "numpy", "nogil": True}
        wrappers = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
        target.options.parse_as_flags(flags, options | wrappers)
        flags.no_compile = True  # numba's own copy would never be called
        given, answer = sigutils.normalize_signature(namespace["signature"])
        parts = PartTarget(target)
        for helper in namespace.values():
            if getattr(helper, "__module__", None) == NAME and hasattr(helper, "_compiler"):
                helper._compiler.targetdescr = parts
                helper._compiler.pipeline_class = parts.pipeline
        context = parts.typing_context, parts.target_context
        function = namespace["function"]
        made = compiler.compile_extra(*context, function, given, answer, flags, {}, None, parts.pipeline)
        library = made.library
        link_parts(library)
        ranks = tuple(
            kind.ndim if isinstance(kind, types.Array) else DOUBLE if kind == types.float64 else WHOLE
            for kind in given
        )
        entry = llvm.parse_assembly(_entry(made.fndesc.mangled_name, given, ranks))
        kinds = zip(given, ranks, strict=True)
        sizes = tuple(kind.dtype.bitwidth // 8 if rank >= 0 else 8 for kind, rank in kinds)
        alone = _alone(library, entry, namespace.get(SHORT_LOOPS, False))
        if alone is not None:
            return StoredCode(ranks, sizes, alone)
        return Loaded(_within(target, library, entry), ranks, sizes, library)


@cache
def _load_arrays() -> None:
    """Import numba's arrays without SciPy's BLAS, which numba imports to see whether it is there."""
    linalg: Any = imported("numba.np.linalg")
    imports_it = linalg.ensure_blas

    def ensure_blas() -> None:
        if find_spec("scipy") is None:
            imports_it()  # raises the ImportError that numba expects

    linalg.ensure_blas = ensure_blas
    try:
        imported("numba.np.arraymath")
    finally:
        linalg.ensure_blas = imports_it


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
            # what is called is inlined, and has the widest vectors only if this has them
            f'define i64 @{ENTRY}({taken}) "prefer-vector-width"="512" {{',
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


def _alone(library: Any, entry: Any, short_loops: bool) -> bytes | None:
    """The machine code of a library and an entry; None if it calls functions that we cannot provide."""
    module = optimised(library, entry, short_loops)
    called = [f.name for f in module.functions if f.is_declaration and not f.name.startswith("llvm.")]
    if not set(called) <= set(outside()):
        return None
    found: bytes = library.codegen._tm.emit_object(module)
    return found


def optimised(library: Any, entry: Any, short_loops: bool) -> Any:
    """The LLVM module of a library, of an entry and of what numba's runtime would do."""
    with IMPORTS:
        import llvmlite.binding as llvm

    module = library._final_module.clone()
    module.link_in(entry, preserve=True)
    support = llvm.parse_assembly(_SUPPORT)
    support.data_layout, support.triple = module.data_layout, module.triple
    module.link_in(support)
    for function in module.functions:
        if not function.is_declaration and function.name != ENTRY:
            function.linkage = "internal"
    codegen = library.codegen
    for how in ({"cost": "cheap", "opt": 0, "loop_vectorize": False, "slp_vectorize": False}, {}):
        passes, builder = codegen._module_pass_manager(**how)  # the two rounds of numba's own
        if short_loops and not how:
            options = llvm.create_pipeline_tuning_options(speed_level=3)
            options.loop_unrolling, options.slp_vectorization = False, False
            builder = llvm.create_pass_builder(codegen._tm, options)
            passes = builder.getModulePassManager()
            passes.add_refprune_pass()
        passes.add_global_dead_code_eliminate_pass()
        passes.add_strip_dead_prototype_pass()
        passes.run(module, builder)
    return module


def _within(target: Any, library: Any, entry: Any) -> int:
    """The entry address of a library that only numba can load."""
    whole = target.target_context.codegen().create_library("desaxe_entry")
    whole.add_linking_library(library)
    whole.add_llvm_module(entry)
    whole.finalize()
    _KEPT.append(whole)
    address: int = whole.get_pointer_to_function(ENTRY)
    return address


_KEPT: list[Any] = []  # what belongs to numba's engine lives as long as the process
