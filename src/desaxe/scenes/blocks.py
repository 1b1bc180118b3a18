"""The grid of a scene, in blocks that tell how far it is."""

from collections.abc import Mapping
from itertools import pairwise
from math import prod
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from ..evaluation.grid import grid
from ..evaluation.labels import import_xarray, with_loads
from ..loads.load import Load
from ..support.forks import IMPORTS
from ..support.progress import Steps
from .content import Content
from .peaks import provenance
from .values import Value

if TYPE_CHECKING:
    import xarray as xr

BLOCK = 5_000_000  # points of the grid between two reports of progress


def blocks_of(content: Content) -> list[tuple[int, int]]:
    """Blocks of the first axis, so that a large grid can report its progress."""
    lengths = [len(value) for value in content.inputs.values() if isinstance(value, tuple)]
    first = lengths[0] if lengths and content.reduction is None else 1
    count = max(1, min(first, prod(lengths) // BLOCK))
    return list(pairwise(first * k // count for k in range(count + 1)))


def values_of_grid(content: Content, blocks: list[tuple[int, int]], steps: Steps) -> "xr.Dataset":
    """The requested outputs over the outer product of all inputs."""
    options = grid_options(content)
    arrays = arrays_of(content.inputs)
    if content.reduction is not None:
        steps.next("values")
        reduced: Any = grid(content.outputs, reduce=content.reduction, **options, **arrays)
        return cast("xr.Dataset", reduced.assign_attrs(provenance(content)))
    first = next((name for name, value in arrays.items() if isinstance(value, np.ndarray)), "")
    whole: Any = None
    for start, stop in blocks:
        steps.next("values")
        if len(blocks) == 1:
            whole = grid(content.outputs, **options, **arrays)
            break
        part: Any = grid(content.outputs, **options, **{**arrays, first: arrays[first][start:stop]})
        whole = _longer(part, first, arrays[first]) if whole is None else whole
        for name, values in part.data_vars.items():
            whole[name].values[slice(start, stop) if first in values.dims else ...] = values.values
    if len(blocks) > 1:
        loads = {name: value for name, value in content.inputs.items() if isinstance(value, Load)}
        whole = with_loads(whole, loads)
    labelled: xr.Dataset = whole.assign_attrs(provenance(content))
    return labelled


def _longer(part: "xr.Dataset", first: str, values: NDArray[np.float64]) -> "xr.Dataset":
    """An empty dataset like a block of it, with all values along its first axis."""
    import_xarray()
    with IMPORTS:
        import xarray

    sizes = {**part.sizes, first: values.size}
    empty = {
        name: (array.dims, np.empty([sizes[d] for d in array.dims], array.dtype), array.attrs)
        for name, array in part.data_vars.items()
    }
    others = {name: array for name, array in part.coords.items() if first not in array.dims}
    coordinates = {**others, first: (first, values, part[first].attrs)}
    return xarray.Dataset(empty, coordinates, part.attrs)


def grid_options(content: Content) -> dict[str, Any]:
    """The options of this scene's grid."""
    return {"branch": content.branch, "accuracy": content.accuracy, "threads": content.threads}


def arrays_of(inputs: Mapping[str, Value]) -> dict[str, Any]:
    """The inputs as `grid` takes them."""
    return {name: np.array(value) if isinstance(value, tuple) else value for name, value in inputs.items()}
