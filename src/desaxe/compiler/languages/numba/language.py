"""numba as a language: modules that people import, with or without a file of helpers beside them."""

from ..protocol import Language, Module
from ..shared import documented, refuse_taken, taken_in_python
from .library import emit_alone

USE = (
    "It needs NumPy and numba, and nothing of desaxe:",
    "",
    "    point(...)      numbers to a tuple of OUTPUTS, also inside of an @njit function",
    "    evaluate(...)   arrays that broadcast, to a dict of arrays",
)
GRID = "    grid(...)       one dimension for each input of one dimension, in the order of the inputs"
FUNCTION = "    {name}({inputs})   one output as a number, from @njit functions, too"


class Numba(Language):
    """Python that numba compiles; see the package."""

    name = "numba"
    suffix = ".py"
    about = "FILE.py: `point(...)`, `evaluate(...)`, `grid(...)`, `run()`; it needs NumPy and numba"
    only_file = True

    def files(self, module: Module) -> dict[str, str]:
        """`name.py`."""
        first = module.outputs[0].name
        use = [*USE, *([GRID] if module.inputs else []), *module.uses]
        use.append(FUNCTION.format(name=first, inputs=", ".join(module.taken(first))))
        text = emit_alone(module, documented(module, use))
        refuse_taken((symbol.name for symbol in module.outputs), taken_in_python(text))
        return {f"{module.name}.py": text}
