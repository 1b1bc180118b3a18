"""The public functions of a compiled module as text: `point`, `evaluate`, `run`."""

from collections.abc import Iterable, Mapping, Sequence
from textwrap import wrap

from ...compiler.languages.numba.reductions import KINDS, outputs_of
from ...compiler.languages.protocol import OpenTable
from ...compiler.languages.tables import columns_of, period_of
from ...compiler.program import Program
from ...compiler.text import with_short_temporaries, write_lines
from ...mechanism.catalogue import quantity
from ...mechanism.inputs import INPUTS
from .axes import arguments_of, taken_from

Tables = Mapping[str, OpenTable]

THREADS = '''def in_blocks(block, length, points, threads):
    """Call block(start, stop) for as many parts of an axis as there are threads that pay."""
    cores = len(sched_getaffinity(0)) if sched_getaffinity else cpu_count() or 1
    count = max(1, min(threads or cores, points // 20_000, length))
    edges = [length * k // count for k in range(count + 1)]
    if count == 1:
        return block(0, length)
    with ThreadPoolExecutor(count) as pool:
        list(pool.map(block, edges[:-1], edges[1:]))
'''
AFFINITY = """try:
    from os import sched_getaffinity
except ImportError:  # not on this system
    sched_getaffinity = None
"""
DOUBLES = '''def doubles(**inputs):
    """The inputs in doubles; text, which may carry a unit, is refused."""
    held = {name: asarray(given) for name, given in inputs.items()}
    for name, numbers in held.items():
        if numbers.dtype.kind in "US":
            raise TypeError(f"{name} = {inputs[name]!r}: expected numbers in SI units, not text")
    return [asarray(numbers, float64) for numbers in held.values()]
'''


TAKEN = '''def taken_table(x, c, ways, period):
    """What the code takes of a table: two numbers, knots, coefficients; zeros where something is none."""
    x, c = (ascontiguousarray(column).reshape(-1) for column in doubles(knots=x, coefficients=c))
    valid, first = checked_table(x, c, ways, period)
    return (valid, first, x, c) if valid == 0.0 else (valid, 0.0, arange(2.0), zeros(24))
'''


def taking(tables: Mapping[str, OpenTable]) -> list[str]:
    """The lines that take the tables."""
    return [
        f"{n}_valid, {n}_first, {n}_x, {n}_c = "
        f"taken_table({n}_x, {n}_c, {table.ways}, {period_of(table, 'inf')})"
        for n, table in tables.items()
    ]


def call_of(inputs: Mapping[str, int | None], tables: Iterable[str]) -> list[str]:
    """The arguments of a kernel over axes, of which the first is cut into blocks."""
    own = {None: "{}", 0: 'axes["{}"][start:stop]'}
    given = [own.get(axis, 'axes["{}"]').format(name) for name, axis in inputs.items()]
    return [*given, *(f"{name}_{end}" for name in tables for end in "xc")]


def described(names: Iterable[str], state: bool) -> list[str]:
    """A line for each name: its unit and what it is."""
    lines = []
    for name in names:
        row = INPUTS.get(name) or quantity(name, state)
        lines.append(f"{name:10} {f'[{row.unit}] ' if row.unit != '1' else ''}{row.meaning}")
    return lines


def docstring(first: str, lines: Sequence[str]) -> list[str]:
    """A docstring, wrapped."""
    wrapped = [
        row
        for line in lines
        for row in (wrap(line, 92, subsequent_indent=" " * 11 if "[" in line[:14] else "") or [""])
    ]
    return [f'"""{first}', *([""] if wrapped else []), *wrapped, '"""'] if wrapped else [f'"""{first}"""']


def point_function(
    program: Program, inputs: Sequence[str], shown: Sequence[str], state: bool, tables: Tables
) -> str:
    """`point(...)` in plain math, with the helpers that it calls."""
    body = write_lines(with_short_temporaries(program), "python")
    returned = ", ".join(program.outputs)
    told = [*described(inputs, state), "", "Gives:", *described(shown, state)]
    types = ", ".join(f"type({name})" for name in inputs)
    check = [f"if str in ({types},):", f"    {_doubles(inputs)}  # says what is wrong"]
    lines = [
        f"def point({', '.join([*inputs, *columns_of(tables)])}):",
        *indented(docstring("One point in plain Python, nothing compiled: numbers in, a tuple out.", told)),
        *indented(check if inputs else []),
        *indented(taking(tables)),
        *indented(body),
        f"    return ({returned},)",
        "",
    ]
    return "\n".join(lines)


def _doubles(inputs: Iterable[str]) -> str:
    return f"doubles({', '.join(f'{name}={name}' for name in inputs)})"


def indented(lines: Iterable[str]) -> list[str]:
    """The lines one level in."""
    return [f"    {line}" if line else "" for line in lines]


