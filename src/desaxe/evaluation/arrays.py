"""`evaluate` over arrays: broadcast the inputs, run in blocks, fill the outputs."""

from collections.abc import Iterable, Mapping, Sequence
from math import prod
from sys import float_info
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..mechanism.inputs import INPUTS, SAFE, Input, is_good, limit_of
from ..mechanism.messages import amount, named
from ..mechanism.read import read_array
from ..runtime.executor import run_in_blocks
from ..runtime.kernels import KernelKey, key_of
from ..runtime.point import point_of
from ..runtime.request import as_number
from ..support.forks import IMPORTS
from ..support.memory import require
from ..support.shown import shown

if TYPE_CHECKING:
    from .call import Call

Array = NDArray[Any]

NESTED = 200_000  # points from which a nest of loops, a kernel of its own, is worth its compilation
SMALL = 100_000  # points: so few always fit into memory
INNERMOST = 64  # points: a shorter innermost loop costs more to start than it saves
LEAST, MOST = SAFE
FLOAT, STATUS = np.dtype(np.float64), np.dtype(np.int8)


Keys = dict[Any, KernelKey] | None
# The lengths of the loops, outermost first; for each input its values along its loop, and which one.
Loops = tuple[tuple[int, ...], dict[str, Array], dict[str, int]]


def evaluate_arrays(
    call: "Call", inputs: Mapping[str, Any], threads: int | None, out: Any = None, keys: Keys = None
) -> dict[str, Array]:
    """The values by requested name, in the broadcast shape; `keys` are the kernels of earlier calls."""
    names = call.asked.shown
    scalars: dict[str, Any] = {}
    arrays: dict[str, Array] = {}
    others = False
    for name in call.inputs:
        value = inputs.get(name)
        if type(value) is float and (LEAST < value < MOST or is_good(name, value)):
            scalars[name] = value
        else:
            arrays[name] = as_array(name, value, call.inputs, names)
            others = others or hasattr(value, "dims") or hasattr(value, "iloc")
    if others:
        with IMPORTS:
            from .labelled import by_dimensions, is_labelled, refuse_differing, refuse_other_labels

        labelled = [n for n in call.inputs if out is None and is_labelled(inputs.get(n))]
        if labelled:
            refuse_differing({name: inputs.get(name) for name in call.inputs})
            labels = {name: inputs[name].copy(data=arrays.pop(name)) for name in labelled}

            def run(columns: Mapping[str, Array]) -> dict[str, Array]:
                return evaluate_arrays(call, {**scalars, **arrays, **columns}, threads, None, keys)

            return by_dimensions(run, names, labels, arrays, call.asked.form.state)
        refuse_other_labels({name: inputs.get(name) for name in call.inputs})
    shapes = {array.shape for array in arrays.values()}
    shape = shapes.pop() if len(shapes) == 1 else broadcast_shape(arrays)
    places = outputs_for(names, shape, out)
    buffers = places if out is None else scratch_for(places, arrays.values())
    if 0 not in shape:
        numbers = [name for name, array in arrays.items() if array.size == 1]
        scalars |= {name: arrays.pop(name).item() for name in numbers}
        fill(call, scalars, arrays, shape, list(buffers.values()), threads, keys=keys)
    if out is None:
        return places if shape else {name: place[()] for name, place in places.items()}
    return copied_back(places, buffers)


def as_array(name: str, value: Any, inputs: Sequence[str], names: Sequence[str]) -> Array:
    """An input as a float64 array; an error names it if missing, not numeric, or without a valid element."""
    if type(value) is np.ndarray and value.dtype == FLOAT:
        return _not_wholly_bad(name, value)
    number = None if type(value) is np.ndarray else as_number(name, value, inputs, names)
    if number is not None:
        return np.array(number)
    return _not_wholly_bad(name, read_array(INPUTS[name], value))


def number_or_array(row: Input, value: Any) -> Array:
    """The array of `read_array`; ValueError for a number that is not finite."""
    array = read_array(row, value)
    if not array.ndim and not np.isfinite(array):
        raise ValueError(named(row.name, value) + f": it must be {row.limit}")
    return array


