"""The Pareto front of several objectives: one is optimised while the others are held, step by step.

The first objective is optimised under bounds on each of the others (epsilon constraints), which go from the
worst that the optimum of another one leaves of them to their own best. Designs that another one beats are
left out.
"""

from itertools import product
from typing import Any

import numpy as np

from ..measures import measured
from .objectives import Goal, lower_limits, upper_limits
from .one_objective import solved
from .optimum import FOUND, NONE, UNSURE
from .problem import Limit, Space


def front(
    goals: list[Goal], space: Space, limits: list[Limit], starts: int, seed: int, points: int
) -> dict[str, Any]:
    """Designs along the front; see `optimize`."""
    alone: list[dict[str, Any]] = []
    for goal in goals:
        alone.append(solved(goal, space, limits, starts, seed))
        if alone[-1]["status"] not in (FOUND, UNSURE):
            return _none(goals, space, alone[-1])
    senses = np.array([goal.sense for goal in goals])
    corners = np.array([_values(goals, space, result) for result in alone])
    worst = np.min(corners * senses, axis=0) * senses
    steps = [np.linspace(worst[k], corners[k, k], points) for k in range(1, len(goals))]
    found = [*alone]
    for bounds in product(*steps):
        held = [*limits]
        for goal, bound in zip(goals[1:], bounds, strict=True):
            sides = lower_limits if goal.sense > 0 else upper_limits
            held += sides(goal.measure, goal.measure, float(bound))
        result = solved(goals[0], space, held, starts, seed)
        if result["status"] in (FOUND, UNSURE):
            found.append(result)
    values = np.array([_values(goals, space, result) for result in found])
    rows = _best(values * senses)
    kept = [found[row] for row in rows]
    return {
        **{name: np.array([result[name] for result in kept]) for name in space.names},
        "value": {goal.key: values[rows, k] for k, goal in enumerate(goals)},
        "status": np.array([result["status"] for result in kept], np.int8),
        "residual": np.array([result["residual"] for result in kept]),
        "message": f"{len(rows)} design{'s' if len(rows) > 1 else ''} on the Pareto front",
    }


def _values(goals: list[Goal], space: Space, result: dict[str, Any]) -> list[float]:
    designs = {**space.fixed, **{name: np.array([result[name]]) for name in space.names}}
    found = measured([goal.measure for goal in goals], designs, space.branch)
    return [float(np.reshape(found[goal.measure].value, -1)[0]) for goal in goals]


def _best(gains: Any) -> list[int]:
    """Indices of the non-dominated rows, sorted by the first objective, its best first."""
    slack = 1e-9 * np.maximum(np.abs(gains).max(axis=0), 1e-300)
    kept: list[int] = []
    for row in np.lexsort(-gains.T[::-1]):
        if not any((gains[other] >= gains[row] - slack).all() for other in kept):
            kept.append(int(row))
    return kept


def _none(goals: list[Goal], space: Space, result: dict[str, Any]) -> dict[str, Any]:
    """The empty front, returned if an objective has no optimum."""
    nothing = np.empty(0)
    return {
        **dict.fromkeys(space.names, nothing),
        "value": {goal.key: nothing for goal in goals},
        "status": np.full(1, result["status"] or NONE, np.int8),
        "residual": nothing,
        "message": result["message"],
    }
