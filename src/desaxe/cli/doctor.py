"""`desaxe doctor`: what is installed, where kernels are kept, and whether arrays and points agree here."""

import platform
import sys
import time
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

from ..evaluation.evaluate import evaluate
from ..support.extras import EXTRAS
from .accuracy import worst_shares

RUNTIME = ("numpy", "numba", "llvmlite")
OPTIONAL = (
    "sympy", "mpmath", "xarray", "h5netcdf", "h5py", "zarr", "dask", "distributed", "matplotlib", "pint",
    "tqdm", "scipy", "plotly", "python-flint",
)  # fmt: skip
FEATURES = ("sse2", "sse4.2", "avx", "avx2", "fma", "avx512f", "neon", "sve")  # as LLVM calls them


class Examination(NamedTuple):
    """The report of `desaxe doctor`, and a flag: desaxe is usable."""

    text: str
    usable: bool


def examine(accuracy: bool = False) -> Examination:
    """Examine the installation, its values beside frozen truths too; problems are reported, never raised."""
    computed, usable = _computation(accuracy)
    parts = {
        "desaxe": [_row("version", _version("desaxe")), _row("place", str(Path(__file__).parents[1]))],
        "runtime": [_row("python", _python()), *(_row(name, _version(name)) for name in RUNTIME)],
        "optional": [_row(name, _optional(name)) for name in OPTIONAL],
        "committed kernels": [_committed()],
        "arrays": [_row("machine code", _machine_code())],
        "processor": _processor(),
        "computation": computed,
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


# ---- machine code and generated files -------------------------------------------------------------


def _machine_code() -> str:
    """Compile, load and call a function: some systems refuse memory that is written and then run."""
    from ctypes import CFUNCTYPE, c_double

    from ..compiler.llvm.machine import compiled

    try:
        code = compiled("define double @half() {\n  ret double 0.5\n}", "half")
    except RuntimeError as error:
        return str(error)
    return "runs" if CFUNCTYPE(c_double)(code.address)() == 0.5 else "gives a wrong answer"


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


# ---- does it compute? ----------------------------------------------------------------------------

POINTS, CLOSE = 4096, 1e-13
PRESS: dict[str, Any] = {"ec": 0.01, "AB": 0.04, "BC": 0.1, "omega0": 31.4}


def _computation(accuracy: bool) -> tuple[list[str], bool]:
    """Report lines of arrays, which are compiled, beside single points, which are not; if they are right."""
    started = time.perf_counter()
    try:
        apart = _array_beside_points()
        shares = worst_shares() if accuracy else {}
    except Exception as error:  # whatever stops a compilation is what the user must know
        return [_row("arrays", f"FAILED: {type(error).__name__}: {error}")], False
    seconds = time.perf_counter() - started
    rows = [_row("arrays", f"a_C at {POINTS:,} points in {seconds:.1f} s, {apart:.0e} from single points")]
    rows += [
        _row(what, f"200 frozen truths: {share:.2g} of the promised error at most")
        for what, share in shares.items()
    ]
    return rows, apart < CLOSE and all(share <= 1.0 for share in shares.values())


def _array_beside_points() -> float:
    """The largest relative difference between values of an array and those of its points alone."""
    import numpy as np

    theta = np.linspace(0.1, 6.3, POINTS)
    array = evaluate("a_C", theta=theta, **PRESS)
    largest = float(np.abs(array).max())
    some = range(0, POINTS, POINTS // 16)
    apart = (abs(array[k] - evaluate("a_C", theta=float(theta[k]), **PRESS)) for k in some)
    return float(max(apart)) / largest
