"""The kernel that a written module of a scene runs over its grid."""

from collections.abc import Iterable, Mapping, Sequence
from math import prod
from typing import Any, NamedTuple

import numpy as np

from ...loads.load import Load, OverY
from ...loads.resolve import plan_of, split
from ...mechanism.catalogue import of_design
from ...mechanism.names import LENGTHS, STATUS
from ...runtime.kernels import KernelKey, key_of
from ...runtime.request import Request, request
from ..content import Content


def own_axes(content: Content, names: Iterable[str]) -> dict[str, list[str]]:
    """The axes of each quantity of a whole design: lengths, and a speed whose sign it uses."""
    axes = [name for name, value in content.inputs.items() if isinstance(value, tuple)]
    found = {}
    for name in names:
        if of_design(name):
            used = {
                *LENGTHS,
                *request((name,), dict(content.inputs), content.branch, content.accuracy).inputs,
            }
            found[name] = [axis for axis in axes if axis in used]
    return found


class GridKernel(NamedTuple):
    """The kernel of a scene's grid: its request, its axes in loop order, its key."""

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
        names = list(dict.fromkeys([*names, STATUS]))
        if [name for name in names if not of_design(name)] == [STATUS] and "theta" not in content.inputs:
            own = {axis for axes in own_axes(content, names).values() for axis in axes}
            dimensions = [name for name in dimensions if name in own]
    fused = content.fused
    if fused is not None:
        dimensions = [*(name for name in dimensions if name != fused.axis), fused.axis]
    given, loads = split(content.inputs)
    if "omega0" not in given and "omega" not in given:
        given["omega0"] = 0.0  # no requested name needs a speed
    if loads:
        return _under_loads(content, given, loads, names, dimensions)
    asked = request(names, given, content.branch, content.accuracy)
    order = dimensions or [""]
    if fused is not None and len(order) == 1:
        order = ["", *order]
    needed = [name for name in asked.inputs if name not in dimensions]
    scalars = {name: float(np.asarray(given.get(name, 0.0)).reshape(-1)[0]) for name in needed}
    columns = {name: np.array(given[name]) for name in asked.inputs if name in dimensions}
    places = {name: order.index(name) for name in columns}
    sizes = tuple(np.size(given[name]) if name else 1 for name in order)
    key = key_of(asked, scalars, columns, places, len(order))
    if fused is not None:
        key = key._replace(reduce=fused.kinds)
    return GridKernel(asked, tuple(order), sizes, key)


def _under_loads(
    content: Content,
    given: Mapping[str, Any],
    loads: Mapping[str, Load],
    names: Sequence[str],
    dimensions: Sequence[str],
) -> GridKernel:
    """The kernel under loads that vary with the motion: inputs along theta or, over Y, along all axes.

    The kernel computes the slopes by the loads too, which total derivatives need.
    """
    plan = plan_of(names, loads, "omega" in given, "mu" in given)
    asked = request(
        (*plan.names, *(n for n in plan.motion if n not in plan.names)),
        {**given, **dict.fromkeys(loads, 1.0)},
        content.branch,
        content.accuracy,
    )
    flat = any(isinstance(load, OverY) for load in plan.loads.values())
    order = [" x ".join(dimensions)] if flat else list(dimensions) or [""]
    lengths = [np.size(given[name]) for name in dimensions] or [1]
    varying = {n: np.array(given[n]) for n in asked.inputs if n in dimensions}
    along = {n: 0 if flat else order.index(n) for n in varying}
    if flat or "theta" in along:  # the values of a load are not needed here, but where it varies
        varying |= {name: np.atleast_1d(given.get("theta", 0.0)) for name in plan.loads}
        along |= dict.fromkeys(plan.loads, 0 if flat else along["theta"])
    scalars = {n: float(np.asarray(given.get(n, 1.0))) for n in asked.inputs if n not in varying}
    key = key_of(asked, scalars, varying, along, len(order))
    return GridKernel(asked, tuple(order), (prod(lengths),) if flat else tuple(lengths), key)
