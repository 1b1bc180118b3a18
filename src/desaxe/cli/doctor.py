"""`desaxe doctor`: what is installed, and whether points and arrays agree here, or with 200 frozen truths."""

import argparse
import platform
import sys
import time
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from math import isfinite, ulp
from pathlib import Path
from typing import Any, NamedTuple

from ..support.extras import EXTRAS
from ..support.template import file_text
from .parser import FLAG, Command, Option

RUNTIME = ("numpy", "numba", "llvmlite")
FEATURES = ("sse2", "sse4.2", "avx", "avx2", "fma", "avx512f", "neon", "sve")  # as LLVM calls them
MISSING = "missing"
MODULES = ("desaxe.derive", "flint")  # that the distributions of EXTRAS bring, under names of their own
POINTS, CLOSE = 4096, 1e-13
PRESS: dict[str, Any] = {"ec": 0.01, "AB": 0.04, "BC": 0.1, "omega0": 31.4}
INPUTS = ("theta", "ec", "AB", "BC", "omega0", "alpha")
COPIES = 64  # of a point in an array: enough to compile instead of computing them one by one


class Examination(NamedTuple):
    """The report of `desaxe doctor`, and a flag: desaxe is usable."""

    text: str
    usable: bool


def _doctor(options: argparse.Namespace) -> int:
    report = examine(options.accuracy)
    print(report.text)
    return 0 if report.usable else 1


ABOUT = "versions, threads, and whether arrays and points agree on this computer"
DOCTOR = Command("doctor", ABOUT, _doctor, [Option("--accuracy", "compare with 200 frozen truths", FLAG)])


def examine(accuracy: bool = False) -> Examination:
    """Examine the installation, its values beside frozen truths too; problems are reported, never raised."""
    computed, usable = _computation(accuracy)
    usable = usable and all(_version(name) != MISSING for name in RUNTIME)
    system = f"{platform.python_implementation()}, {sys.platform}, {platform.machine()}"
    python = f"{platform.python_version()} ({system})"
    parts: dict[str, dict[str, str]] = {
        "desaxe": {"version": _version("desaxe"), "place": str(Path(__file__).parents[1])},
        "runtime": {"python": python, **{name: _version(name) for name in RUNTIME}},
        "optional": {name: _optional(name, extra) for name, extra in EXTRAS.items() if name not in MODULES},
        "committed kernels": {"freshness": _committed()},
        "processor": _processor(),
        "computation": computed,
    }
    lines = []
    for title, rows in parts.items():
        lines += [title, *(f"  {name:13}{what}" for name, what in rows.items())]
    verdict = "desaxe can be used." if usable else "desaxe cannot be used here; see above."
    return Examination("\n".join([*lines, verdict]), usable)


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return MISSING


def _optional(name: str, extra: str) -> str:
    installed = _version(name)
    return f"missing: python -m pip install 'desaxe[{extra}]'" if installed == MISSING else installed


def _committed() -> str:
    """Report if generated/ matches the installed derivation and compiler."""
    digest: str = import_module("desaxe.generated").DIGEST
    if find_spec("sympy") is None:
        return f"digest {digest[:16]}; to check it: python -m pip install 'desaxe[derive]'"
    current: str = import_module("desaxe.derive.write").inputs_digest()
    state = "fresh" if current == digest else f"STALE, the sources are {current[:16]}: run `desaxe derive`"
    return f"{state} (digest {digest[:16]})"


def _processor() -> dict[str, str]:
    """Threads, and the CPU as LLVM sees it."""
    from ..runtime.threads import available

    rows = {"threads": f"{available()} can be used by this process"}
    try:
        llvm = import_module("llvmlite.binding")
        features = [name for name in FEATURES if llvm.get_host_cpu_features().get(name)]
        return rows | {"name": llvm.get_host_cpu_name(), "SIMD": ", ".join(features) or "none known"}
    except (ImportError, RuntimeError, OSError) as error:
        return rows | {"name": f"unknown: {error}"}


# ---- does it compute? ----------------------------------------------------------------------------


def _computation(accuracy: bool) -> tuple[dict[str, str], bool]:
    """Report lines of arrays, which are compiled, beside single points, which are not; if they are right."""
    started = time.perf_counter()
    try:
        apart = _array_beside_points()
        shares = worst_shares() if accuracy else {}
    except Exception as error:  # whatever stops a compilation is what the user must know
        return {"arrays": f"FAILED: {type(error).__name__}: {error}"}, False
    seconds = time.perf_counter() - started
    rows = {"arrays": f"a_C at {POINTS:,} points in {seconds:.1f} s, {apart:.0e} from single points"}
    for what, share in shares.items():
        rows[f"{what}, truth"] = f"200 frozen truths: {share:.2g} of the promised error at most"
    return rows, apart < CLOSE and all(share <= 1.0 for share in shares.values())


def evaluate(*args: Any, **inputs: Any) -> Any:
    """`desaxe.evaluate`."""
    return import_module("desaxe").evaluate(*args, **inputs)


def _array_beside_points() -> float:
    """The largest relative difference between values of an array and those of its points alone."""
    import numpy as np

    theta = np.linspace(0.1, 6.3, POINTS)
    array = evaluate("a_C", theta=theta, **PRESS)
    largest = float(np.abs(array).max())
    some = range(0, POINTS, POINTS // 16)
    apart = (abs(array[k] - evaluate("a_C", theta=float(theta[k]), **PRESS)) for k in some)
    return float(max(apart)) / largest


class FrozenTruth(NamedTuple):
    """The true value of a quantity at a point, rounded, and the error that is promised there [ulp]."""

    name: str
    branch: int
    point: dict[str, Any]
    value: float
    promised: float

    def share(self, value: float) -> float:
        """The error of a value as a share of the promise; the truth itself is rounded by half an ulp."""
        if not isfinite(value):
            return float("inf")
        return max(0.0, abs(value - self.value) / ulp(self.value) - 0.5) / self.promised


def truths() -> list[FrozenTruth]:
    """The table, as `python -m benchmarks.accuracy.freeze` wrote it."""
    rows = []
    for name, branch, *numbers in map(str.split, file_text(__package__, "truths.txt").splitlines()):
        *point, value, promised = map(float, numbers)
        rows.append(FrozenTruth(name, int(branch), dict(zip(INPUTS, point, strict=True)), value, promised))
    return rows


def worst_shares() -> dict[str, float]:
    """The largest error of single points and of arrays, as shares of the promise."""
    import numpy as np

    worst = {"points": 0.0, "arrays": 0.0}
    for row in truths():
        columns: dict[str, Any] = {name: np.full(COPIES, value) for name, value in row.point.items()}
        for what, point in (("points", row.point), ("arrays", columns)):
            value = np.ravel(evaluate(row.name, branch=row.branch, **point))[0]
            worst[what] = max(worst[what], row.share(float(value)))
    return worst
