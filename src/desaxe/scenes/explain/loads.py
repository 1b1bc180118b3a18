"""The cost of a load: how often its table is looked up, and where."""

from collections.abc import Mapping
from typing import NamedTuple

from ...evaluation.plan import Plan
from ...evaluation.points import Points
from ...evaluation.reductions.reduced import AtPlace, Reduced
from ...loads.along_motion import OfMotion
from ...loads.load import Load, OverTheta, TableOverTheta


class LoadCost(NamedTuple):
    """A load, how often it is looked up, and where."""

    name: str
    lookups: int
    where: str


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
            return LoadCost(name, angles, "a Python function, called with all angles")
        return LoadCost(name, angles, "once for each angle")
    if isinstance(load, OfMotion):
        return LoadCost(name, points, "at each point, from the motion there")
    return LoadCost(name, points, "at each point, by the kernel" if compiled else "at the point")
