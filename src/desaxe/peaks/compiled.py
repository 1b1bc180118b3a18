"""The module of a search: its loops from the Programs, and the text of `search` behind them.

Its machine code is kept on disk, like that of every kernel. The same text runs in plain Python,
with its functions in NumPy, for the first designs, so that nobody waits for a compiler.
"""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiler.builder import module_text, rebound
from ..compiler.languages.numba import peaks
from ..compiler.languages.numba.module import numba_parts
from ..compiler.languages.python import SCOPE
from ..runtime.modules import is_kept, native
from ..runtime.threads import run_parts
from ..runtime.tiers import INTERPRETED, NUMPY, forced_tier
from ..support.forks import ForkSafeLock
from ..support.recent import Recent
from . import search as loops
from .by_arrays import functions_of
from .nodes import Array
from .programs import Programs, Search, programs_of

Kernel = Callable[..., object]

SEARCH = Path(loops.__file__)
MOST_LOADED = 64  # searches in memory
LEAST_PART = 1_024  # designs of a thread
LONGEST_PART = 8_192  # designs: less than half a second
BREAK_EVEN = 16_384  # designs by NumPy, a second or so of them: beyond, compiling pays
SIGNATURE = """ints, row, rows = types.int64[::1], types.float64[::1], types.float64[:, ::1]
signature = types.void(rows, ints, ints, row, ints, types.int64, row, rows)
function = search.py_func
"""


@lru_cache(maxsize=1024)
def source_of(search: Search) -> str:
    """The text of the compiled module."""
    docstring = f"desaxe search: extreme values of {search.name} over theta."
    parts = [*texts_of(programs_of(search, True), "numba"), SIGNATURE]
    return module_text(docstring, numba_parts(parts, SEARCH))


def texts_of(programs: Programs, column: str) -> list[str]:
    """`sweep`, `points` and `finish`, and the rows that `sweep` keeps."""
    rows = peaks.Rows(programs.inputs, column, "theta")
    sweep, work = peaks.sweep_function(programs.curve, rows)
    points = peaks.points_function(programs.curve, rows)
    finish = peaks.finish_function(programs.finish, rows)
    return [f"WORK = {max(work, 1)}\n", sweep, points, finish]


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
    return _search_with(_scope(search, texts_of(programs_of(search, False), "python")))


@lru_cache(maxsize=1024)
def _by_arrays(search: Search) -> Kernel:
    """The search with its functions in NumPy: no request waits for a compiler when it is first made."""
    return search_with(*functions_of(programs_of(search, False)))


@lru_cache(maxsize=1024)
def plain_finish(search: Search) -> Kernel:
    """`finish(count, theta, block, out)` in plain Python: value, slope and gradient at a fixed load."""
    return _quiet(_scope(search, texts_of(programs_of(search, False), "python"))["finish"])


def search_with(sweep: Kernel, points: Kernel, finish: Kernel) -> Kernel:
    """The search in plain Python with functions that are not compiled."""
    return _search_with({"WORK": 1, "sweep": sweep, "points": points, "finish": finish})


def _search_with(scope: Mapping[str, Any]) -> Kernel:
    return _quiet(rebound(loops, {**scope, "uint64": int})["search"])


def _scope(search: Search, functions: Sequence[str]) -> dict[str, Any]:
    """Functions in plain Python, by name."""
    scope: dict[str, Any] = dict(SCOPE)
    exec(compile("\n".join(functions), f"<desaxe search {search.name}>", "exec"), scope)
    return scope


def _quiet(kernel: Kernel) -> Kernel:
    def quiet(*arguments: Any) -> None:
        with np.errstate(all="ignore"):
            kernel(*arguments)

    return quiet
