"""The module of a search: its loops from the Programs, and the text of `search` behind them.

Its machine code is kept on disk, like that of every kernel. The same text runs in plain Python,
with its functions in NumPy, for the first designs, so that nobody waits for a compiler.
"""

import math
from collections import Counter
from collections.abc import Callable, Mapping
from functools import cache, lru_cache
from pathlib import Path
from types import CodeType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiler.languages.numba import peaks
from ..compiler.languages.numba.module import helper_sources
from ..compiler.operations import HELPERS, MATH_NAMES
from ..runtime.modules import is_kept, native
from ..runtime.threads import run_parts
from ..runtime.tiers import INTERPRETED, NUMPY, forced_tier
from ..support.forks import ForkSafeLock
from ..support.recent import Recent
from .by_arrays import functions_of
from .nodes import Array
from .programs import Programs, Search, programs_of

Kernel = Callable[..., object]

LINE = "# ---- compiled"
MOST_LOADED = 64  # searches in memory
LEAST_PART = 1_024  # designs of a thread
LONGEST_PART = 8_192  # designs: less than half a second
BREAK_EVEN = 16_384  # designs by NumPy, a second or so of them: beyond, compiling pays
_NJIT = '@njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)\n'
_HEADER = '''"""desaxe search: extreme values of {name} over theta."""

from math import atan2, copysign, cos, exp, fabs, inf, log, nan, pow, sin, sqrt

from numba import njit, types
from numba.extending import intrinsic
from numpy import empty, floor, int64, uint64

WORK = {work}
'''
SIGNATURE = """ints, row, rows = types.int64[::1], types.float64[::1], types.float64[:, ::1]
signature = types.void(rows, ints, ints, row, ints, types.int64, row, rows)
function = search
"""


@lru_cache(maxsize=1024)
def source_of(search: Search) -> str:
    """The text of the compiled module."""
    programs = programs_of(search, True)
    loops, work = _loops(programs, "numba")
    *helpers, last = _functions()
    called = {line.op for program in (programs.curve, programs.finish) for line in program.lines}
    parts = [
        _HEADER.format(name=search.name, work=max(work, 1)),
        *helper_sources(called),
        *(_NJIT + loop for loop in loops),
        *(helper if helper.startswith("BLOCK") else _NJIT + helper for helper in helpers),
        last,
        SIGNATURE,
    ]
    return "\n\n".join(parts)


def _loops(programs: Programs, column: str) -> tuple[list[str], int]:
    rows = peaks.Rows(programs.inputs, column, "theta")
    sweep, work = peaks.sweep_function(programs.curve, rows)
    points = peaks.points_function(programs.curve, rows)
    return [sweep, points, peaks.finish_function(programs.finish, rows)], work


@cache
def _functions() -> list[str]:
    """The constants and functions of `search`, without types, which numba finds by itself."""
    source = Path(__file__).with_name("search.py").read_text(encoding="utf-8")
    first, *others = source.partition(LINE)[2].partition("\n")[2].strip().split("\ndef ")
    bare = [first.strip() + "\n", *(f"def {other.strip()}\n" for other in others)]
    for kind in (" -> Any", ": Any", ": int", ": float", " -> None", " -> int", " -> float"):
        bare = [part.replace(kind, "") for part in bare]
    return bare


class Groups(NamedTuple):
    """Designs in the order of their groups; where each group starts, its nodes, and where those start."""

    order: NDArray[np.intp]
    starts: NDArray[np.intp]
    nodes: Array
    node_starts: NDArray[np.intp]


def run(
    search: Search,
    columns: Mapping[str, Array],
    groups: Groups,
    kind: int,
    theta: Array,
    out: Array,
    threads: int | None,
) -> None:
    """Search groups of designs on some threads; `theta` and the rows of `out` are filled at these designs."""
    order, starts, nodes, node_starts = groups
    inputs = programs_of(search, False).inputs
    table = np.empty((len(inputs), theta.size))
    for row, name in zip(table, inputs, strict=True):
        row[:] = columns[name]
    kernel = kernel_for(search, order.size)

    def part(first: int, last: int) -> None:
        kernel(table, order, np.clip(starts, first, last), nodes, node_starts, kind, theta, out)

    run_parts(part, order.size, threads, LEAST_PART, LONGEST_PART)


_LOADED: Recent[Search, Kernel] = Recent(MOST_LOADED)
_ASKED: Counter[Search] = Counter()
_LOCK = ForkSafeLock()


def kernel_for(search: Search, designs: int) -> Kernel:
    """The search, compiled if that pays for this number of further designs."""
    found = _LOADED.get(search)
    if found is not None:
        return found
    _ASKED[search] += designs
    forced = forced_tier()
    early = forced is None and _ASKED[search] < BREAK_EVEN and not _on_disk(search)
    if forced == INTERPRETED:
        return _plain(search)
    if early or forced == NUMPY:
        return _by_arrays(search)
    with _LOCK:
        found = _LOADED.get(search) or native("search", source_of(search))
        _LOADED[search] = found
    return found


@lru_cache(maxsize=1024)
def _on_disk(search: Search) -> bool:
    """True if an earlier process has stored the machine code."""
    return is_kept("search", source_of(search))


@lru_cache(maxsize=1024)
def _plain(search: Search) -> Kernel:
    """The search as plain Python, design by design."""
    loops, work = _loops(programs_of(search, False), "python")
    scope = _scope(max(work, 1))
    source = "\n\n".join([*HELPERS.values(), *loops, *_functions()])
    exec(compile(source, f"<desaxe search {search.name}>", "exec"), scope)
    return _quiet(scope["search"])


@lru_cache(maxsize=1024)
def _by_arrays(search: Search) -> Kernel:
    """The search with its functions in NumPy: no request waits for a compiler when it is first made."""
    return search_with(*functions_of(programs_of(search, False)))


@lru_cache(maxsize=1024)
def plain_finish(search: Search) -> Kernel:
    """`finish(count, theta, block, out)` in plain Python: value, slope and gradient at a fixed load."""
    programs = programs_of(search, False)
    function = peaks.finish_function(programs.finish, peaks.Rows(programs.inputs, "python", "theta"))
    scope = _scope(1)
    exec(compile("\n\n".join([*HELPERS.values(), function]), "<desaxe finish>", "exec"), scope)
    return _quiet(scope["finish"])


def search_with(sweep: Kernel, points: Kernel, finish: Kernel) -> Kernel:
    """The search in plain Python with other functions in place of the stubs."""
    scope = _scope(1) | {"sweep": sweep, "points": points, "finish": finish}
    exec(_code(), scope)
    return _quiet(scope["search"])


@cache
def _code() -> CodeType:
    return compile("\n\n".join(_functions()), "<desaxe search>", "exec")


def _scope(work: int) -> dict[str, Any]:
    """The names that the text of the search imports, for plain Python."""
    numpy = {"floor": np.floor, "empty": np.empty, "int64": np.int64}
    return {name: getattr(math, name) for name in MATH_NAMES} | numpy | {"uint64": int, "WORK": work}


def _quiet(kernel: Kernel) -> Kernel:
    def quiet(*arguments: Any) -> None:
        with np.errstate(all="ignore"):
            kernel(*arguments)

    return quiet
