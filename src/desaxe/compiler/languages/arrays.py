"""A Program as a function of arrays that broadcast, in the spelling of the jax column."""

from collections.abc import Callable
from typing import Any

from ..operations import HELPERS
from ..program import Program
from ..text import INDENT, with_short_temporaries, write_lines
from .jax import HELPERS as OF_ARRAYS
from .jax import RENAMED

Function = Callable[..., tuple[Any, ...]]

NAMES = (
    "atan2", "copysign", "cos", "exp", "fabs", "finfo", "floor", "hypot", "inf", "log", "logical_and",
    "logical_not", "logical_or", "nan", "pow", "result_type", "sin", "sqrt", "where",
)  # fmt: skip
SHARED = ("two_sum_error", "two_product_error", "mul_add", "extended_only", "rounding")


def compile_arrays(program: Program, numpy: Any) -> Function:
    """A program as a function of arrays and numbers, over the functions of NumPy, the module."""
    program = with_short_temporaries(program)
    lines = [*write_lines(program, "jax"), f"return ({', '.join(program.outputs)},)"]
    text = [f"def function({', '.join(program.inputs)}):", *(INDENT + line for line in lines)]
    helpers = [*(HELPERS[name] for name in SHARED), OF_ARRAYS["power_of_two"]]
    scope = {name: getattr(numpy, RENAMED.get(name, name)) for name in NAMES}
    exec(compile("\n".join([*helpers, *text]), "<desaxe arrays>", "exec"), scope)
    function: Function = scope["function"]
    return function
