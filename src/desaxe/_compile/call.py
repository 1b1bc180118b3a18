"""`compile`: a scene to a module of its own, for the user's repository."""

import hashlib
import keyword
import re
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from textwrap import wrap
from typing import Any

from .._constants import constants, double_constants, single_constants
from .._kernels import KernelKey, is_single, kernel_of
from .._point import cut
from .._program import digest
from .._scene import Scene, SceneError
from .._scene import scene as scene_of
from .._scene.kernels import GridKernel, grid_kernel
from ..catalogue import quantity
from ..compiler.cost import cost_of
from ..compiler.emit_numba import emit_numba
from ..compiler.kernel import Kernel
from ..compiler.operations import HELPERS, NUMBA_HELPERS
from ..compiler.passes.double_double import double_digits
from ..compiler.reductions import emit_reduced
from ..inputs import INPUTS
from ..support.files import check_target, write_text
from .merge import import_lines, merged, renamed
from .parts import (
    AFFINITY,
    DOUBLES,
    THREADS,
    axes_text,
    evaluate_function,
    point_function,
    run_function,
    run_reduced_function,
)

WIDTH = 96


def compile(scene: Scene | str | PathLike[str] | Mapping[str, Any], path: str | PathLike[str]) -> Path:
    """Write the kernels of a scene as a Python module that needs only NumPy and numba.

    What the scene fixes is folded in; what it gives as a list or range stays an argument of
    `point(...)`, for one point in plain Python, and `evaluate(...)`, for arrays; `run()` computes the
    scene's own grid, or its reductions. The module has no import of desaxe: it can live in your own
    repository. The same scene gives the same bytes. Raises as `scene` does, SceneError where the
    scene asks for no outputs, and ValueError for a path that Python cannot import: it is FILE.py.

        dx.compile("examples/compactor.toml", "my_kernels.py")
    """
    place = Path(path)
    _require_importable(place)
    check_target(place)
    write_text(place, module_text(scene if isinstance(scene, Scene) else scene_of(scene), place.name))
    return place


def _require_importable(place: Path) -> None:
    """A module is imported by the name of its file."""
    name = place.stem
    if place.suffix != ".py" or not name.isidentifier() or keyword.iskeyword(name):
        word = re.sub(r"\W", "_", name)
        good = word if word.isidentifier() and not keyword.iskeyword(word) else f"kernels_{word}"
        raise ValueError(f"{place}: Python cannot import a module of this name, but {good}.py, for example")


def module_text(scene: Scene, name: str = "my_kernels.py") -> str:
    """The text of the module."""
    content = scene.content
    if not content.outputs:
        raise SceneError(f"{scene.name or 'scene'}: nothing to compile, give outputs = [...]")
    found = grid_kernel(content)
    anywhere = found.key.form._replace(roomy=False)  # the module takes other designs, too
    key = _all_fixed(found.key._replace(form=anywhere), found, content.inputs)
    axes = {n: value for n in found.axes if isinstance(value := content.inputs.get(n), tuple)}
    state = found.request.form.state
    shown = found.request.shown
    program = cut(key.names, key.form, key.fixed)
    if key.accuracy == "extended":
        program = double_digits(program, double_constants())
    sources = [point_function(program, shown, state)]
    grid = None
    if program.inputs:
        grid = _kernels(key, program.inputs, sources)
    imports, statements = merged(_shared(sources))
    limit = None if key.far else _limit(key)
    calls = [THREADS] if program.inputs else []
    calls.append(evaluate_function(program, shown, state, limit, bool(program.inputs)))
    calls += [axes_text(axes)] if axes else []
    if grid is None:
        calls.append('def run():\n    """The values; every input is fixed."""\n    return evaluate()')
    elif content.reduction is None:
        calls.append(run_function(shown, list(axes), grid.inputs, state))
    else:
        calls.append(run_reduced_function(shown, key.reduce, found.axes, grid.inputs, grid.outputs))
    tables = [*([AFFINITY, DOUBLES] if program.inputs else []), _outputs(shown), _fixed(key)]
    body = "\n\n\n".join(part.strip("\n") for part in [*tables, *statements, *calls]) + "\n"
    head = _docstring(scene, name, key, shown, program.inputs, cost_of(program).operations)
    return "\n\n\n".join([head, "\n".join(import_lines(_called(imports, body))), body])


# What the functions that people call import; what does not stand in the text is left out.
IMPORTS = {
    "concurrent.futures": {"ThreadPoolExecutor"},
    "math": {"prod"},
    "numpy": {
        "append", "array", "asarray", "ascontiguousarray", "broadcast_arrays", "empty", "float64", "int8",
        "isfinite", "linspace", "nan",
    },
    "os": {"cpu_count"},
}  # fmt: skip


