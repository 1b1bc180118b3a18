"""A scene as a module of numba: one point in plain Python, arrays, the scene's grid and peaks."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from textwrap import wrap
from typing import NamedTuple

import numpy as np

from ...compiler.builder import HELPERS, MATH, Parts, functions_of, module_text, renamed, with_sources
from ...compiler.cost import cost_of
from ...compiler.languages.numba.language import scalar_parts
from ...compiler.languages.numba.module import CALLABLE, loops_parts, numba_parts
from ...compiler.languages.numba.reductions import reduced_parts
from ...compiler.languages.protocol import Symbol
from ...compiler.languages.shared import refuse_taken, taken_in_python
from ...compiler.operations import OPERATIONS
from ...loads.resolve import split
from ...mechanism.catalogue import of_design, quantity
from ...mechanism.inputs import INPUTS
from ...mechanism.names import ORDER
from ...mechanism.program import digest
from ...runtime.kernels import KernelKey, has_large_angles, key_of
from ...support.version import version
from ...support.written import UNSEALED
from ..content import Content
from ..scene import Scene
from .axes import axes_of, axes_text, chosen_text, own_axes, text_file
from .entry_points import (
    AFFINITY,
    evaluate_function,
    fixed_functions,
    point_function,
    run_function,
    run_reduced_function,
)
from .loaded import require_tables, table_text
from .made import Made, limit_of
from .peaks import SEARCH, left_out_of_module, peak_texts
from .portable import WITHOUT_VALUE, PortableRequest, asked_of, require_outputs

WIDTH = 96
FUNCTIONS = Path(__file__).with_name("functions.py")


def text_of(scene: Scene, name: str = "my_kernels.py") -> str:
    """The text of the module of a scene."""
    content = scene.content
    require_outputs(scene)
    require_tables(scene.name or "scene", split(content.inputs)[1])
    names = (*content.outputs, *([] if content.reduction else ["status"]))
    asked = asked_of(content, names)
    shown, state = asked.shown, asked.request.form.state
    made, order = Made(content, asked), _order(content, shown)
    key = _key(content, asked, order)
    axes = {n: value for n in order if isinstance(value := content.inputs.get(n), tuple)}
    program = made.guarded(key, shown)
    inputs = tuple(sorted(program.inputs, key=ORDER.index))
    kernels = _kernels(made, key, inputs) if inputs else Kernels([], {}, (), {})
    peaks = peak_texts(content)
    scalars = _scalars(made, key, shown, inputs, own_axes(content, shown))
    groups = [
        with_sources([point_function(program, inputs, shown, state)], (HELPERS, FUNCTIONS)),
        *map(
            _compiled,
            [
                *kernels.parts,
                scalars,
                *peaks.loops,
            ],
        ),
    ]
    compiles = bool(inputs or peaks.loops)
    limit = None if key.far else limit_of(key)
    calls = [] if inputs else fixed_functions()
    if inputs:
        calls.append(evaluate_function(inputs, shown, state, limit, kernels.of_points))
        calls += [axes_text(axes), chosen_text(axes, limit)] if axes else []
        calls.append(
            run_function(shown, list(axes), kernels.inputs, own_axes(content, shown))
            if content.fused is None
            else run_reduced_function(shown, content.fused.kinds, order, kernels.inputs, kernels.outputs)
        )
    calls += peaks.functions
    tables = [AFFINITY, text_file("compiled")] if compiles else []
    tables += [table_text(n, load) for n, load in asked.loads.items()]
    tables += [f"INPUTS = {inputs!r}", _outputs(shown), _fixed(key)]
    command = f"desaxe compile {Path(scene.name).name} -o {name}"
    if not scene.name:
        command = f'desaxe.compile(scene, "{name}")'
    head = _docstring(scene, command, key, shown, inputs, cost_of(program).operations)
    text = module_text(head, _front(tables), *groups, _front(calls))
    refuse_taken(shown, taken_in_python(text) | {f"compiled_{name}" for name in functions_of(HELPERS)})
    return text


# Where the names come from that stand in the functions that people call.
_NUMPY = (
    "append", "arange", "array", "asarray", "ascontiguousarray", "broadcast_arrays", "broadcast_shapes",
    "broadcast_to", "empty", "errstate", "float64", "floor", "fmax", "int8", "isfinite", "linspace",
    "searchsorted", "unique", "where", "zeros",
)  # fmt: skip
IMPORTS = {
    **MATH, **dict.fromkeys(_NUMPY, "numpy"), "ThreadPoolExecutor": "concurrent.futures", "prod": "math",
    "pi": "math", "cpu_count": "os", "Lock": "threading", "njit": "numba", "types": "numba",
}  # fmt: skip


def _front(parts: Sequence[str]) -> Parts:
    """Parts that people call, and the functions behind them."""
    return with_sources(parts, (FUNCTIONS, SEARCH), imports=IMPORTS)


def _order(content: Content, shown: Sequence[str]) -> tuple[str, ...]:
    """The axes of the grid kernel in loop order; of a whole design those that its names have."""
    order = axes_of(content)
    if "theta" not in content.inputs and {n for n in shown if not of_design(n)} == {"status"}:
        own = {axis for axes in own_axes(content, shown).values() for axis in axes}
        order = [name for name in order if name in own] or [""]
    return tuple(order)


def _key(content: Content, asked: PortableRequest, order: Sequence[str]) -> KernelKey:
    """The key of the grid kernel, every number of the scene folded in; loads of the motion stay inputs."""
    numbers = {n: value for n, value in asked.fixed if n in asked.request.inputs}
    needed = content.inputs if asked.loads else asked.request.inputs
    columns = {n: np.array(content.inputs[n]) for n in order if n in needed}
    key = key_of(asked.request, numbers, columns, {n: order.index(n) for n in columns}, len(order))
    if "theta" in columns and has_large_angles(columns["theta"]):
        key = key._replace(far=True)
    anywhere = key.form._replace(wide_margins=False)  # the module takes other designs, too
    fixed = tuple((dict(key.fixed) | numbers).items())
    return key._replace(names=asked.shown, form=anywhere, fixed=fixed)


def _scalars(
    made: Made,
    key: KernelKey,
    shown: tuple[str, ...],
    inputs: tuple[str, ...],
    own: Mapping[str, Sequence[str]],
) -> Parts:
    """The functions of one output each; those of a whole design take its own inputs alone."""
    scalars = []
    for name in shown:
        row = quantity(name, key.form.state)
        taken = [n for n in inputs if n in own.get(name, inputs)]
        scalars.append((Symbol(name, row.unit, row.meaning), made.guarded(key, (name,)), taken))
    parts = numba_parts(scalar_parts(scalars), jit=CALLABLE)
    return parts._replace(imports={**parts.imports, "isfinite": "numpy"})


# The tails of the inner loops and of the whole.
REDUCED = 'kernel = njit(error_model="numpy")(loops)\n', text_file("reduced")


class Kernels(NamedTuple):
    """The array kernel and the grid kernel, one where they are the same; what the latter takes and gives.

    of_points  what the array kernel takes
    """

    parts: list[Parts]
    inputs: Mapping[str, int | None]
    outputs: tuple[str, ...]
    of_points: Mapping[str, int | None]


def _kernels(made: Made, key: KernelKey, inputs: tuple[str, ...]) -> Kernels:
    """The kernels of a scene; the array kernel takes the inputs in the order in which they stand in names."""
    kernel = made.kernel(key._replace(axis_of=tuple((n, 0) for n in sorted(inputs)), axes=1))
    numbers = {name: axis for name, axis in kernel.inputs.items() if axis is None}
    of_points = {name: kernel.inputs[name] for name in inputs} | numbers
    kernel = kernel._replace(inputs=of_points)
    parts = [_named("point", [*loops_parts(kernel), text_file("kernel")])]
    if key.axes > 1:
        kernel = made.kernel(key)
        fused = made.content.fused
        reduced = fused and reduced_parts(kernel, fused.kinds, REDUCED)
        parts.append(_named("grid", reduced or [*loops_parts(kernel), text_file("kernel")]))
    return Kernels(parts, kernel.inputs, kernel.outputs, of_points)


def _named(prefix: str, parts: Sequence[str]) -> Parts:
    """The parts of a kernel under names that another kernel does not have."""
    names = {name: f"{prefix}_{name}" for name in ("loops", "kernel", "stable", "signature")}
    return numba_parts([renamed(part, names) for part in parts], jit=CALLABLE)


def _compiled(parts: Parts) -> Parts:
    """Parts of kernels whose helpers have names that differ from those of the plain point."""
    spelled = {row.numba.partition("(")[0] for row in OPERATIONS.values()}
    names = {name: f"compiled_{name}" for name in functions_of(HELPERS) if name in spelled}
    return parts._replace(texts=tuple(renamed(text, names) for text in parts.texts))


def _outputs(shown: tuple[str, ...]) -> str:
    rows = [f'    "{name}": {"int8" if name == "status" else "float64"},' for name in shown]
    return "\n".join(["OUTPUTS = {", *rows, "}"])


def _fixed(key: KernelKey) -> str:
    rows = [f'    "{name}": {value!r},' for name, value in key.fixed]
    return "\n".join(
        ["# Folded into the code below: changing them here changes nothing.", "FIXED = {", *rows, "}"]
    )


def _docstring(
    scene: Scene,
    command: str,
    key: KernelKey,
    shown: tuple[str, ...],
    inputs: tuple[str, ...],
    operations: int,
) -> str:
    """The module's docstring: its source, its contents, its units."""
    peak_lines = peak_texts(scene.content).lines
    state = key.form.state
    own = own_axes(scene.content, shown).get(shown[0])
    given = ["*INPUTS"] if own is None else [n for n in inputs if n in own]
    first = f"{shown[0]}({', '.join(given)})"
    lines = [
        f"{scene.title or 'An offset slider-crank'}: {', '.join(shown)}.",
        "",
        f"Generated by `{command}`; write it again instead of editing it.",
        f"desaxe {version()}, derivation {digest()[:16]}, scene {scene.content.digest[:16]}, {UNSEALED}.",
        f"A `point` takes {operations} operations, in a form that is right for any design: a sine is one,",
        "the scene's numbers are folded in.",
        "It needs NumPy and numba, and nothing of desaxe.",
        "",
        "    point(...)      one point in plain Python",
        "    evaluate(...)   numbers or arrays that broadcast",
        "    run()           the scene's own grid; run(theta=...) with other axes",
        *(f"    {line}" for line in peak_lines),
        f"    {first}   one output as a number, from @njit functions, too",
        "",
        f"Accuracy {key.accuracy}; SI units and radians. Y points along the slider axis towards the slider,",
        "theta turns from +Y towards +X.",
        "",
        *WITHOUT_VALUE,
        "",
    ]
    lost = left_out_of_module(scene.content)
    lines += [f"Not in here (`desaxe run` has it): {', '.join(lost)}.", ""] if lost else []
    rows = [("inputs", n, INPUTS[n].unit, INPUTS[n].meaning) for n in inputs]
    rows += [("outputs", n, quantity(n, state).unit, quantity(n, state).meaning) for n in shown]
    rows += [("fixed", n, "", _fixed_as(n, value)) for n, value in key.fixed if n in INPUTS and value != 0.0]
    zeros = [n for n, value in key.fixed if n in INPUTS and value == 0.0]
    rows += [("fixed", ", ".join(zeros), "", "0")] if zeros else []
    before = ""
    for group, word, unit, meaning in rows:
        told = f"{word} [{unit}]" if unit and unit != "1" else word
        text = f"{told}: {meaning}" if group != "fixed" else f"{word} = {meaning}"
        cells = wrap(text, WIDTH - 12)
        lines.append(f"  {group if group != before else '':8} {cells[0]}")
        lines += [f"  {'':10}{cell}" for cell in cells[1:]]
        before = group
    lines += ["", "SPDX-License-Identifier: MIT"]
    return "\n".join([*lines, ""]).replace("\\", "/").replace('"""', "'''")


def _fixed_as(name: str, value: float) -> str:
    unit = INPUTS[name].unit
    return f"{value!r} {unit}" if unit != "1" else repr(value)
