"""The result of `optimize`: the design, its active limits with their multipliers, a message."""

from collections.abc import Mapping, Sequence
from math import fsum, nan
from typing import Any

import numpy as np

from ...mechanism.inputs import INPUTS
from ...mechanism.messages import Message, amount, listed
from ...mechanism.names import LENGTHS
from ...mechanism.quantity_units import slopes_of, unit_of, units_by_name
from ...mechanism.status import OptimizeStatus
from ..measures import Measure, checked, text_of
from .problem import EQUAL, LOWER, UPPER, Goal, Limit, Space
from .search import NEAR, SATISFIED, SETTLED, Candidate, LocalSearch

FOUND, NONE, UNBOUNDED, EDGE, UNSURE, NO_VALUE = map(int, OptimizeStatus)
NOWHERE = "no design in over= keeps all limits: "
STILL = 1e-12  # of the objective: a slope over the range that is none


def result_of(
    goal: Goal, space: Space, result: Candidate, search: LocalSearch, grows: bool
) -> dict[str, Any]:
    """The result of `optimize` for one objective; `grows` where it does without bound towards the edge."""
    design = {name: float(x[0]) for name, x in space.designs(result.z).items() if name in space.names}
    active, multipliers = _named(space, result, search)
    gain = multipliers.pop(None, 0.0)
    edge = active.pop(None, "")  # the implied limit, of turning
    if edge:
        active["margin"], multipliers["margin"] = LOWER, gain
    status = FOUND
    if result.violation > SATISFIED or not np.isfinite(result.value):
        status = NONE if result.violation > SATISFIED else NO_VALUE
    elif edge:
        status = UNBOUNDED if grows else EDGE
    elif result.residual > SETTLED and not result.kink:
        status = UNSURE
    size = isinstance(goal.measure, tuple) and goal.measure[0] == "absmax"
    value = abs(result.value) if size else -goal.sense * result.value
    unknown = {NONE: np.nan, NO_VALUE: np.nan, UNBOUNDED: goal.sense * np.inf}
    return {
        **design,
        "value": float(unknown.get(status, value)),
        "active": active,
        "multipliers": dict.fromkeys(multipliers, np.nan)
        if status in unknown or result.kink
        else multipliers,
        "status": status,
        "message": _message(status, goal, design, result, search, active),
        "residual": result.residual,
    }


def _named(space: Space, result: Candidate, search: LocalSearch) -> tuple[dict[Any, str], dict[Any, float]]:
    """The active limits and the multipliers, by name."""
    rows = [(limit.key, limit.side, -1.0 if limit.side == EQUAL else 1.0) for limit in search.limits]
    ends = list(zip(space.names, 1.0 / (space.high - space.low), strict=True))
    rows += [(name, side, unit) for side in (LOWER, UPPER) for name, unit in ends]
    active: dict[Any, str] = {}
    multipliers: dict[Any, float] = {key: 0.0 for key, *_ in rows}
    for (key, side, unit), multiplier in zip(rows, result.multipliers, strict=True):
        if multiplier or side == EQUAL:
            active[key] = side
            multipliers[key] += float(unit * multiplier)
    return active, multipliers


def _message(
    status: int,
    goal: Goal,
    design: dict[str, float],
    result: Candidate,
    search: LocalSearch,
    active: dict[Any, str],
) -> str:
    what = text_of(goal.measure)
    where = _where(design)
    limit = "margin = BC - AB - |ec| = 0"
    if status == NONE:
        return NOWHERE + _missed(result, search) + " at the nearest, " + where
    if status == NO_VALUE:
        return f"{what} has no finite value at any of the {len(search.places)} designs that were looked at"
    if status == UNBOUNDED:
        message = f"no optimum: {what} grows without bound towards the limit of turning, {limit}, as near "
        keep = "; keep a margin, such as keep={'margin': ('" + _number("margin", 0.005) + "', None)}"
        return message + where + keep
    if status == EDGE:
        message = f"the best is at the limit of turning itself, {limit}: {what} is bounded there, near "
        return message + where
    if status == UNSURE:
        unsure = (
            f", where the optimality conditions hold to {result.residual:.1g} only: more starts= may help"
        )
        return "the search ended at " + where + unsure
    names = {key: key if key in design else text_of(checked(key)) for key in active}
    held = ", ".join(f"{names[key]} ({side})" for key, side in active.items())
    rest = f", held back by {held}" if held else _inside(search.space, result.z)
    return (
        "optimum at "
        + where
        + f"{_kink(goal, result)}{rest}{_left_out(what, search)}{_unmoved(goal, search)}"
    )


def _kink(goal: Goal, result: Candidate) -> str:
    """Why the derivatives do not vanish at an optimum, as text."""
    if result.edge:
        return f", at the edge of the designs where {text_of(goal.measure)} is finite"
    return ", at a kink of the objective" if result.kink else ""


