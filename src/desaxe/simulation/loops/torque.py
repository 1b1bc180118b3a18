"""The torque of many designs, a function of the user's: compiled by numba, for many nodes in one call."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from inspect import signature
from types import BuiltinFunctionType, CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

from ...loads.arguments import arguments_of
from ...support.forks import IMPORTS, ForkSafeLock, imported
from ...support.signals import finished
from ..drive import ROLES

PLAIN = (bool, int, float, complex, str, bytes, type(None), np.generic)
CONSTANT = (BuiltinFunctionType, np.ufunc, type)
_LOCK = ForkSafeLock()


@dataclass(frozen=True)
class _Frozen:
    """A function with the values that it reads now, by which it is remembered."""

    values: tuple[Any, ...]
    torque: Callable[..., Any] = field(compare=False)


def compiled(torque: Callable[..., Any]) -> Any:
    """The machine code of a function, at `address`; TypeError where numba cannot compile it.

    It takes rows of numbers, how far apart they are and how many numbers each has: it reads t, theta and
    omega and fills in the fourth row. Its whole number is 0 unless the function raises an exception.
    Numba freezes the values of globals and closure cells: the code is made anew where they have changed.
    """
    values = values_read(torque)
    return _made(torque) if values is None else _remembered(_Frozen(values, torque))


@lru_cache(maxsize=32)
def _remembered(frozen: _Frozen) -> Any:
    return _made(frozen.torque)


def _made(torque: Callable[..., Any]) -> Any:
    def made() -> Any:
        with _LOCK:
            return _compiled(torque)

    return finished(made)


def _compiled(torque: Callable[..., Any]) -> Any:
    with IMPORTS:
        from numba.core.errors import NumbaError

    numba: Any = imported("numba")
    arguments = arguments_of("torque", getattr(torque, "py_func", torque), ROLES)
    try:
        fast = _fast(torque, arguments)
    except (NumbaError, TypeError) as error:
        message = str(error).strip().splitlines()
        why = next((line for line in message if line.strip() and "pipeline" not in line), "")
        raise TypeError(
            "torque: for many designs at once numba must be able to compile the function, and it cannot: "
            f"{why.strip()}; use numbers and math in it, or simulate one design at a time"
        ) from None
    passed = ", ".join(f"rows[{ROLES.index(argument)} * apart + i]" for argument in arguments)
    scope: dict[str, Any] = {"fast": fast, "carray": numba.carray}
    exec(_LOOP.format(passed), scope)
    types = numba.types
    kinds = types.int64(types.CPointer(types.float64), types.int64, types.int64)
    return numba.cfunc(kinds, error_model="numpy")(scope["torques"])


_LOOP = """
def torques(memory, apart, count):
    rows = carray(memory, 3 * apart + count)
    try:
        for i in range(count):
            rows[3 * apart + i] = fast({})
    except Exception:
        return 1
    return 0
"""


def _fast(torque: Any, arguments: tuple[str, ...]) -> Any:
    """A function of these arguments, compiled for numbers."""
    with IMPORTS:
        from numba import float64, njit
        from numba.core.dispatcher import Dispatcher
        from numba.core.types import Float, Integer, Omitted

    fast: Any = torque if isinstance(torque, Dispatcher) else njit(error_model="numpy")(torque)
    others = [p.default for p in signature(fast).parameters.values()][len(arguments) :]
    types = (*(float64,) * len(arguments), *map(Omitted, others))
    fast.compile(types)
    result = fast.overloads[types].signature.return_type
    if not isinstance(result, (Float, Integer)):
        raise TypeError(f"torque: the function gives {result}, expected a number in N*m")
    return fast


# ---- the values that a function reads besides its arguments, which numba freezes -------------------


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
