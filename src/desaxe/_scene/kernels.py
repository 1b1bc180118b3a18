"""The kernel that a scene's grid runs: for `explain` and `compile`, which run nothing."""

from math import prod
from typing import NamedTuple

import numpy as np

from .._kernels import KernelKey, key_of
from .._request import Request, request
from .read import Content


class GridKernel(NamedTuple):
    """What the grid of a scene asks for, its axes in the order of the kernel's loops, and the key."""

    request: Request
    axes: tuple[str, ...]
    sizes: tuple[int, ...]
    key: KernelKey

    @property
    def points(self) -> int:
        """Points of the grid."""
        return prod(self.sizes)


def grid_kernel(content: Content) -> GridKernel:
    """The kernel of the outputs (and, where they are stored, of the status)."""
    dimensions = [name for name, value in content.inputs.items() if isinstance(value, tuple)]
    names = list(content.outputs)
    if content.reduction is None:
        names = list(dict.fromkeys([*(name for name in names if name != "margin"), "status"]))
    else:
        dimensions = [
            *(name for name in dimensions if name != content.reduction.axis),
            content.reduction.axis,
        ]
    given = dict(content.inputs)
    if "omega0" not in given and "omega" not in given:
        given["omega0"] = 0.0  # nothing that is asked for needs a speed
    asked = request(names, given, content.branch, content.accuracy)
    order = dimensions or [""]
    if content.reduction is not None and len(order) == 1:
        order = ["", *order]
    needed = [name for name in asked.inputs if name not in dimensions]
    scalars = {name: float(np.asarray(given.get(name, 0.0)).reshape(-1)[0]) for name in needed}
    columns = {name: np.array(given[name]) for name in asked.inputs if name in dimensions}
    places = {name: order.index(name) for name in columns}
    key = key_of(asked, scalars, columns, places, len(order))
    if content.reduction is not None:
        key = key._replace(reduce=content.reduction.kinds)
    sizes = [np.size(given[name]) if name else 1 for name in order]
    return GridKernel(asked, tuple(order), tuple(sizes), key)