def _called(imports: Mapping[str, set[str]], body: str) -> dict[str, set[str]]:
    """The imports of a text; a name of both NumPy and math is NumPy's, which serves numba too."""
    found = {m: imports.get(m, set()) | IMPORTS.get(m, set()) for m in {**imports, **IMPORTS}}
    found["math"] = found["math"] - imports.get("numpy", set())
    found["numpy"] = {n for n in found["numpy"] if n in imports.get("numpy", ()) or n not in found["math"]}
    used = set(re.findall(r"\w+", body))
    return {module: names & used for module, names in found.items() if names & used}


def _all_fixed(key: KernelKey, found: GridKernel, inputs: Mapping[str, Any]) -> KernelKey:
    """The key with every number of the scene folded in."""
    numbers = {n: inputs.get(n, 0.0) for n in found.request.inputs if n not in found.axes}
    fixed = dict(key.fixed) | {n: float(value) for n, value in numbers.items()}
    return key._replace(fixed=tuple(fixed.items()))


def _kernels(key: KernelKey, inputs: tuple[str, ...], sources: list[str]) -> Kernel:
    """Append the kernels of arrays and of the grid; the latter, which tells the order of its inputs."""
    points = key._replace(axis_of=tuple((n, 0) for n in sorted(inputs)), axes=1, reduce=())
    single = is_single(key)
    own = _prefixed("point")
    kernel = kernel_of(points)
    sources.append(renamed(emit_numba(kernel, "Points.", single), own))
    if key.axes == 1:
        return kernel
    grid = kernel_of(key)
    own = _prefixed("grid")
    text = emit_reduced(grid, key.reduce, "", single) if key.reduce else emit_numba(grid, "", single)
    if single:  # constants of float32 have names of their own in each module
        own |= {f"k{index}": f"grid_k{index}" for index in range(1000)}
    sources.append(renamed(text, own))
    return grid


def _prefixed(prefix: str) -> dict[str, str]:
    """Names of a kernel's module under which two of them can stand in one."""
    words = {name: f"{prefix}_{name}" for name in ("loops", "kernel")}
    signature = f"{prefix}_signature"
    return words | {"signature = types": f"{signature} = types", "njit(signature": f"njit({signature}"}


def _shared(sources: list[str]) -> list[str]:
    """The plain point first; helpers of kernels under names that differ from its own."""
    plain, *kernels = sources
    helpers = {name: f"compiled_{name}" for name in (*HELPERS, *NUMBA_HELPERS)}
    return [plain, *(renamed(text, helpers, called=True) for text in kernels)]


def _limit(key: KernelKey) -> float:
    """The largest angle that the written-out sine and cosine reduce exactly."""
    if key.accuracy == "extended":
        return double_constants().limit
    return single_constants().limit if key.accuracy == "fast" else constants().limit


def _outputs(shown: tuple[str, ...]) -> str:
    rows = [f'    "{name}": {"int8" if name == "status" else "float64"},' for name in shown]
    return "\n".join(["OUTPUTS = {", *rows, "}"])


def _fixed(key: KernelKey) -> str:
    rows = [f'    "{name}": {value!r},' for name, value in key.fixed]
    return "\n".join(
        ["# Folded into the code below: changing them here changes nothing.", "FIXED = {", *rows, "}"]
    )


def _docstring(
    scene: Scene, name: str, key: KernelKey, shown: tuple[str, ...], inputs: tuple[str, ...], operations: int
) -> str:
    """Where the module comes from, what it computes, in which units."""
    from .. import __version__

    source = Path(scene.name).name
    command = f"desaxe compile {source} -o {name}" if source else f'desaxe.compile(scene, "{name}")'
    said = hashlib.sha256(repr(scene.content).encode()).hexdigest()[:16]
    state = key.form.state
    lines = [
        f"{scene.title or 'An offset slider-crank'}: {', '.join(shown)}.",
        "",
        f"Generated by `{command}`; write it again instead of editing it.",
        f"desaxe {__version__}, derivation {digest()[:16]}, scene {said}.",
        f"A `point` takes {operations} operations, in a form that is right for any design: a sine is one,",
        "the scene's numbers are folded in.",
        "It needs NumPy and numba, and nothing of desaxe.",
        "",
        "    point(...)      one point in plain Python",
        "    evaluate(...)   numbers or arrays that broadcast",
        "    run()           the scene's own grid",
        "",
        f"Accuracy {key.accuracy}; SI units and radians. Y points along the slider axis towards the slider,",
        "theta turns from +Y towards +X.",
        "",
    ]
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
    body = "\n".join(lines).replace("\\", "/").replace('"""', "'''")
    return f'"""{body}\n"""'


def _fixed_as(name: str, value: float) -> str:
    unit = INPUTS[name].unit
    return f"{value!r} {unit}" if unit != "1" else repr(value)
