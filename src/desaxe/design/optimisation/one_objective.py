"""The optimum of one objective: searches ever nearer to the limit of turning; the front of several.

Along the Pareto front the first objective is optimised under bounds on each of the others (epsilon
constraints), which go from the worst that the optimum of another one leaves of them to their own best.
Designs that another one beats are left out.
"""

from itertools import product
from typing import Any

import numpy as np

from ..measures import measured
from .objectives import Goal, problems, side_limits
from .optimum import FOUND, NONE, SETTLED, UNSURE, none_turns, result_of
from .problem import LOWER, UPPER, Array, Limit, Space
from .search import SATISFIED, Candidate, LocalSearch

EDGES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)  # of the rod: how near to the limit of turning the search goes
GROWS = 0.2  # the power of the margin from which growth towards the limit is no rounding


def solved(goal: Goal, space: Space, limits: list[Limit], starts: int, seed: int) -> dict[str, Any]:
    """The optimum of one objective; see `optimize`."""
    none = none_turns(space, limits)
    if none is not None:
        return none
    rod = space.fixed.get("BC") or float(space.high[space.names.index("BC")])
    own = any(c.key == "margin" and c.side != UPPER and c.bound > EDGES[-1] * rod for c in limits)
    history: list[tuple[float, float]] = []
    places: list[Array] = []
    for edge in EDGES:
        implied = [] if own else side_limits(None, "margin", edge * rod, LOWER)
        # After the first time the best is followed towards the edge.
        best = _best(goal, space, [*limits, *implied], 0 if places else starts, seed, places)
        result, search = best
        if result.violation > SATISFIED and _misses_implied(result, search):
            continue  # a margin that is smaller yet may keep all limits
        at_edge = any(c.key is None and m for c, m in zip(search.limits, result.multipliers, strict=False))
        history.append((edge, abs(result.value)))
        if result.violation > SATISFIED or not at_edge or _power(history) > GROWS:
            break
        places = [result.z]
    return result_of(goal, space, *best, _power(history) > GROWS)


def _best(
    goal: Goal, space: Space, limits: list[Limit], starts: int, seed: int, places: list[Array]
) -> tuple[Candidate, LocalSearch]:
    """The best of all local searches, to its last digits."""
    candidates = []
    for pieces in problems(goal):
        search = LocalSearch(space, pieces, limits, seed)
        begin = [*places, *search.starts(starts)]
        candidates += [(search.run(start), search) for start in begin]
        # Towards the limit of turning a search may stall, so steep does it get: look along that limit too.
        near, _ = min(candidates, key=_rank)
        stalled = near.residual > SETTLED or search.is_near_margin(near.z)
        for number in search.margins() if stalled else ():
            candidates.append((search.run(search.at_limit(near.z, number), number), search))
    result, search = min(candidates, key=_rank)
    if result.violation > SATISFIED:
        nearest = search.nearest(result)
        if nearest.violation > SATISFIED:
            return nearest, search
        result, search = min(*candidates, (nearest, search), (search.run(nearest.z), search), key=_rank)
    result = search.polished(result)
    return (search.probed(result) if result.residual > SETTLED else result), search


def _misses_implied(result: Candidate, search: LocalSearch) -> bool:
    """True if the design breaks the margin that is implied."""
    value = search.scaled(result.z)[0][search.count :]
    return any(limit.key is None and v < 0.0 for limit, v in zip(search.limits, value, strict=True))


def _rank(candidate: tuple[Candidate, LocalSearch]) -> tuple[float, float]:
    result = candidate[0]
    return max(result.violation, SATISFIED), result.value


def _power(history: list[tuple[float, float]]) -> float:
    """The power of 1/margin with which the optimum has grown over the last two steps; 0 before."""
    if len(history) < 3:
        return 0.0
    edges, values = np.log(np.array(history[-3:])).T
    return float(np.min(np.diff(values) / -np.diff(edges)))


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
            side = LOWER if goal.sense > 0 else UPPER
            held += side_limits(goal.measure, goal.measure, float(bound), side)
        result = solved(goals[0], space, held, starts, seed)
        if result["status"] in (FOUND, UNSURE):
            found.append(result)
    values = np.array([_values(goals, space, result) for result in found])
    rows = _undominated(values * senses)
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


def _undominated(gains: Any) -> list[int]:
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
