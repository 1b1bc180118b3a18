"""`evaluate` over columns of one shape, repeated: a cache of checked calls and their kernels.

A plan is made when the kernel is in memory. From then on a call checks its inputs, makes room for the
answers and runs the machine code, by the loop of `runtime.any_stride`, which also looks for angles that are
too large. Whatever is out of the ordinary goes the general way (`arrays`).
"""

import struct
from collections.abc import Callable, Mapping
from ctypes import CFUNCTYPE, addressof, c_char, c_char_p, c_int64
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..mechanism.constants import limit_of
from ..mechanism.inputs import is_good
from ..mechanism.names import LENGTHS
from ..runtime.kernels import is_ready, kernel_for, key_of, tells_unsafe
from ..runtime.native.any_stride import data_of, loop
from ..runtime.request import Request
from ..runtime.specialise import plain_form
from ..runtime.threads import LONGEST_BLOCK, least_of, run_parts
from ..runtime.wide_margins import of_numbers
from ..support.memory import require
from .extremes import LEAST, is_extreme
from .extremes import MOST as LARGEST

Array = NDArray[Any]
FLOAT, STATUS = np.dtype(np.float64), np.dtype(np.int8)
SMALL = 20_000  # points: so few are run at once, and again if some are left over
_Loop = CFUNCTYPE(c_int64, c_char_p, c_char_p, c_char_p, c_char_p)


class _Call(NamedTuple):
    """A remembered request: its inputs, its wide-margin test, and the plans made so far."""

    request: Request
    inputs: tuple[str, ...]
    has_wide_margins: Callable[..., Any] | None
    plans: dict[tuple[Any, ...], "_Plan"]


class _Plan(NamedTuple):
    """A kernel as a ufunc's inner loop, and the packing of the table of its arguments."""

    loop: Callable[[bytes, bytes, bytes, bytes], int]
    head: bytes  # of the loop's data
    pack: Callable[..., bytes]  # the numbers of the kernel's table; the loop fills in the rest
    order: tuple[int, ...]  # of the numbers
    addresses: Callable[..., bytes]
    steps: bytes
    kinds: tuple[tuple[str, np.dtype[Any]], ...]
    refused: list[int]  # the sizes of calls of which points were left over
    kept: Any


_CALLS: dict[int, _Call] = {}
_ONE = struct.Struct("q").pack


def planned(
    wanted: Request, given: Mapping[str, Any], out: Any = None, threads: int | None = None
) -> dict[str, Array] | None:
    """The values by name; None if the call is no ordinary one, or its kernel is not in memory."""
    call = _CALLS.get(id(wanted)) or _new_call(wanted)
    numbers: dict[str, float] = {}
    columns: dict[str, Array] = {}
    kinds: list[bool | None] = []
    shape: tuple[int, ...] | None = None
    for name in call.inputs:
        value = given.get(name)
        if type(value) is not float and (
            isinstance(value, float) or (type(value) is int and -LARGEST < value < LARGEST)
        ):
            value = float(value)
        if type(value) is float:
            if not (LEAST < value < LARGEST or _is_ordinary(name, value)):
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
            if not (LEAST < first < LARGEST or _is_ordinary(name, first)):
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
    return _run(plan, list(numbers.values()), list(columns.values()), shape, out, threads)


def _is_ordinary(name: str, value: float) -> bool:
    """True for a valid number that is not near the ends of the double range."""
    return is_good(name, value) and not is_extreme(name, value)


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
    numbers: list[float],
    columns: list[Array],
    shape: tuple[int, ...],
    out: Any,
    threads: int | None,
) -> dict[str, Array] | None:
    size = columns[0].size
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
    places = _addresses([*columns, *found.values()])
    if out is not None and _overlap(places, len(columns), 8 * size):
        return None
    table = plan.pack(*[numbers[place] for place in plan.order])
    if size > SMALL:
        return found if _run_in_parts(plan, places, plan.head + table, size, threads) else None
    left = plan.loop(plan.addresses(*places), _ONE(size), plan.steps, plan.head + table)
    return None if left else found


def _run_in_parts(plan: _Plan, places: list[int], data: bytes, size: int, threads: int | None) -> bool:
    """Run many points, on threads where that pays; False if some are left over, and then for good."""
    steps = struct.unpack(f"{len(places)}q", plan.steps)

    def part(start: int, stop: int) -> None:
        own = [place + start * step for place, step in zip(places, steps, strict=True)]
        if plan.loop(plan.addresses(*own), _ONE(stop - start), plan.steps, data):
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
    _CALLS[id(wanted)] = call  # which keeps the request, and with it its id
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
    order, own = list(columns), list(scalars)
    names = [name for name, _ in kernel.axis_of]
    places: list[int | float] = [float(own.index(n)) if n in scalars else order.index(n) for n in names]
    places += range(len(order), len(order) + len(wanted.names))
    # A kernel that counts unsafe points looks at the angles itself.
    looked_at = "theta" in order and "theta" in names and not tells_unsafe(key)
    angle = order.index("theta") if looked_at else None
    head, _ = data_of(kernel.function, places, len(order), angle, limit_of(key.accuracy))
    ranks = kernel.function.ranks
    words = "".join("d" if rank < 0 else "24x" for rank in ranks)
    results = tuple((name, STATUS if name == "status" else FLOAT) for name in wanted.shown)
    steps = [8] * len(order) + [kind.itemsize for _, kind in results]
    inner = loop()
    plan = _Plan(
        _Loop(inner.address),
        head,
        struct.Struct(words).pack,
        tuple(int(place) for place, rank in zip(places, ranks, strict=True) if rank < 0),
        struct.Struct(f"{len(steps)}q").pack,
        struct.pack(f"{len(steps)}q", *steps),
        results,
        [],
        (inner, kernel),
    )
    call.plans[kinds] = plan
    return plan
