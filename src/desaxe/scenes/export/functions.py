"""Functions of a written module: those that it calls go along, as they stand here (`compiler/builder.py`).

The module itself has the other names that they call.
"""
# ruff: noqa: F821

from math import pi, prod

from numpy import (
    append,
    arange,
    arcsinh,
    argmax,
    array,
    broadcast_to,
    concatenate,
    empty,
    errstate,
    float64,
    frexp,
    inf,
    int8,
    isfinite,
    ldexp,
    nan,
    sinh,
    take_along_axis,
    unique,
    where,
    zeros,
)


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


def with_axes(axes, inputs):
    """The axes, those that are given in their places: arrays of one dimension in the same order."""
    given = columns_of({n: value for n, value in inputs.items() if value is not None}, axes)
    for name, column in given.items():
        if column.ndim > 1:
            raise ValueError(f"{name}: expected a number or one dimension, got the shape {column.shape}")
    return {name: given[name].reshape(-1) if name in given else values for name, values in axes.items()}


# ---- reductions -------------------------------------------------------------------------------------


def reduced(grid_over, axes, along, kinds):
    """Outputs over axes, reduced along the last of them, a part of the grid at a time."""
    first, *rest = [name for name in axes if name != along] or [along]
    size = axes[first].size if first != along else 1
    step = max(1, 2**20 // max(1, axes[along].size * prod(axes[name].size for name in rest)))
    parts = []
    for start in range(0, max(size, 1), step):
        part = {} if first == along else {first: axes[first][start : start + step]}
        grid = grid_over(axes | part)
        parts.append([reductions(name, rows, along, axes[along], kinds) for name, rows in grid.items()])
    whole = [{key: column for one in part for key, column in one.items()} for part in parts]
    if len(whole) == 1:
        return whole[0]
    return {key: concatenate([part[key] for part in whole]) for key in whole[0]}


def reductions(name, rows, along, places, kinds):
    """The reductions of rows by name; what has no value (NaN) is skipped and counted."""
    good = rows == rows
    count = good.sum(axis=-1)
    result = {}
    for kind in kinds:
        if kind in ("mean", "rms"):
            values = where(good, rows, 0.0)
            with errstate(all="ignore"):  # infinities
                mean = exact_mean(values, count) if kind == "mean" else root_mean_square(values, count)
            result[f"{name}_{kind}"] = where(count > 0, mean, nan)
            continue
        score = abs(rows) if kind == "absmax" else -rows if kind == "min" else rows
        # Before the first -inf that is a number there may be one that stands for a NaN.
        best = where(good, score, -inf)
        index = first_true(best == best.max(axis=-1, keepdims=True, initial=-inf))
        index = where(take_along(good, index), index, first_true(good))
        value = where(count > 0, take_along(rows, index), nan)
        result[f"{name}_{kind}"] = abs(value) if kind == "absmax" else value
        result[f"{name}_{kind}_{along}"] = append(places, nan)[where(count > 0, index, places.size)]
    return result | {f"{name}_skipped": rows.shape[-1] - count}


def first_true(rows):
    """The index of the first True of each row, 0 without one."""
    return argmax(rows, axis=-1) if rows.shape[-1] else zeros(rows.shape[:-1], int)


def take_along(rows, index):
    """The element of each row at an index; NaN of rows without one."""
    if not rows.shape[-1]:
        return zeros(rows.shape[:-1], rows.dtype)
    return take_along_axis(rows, index[..., None], -1)[..., 0]


def exact_mean(rows, count):
    """The mean of each row, as if the rounding of its sum were that of a few operations.

    Beside a power of two that is larger than the sum of magnitudes each number splits into a high part, whose
    sum is exact, and a small rest.
    """
    largest = abs(rows).max(axis=-1, keepdims=True, initial=0.0)
    power = ldexp(1.0, (frexp(largest)[1] + rows.shape[-1].bit_length()).clip(None, 1023))
    high = (rows + power) - power
    total = high.sum(axis=-1) + (rows - high).sum(axis=-1)
    return where(isfinite(total), total, rows.sum(axis=-1)) / where(count > 0, count, 1)


def root_mean_square(rows, count):
    """The root of the mean square, of any scale: a power of two brings the squares into range."""
    size = where(isfinite(rows), abs(rows), 0.0).max(axis=-1, keepdims=True, initial=0.0)
    factor = ldexp(1.0, -frexp(where((size < 2.0**500) & (size > 2.0**-400) | (size == 0.0), 0.5, size))[1])
    return exact_mean((rows * factor) ** 2, count) ** 0.5 / factor[..., 0]


# ---- peaks ------------------------------------------------------------------------------------------


def extremum(search, kind, ends, axes, given, inputs, slopes):
    """The peaks of all designs, as arrays over the axes: `value`, `theta` where it is, `status`, derivatives.

    The status is 0, or 4 for bad input; ValueError for a design that stalls or cannot turn fully.

    axes     arrays of the scene, and its inputs that are numbers
    given    the axes that take the place of the scene's, or None, and `threads`
    inputs   the names that the search takes
    slopes   name -> the index of the derivative in what the search gives, 0 without one
    """
    axes, columns = with_axes(axes, given), {}
    varied = [name for name in axes if name in given]
    shape = tuple(axes[name].size for name in varied)
    for name, value in axes.items():
        along = [-1 if name == axis else 1 for axis in varied]
        columns[name] = broadcast_to(array(value).reshape(along), shape).flatten()
    require_turning(columns, *ends)
    size, nodes = prod(shape), nodes_between(*ends)
    designs, theta, out = (
        zeros((len(inputs), size)),
        empty(size),
        empty((1 + max([1, *slopes.values()]), size)),
    )
    for row, name in zip(designs, inputs, strict=True):
        row[:] = columns.get(name, 0.0)
    turns = sine_cosine(nodes)

    def work(first, last):
        search(kind, nodes, turns, designs, first, last, theta, out)

    in_parts(work, size, 1_000 * size, given["threads"])
    value = abs(out[0]) if kind == 0 else out[0]
    sign = where(out[0] < 0.0, -1.0, 1.0) if kind == 0 else 1.0
    result = {"value": value, "theta": theta, "status": where(isfinite(value), 0, 4).astype(int8)}
    result |= {name: sign * out[row] if row else 0.0 * value for name, row in slopes.items()}
    return {name: column.reshape(shape) for name, column in result.items()}


def require_turning(columns, low, high):
    """ValueError for designs that stall or cannot turn fully: their extremes need more than this search."""
    good = columns["BC"] - columns["AB"] - abs(columns["ec"]) > 0.0
    if "alpha" in columns and "omega0" in columns:
        square, twice = columns["omega0"] ** 2, 2.0 * columns["alpha"]
        good &= (square + twice * (low - 1.0) > 0.0) & (square + twice * (high + 1.0) > 0.0)
    if not good.all():
        design = {name: float(column[~good][0]) for name, column in columns.items()}
        raise ValueError(f"{design}: it stalls or cannot turn fully, which needs desaxe.peak")


def nodes_between(low, high):
    """The angles at which a search begins, both ends included: denser towards a quarter turn.

    There peaks become narrow at a change point, as sinh does for steps of its argument.
    """
    least, far = 2.0**-50.5, 1.2
    near = least * sinh(arcsinh(far / least) * arange(106) / 106)
    distances = append(near, far + (0.5 * pi - far) * arange(2))
    quarters = pi * (arange(low // pi - 1.0, high // pi + 2.0) + 0.5)
    angles = quarters[:, None] + append(distances, -distances)
    return unique(append(angles[(angles >= low) & (angles <= high)], [low, high]))
