"""Reductions of one axis, fused with the loops that compute the values: the grid is never stored.

`emit_reduced` writes a kernel whose innermost axis is reduced. It computes a few rows at a time into
a scratch that stays in the cache, and takes of each row what is wanted: the largest or smallest
number and its place, or a sum. A NaN is skipped, and what is not skipped is counted. Every row is
reduced by one thread in one order, so that the answer does not depend on how many threads there are.
"""

from collections.abc import Mapping, Sequence

from ...builder import function_text, module_text
from ...kernel import Kernel
from ...text import INDENT
from .module import arrays_of, input_types, loops_parts, numba_parts, parameters_of, signature

# Kind -> what it is called in CF's `cell_methods`.
KINDS = {
    "max": "maximum",
    "min": "minimum",
    "absmax": "maximum_absolute_value",
    "mean": "mean",
    "rms": "root_mean_square",
}
EXTREMES = ("max", "min", "absmax")  # these have a place

SCRATCH = 32_768  # doubles: a quarter of a megabyte, for the second-level cache
LONGEST = 2_048  # doubles of a row that are computed at a time


# The tails of the inner loops and of the whole, for a text that the runtime compiles.
TO_COMPILE = (
    'kernel = njit(signature, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)(loops)\n',
    "function, signature = reduced_loops, reduced_signature\n",
)


def emit_reduced(kernel: Kernel, kinds: Sequence[str], docstring: str) -> str:
    """The source of a module whose `reduced_loops` reduces the innermost axis, for the runtime to compile."""
    return module_text(docstring, numba_parts(reduced_parts(kernel, kinds)))


def reduced_parts(kernel: Kernel, kinds: Sequence[str], tails: tuple[str, str] = TO_COMPILE) -> list[str]:
    """`reduced_loops(*inputs, length, *outputs)`, which reduces the innermost axis, and what it calls.

    Precondition: two axes or more; every output is f64. `length` is that of the reduced axis. The
    outputs, over the other axes: for each output of the kernel and each kind the reduced value and,
    of an extreme, its place (int64, -1 where there is none); then how many values counted. `tails`
    say what becomes of the inner `loops` and of `reduced_loops`: by default the runtime compiles them.
    """
    inner, outer = tails
    return [*loops_parts(kernel), inner, *_reduced_loops(kernel, kinds), outer]


def outputs_of(names: Sequence[str], kinds: Sequence[str]) -> list[tuple[str, str]]:
    """The outputs of a reduced kernel in their order: the name and the type of each."""
    found = []
    for name in names:
        for kind in kinds:
            found.append((f"{name}_{kind}", "float64"))
            found += [(f"{name}_{kind}_place", "int64")] if kind in EXTREMES else []
        found.append((f"{name}_count", "int64"))
    return found


def _reduced_loops(kernel: Kernel, kinds: Sequence[str]) -> list[str]:
    """The function of the reductions, and its signature."""
    parameters, types = parameters_of(kernel), [*input_types(kernel), "types.int64"]
    outs = outputs_of(kernel.outputs, kinds)
    shape = ", ".join([":"] * (kernel.axes - 2) + ["::1"])
    types += [f"types.{kind}[{shape}]" for _, kind in outs]
    given = [*parameters, "length", *(f"out_{name}" for name, _ in outs)]
    loops = function_text("reduced_loops", given, _blocks(kernel, kinds, f"out_{outs[0][0]}"))
    return [loops, signature("reduced_signature", "void", types)]


def _blocks(kernel: Kernel, kinds: Sequence[str], measure: str) -> list[str]:
    """Loops over blocks of designs; in each, loops over blocks of the reduced axis, then rows."""
    outer = range(kernel.axes - 1)
    lines = [
        f"step = max(1, min(length, {LONGEST}))",
        f"room = {SCRATCH // len(kernel.outputs)} // step",
    ]
    for axis in reversed(outer):
        lines.append(f"step_{axis} = max(1, min({measure}.shape[{axis}], room))")
        lines.append(f"room //= step_{axis}")
    size = " * ".join(f"step_{axis}" for axis in outer)
    lines += [f"scratch_{name} = empty({size} * step)" for name in kernel.outputs]
    lines += [f"{each} = empty({size})" for each in _state(kernel.outputs, kinds, "float64")]
    lines += [f"{each} = empty({size}, int64)" for each in _state(kernel.outputs, kinds, "int64")]
    for axis in outer:
        pad = INDENT * axis
        lines.append(f"{pad}for b{axis} in range(0, {measure}.shape[{axis}], step_{axis}):")
        lines.append(f"{pad}{INDENT}n{axis} = min(step_{axis}, {measure}.shape[{axis}] - b{axis})")
    return lines + [INDENT * len(outer) + line for line in _block(kernel, kinds)]


