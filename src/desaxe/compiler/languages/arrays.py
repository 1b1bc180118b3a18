"""A Program as a function of arrays that broadcast, in the spelling of the jax column."""

from collections.abc import Callable
from typing import Any

from .. import helpers
from ..builder import function_text, rebound
from ..program import Program, tables_in
from ..text import with_short_temporaries, write_lines
from .jax import HELPERS as OF_ARRAYS
from .jax import RENAMED

Function = Callable[..., tuple[Any, ...]]

NAMES = (
    "atan2", "copysign", "cos", "exp", "fabs", "finfo", "floor", "hypot", "inf", "log", "logical_and",
    "logical_not", "logical_or", "nan", "pow", "result_type", "sin", "sqrt", "where", "asarray",
    "searchsorted",
)  # fmt: skip
TABLES = ("lookup_piece", "lookup", "lookup_slope", "row_of")


def compile_arrays(program: Program, numpy: Any) -> Function:
    """A program as a function of arrays and numbers, over the functions of NumPy, the module.

    The arrays of its tables, knots and coefficients of each, are its last arguments.
    """
    program = with_short_temporaries(program)
    lines = [*write_lines(program, "jax"), f"return ({', '.join(program.outputs)},)"]
    tables = [f"{name}_{end}" for name in tables_in(program) for end in "xc"]
    helpers_of = [OF_ARRAYS[n] for n in ("power_of_two", *(TABLES if tables else ()))]
    text = "\n".join([*helpers_of, function_text("function", [*program.inputs, *tables], lines)])
    scope = rebound(helpers, {name: getattr(numpy, RENAMED.get(name, name)) for name in NAMES})
    exec(compile(text, "<desaxe arrays>", "exec"), scope)
    function: Function = scope["function"]
    return function
