"""A Program as plain Python over `math`: one point, microseconds, nothing compiled."""

import math
from collections.abc import Callable, Sequence
from typing import Any

from .. import helpers
from ..builder import function_text
from ..operations import MATH_NAMES
from ..program import Program, tables_in
from ..text import with_short_temporaries, write_lines

SCOPE = {name: getattr(math, name) for name in MATH_NAMES} | vars(helpers)  # what spellings call


def point_text(program: Program, name: str = "point", arguments: Sequence[str] | None = None) -> str:
    """The function itself; without `arguments` it takes its inputs, then the arrays of its tables."""
    returned = "".join(f"{output}, " for output in program.outputs)
    body = [*write_lines(with_short_temporaries(program), "python"), f"return ({returned.strip()})"]
    if arguments is None:
        arguments = [*program.inputs, *(f"{table}_{end}" for table in tables_in(program) for end in "xc")]
    return function_text(name, arguments, body)


def compile_python(
    program: Program, arguments: Sequence[str] | None = None
) -> Callable[..., tuple[Any, ...]]:
    """The function, ready to be called; see `point_text`."""
    scope = dict(SCOPE)
    exec(compile(point_text(program, arguments=arguments), "<desaxe point>", "exec"), scope)
    function: Callable[..., tuple[Any, ...]] = scope["point"]
    return function
