"""`grid`: the outer product of its arguments, as a labelled xarray.Dataset."""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, Unpack, overload

import numpy as np
from numpy.typing import NDArray

from ..loads.resolve import without_loads
from ..mechanism.inputs import Inputs
from ..runtime.request import Request, request, with_named_inputs
from .arrays import copied_back, fill, outputs_for, scratch_for
from .loaded import filled_under_loads
from .loops import Loops
from .outer import join_axes, outer_of, require_inputs

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[Any]


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
    **inputs: Unpack[Inputs],
) -> "xr.Dataset": ...


@overload
def grid(
    names: str | Sequence[str],
    *,
    branch: int = 1,
    accuracy: str | float = "standard",
    threads: int | None = None,
    out: Array | Mapping[str, Array],
    **inputs: Unpack[Inputs],
) -> dict[str, Array]: ...


@with_named_inputs
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
    becomes a coordinate without one, and a load that varies with the motion follows theta: `over_theta`,
    `over_Y`, a function of theta, or a labelled array over the dimension theta. The Dataset has the names
    asked for over all dimensions, `status` (int8, with CF flags) and `margin`, over those that it depends on.

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
        without_loads("grid with chunks=", outer.loads)
        if out is not None:
            raise TypeError("chunks= and out=: give one of them")
        from .lazy import lazy_grid

        return lazy_grid(outer, chunks, branch, accuracy, threads, reduce)
    wanted, axes, dimensions = outer.names, outer.axes, outer.dimensions
    given = {
        **outer.given,
        **dict.fromkeys(outer.loads, 0.0),
    }  # what a request asks of a load is not its value
    everything: dict[str, Any] = {**axes, **outer.loads}

    def filled(some: Sequence[str], along: Sequence[str], out: Any = None) -> dict[str, Array]:
        if outer.loads:
            return filled_under_loads(some, everything, along, (branch, accuracy, threads), out)
        return _filled(request(some, given, branch, accuracy), axes, along, threads, out)

    if reduce is not None:
        if out is not None:
            raise TypeError("reduce= and out=: give one of them")
        from .reduce import reduced_grid

        asked = request(wanted, given, branch, accuracy)
        require_inputs(asked, everything)
        whole = partial(filled, wanted, dimensions)
        return reduced_grid(asked, axes, dimensions, reduce, branch, threads, whole, bool(outer.loads))
    if out is not None:
        return filled(wanted, dimensions, out)
    from .labels import labelled, with_loads

    arrays: dict[str, tuple[Sequence[str], Array]] = {}
    for some, along in outer.groups():
        arrays.update({name: (along, array) for name, array in filled(some, along).items()})
    state = given.get("omega") is not None
    dataset = labelled({n: arrays[n] for n in outer.shown}, outer.coordinates, branch, state, accuracy)
    return with_loads(dataset, outer.loads)


def _filled(
    wanted: Request, axes: Mapping[str, Array], dimensions: Sequence[str], threads: int | None, out: Any
) -> dict[str, Array]:
    """The values over these dimensions, from one loop nest in their order."""
    require_inputs(wanted, axes)
    inputs = wanted.inputs
    shape = tuple(axes[name].size for name in dimensions)
    places = outputs_for(wanted.shown, shape, out)
    buffers = places if out is None else scratch_for(places, axes.values())
    if all(shape):
        # At least one axis, so that a grid of numbers alone goes the same way.
        order = list(dimensions) or [""]
        scalars = {name: float(axes[name].reshape(-1)[0]) for name in inputs if name not in order}
        columns = {name: np.ascontiguousarray(axes[name]) for name in inputs if name in order}
        places_of = {name: order.index(name) for name in columns}
        sizes = join_axes(order, columns, places_of, shape or (1,))
        fill(wanted, scalars, Loops(sizes, columns, places_of), list(buffers.values()), threads)
    return copied_back(places, buffers, False)
