"""`compile`: a scene to a module of its own, for the user's repository."""

import ast
import hashlib
import keyword
import re
from collections.abc import Container, Iterable, Mapping, Sequence
from os import PathLike
from pathlib import Path
from textwrap import wrap
from typing import Any

from ...compiler.cost import cost_of
from ...compiler.kernel import Kernel
from ...compiler.languages import language_of
from ...compiler.languages.numba.module import emit_numba
from ...compiler.languages.numba.reductions import emit_reduced
from ...compiler.languages.shared import refuse_taken, taken_in_python
from ...compiler.languages.words import words_of
from ...compiler.operations import HELPERS, NUMBA_HELPERS
from ...compiler.passes.double_double import double_double
from ...compiler.passes.guard import guard_inputs
from ...compiler.program import Program
from ...loads.load import Load
from ...loads.resolve import Plan, plan_of, split
from ...mechanism.catalogue import quantity
from ...mechanism.constants import constants, double_constants
from ...mechanism.inputs import INPUTS, LEAST
from ...mechanism.names import ORDER
from ...mechanism.program import digest
from ...runtime.kernels import KernelKey, kernel_of
from ...runtime.specialise import specialise
from ...runtime.written import UNSEALED, replacing_ours, require_ours, sealed
from ...support.files import as_path, check_target, require_writable
from ...support.shown import printable
from ...support.version import version
from ..content import Content
from ..kernel import GridKernel, grid_kernel, own_axes
from ..scene import Scene
from ..scene import scene as scene_of
from ..schema import SceneError
from .axes import SPACED, WITH_AXES, axes_text, chosen_text
from .entry_points import (
    AFFINITY,
    DOUBLES,
    THREADS,
    evaluate_function,
    point_function,
    run_function,
    run_reduced_function,
)
from .first_call import COMPILED, LAZY, LAZY_REDUCED
from .loaded import calls_text, renames, require_tables, table_text
from .merge import import_lines, merged, renamed
from .peaks import left_out_of_module, peak_texts
from .portable import WITHOUT_VALUE, Order, left_out, module_of, require_outputs
from .scalars import scalars_source

WIDTH = 96


def compile(
    scene: Scene | str | PathLike[str] | Mapping[str, Any],
    path: str | PathLike[str],
    to: str = "numba",
    *,
    libm: bool = True,
    check: bool = False,
    overwrite: bool = False,
) -> Path:
    """Write the outputs of a scene as source code of its own, which needs nothing of desaxe.

    What the scene fixes is folded in; what it gives as a list or range is an argument, in the order theta,
    ec, AB, BC, omega0 (or omega), alpha, then masses and loads. `to` is the language:

    numba       FILE.py, which needs NumPy and numba: `point(...)`, `evaluate(...)`, `run()`, which takes
                other axes, too, and for each output a function to call from an @njit of your own; for each
                [[peak]] of designs that turn fully, without friction, a function such as `peak_absmax_a_C()`
    c           C99: FOLDER/name.h and name.c, where `name` is the folder's: `int name_point(in, out)`,
                `void name_array(n, in, out)`, `name_inverse`, `name_limits`; where masses are given
                `name_alpha` and `name_step`, the motion under a torque in steps of order 4
    octave      name.m for GNU Octave and MATLAB: `[a_C, V_C] = name(theta, ec)`
    jax         a module with a function for each output and `evaluate(**inputs)`; its derivatives are the
                derived ones
    javascript  an ES module and its types

    A path that ends as the language's files do is the file; any other is a folder, whose last part is the
    name. `libm=False` (c) writes elementary functions of its own. The same scene gives the same bytes;
    `check=True` writes nothing and raises ValueError where the files are not what would be written. A file
    that it did not write, or that was edited since, is left as it is, and FileExistsError raised, unless
    `overwrite` is true.

    Returns the path. Raises as `scene` does, SceneError where the scene asks for no outputs, and ValueError
    for an unknown language, or a name that it cannot have.

        dx.compile("examples/compactor.toml", "my_kernels.py")
        dx.compile("examples/compactor.toml", "press", to="c")
    """
    place = as_path("path", path)
    texts = texts_of(scene if isinstance(scene, Scene) else scene_of(scene), place, to, libm)
    if check:
        stale = differing(texts)
        if stale:
            names = ", ".join(file.name for file in stale)
            raise ValueError(f"{printable(place)}: not what the scene gives ({names}); write it again")
        return place
    for file in texts:
        check_target(file)
        require_ours(file, overwrite)
        require_writable(file)
    for file, text in texts.items():
        with replacing_ours(file, overwrite) as staged:
            staged.write_bytes(text.encode())
    return place


