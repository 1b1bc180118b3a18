"""The values that a function reads besides its arguments, which numba freezes where it compiles it."""

from collections.abc import Callable, Iterator
from types import BuiltinFunctionType, CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

PLAIN = (bool, int, float, complex, str, bytes, type(None), np.generic)
CONSTANT = (BuiltinFunctionType, np.ufunc, type)


def values_read(function: Callable[..., Any]) -> tuple[Any, ...] | None:
    """A key of the code and the values that it reads; None where one may change without a trace."""
    plain = getattr(function, "py_func", function)
    if not isinstance(plain, FunctionType):
        return None
    try:
        return (None if plain is function else function, *_of_function(plain, ()))
    except (TypeError, ValueError):  # an object of any other kind, or a cell that is empty
        return None


def _of_function(function: FunctionType, seen: tuple[Any, ...]) -> tuple[Any, ...]:
    code, names = function.__code__, tuple(dict.fromkeys(_names(function.__code__)))
    cells = zip(code.co_freevars, function.__closure__ or (), strict=True)
    read = {name: function.__globals__[name] for name in names if name in function.__globals__}
    read |= {f"{name} of a cell": cell.cell_contents for name, cell in cells}
    read["defaults"] = (function.__defaults__, *(function.__kwdefaults__ or {}).items())
    return code, *((name, _key(value, names, (*seen, function))) for name, value in read.items())


def _names(code: CodeType) -> Iterator[str]:
    """The globals and attributes that code, and code inside of it, may read."""
    yield from code.co_names
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _names(constant)


def _key(value: Any, names: tuple[str, ...], seen: tuple[Any, ...]) -> Any:
    """A hashable value that is equal for equal values; TypeError where there is none."""
    if any(value is one for one in seen):
        return None
    if isinstance(value, PLAIN):
        return type(value), repr(value)
    if isinstance(value, np.ndarray) and not value.dtype.hasobject:
        return value.dtype.str, value.shape, value.tobytes()
    if isinstance(value, tuple):
        return type(value), *(_key(part, names, seen) for part in value)
    if isinstance(value, ModuleType):
        own = {name: getattr(value, name) for name in names if hasattr(value, name)}
        return value.__name__, *((name, _key(part, names, (*seen, value))) for name, part in own.items())
    if isinstance(value, FunctionType):
        return _of_function(value, seen)
    if isinstance(value, CONSTANT) or hasattr(value, "py_func"):
        return value
    raise TypeError
