"""`grid`: the outer product of its arguments, as a labelled xarray.Dataset."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ._arrays import as_array, delivered, dtype_of, places_for
from ._kernels import kernel_for, key_of
from ._program import program_of
from ._request import Request, check_border, request
from ._threads import run_in_blocks
from .catalogue import quantity
from .extras import needed
from .inputs import INPUTS

if TYPE_CHECKING:
    import xarray as xr

STATUS_FLAGS = ("ok", "cannot_be_assembled", "change_point", "stalled", "bad_input")
ALWAYS = ("status", "margin")


def grid(
    names: str | Sequence[str],
    *,
    branch: int = 1,
    accuracy: str = "standard",
    threads: int | None = None,
    out: Any = None,
    **inputs: Any,
) -> "xr.Dataset | dict[str, NDArray[Any]]":
    """Quantities over the outer product of the inputs, as an xarray.Dataset with units.

    The inputs are those of `evaluate`. Each 1-d input is a dimension, in the order given; a number
    becomes a coordinate without one. The Dataset has the names asked for over all dimensions,
    `status` (int8, with CF flags) and `margin` (over the dimensions that it depends on).

    With `out` (an array, or a dict name -> array, of the grid's shape) the arrays are filled and
    returned as a dict, and xarray is not needed. Otherwise needs the extra `labelled`. Raises as
    `evaluate` does, and for an input of more than one dimension.

        dx.grid(["a_C"], theta=th, ec=ecs, AB=.125, BC=bcs, omega0=157.08).a_C.max("theta")
    """
    wanted = (names,) if isinstance(names, str) else tuple(dict.fromkeys(names))
    unknown = [name for name in inputs if name not in INPUTS]
    if unknown:
        raise TypeError(f"grid() has no input {unknown[0]!r}: {', '.join(INPUTS)}")
    given = {"alpha": 0.0, **inputs}
    check_border(given, branch, threads)
    if given.get("omega0") is None and given.get("omega") is None:
        given["omega0"] = _standstill(wanted, branch, accuracy)
    shown = wanted if out is not None else (*wanted, *(name for name in ALWAYS if name not in wanted))
    axes = {name: as_array(name, value, (), shown) for name, value in given.items() if value is not None}
    for name, array in axes.items():
        if array.ndim > 1:
            raise ValueError(f"{name}: a grid takes numbers and 1-d arrays, got the shape {array.shape}")
    dimensions = [name for name in inputs if name in axes and axes[name].ndim == 1]
    if out is not None:
        return _filled(request(wanted, given, branch, accuracy), axes, dimensions, threads, out)
    with needed("grid (without out=)"):
        import xarray
    wide = request([name for name in shown if name != "margin"], given, branch, accuracy)
    arrays: dict[str, Any] = _filled(wide, axes, dimensions, threads, None)
    variables = {name: (dimensions, array) for name, array in arrays.items()}
    if "margin" in shown:
        own = [name for name in dimensions if name in ("ec", "AB", "BC")]
        margin = _filled(request(["margin"], given, branch, accuracy), axes, own, threads, None)
        variables["margin"] = (own, margin["margin"])
    state = given.get("omega") is not None
    data = {name: (dims, array, attributes(name, state)) for name, (dims, array) in variables.items()}
    coordinates = {
        name: (dimensions_of(name, axes[name]), axes[name], input_attributes(name))
        for name in inputs
        if name in axes
    }
    return xarray.Dataset(
        {name: data[name] for name in shown}, coordinates, {"title": "offset slider-crank", "branch": branch}
    )


def _standstill(names: Sequence[str], branch: int, accuracy: str) -> float | None:
    """A speed of 0 where no wanted name needs one, so that `status` can be told all the same."""
    asked = request(names, {}, branch, accuracy)
    return None if "omega0" in program_of(asked.names, False).inputs else 0.0


def dimensions_of(name: str, array: NDArray[Any]) -> tuple[str, ...]:
    """The dimension of an input's coordinate."""
    return (name,) if array.ndim else ()


def _filled(
    wanted: Request,
    axes: Mapping[str, NDArray[Any]],
    dimensions: Sequence[str],
    threads: int | None,
    out: Any,
) -> dict[str, NDArray[Any]]:
    """The answers over these dimensions, from one loop nest in their order."""
    shape = tuple(axes[name].size for name in dimensions)
    places = places_for(wanted.shown, shape, out)
    buffers = {n: p if _direct(n, p) else np.empty(shape, dtype_of(n)) for n, p in places.items()}
    inputs = [name for name in program_of(wanted.names, wanted.state).inputs if name != "branch"]
    missing = [name for name in inputs if name not in axes]
    if missing:
        raise TypeError(f"{', '.join(wanted.shown)}: {missing[0]} is missing (needed: {', '.join(inputs)})")
    if all(shape):
        # At least one axis, so that a grid of numbers alone goes the same way.
        order = list(dimensions) or [""]
        scalars = {name: float(axes[name].reshape(-1)[0]) for name in inputs if name not in order}
        columns = {name: np.ascontiguousarray(axes[name]) for name in inputs if name in order}
        key = key_of(wanted, scalars, columns, {name: order.index(name) for name in columns}, len(order))
        outs = [buffer if dimensions else buffer.reshape(1) for buffer in buffers.values()]
        run_in_blocks(kernel_for(key), {**scalars, **columns}, outs, threads)
    return delivered(places, buffers, False)


def _direct(name: str, place: NDArray[Any]) -> bool:
    return bool(place.flags.c_contiguous and place.dtype == dtype_of(name))


def attributes(name: str, state: bool = False) -> dict[str, Any]:
    """CF attributes of a quantity."""
    if name == "status":
        flags = np.arange(len(STATUS_FLAGS), dtype=np.int8)
        return {"long_name": "status", "flag_values": flags, "flag_meanings": " ".join(STATUS_FLAGS)}
    known = quantity(name, state)
    found = {"units": known.unit, "long_name": known.meaning}
    if known.source:
        found["references"] = known.source
    return found


def input_attributes(name: str) -> dict[str, str]:
    """CF attributes of an input."""
    return {"units": INPUTS[name].unit, "long_name": INPUTS[name].meaning}
