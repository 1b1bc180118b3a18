"""`evaluate` over arrays: broadcast the inputs, run in blocks, fill the outputs."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from math import prod
from sys import float_info
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..mechanism.inputs import INPUTS, SAFE, Input, is_good, limit_of
from ..mechanism.messages import amount, named
from ..mechanism.read import read_array
from ..runtime.executor import run_in_blocks
from ..runtime.kernels import KernelKey, key_of
from ..runtime.point import point_of
from ..runtime.request import Request, as_number
from ..support.memory import require
from ..support.shown import shown

if TYPE_CHECKING:
    from .under_loads.request import LoadInputs

Array = NDArray[Any]

NESTED = 200_000  # points from which a nest of loops, a kernel of its own, is worth its compilation
SMALL = 20_000  # points: so few always fit into memory
INNERMOST = 64  # points: a shorter innermost loop costs more to start than it saves
LEAST, MOST = SAFE
FLOAT, STATUS = np.dtype(np.float64), np.dtype(np.int8)


class Loops(NamedTuple):
    """The lengths of the loops, outermost first; for each input its values along its loop, and which one."""

    sizes: tuple[int, ...]
    columns: dict[str, Array]
    axis_of: dict[str, int]

    def taken_by(self, requested: Request) -> "Loops":
        """The loops with the columns that a request takes; a force may vary where nothing else does."""
        columns = {name: column for name, column in self.columns.items() if name in requested.inputs}
        return (
            self
            if len(columns) == len(self.columns)
            else self._replace(columns=columns, axis_of={n: self.axis_of[n] for n in columns})
        )


def evaluate_arrays(
    requested: Request,
    inputs: Sequence[str],
    given: Mapping[str, Any],
    threads: int | None,
    out: Any,
    loads: "LoadInputs | None" = None,
    keys: dict[Any, KernelKey] | None = None,
) -> dict[str, Array]:
    """The values by requested name, in the broadcast shape.

    inputs   those that are numbers or arrays of the caller; others follow from `loads`
    keys     the kernels of the request that are remembered
    """
    names = requested.shown
    scalars: dict[str, Any] = {}
    arrays: dict[str, Array] = {}
    labelled = False
    for name in inputs:
        value = given.get(name)
        if type(value) is float and (LEAST < value < MOST or is_good(name, value)):
            scalars[name] = value
        else:
            arrays[name] = as_array(name, value, inputs, names)
            labelled = labelled or type(value) is not np.ndarray
    if labelled:
        refuse_other_labels({name: given.get(name) for name in inputs})
    shapes = {array.shape for array in arrays.values()}
    shape = shapes.pop() if len(shapes) == 1 else broadcast_shape(arrays)
    places = outputs_for(names, shape, out)
    buffers = places if out is None else scratch_for(places, arrays.values())
    if 0 not in shape:
        numbers = [name for name, array in arrays.items() if array.size == 1]
        scalars |= {name: arrays.pop(name).item() for name in numbers}
        if loads is not None:
            scalars |= loads.tables()
            for name, made in _functions(loads, {**scalars, **arrays}).items() if loads.functions else ():
                if np.ndim(made):
                    arrays[name] = made
                else:
                    scalars[name] = float(made)
        loops = loops_over(arrays, shape)
        loops = loops if loads is None else loops.taken_by(requested)
        fill(requested, scalars, loops, list(buffers.values()), threads, keys=keys)
    if out is None:
        return places if shape else {name: place[()] for name, place in places.items()}
    return copied_back(places, buffers)


def _functions(loads: "LoadInputs", given: Mapping[str, Any]) -> dict[str, Any]:
    """The values of loads that are no tables, and their derivatives."""
    motion = loads.motion
    if motion is None:
        return loads.at(given)
    numbers = {name: np.asarray(value) for name, value in given.items() if name in INPUTS}
    return loads.at(numbers, evaluate_arrays(motion, motion.inputs, numbers, 1, None))


def refuse_other_labels(inputs: Mapping[str, Any]) -> None:
    """ValueError for labelled arrays of different dimensions or rows, where arrays broadcast by position."""
    labels = {name: value.dims for name, value in inputs.items() if hasattr(value, "dims") and value.dims}
    if len(set(labels.values())) > 1:
        message = ", ".join(f"{name} {dims}" for name, dims in labels.items())
        raise ValueError(
            f"labelled arrays of different dimensions: {message}; use grid, or pass their .values"
        )
    rows = [(name, value.index) for name, value in inputs.items() if hasattr(value, "iloc")]
    for name, index in rows[1:]:
        first, expected = rows[0]
        if len(index) == len(expected) and not index.equals(expected):
            raise ValueError(f"{first} and {name}: Series of different index; align them or pass .values")


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
    if array.size and not is_good(name, array.item(0)) and not are_good(name, array).any():
        first = amount(name, array.item(0))
        limit = limit_of(name, array.item(0))
        raise ValueError(f"{name}: every value is bad, the first is " + first + f"; {limit}")
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


def scratch_for(places: Mapping[str, Array], inputs: Collection[Array]) -> dict[str, Array]:
    """Buffers for a kernel: the outputs where it can write into them, else new arrays to copy from."""
    return {
        name: _buffer_for(name, place, [*inputs, *(p for n, p in places.items() if n != name)])
        for name, place in places.items()
    }


def _buffer_for(name: str, place: Array, others: Iterable[Array]) -> Array:
    direct = place.flags.c_contiguous and place.flags.aligned and place.dtype == dtype_of(name)
    overlaps = any(np.may_share_memory(place, array) for array in others)
    return place if direct and not overlaps else np.empty(place.shape, dtype_of(name))


def copied_back(places: dict[str, Array], buffers: Mapping[str, Array]) -> dict[str, Array]:
    """The outputs, filled from the buffers."""
    for name, place in places.items():
        if buffers[name] is not place:
            np.copyto(place, buffers[name], casting="same_kind")
    return places


def fill(
    requested: Request,
    scalars: Mapping[str, Any],
    loops: Loops,
    outs: Sequence[Array],
    threads: int | None,
    key: KernelKey | None = None,
    keys: dict[Any, KernelKey] | None = None,
) -> None:
    """Fill contiguous outputs from scalars and the columns along loops.

    key    the kernel, where these points are a block of more that it was chosen for
    keys   the kernels of a request that are remembered
    """
    sizes, columns, axis_of = loops
    outs = [out.reshape(sizes) for out in outs]
    if key is None:
        key = key_of(requested, scalars, columns, axis_of, len(sizes), keys)
    if columns:
        run_in_blocks(key, {**scalars, **columns}, outs, threads)
        return
    point = point_of(key.names, key.form, key.fixed, key.accuracy)
    for out, value in zip(outs, point.run(scalars), strict=True):
        out[...] = value


# ---- loops: a column of designs over a row of angles needs the sine of an angle once, not once a design ----


def loops_over(arrays: Mapping[str, Array], shape: Sequence[int]) -> Loops:
    """The loops for arrays that broadcast to a shape; none of them is a number."""
    size = prod(shape)
    nested = _nested(arrays, shape) if size >= NESTED else None
    if nested is not None:
        return nested
    columns = {
        name: array.reshape(-1) if array.size == size and array.flags.c_contiguous else _column(array, shape)
        for name, array in arrays.items()
    }
    return Loops((size,), columns, dict.fromkeys(columns, 0))


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
    return Loops(sizes, columns, {name: min(own) for name, own in places.items()})


def _varies_along(array: Array, shape: Sequence[int]) -> set[int]:
    """The axes of the shape along which an array has more than one value."""
    lead = len(shape) - array.ndim
    return {lead + axis for axis, size in enumerate(array.shape) if size > 1}


def _inputs(along: Mapping[str, set[int]], axis: int) -> set[str]:
    return {name for name, axes in along.items() if axis in axes}


def _column(array: Array, shape: Sequence[int]) -> Array:
    return np.ascontiguousarray(np.broadcast_to(array, shape)).reshape(-1)
