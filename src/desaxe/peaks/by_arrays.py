"""The functions of a search by NumPy: a block of designs at once, without a compiler.

Loops that vectorise, `for i in range(uint64(count))`, are turned into operations on whole arrays, line by
line; those in which one pass hangs on the one before stand here. Nodes are a column that all designs of a
group share, or a table with a column for each.
"""

import ast
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import CodeType
from typing import Any

import numpy as np

from ..compiler.languages.arrays import compile_arrays
from ..compiler.program import Program
from .nodes import Array
from .programs import SearchPrograms
from .search import AFTER, BEFORE, DIP, FIFTH, FIRST, FLAT, HIGH, LOW, THETA, TIE, WIDTH

Function = Callable[..., None]


def functions_of(programs: SearchPrograms) -> tuple[Function, Function, Function]:
    """`sweep`, `points` and `finish` of `search`, for its designs and angles in arrays."""
    curve, told = (_over(program, programs.inputs) for program in (programs.curve, programs.finish))

    def sweep(
        count: int, nodes: Array, block: Array, tables: Array, work: Array, value: Array, slope: Array
    ) -> None:
        """Value and slope at every node, for every design."""
        here = slice(0, len(nodes)), slice(0, count)
        value[here], slope[here] = curve(nodes.reshape(len(nodes), -1), block[:, None, :count])

    def points(
        rows: int, count: int, theta: Array, block: Array, tables: Array, value: Array, slope: Array
    ) -> None:
        """Value and slope of every design at angles of its own."""
        here = slice(0, rows), slice(0, count)
        value[here], slope[here] = curve(theta[here], block[:, None, :count])

    def finish(count: int, theta: Array, block: Array, tables: Array, out: Array) -> None:
        """Value, slope and gradient of every design at an angle."""
        for row, values in zip(out, told(theta[:count], block[:, :count]), strict=True):
            row[:count] = values

    return sweep, points, finish


def _over(program: Program, inputs: tuple[str, ...]) -> Callable[[Array, Array], tuple[Any, ...]]:
    """A program as a function of angles and the rows of a block."""
    function = compile_arrays(program, np)
    places = [None if name == "theta" else inputs.index(name) for name in program.inputs]

    def values(theta: Array, block: Array) -> tuple[Any, ...]:
        with np.errstate(all="ignore"):
            return function(*(theta if place is None else block[place] for place in places))

    return values


class _Loops(ast.NodeTransformer):
    """Each loop that vectorises as its body, once, for all indices: x[i] is x[:count], a choice is `where`.

    What a loop counts, `left += 1 if ... else 0`, is the sum.
    """

    def __init__(self) -> None:
        self.index, self.count = "", ast.expr()
        self.written: set[str] = set()

    def visit_For(self, loop: ast.For) -> Any:
        called = loop.iter.args[0] if isinstance(loop.iter, ast.Call) else None
        if not (isinstance(called, ast.Call) and isinstance(loop.target, ast.Name)):
            return self.generic_visit(loop)
        self.index, self.count = loop.target.id, called.args[0]
        items = [item for item in ast.walk(loop) if isinstance(item, ast.Subscript)]
        self.written = {ast.unparse(item.value) for item in items if isinstance(item.ctx, ast.Store)}
        body = [self.visit(line) for line in loop.body]
        self.index = ""
        return body

    def visit_Subscript(self, item: ast.Subscript) -> Any:
        if self.index and isinstance(item.slice, ast.Name) and item.slice.id == self.index:
            part = ast.Subscript(item.value, ast.Slice(upper=self.count), item.ctx)
            if isinstance(item.ctx, ast.Load) and ast.unparse(item.value) in self.written:
                return ast.Call(ast.Attribute(part, "copy", ast.Load()), [], [])  # as it was when it was read
            return part
        return item

    def visit_IfExp(self, choice: ast.IfExp) -> Any:
        if not self.index:
            return choice
        parts = [self.visit(part) for part in (choice.test, choice.body, choice.orelse)]
        return ast.Call(ast.Name("where", ast.Load()), parts, [])

    def visit_AugAssign(self, line: ast.AugAssign) -> Any:
        counts = isinstance(line.value, ast.IfExp)
        self.generic_visit(line)
        if self.index and counts:
            line.value = ast.Call(ast.Name("count_nonzero", ast.Load()), [line.value], [])
        return line


def _at(nodes: Array, places: Any, owners: Any) -> Array:
    """Nodes of designs that share them, or of designs with a column each."""
    found: Array = nodes[places] if nodes.ndim == 1 else nodes[places, owners]
    return found


def gather(count: int, chosen: Any, columns: Array, block: Array) -> None:
    """The inputs of chosen designs, next to each other."""
    block[:, :count] = columns[: len(block), chosen[:count]]


def candidates(count: int, nodes: Array, upper: Array, best: Array, places: Any, owners: Any) -> int:
    """Collect the intervals whose bound exceeds the best node: index and design; return their number."""
    place, owner = np.nonzero(upper[1 : len(nodes), :count] >= best[:count])
    places[: place.size], owners[: place.size] = place, owner
    return place.size


