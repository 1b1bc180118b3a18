"""`grid`: the outer product of its arguments, as a labelled xarray.Dataset."""

from collections.abc import Mapping, Sequence
from functools import partial
from math import prod
from typing import TYPE_CHECKING, Any, NamedTuple, overload

import numpy as np
from numpy.typing import NDArray

from ._arrays import as_array, buffers_for, delivered, dtype_of, fill, places_for
from ._axes import Loops, spread
from ._request import Request, check_border, check_inputs, request, several, standstill
from .inputs import INPUTS
from .names import LENGTHS
from .support.memory import require

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[Any]
ALWAYS = ("status", "margin")
LONG_ENOUGH = 1_000  # points of the innermost loop: a shorter one costs as much to start as to run


@overload
def grid(
    names: str | Sequence[str],
    *,
    branch: int = 1,
    accuracy: str | float = "standard",
    threads: int | None = None,
    out: None = None,
    reduce: Mapping[str, str | Sequence[str]] | None = None,
    chunks: Any = None,
    **inputs: Any,
) -> "xr.Dataset": ...


@overload
def grid(
    names: str | Sequence[str],
    *,
    branch: int = 1,
    accuracy: str | float = "standard",
    threads: int | None = None,
    out: Array | Mapping[str, Array],
    **inputs: Any,
) -> dict[str, Array]: ...


def grid(
    names: str | Sequence[str],
    *,
    branch: int = 1,
    accuracy: str | float = "standard",
    threads: int | None = None,
    out: Any = None,
    reduce: Mapping[str, str | Sequence[str]] | None = None,
    chunks: Any = None,
    **inputs: Any,
) -> "xr.Dataset | dict[str, Array]":
    """Quantities over the outer product of the inputs, as an xarray.Dataset with units.

    The inputs are those of `evaluate`. Each 1-d input is a dimension, in the order given; a number
    becomes a coordinate without one. The Dataset has the names asked for over all dimensions,
    `status` (int8, with CF flags) and `margin` (over the dimensions that it depends on).

    With `out` (an array, or a dict name -> array, of the grid's shape) the arrays are filled and
    returned as a dict, and xarray is not needed. Otherwise needs the extra `labelled`. Raises as
    `evaluate` does, and for an input of more than one dimension.

    `reduce={"theta": "absmax"}` (max, min, absmax, mean, rms, or a list of these) reduces an axis
    without storing the grid: the Dataset has `a_C_absmax` over the other axes, `a_C_absmax_theta`,
    where the largest or smallest sample is, and `a_C_skipped`, how many points along the axis have no
    value. The extremes are those of the samples; `peak` refines them.

    `chunks={"theta": 1000}` (as in xarray: a dict, a number or "auto"; dimensions not named are whole)
    gives lazy Dask arrays, each chunk computed by compiled kernels when it is needed, with the same
    digits whatever the chunks. Needs the extra `scale`.

        dx.grid(["a_C"], theta=th, ec=ecs, AB=.125, BC=bcs, omega0=157.08).a_C.max("theta")
    """
    outer = outer_of(names, inputs, branch, threads, always=out is None)
    if chunks is not None:
        if out is not None:
            raise TypeError("chunks= and out=: give one of them")
        from .evaluation.lazy import lazy_grid

        return lazy_grid(outer, chunks, branch, accuracy, threads, reduce)
    wanted, given, axes, dimensions = outer.names, outer.given, outer.axes, outer.dimensions
    if reduce is not None:
        if out is not None:
            raise TypeError("reduce= and out=: give one of them")
        from ._reduce import reduced_grid

        asked = request(wanted, given, branch, accuracy)
        require_inputs(asked, axes)
        whole = partial(_filled, asked, axes, dimensions, threads, None)
        return reduced_grid(asked, axes, dimensions, reduce, branch, threads, whole)
    if out is not None:
        return _filled(request(wanted, given, branch, accuracy), axes, dimensions, threads, out)
    from ._labels import labelled

    arrays: dict[str, tuple[Sequence[str], Array]] = {}
    for some, along in outer.groups():
        found = _filled(request(some, given, branch, accuracy), axes, along, threads, None)
        arrays.update({name: (along, array) for name, array in found.items()})
    state = given.get("omega") is not None
    return labelled({n: arrays[n] for n in outer.shown}, outer.coordinates, branch, state, accuracy)


