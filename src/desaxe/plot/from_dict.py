"""A dict of arrays from `evaluate` as a Dataset to plot."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ..evaluation.labels import attributes, labelled, with_loads
from ..loads.resolve import split
from ..mechanism.inputs import INPUTS
from ..mechanism.read import read_array
from .from_motion import dataset_of_motion, is_motion

if TYPE_CHECKING:
    import xarray as xr


def as_dataset(found: Any, over: str, inputs: Mapping[str, Any]) -> "xr.Dataset":
    """The Dataset of a dict of arrays; a Dataset is returned unchanged.

    A motion has its histories, over t or over theta.

    `inputs` are those that the arrays were computed with, beside or instead of those that an answer of
    `evaluate` remembers. Each varies along one axis of the arrays. Raises TypeError where the one `over`
    which a curve is drawn is missing, ValueError where an input does not fit.
    """
    if hasattr(found, "data_vars"):
        if inputs:
            raise TypeError(f"a Dataset has its inputs: leave {', '.join(inputs)} out")
        dataset: xr.Dataset = found
        return dataset
    if is_motion(found):
        return dataset_of_motion(found, over)
    given, loads = split({**getattr(found, "inputs", {}), **inputs})
    shape = np.broadcast_shapes(*(np.shape(array) for array in found.values()))
    arrays = {name: _numbers(name, value) for name, value in given.items() if value is not None}
    if over not in arrays:
        raise TypeError(f"a dict does not say {over}: give it, as in curves(found, name, {over}={over})")
    dims: dict[int, str] = {}
    coordinates: dict[str, Any] = {}
    for name, array in sorted(arrays.items(), key=lambda item: item[0] != over):
        axes = [len(shape) - array.ndim + k for k, size in enumerate(array.shape) if size > 1]
        if len(axes) > 1 or (axes and array.size != shape[axes[0]]):
            raise ValueError(
                f"{name}: it varies along one axis of arrays of the shape {shape}, got {array.shape}"
            )
        if not axes:
            coordinates[name] = array.reshape(-1)[0]
        elif axes[0] not in dims:
            dims[axes[0]] = name
            coordinates[name] = array.reshape(-1)
    named = [dims.get(axis, f"axis_{axis}") for axis in range(len(shape))]
    values = {
        name: (named, np.broadcast_to(np.asarray(array), shape), attributes(name, "omega" in arrays))
        for name, array in found.items()
    }
    known = {name: np.asarray(value) for name, value in coordinates.items()}
    return with_loads(labelled(values, known, int(given.get("branch", 1))), loads)


def _numbers(name: str, value: Any) -> Any:
    if name not in INPUTS:
        raise TypeError(f"no input {name!r}; there are {', '.join(INPUTS)}")
    return read_array(INPUTS[name], value)
