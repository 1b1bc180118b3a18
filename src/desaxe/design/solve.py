"""`solve`: the values of one input at which a quantity of the design has a given value."""

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np

from ..mechanism.inputs import INPUTS
from ..mechanism.keywords import check_inputs
from ..mechanism.messages import amount
from ..mechanism.names import LENGTHS, WHOLE
from ..mechanism.quantity_units import unit_of
from ..mechanism.status import SolveStatus
from ..runtime.request import check_common, check_sliders
from ..support.answer import Answer
from ..support.deadline import Deadline
from ..support.panels import Array, Panels, resolved
from ..support.shown import shown
from .measures import Measure, Measured, checked, is_named, measured, text_of
from .optimisation.problem import Space, space_of, value_of

EQUAL = 1e-13  # of the largest value: a difference that is none
INSIDE = 1e-12  # of the range: so far within the lengths of a crank that turns
STEPS = 4  # of Newton's method
LARGEST = 1e-3  # of the range: of a step


class Target(NamedTuple):
    """A measure and the value that it is to have."""

    measure: Measure
    value: float


def solve(
    *,
    over: Mapping[str, tuple[Any, Any]],
    where: Mapping[Any, Any] | None = None,
    branch: int = 1,
    timeout: float | None = 120.0,
    sliders: Any = None,
    **inputs: Any,
) -> dict[str, Any]:
    """All values of one input within a range at which a quantity of the design takes a required value.

    over     dict of the input -> (low, high)
    where    dict of one measure, as in `optimize`, -> its value: {("absmax", "a_C"): 900.0}; a named one may
             be a keyword instead: stroke="50 mm", time_ratio=1.1, margin=...
    sliders  filled in by a `Crankshaft`, for a peak, an average or a quantity at an angle
    inputs   the others, as in `evaluate`, without theta

    Returns a dict:

    AB, ...    by the name of the input: all solutions, ascending
    gradient   dict input or measure -> derivatives of the solutions
    reachable  (least, largest) value of the quantity over the range, where the crank turns fully
    status     0; 1 the value is not reached, 2 the crank turns nowhere in the range, 3 the quantity has the
               value everywhere
    message    the same in words

    Raises ValueError for a range, a measure or an input that is wrong.

    See docs/choose.md: which call for which question.

        >>> import desaxe as dx
        >>> found = dx.solve(over={"AB": ("10 mm", "60 mm")}, stroke="50 mm", ec=0.0, BC=0.15)
        >>> [round(float(AB), 6) for AB in found["AB"]]
        [0.025]
    """
    check_common({}, branch)
    check_sliders(sliders)
    sought, inputs = _sought(where, inputs, INPUTS if sliders is None else (*INPUTS, *inputs))
    space = space_of(over, inputs, branch, Deadline("solve", timeout), "solve", sliders)
    if len(space.names) != 1:
        raise ValueError(f"solve: over= has {', '.join(space.names)}: it takes one input")
    name = space.names[0]
    low, high = _turning(space, sought.measure)
    if not low < high:
        return _none(name, sought, SolveStatus.CANNOT_TURN, (np.nan, np.nan))

    def at(x: Array) -> Measured:
        space.deadline.check()
        return measured([sought.measure], {**space.fixed, name: x}, branch)[sought.measure]

    def values(z: Array, row: Array) -> dict[str, Array]:
        return {"": np.broadcast_to(at(low + z * (high - low)).value, z.shape)}

    panels = resolved(values, np.array([0.0, 1.0]))
    value = panels.values[""]
    reachable = (float(panels.extreme(value, -1.0)[0]), float(panels.extreme(value, 1.0)[0]))
    height = value - sought.value
    if np.nanmax(np.abs(height)) <= EQUAL * np.nanmax(np.abs(value)):
        return _none(name, sought, SolveStatus.EQUAL, reachable)
    roots = _roots(panels, np.nan_to_num(height, nan=1.0))
    if not roots.size:
        return _none(name, sought, SolveStatus.NOT_REACHED, reachable)
    x = low + roots * (high - low)
    for _ in range(STEPS):
        here = at(x)
        with np.errstate(all="ignore"):
            step = (here.value - sought.value) / here.gradient[name]
        x = np.where(np.abs(step) < LARGEST * (high - low), np.clip(x - step, low, high), x)
    return _solutions(name, sought, x, at(x), reachable)