class Outer(NamedTuple):
    """The arguments of a grid, checked.

    `given` are the inputs as they came, with defaults; `axes` their arrays; `coordinates` those of them
    that were not a default.
    """

    names: tuple[str, ...]
    given: dict[str, Any]
    axes: dict[str, Array]
    coordinates: dict[str, Array]

    @property
    def dimensions(self) -> list[str]:
        """The inputs with one axis, in their order."""
        return [name for name, array in self.coordinates.items() if array.ndim]

    @property
    def shown(self) -> tuple[str, ...]:
        """The names of the variables of a labelled grid."""
        return tuple(dict.fromkeys((*self.names, *ALWAYS)))

    def groups(self) -> list[tuple[list[str], list[str]]]:
        """The names that have all dimensions, and those that have the lengths' alone, with them."""
        lengths = [name for name in self.dimensions if name in LENGTHS]
        return [([n for n in self.shown if n != "margin"], self.dimensions), (["margin"], lengths)]


def outer_of(
    names: str | Sequence[str], inputs: Mapping[str, Any], branch: int, threads: int | None, always: bool
) -> Outer:
    """Check the arguments of a grid; `always`: it has `status` and `margin` too."""
    wanted = (names,) if isinstance(names, str) else several(names)
    given = _given(wanted, inputs)
    check_border(given, branch, threads)
    shown = tuple(dict.fromkeys((*wanted, *ALWAYS))) if always else wanted
    axes = {name: _axis(name, value, shown) for name, value in given.items() if value is not None}
    coordinates = {name: axes[name] for name in inputs if name in axes}
    return Outer(wanted, given, axes, coordinates)


def _given(names: Sequence[str], inputs: Mapping[str, Any]) -> dict[str, Any]:
    """The inputs with their defaults; a TypeError for one that there is not."""
    check_inputs("grid", inputs, (*INPUTS, "branch", "accuracy", "threads", "out", "reduce", "chunks"))
    given = dict(inputs)
    if given.get("omega0") is None and given.get("omega") is None:
        given["omega0"] = standstill(names, given)
    return given


def _axis(name: str, value: Any, names: Sequence[str]) -> Array:
    array = as_array(name, value, (), names)
    if array.ndim > 1:
        raise ValueError(f"{name}: a grid takes numbers and 1-d arrays, got the shape {array.shape}")
    return array


def _filled(
    wanted: Request, axes: Mapping[str, Array], dimensions: Sequence[str], threads: int | None, out: Any
) -> dict[str, Array]:
    """The answers over these dimensions, from one loop nest in their order."""
    require_inputs(wanted, axes)
    inputs = wanted.inputs
    shape = tuple(axes[name].size for name in dimensions)
    if out is None:
        size = sum(dtype_of(name).itemsize for name in wanted.shown) * prod(shape)
        points = " x ".join(map(str, shape))
        require(size, f"a grid of {points} points and {len(wanted.shown)} names")
    places = places_for(wanted.shown, shape, out)
    buffers = places if out is None else buffers_for(places, axes.values())
    if all(shape):
        # At least one axis, so that a grid of numbers alone goes the same way.
        order = list(dimensions) or [""]
        scalars = {name: float(axes[name].reshape(-1)[0]) for name in inputs if name not in order}
        columns = {name: np.ascontiguousarray(axes[name]) for name in inputs if name in order}
        places_of = {name: order.index(name) for name in columns}
        sizes = join_axes(order, columns, places_of, shape or (1,))
        fill(wanted, scalars, Loops(sizes, columns, places_of), list(buffers.values()), threads)
    return delivered(places, buffers, False)


def join_axes(
    order: Sequence[str], columns: dict[str, Array], axis_of: dict[str, int], shape: tuple[int, ...]
) -> tuple[int, ...]:
    """Join the last axes to one that is long enough to vectorise; the lengths of the axes then.

    Effect: `columns` along the joined axes have a value for each point of them, and `axis_of` follows.
    """
    return join_from(first_joined(order, shape), columns, axis_of, shape)


def first_joined(order: Sequence[str], shape: Sequence[int]) -> int:
    """The first of the last axes that are joined to one, long enough to vectorise.

    The crank angle is never joined: its sine and cosine must not be computed again for every design.
    """
    first = len(order) - 1
    if order[first] != "theta":
        while first > 0 and prod(shape[first:]) < LONG_ENOUGH and order[first - 1] != "theta":
            first -= 1
    return first


def join_from(
    first: int, columns: dict[str, Array], axis_of: dict[str, int], shape: tuple[int, ...]
) -> tuple[int, ...]:
    """Join the axes from `first` on, as `join_axes` does."""
    rest = shape[first:]
    for name, axis in axis_of.items() if len(rest) > 1 else ():
        if axis >= first:
            columns[name] = np.ascontiguousarray(spread(columns[name], axis - first, rest))
            axis_of[name] = first
    return (*shape[:first], prod(rest))


def require_inputs(wanted: Request, axes: Mapping[str, Array]) -> None:
    missing = [name for name in wanted.inputs if name not in axes]
    if missing:
        needed = ", ".join(wanted.inputs)
        raise TypeError(f"{', '.join(wanted.shown)}: {missing[0]} is missing (needed: {needed})")
