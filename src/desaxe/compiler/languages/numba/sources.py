"""Functions whose text goes into modules of numba: blocks of points, functions of arrays, arithmetic.

Nothing here is imported. What numba compiles is typed anew for every module, so that each function more
costs a first call some hundredths of a second.
"""

from concurrent.futures import ThreadPoolExecutor
from inspect import Parameter, signature
from math import cos, fabs, nan, prod, sin
from os import cpu_count
from typing import TYPE_CHECKING

from numba import njit, types
from numba.extending import intrinsic, overload, register_jitable
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
    int64,
    ndarray,
    uint64,
)

if TYPE_CHECKING:
    LIMIT = 0.0  # of an angle whose sine the polynomials give

    def near_sin_cos(angle):
        """Sine and cosine of an angle below the limit: written from a Program."""


BLOCK = 1024  # points: their inputs and sines stay in the cache, and slices cost little beside them
LEAN = {"error_model": "numpy", "no_cfunc_wrapper": True}
inlined = register_jitable(forceinline=True, **LEAN)
inner = njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)


def compiled(function):
    """The function for numba, its machine code kept on disk where numba finds a folder for it."""
    try:
        return njit(cache=True, error_model="numpy", nogil=True)(function)
    except RuntimeError:
        return njit(error_model="numpy", nogil=True)(function)


def by_types(parameters, text_of):
    """A function of tuples whose text depends on the types in them: no loop over a tuple in numba."""

    def typed(*kinds):
        exec(f"def function({parameters}):\n    " + "\n    ".join(text_of(*kinds)), globals(), scope)
        return scope["function"]

    scope = {"typed": typed}
    exec(f"def stub({parameters}): pass\ndef types_of({parameters}): return typed({parameters})", scope)
    overload(scope["stub"], jit_options=LEAN)(scope["types_of"])
    return scope["stub"]


def text_of_rows(test, plain, stable, angles, columns, turns, first, last, length, branch, targets):
    """The loop over some blocks of rows; `turns` are the sine and cosine of `angles`, None: blocks have them.

    A column is an array along a row, one of BLOCK elements for a single number; or numbers, each for a period
    of rows.
    """
    along = "{0}[start:stop] if {0}.size > BLOCK else {0}[: stop - start]"
    number = "{0}[0][row // {0}[1] % {0}[0].size]"
    every = [(f"columns[{k}]", kind) for k, kind in enumerate(columns)]
    inside = isinstance(turns, types.NoneType)
    every += [] if inside else [(f"turns[{k}]", kind) for k, kind in enumerate(turns)]
    values = [(along if isinstance(kind, types.Array) else number).format(name) for name, kind in every]
    values += ["sine", "cosine"] if inside else []
    outs = [f"targets[{k}][row * length + start : row * length + stop]" for k in range(len(targets))]
    yield "blocks = (length + BLOCK - 1) // BLOCK"
    yield "for block in range(first, last):"
    yield "    row, start = block // blocks, block % blocks * BLOCK"
    yield "    stop = min(start + BLOCK, length)"
    yield f"    sine, cosine = sine_cosine({along.format('angles')})" if inside else ""
    yield f"    fill_block(test, plain, stable, ({', '.join(values)}, branch), ({', '.join(outs)},))"


def text_of_block(test, plain, stable, columns, targets):
    """The loops of a block: `plain` first, if there is one, then `stable` where that does not hold.

    Arrays have names: numba would count references to an element of a tuple at each point.
    """
    indices = ["[i]" if isinstance(kind, types.Array) else "" for kind in columns]
    inputs = ", ".join(f"c{k}{index}" for k, index in enumerate(indices))
    store = "; ".join(f"t{k}[i] = values[{k}]" for k in range(len(targets)))
    yield "apart()"
    yield "; ".join(f"c{k} = columns[{k}]" for k in range(len(columns)))
    yield "; ".join(f"t{k} = targets[{k}]" for k in range(len(targets)))
    yield "size, count = uint64(t0.size), uint64(0)"
    if isinstance(plain, types.NoneType):
        yield f"for i in range(size): values = stable({inputs}); {store}"
        return
    # The test has a loop of its own: with thirteen outputs beside it, it costs as much as all of them.
    yield f"for i in range(size): count += uint64(1) if test({inputs}) else uint64(0)"
    yield "if count > uint64(0):"
    yield f"    for i in range(size): values = plain({inputs}); {store}"
    unless = "; ".join(f"t{k}[i] = t{k}[i] if wide else values[{k}]" for k in range(len(targets)))
    yield "if count == size: return"
    yield f"for i in range(size): wide = test({inputs}); values = stable({inputs}); {unless}"


