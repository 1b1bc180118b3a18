"""Blocks of points, rows of a grid and functions of arrays, for modules that people import."""

from concurrent.futures import ThreadPoolExecutor
from math import prod
from os import cpu_count
from typing import TYPE_CHECKING

from numba import njit, types
from numba.extending import overload
from numpy import (
    asarray,
    ascontiguousarray,
    broadcast_shapes,
    broadcast_to,
    can_cast,
    copyto,
    empty,
    float64,
    ndarray,
)

if TYPE_CHECKING:

    def sines(angle, sine, cosine):
        """The sines and cosines of a block of angles: written from a Program."""


BLOCK = 1024  # points: their inputs and sines stay in the cache, and slices cost little beside them


def compiled(function):
    """The function for numba, its machine code kept on disk where numba finds a folder for it."""
    try:
        return njit(cache=True, error_model="numpy", nogil=True)(function)
    except RuntimeError:
        return njit(error_model="numpy", nogil=True)(function)


@njit(error_model="numpy")
def row_number(column, row):
    """Look up what holds in a row of a grid: a column of numbers, each for a period of rows."""
    numbers, period = column
    return numbers[row // period % numbers.size]


@njit(error_model="numpy")
def part_of(column, buffer, start, size):
    """The block of a column, or of the buffer of its one number."""
    return buffer[:size] if column.size == 1 else column[start : start + size]


@njit(error_model="numpy")
def hold(columns, buffers):
    """Repeat the numbers of columns that have but one."""
    for k in range(len(columns)):
        if columns[k].size == 1:
            buffers[k] = columns[k][0]


def unrolled(parameters, over, cell, other=""):
    """A function with a cell for each element of a tuple, another for what is no array: no loop in numba."""

    def typed(kinds):
        cells = [cell if isinstance(kind, types.Array) or not other else other for kind in kinds]
        cells = [one.format(k=k) for k, one in enumerate(cells)]
        body = "; ".join(cells) if " = " in cell else f"return ({', '.join(cells)},)"
        exec(f"def loop({parameters}): {body}", globals(), scope)
        return scope["loop"]

    scope = {"typed": typed}
    exec(f"def stub({parameters}): pass", scope)
    exec(f"def types_of({parameters}): return typed({over})", scope)
    overload(scope["stub"])(scope["types_of"])
    return scope["stub"]


values_at = unrolled("columns, i", "columns", "columns[{k}][i]", "columns[{k}]")
parts_at = unrolled(
    "columns, buffers, start, size", "columns", "part_of(columns[{k}], buffers[{k}], start, size)"
)
rows_at = unrolled("columns, row", "columns", "columns[{k}]", "row_number(columns[{k}], row)")
slices = unrolled("targets, start, stop", "targets", "targets[{k}][start:stop]")
store = unrolled("targets, i, values", "targets", "targets[{k}][i] = values[{k}]")
store_unless = unrolled(
    "wide, targets, i, values", "targets", "targets[{k}][i] = targets[{k}][i] if wide else values[{k}]"
)


def column_of(name, value):
    """An input as an array that numba takes; TypeError that names it if it holds no real numbers."""
    column = asarray(value)
    if column.dtype.kind not in "fiu":
        raise TypeError(f"{name}: expected real numbers, got {column.dtype}")
    column = ascontiguousarray(column, dtype=float64).reshape(column.shape)
    return column if column.flags.writeable and column.flags.aligned else column.copy()


def outputs_of(kinds, shape, out):
    """The arrays to fill by name: new ones, or those of `out` after a check."""
    if out is None:
        return {name: empty(shape, kind) for name, kind in kinds.items()}
    if set(out) != set(kinds):
        raise ValueError(f"out= is a dict with the keys {', '.join(kinds)}, got {', '.join(out)}")
    for name, kind in kinds.items():
        target = out[name]
        if not (
            isinstance(target, ndarray)
            and target.shape == shape
            and can_cast(kind, target.dtype, "same_kind")
        ):
            raise ValueError(f"out= for {name}: expected {kind.__name__} of the shape {shape}")
    return {name: out[name] for name in kinds}


def in_parts(work, count, points, threads):
    """Call work(first, last) for parts of a range, on as many threads as pay."""
    number = max(1, min(threads or cpu_count() or 1, points // 20_000, count))
    if number == 1:
        return work(0, count)
    edges = [count * k // number for k in range(number + 1)]
    with ThreadPoolExecutor(number) as pool:
        list(pool.map(work, edges[:-1], edges[1:]))


def filled(fill, sizes, columns, branch, kinds, targets, threads):
    """The targets, filled by compiled loops; the first of `sizes` is shared by threads."""
    if branch not in (1, -1):
        raise ValueError(f"branch = {branch}: it is +1 or -1")
    flat = {
        name: target.reshape(-1)
        if target.flags.c_contiguous and target.flags.aligned and target.dtype == kinds[name]
        else empty(target.size, kinds[name])
        for name, target in targets.items()
    }
    arrays = tuple(flat.values())

    def work(first, last):
        fill(columns, first, last, *sizes[1:], float(branch), arrays)

    if prod(sizes):
        in_parts(work, sizes[0], prod(sizes), threads)
    for name, target in targets.items():
        if flat[name].base is not target and flat[name] is not target:
            copyto(target, flat[name].reshape(target.shape), casting="same_kind")
    return targets


def broadcast(fill, kinds, inputs, branch, out, threads):
    """Fill outputs of the shape that all inputs broadcast to; those of numbers alone are numbers."""
    columns = [column_of(name, value) for name, value in inputs.items()]
    shape = broadcast_shapes(*(column.shape for column in columns))
    flat = [
        c.reshape(-1) if c.size == 1 or c.shape == shape else broadcast_to(c, shape).flatten()
        for c in columns
    ]
    targets = outputs_of(kinds, shape, out)
    filled(fill, (prod(shape),), tuple(flat), branch, kinds, targets, threads)
    return targets if out is not None or shape else {name: target[()] for name, target in targets.items()}


def meshed(inputs, order=None):
    """The inputs of a grid, each of one dimension along its own; `order` is that in which they come."""
    columns = {name: column_of(name, value) for name, value in inputs.items()}
    for name, column in columns.items():
        if column.ndim > 1:
            raise ValueError(f"{name}: a grid takes numbers and arrays of one dimension, got {column.ndim}")
    left = sum(column.ndim for column in columns.values())
    for name, column in columns.items():
        left -= column.ndim
        columns[name] = column.reshape((-1,) + (1,) * left) if column.ndim else column
    return {name: columns[name] for name in order or columns}


def outer(fill, angle, kinds, inputs, branch, out, threads, order=None):
    """Fill outputs of one dimension for each input of one dimension, in the order of the inputs.

    `order` is that in which `fill` takes them; behind it come sine and cosine of the angle, if there is one.
    """
    columns = meshed(inputs)
    shape = tuple(column.size for column in columns.values() if column.ndim)
    rows, length = prod(shape[:-1]), shape[-1] if shape else 1
    periods, period, left = {}, max(rows, 1), len(shape)
    for name, column in columns.items():
        left -= column.ndim > 0
        period = period // max(column.size, 1) if column.ndim and left else period
        periods[name] = 0 if column.ndim and not left else period if column.ndim else 1
    names = [*(order or columns)]
    if angle is not None:
        names += ["sine", "cosine"]
        columns |= {name: empty(columns[angle].shape) for name in ("sine", "cosine")}
        sines(*(columns[name].reshape(-1) for name in (angle, "sine", "cosine")))
        periods |= dict.fromkeys(("sine", "cosine"), periods[angle])
    parts = [columns[n] if not periods[n] else (columns[n].reshape(-1), periods[n]) for n in names]
    return filled(fill, (rows, length), tuple(parts), branch, kinds, outputs_of(kinds, shape, out), threads)
