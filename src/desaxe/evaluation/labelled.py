"""Labelled arrays: DataArrays broadcast by their dimensions, Series by the names of their indices."""

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..mechanism.inputs import INPUTS
from ..mechanism.names import LENGTHS
from ..support.extras import needed
from .arrays import as_array
from .labels import attributes, input_attributes, provenance

if TYPE_CHECKING:
    import xarray as xr


def is_labelled(value: Any) -> bool:
    """True for an xarray.DataArray that has dimensions."""
    return bool(getattr(value, "dims", ())) and hasattr(value, "coords")


def evaluate_labelled(
    run: Callable[[dict[str, Any]], dict[str, Any]], names: Sequence[str], given: Mapping[str, Any]
) -> dict[str, Any]:
    """The values by name as DataArrays, with the coordinates of the inputs and units.

    `run` evaluates plain arrays, which broadcast by position. ValueError for labels that differ along a
    dimension, and for an array without labels beside others of several dimensions.
    """
    with needed("labelled arrays"):
        import xarray
    labelled = {name: value for name, value in given.items() if is_labelled(value)}
    _refuse_unlabelled(given, labelled)
    arrays = [value.copy(data=as_array(name, value, (), names)) for name, value in labelled.items()]

    def plain(*found: Any) -> Any:
        answer = run({**given, **dict(zip(labelled, found, strict=True))})
        shape = np.broadcast_shapes(*(array.shape for array in found))
        whole = [answer[n] if answer[n].shape == shape else np.broadcast_to(answer[n], shape) for n in names]
        return tuple(whole) if len(whole) > 1 else whole[0]

    outputs = xarray.apply_ufunc(plain, *arrays, join="exact", output_core_dims=[()] * len(names))
    state = given.get("omega") is not None
    found = dict(zip(names, outputs if len(names) > 1 else (outputs,), strict=True))
    return {n: array.rename(n).assign_attrs(attributes(n, state)) for n, array in found.items()}


def _refuse_unlabelled(given: Mapping[str, Any], labelled: Mapping[str, Any]) -> None:
    dimensions = {value.dims for value in labelled.values()}
    for name, value in given.items():
        if len(dimensions) > 1 and name not in labelled and np.size(value) > 1:
            told = ", ".join(f"{other} {array.dims}" for other, array in labelled.items())
            raise ValueError(
                f"{name}: an array without labels beside labelled ones of different dimensions, {told}: "
                "make it an xarray.DataArray too, or pass the .values of all"
            )


def has_named_index(value: Any) -> bool:
    """True for a pandas Series whose index has a name."""
    return hasattr(value, "iloc") and isinstance(getattr(value.index, "name", None), str)


def grid_by_index(
    evaluate: Callable[..., dict[str, Any]],
    names: Sequence[str],
    inputs: Mapping[str, Any],
    branch: int,
    accuracy: str | float,
) -> "xr.Dataset":
    """A grid of which Series are inputs: those that share the name of an index vary together along it.

    Each index is a dimension with its labels, and the inputs along it are coordinates; other arrays are
    dimensions of their own. `evaluate` takes names and inputs.
    """
    with needed("labelled arrays"):
        import xarray
    present = {name: value for name, value in inputs.items() if value is not None}
    arrays = {name: _array(name, value, names) for name, value in present.items() if not callable(value)}
    given = {**present, **{name: array for name, array in arrays.items() if array.ndim}}
    lengths = {name: given.get(name) for name in (*LENGTHS, "omega0", "omega")}
    given = {**dict.fromkeys(("theta", *lengths)), "alpha": 0.0, **given}
    found = evaluate(list(names), given) | evaluate(["status"], given) | evaluate(["margin"], lengths)
    told = {name: array.assign_attrs(input_attributes(name)) for name, array in arrays.items()}
    about = provenance(names, {name: array.values for name, array in arrays.items()}, branch, accuracy)
    return xarray.Dataset(found, attrs=about).assign_coords(told)


def _array(name: str, value: Any, names: Sequence[str]) -> "xr.DataArray":
    """A number without dimensions, or an array along its own name or that of its index."""
    with needed("labelled arrays"):
        import xarray
    values = as_array(name, value, tuple(INPUTS), names)
    if values.ndim > 1:
        raise ValueError(f"{name}: a grid takes numbers and 1-d arrays, got the shape {values.shape}")
    if not values.ndim:
        return xarray.DataArray(values)
    index = value.index if has_named_index(value) else None
    along = name if index is None else index.name
    return xarray.DataArray(values, dims=along, coords={along: values if index is None else index})
