"""Blocks of points, rows of a grid and functions of arrays, for modules that people import."""

from concurrent.futures import ThreadPoolExecutor
from math import prod
from os import cpu_count
from typing import TYPE_CHECKING

from numba import njit, types
from numba.extending import overload, register_jitable
from numpy import (
    asarray,
    ascontiguousarray,
    broadcast_shapes,
    broadcast_to,
    can_cast,
    copyto,
    empty,
    float64,
    full,
    int8,
    ndarray,
    uint64,
)

if TYPE_CHECKING:

    def apart():
        """Mark the arrays that a function takes as separate: an intrinsic of `spellings`."""

    def sines(angle, sine, cosine):
        """The sines and cosines of a block of angles: written from a Program."""


BLOCK = 1024  # points: their inputs and sines stay in the cache, and slices cost little beside them
inlined = register_jitable(error_model="numpy", forceinline=True)
inner = njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)


def compiled(function):
    """The function for numba, its machine code kept on disk where numba finds a folder for it."""
    try:
        return njit(cache=True, error_model="numpy", nogil=True)(function)
    except RuntimeError:
        return njit(error_model="numpy", nogil=True)(function)


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
parts_at = unrolled("columns, start, size", "columns", "part_of(columns[{k}], start, size)")
rows_at = unrolled("columns, row", "columns", "columns[{k}]", "row_number(columns[{k}], row)")
slices = unrolled("targets, start, stop", "targets", "targets[{k}][start:stop]")
store = unrolled("targets, i, values", "targets", "targets[{k}][i] = values[{k}]")
store_unless = unrolled(
    "wide, targets, i, values", "targets", "targets[{k}][i] = targets[{k}][i] if wide else values[{k}]"
)


@inner
def part_of(column, start, size):
    """The block of a column: one of BLOCK elements holds a single number."""
    first = start if column.size > BLOCK else 0
    return column[first : first + size]


