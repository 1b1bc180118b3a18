"""A Program as plain Python over `math`: one point, microseconds, nothing compiled."""

from collections.abc import Callable
from typing import Any

from ..operations import HELPERS, MATH_NAMES
from ..program import Program
from ..text import INDENT, with_short_temporaries, write_lines

_HEADER = f"from math import {', '.join(MATH_NAMES)}\n\n\n" + "\n\n".join(HELPERS.values())


def emit_python(program: Program, name: str = "point") -> str:
    """The source of `name(*inputs)`, which returns a tuple of the outputs and never raises."""
    returned = "".join(f"{output}, " for output in program.outputs)
    body = [*write_lines(with_short_temporaries(program), "python"), f"return ({returned.strip()})"]
    signature = f"def {name}({', '.join(program.inputs)}):"
    return "\n".join([_HEADER, "", signature, *(INDENT + line for line in body)]) + "\n"


def compile_python(program: Program) -> Callable[..., tuple[Any, ...]]:
    """The function itself."""
    scope: dict[str, Any] = {}
    exec(compile(emit_python(program), "<desaxe point>", "exec"), scope)
    function: Callable[..., tuple[Any, ...]] = scope["point"]
    return function