def _state(names: Sequence[str], kinds: Sequence[str], kind_of: str) -> list[str]:
    """Names of the arrays that carry a reduction from one part of a row to the next."""
    found = []
    for name in names:
        found += [f"count_{name}"] if kind_of == "int64" else []
        for kind in kinds:
            if kind in EXTREMES:
                found.append(f"{kind}_{name}" if kind_of == "float64" else f"place_{kind}_{name}")
            elif kind_of == "float64":
                found += [f"{kind}_{name}", f"rest_{kind}_{name}"]
                found += [f"factor_{name}"] if kind == "rms" else []
    return found


def _block(kernel: Kernel, kinds: Sequence[str]) -> list[str]:
    """The lines that reduce one block of designs."""
    outer = range(kernel.axes - 1)
    names = kernel.outputs
    rows = " * ".join(f"n{axis}" for axis in outer)
    lines = [f"rows = {rows}"]
    lines += [f"{each}[:] = 0.0" for each in _state(names, kinds, "float64")]
    lines += [f"{each}[:] = {-1 if each[0] == 'p' else 0}" for each in _state(names, kinds, "int64")]
    lines += ["for start in range(0, length, step):", f"{INDENT}n = min(step, length - start)"]
    sizes = ", ".join([*(f"n{axis}" for axis in outer), "n"])
    for name in names:
        lines.append(f"{INDENT}block_{name} = scratch_{name}[: rows * n].reshape(({sizes}))")
    cut = [_cut(name, axis, kernel.axes - 1) for name, axis in kernel.inputs.items()]
    cut += arrays_of(kernel.given)
    lines += [f"{INDENT}kernel(", *(f"{INDENT * 2}{a}," for a in [*cut, *(f"block_{n}" for n in names)])]
    lines += [f"{INDENT})", f"{INDENT}for r in range(rows):"]
    for name in names:
        lines += [INDENT * 2 + line for line in _row(name, kinds)]
    lines.append("for r in range(rows):")
    place = []
    for axis in outer:
        inner = " * ".join(f"n{k}" for k in outer if k > axis)
        part = f"r // ({inner})" if inner else "r"
        place.append(f"b{axis} + {part} % n{axis}")
    lines.append(f"{INDENT}at = ({', '.join(place)},)")
    for name in names:
        lines += [f"{INDENT}{line}" for line in _kept(name, kinds)]
    return lines


def _cut(name: str, axis: int | None, last: int) -> str:
    if axis is None:
        return name
    return f"{name}_axis[start : start + n]" if axis == last else f"{name}_axis[b{axis} : b{axis} + n{axis}]"


def _row(name: str, kinds: Sequence[str]) -> list[str]:
    """The lines that fold one part of a row into its reduction."""
    lines = [f"row = scratch_{name}[r * n : r * n + n]", f"count_{name}[r] += count_valid(row)"]
    for kind in kinds:
        if kind == "rms":
            lines += [
                f"factor = factor_for(row, factor_{name}[r])",
                f"if factor_{name}[r] > 0.0 and factor != factor_{name}[r]:",
                f"{INDENT}change = factor / factor_{name}[r]",
                f"{INDENT}rms_{name}[r] *= change * change",
                f"{INDENT}rest_rms_{name}[r] *= change * change",
                f"factor_{name}[r] = factor",
                f"rms_{name}[r], rest_rms_{name}[r] = take_sum(",
                f"{INDENT}row, factor, 2, rms_{name}[r], rest_rms_{name}[r]",
                ")",
            ]
        else:
            second = f"{'place' if kind in EXTREMES else 'rest'}_{kind}_{name}[r]"
            lines.append(f"{kind}_{name}[r], {second} = take_{kind}(row, start, {kind}_{name}[r], {second})")
    return lines


def _kept(name: str, kinds: Sequence[str]) -> list[str]:
    """The lines that store the results of one row; NaN if no point was valid."""
    lines = [f"counted = count_{name}[r]"]
    value: Mapping[str, str] = {
        "max": f"max_{name}[r]",
        "min": f"-min_{name}[r]",
        "absmax": f"absmax_{name}[r]",
        "mean": f"whole_sum(mean_{name}[r], rest_mean_{name}[r]) / counted",
        "rms": f"sqrt(whole_sum(rms_{name}[r], rest_rms_{name}[r]) / counted) / factor_{name}[r]",
    }
    for kind in kinds:
        wanted = value[kind]
        if kind == "rms":
            lines.append("none = 0.0 if counted > 0 else nan")
            lines.append(f"out_{name}_rms[at] = {wanted} if factor_{name}[r] > 0.0 else none")
            continue
        lines.append(f"out_{name}_{kind}[at] = {wanted} if counted > 0 else nan")
        if kind in EXTREMES:
            lines.append(f"out_{name}_{kind}_place[at] = place_{kind}_{name}[r]")
    return [*lines, f"out_{name}_count[at] = counted"]