def texts_of(scene: Scene, place: Path, to: str = "numba", libm: bool = True) -> dict[Path, str]:
    """The files of a scene in a language, with their texts; nothing is written."""
    if to == "numba":
        _require_importable(place)
        refuse_taken(scene.content.outputs, words_of(to).outputs)
        return {place: sealed(module_text(scene, place.name))}
    language = language_of(to)
    if not libm and not language.own_functions:
        raise ValueError(f"libm=False is for c: {to} has its elementary functions at hand")
    if scene.content.accuracy == "extended" and not language.extended:
        raise SceneError(
            f'accuracy = "extended": {to} has standard, numba, c, octave and javascript have both'
        )
    is_file = place.suffix == language.suffix
    name = place.stem if is_file else place.name
    require_name(name, place, words_of(to).modules)
    refuse_taken(scene.content.outputs, words_of(to).outputs)
    folder = place.parent if is_file else place
    source = Path(scene.name).name
    said = f"desaxe compile {source} --to {to} -o {place.name}" + " --no-libm" * (not libm)
    if not source:
        said = f'desaxe.compile(scene, "{place.name}", to="{to}"' + ", libm=False" * (not libm) + ")"
    module = module_of(scene, Order(to, name, said, language.second_order, not libm))
    return {folder / file: sealed(text) for file, text in language.files(module, not libm).items()}


def lost_of(content: Content, to: str) -> list[str]:
    """The parts of a scene that its module in a language leaves out, by name."""
    if to != "numba":
        return left_out(content)
    return left_out_of_module(content, left_out(content, reduction=False))


def differing(texts: Mapping[Path, str]) -> list[Path]:
    """The files that are missing or have another text."""
    return [f for f, text in texts.items() if not f.is_file() or f.read_bytes() != text.encode()]


def require_name(name: str, place: Path, words: Container[str]) -> None:
    """ValueError for a module name that is not valid in every language, or a word of this one."""
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name) or _is_word(name, words):
        word = re.sub(r"\W", "_", name, flags=re.ASCII)
        good = word if re.match(r"[A-Za-z]", word) and not _is_word(word, words) else f"press_{word}"
        raise ValueError(
            f"{printable(place)}: {name!r} cannot be the name of a module, but {good!r}, for example"
        )


def _require_importable(place: Path) -> None:
    """ValueError for a file name that Python cannot import."""
    name, words = place.stem, words_of("numba").modules
    if place.suffix != ".py" or not name.isidentifier() or _is_word(name, words):
        word = re.sub(r"\W", "_", name)
        good = word if word.isidentifier() and not _is_word(word, words) else f"kernels_{word}"
        raise ValueError(
            f"{printable(place)}: Python cannot import a module of this name, but {good}.py, for example"
        )


def _is_word(name: str, words: Container[str]) -> bool:
    return keyword.iskeyword(name) or name in words


def module_text(scene: Scene, name: str = "my_kernels.py") -> str:
    """The text of the module."""
    content = scene.content
    require_outputs(scene)
    numbers, loads = split(content.inputs)
    require_tables(scene.name or "scene", loads)
    if loads and content.reduction is not None:
        raise SceneError(
            f"{scene.name or 'scene'}: a module under a load that varies stores its grid: no [reduce]"
        )
    found = grid_kernel(content, apart=False)
    anywhere = found.key.form._replace(wide_margins=False)  # the module takes other designs, too
    key = _all_fixed(found.key._replace(form=anywhere), found, numbers, loads)
    order = content.inputs if loads else found.axes
    axes = {n: value for n in order if isinstance(value := content.inputs.get(n), tuple)}
    state = found.request.form.state
    shown = found.request.shown
    program = _in_order(_guarded(key, key.names))
    plan = plan_of(_asked(content), loads, "omega" in numbers, "mu" in numbers) if loads else None
    if plan is not None and plan.loads:
        return _module_under_loads(scene, name, plan, key, program, axes)
    sources = [point_function(program, shown, state)]
    grid = None
    if program.inputs:
        grid = _kernels(key, program.inputs, sources)
    sources.append(_scalars(key, shown, program.inputs, own_axes(content, shown)))
    peaks = peak_texts(content)
    sources += peaks.searches
    compiles = bool(program.inputs or peaks.searches)
    imports, statements = merged(_shared(sources))
    limit = None if key.far else _limit(key)
    calls = [THREADS] if compiles else []
    calls += [WITH_AXES] if axes or peaks.functions else []
    calls.append(evaluate_function(program, shown, state, limit, bool(program.inputs)))
    calls += [axes_text(axes), chosen_text(axes, limit)] if axes else []
    if grid is None:
        calls.append('def run():\n    """The values; every input is fixed."""\n    return evaluate()')
    elif content.fused is None:
        calls.append(run_function(shown, list(axes), grid.inputs, own_axes(content, shown)))
    else:
        calls.append(run_reduced_function(shown, key.reduce, found.axes, grid.inputs, grid.outputs))
    calls += peaks.functions
    if "spaced(" in "".join(peaks.functions) and not any("def spaced" in call for call in calls):
        calls.insert(0, SPACED)
    tables = [*([AFFINITY, DOUBLES, COMPILED] if compiles else [])]
    tables += [f"INPUTS = {program.inputs!r}", _outputs(shown), _fixed(key)]
    body = "\n\n\n".join(part.strip("\n") for part in [*tables, *statements, *calls]) + "\n"
    head = _docstring(scene, name, key, shown, program.inputs, cost_of(program).operations)
    text = "\n\n\n".join([head, "\n".join(import_lines(_called(imports, body))), body])
    refuse_taken(shown, taken_in_python(text))
    return text


