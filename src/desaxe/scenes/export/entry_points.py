"""The public functions of a compiled module as text: `point`, `evaluate`, `run`."""

from collections.abc import Iterable, Mapping, Sequence
from textwrap import wrap

from ...compiler.languages.numba.reductions import KINDS, outputs_of
from ...compiler.program import Program
from ...compiler.text import with_short_temporaries, write_lines
from ...mechanism.catalogue import quantity
from ...mechanism.inputs import INPUTS
from ...support.template import filled
from .axes import arguments_of, taken_from, text_file

AFFINITY = """try:
    from os import sched_getaffinity
except ImportError:  # not on this system
    sched_getaffinity = None
"""


def call_of(inputs: Mapping[str, int | None]) -> list[str]:
    """The arguments of a kernel over axes, of which the first is cut into blocks."""
    own = {None: "{}", 0: 'axes["{}"][start:stop]'}
    return [own.get(axis, 'axes["{}"]').format(name) for name, axis in inputs.items()]


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


def point_function(program: Program, inputs: Sequence[str], shown: Sequence[str], state: bool) -> str:
    """`point(...)` in plain math, with the helpers that it calls."""
    told = [*described(inputs, state), "", "Gives:", *described(shown, state)]
    types = ", ".join(f"type({name})" for name in inputs)
    check = [f"if str in ({types},):", f"    {_doubles(inputs)}  # says what is wrong"]
    return filled(
        text_file("point"),
        GIVEN=", ".join(inputs),
        DOCSTRING=docstring("One point in plain Python, nothing compiled: numbers in, a tuple out.", told),
        CHECK=check if inputs else [],
        BODY=write_lines(with_short_temporaries(program), "python"),
        RETURNED=", ".join(program.outputs),
    )


def _doubles(inputs: Iterable[str]) -> str:
    return f"doubles({', '.join(f'{name}={name}' for name in inputs)})"


def fixed_functions() -> list[str]:
    """`evaluate` and `run` where every input is fixed."""
    return text_file("fixed").split("\n\n\n")


def evaluate_function(
    inputs: Sequence[str],
    shown: Sequence[str],
    state: bool,
    limit: float | None,
    kernel: Mapping[str, int | None],
) -> str:
    """`evaluate(...)`: numbers by `point`, arrays by the kernel, broadcast like NumPy."""
    told = [
        *described(inputs, state),
        "",
        "Numbers or arrays that broadcast together; a dict of floats or arrays comes back. What has "
        "no value is NaN" + (", and `status` tells why." if "status" in shown else "."),
        "`threads`: how many share the work, all cores without; the answer is the same.",
    ]
    more = [name for name, axis in kernel.items() if axis is None]
    check = ""
    if limit is not None and "theta" in inputs:
        theta = f"arrays[{inputs.index('theta')}]"
        check = filled(text_file("reach"), THETA=theta, LIMIT=repr(limit), ROUNDED=f"{limit:.0f}")
    return filled(
        text_file("evaluate"),
        GIVEN=", ".join(inputs),
        DOCSTRING=docstring(f"{', '.join(shown)} at points of your own.", told),
        DOUBLES=_doubles(inputs),
        CHECK=check.splitlines(),
        OF_POINT="*(float(a) for a in arrays)",
        OF_KERNEL=", ".join(["*(a[start:stop] for a in flat)", *more, "*(a[start:stop] for a in places)"]),
    )


def run_function(
    names: Sequence[str],
    axes: Sequence[str],
    inputs: Mapping[str, int | None],
    own_axes: Mapping[str, Sequence[str]],
) -> str:
    """`run()`: the outputs over the outer product of the scene's axes, or of others in their place.

    `own_axes` are those of quantities of a whole design, which have no others.
    """
    others = {n: tuple(k for k, a in enumerate(axes) if a not in own) for n, own in own_axes.items()}
    told = [
        "A dict of arrays, one dimension per axis: " + " x ".join(axes) + ".",
        *(f"{name} has {' x '.join(own_axes[name]) or 'none'} alone." for name in others if others[name]),
        "An axis that is given takes the place of the scene's.",
    ]
    kernel = "point_kernel" if len(axes) == 1 else "grid_kernel"
    return filled(
        text_file("run"),
        GIVEN=arguments_of(axes),
        DOCSTRING=docstring(f"{', '.join(names)} over the scene's axes.", told),
        CHOSEN=taken_from(axes),
        KERNEL=f"{kernel}({', '.join([*call_of(inputs), '*(a[start:stop] for a in out.values())'])})",
        LEFT=[
            f'out["{name}"] = fmax.reduce(out["{name}"], axis={places}, initial=nan)  # the same everywhere'
            for name, places in others.items()
            if places
        ],
    )


def run_reduced_function(
    names: Sequence[str],
    kinds: Sequence[str],
    axes: Sequence[str],
    inputs: Mapping[str, int | None],
    own: Sequence[str],
) -> str:
    """`run()` of a scene with a reduction: the last axis is reduced, the grid is not stored."""
    last, rest, free = axes[-1], [axis for axis in axes[:-1] if axis], [axis for axis in axes if axis]
    told = [
        f"A dict of arrays over {' x '.join(rest) or 'nothing'}: for each name "
        + ", ".join(f"`_{kind}`, {KINDS[kind].replace('_', ' ')}" for kind in kinds)
        + f"; `_<extreme>_{last}`, where it is; `_skipped`, how many points along {last} have no value.",
    ]
    given = [*call_of(inputs), "length", "*(a[start:stop] for a in places)"]
    return filled(
        text_file("run_reduced"),
        GIVEN=arguments_of(free),
        DOCSTRING=docstring(f"{', '.join(names)} over the scene's axes, {last} reduced.", told),
        CHOSEN=taken_from(free),
        REST=repr(tuple(rest)),
        LAST=last,
        PLACES=[f"empty(shape, {kind})," for _, kind in outputs_of(own, kinds)],
        KERNEL=f"reduced({', '.join(given)})",
        SINGLE=[] if rest else ["places = [place[0] for place in places]"],
        RESULTS=[_result(index, *row, last) for index, row in enumerate(outputs_of(names, kinds))],
    )


def _result(index: int, name: str, kind: str, last: str) -> str:
    """The entry of a reduced value, of its place, or of how many points have none."""
    if name.endswith("_count") and kind == "int64":
        return f'"{name.removesuffix("_count")}_skipped": length - places[{index}],'
    if kind == "int64":
        return f'"{name.removesuffix("_place")}_{last}": at[places[{index}]],'
    return f'"{name}": places[{index}],'
