"""The values of a grid over some of its dimensions, from one loop nest in their order."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..runtime.request import Request
from .arrays import copied_back, fill, outputs_for, scratch_for
from .loops import Loops
from .outer import join_axes, require_inputs

Array = NDArray[Any]


def filled_grid(
    wanted: Request, axes: Mapping[str, Array], dimensions: Sequence[str], threads: int | None, out: Any
) -> dict[str, Array]:
    """The answers over these dimensions, in `out` where that is given."""
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