def _sought(
    where: Mapping[Any, Any] | None, inputs: dict[str, Any], known: Iterable[str]
) -> tuple[Target, dict[str, Any]]:
    """The measure and its value, and the inputs without it."""
    named = {name: inputs.pop(name) for name in [*inputs] if is_named(name) and inputs[name] is not None}
    check_inputs("solve", inputs, ("over", "where", "branch", "timeout", *known, *WHOLE, "margin"))
    if where is not None and not isinstance(where, Mapping):
        raise TypeError(f"where = {shown(where)}: expected a dict, such as {{('absmax', 'a_C'): 900.0}}")
    every = {**(where or {}), **named}
    if len(every) != 1:
        asked = f"got {', '.join(text_of(checked(key)) for key in every)}" if every else "got none"
        raise TypeError(f"solve takes the value of one quantity, such as stroke='50 mm'; {asked}")
    ((key, value),) = every.items()
    measure = checked(key)
    return Target(measure, value_of(measure, value, "solve")), inputs


def _turning(space: Space, measure: Measure) -> tuple[float, float]:
    """The part of the range in which the crank turns fully; all of it for the margin."""
    name, low, high = space.names[0], float(space.low[0]), float(space.high[0])
    known = {**space.fixed, name: 0.0}
    if measure == "margin" or name not in LENGTHS or not {*LENGTHS} <= {*known}:
        return low, high
    ec, AB, BC = (known[length] for length in LENGTHS)
    spare = INSIDE * (high - low)
    limits = {"AB": (low, BC - abs(ec)), "BC": (AB + abs(ec), high), "ec": (AB - BC, BC - AB)}
    least, most = limits[name]
    return max(low, least + spare if least > low else low), min(high, most - spare if most < high else high)


def _roots(panels: Panels, height: Array) -> Array:
    """The places from 0 to 1 at which the value is passed, ascending, its ends too where it is there."""
    scale = np.abs(panels.values[""]).max()
    ends = panels.ends(height)[[0, -1], [0, -1]]
    at_ends = np.array([0.0, 1.0])[np.abs(ends) <= EQUAL * scale]
    inside = panels.roots(height)
    every = np.sort(np.concatenate([at_ends, inside[inside > 0.0]]))
    return every[np.diff(every, prepend=-1.0) > INSIDE]


def _solutions(name: str, sought: Target, x: Array, here: Measured, reachable: tuple[float, float]) -> Answer:
    """The answer with the derivatives of the solutions: -m_p / m_x, and 1 / m_x by the value itself."""
    order = np.argsort(x)
    with np.errstate(all="ignore"):
        slope = here.gradient[name][order]
        gradient = {p: -v[order] / slope for p, v in here.gradient.items() if p != name and np.ndim(v)}
        gradient[_key(sought)] = 1.0 / slope
    ends = amount(sought.measure, reachable, "g", says_unit=True)
    count = f"{x.size} solution{'s' if x.size > 1 else ''}; {text_of(sought.measure)} reaches " + ends
    answer = {name: x[order], "gradient": gradient, "reachable": reachable, "status": 0, "message": count}
    return _with_units(name, sought, answer)


def _none(name: str, sought: Target, status: SolveStatus, reachable: tuple[float, float]) -> Answer:
    """The answer where there is no solution, or no end of them."""
    told = ""
    if status != SolveStatus.CANNOT_TURN:
        value, ends = (
            amount(sought.measure, part, "g", says_unit=True) for part in (sought.value, reachable)
        )
        told = f": {text_of(sought.measure)} = " + value + ", reachable is " + ends
    message = status.words + told
    answer = {name: np.empty(0), "gradient": {}, "reachable": reachable, "status": int(status)}
    return _with_units(name, sought, {**answer, "message": message})


def _key(sought: Target) -> Any:
    return sought.measure if isinstance(sought.measure, (str, tuple)) else text_of(sought.measure)


def _with_units(name: str, sought: Target, answer: dict[str, Any]) -> Answer:
    slopes = {p: unit_of(name, p) for p in answer["gradient"]}
    units = {name: unit_of(name), "reachable": unit_of(sought.measure), "gradient": slopes}
    return Answer(answer, units, SolveStatus)
