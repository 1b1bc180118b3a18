"""A Program as a function of arrays that broadcast, in the spelling of the jax column."""

from collections.abc import Callable
from typing import Any

from .. import helpers
from ..builder import function_text, rebound
from ..program import Program
from ..text import with_short_temporaries, write_lines
from .jax import HELPERS as OF_ARRAYS
from .jax import RENAMED

Function = Callable[..., tuple[Any, ...]]

NAMES = (
    "atan2", "copysign", "cos", "exp", "fabs", "finfo", "floor", "hypot", "inf", "log", "logical_and",
    "logical_not", "logical_or", "nan", "pow", "result_type", "sin", "sqrt", "where",
)  # fmt: skip


def compile_arrays(program: Program, numpy: Any) -> Function:
    """A program as a function of arrays and numbers, over the functions of NumPy, the module."""
    program = with_short_temporaries(program)
    lines = [*write_lines(program, "jax"), f"return ({', '.join(program.outputs)},)"]
    text = OF_ARRAYS["power_of_two"] + function_text("function", program.inputs, lines)
    scope = rebound(helpers, {name: getattr(numpy, RENAMED.get(name, name)) for name in NAMES})
    exec(compile(text, "<desaxe arrays>", "exec"), scope)
    function: Function = scope["function"]
    return function