fill_rows = by_types(
    "test, plain, stable, angles, columns, turns, first, last, length, branch, targets", text_of=text_of_rows
)
fill_block = by_types("test, plain, stable, columns, targets", text_of=text_of_block)


@compiled
def sine_cosine(angles):
    """The sines and cosines of angles."""
    turns = empty((2, angles.size))
    sines(angles, turns[0], turns[1])
    return turns[0], turns[1]


# ---- functions of arrays ----------------------------------------------------------------------------


def results(*names):
    """The types of results by name."""
    return {name: int8 if name == "status" else float64 for name in names}


def units(inputs, outputs, *texts):
    """The units of inputs and outputs by name."""
    return dict(zip((*inputs, *outputs), texts, strict=True))


def functions_of_arrays(fill, point, kinds, names, angle=None, halves=(), fixed=(), rows=True):
    """`evaluate` and `grid` of a module, with the parameters of its `point`.

    names    of the inputs that callers give; `fixed` are numbers that formulas take besides
    angle    the input of which blocks or `turns` have sine and cosine
    halves   input -> the input of which it is half by default: a centre of mass halfway along its link
    rows     whether formulas take numbers of rows; else a grid runs as points
    """
    taken = signature(point.py_func)
    more = [Parameter(name, Parameter.POSITIONAL_OR_KEYWORD, default=None) for name in ("out", "threads")]
    taken = taken.replace(parameters=[*taken.parameters.values(), *more])

    def function_of(name, is_grid, how):
        def function(*arguments, **named):
            bound = taken.bind(*arguments, **named)
            bound.apply_defaults()
            inputs = dict.fromkeys([*list(taken.parameters)[: len(arguments)], *named])
            inputs |= {**bound.arguments, **dict(fixed)}
            columns = columns_of(inputs, (*names, *fixed), halves, is_grid)
            shape = broadcast_shapes(*(column.shape for column in columns.values()))
            if is_grid and rows:
                parts, turns = as_rows(columns, shape, angle)
                sizes = prod(shape[:-1]), shape[-1] if shape else 1
            else:
                parts, turns, sizes = as_points(columns, shape), None if angle else (), (1, prod(shape))
            return filled(fill, parts, turns, *sizes, shape, kinds, inputs)

        function.__name__ = function.__qualname__ = name
        function.__module__, function.__signature__ = point.__module__, taken
        function.__doc__ = f"{point.__doc__.partition(' at a point')[0]} by name: {how}."
        return function

    broadcasts = "inputs broadcast like NumPy's; numbers give numbers"
    axes = "one dimension for each input of one dimension, in the order in which they are given"
    return function_of("evaluate", False, broadcasts), function_of("grid", True, axes)


def columns_of(inputs, names, halves=(), is_grid=False):
    """Inputs as arrays, in a grid along its dimensions; TypeError for one that holds no real numbers."""
    columns, along = {}, {}
    for name in [name for name in inputs if name in names]:
        half = inputs[name] is None and name in halves
        column = 0.5 * asarray(inputs[halves[name]]) if half else asarray(inputs[name])
        if column.dtype.kind not in "fiu":
            raise TypeError(f"{name}: expected real numbers, got {column.dtype}")
        if is_grid and column.ndim > 1:
            raise ValueError(f"{name}: a grid takes numbers and arrays of one dimension, got {column.ndim}")
        column = ascontiguousarray(column, dtype=float64).reshape(column.shape)
        columns[name] = column if column.flags.writeable and column.flags.aligned else column.copy()
        along[name] = halves[name] if half else name
    axes = [name for name, column in columns.items() if is_grid and column.ndim and along[name] == name]
    for name, column in columns.items():
        if is_grid and column.ndim:
            columns[name] = column.reshape([-1 if axis == along[name] else 1 for axis in axes])
    return {name: columns[name] for name in names if name in columns}


def as_points(columns, shape):
    """The columns of all points, as one row."""
    size = min(prod(shape), BLOCK)

    def part(column):
        whole = column if column.shape == shape else broadcast_to(column, shape).copy()
        return full(size, column.item()) if column.size == 1 else whole.reshape(-1)

    return tuple(map(part, columns.values()))


