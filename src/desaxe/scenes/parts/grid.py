"""The grid of a scene: its plan, and the plan run in blocks that tell how far it is."""

from collections.abc import Mapping
from math import prod
from typing import TYPE_CHECKING, Any

import numpy as np

from ...evaluation.axes import outer_of
from ...evaluation.plan import Plan, plan_of
from ...support.progress import Steps
from ..reading.values import Value
from ..setting import Setting

if TYPE_CHECKING:
    import xarray as xr

BLOCK = 5_000_000  # points of the grid between two reports of progress


def plan_of_grid(setting: Setting) -> Plan:
    """The plan of the outputs over the outer product of all inputs."""
    outer = outer_of(setting.outputs, arrays_of(setting.inputs), setting.branch, setting.threads, always=True)
    return plan_of(outer, setting.branch, setting.accuracy, setting.reduction)


def blocks_of(setting: Setting) -> tuple[int, int]:
    """The number of blocks along the first axis, and their length: a large grid reports its progress."""
    sizes = [len(value) for value in setting.inputs.values() if isinstance(value, tuple)]
    first = sizes[0] if sizes and setting.reduction is None else 1
    length = -(-first // max(1, min(first, prod(sizes) // BLOCK)))
    return -(-first // length), length


def values_of_grid(setting: Setting, steps: Steps) -> "xr.Dataset":
    """The requested outputs over the outer product of all inputs, labelled."""
    plan = plan_of_grid(setting)
    if setting.reduction is not None:
        steps.next("values")
        arrays = plan.values(setting.threads)
    else:
        first = dict.fromkeys(list(plan.sizes)[:1], blocks_of(setting)[1])
        lengths = {name: max(1, size) for name, size in (plan.sizes | first).items()}
        arrays = plan.values_by_blocks(setting.threads, lengths, lambda: steps.next("values"))
    return plan.dataset(arrays).assign_attrs(setting.provenance)


def arrays_of(inputs: Mapping[str, Value]) -> dict[str, Any]:
    """The inputs as `grid` takes them."""
    return {name: np.array(value) if isinstance(value, tuple) else value for name, value in inputs.items()}