def _not_wholly_bad(name: str, array: Array) -> Array:
    middle = array.item(array.size // 2) if array.size else 1.0
    if not (LEAST < middle < MOST or is_good(name, middle) or are_good(name, array).any()):
        first = array.item(0)
        message = amount(name, first) + f"; {limit_of(name, first)}"
        raise ValueError(f"{name}: every value is bad, the first is " + message)
    return array


def are_good(name: str, array: Array) -> NDArray[np.bool_]:
    """Mask of the elements that are valid values of an input."""
    least = LEAST if name == "BC" else INPUTS[name].least
    good: NDArray[np.bool_] = np.abs(array) <= (float_info.max if name == "theta" else MOST)
    return good if least is None else good & (array >= least)


def broadcast_shape(arrays: Mapping[str, Array]) -> tuple[int, ...]:
    """The broadcast shape; ValueError that names every shape if there is none."""
    try:
        return np.broadcast_shapes(*(array.shape for array in arrays.values()))
    except ValueError:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items() if array.ndim)
        raise ValueError(f"the shapes do not broadcast together: {shapes}") from None


def outputs_for(names: Sequence[str], shape: tuple[int, ...], out: Any) -> dict[str, Array]:
    """The output arrays: new ones, or those of `out`, checked."""
    if out is None:
        if prod(shape) > SMALL:
            size = sum(dtype_of(name).itemsize for name in names) * prod(shape)
            require(size, f"a result of the shape {tuple(shape)} and {len(names)} names")
        return {name: np.empty(shape, dtype_of(name)) for name in names}
    if not names and not isinstance(out, Mapping):
        raise ValueError(f"out = {shown(out)}: no name is given, so there is nothing to fill")
    places = dict(out) if isinstance(out, Mapping) else {names[0]: out}
    if set(places) != set(names):
        requested = (
            "a dict with the keys " + ", ".join(names) if len(names) > 1 else f"an array for {names[0]}"
        )
        raise ValueError(f"out= is {requested}, got {', '.join(places)}")
    for name, place in places.items():
        if not isinstance(place, np.ndarray) or place.shape != shape:
            result = getattr(place, "shape", type(place).__name__)
            raise ValueError(f"out= for {name}: expected an array of shape {shape}, got {result}")
        if not np.can_cast(dtype_of(name), place.dtype, "same_kind"):
            raise TypeError(f"out= for {name}: {place.dtype} cannot hold {dtype_of(name)}")
        if not place.flags.writeable:
            raise ValueError(f"out= for {name}: the array is read-only")
    return {name: places[name] for name in names}


def dtype_of(name: str) -> np.dtype[Any]:
    """The dtype of an output: int8 for a status, else float64."""
    return STATUS if name == "status" else FLOAT


def scratch_for(places: Mapping[str, Array], inputs: Iterable[Array]) -> dict[str, Array]:
    """Buffers for a kernel: the outputs where it can write into them, else new arrays to copy from."""
    every, result = [*inputs, *places.values()], dict[str, Array]()
    for name, place in places.items():
        direct = place.flags.c_contiguous and place.flags.aligned and place.dtype == dtype_of(name)
        shared = sum(np.may_share_memory(place, array) for array in every) > 1  # with more than itself
        result[name] = place if direct and not shared else np.empty(place.shape, dtype_of(name))
    return result


def copied_back(places: dict[str, Array], buffers: Mapping[str, Array]) -> dict[str, Array]:
    """The outputs, filled from the buffers."""
    for name, place in places.items():
        if buffers[name] is not place:
            np.copyto(place, buffers[name], casting="same_kind")
    return places


def fill(
    call: "Call",
    scalars: dict[str, Any],
    arrays: Mapping[str, Array],
    shape: tuple[int, ...],
    outs: Sequence[Array],
    threads: int | None,
    key: KernelKey | None = None,
    keys: Keys = None,
) -> None:
    """Fill contiguous outputs from numbers and from arrays that broadcast to a shape.

    key    the kernel, where these points are a block of more that it was chosen for: it has a loop for each
           dimension, or a single one
    keys   the kernels of a request that are remembered
    """
    if call.loads is not None:
        scalars, arrays = loaded(call, scalars, arrays)
    if key is None:
        sizes, columns, axis_of = loops_over(arrays, shape)
        key = key_of(call.asked, scalars, columns, axis_of, len(sizes), keys)
    else:
        sizes = shape if key.axes == len(shape) else (prod(shape),)
        columns = {n: _column(a, a.shape if key.axes > 1 else shape) for n, a in arrays.items()}
    if columns:
        outs = outs if sizes == shape else [out.reshape(sizes) for out in outs]
        run_in_blocks(key, {**scalars, **columns}, outs, threads)
        return
    point = point_of(key.names, key.form, key.fixed, key.accuracy)
    for out, value in zip(outs, point.run(scalars), strict=True):
        out[...] = value


