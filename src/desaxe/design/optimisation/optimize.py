"""`optimize`: the best design within limits, with the multipliers of the limits; or why there is none.

An optimum is searched ever nearer to the limit of turning. Along the Pareto front of several objectives the
first is optimised under bounds on each of the others (epsilon constraints), which go from the worst that the
optimum of another one leaves of them to their own best. Designs that another one beats are left out.
"""

from collections.abc import Mapping
from functools import partial
from itertools import product
from typing import Any

import numpy as np

from ...mechanism.keywords import with_known_keywords
from ...runtime.request import check_common, check_sliders
from ...support.answer import Answer
from ...support.checks import whole_number
from ...support.deadline import Deadline
from ...support.extras import explained
from ...support.signals import put_off
from ..measures import measured
from .problem import LOWER, UPPER, Array, Goal, Limit, Space, goals_of, limits_of, side_limits, space_of

with put_off(), explained("optimize", "design"):
    from .optimum import FOUND, NONE, UNSURE, none_turns, result_of, units_of_optimum
    from .search import CLOSE, SATISFIED, SETTLED, Candidate, LocalSearch

EDGES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)  # of the rod: how near to the limit of turning the search goes
GROWS = 0.2  # the power of the margin from which growth towards the limit is no rounding


@with_known_keywords
def optimize(
    *,
    over: Mapping[str, tuple[Any, Any]],
    maximize: Any = None,
    minimize: Any = None,
    keep: Mapping[Any, Any] | None = None,
    branch: int = 1,
    starts: int = 3,
    points: int = 11,
    seed: int = 0,
    timeout: float | None = 120.0,
    sliders: Any = None,
    **fixed: Any,
) -> dict[str, Any]:
    """The design that makes a quantity as large or as small as possible, within limits.

    maximize, minimize  "margin", a name of `events` such as "stroke" or "time_ratio", or a peak over the
                        crank angle as (kind, quantity): ("absmax", "a_C"). Others are ("rms", "T_in"),
                        ("mean", "power_in"), ("at", "60 deg", "Y"), and a function of a design, a dict,
                        that gives its value and a dict of its derivatives. Several of them, or both, ask
                        for the Pareto front: designs of which none is better than another in everything
    over                dict parameter -> (low, high): what may vary, lengths, speed or masses
    keep                dict of the same names -> (low, high), None where there is no limit, or ("==", value).
                        The crank always turns fully: margin >= 0
    fixed               all other parameters, as in `evaluate`; F_X and F_Y may vary with the motion
    sliders             filled in by a `Crankshaft`, whose phases and banks may vary, too
    starts, seed        how many local searches, from the best of a scan of the space
    timeout             seconds after which it ends with a TimeoutError; None for no limit
    points              designs along a Pareto front (to the power of the objectives less one)

    Numbers are in SI units; texts with units are understood. Gives a dict:

    <parameter>  the design, each p of `over`
    value        of the objective there; infinite where there is no optimum
    active       dict of the limits that hold it back: name or parameter -> "lower", "upper" or "equal"
    multipliers  dict name or parameter -> what the objective would gain, per unit, from relaxing its limit:
                 positive, and 0 where the limit does not hold it back. With "equal", what raising the
                 required value would gain, of either sign. NaN at a kink of the objective
    status       0 an optimum; 1 no design keeps the limits; 2 no optimum: the objective grows without
                 bound towards the limit of turning; 3 the best is at that limit itself, and nearly
                 reached by the design returned; 4 the search did not settle; 5 the objective has no finite
                 value at any design that was looked at. NaN and infinity are no design: they are left out,
                 and the message says so
    message      the same in words
    residual     of the optimality conditions, relative

    For several objectives parameters, `status` and `residual` are arrays along the front, and `value` is a
    dict of arrays by objective.

    A scan of the space, SLSQP (SciPy) with exact gradients from its best places, and the last digits from the
    optimality conditions. Largest magnitudes are split into both signs, so that a kink between them does no
    harm. Needs the extra `design`. Raises ValueError for an unknown name or limits that cross.

    See docs/choose.md: which call for which question.

        >>> import desaxe as dx
        >>> machine = dict(AB=0.125, BC=0.350, omega0=157.08)
        >>> keep = {"margin": (0.005, None)}
        >>> best = dx.optimize(maximize=("absmax", "a_C"), over={"ec": (0, 0.25)}, keep=keep, **machine)
        >>> round(best["ec"], 9), best["active"]
        (0.22, {'margin': 'lower'})
    """
    check_common({}, branch)
    check_sliders(sliders)
    for name, number, least in (("starts", starts, 1), ("points", points, 2)):
        whole_number(name, number, least, 10_000)
    whole_number("seed", seed, 0, 2**32 - 1)
    deadline = Deadline("optimize", timeout)
    goals = goals_of(maximize, minimize)
    space = space_of(over, fixed, branch, deadline, sliders=sliders)
    limits = limits_of({} if keep is None else keep)
    with deadline.shown():
        if len(goals) > 1:
            result = front(goals, space, limits, starts, seed, points)
        else:
            result = solved(goals[0], space, limits, starts, seed)
    return Answer(result, partial(units_of_optimum, goals))


