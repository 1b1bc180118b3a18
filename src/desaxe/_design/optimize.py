"""`optimize`: the best design within limits, what the limits cost, or why there is none."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from .._request import check_border
from ..extras import needed
from ..support.checks import whole_number
from ..support.deadline import Deadline
from .problem import UPPER, Array, Limit, Space
from .wishes import Goal, goals_of, limits_of, lower_limits, problems, space_of

with needed("optimize", "design"):
    from .search import Found, Search
    from .verdict import SATISFIED, SETTLED, told

EDGES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)  # of the rod: how near to the limit of turning the search goes
GROWS = 0.2  # the power of the margin from which growth towards the limit is no rounding


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
    **fixed: Any,
) -> dict[str, Any]:
    """The design that makes a quantity as large or as small as possible, within limits.

    maximize, minimize  "margin", a name of `events` such as "stroke" or "time_ratio", or a peak over the
                        crank angle as (kind, quantity): ("absmax", "a_C"). Several of them, or both, ask
                        for the Pareto front: designs of which none is better than another in everything
    over                dict parameter -> (low, high): what may vary, lengths, speed or masses
    keep                dict of the same names -> (low, high), None where there is no limit; a number is to be
                        met exactly. The crank always turns fully: margin >= 0
    fixed               all other parameters, as in `evaluate`
    starts, seed        how many local searches, from the best of a scan of the space
    timeout             seconds after which it ends with a TimeoutError; None for no limit
    points              designs along a Pareto front (to the power of the objectives less one)

    Numbers are in SI units; texts with units are understood. Gives a dict:

    <parameter>  the design, each p of `over`
    value        of the objective there; infinite where there is no optimum
    active       dict of the limits that hold it back: name or parameter -> "lower", "upper" or "equal"
    multipliers  dict name or parameter -> what the objective would gain, per unit, from relaxing its limit:
                 positive, and 0 where the limit does not hold it back. With "equal", what raising the
                 wanted value would gain, of either sign. NaN at a kink, where two peaks of one sign share
                 the extreme value
    status       0 an optimum; 1 no design keeps the limits; 2 no optimum: the objective grows without
                 bound towards the limit of turning; 3 the best is at that limit itself, and nearly
                 reached at the design told; 4 the search did not settle
    message      the same in words
    residual     of the optimality conditions, relative

    For several objectives parameters, `status` and `residual` are arrays along the front, and `value` is a
    dict of arrays by objective.

    A scan of the space, SLSQP (SciPy) with exact gradients from its best places, and the last digits from the
    optimality conditions. Largest magnitudes are split into both signs, so that a kink between them does no
    harm. Needs the extra `design`. Raises ValueError for an unknown name or limits that cross.

        >>> import desaxe as dx
        >>> machine = dict(AB=0.125, BC=0.350, omega0=157.08)
        >>> keep = {"margin": (0.005, None)}
        >>> best = dx.optimize(maximize=("absmax", "a_C"), over={"ec": (0, 0.25)}, keep=keep, **machine)
        >>> round(best["ec"], 9), best["active"]
        (0.22, {'margin': 'lower'})
    """
    check_border({}, branch)
    for name, number, least in (("starts", starts, 1), ("points", points, 2)):
        whole_number(name, number, least, 10_000)
    whole_number("seed", seed, 0, 2**32 - 1)
    deadline = Deadline("optimize", timeout)
    goals = goals_of(maximize, minimize)
    space = space_of(over, fixed, branch, deadline)
    limits = limits_of(keep or {})
    if len(goals) > 1:
        from .pareto import front

        return front(goals, space, limits, starts, seed, points)
    return solved(goals[0], space, limits, starts, seed)


def solved(goal: Goal, space: Space, limits: list[Limit], starts: int, seed: int) -> dict[str, Any]:
    """The optimum of one objective; see `optimize`."""
    rod = space.fixed.get("BC") or float(space.high[space.names.index("BC")])
    own = any(c.key == "margin" and c.side != UPPER and c.bound > EDGES[-1] * rod for c in limits)
    history: list[tuple[float, float]] = []
    places: list[Array] = []
    for edge in EDGES:
        implied = [] if own else lower_limits(None, "margin", edge * rod)
        # After the first time the best is followed towards the edge.
        best = _best(goal, space, [*limits, *implied], 0 if places else starts, seed, places)
        found, search = best
        at_edge = any(c.key is None and m for c, m in zip(search.limits, found.multipliers, strict=False))
        history.append((edge, abs(found.value)))
        if found.violation > SATISFIED or not at_edge or _power(history) > GROWS:
            break
        places = [found.z]
    return told(goal, space, *best, _power(history) > GROWS)


def _best(
    goal: Goal, space: Space, limits: list[Limit], starts: int, seed: int, places: list[Array]
) -> tuple["Found", "Search"]:
    """The best of all local searches, to its last digits."""
    candidates = []
    for pieces in problems(goal):
        search = Search(space, pieces, limits, seed)
        begin = [*places, *search.starts(starts)]
        candidates += [(search.run(start), search) for start in begin]
        # Towards the limit of turning a search may stall, so steep does it get: look along that limit too.
        near, _ = min(candidates, key=_rank)
        stalled = near.residual > SETTLED or search.is_near_margin(near.z)
        for number in search.margins() if stalled else ():
            candidates.append((search.run(search.at_limit(near.z, number), number), search))
    found, search = min(candidates, key=_rank)
    found = search.polished(found)
    return (search.probed(found) if found.residual > SETTLED else found), search


def _rank(candidate: tuple["Found", "Search"]) -> tuple[float, float]:
    found = candidate[0]
    return max(found.violation, SATISFIED), found.value


def _power(history: list[tuple[float, float]]) -> float:
    """The power of 1/margin with which the optimum has grown over the last two steps; 0 before."""
    if len(history) < 3:
        return 0.0
    edges, values = np.log(np.array(history[-3:])).T
    return float(np.min(np.diff(values) / -np.diff(edges)))
