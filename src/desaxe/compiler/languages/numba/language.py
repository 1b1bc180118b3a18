"""numba as a language: functions of one output each, and loop nests."""

from collections.abc import Sequence

from ...builder import module_text
from ...program import Program
from ...text import INDENT, with_short_temporaries, write_lines
from ..protocol import Language, Module, Symbol
from ..shared import one_line
from .module import CALLABLE, emit_numba, numba_parts

SCALAR = '''def scalar(function):
    """A function of floats for @njit functions, and for Python; compiled at the first call."""
    try:
        return njit(cache=True, error_model="numpy")(function)
    except RuntimeError:  # numba found no folder that it can write to
        return njit(error_model="numpy")(function)
'''


class Numba(Language):
    """Python that numba compiles; see the package."""

    name = "numba"
    suffix = ".py"
    about = "FILE.py: `point(...)`, `evaluate(...)`, `run()`; it needs NumPy and numba"
    loops = staticmethod(emit_numba)

    def files(self, module: Module) -> dict[str, str]:
        """`name.py`: for each result a function of its own."""
        scalars = [(one, module.values[one.name], module.taken(one.name)) for one in module.outputs]
        parts = scalar_parts(scalars)
        head = "\n".join(map(one_line, module.head))
        return {f"{module.name}.py": module_text(f"{head}\n", numba_parts(parts, jit=CALLABLE))}


def scalar_parts(scalars: Sequence[tuple[Symbol, Program, Sequence[str]]]) -> list[str]:
    """A function of numbers for each output: its Program, and the inputs that it takes."""
    return [SCALAR, *(_scalar(*one) for one in scalars)]


def _scalar(symbol: Symbol, program: Program, inputs: Sequence[str]) -> str:
    meaning = symbol.meaning or symbol.name  # a quantity of one's own may come without
    lines = [
        f'"""{meaning[0].upper()}{meaning[1:]} [{symbol.unit}]."""',
        *(f"{given} = float({given})" for given in inputs if given in program.inputs),
        *write_lines(with_short_temporaries(program), "numba"),
        f"return {program.outputs[0]}",
    ]
    rows = [INDENT + line for line in lines]
    return "\n".join(["@scalar", f"def {symbol.name}({', '.join(inputs)}):", *rows, ""])