def loaded(
    call: "Call", scalars: Mapping[str, Any], arrays: Mapping[str, Array]
) -> tuple[dict[str, Any], dict[str, Array]]:
    """The numbers and arrays that the request takes, those that follow from its loads among them."""
    loads, inputs = call.loads, {**scalars, **arrays}
    assert loads is not None
    made: dict[str, Any] = {}
    if loads.motion is not None:
        motion = call._replace(asked=loads.motion, inputs=loads.motion.inputs, loads=None)
        varying = {name: array for name, array in arrays.items() if name in motion.inputs}
        shape = broadcast_shape(varying)
        columns = outputs_for(motion.asked.shown, shape, None)
        fill(motion, {**scalars}, varying, shape, list(columns.values()), 1)
        made = loads.at({name: np.asarray(value) for name, value in inputs.items()}, columns)
    elif loads.functions:
        theta, shape = inputs["theta"], np.shape(inputs["theta"])
        result = loads.at({"theta": theta.reshape(-1) if shape and theta.size == max(shape) else theta})
        made = {name: value.reshape(shape) if np.ndim(value) else value for name, value in result.items()}
    numbers = {**scalars, **loads.tables(), **{n: float(x) for n, x in made.items() if not np.ndim(x)}}
    varying = {**arrays, **{n: x for n, x in made.items() if np.ndim(x)}}
    return numbers, {n: x for n, x in varying.items() if n in call.asked.inputs}


# ---- loops: a column of designs over a row of angles needs the sine of an angle once, not once a design ----


def loops_over(arrays: Mapping[str, Array], shape: Sequence[int]) -> Loops:
    """The loops for arrays that broadcast to a shape; none of them is a number."""
    size = prod(shape)
    nested = _nested(arrays, shape) if size >= NESTED else None
    if nested is not None:
        return nested
    columns = {
        name: array if array.shape == (size,) else _column(array, shape) for name, array in arrays.items()
    }
    return (size,), columns, dict.fromkeys(columns, 0)


def _nested(arrays: Mapping[str, Array], shape: Sequence[int]) -> Loops | None:
    """A nest of loops, if there is one that pays."""
    along = {name: _varies_along(array, shape) for name, array in arrays.items()}
    groups: list[list[int]] = []
    for axis in (axis for axis, size in enumerate(shape) if size > 1):
        together = groups and _inputs(along, groups[-1][-1]) == _inputs(along, axis)
        groups = [*groups[:-1], [*groups[-1], axis]] if together else [*groups, [axis]]
    place = {axis: place for place, group in enumerate(groups) for axis in group}
    places = {name: {place[axis] for axis in axes} for name, axes in along.items()}
    sizes = tuple(prod(shape[axis] for axis in group) for group in groups)
    if len(groups) < 2 or sizes[-1] < INNERMOST or any(len(own) > 1 for own in places.values()):
        return None
    columns = {name: _column(array, array.shape) for name, array in arrays.items()}
    return sizes, columns, {name: min(own) for name, own in places.items()}


def _varies_along(array: Array, shape: Sequence[int]) -> set[int]:
    """The axes of the shape along which an array has more than one value."""
    lead = len(shape) - array.ndim
    return {lead + axis for axis, size in enumerate(array.shape) if size > 1}


def _inputs(along: Mapping[str, set[int]], axis: int) -> set[str]:
    return {name for name, axes in along.items() if axis in axes}


def _column(array: Array, shape: Sequence[int]) -> Array:
    if array.shape == shape and array.flags.c_contiguous:
        return array.reshape(-1)
    return np.ascontiguousarray(np.broadcast_to(array, shape)).reshape(-1)