def interior(
    count: int, nodes: Array, places: Any, owners: Any, slope: Array, theta: Array, even: Any
) -> None:
    """Three angles inside of each interval: even, or graded towards an end that is flat."""
    j, i = places[:count], owners[:count]
    a, b = np.abs(slope[j, i]), np.abs(slope[j + 1, i])
    even[:count] = ~((a < FLAT * b) | (b < FLAT * a))
    graded = np.where(a < b, [[1 / 512], [1 / 32], [1 / 4]], [[3 / 4], [31 / 32], [511 / 512]])
    parts = np.where(even[:count] == 1, [[0.25], [0.5], [0.75]], graded)
    low = _at(nodes, j, i)
    theta[:, :count] = low + parts * (_at(nodes, j + 1, i) - low)


def brackets(
    count: int, nodes: Array, places: Any, owners: Any, slope: Array, thetas: Array, slopes: Array, even: Any,
    roots: Array, whose: Any,
) -> int:  # fmt: skip
    """The brackets in which the slope changes sign: a column of `roots` each, rows LOW to FIFTH."""
    j, i = places[:count], owners[:count]
    angles = np.vstack([_at(nodes, j, i), thetas[:, :count], _at(nodes, j + 1, i)])
    known = np.vstack([slope[j, i], slopes[:, :count], slope[j + 1, i]])
    before, after = known[:-1], known[1:]
    changes = ((before > 0.0) != (after > 0.0)) & (before == before) & (after == after)
    c, k = np.nonzero(changes.T)
    number = np.where(even[c] == 1, k, -1)
    rows = (
        angles[k, c],
        angles[k + 1, c],
        number,
        angles[k + 1, c] - angles[k, c],
        before[k, c],
        after[k, c],
    )
    for row, values in zip((LOW, HIGH, THETA, WIDTH, BEFORE, AFTER), rows, strict=True):
        roots[row, : c.size] = values
    roots[FIRST : FIFTH + 1, : c.size] = known[:, c]
    whose[: c.size] = i[c]
    return c.size


def choose(
    kind: int, count: int, roots: Array, whose: Any, value: Array, best: Array, theta: Array, taken: Any
) -> None:
    """Choose for each design the best root, if it is as good as the best node."""
    own, new = whose[:count], value[:count]
    new = np.abs(new) if kind == 0 else new if kind == 1 else -new
    np.fmax.at(best, own, new)
    good = np.flatnonzero(new >= best[own] - TIE * np.abs(best[own]))[::-1]
    theta[own[good]] = roots[THETA, good]  # of equal ones the first, which is written last


def told(kind: int, count: int, chosen: Any, here: Array, found: Array, theta: Array, out: Array) -> None:
    """The angles and what was found there, for the designs chosen; of |value| for kind 0."""
    theta[chosen] = here[:count]
    out[:, chosen] = found[:, :count]
    if kind == 0:
        out[2:, chosen] *= np.where(found[0, :count] < 0.0, -1.0, 1.0)


def bound(
    kind: int, count: int, nodes: Array, value: Array, slope: Array, best: Array, theta: Array, upper: Array
) -> None:
    """The best node of each design, and the bounds between nodes: NaN where no extremum is."""
    nodes = nodes.reshape(len(nodes), -1)
    value, slope = value[: len(nodes), :count], slope[: len(nodes), :count]
    top = np.abs(value) if kind == 0 else value if kind == 1 else -value
    known = np.where(np.isnan(top), -np.inf, top)
    place = known.argmax(axis=0), np.arange(count)
    best[:count] = known[place]
    best_node = nodes[place[0], 0] if nodes.shape[1] == 1 else nodes[place]
    theta[:count] = np.where(known[place] > -np.inf, best_node, np.nan)
    width, a, b = np.diff(nodes, axis=0), slope[:-1], slope[1:]
    size_a, size_b = np.abs(a), np.abs(b)
    less, more = np.fmin(size_a, size_b), np.fmax(size_a, size_b)
    middle = 1.5 * np.diff(value, axis=0) / np.where(width > 0.0, width, np.inf) - 0.25 * (a + b)
    rising = a > 0.0
    dips = np.where(rising, middle, -middle) < DIP * more
    some = ((rising != (b > 0.0)) | dips | (less < FLAT * more)) & (width > 0.0)
    bounds = np.fmax(top[:-1], top[1:]) + width * np.fmax(np.abs(middle), more)
    upper[1 : len(nodes), :count] = np.where(some, bounds, np.nan)


SEQUENTIAL = {f.__name__: f for f in (gather, bound, candidates, interior, brackets, choose, told)}


def whole_blocks(source: Path, scope: dict[str, Any]) -> dict[str, Any]:
    """The functions of a search's source with its loops over a block as operations on arrays."""
    names: dict[str, Any] = {"__name__": __name__}
    exec(_code(source), names)
    arrays = {"where": np.where, "count_nonzero": np.count_nonzero, "fabs": np.abs, "uint64": int}
    names |= {**arrays, **SEQUENTIAL, **scope}  # the scope of the functions: they see these
    return names


@cache
def _code(source: Path) -> CodeType:
    tree = _Loops().visit(ast.parse(source.read_text(encoding="utf-8")))
    return compile(ast.fix_missing_locations(tree), "<desaxe search>", "exec")