def evaluate_function(
    inputs: Sequence[str],
    shown: Sequence[str],
    state: bool,
    limit: float | None,
    kernel: Mapping[str, int | None],
    tables: Tables,
) -> str:
    """`evaluate(...)`: numbers by `point`, arrays by the kernel, broadcast like NumPy."""
    columns = columns_of(tables)
    told = [
        *described(inputs, state),
        "",
        "Numbers or arrays that broadcast together; a dict of floats or arrays comes back. What has "
        "no value is NaN" + (", and `status` tells why." if "status" in shown else "."),
        "`threads`: how many share the work, all cores without; the answer is the same.",
    ]
    if not inputs:
        return "\n".join(
            [
                f"def evaluate({', '.join(columns)}):",
                *indented(docstring("The values; every input is fixed.", [])),
                f"    return dict(zip(OUTPUTS, point({', '.join(columns)}), strict=True))",
                "",
            ]
        )
    head = ", ".join([*inputs, *columns])
    of_point = ", ".join(["*(float(a) for a in arrays)", *columns])
    more = [*(name for name, axis in kernel.items() if axis is None), *columns]
    of_kernel = ", ".join(["*(a[start:stop] for a in flat)", *more, "*(a[start:stop] for a in places)"])
    check = []
    if limit is not None and "theta" in inputs:
        place = f"arrays[{inputs.index('theta')}]"
        check = [
            f"    reach = max(-{place}.min(initial=0.0), {place}.max(initial=0.0))",
            f"    if not reach <= {limit!r} and (abs({place}[isfinite({place})]) > {limit!r}).any():",
            f'        raise ValueError("theta: at most {limit:.0f} rad in magnitude; take whole turns off")',
        ]
    return "\n".join(
        [
            f"def evaluate({head}, threads=None):",
            *indented(docstring(f"{', '.join(shown)} at points of your own.", told)),
            f"    arrays = broadcast_arrays(*{_doubles(inputs)})",
            *check,
            "    if not arrays[0].ndim:",
            f"        return dict(zip(OUTPUTS, point({of_point}), strict=True))",
            *indented(taking(tables)),
            "    flat = [ascontiguousarray(a).reshape(-1) for a in arrays]",
            "    out = {name: empty(arrays[0].shape, kind) for name, kind in OUTPUTS.items()}",
            "    places = [place.reshape(-1) for place in out.values()]",
            "",
            "    def block(start, stop):",
            f"        point_kernel({of_kernel})",
            "",
            "    in_blocks(block, flat[0].size, flat[0].size, threads)",
            "    return out",
            "",
        ]
    )


def run_function(
    names: Sequence[str],
    axes: Sequence[str],
    inputs: Mapping[str, int | None],
    own_axes: Mapping[str, Sequence[str]],
    tables: Tables,
) -> str:
    """`run()`: the outputs over the outer product of the scene's axes, or of others in their place.

    `own_axes` are those of quantities of a whole design, which have no others.
    """
    others = {n: tuple(k for k, a in enumerate(axes) if a not in own) for n, own in own_axes.items()}
    left = [
        f'    out["{name}"] = fmax.reduce(out["{name}"], axis={places}, initial=nan)  # the same everywhere'
        for name, places in others.items()
        if places
    ]
    told = [
        "A dict of arrays, one dimension per axis: " + " x ".join(axes) + ".",
        *(f"{name} has {' x '.join(own_axes[name]) or 'none'} alone." for name in others if others[name]),
        "An axis that is given takes the place of the scene's.",
    ]
    kernel = "point_kernel" if len(axes) == 1 else "grid_kernel"
    given = ", ".join([*call_of(inputs, tables), "*(a[start:stop] for a in out.values())"])
    return "\n".join(
        [
            f"def run({', '.join([*columns_of(tables), arguments_of(axes)])}):",
            *indented(docstring(f"{', '.join(names)} over the scene's axes.", told)),
            taken_from(axes),
            *indented(taking(tables)),
            "    shape = tuple(axis.size for axis in axes.values())",
            "    out = {name: empty(shape, kind) for name, kind in OUTPUTS.items()}",
            "",
            "    def block(start, stop):",
            f"        {kernel}({given})",
            "",
            "    in_blocks(block, shape[0], prod(shape), threads)",
            *left,
            "    return out",
            "",
        ]
    )


def run_reduced_function(
    names: Sequence[str],
    kinds: Sequence[str],
    axes: Sequence[str],
    inputs: Mapping[str, int | None],
    own: Sequence[str],
    tables: Tables,
) -> str:
    """`run()` of a scene with a reduction: the last axis is reduced, the grid is not stored."""
    last = axes[-1]
    rest = [axis for axis in axes[:-1] if axis]
    told = [
        f"A dict of arrays over {' x '.join(rest) or 'nothing'}: for each name "
        + ", ".join(f"`_{kind}`, {KINDS[kind].replace('_', ' ')}" for kind in kinds)
        + f"; `_<extreme>_{last}`, where it is; `_skipped`, how many points along {last} have no value.",
    ]
    outs = outputs_of(own, kinds)
    shown = outputs_of(names, kinds)
    given = call_of(inputs, tables)
    lines = [
        f"def run({', '.join([*columns_of(tables), arguments_of([axis for axis in axes if axis])])}):",
        *indented(docstring(f"{', '.join(names)} over the scene's axes, {last} reduced.", told)),
        taken_from([axis for axis in axes if axis]),
        *indented(taking(tables)),
        f"    shape = tuple(axes[name].size for name in {tuple(rest)!r}) or (1,)",
        f'    length = axes["{last}"].size',
        "    places = [",
        *(f"        empty(shape, {kind})," for _, kind in outs),
        "    ]",
        "",
        "    def block(start, stop):",
        f"        reduced({', '.join([*given, 'length', '*(a[start:stop] for a in places)'])})",
        "",
        "    in_blocks(block, shape[0], prod(shape) * length, threads)",
        f'    at = append(axes["{last}"], nan)  # -1: nowhere',
    ]
    if not rest:
        lines.append("    places = [place[0] for place in places]")
    lines.append("    return {")
    for index, (name, kind) in enumerate(shown):
        if name.endswith("_count") and kind == "int64":
            lines.append(f'        "{name.removesuffix("_count")}_skipped": length - places[{index}],')
        elif kind == "int64":
            lines.append(f'        "{name.removesuffix("_place")}_{last}": at[places[{index}]],')
        else:
            lines.append(f'        "{name}": places[{index}],')
    return "\n".join([*lines, "    }", ""])
