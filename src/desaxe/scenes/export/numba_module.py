"""A scene as a module of numba: its results, its own axes and reductions, its peaks."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from ...compiler.builder import MATH, function_text, quoted, with_sources
from ...compiler.languages.protocol import Module
from ..content import Content
from ..scene import Scene
from .axes import arguments_of, axes_text
from .peaks import carried, left_out_of_module, peak_texts
from .portable import Order, module_of

HERE = Path(__file__).parent
FUNCTIONS, STEPS = HERE / "functions.py", HERE / "peak_steps.py"
_NUMPY = ("array", "empty", "fmax", "linspace")
IMPORTS = {**MATH, **dict.fromkeys(_NUMPY, "numpy"), "njit": "numba", "uint64": "numpy"}


def numba_module_of(scene: Scene, order: Order) -> Module:
    """The module of a scene: `run` over its axes, and a function for each peak that it can have."""
    content = scene.content
    peaks = carried(content)
    names = tuple(dict.fromkeys(name for one in peaks for name in one.names))
    opened = tuple(dict.fromkeys(name for one in peaks for name in one.opened))
    order = order._replace(status=content.reduction is None, lost=left_out_of_module)
    module = module_of(scene, order, names, opened)
    numbers = {name: content.inputs.get(name) for name in opened if name in module.forms.stable.inputs}
    fixed = {name: value if isinstance(value, float) else 0.0 for name, value in numbers.items()}
    module = module._replace(fixed=fixed, angle="theta")
    axes = {n: value for n, value in content.inputs.items() if isinstance(value, tuple)}
    texts = [axes_text(axes), _run(module, content, axes)] if axes else [_FIXED]
    uses = ["    run()           the scene's own grid; run(theta=...) with other axes"]
    searches, lines = peak_texts(peaks, module, names)
    search = with_sources(searches, [STEPS], "@inner\n", IMPORTS)
    more = with_sources([*texts, *search.texts], [FUNCTIONS], imports=search.imports)
    return module._replace(more=more, uses=(*uses, *lines))


_FIXED = '''def run():
    """The values; every input is fixed."""
    return evaluate()
'''


def _run(module: Module, content: Content, axes: Mapping[str, Sequence[float]]) -> str:
    """`run()`: the results over the scene's axes, or over others, reduced where the scene says so."""
    fused = content.fused
    if fused is not None:
        ordered = [*(n for n in axes if n != fused.axis), fused.axis]
        how = f"{fused.axis} reduced. `_skipped`: how many points along it have no value."
        body = [
            f"axes = with_axes({{name: AXES[name] for name in {quoted(tuple(ordered))}}}, locals())",
            "",
            "def values(axes):",
            "    return grid(threads=threads, **axes)",
            "",
            f"return reduced(values, axes, {quoted(fused.axis)}, {quoted(tuple(fused.kinds))})",
        ]
    else:
        how = "one dimension for each. An axis that is given takes the place of the scene's."
        indices = {
            name: tuple(k for k, axis in enumerate(axes) if axis not in taken)
            for name, taken in module.arguments.items()
        }
        body = [
            "axes = with_axes(AXES, locals())",
            "out = grid(threads=threads, **axes)",
            *(
                f'out["{name}"] = fmax.reduce(out["{name}"], axis={along}, initial=nan)  # all the same'
                for name, along in indices.items()
                if along
            ),
            "return out",
        ]
    body = [f'"""The results over {" x ".join(axes)}: {how}"""', *body]
    return function_text("run", arguments_of(axes), body)
