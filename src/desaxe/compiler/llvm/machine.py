"""Machine code from LLVM's text: optimised for one processor, linked in memory, owned by whoever calls it.

LLVM is called by one thread at a time, and never while the process forks: a child would inherit a lock that
nobody holds. So a fork waits for this lock and for that of llvmlite, which compilations by numba hold, too.
"""

import ctypes
import math
import platform
import sys
import time
from collections import deque
from functools import cache
from itertools import count
from threading import RLock
from typing import Any

from ...support.forks import IMPORTS, ForkSafeLock, acquired_last

MATHEMATICS = ("asin", "atan2", "cos", "exp", "floor", "fma", "log", "nextafter", "pow", "sin")
MEMORY = ("memmove", "memset")


class _LlvmliteLock:
    """The lock that llvmlite holds during each call; a fork waits for it once imports have ended."""

    def __init__(self) -> None:
        self._acquired: Any = None

    def acquire_until(self, end: float) -> bool:
        """Try to acquire it until some time of the monotonic clock; False as long as it does not exist."""
        library = _library()
        if library is None or not library._lock._lock.acquire(timeout=max(end - time.monotonic(), 0.0)):
            return False
        self._acquired = library._lock._lock
        return True

    def release(self) -> None:
        """Release it after a fork."""
        self._acquired.release()

    def renew(self) -> None:
        """In a child: free it of a thread that is not there."""
        library = _library()
        if library is not None:
            library._lock._lock = RLock()


def _library() -> Any:
    """The library of llvmlite; None before and during its import."""
    return getattr(sys.modules.get("llvmlite.binding.ffi"), "lib", None)


LOCK = ForkSafeLock()
acquired_last(_LlvmliteLock())
_UNUSED: deque[Any] = deque()


class Code:
    """Machine code in memory, which stays there as long as this object: its address."""

    __slots__ = ("__weakref__", "_tracker", "address")

    def __init__(self, tracker: Any, name: str) -> None:
        self._tracker = tracker
        self.address: int = tracker[name]

    def __del__(self, unused: deque[Any] = _UNUSED) -> None:  # at exit the module's names are gone
        unused.append(self._tracker)  # a collection of garbage must not wait for LLVM


_NUMBERS = count()


def compiled(text: str, name: str, optimised: bool = False) -> Code:
    """The function of this name of a text, as machine code for this processor."""
    with LOCK:
        return _linked(emitted(text, optimised=optimised), name)


def emitted(text: str, target: Any = None, optimised: bool = False) -> bytes:
    """The object file of a text, for a processor (see `target_machine`); this one without.

    Kernels have vectors and no value twice: there LLVM's passes would find nothing, and take as long as all
    the rest.
    """
    llvm = _llvm()
    with LOCK:
        target = target or _host()
        module = llvm.parse_assembly(text, llvm.create_context())
        module.triple, module.data_layout = target.triple, str(target.target_data)
        module.verify()
        if optimised:
            _optimise(module, target)
        data: bytes = target.emit_object(module)
        return data


def _optimise(module: Any, target: Any) -> None:
    """Run LLVM's passes; short loops are not unrolled, which would come before the search for vectors."""
    llvm = _llvm()
    options = llvm.create_pipeline_tuning_options(speed_level=3)
    options.loop_unrolling, options.slp_vectorization = False, False
    builder = llvm.create_pass_builder(target, options)
    builder.getModulePassManager().run(module, builder)


@cache
def lanes() -> int:
    """The number of doubles in a vector of this processor's code."""
    llvm = _llvm()
    with LOCK:
        return 8 if llvm.get_host_cpu_features().get("avx512f") else 4


def target_machine(triple: str | None = None, cpu: str = "", features: str = "") -> Any:
    """LLVM's description of a processor: of this one, or by names, the plainest of a triple."""
    llvm = _llvm()
    with LOCK:
        llvm.initialize_all_targets() if triple else llvm.initialize_native_target()
        llvm.initialize_all_asmprinters() if triple else llvm.initialize_native_asmprinter()
        triple = triple or _triple()
        # There code is far from all else: without a table of offsets, which the linker has not.
        relocation = "static" if "windows" in triple else "default"
        target = llvm.Target.from_triple(triple)
        return target.create_target_machine(cpu=cpu, features=features, opt=3, reloc=relocation)


def _triple() -> str:
    """The system's triple; its linker in memory takes ELF alone on Windows."""
    triple: str = _llvm().get_process_triple()
    return f"{triple}-elf" if sys.platform == "win32" else triple


@cache
def _llvm() -> Any:
    with IMPORTS:
        import llvmlite.binding

    return llvmlite.binding


@cache
def _host() -> Any:
    llvm = _llvm()
    return target_machine(None, llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten())


@cache
def _linker() -> Any:
    """LLVM's linker in memory, of which a process has one."""
    arm = platform.machine().lower() in ("arm64", "aarch64")
    return _llvm().create_lljit_compiler(use_jit_link=arm)


def _linked(data: bytes, name: str) -> Code:
    while _UNUSED:
        _UNUSED.pop().close()
    library = _llvm().JITLibraryBuilder().add_object_img(data).export_symbol(name)
    for symbol, address in outside().items():
        library.import_symbol(symbol, address)
    try:
        return Code(library.link(_linker(), f"desaxe {next(_NUMBERS)}"), name)
    except RuntimeError as error:
        raise RuntimeError(
            f"machine code cannot be loaded: {error}. desaxe needs memory that a process may write and then "
            "run; a system that refuses it (SELinux's execmem, MemoryDenyWriteExecute) has to allow it"
        ) from None


@cache
def outside() -> dict[str, int]:
    """The addresses of the functions that machine code may call, by name."""
    library = ctypes.CDLL("ucrtbase" if sys.platform == "win32" else getattr(math, "__file__", None))
    functions = {name: getattr(library, name) for name in MATHEMATICS}
    functions |= {name: getattr(ctypes, name) for name in MEMORY}
    functions["memcpy"] = ctypes.memmove
    if sys.platform == "win32":
        functions["__chkstk"] = getattr(ctypes.WinDLL("ntdll"), "__chkstk")
    return {name: ctypes.cast(function, ctypes.c_void_p).value or 0 for name, function in functions.items()}
