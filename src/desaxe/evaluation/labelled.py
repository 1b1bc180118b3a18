"""Labelled arrays: DataArrays broadcast by their dimensions, Series by the names of their indices."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from .arrays import as_array
from .labels import attributes, import_xarray


def is_labelled(value: Any) -> bool:
    """True for an xarray.DataArray that has dimensions."""
    return bool(getattr(value, "dims", ())) and hasattr(value, "coords")


def evaluate_labelled(
    run: Callable[[dict[str, Any]], dict[str, Any]], names: Sequence[str], inputs: Mapping[str, Any]
) -> dict[str, Any]:
    """The values by name as DataArrays, with the coordinates of the inputs and units.

    `run` evaluates plain arrays, which broadcast by position. ValueError for labels that differ along a
    dimension, and for an array without labels beside others of several dimensions.
    """
    xarray = import_xarray("labelled arrays")
    labelled = {name: value for name, value in inputs.items() if is_labelled(value)}
    _refuse_unlabelled(inputs, labelled)
    arrays = [value.copy(data=as_array(name, value, (), names)) for name, value in labelled.items()]

    def plain(*result: Any) -> Any:
        answer = run({**inputs, **dict(zip(labelled, result, strict=True))})
        shape = np.broadcast_shapes(*(array.shape for array in result))
        whole = [answer[n] if answer[n].shape == shape else np.broadcast_to(answer[n], shape) for n in names]
        return tuple(whole) if len(whole) > 1 else whole[0]

    outputs = xarray.apply_ufunc(plain, *arrays, join="exact", output_core_dims=[()] * len(names))
    state = inputs.get("omega") is not None
    result = dict(zip(names, outputs if len(names) > 1 else (outputs,), strict=True))
    return {n: array.rename(n).assign_attrs(attributes(n, state)) for n, array in result.items()}


def _refuse_unlabelled(inputs: Mapping[str, Any], labelled: Mapping[str, Any]) -> None:
    dimensions = {value.dims for value in labelled.values()}
    for name, value in inputs.items():
        if len(dimensions) > 1 and name not in labelled and np.size(value) > 1:
            message = ", ".join(f"{other} {array.dims}" for other, array in labelled.items())
            raise ValueError(
                f"{name}: an array without labels beside labelled ones of different dimensions, {message}: "
                "make it an xarray.DataArray too, or pass the .values of all"
            )
