"""Run a Program line by line in doubles: each operation is its `python` column, and nothing raises."""

from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

from .languages.python import SCOPE
from .operations import OPERATIONS
from .program import Program, TableName


def run_in_doubles(program: Program, values: Mapping[str, Any]) -> dict[str, Any]:
    """Every name of the program in double precision; inf and NaN flow.

    values   numbers of the inputs; knots and coefficients of tables
    """
    scope: dict[str, Any] = dict(values)
    for line in program.lines:
        args = (a.name if isinstance(a, TableName) else a for a in line.args)
        scope[line.name] = ieee(line.op, *(scope[a] if isinstance(a, str) else a for a in args))
    return scope


def ieee(op: str, *args: Any) -> Any:
    """Apply one operation with IEEE 754 semantics; a table is its knots and coefficients."""
    spread = ((a,) if not isinstance(a, tuple) else a for a in args)
    return _function(op)(*(part for each in spread for part in each))


@cache
def _function(op: str) -> Callable[..., Any]:
    operation = OPERATIONS[op]
    names = "abc"[: operation.arity]
    pairs = zip(names, operation.signature, strict=False)
    parameters = (f"{name}_x, {name}_c" if letter == "t" else name for name, letter in pairs)
    function: Callable[..., Any] = eval(
        f"lambda {', '.join(parameters)}: {operation.python.format(*names)}", dict(SCOPE)
    )
    return function
