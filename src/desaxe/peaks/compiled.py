"""The module of a search: its loops from the Programs, and the text of `search` behind them.

Its machine code is kept on disk, like that of every kernel. The same text runs in plain Python,
and by NumPy, many designs at once, so that nobody waits for a compiler.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiler.builder import module_text, rebound
from ..compiler.languages.numba import peaks
from ..compiler.languages.numba.module import numba_parts
from ..compiler.languages.python import SCOPE
from ..runtime.native.modules import Store
from ..runtime.threads import run_parts
from . import columns
from . import search as loops
from .by_arrays import functions_of, whole_blocks
from .nodes import Array
from .programs import Search, SearchPrograms, programs_of

Function = Callable[..., object]
PLAIN, NUMPY, COMPILED = "plain", "numpy", "compiled"
WAY: str | None = None  # of all searches, if one is forced
_ONLY: ContextVar[bool] = ContextVar("compiled_only", default=False)

SEARCH = Path(loops.__file__)
COLUMNS = Path(columns.__file__)
FUNCTIONS = ("sweep", "points", "finish")  # that a search calls, made of its Programs
BLOCK = 1_024  # designs at once in NumPy: the cost of each operation is shared by so many
MOST_LOADED = 64  # searches in memory
LEAST_PART = 1_024  # designs of a thread
LONGEST_PART = 8_192  # designs: less than half a second
BREAK_EVEN = 786_432  # designs of a call that take longer by NumPy than compiling does
FEW = 8  # designs that are searched one after the other
NO_TABLES = np.empty(0)
SIGNATURE = """ints, row, rows = types.int64[::1], types.float64[::1], types.float64[:, ::1]
signature = types.void(rows, ints, ints, row, ints, row, types.int64, row, rows)
function = search.py_func
"""


@lru_cache(maxsize=1024)
def source_of(search: Search) -> str:
    """The text of the compiled module."""
    docstring = f"desaxe search: extreme values of {search.name} over theta."
    programs = programs_of(search, True)
    files = (COLUMNS, SEARCH) if programs.own_nodes else (SEARCH, COLUMNS)
    return module_text(docstring, numba_parts([*texts_of(programs, "numba"), SIGNATURE], *files))


def texts_of(programs: SearchPrograms, column: str) -> list[str]:
    """`sweep`, `points` and `finish`, and the rows that `sweep` keeps."""
    own = programs.tables, programs.held, programs.own_nodes
    rows = peaks.Rows(programs.inputs, column, "theta", *own)
    sweep, work = peaks.sweep_function(programs.curve, rows)
    points = peaks.points_function(programs.curve, rows)
    finish = peaks.finish_function(programs.finish, rows)
    return [f"WORK = {max(work, 1)}\n", sweep, points, finish]


class Groups(NamedTuple):
    """Designs in the order of their groups; where each group starts, its nodes, and where those start.

    In one group, of BLOCK designs at most, each may have nodes of its own: a column of a table.
    """

    order: NDArray[np.intp]
    starts: NDArray[np.intp]
    nodes: Array
    node_starts: NDArray[np.intp]


class Tables(NamedTuple):
    """The tables of loads (`columns`), and rows for each design behind its inputs: arcs, nodes of its own."""

    packed: Array
    rows: Array


class SearchKernel(NamedTuple):
    """The function of a search; `coarse` if each group of designs costs more than their nodes."""

    function: Function
    coarse: bool = False


def run(
    search: Search,
    columns: Mapping[str, Array],
    cost: int,
    grouped: Callable[[bool], Groups],
    kind: int,
    theta: Array,
    out: Array,
    threads: int | None,
    tables: Tables | None = None,
) -> None:
    """Search designs on some threads; `theta` and the rows of `out` are filled at these designs.

    cost      of all designs of the call: that of one of the usual kind is 1
    grouped   their groups; few ones, if it is given True
    """
    inputs = programs_of(search, False).inputs
    more = np.empty((0, theta.size)) if tables is None else tables.rows
    table = np.empty((len(inputs) + len(more), theta.size))
    table[len(inputs) :] = more
    for row, name in zip(table, inputs, strict=False):
        row[:] = columns[name]
    packed = NO_TABLES if tables is None else tables.packed
    kernel = kernel_for(search, cost) if tables is None else STORE.of(search)  # the one that takes tables
    order, starts, nodes, node_starts = grouped(kernel.coarse)

    def part(first: int, last: int) -> None:
        here = nodes if nodes.ndim == 1 else nodes[:, first:last]
        own = np.clip(starts, first, last)
        kernel.function(table, order, own, here, node_starts, packed, kind, theta, out)

    run_parts(part, order.size, threads, LEAST_PART, LONGEST_PART)


STORE = Store("search", source_of, lambda _, function: SearchKernel(function), MOST_LOADED)


@contextmanager
def compiled_only() -> Iterator[None]:
    """Search by machine code in a block, however few designs a call has: results do not depend on chunks."""
    token = _ONLY.set(True)
    try:
        yield
    finally:
        _ONLY.reset(token)


def kernel_for(search: Search, designs: int) -> SearchKernel:
    """The search, compiled if this number of designs would take longer than compiling."""
    if WAY == PLAIN:
        return _plain(search)
    if not is_compiled(search, designs):
        return _by_arrays(search) if designs > FEW else _by_loops(search)
    return STORE.of(search)


def is_compiled(search: Search, designs: int) -> bool:
    """True if this number of designs goes through machine code."""
    if _ONLY.get() or WAY is not None:
        return _ONLY.get() or WAY == COMPILED
    return designs >= BREAK_EVEN or STORE.is_ready(search) or _on_disk(search)


_on_disk = lru_cache(maxsize=1024)(STORE.is_on_disk)  # once for all: calls must not change their tier


@lru_cache(maxsize=1024)
def _plain(search: Search) -> SearchKernel:
    """The search as plain Python, design by design."""
    return SearchKernel(_search_with(_scope(search, texts_of(programs_of(search, False), "python"))))


@lru_cache(maxsize=1024)
def _by_arrays(search: Search) -> SearchKernel:
    """The search in NumPy, many designs at once: no call waits for a compiler."""
    functions = dict(zip(FUNCTIONS, functions_of(programs_of(search, False)), strict=True))
    scope = whole_blocks(SEARCH, {"WORK": 1, "BLOCK": BLOCK, **functions})
    return SearchKernel(_quiet(scope["search"]), coarse=True)


@lru_cache(maxsize=1024)
def _by_loops(search: Search) -> SearchKernel:
    """The search of a few designs: what it calls by NumPy, over many nodes; its own loops as they stand."""
    return SearchKernel(search_with(*functions_of(programs_of(search, False))))


@lru_cache(maxsize=1024)
def plain_finish(search: Search) -> Function:
    """`finish(count, theta, block, out)` in plain Python: value, slope and gradient at a fixed load."""
    return _quiet(_scope(search, texts_of(programs_of(search, False), "python"))["finish"])


def search_by_rows(sweep: Function, points: Function, finish: Function) -> Function:
    """The search by NumPy of designs with a column of nodes each, which are one group and one block."""
    functions = {"sweep": sweep, "points": points, "finish": finish}
    return _quiet(whole_blocks(SEARCH, {"WORK": 1, "BLOCK": 2**62, **functions})["search"])


def search_with(sweep: Function, points: Function, finish: Function) -> Function:
    """The search in plain Python with functions that are not compiled."""
    return _search_with({"WORK": 1, "sweep": sweep, "points": points, "finish": finish})


def _search_with(scope: Mapping[str, Any]) -> Function:
    return _quiet(rebound(loops, {**scope, "uint64": int})["search"])


def _scope(search: Search, functions: Sequence[str]) -> dict[str, Any]:
    """Functions in plain Python, by name."""
    scope: dict[str, Any] = dict(SCOPE)
    exec(compile("\n".join(functions), f"<desaxe search {search.name}>", "exec"), scope)
    return scope


def _quiet(kernel: Function) -> Function:
    def quiet(*arguments: Any) -> None:
        with np.errstate(all="ignore"):
            kernel(*arguments)

    return quiet
