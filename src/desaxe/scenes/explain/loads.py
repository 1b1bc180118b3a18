"""The cost of a load: how often its table is looked up, where, and how long that takes."""

from collections.abc import Mapping
from math import log2
from typing import NamedTuple

from ...evaluation.plan import Plan
from ...evaluation.points import Points
from ...evaluation.reductions.measures import AtPlace
from ...evaluation.reductions.reduced import Reduced
from ...loads.load import Load, OverTheta, OverY, TableOverTheta

LOOKUP, HALVING = 2e-9, 0.8e-9  # s in a kernel, in a pass of its own, and for each halving of the table
IN_NUMPY = 60e-9  # s, with the motion that the place follows from


class LoadCost(NamedTuple):
    """A load, how often it is looked up, where, and the time of that on one core; None for a function's."""

    name: str
    lookups: int
    where: str
    seconds: float | None


def points_of(plan: Plan) -> Points:
    """The step of the values, reduced or not."""
    (step, *_) = plan.steps
    assert isinstance(step, (Points, Reduced, AtPlace))
    return step if isinstance(step, Points) else step.of


def load_costs(plan: Plan, points: int, compiled: bool) -> list[LoadCost]:
    """The costs of the loads of a grid."""
    step, sizes = points_of(plan), {name: axis.size for name, axis in plan.outer.axes.items()}
    loads = {} if step.loads is None else step.loads.loads
    return [_cost(name, load, step, sizes, points, compiled) for name, load in loads.items()]


def _cost(
    name: str, load: Load, step: Points, sizes: Mapping[str, int], points: int, compiled: bool
) -> LoadCost:
    if isinstance(load, OverTheta):
        angles = sizes.get("theta", 1)
        if not isinstance(load, TableOverTheta):
            return LoadCost(name, angles, "a Python function, called with all angles", None)
        return LoadCost(name, angles, "once for each angle", angles * IN_NUMPY)
    assert isinstance(load, OverY)
    if step.inside is None or not compiled:
        return LoadCost(name, points, "at each point, by NumPy", points * IN_NUMPY)
    each = LOOKUP + HALVING * log2(len(load.outward.knots))
    return LoadCost(name, points, "at each point, in a pass of the kernel", points * each)
