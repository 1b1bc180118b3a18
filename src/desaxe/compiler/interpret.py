"""Run a Program line by line in doubles: each operation is its `python` column, and nothing raises."""

from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

from .languages.python import compile_python
from .operations import OPERATIONS
from .program import Line, Program, TableName


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
    columns = (column for a in args if isinstance(a, tuple) for column in a)
    return _function(op)(*(a for a in args if not isinstance(a, tuple)), *columns)[0]


@cache
def _function(op: str) -> Callable[..., tuple[Any, ...]]:
    pairs = zip("abc", OPERATIONS[op].signature[:-1], strict=False)
    args = tuple(TableName(name) if letter == "t" else name for name, letter in pairs)
    inputs = tuple(a for a in args if isinstance(a, str))
    return compile_python(Program(inputs, (Line("result", op, args),), ("result",), {}))
