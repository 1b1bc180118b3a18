"""Functions of a written module: those that it calls go along, as they stand here (`compiler/builder.py`).

The module itself has the other names that they call.
"""
# ruff: noqa: F821

from concurrent.futures import ThreadPoolExecutor
from math import prod
from os import cpu_count

from numpy import (
    arange,
    asarray,
    ascontiguousarray,
    broadcast_shapes,
    broadcast_to,
    empty,
    errstate,
    float64,
    int8,
    isfinite,
    where,
)  # fmt: skip


def doubles(**inputs):
    """The inputs in doubles; text, which may carry a unit, is refused."""
    held = {name: asarray(given) for name, given in inputs.items()}
    for name, numbers in held.items():
        if numbers.dtype.kind in "US":
            raise TypeError(f"{name} = {inputs[name]!r}: expected numbers in SI units, not text")
    return [asarray(numbers, float64) for numbers in held.values()]


def in_blocks(block, length, points, threads):
    """Call block(start, stop) for as many parts of an axis as there are threads that pay."""
    cores = len(sched_getaffinity(0)) if sched_getaffinity else cpu_count() or 1
    count = max(1, min(threads or cores, points // 20_000, length))
    edges = [length * k // count for k in range(count + 1)]
    if count == 1:
        return block(0, length)
    with ThreadPoolExecutor(count) as pool:
        list(pool.map(block, edges[:-1], edges[1:]))


def spaced(first, rest, step, num):
    """num values from first + rest on, correctly rounded; step is in parts, whose products are exact."""
    k = arange(num, dtype=float64)
    wide, narrow = k * step[0], k * step[1]
    total = wide + narrow
    lost = narrow - (total - wide)
    value = first + total
    of_total = value - first
    more = (first - (value - of_total)) + (total - of_total)
    return value + (more + (lost + (k * step[2] + rest)))


def with_axes(axes, given):
    """The axes of the scene, with those that are given in their places: 1-d arrays in the same order."""
    axes = dict(axes)
    for name, values in given.items():
        if values is not None:
            (numbers,) = doubles(**{name: values})
            if numbers.ndim > 1:
                raise ValueError(f"{name}: expected a number or one dimension, got the shape {numbers.shape}")
            axes[name] = ascontiguousarray(numbers.reshape(-1))
    return axes


def require_turning(columns, low, high):
    """ValueError for designs that stall or cannot turn fully: their extremes need more than this search."""
    good = columns["BC"] - columns["AB"] - abs(columns["ec"]) > 0.0
    if "alpha" in columns and "omega0" in columns:
        square, twice = columns["omega0"] ** 2, 2.0 * columns["alpha"]
        good &= (square + twice * (low - 1.0) > 0.0) & (square + twice * (high + 1.0) > 0.0)
    if not good.all():
        design = {name: float(column[~good][0]) for name, column in columns.items()}
        raise ValueError(f"{design}: it stalls or cannot turn fully, which needs desaxe.peak")


TABLES = "void(float64[:, ::1], float64[:, ::1])"
DESIGNS = 256  # of a block, whose arrays stay in the cache


def by_points(loops, rows, arrays):
    """Run loops over the points of arrays that broadcast; a row for each result."""
    shape = broadcast_shapes(*(values.shape for values in arrays))
    given, out = empty((len(arrays), *shape)), empty((rows, *shape))
    for row, values in zip(given, arrays, strict=True):
        row[...] = values
    compiled(loops, TABLES)(given.reshape(len(arrays), -1), out.reshape(rows, -1))
    return out if rows > 1 else out[0]


def extremum(one, given, threads):
    """The peaks of all designs: of the scene's axes, with those that are given in their places."""
    axes = with_axes(one["axes"], given)
    shape = tuple(axis.size for axis in axes.values())
    size = prod(shape)
    columns = {name: empty(size) for name in (*axes, *one["fixed"])}
    for place, (name, axis) in enumerate(axes.items()):
        along = axis.reshape([-1 if k == place else 1 for k in range(len(shape))])
        columns[name][:] = broadcast_to(along, shape).reshape(-1)
    for name, value in one["fixed"].items():
        columns[name][:] = value
    low, high = one["theta"]
    require_turning(columns, low, high)
    table = empty((len(one["inputs"]), size))
    for row, name in zip(table, one["inputs"], strict=True):
        row[:] = columns[name]
    margin = (columns["BC"] - columns["AB"] - abs(columns["ec"])) / columns["AB"]
    nodes = nodes_between(low, high, margin.min())[:, None]
    theta, out = empty(size), empty((one["rows"], size))

    def curve(angles, own):
        return by_points(one["curve"], 2, (angles, *own))

    def finish(angles, own):
        return by_points(one["finish"], one["rows"], (angles, *own))

    def block(start, stop):
        with errstate(all="ignore"):
            for first in range(start, stop, DESIGNS):
                part = slice(first, min(first + DESIGNS, stop))
                theta[part], out[:, part] = search_block(curve, finish, one["kind"], nodes, table[:, part])

    in_blocks(block, size, 1_000 * size, threads)
    value = abs(out[0]) if one["kind"] == 0 else out[0]
    found = {"value": value, "theta": theta, "status": where(isfinite(value), 0, 4).astype(int8)}
    found |= {name: out[row] if row else 0.0 * value for name, row in one["slopes"].items()}
    return {name: column.reshape(shape) for name, column in found.items()}
