"""`evaluate` over columns of one shape, repeated: a cache of checked calls and their kernels.

A plan is made when the kernel is in memory. From then on a call checks its inputs, allocates the outputs and
runs the machine code. Whatever is out of the ordinary goes the general way (`arrays`).
"""

import struct
from collections.abc import Callable, Mapping
from ctypes import addressof, c_char
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..mechanism.inputs import SAFE, is_good
from ..mechanism.names import LENGTHS
from ..runtime.executor import CompiledKernel, is_ready, kernel_for, words
from ..runtime.kernels import key_of, of_numbers
from ..runtime.request import Request
from ..runtime.specialise import plain_form
from ..runtime.threads import LONGEST_BLOCK, least_of, run_parts
from ..support.memory import require
from ..support.recent import Recent

Array = NDArray[Any]
FLOAT, STATUS = np.dtype(np.float64), np.dtype(np.int8)
SMALL = 20_000  # points: so few are run at once, and again if some are left over


LEAST, LARGEST = SAFE


class _Call(NamedTuple):
    """A remembered request: its inputs, its wide-margin test, and the plans made so far."""

    request: Request
    inputs: tuple[str, ...]
    has_wide_margins: Callable[..., Any] | None
    plans: dict[tuple[Any, ...], "_Plan"]


class _Plan(NamedTuple):
    """A kernel, and how its arguments are packed."""

    kernel: CompiledKernel
    pack: Callable[..., bytes]  # addresses
    steps: bytes
    kinds: tuple[tuple[str, np.dtype[Any]], ...]
    refused: list[int]  # the sizes of calls of which points were left over


MOST_CALLS = 256  # requests that are remembered
_CALLS: Recent[Request, _Call] = Recent(MOST_CALLS)


def planned(
    wanted: Request,
    given: Mapping[str, Any],
    out: Any = None,
    threads: int | None = None,
    made: Mapping[str, Any] = MappingProxyType({}),
) -> dict[str, Array] | None:
    """The values by name; None if the call is no ordinary one, or its kernel is not in memory.

    made   numbers and arrays of the tables of loads, by the names of the kernel's inputs
    """
    call = _CALLS.get(wanted) or _new_call(wanted)
    numbers: dict[str, float] = {}
    columns: dict[str, Array] = {}
    kinds: list[bool | None] = []
    shape: tuple[int, ...] | None = None
    for name in call.inputs:
        if name in made:
            numbers[name] = made[name]
            continue
        value = given.get(name)
        if type(value) is not float and (
            isinstance(value, float) or (type(value) is int and -LARGEST < value < LARGEST)
        ):
            value = float(value)
        if type(value) is float:
            if not (LEAST < value < LARGEST or is_good(name, value)):
                return None
            numbers[name] = value
            kinds.append(value == 0.0)
        elif type(value) is np.ndarray and value.dtype is FLOAT:
            if not value.flags.c_contiguous:
                if 0 in value.strides:  # a value for many points, of which the general way makes use
                    return None
                value = np.ascontiguousarray(value)
            if shape is None:
                shape = value.shape
                if not shape or value.size < 2:
                    return None
            elif value.shape != shape:
                return None
            first = value.item(0)
            if not (LEAST < first < LARGEST or is_good(name, first)):
                return None
            columns[name] = value
            kinds.append(None)
        else:
            return None
    if shape is None:
        return None
    if call.has_wide_margins is not None:
        kinds.append(_all_wide(call.has_wide_margins, numbers))
    plan = call.plans.get(tuple(kinds)) or _new_plan(call, tuple(kinds), numbers, columns)
    if plan is None:
        return None
    return _run(plan, {**numbers, **made}, columns, shape, out, threads)


def _all_wide(test: Callable[..., Any], numbers: Mapping[str, float]) -> bool:
    """True for one design, of wide margins."""
    ec, AB, BC = (numbers.get(name) for name in LENGTHS)
    return ec is not None and AB is not None and BC is not None and bool(test(ec, AB, BC)[0])


def _addresses(arrays: list[Any]) -> list[int]:
    """The addresses of the arrays' memory, by the fastest way; read-only arrays take the slow one."""
    try:
        return [addressof(_bytes_of(array)) for array in arrays]
    except (TypeError, ValueError):
        return [array.__array_interface__["data"][0] for array in arrays]


