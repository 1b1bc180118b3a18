"""`desaxe doctor`: what is installed, where kernels are kept, and whether loops vectorise on this CPU."""

import platform
import re
import sys
import time
from collections.abc import Iterator
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

from ..support.extras import EXTRAS

RUNTIME = ("numpy", "numba", "llvmlite")
OPTIONAL = (
    "sympy", "mpmath", "xarray", "h5netcdf", "h5py", "zarr", "dask", "distributed", "matplotlib", "pint",
    "msgspec", "tqdm", "scipy", "SALib", "plotly", "python-flint",
)  # fmt: skip
FEATURES = ("sse2", "sse4.2", "avx", "avx2", "fma", "avx512f", "neon", "sve")  # as LLVM calls them
NAMES = ("V_C", "a_C")
INPUTS = ("theta", "ec", "AB", "BC", "omega0")

# Arithmetic on doubles, packed and one at a time; groups: x86-64 register, AArch64 vector.
_PACKED = re.compile(
    r"^\s+(?:v?(?:add|sub|mul|div|sqrt)pd|vf?n?m(?:add|sub)\d+pd)\s.*%([xyz]mm)\d+"
    r"|^\s+f(?:add|sub|mul|div|sqrt|mla|mls)\s+(?:v\d+\.2d|z\d+\.d)",
    re.M,
)
_SINGLE = re.compile(
    r"^\s+(?:v?(?:add|sub|mul|div|sqrt)sd|vf?n?m(?:add|sub)\d+sd)\s"
    r"|^\s+f(?:n?m?add|n?m?sub|n?mul|div|sqrt)\s+d\d+",
    re.M,
)
_LIBRARY = re.compile(r"(?<![\w.])[$_]*(sincos|sin|cos)(?:@PLT)?(?=[\s,)]|$)", re.M)
_DOUBLES = {"xmm": 2, "ymm": 4, "zmm": 8, "": 2}


class Examination(NamedTuple):
    """The report of `desaxe doctor`, and a flag: desaxe is usable."""

    text: str
    usable: bool


class AssemblyLoop(NamedTuple):
    """Instruction counts of a kernel's machine code, and its calls of the C library."""

    packed: int
    single: int
    doubles: int
    library_calls: tuple[str, ...]

    @property
    def vectorised(self) -> bool:
        """True if the loop is vectorised: one copy is packed, a second one handles the remaining points."""
        return self.packed > 0 and 2 * self.packed >= self.single


def report() -> str:
    """The report as text."""
    return examine().text


def examine() -> Examination:
    """Examine the installation; problems are reported, never raised."""
    loop_lines, usable = _loops()
    parts = {
        "desaxe": [_row("version", _version("desaxe")), _row("place", str(Path(__file__).parents[1]))],
        "runtime": [_row("python", _python()), *(_row(name, _version(name)) for name in RUNTIME)],
        "optional": [_row(name, _optional(name)) for name in OPTIONAL],
        "kernels on disk": _cache(),
        "committed kernels": [_committed()],
        "arrays": [_row("tier", _tier())],
        "processor": _processor(),
        "loops": loop_lines,
    }
    usable = usable and not any(_version(name) == MISSING for name in RUNTIME)
    lines = [line for title, rows in parts.items() for line in (title, *rows)]
    verdict = "desaxe can be used." if usable else "desaxe cannot be used here; see above."
    return Examination("\n".join([*lines, verdict]), usable)


def _row(name: str, what: str) -> str:
    return f"  {name:13}{what}"


# ---- what is installed ---------------------------------------------------------------------------

MISSING = "missing"


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return MISSING


def _optional(name: str) -> str:
    found = _version(name)
    return f"missing: python -m pip install 'desaxe[{EXTRAS[name]}]'" if found == MISSING else found


def _python() -> str:
    kind = f"{platform.python_implementation()}, {sys.platform}, {platform.machine()}"
    return f"{platform.python_version()} ({kind})"


# ---- where kernels are ---------------------------------------------------------------------------


def _cache() -> list[str]:
    """The cache folder: its path, its persistence, its contents."""
    from ..runtime.cache import VARIABLE, entries, folder, limit
    from ..runtime.kernels import MOST_LOADED, STORE

    found = folder()
    kept = entries(found.path)
    size = sum(entry.size for entry in kept)
    count = sum(entry.path.suffix == ".code" for entry in kept)
    state = "can be written" if found.lasting else f"temporary: {found.why} (set {VARIABLE})"
    return [
        _row("folder", f"{found.path} ({state})"),
        _row("holds", f"{count} kernels, {size / 1e6:.1f} MB of at most {limit() / 1e6:.0f} MB"),
        _row("in memory", f"{len(STORE)} kernels of this process, at most {MOST_LOADED}"),
    ]