def as_rows(columns, shape, angle):
    """The columns of the rows of a grid, and those of the sine and cosine of an angle."""

    def part(column, like):
        along = max((k for k, size in enumerate(like.shape) if size > 1), default=-1)
        return column if 0 <= along == len(shape) - 1 else (column, prod(shape[along + 1 : -1]) or 1)

    turns = sine_cosine(columns[angle].reshape(-1)) if angle else ()
    parts = tuple(part(column.reshape(-1), column) for column in columns.values())
    return parts, tuple(part(turn, columns[angle]) for turn in turns)


def filled(fill, columns, turns, rows, length, shape, kinds, inputs):
    """The outputs by name, filled by a compiled loop; threads share its blocks."""
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
        fill(columns, turns, first, last, length, float(branch), tuple(targets))

    if prod(shape):
        in_parts(work, rows * -(-length // BLOCK), prod(shape), inputs["threads"])
    arrays = {name: target.reshape(shape)[()] for name, target in zip(kinds, targets, strict=True)}
    if out is None:
        return arrays
    for name in copied:
        copyto(out[name], arrays[name], casting="same_kind")
    return {name: out[name] for name in kinds}


def in_parts(work, count, points, threads):
    """Call work(first, last) for parts of a range, on as many threads as pay."""
    number = max(1, min(threads or cpu_count() or 1, points // 20_000, count))
    edges = [count * k // number for k in range(number + 1)]
    if number == 1:
        return work(0, count)
    with ThreadPoolExecutor(number) as pool:
        list(pool.map(work, edges[:-1], edges[1:]))


# ---- arithmetic -------------------------------------------------------------------------------------


@inner
def finite(x):
    """The number, NaN where it is infinite."""
    return x if fabs(x) <= 1.7976931348623157e308 else nan


@inner
def at_least(least, x):
    """The number, NaN where it is infinite or too small."""
    return x if (x <= 1.7976931348623157e308) & (least <= x) else nan


def multiply_add(name):
    """a * b + c as one instruction: a product that LLVM moved out of a loop would not be fused any more."""

    @intrinsic
    def function(typingctx, a, b, c):
        def code(context, builder, kinds, args):
            number = args[0].type
            kind = type(builder.function.ftype)(number, [number] * 3)
            return builder.call(builder.module.declare_intrinsic(name, [number], kind), args)

        return types.float64(types.float64, types.float64, types.float64), code

    return function


# The first is rounded once where the machine can, else twice; the second always once.
mul_add, fused = multiply_add("llvm.fmuladd"), multiply_add("llvm.fma")


@inner
def two_product_error(a, b):
    """The rounding error of a * b, exactly."""
    return fused(a, b, -(a * b))


@inner
def rotated(odd, even, quarters):
    """The one or the other by the parity of a whole number, with the sign of half of it."""
    # Beyond 2^52 the last bits of a number are those of the whole number that was added.
    bits = float64(quarters + 6755399441055744.0).view(int64)
    value = float64(odd if bits & 1 else even).view(int64)
    return int64(value ^ (bits >> 1 << 63)).view(float64)


@inner
def rotated_sin(sine, cosine, quarters):
    """The sine of an angle and a whole number of quarter turns."""
    return rotated(cosine, sine, quarters)


@inner
def rotated_cos(sine, cosine, quarters):
    """The cosine of an angle and a whole number of quarter turns."""
    return rotated(cosine, sine, quarters + 1.0)


@inlined
def sin_cos(angle):
    """Sine and cosine of any angle."""
    if fabs(angle) <= LIMIT:
        return near_sin_cos(angle)
    return sin(angle), cos(angle)


@compiled
def sines(angle, sine, cosine):
    """The sines and cosines of a block of angles."""
    apart()
    size, near = uint64(angle.size), uint64(0)
    for i in range(size):
        near += uint64(1) if fabs(angle[i]) <= LIMIT else uint64(0)
        sine[i], cosine[i] = near_sin_cos(angle[i])
    if near < size:
        for i in range(size):
            if not fabs(angle[i]) <= LIMIT:
                sine[i], cosine[i] = sin(angle[i]), cos(angle[i])


@intrinsic
def apart(typingctx):
    """Mark the arrays that a function takes as separate (noalias), and ask for the widest vectors."""

    def code(context, builder, kinds, args):
        for argument in context.call_conv.get_arguments(builder.function):
            if argument.type.is_pointer:
                argument.add_attribute("noalias")
        # past llvmlite's list of attributes, which has none with a value
        set.add(builder.function.attributes, '"prefer-vector-width"="512"')
        return context.get_dummy_value()

    return types.none(), code