_bytes_of = c_char.from_buffer


def _run(
    plan: _Plan,
    numbers: Mapping[str, Any],
    columns: Mapping[str, Array],
    shape: tuple[int, ...],
    out: Any,
    threads: int | None,
) -> dict[str, Array] | None:
    given = [columns[name] for name in plan.kernel.arguments]
    size = given[0].size
    if size > SMALL:
        if plan.refused:
            return None
        if out is None:
            require(size * sum(kind.itemsize for _, kind in plan.kinds), f"a result of the shape {shape}")
    if out is None:
        found: dict[str, Array] | None = {name: np.empty(shape, kind) for name, kind in plan.kinds}
    else:
        found = _given(plan, shape, out)
    if found is None:
        return None
    places = _addresses([*given, *found.values()])
    if out is not None and _overlap(places, len(given), 8 * size):
        return None
    data, tables, knots = plan.kernel.data(numbers), list[int](), list[int]()
    for name in plan.kernel.given:
        knots.append(numbers[f"{name}_x"].size)
        tables += _addresses([numbers[f"{name}_x"], numbers[f"{name}_c"]])
    if size > SMALL:
        return found if _run_in_parts(plan, places, (tables, knots), data, size, threads) else None
    left = plan.kernel.call(plan.pack(*places, *tables), words([size, *knots]), plan.steps, data)
    return None if left else found


def _run_in_parts(
    plan: _Plan,
    places: list[int],
    loads: tuple[list[int], list[int]],
    data: bytes,
    size: int,
    threads: int | None,
) -> bool:
    """Run many points, on threads where that pays; False if some are left over, and then for good.

    loads   the addresses of tables, and their numbers of knots
    """
    tables, knots = loads
    steps = struct.unpack(f"{len(places)}q", plan.steps)

    def part(start: int, stop: int) -> None:
        own = [place + start * step for place, step in zip(places, steps, strict=True)]
        if plan.kernel.call(plan.pack(*own, *tables), words([stop - start, *knots]), plan.steps, data):
            plan.refused.append(size)

    run_parts(part, size, threads, least_of(len(plan.kinds)), LONGEST_BLOCK)
    return not plan.refused


def _given(plan: _Plan, shape: tuple[int, ...], out: dict[str, Any]) -> dict[str, Array] | None:
    """The caller's arrays by name; None unless a kernel can write into them as they are."""
    found: dict[str, Array] = {}
    for name, kind in plan.kinds:
        array = out.get(name)
        if type(array) is not np.ndarray or array.dtype is not kind or array.shape != shape:
            return None
        if not (array.flags.c_contiguous and array.flags.writeable):
            return None
        found[name] = array
    return found if len(out) == len(found) else None


def _overlap(places: list[int], inputs: int, size: int) -> bool:
    """True if an output shares memory with another array."""
    return any(abs(places[k] - place) < size for k in range(inputs, len(places)) for place in places[:k])


def _new_call(wanted: Request) -> _Call:
    inputs = wanted.inputs
    known = wanted.accuracy != "extended" and all(name in inputs for name in LENGTHS)
    known = known and plain_form(wanted.names, wanted.form, wanted.fixed) is not None
    call = _Call(wanted, inputs, of_numbers(wanted.form) if known else None, {})
    _CALLS[wanted] = call
    return call


def _new_plan(
    call: _Call, kinds: tuple[Any, ...], scalars: Mapping[str, float], given: Mapping[str, Array]
) -> _Plan | None:
    """The plan for inputs of these kinds, if the kernel is in memory and the angles are not too large."""
    wanted = call.request
    columns = {name: column.reshape(-1) for name, column in given.items()}
    key = key_of(wanted, scalars, columns, dict.fromkeys(columns, 0), 1)
    if key.far or "theta" in scalars or not is_ready(key):
        return None
    kernel = kernel_for(key)
    results = tuple((name, STATUS if name == "status" else FLOAT) for name in wanted.shown)
    steps = [8] * len(kernel.arguments) + [kind.itemsize for _, kind in results]
    pack = struct.Struct(f"{len(steps) + 2 * len(kernel.given)}q").pack
    plan = call.plans[kinds] = _Plan(kernel, pack, words(steps), results, [])
    return plan
