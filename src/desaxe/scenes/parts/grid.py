"""The grid of a scene: its plan, and the plan run in blocks that tell how far it is."""

from collections.abc import Mapping
from math import prod
from typing import TYPE_CHECKING, Any

import numpy as np

from ...evaluation.axes import outer_of
from ...evaluation.plan import Plan, plan_of
from ...support.progress import Steps
from ..content import Content
from ..reading.values import Value
from .extremes import provenance

if TYPE_CHECKING:
    import xarray as xr

BLOCK = 5_000_000  # points of the grid between two reports of progress


def plan_of_grid(content: Content) -> Plan:
    """The plan of the outputs over the outer product of all inputs."""
    outer = outer_of(content.outputs, arrays_of(content.inputs), content.branch, content.threads, always=True)
    return plan_of(outer, content.branch, content.accuracy, content.reduction)


def blocks_of(content: Content) -> tuple[int, int]:
    """The number of blocks along the first axis, and their length: a large grid reports its progress."""
    sizes = [len(value) for value in content.inputs.values() if isinstance(value, tuple)]
    first = sizes[0] if sizes and content.reduction is None else 1
    length = -(-first // max(1, min(first, prod(sizes) // BLOCK)))
    return -(-first // length), length


def values_of_grid(content: Content, steps: Steps) -> "xr.Dataset":
    """The requested outputs over the outer product of all inputs, labelled."""
    plan = plan_of_grid(content)
    if content.reduction is not None:
        steps.next("values")
        arrays = plan.values(content.threads)
    else:
        first = dict.fromkeys(list(plan.sizes)[:1], blocks_of(content)[1])
        arrays = plan.values(content.threads, {**plan.sizes, **first}, lambda: steps.next("values"))
    return plan.dataset(arrays).assign_attrs(provenance(content))


def arrays_of(inputs: Mapping[str, Value]) -> dict[str, Any]:
    """The inputs as `grid` takes them."""
    return {name: np.array(value) if isinstance(value, tuple) else value for name, value in inputs.items()}