def _left_out(what: str, search: LocalSearch) -> str:
    """The number of designs of the scan that keep the limits and have no finite objective, as text."""
    lost = int(search.without_value(search.places).sum())
    share = f"{lost} of {len(search.places)} designs that were looked at"
    return f"; {what} has no finite value at {share}, which are left out" if lost else ""


def _unmoved(goal: Goal, search: LocalSearch) -> str:
    """The variables with which the objective does not change at any design of the scan, as text."""
    if len(goal.problems) > 1:  # of which the search has one
        return ""
    scan = search.functions(search.places)
    value, slope = np.abs(scan.value[:, : search.count, None]), np.abs(scan.slope[:, : search.count])
    still = np.asarray((slope > STILL * value).sum(axis=(0, 1)) == 0)
    names = [name for name, is_still in zip(search.space.names, still, strict=True) if is_still]
    return f"; {text_of(goal.measure)} does not change with {', '.join(names)}" if names else ""


def _inside(space: Space, z: Any) -> str:
    """The place of an optimum that no limit holds back: inside of them, or just on a bound."""
    sides = ((LOWER, z <= NEAR), (UPPER, z >= 1.0 - NEAR))
    touched = [
        f"{name} ({side})" for side, on in sides for name, is_on in zip(space.names, on, strict=True) if is_on
    ]
    if not touched:
        return ", inside of all limits"
    return f", on the bound of {', '.join(touched)}, which does not hold it back"


def _number(name: Any, value: float, form: str = ".3g") -> Message:
    return amount(name, value, form, says_unit=True)


def none_turns(space: Space, limits: Sequence[Limit]) -> dict[str, Any] | None:
    """The result where no design within the bounds turns fully, or has the margin to be kept; else None."""
    ends = dict(zip(space.names, zip(space.low.tolist(), space.high.tolist(), strict=True), strict=True))
    design = {name: 0.5 * (low + high) for name, (low, high) in ends.items()}
    best: dict[str, Any] = {"ec": lambda low, high: min(max(0.0, low), high), "AB": min, "BC": max}
    design |= {name: choose(*ends[name]) for name, choose in best.items() if name in ends}
    ec, AB, BC = (float({**space.fixed, **design}.get(name, nan)) for name in LENGTHS)
    margin = fsum((BC, -AB, -abs(ec)))  # NaN of sliders that differ
    kept = max((c.bound for c in limits if c.key == "margin" and c.side != UPPER), default=None)
    if not margin < (kept or 0.0) - SATISFIED * BC:
        return None
    missed = _misses_turning(-margin) if kept is None else _misses("margin", LOWER, kept - margin)
    keys = [*(limit.key for limit in limits), *space.names]
    return {
        **design, "value": np.nan, "active": {}, "multipliers": dict.fromkeys(keys, np.nan), "status": NONE,
        "message": NOWHERE + missed + " at the nearest, " + _where(design), "residual": 0.0,
    }  # fmt: skip


def _where(design: Mapping[str, float]) -> Message:
    return listed([f"{name} = " + _number(name, value, ".9g") for name, value in design.items()])


def _misses(measure: Measure, side: str, short: float) -> Message:
    return f"{text_of(measure)} misses its {side} limit by " + _number(measure, short)


def _misses_turning(short: float) -> Message:
    return "margin = BC - AB - |ec| misses 0, from which on the crank turns, by " + _number("margin", short)


def _missed(result: Candidate, search: LocalSearch) -> Message:
    """The most violated limit, and the violation, as text."""
    value = search.scaled(result.z)[0][search.count :]
    wrong = np.where(search.equal, np.abs(value), -value)
    short = wrong * search.scale[search.count :]
    for k in np.argsort(-wrong):
        limit = search.limits[k]
        if limit.key is not None and short[k] > 0.0:
            return _misses(checked(limit.key), limit.side, float(short[k]))
        if limit.key is None and short[k] > limit.bound:  # implied, and kept with a little to spare
            return _misses_turning(float(short[k] - limit.bound))
    least = min(limit.bound for limit in search.limits if limit.key is None)
    return "the margin, above 0, is less than " + _number("margin", least)


def units_of_optimum(goals: list[Goal], result: Mapping[str, Any]) -> dict[Any, Any]:
    """The units of the design, of the objectives, and of what they gain by relaxing a limit."""
    values = {goal.key: unit_of(goal.measure) for goal in goals}
    units = units_by_name({key: value for key, value in result.items() if key in INPUTS or "[" in key})
    if isinstance(result["value"], Mapping):
        return {**units, "value": values}
    gains = slopes_of(goals[0].measure, result["multipliers"])
    return {**units, "value": values[goals[0].key], "multipliers": gains}
