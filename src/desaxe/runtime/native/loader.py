"""LLVM as a loader: the processor's name, and machine code made ready to be called.

Importing `llvmlite.binding` takes ten times longer than loading a kernel, for it brings all that building
code needs. So the few functions wanted here are called in llvmlite's library directly, as long as nobody has
imported the binding and the library is of a version whose prototypes are known; else through the binding.
"""

import ctypes
import platform
import sys
import weakref
from collections.abc import Mapping
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any, Protocol

from ...support.forks import IMPORTS, ForkSafeLock

KNOWN = ("0.50.",)  # versions of llvmlite with these prototypes
_FILES = {"darwin": "libllvmlite.dylib", "win32": "llvmlite.dll"}
_TEXT, _PLACE, _WHOLE = ctypes.c_char_p, ctypes.c_void_p, ctypes.c_int
_PROTOTYPES: Mapping[str, tuple[Any, tuple[Any, ...]]] = {
    "AddSymbol": (None, (_TEXT, _PLACE)),
    "ContextCreate": (_PLACE, ()),
    "CreateMCJITCompiler": (_PLACE, (_PLACE, _PLACE, ctypes.c_bool, _PLACE)),
    "CreateObjectFile": (_PLACE, (_TEXT, ctypes.c_size_t)),
    "CreateTargetMachine": (
        _PLACE,
        (_PLACE, _TEXT, _TEXT, _TEXT, _WHOLE, _TEXT, _TEXT, _WHOLE, _WHOLE, _TEXT),
    ),
    "DisposeExecutionEngine": (None, (_PLACE,)),
    "DisposeObjectFile": (None, (_PLACE,)),
    "DisposeString": (None, (_PLACE,)),
    "FinalizeObject": (None, (_PLACE,)),
    "GetDefaultTargetTriple": (None, (_PLACE,)),
    "GetFunctionAddress": (ctypes.c_uint64, (_PLACE, _TEXT)),
    "GetHostCPUFeatures": (_WHOLE, (_PLACE,)),
    "GetHostCPUName": (None, (_PLACE,)),
    "GetTargetFromTriple": (_PLACE, (_TEXT, _PLACE)),
    "InitializeNativeAsmPrinter": (None, ()),
    "InitializeNativeTarget": (None, ()),
    "MCJITAddObjectFile": (None, (_PLACE, _PLACE)),
    "ParseAssembly": (_PLACE, (_PLACE, _TEXT, _PLACE)),
}


class Loader(Protocol):
    """The interface of both ways."""

    def host(self) -> str:
        """The processor's name and its features."""
        ...

    def load(self, code: bytes, entry: str, outside: Mapping[str, int]) -> tuple[int, Any]:
        """The address of an entry of machine code, and an object that keeps the code in memory.

        `outside` has the addresses of the functions that the code may call: LLVM ends the process where one
        is missing.
        """
        ...


LLVM = ForkSafeLock()  # for calls of LLVM, which has a lock of its own, where no other lock of ours is held


@cache
def loader() -> Loader:
    """The quicker way that is open."""
    if "llvmlite.binding" not in sys.modules:
        with suppress(ImportError, OSError, AttributeError):
            return _Direct()
    return _Binding()


class _Engine:
    """LLVM's engine, which owns loaded code."""


class _Direct:
    """llvmlite's library, by its C functions."""

    def __init__(self) -> None:
        with IMPORTS:
            import llvmlite

        if not llvmlite.__version__.startswith(KNOWN):
            raise ImportError(f"llvmlite {llvmlite.__version__}: its prototypes are not known here")
        file = Path(str(llvmlite.__file__)).parent / "binding" / _FILES.get(sys.platform, "libllvmlite.so")
        library = ctypes.PyDLL(str(file))
        self._functions: dict[str, Any] = {}
        for name, (result, arguments) in _PROTOTYPES.items():
            function = getattr(library, f"LLVMPY_{name}")
            function.restype, function.argtypes = result, arguments
            self._functions[name] = function
        self._context = self._call("ContextCreate")
        self._call("InitializeNativeTarget")
        self._call("InitializeNativeAsmPrinter")

    def _call(self, name: str, *arguments: Any) -> Any:
        return self._functions[name](*arguments)

    def _text(self, name: str) -> bytes:
        place = _TEXT()
        self._call(name, ctypes.byref(place))
        text = place.value or b""
        self._call("DisposeString", place)
        return text

    def host(self) -> str:
        """The processor's name and its features."""
        features = ",".join(sorted(self._text("GetHostCPUFeatures").decode().split(",")))
        return f"{self._text('GetHostCPUName').decode()}, {features}"

    def load(self, code: bytes, entry: str, outside: Mapping[str, int]) -> tuple[int, Any]:
        """Load machine code with the addresses of outside functions; see `Loader.load`."""
        for name, place in outside.items():
            self._call("AddSymbol", name.encode(), place)
        error = _TEXT()
        triple = self._text("GetDefaultTargetTriple")
        target = self._call("GetTargetFromTriple", triple, ctypes.byref(error))
        triple += b"-elf" if sys.platform == "win32" else b""  # the only format that MCJIT takes
        how = b"", b"", 2, b"default", b"jitdefault", 0, 0, b""
        machine = self._call("CreateTargetMachine", target, triple, *how)
        module = self._call("ParseAssembly", self._context, b"", ctypes.byref(error))
        own_memory = platform.machine().lower() in ("arm64", "aarch64")
        engine = self._call("CreateMCJITCompiler", module, machine, own_memory, ctypes.byref(error))
        keeper = _Engine()
        weakref.finalize(keeper, self._call, "DisposeExecutionEngine", engine).atexit = False
        file = self._call("CreateObjectFile", code, len(code))
        self._call("MCJITAddObjectFile", engine, file)
        self._call("DisposeObjectFile", file)
        self._call("FinalizeObject", engine)
        return self._call("GetFunctionAddress", engine, entry.encode()), keeper


class _Binding:
    """llvmlite's own binding."""

    def host(self) -> str:
        """The processor's name and its features."""
        with IMPORTS:
            import llvmlite.binding as llvm

        features = ",".join(sorted(llvm.get_host_cpu_features().flatten().split(",")))
        return f"{llvm.get_host_cpu_name()}, {features}"

    def load(self, code: bytes, entry: str, outside: Mapping[str, int]) -> tuple[int, Any]:
        """Load machine code with the addresses of outside functions; see `Loader.load`."""
        with IMPORTS:
            import llvmlite.binding as llvm

        for name, place in outside.items():
            llvm.add_symbol(name, place)
        llvm.initialize_native_target()
        llvm.initialize_native_asmprinter()
        machine = llvm.Target.from_default_triple().create_target_machine()
        engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)
        engine.add_object_file(llvm.object_file.ObjectFileRef.from_data(code))
        engine.finalize_object()
        return engine.get_function_address(entry), engine
