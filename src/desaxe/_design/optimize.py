"""`optimize`: the best design within limits, what the limits cost, or why there is none."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from .._request import as_number, check_border, check_inputs
from ..extras import needed
from ..inputs import INPUTS
from .closed_form import LENGTHS
from .measures import Measure, Measured, checked, text_of, unit_of
from .problem import EQUAL, LOWER, UPPER, Limit, Piece, Space

with needed("optimize", "design"):
    from .search import Found, Search

FOUND, NONE, UNBOUNDED, EDGE, UNSURE = range(5)
EDGES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)  # of the rod: how near to the limit of turning the search goes
GROWS = 0.2  # the power of the margin from which growth towards the limit is no rounding
SATISFIED = 1e-7  # of its scale: a limit that is broken by less is kept
SETTLED = 1e-4  # residual of the optimality conditions


class Goal(NamedTuple):
    """A measure and whether it is to be large (1) or small (-1)."""

    measure: Measure
    sense: int


def optimize(
    *,
    over: Mapping[str, tuple[Any, Any]],
    maximize: Any = None,
    minimize: Any = None,
    keep: Mapping[Any, Any] | None = None,
    branch: int = 1,
    starts: int = 4,
    points: int = 11,
    seed: int = 0,
    **fixed: Any,
) -> dict[str, Any]:
    """The design that makes a quantity as large or as small as possible, within limits.

    maximize, minimize  "margin", a name of `events` such as "stroke" or "time_ratio", or a peak over the crank
                        angle as (kind, quantity): ("absmax", "a_C"). A list of several, or both, asks for
                        the Pareto front: designs of which none is better than another in everything
    over                dict parameter -> (low, high): what may vary, lengths, speed or masses
    keep                dict of the same names -> (low, high), None where there is no limit; a number is to be
                        met exactly. The crank always turns fully: margin >= 0
    fixed               all other parameters, as in `evaluate`
    starts, seed        how many local searches, from the best of a scan of the space
    points              designs along a Pareto front (to the power of the objectives less one)

    Numbers are in SI units; texts with units are understood. Gives a dict:

    <parameter>  the design, each p of `over`
    value        of the objective there; infinite where there is no optimum
    active       dict of the limits that hold it back: name or parameter -> "lower", "upper" or "equal"
    multipliers  dict name or parameter -> what the objective would gain, per unit, from relaxing its limit:
                 positive, and 0 where the limit does not hold it back. With "equal", what raising the
                 wanted value would gain, of either sign
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
        >>> best = dx.optimize(maximize=("absmax", "a_C"), over={"ec": (0, 0.25)}, keep={"margin": (0.005, None)},
        ...                    AB=0.125, BC=0.350, omega0=157.08)
        >>> round(best["ec"], 9), best["active"]
        (0.22, {'margin': 'lower'})
    """
    check_border({}, branch)
    goals = _goals(maximize, minimize)
    space = _space(over, fixed, branch)
    limits = _limits(keep or {})
    for key in keep or {}:
        if key in space.names or key in INPUTS:
            raise ValueError(f"keep: {key} is a parameter; its bounds go into over=")
    if len(goals) > 1:
        from .pareto import front

        return front(goals, space, limits, starts, seed, points)
    return solved(goals[0], space, limits, starts, seed)


# ---- what is asked for --------------------------------------------------------------------------


def _goals(maximize: Any, minimize: Any) -> list[Goal]:
    goals = []
    for wanted, sense in ((maximize, 1), (minimize, -1)):
        several = wanted if isinstance(wanted, list) else [] if wanted is None else [wanted]
        goals += [Goal(checked(measure), sense) for measure in several]
    if not goals:
        raise TypeError('optimize: say what to maximize= or to minimize=, such as ("absmax", "a_C")')
    return goals


def _space(over: Mapping[str, Any], fixed: Mapping[str, Any], branch: int) -> Space:
    known = tuple(name for name in INPUTS if name != "theta")
    check_inputs("optimize", over, known)
    check_inputs("optimize", fixed, known)
    if not over:
        raise ValueError("over= is empty: name at least one parameter and its bounds, such as ec=(0, 0.1)")
    both = [name for name in over if name in fixed]
    if both:
        raise ValueError(f"{both[0]} is in over= and fixed at the same time")
    ends = {name: _pair(name, bounds) for name, bounds in over.items()}
    numbers = {name: _number(name, value) for name, value in fixed.items() if value is not None}
    missing = [name for name in LENGTHS if name not in over and name not in numbers]
    if missing:
        raise TypeError(f"optimize: {missing[0]} is missing (in over= or as a number)")
    low, high = (np.array([pair[i] for pair in ends.values()]) for i in (0, 1))
    return Space(tuple(over), low, high, numbers, branch)


def _pair(name: str, bounds: Any) -> tuple[float, float]:
    try:
        low, high = (_number(name, end) for end in bounds)
    except (TypeError, ValueError) as error:
        raise type(error)(f"over: {name} = {bounds!r}: two finite bounds are wanted ({error})") from None
    if not low < high:
        raise ValueError(f"over: {name} = ({low:g}, {high:g}): the lower bound first, and smaller")
    return low, high


def _number(name: str, value: Any) -> float:
    number = as_number(name, value, (name,), ("optimize",))
    if number is None:
        raise TypeError(f"{name}: optimize takes numbers, got {type(value).__name__}")
    return number


def _limits(keep: Mapping[Any, Any]) -> list[Limit]:
    """The limits as functions that stay positive."""
    limits: list[Limit] = []
    for key, bounds in keep.items():
        if key in INPUTS:
            continue  # told by the caller
        measure = checked(key)
        pair = bounds if isinstance(bounds, (tuple, list)) else (bounds, bounds)
        if len(pair) != 2:
            raise ValueError(
                f"keep: {text_of(measure)} = {bounds!r}: a pair (low, high) or a number is wanted"
            )
        low, high = (None if end is None else _in_si(measure, end) for end in pair)
        if low is not None and high is not None and low >= high:
            if low > high:
                raise ValueError(f"keep: {text_of(measure)} = ({low:g}, {high:g}): the lower bound first")
            limits.append(Limit(key, measure, 1.0, low, EQUAL))
            continue
        if low is not None:
            limits += lower_limits(key, measure, low)
        if high is not None:
            limits += upper_limits(key, measure, high)
    return limits


def _in_si(measure: Measure, value: Any) -> float:
    if isinstance(value, str) or hasattr(value, "magnitude"):
        from ..units import in_unit

        value = in_unit(text_of(measure), value, unit_of(measure))
    number = float(value)
    if not np.isfinite(number):
        raise ValueError(f"keep: {text_of(measure)} = {number}: it must be finite, or None for no limit")
    return number


def lower_limits(key: Any, measure: Measure, bound: float) -> list[Limit]:
    """measure >= bound. The margin has two sides, without a kink at ec = 0."""
    if measure == "margin":
        return [Limit(key, side, 1.0, bound, LOWER) for side in (_margin_above, _margin_below)]
    return [Limit(key, measure, 1.0, bound, LOWER)]


def upper_limits(key: Any, measure: Measure, bound: float) -> list[Limit]:
    """measure <= bound. A largest magnitude has two signs, without a kink between them."""
    if isinstance(measure, tuple) and measure[0] == "absmax":
        name = measure[1]
        return [Limit(key, ("max", name), -1.0, bound, UPPER), Limit(key, ("min", name), 1.0, -bound, UPPER)]
    return [Limit(key, measure, -1.0, bound, UPPER)]


def _margin_above(designs: Mapping[str, Any]) -> Measured:
    return _one_sided(designs, -1.0)


def _margin_below(designs: Mapping[str, Any]) -> Measured:
    return _one_sided(designs, 1.0)


def _one_sided(designs: Mapping[str, Any], side: float) -> Measured:
    ec, AB, BC = (np.asarray(designs[name], float) for name in LENGTHS)
    value = (BC - AB) + side * ec
    one = np.ones_like(value)
    return Measured(value, {"ec": side * one, "AB": -one, "BC": one})


# ---- one objective ------------------------------------------------------------------------------


def _pieces(goal: Goal) -> list[list[Piece]]:
    """Problems of which the best is taken, each with the pieces whose largest is made small."""
    measure, sense = goal
    if isinstance(measure, tuple) and measure[0] == "absmax":
        signs = [Piece(("max", measure[1]), -sense), Piece(("min", measure[1]), float(sense))]
        return [[sign] for sign in signs] if sense > 0 else [signs]
    return [[Piece(measure, -float(sense))]]


def solved(goal: Goal, space: Space, limits: list[Limit], starts: int, seed: int) -> dict[str, Any]:
    """The optimum of one objective; see `optimize`."""
    own = any(limit.key == "margin" and limit.side != UPPER for limit in limits)
    rod = space.fixed.get("BC") or float(space.high[space.names.index("BC")])
    best: tuple[Found, Search] | None = None
    history: list[tuple[float, float]] = []
    places: list[Any] = []
    for edge in (0.0,) if own else EDGES:
        implied = [] if own else lower_limits(None, "margin", edge * rod)
        best = _best(goal, space, [*limits, *implied], starts, seed, places)
        found, search = best
        if found.violation > SATISFIED:
            break
        history.append((edge, abs(found.value)))
        at_edge = any(
            limit.key is None and m for limit, m in zip(search.limits, found.multipliers, strict=False)
        )
        if not at_edge or _power(history) > GROWS:
            break
        places = [found.z]
    assert best is not None
    return _told(goal, space, *best, history, own)


def _best(
    goal: Goal, space: Space, limits: list[Limit], starts: int, seed: int, places: list[Any]
) -> tuple[Found, "Search"]:
    """The best of all local searches."""
    candidates = []
    for pieces in _pieces(goal):
        search = Search(space, pieces, limits, seed)
        candidates += [(search.run(start), search) for start in [*places, *search.starts(starts)]]
    return min(candidates, key=lambda pair: (max(pair[0].violation, SATISFIED), pair[0].value))


def _power(history: list[tuple[float, float]]) -> float:
    """With which power of 1/margin the optimum has grown over the last two steps; 0 if not over both."""
    if len(history) < 3:
        return 0.0
    edges, values = np.log(np.array(history[-3:])).T
    return float(np.min(np.diff(values) / -np.diff(edges)))


def _told(
    goal: Goal, space: Space, found: Found, search: Search, history: list[tuple[float, float]], own: bool
) -> dict[str, Any]:
    design = {name: float(x[0]) for name, x in space.designs(found.z).items() if name in space.names}
    active, multipliers = _named(space, found, search)
    edge = not own and None in active
    active.pop(None, None)
    gain = multipliers.pop(None, 0.0)
    status = FOUND
    if found.violation > SATISFIED:
        status = NONE
    elif edge:
        status = UNBOUNDED if _power(history) > GROWS else EDGE
    elif found.residual > SETTLED:
        status = UNSURE
    value = (
        -goal.sense * found.value
        if isinstance(goal.measure, str) or goal.measure[0] != "absmax"
        else found.value
    )
    if isinstance(goal.measure, tuple) and goal.measure[0] == "absmax":
        value = abs(value)
    if edge:
        active["margin"], multipliers["margin"] = LOWER, gain
    if status == UNBOUNDED:
        value = goal.sense * np.inf
        multipliers = dict.fromkeys(multipliers, np.nan)
    if status == NONE:
        value, multipliers = np.nan, dict.fromkeys(multipliers, np.nan)
    return {
        **design,
        "value": float(value),
        "active": active,
        "multipliers": multipliers,
        "status": status,
        "message": _message(status, goal, design, found, search, active),
        "residual": found.residual,
    }


def _named(space: Space, found: Found, search: Search) -> tuple[dict[Any, str], dict[Any, float]]:
    """Which limits hold the optimum back, and their multipliers, by name."""
    n, count = len(space.names), len(search.limits)
    active: dict[Any, str] = {}
    multipliers: dict[Any, float] = {limit.key: 0.0 for limit in search.limits} | dict.fromkeys(
        space.names, 0.0
    )
    for limit, multiplier in zip(search.limits, found.multipliers[:count], strict=True):
        if multiplier or limit.side == EQUAL:
            active[limit.key] = limit.side
            multipliers[limit.key] += float(-multiplier if limit.side == EQUAL else multiplier)
    width = space.high - space.low
    for side, part in (
        (LOWER, found.multipliers[count : count + n]),
        (UPPER, found.multipliers[count + n :]),
    ):
        for name, multiplier, wide in zip(space.names, part, width, strict=True):
            if multiplier:
                active[name] = side
                multipliers[name] = float(multiplier / wide)
    return active, multipliers


def _message(
    status: int, goal: Goal, design: dict[str, float], found: Found, search: Search, active: dict[Any, str]
) -> str:
    what = text_of(goal.measure)
    where = ", ".join(f"{name} = {value:.6g}" for name, value in design.items())
    if status == NONE:
        value = search.scaled(found.z)[0][search.count :]
        worst = int(np.argmax(np.where(search.equal, np.abs(value), -value)))
        limit = search.limits[worst]
        key = "margin" if limit.key is None else text_of(checked(limit.key))
        short = abs(float(value[worst] * search.scale[search.count + worst]))
        return f"no design in over= keeps all limits: {key} misses its {limit.side} limit by {short:.3g} at the nearest, {where}"
    if status == UNBOUNDED:
        return (
            f"no optimum: {what} grows without bound towards the limit of turning, margin = BC - AB - |ec| = 0, "
            f"as near {where}; keep a margin, such as keep={{'margin': (0.005, None)}}"
        )
    if status == EDGE:
        return f"the best is at the limit of turning itself, margin = BC - AB - |ec| = 0: {what} is bounded there, near {where}"
    if status == UNSURE:
        return f"the search ended at {where}, where the optimality conditions hold to {found.residual:.1g} only: more starts= may help"
    held = ", ".join(
        f"{key if isinstance(key, str) else text_of(key)} ({side})" for key, side in active.items()
    )
    return f"optimum at {where}" + (f", held back by {held}" if held else ", inside of all limits")