# What the functions that people call import; what does not stand in the text is left out.
IMPORTS = {
    "concurrent.futures": {"ThreadPoolExecutor"},
    "math": {"prod"},
    "numpy": {
        "append", "arange", "array", "asarray", "ascontiguousarray", "broadcast_arrays", "empty", "float64",
        "fmax", "int8", "isfinite", "linspace", "nan", "broadcast_to", "floor", "pi", "searchsorted",
        "unique", "where",
    },
    "os": {"cpu_count"},
    "threading": {"Lock"},
}  # fmt: skip


def _called(imports: Mapping[str, set[str]], body: str) -> dict[str, set[str]]:
    """The imports that a text needs; NumPy's for a name that math has too, since numba accepts it."""
    found = {m: imports.get(m, set()) | IMPORTS.get(m, set()) for m in {**imports, **IMPORTS}}
    found["math"] = found["math"] - imports.get("numpy", set())
    found["numpy"] = {n for n in found["numpy"] if n in imports.get("numpy", ()) or n not in found["math"]}
    used = {node.id for node in ast.walk(ast.parse(body)) if isinstance(node, ast.Name)}
    return {module: names & used for module, names in found.items() if names & used}


def _asked(content: Content) -> list[str]:
    """The outputs, as a grid has them."""
    return list(dict.fromkeys([*content.outputs, "status"]))


def _module_under_loads(
    scene: Scene,
    name: str,
    plan: Plan,
    key: KernelKey,
    program: Program,
    axes: Mapping[str, tuple[float, ...]],
) -> str:
    """The text of the module of a scene whose loads are tables."""
    state, inputs = key.form.state, program.inputs
    own = renames()
    parts = tuple(dict.fromkeys((*plan.names, *plan.motion)))
    single = key._replace(axis_of=tuple((n, 0) for n in sorted(inputs)), axes=1, reduce=())
    sources = [point_function(program, parts, state)]
    _kernels(single, inputs, sources)
    imports, statements = merged(
        _shared([renamed(sources[0], {"point": own["point"]}, called=True), *sources[1:]])
    )
    limit = None if key.far else _limit(key)
    inner = renamed(evaluate_function(program, parts, state, limit, True), own)
    fixed = scene.content.inputs.get("theta")
    fixed_theta = float(fixed) if isinstance(fixed, float) else None
    tables = [AFFINITY, DOUBLES, COMPILED, f"INPUTS = {tuple(n for n in inputs if n not in plan.loads)!r}"]
    tables += [renamed(_outputs(parts), own), _outputs(plan.shown), _fixed(key)]
    tables += [table_text(n, load, "N") for n, load in plan.loads.items()]
    calls = [THREADS, inner, *([axes_text(axes), WITH_AXES, chosen_text(axes, limit)] if axes else [])]
    calls.append(calls_text(plan, inputs, list(axes), fixed_theta, dict(key.fixed)))
    body = "\n\n\n".join(part.strip("\n") for part in [*tables, *statements, *calls]) + "\n"
    shown_inputs = tuple(n for n in inputs if n not in plan.loads)
    head = _docstring(scene, name, key, plan.shown, shown_inputs, cost_of(program).operations)
    return "\n\n\n".join([head, "\n".join(import_lines(_called(imports, body))), body])


def _all_fixed(
    key: KernelKey, found: GridKernel, inputs: Mapping[str, Any], loads: Iterable[str]
) -> KernelKey:
    """The key with every number of the scene folded in; loads that vary with the motion stay inputs."""
    left = {*(n for n, value in inputs.items() if isinstance(value, tuple)), *loads}
    numbers = {n: inputs.get(n, 0.0) for n in found.request.inputs if n not in left}
    fixed = dict(key.fixed) | {n: float(value) for n, value in numbers.items()}
    return key._replace(fixed=tuple(fixed.items()))


def _in_order(program: Program) -> Program:
    """The program with its inputs in the order in which they stand in names."""
    return program._replace(inputs=tuple(sorted(program.inputs, key=ORDER.index)))