def _tier() -> str:
    """The tiers that evaluate a request over arrays, and their thresholds."""
    from ..runtime.tiers import BREAK_EVEN, NUMPY_PAYS, VARIABLE, forced_tier

    try:
        forced = forced_tier()
    except ValueError as error:
        return str(error)
    if forced is not None:
        return f"{forced}, as {VARIABLE} says"
    few = f"plain Python below {BREAK_EVEN:,} points"
    return f"{few}; NumPy for a new request up to {NUMPY_PAYS:,}; else compiled"


def _committed() -> str:
    """Report if generated/ matches the installed derivation and compiler."""
    digest: str = import_module("desaxe.generated").DIGEST
    if find_spec("sympy") is None:
        return _row("freshness", f"digest {digest[:16]}; to check it: python -m pip install 'desaxe[derive]'")
    current: str = import_module("desaxe.derive.write").inputs_digest()
    state = "fresh" if current == digest else f"STALE, the sources are {current[:16]}: run `desaxe derive`"
    return _row("freshness", f"{state} (digest {digest[:16]})")


# ---- the machine ---------------------------------------------------------------------------------


def _processor() -> list[str]:
    """Threads, and the CPU as LLVM sees it."""
    from ..runtime.threads import available

    rows = [_row("threads", f"{available()} can be used by this process")]
    try:
        llvm = import_module("llvmlite.binding")
        features = llvm.get_host_cpu_features()
        found = [name for name in FEATURES if features.get(name)]
        rows += [_row("name", llvm.get_host_cpu_name()), _row("SIMD", ", ".join(found) or "none known")]
    except (ImportError, RuntimeError, OSError) as error:
        rows.append(_row("name", f"unknown: {error}"))
    return rows


# ---- does it vectorise? --------------------------------------------------------------------------


def _loops() -> tuple[list[str], bool]:
    """Compile a kernel as `evaluate` does; return report lines about its machine code, and if it compiled."""
    started = time.perf_counter()
    try:
        assembly = "\n".join(_assembly())
    except Exception as error:  # whatever stops a compilation is what the user must know
        return [_row("compilation", f"FAILED: {type(error).__name__}: {error}")], False
    seconds = time.perf_counter() - started
    loop = examine_assembly(assembly)
    bits = 64 * loop.doubles
    if loop.vectorised:
        verdict = f"yes, {loop.doubles} doubles at a time ({bits} bit)"
    else:
        verdict = "no, one double at a time"
    calls = ", ".join(loop.library_calls)
    sines = (
        f"calls of the C library ({calls}), one at a time" if calls else "inside the loop, vectorised with it"
    )
    sines = sines if loop.vectorised or calls else "inside the loop"
    return [
        _row("compilation", f"a kernel for {', '.join(NAMES)} in {seconds:.1f} s"),
        _row("vectorised", f"{verdict}: {loop.packed} packed and {loop.single} single operations"),
        _row("sin, cos", sines),
    ], True


def examine_assembly(assembly: str) -> AssemblyLoop:
    """Count packed and single arithmetic on doubles, and the C library's sines and cosines."""
    registers = [match[1] or "" for match in _PACKED.finditer(assembly)]
    doubles = max((_DOUBLES[register] for register in registers), default=1)
    single = len(_SINGLE.findall(assembly))
    calls = tuple(sorted(set(_LIBRARY.findall(assembly))))
    return AssemblyLoop(len(registers), single, doubles, calls)


def _assembly() -> Iterator[str]:
    """The assembly of a fresh kernel with every input an array; numba has none for a cached kernel."""
    import numpy as np

    from ..compiler.languages.numba.module import TO_COMPILE, emit_numba
    from ..runtime.kernels import kernel_of, key_of
    from ..runtime.request import request

    columns = dict.fromkeys(INPUTS, np.ones(8))
    wanted = request(NAMES, {"omega0": 1.0}, 1, "standard")
    key = key_of(wanted, {}, columns, dict.fromkeys(INPUTS, 0), axes=1)
    njit: Any = import_module("numba").njit
    scope: dict[str, Any] = {}
    exec(emit_numba(kernel_of(key), "A kernel.", TO_COMPILE), scope)
    compiled = njit(scope["signature"], error_model="numpy", nogil=True)(scope["function"])
    yield from compiled.inspect_asm().values()