def solved(goal: Goal, space: Space, limits: list[Limit], starts: int, seed: int) -> dict[str, Any]:
    """The optimum of one objective; see `optimize`."""
    none = none_turns(space, limits)
    if none is not None:
        return none
    rod = space.rod
    own = any(c.key == "margin" and c.side != UPPER and c.bound > EDGES[-1] * rod for c in limits)
    history: list[tuple[float, float]] = []
    places: list[Array] = []
    for edge in EDGES:
        implied = [] if own else side_limits(None, "margin", edge * rod, LOWER)
        # After the first time the best is followed towards the edge.
        result, search = best = _best(goal, space, [*limits, *implied], 0 if places else starts, seed, places)
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
    for pieces in goal.problems:
        search = LocalSearch(space, pieces, limits, seed)
        for start in (*places, *search.starts(starts)):
            candidates += [(search.run(start), search), (search.judged(start), search)]
        # Towards the limit of turning a search may stall, so steep does it get: look along that limit too.
        near, _ = min(candidates, key=_rank)
        value = search.scaled(near.z)[0][search.count :]
        stalled = near.residual > SETTLED or any(value[k] < CLOSE for k in search.margins)
        for k in search.margins if stalled else ():
            candidates.append((search.run(search.at_limit(near.z, k), k), search))
    result, search = min(candidates, key=_rank)
    if result.violation > SATISFIED:
        nearest = search.nearest(result, seed)
        if nearest.violation > SATISFIED:
            return nearest, search
        result, search = min(*candidates, (nearest, search), (search.run(nearest.z), search), key=_rank)
    return search.settled(result), search


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
    found: list[dict[str, Any]] = []
    for goal in goals:
        found.append(solved(goal, space, limits, starts, seed))
        if found[-1]["status"] not in (FOUND, UNSURE):
            status = np.full(1, found[-1]["status"] or NONE, np.int8)
            return {**_front(goals, space, [], np.empty((0, len(goals)))), "status": status,
                    "message": found[-1]["message"]}  # fmt: skip
    senses = np.array([goal.sense for goal in goals])
    corners = np.array([_values(goals, space, result) for result in found])
    worst = np.min(corners * senses, axis=0) * senses
    for bounds in product(*(np.linspace(worst[k], corners[k, k], points) for k in range(1, len(goals)))):
        kept = [*limits]
        for goal, bound in zip(goals[1:], bounds, strict=True):
            side = LOWER if goal.sense > 0 else UPPER
            kept += side_limits(goal.measure, goal.measure, float(bound), side)
        found.append(solved(goals[0], space, kept, starts, seed))
    found = [result for result in found if result["status"] in (FOUND, UNSURE)]
    values = np.array([_values(goals, space, result) for result in found])
    rows = _undominated(values * senses)
    return _front(goals, space, [found[row] for row in rows], values[rows])


def _front(goals: list[Goal], space: Space, kept: list[dict[str, Any]], values: Array) -> dict[str, Any]:
    """The designs of a front as arrays."""
    return {
        **{name: np.array([result[name] for result in kept]) for name in space.names},
        "value": {goal.key: values[:, k] for k, goal in enumerate(goals)},
        "status": np.array([result["status"] for result in kept], np.int8),
        "residual": np.array([result["residual"] for result in kept]),
        "message": f"{len(kept)} design{'s' if len(kept) > 1 else ''} on the Pareto front",
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