def _scalars(
    key: KernelKey, shown: tuple[str, ...], inputs: tuple[str, ...], own: Mapping[str, Sequence[str]]
) -> str:
    """The functions of one output each; those of a whole design take its own inputs alone."""
    functions = []
    for name, law in zip(shown, key.names, strict=True):
        taken = tuple(n for n in inputs if n in own.get(name, inputs))
        functions.append((name, _guarded(key, (law,)), taken))
    return scalars_source(functions, key.form.state)


def _guarded(key: KernelKey, names: tuple[str, ...]) -> Program:
    """The program of names of a point, which says what of its inputs is bad, as the array kernels do."""
    program = specialise(names, key.form, key.fixed, key.accuracy)
    if key.accuracy != "extended":
        return guard_inputs(program, program.inputs, LEAST, {})
    far = {"theta": _limit(key)}
    return double_double(guard_inputs(program, program.inputs, LEAST, far), double_constants())


def _kernels(key: KernelKey, inputs: tuple[str, ...], sources: list[str]) -> Kernel:
    """Append the sources of the array and the grid kernel; return the latter, which has the input order."""
    points = key._replace(axis_of=tuple((n, 0) for n in sorted(inputs)), axes=1, reduce=())
    own = _prefixed("point")
    kernel = kernel_of(points)
    kernel = kernel._replace(
        inputs={name: kernel.inputs[name] for name in inputs}
    )  # as `evaluate` passes them
    sources.append(renamed(emit_numba(kernel, "Points.", LAZY), own))
    if key.axes == 1:
        return kernel
    grid = kernel_of(key)
    own = _prefixed("grid")
    text = emit_reduced(grid, key.reduce, "", LAZY_REDUCED) if key.reduce else emit_numba(grid, "", LAZY)
    sources.append(renamed(text, own))
    return grid


def _prefixed(prefix: str) -> dict[str, str]:
    """Names of a kernel's module under which two of them can stand in one."""
    words = {name: f"{prefix}_{name}" for name in ("loops", "kernel")}
    signature = f"{prefix}_signature"
    words["compiled(loops, signature"] = f"compiled({prefix}_loops, {signature}"
    return words | {"signature = types": f"{signature} = types"}


def _shared(sources: list[str]) -> list[str]:
    """The plain point first; helpers of kernels under names that differ from its own."""
    plain, *kernels = sources
    helpers = {name: f"compiled_{name}" for name in (*HELPERS, *NUMBA_HELPERS)}
    return [plain, *(renamed(text, helpers, called=True) for text in kernels)]


def _limit(key: KernelKey) -> float:
    """The largest angle that the written-out sine and cosine reduce exactly."""
    return double_constants().limit if key.accuracy == "extended" else constants().limit


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
    """The module's docstring: its source, its contents, its units."""
    source = Path(scene.name).name
    command = f"desaxe compile {source} -o {name}" if source else f'desaxe.compile(scene, "{name}")'
    peak_lines = peak_texts(scene.content).lines
    loads = [load.identity for load in scene.content.inputs.values() if isinstance(load, Load)]
    said = hashlib.sha256(repr((scene.content, *loads) if loads else scene.content).encode())
    state = key.form.state
    own = own_axes(scene.content, shown).get(shown[0])
    first = f"{shown[0]}({'*INPUTS' if own is None else ', '.join(n for n in inputs if n in own)})"
    lines = [
        f"{scene.title or 'An offset slider-crank'}: {', '.join(shown)}.",
        "",
        f"Generated by `{command}`; write it again instead of editing it.",
        f"desaxe {version()}, derivation {digest()[:16]}, scene {said.hexdigest()[:16]}, {UNSEALED}.",
        f"A `point` takes {operations} operations, in a form that is right for any design: a sine is one,",
        "the scene's numbers are folded in.",
        "It needs NumPy and numba, and nothing of desaxe.",
        "",
        "    point(...)      one point in plain Python",
        "    evaluate(...)   numbers or arrays that broadcast",
        "    run()           the scene's own grid; run(theta=...) with other axes",
        *(f"    {line}" for line in peak_lines),
        *([] if loads else [f"    {first}   one output as a number, from @njit functions, too"]),
        "",
        f"Accuracy {key.accuracy}; SI units and radians. Y points along the slider axis towards the slider,",
        "theta turns from +Y towards +X.",
        "",
        *WITHOUT_VALUE,
        "",
    ]
    lost = lost_of(scene.content, "numba")
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
    body = "\n".join(lines).replace("\\", "/").replace('"""', "'''")
    return f'"""{body}\n"""'


def _fixed_as(name: str, value: float) -> str:
    unit = INPUTS[name].unit
    return f"{value!r} {unit}" if unit != "1" else repr(value)
