"""The torque of many designs, a function of the user's: compiled alone, for many nodes in one call.

Kernels know the address of its machine code only, and so stand in the cache whatever the function is. Its
sine and cosine are written out where they can be, for then its loop runs in the lanes of a vector.
"""

import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from functools import lru_cache
from inspect import signature
from types import CellType, FunctionType, ModuleType
from typing import Any

import numpy as np

from ...compiler.builder import function_text, module_text
from ...compiler.languages.numba.module import NJIT, numba_parts
from ...compiler.lowering import for_loops
from ...compiler.program import Line, Program
from ...compiler.text import with_short_temporaries, write_lines
from ...loads.arguments import arguments_of
from ...mechanism.constants import constants
from ...runtime.native.modules import Native, native_here
from ...support.forks import IMPORTS, ForkSafeLock
from ...support.interrupts import finished
from ..checks import TIME_AND_CRANK
from .values_read import values_read

_LOCK = ForkSafeLock()
_LARGEST = 2.0**45  # rad: beyond, a written-out sine is NaN, and the C library's is asked
_CALL = "put(rows, uint64(3 * apart + i), {}({}))"
_COLUMNS = {name: f"get(rows, uint64({k} * apart + i))" for k, name in enumerate(TIME_AND_CRANK)}
_SIGNATURE = """signature = types.int64(types.int64, types.int64, types.int64)
function = torques
"""


@dataclass(frozen=True)
class _Frozen:
    """A function with the values that it reads now, by which it is remembered."""

    values: tuple[Any, ...]
    torque: Callable[..., Any] = field(compare=False)


def compiled(torque: Callable[..., Any]) -> Native:
    """The machine code of a function (see `sources.given`); TypeError where numba cannot compile it.

    Numba freezes the values of globals and closure cells: the code is made anew where they have changed.
    """
    values = values_read(torque)
    return _made(torque) if values is None else _remembered(_Frozen(values, torque))


@lru_cache(maxsize=32)
def _remembered(frozen: _Frozen) -> Native:
    return _made(frozen.torque)


def _made(torque: Callable[..., Any]) -> Native:
    def made() -> Native:
        with _LOCK:
            return _compiled(torque)

    return finished(made)


def _compiled(torque: Callable[..., Any]) -> Native:
    with IMPORTS:
        from numba.core.dispatcher import Dispatcher
        from numba.core.errors import NumbaError

    plain = getattr(torque, "py_func", torque)
    arguments = arguments_of("torque", plain, TIME_AND_CRANK)
    try:
        fast = _fast(torque, arguments)
    except (NumbaError, TypeError) as error:
        told = str(error).strip().splitlines()
        why = next((line for line in told if line.strip() and "pipeline" not in line), "")
        raise TypeError(
            "torque: for many designs at once numba must be able to compile the function, and it cannot: "
            f"{why.strip()}; use numbers and math in it, or simulate one design at a time"
        ) from None
    scope: dict[str, Any] = {"given": fast}
    parts, body = list[str](), ["rows = room_at(place)", *_loop("given", arguments)]
    if not isinstance(torque, Dispatcher) and _with_sines(plain, {"sin": None, "cos": None}) is not None:

        def with_sines(sine: Any, cosine: Any) -> Any:
            """The function with these; the given one where they do not suit it."""
            with suppress(NumbaError, TypeError):
                return _fast(_with_sines(plain, {"sin": sine, "cos": cosine}), arguments)
            return fast

        scope["with_sines"] = with_sines
        parts = [_written("sin"), _written("cos"), "in_lanes = with_sines(written_sin, written_cos)\n"]
        body = ["rows = room_at(place)", *_loop("in_lanes", arguments), "none = 0.0"]
        body += ["for i in range(count):"]
        body += ["    none += 0.0 * get(rows, uint64(3 * apart + i))", "if none != none:"]
        body += [f"    {row}" for row in _loop("given", arguments)]
    text = function_text("torques", ("place", "apart", "count"), [*body, "return 0"])
    return native_here(module_text("desaxe: a torque.", numba_parts([*parts, text, _SIGNATURE])), scope)


def _loop(name: str, arguments: tuple[str, ...]) -> list[str]:
    """The lines of a loop over the nodes."""
    passed = ", ".join(_COLUMNS[argument] for argument in arguments)
    return ["for i in range(count):", "    " + _CALL.format(name, passed)]


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


def _with_sines(plain: Callable[..., Any], sines: Mapping[str, Any]) -> Callable[..., Any] | None:
    """The function with these sines and cosines; None where it has none, or is no plain function."""
    if not isinstance(plain, FunctionType):
        return None
    used, cells = plain.__code__.co_names, plain.__closure__ or ()
    own = {n: _other(plain.__globals__[n], used, sines) for n in used if n in plain.__globals__}
    held = [_other(cell.cell_contents, used, sines) for cell in cells]
    changed = [value is not plain.__globals__[name] for name, value in own.items()]
    changed += [value is not cell.cell_contents for value, cell in zip(held, cells, strict=True)]
    if not any(changed):
        return None
    names, closure = plain.__globals__ | own, tuple(map(CellType, held))
    made = FunctionType(plain.__code__, names, plain.__name__, plain.__defaults__, closure)
    made.__kwdefaults__ = plain.__kwdefaults__
    return made


def _other(value: Any, used: tuple[str, ...], sines: Mapping[str, Any]) -> Any:
    """The stand-in for a sine, a cosine, or a module of them that a function uses."""
    for name, there in (("sin", (math.sin, np.sin)), ("cos", (math.cos, np.cos))):
        if any(value is one for one in there):
            return sines[name]
    if (value is math or value is np) and not sines.keys().isdisjoint(used):
        return _Other(value, sines)
    return value


class _Other(ModuleType):
    """A module with other sines and cosines."""

    def __init__(self, module: ModuleType, sines: Mapping[str, Any]) -> None:
        super().__init__(module.__name__)
        self._module, self._sines = module, sines

    def __getattr__(self, name: str) -> Any:
        return self._sines[name] if name in self._sines else getattr(self._module, name)


def _written(name: str) -> str:
    """Sine or cosine without a call or a branch; NaN beyond the largest angle."""
    program = Program(("x",), (Line("found", name, ("x",)),), ("found",), {})
    rows = write_lines(with_short_temporaries(for_loops(program, constants(), plain=True)), "numba")
    last = f"return found if fabs(x) <= {_LARGEST} else nan"
    return NJIT + function_text(f"written_{name}", ("x",), [*rows, last])