@inner
def row_number(column, row):
    """Look up what holds in a row of a grid: a column of numbers, each for a period of rows."""
    numbers, period = column
    return numbers[row // period % numbers.size]


@inner
def fill_block(test, plain, stable, columns, targets):
    """Fill the outputs of a block: `plain` first, if there is one, then `stable` where that does not hold."""
    apart()
    size, count = uint64(targets[0].size), uint64(0)
    if plain is None:
        for i in range(size):
            store(targets, i, stable(*values_at(columns, i)))
    else:
        for i in range(size):
            values = values_at(columns, i)
            count += uint64(1) if test(*values) else uint64(0)
            store(targets, i, plain(*values))
        if count < size:
            for i in range(size):
                values = values_at(columns, i)
                store_unless(test(*values), targets, i, stable(*values))


@inner
def fill_points(test, plain, stable, angle, columns, first, last, branch, targets):
    """Fill the outputs of points, a block at a time; `angle` is the index of the crank angle."""
    turns = empty((2, BLOCK))
    for start in range(first, last, BLOCK):
        stop = min(start + BLOCK, last)
        parts, outs = parts_at(columns, start, stop - start), slices(targets, start, stop)
        if angle is None:
            fill_block(test, plain, stable, (*parts, branch), outs)
        else:
            sine, cosine = turns[0, : stop - start], turns[1, : stop - start]
            sines(parts[angle], sine, cosine)
            fill_block(test, plain, stable, (*parts, sine, cosine, branch), outs)


@inner
def fill_grid(test, plain, stable, columns, first, last, length, branch, targets):
    """Fill rows of a grid: a column is an array along a row, or numbers of rows with a period."""
    for row in range(first, last):
        outs = slices(targets, row * length, (row + 1) * length)
        fill_block(test, plain, stable, (*rows_at(columns, row), branch), outs)


def results(*names):
    """The types of results by name."""
    return {name: int8 if name == "status" else float64 for name in names}


def columns_of(inputs, names, halves):
    """The inputs of these names as arrays; TypeError for one that holds no real numbers.

    A None is half the input that `halves` names: a centre of mass halfway along its link.
    """
    columns = {}
    for name in [name for name in inputs if name in names]:
        half = inputs[name] is None and name in halves
        column = 0.5 * columns[halves[name]] if half else asarray(inputs[name])
        if column.dtype.kind not in "fiu":
            raise TypeError(f"{name}: expected real numbers, got {column.dtype}")
        column = ascontiguousarray(column, dtype=float64).reshape(column.shape)
        columns[name] = column if column.flags.writeable and column.flags.aligned else column.copy()
    return columns


def in_parts(work, count, points, threads):
    """Call work(first, last) for parts of a range, on as many threads as pay."""
    number = max(1, min(threads or cpu_count() or 1, points // 20_000, count))
    edges = [count * k // number for k in range(number + 1)]
    if number == 1:
        return work(0, count)
    with ThreadPoolExecutor(number) as pool:
        list(pool.map(work, edges[:-1], edges[1:]))


def filled(fill, sizes, columns, shape, kinds, inputs):
    """The outputs by name, filled by compiled loops; threads share the first of `sizes`."""
    branch, out = inputs.get("branch", 1), inputs.get("out")
    if branch not in (1, -1):
        raise ValueError(f"branch = {branch}: it is +1 or -1")
    if out is not None and set(out) != set(kinds):
        raise ValueError(f"out= is a dict with the keys {', '.join(kinds)}, got {', '.join(out)}")
    targets, copied = [], []
    for name, kind in kinds.items():
        target = None if out is None else out[name]
        fits = isinstance(target, ndarray) and target.shape == shape
        if target is not None and not (fits and can_cast(kind, target.dtype, "same_kind")):
            raise ValueError(f"out= for {name}: expected {kind.__name__} of the shape {shape}")
        direct = fits and target.flags.carray and target.dtype == kind
        targets.append(target.reshape(-1) if direct else empty(prod(shape), kind))
        copied += [] if direct else [name]

    def work(first, last):
        fill(columns, first, last, *sizes[1:], float(branch), tuple(targets))

    if prod(sizes):
        in_parts(work, sizes[0], prod(sizes), inputs["threads"])
    arrays = {name: target.reshape(shape)[()] for name, target in zip(kinds, targets, strict=True)}
    if out is None:
        return arrays
    for name in copied:
        copyto(out[name], arrays[name], casting="same_kind")
    return {name: out[name] for name in kinds}


def broadcast(fill, names, kinds, inputs, halves=()):
    """Fill outputs of the shape that all inputs broadcast to; those of numbers alone are numbers."""
    columns = columns_of(inputs, names, halves)
    shape = broadcast_shapes(*(column.shape for column in columns.values()))
    size, flat = prod(shape), []
    for column in (columns[name] for name in names):
        if column.size == 1:
            flat.append(full(min(size, BLOCK), column.item()))
        else:
            flat.append((column if column.shape == shape else broadcast_to(column, shape).copy()).reshape(-1))
    return filled(fill, (size,), tuple(flat), shape, kinds, inputs)


def meshed(inputs, names, halves=()):
    """The inputs of a grid, each of one dimension along its own, in the order in which they come."""
    columns = columns_of(inputs, names, halves)
    for name, column in columns.items():
        if column.ndim > 1:
            raise ValueError(f"{name}: a grid takes numbers and arrays of one dimension, got {column.ndim}")
    axes = [name for name, column in columns.items() if column.ndim and inputs[name] is not None]
    for name, column in columns.items():
        along = name if inputs[name] is not None else halves[name]
        if column.ndim:
            columns[name] = column.reshape([-1 if axis == along else 1 for axis in axes])
    return axes, columns


def outer(fill, angle, names, kinds, inputs, halves=()):
    """Fill outputs of one dimension for each input of one dimension, in the order of the inputs.

    `fill` takes the inputs as `names` has them, then sine and cosine of the angle, if there is one.
    """
    axes, columns = meshed(inputs, names, halves)
    shape = tuple(columns[name].size for name in axes)
    pairs = [(name if inputs[name] is not None else halves[name], columns[name]) for name in names]
    if angle is not None:
        turns = empty((2, columns[angle].size))
        sines(columns[angle].reshape(-1), turns[0], turns[1])
        pairs += [(angle, turns[0]), (angle, turns[1])]
    period = {name: prod(shape[k + 1 : -1]) for k, name in enumerate(axes[:-1])}
    flat = [(name, column.reshape(-1)) for name, column in pairs]
    parts = [column if [name] == axes[-1:] else (column, period.get(name, 1)) for name, column in flat]
    sizes = prod(shape[:-1]), shape[-1] if shape else 1
    return filled(fill, sizes, tuple(parts), shape, kinds, inputs)
