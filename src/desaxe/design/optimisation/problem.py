"""The request of `optimize`: objectives, space of designs and limits, in variables from 0 to 1.

Measures with a kink, such as one of |ec|, are the largest or the smallest of smooth ones.
"""

from collections.abc import Callable, Mapping, Sequence
from math import pi
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...evaluation.labelled import loads_of
from ...evaluation.reductions.own_measure import OwnMeasure
from ...loads.along_motion import with_derivatives
from ...mechanism.closed.limits import margins_of
from ...mechanism.inputs import INPUTS, Input, row_of
from ...mechanism.keywords import check_inputs
from ...mechanism.messages import Message, NamedValue, amount, message_of, named
from ...mechanism.names import LENGTHS
from ...mechanism.quantity_units import UnitSystem, unit_of
from ...mechanism.read import read
from ...support.deadline import Deadline
from ...support.shown import shown
from ..measures import Measure, Measured, checked, is_named, measured, text_of

Array = NDArray[np.float64]
LOWER, UPPER, EQUAL = "lower", "upper", "equal"
EQUATION = "=="  # in place of a lower end
Smooth = Measure | Callable[[Mapping[str, Any]], Measured]


class Limit(NamedTuple):
    """sign * (measure - bound) >= 0, or = 0; `key` is what the caller calls it.

    A piece of an objective is the same without a side: of the largest piece the smallest value is sought.
    """

    key: Any
    measure: Any
    sign: float
    bound: float = 0.0
    side: str = ""


class Space(NamedTuple):
    """The parameters that vary, between finite bounds, and those that are fixed."""

    names: tuple[str, ...]
    low: Array
    high: Array
    fixed: Mapping[str, Any]  # numbers, and loads that vary with the motion
    branch: int
    deadline: Deadline

    @property
    def rod(self) -> float:
        """The length of the rod, or the longest one, of several sliders of the first."""
        if "BC" in self.names:
            return float(self.high[self.names.index("BC")])
        several = self.fixed.get("sliders")
        return float(self.fixed["BC"] if several is None else several.members[0].inputs["BC"])

    def designs(self, z: Array) -> dict[str, Any]:
        """Rows of variables as parameters by name."""
        x = self.low + np.atleast_2d(z) * (self.high - self.low)
        x = np.clip(x, self.low, self.high)
        return {**self.fixed, **{name: x[:, i] for i, name in enumerate(self.names)}}


class Functions:
    """Functions sign * (measure - bound) over a space of designs; the last result is cached.

    value   (designs, functions)
    slope   (designs, functions, variables)
    """

    def __init__(self, space: Space, rows: Sequence[Limit]) -> None:
        self.space, self.rows = space, tuple(rows)
        self.value = self.slope = np.empty(0)
        self._key = b""

    def __call__(self, z: Array) -> "Functions":
        """Values and slopes of all functions at rows of variables."""
        key = np.ascontiguousarray(z).tobytes()
        if self._key != key:
            self._evaluate(np.atleast_2d(z))
            self._key = key
        return self

    def _evaluate(self, z: Array) -> None:
        space = self.space
        space.deadline.check()
        result = measured([row.measure for row in self.rows], space.designs(z), space.branch)
        self.value = np.empty((len(z), len(self.rows)))
        self.slope = np.zeros((*self.value.shape, len(space.names)))
        for k, (_, measure, sign, bound, _) in enumerate(self.rows):
            value, gradient = result[measure]
            self.value[:, k] = sign * (value - bound)
            for i, name in enumerate(space.names):
                if name in gradient:
                    self.slope[:, k, i] = sign * gradient[name] * (space.high[i] - space.low[i])


class Sides(NamedTuple):
    """The measure is the largest (or else the smallest) of sign * smooth."""

    largest: bool
    parts: tuple[tuple[Smooth, float], ...]


def sides_of(measure: Measure) -> Sides:
    """The smooth parts of a measure; itself where it has no kink."""
    if isinstance(measure, tuple) and measure[0] == "absmax":
        return Sides(True, ((("max", measure[1]), 1.0), (("min", measure[1]), -1.0)))
    alone = Sides(True, ((measure, 1.0),))
    return SIDES.get(measure, alone) if isinstance(measure, str) else alone


def _margin(side: float) -> Smooth:
    """BC - AB - side ec of designs."""

    def margin(designs: Mapping[str, Any]) -> Measured:
        if "sliders" in designs:
            return Measured(*designs["sliders"].least_margin(side, designs))
        ec, AB, BC = (np.asarray(designs[name], float) for name in LENGTHS)
        value = margins_of(side * ec, AB, BC)[0]
        one = np.ones_like(value)
        return Measured(value, {"ec": -side * one, "AB": -one, "BC": one})

    return margin


def _ratio(over: str, under: str) -> Smooth:
    """One of the angles of advance and return over the other."""

    def ratio(designs: Mapping[str, Any]) -> Measured:
        above, below = measured([over, under], designs).values()
        value = above.value / below.value
        slopes = {p: (above.gradient[p] - value * below.gradient[p]) / below.value for p in LENGTHS}
        return Measured(value, slopes)

    return ratio


ACROSS = (0.5 * pi, -0.5 * pi)  # a crank across the guide: there the rod leans most to either side
TRANSMISSION = tuple((("at", angle, "transmission_angle"), 1.0) for angle in ACROSS)
ANGLES = "advance_angle", "return_angle"
SIDES = {
    "margin": Sides(False, ((_margin(1.0), 1.0), (_margin(-1.0), 1.0))),
    "max_pressure_angle": Sides(True, tuple((("at", angle, "phi"), 2.0 * angle / pi) for angle in ACROSS)),
    "min_transmission_angle": Sides(False, TRANSMISSION),
    "time_ratio": Sides(True, ((_ratio(*ANGLES), 1.0), (_ratio(*ANGLES[::-1]), 1.0))),
}


class Goal(NamedTuple):
    """A measure and its sense: 1 to maximise, -1 to minimise."""

    measure: Measure
    sense: int

    @property
    def key(self) -> Any:
        """The measure as results are keyed by it: a function is itself."""
        return self.measure.function if isinstance(self.measure, OwnMeasure) else self.measure

    @property
    def problems(self) -> list[list[Limit]]:
        """The minimax problems, whose best optimum counts; each is a list of pieces."""
        largest, parts = sides_of(self.measure)
        pieces = [Limit(None, part, -self.sense * sign) for part, sign in parts]
        return [pieces] if largest == (self.sense < 0) else [[piece] for piece in pieces]


def goals_of(maximize: Any, minimize: Any) -> list[Goal]:
    """The objectives, each with its sense: 1 to maximise, -1 to minimise."""
    goals = []
    for requested, sense in ((maximize, 1), (minimize, -1)):
        goals += [Goal(checked(measure), sense) for measure in _several(requested)]
    if not goals:
        raise TypeError('optimize: say what to maximize= or to minimize=, such as ("absmax", "a_C")')
    return goals


def _several(requested: Any) -> list[Any]:
    """One or several objectives as a list; a pair (kind, quantity) is one objective."""
    if requested is None:
        return []
    many = isinstance(requested, tuple) and (
        len(requested) not in (2, 3) or not isinstance(requested[0], str) or is_named(requested[0])
    )
    return list(requested) if many or isinstance(requested, list) else [requested]


def space_of(
    over: Mapping[str, Any],
    fixed: Mapping[str, Any],
    branch: int,
    deadline: Deadline,
    caller: str = "optimize",
    sliders: Any = None,
) -> Space:
    """The box of free parameters and the fixed inputs, of several sliders the lengths that all have."""
    known = tuple(name for name in INPUTS if name != "theta")
    _check_mapping("over", over, "{'ec': (0, 0.1)}")
    if sliders is None:
        check_inputs(caller, over, known)
        check_inputs(caller, fixed, known)
    else:
        fixed = {
            **{n: v for n, v in sliders.shared_lengths([*over, *fixed]).items() if n not in over},
            **fixed,
        }
    if not over:
        raise ValueError("over= is empty: name at least one parameter and its bounds, such as ec=(0, 0.1)")
    both = [name for name in over if name in fixed]
    if both:
        raise ValueError(f"{both[0]} is in over= and fixed at the same time")
    ends = {name: _pair(name, bounds) for name, bounds in over.items()}
    inputs, loads = loads_of({name: value for name, value in fixed.items() if value is not None})
    numbers = {name: _number(name, value) for name, value in inputs.items()}
    missing = [name for name in LENGTHS if name not in over and name not in numbers]
    if missing and sliders is None:
        raise TypeError(f"{caller}: {missing[0]} is missing (in over= or as a number)")
    loads = with_derivatives(loads, {**numbers, **{name: max(pair) for name, pair in ends.items()}})
    low, high = (np.array([pair[i] for pair in ends.values()]) for i in (0, 1))
    several = {} if sliders is None else {"sliders": sliders}
    return Space(tuple(over), low, high, {**numbers, **loads, **several}, branch, deadline)


def _check_mapping(name: str, inputs: Any, example: str) -> None:
    if not isinstance(inputs, Mapping):
        raise TypeError(f"{name} = {shown(inputs)}: expected a dict, such as {example}")


def _pair(name: str, bounds: Any) -> tuple[float, float]:
    try:
        first, last = bounds
    except (TypeError, ValueError) as error:
        raise type(error)(
            "over: " + named(name, bounds) + ": expected two finite bounds, the lower one first"
        ) from None
    try:
        low, high = _number(name, first), _number(name, last)
    except (TypeError, ValueError) as error:
        why = ": expected two finite bounds (" + message_of(error) + ")"
        raise type(error)("over: " + named(name, bounds) + why) from None
    if not low < high:
        raise ValueError("over: " + named(name, (low, high), "g") + ": the lower bound first, and smaller")
    return low, high


def _number(name: str, value: Any) -> float:
    return read(row_of(name), value, "optimize")


def limits_of(keep: Mapping[Any, Any]) -> list[Limit]:
    """The limits as functions that stay positive."""
    _check_mapping("keep", keep, "{'margin': (0.005, None)}")
    limits: list[Limit] = []
    for key, bounds in keep.items():
        if key in INPUTS:
            raise ValueError(f"keep: {key} is a parameter; its bounds go into over=")
        measure = checked(key)
        low, high = _ends(measure, bounds)
        if low is not None and high is not None and low >= high:
            if low > high:
                ends = f"keep: {text_of(measure)} = " + amount(measure, (low, high), "g")
                raise ValueError(ends + ": the lower bound first")
            limits.append(Limit(key, measure, 1.0, low, EQUAL))
            continue
        for bound, side in ((low, LOWER), (high, UPPER)):
            limits += [] if bound is None else side_limits(key, measure, bound, side)
    return limits


class AsArgument(NamedValue):
    """A number as it is written in a call: a text where it has a unit."""

    def text(self, system: UnitSystem | None = None) -> str:
        """The number in the units of a system; in SI units without."""
        text = super().text(system)
        return repr(text) if " " in text else text


def _ends(measure: Measure, bounds: Any) -> tuple[float | None, float | None]:
    """The ends of a limit, None where it has none; both are the value of an equation."""
    if not isinstance(bounds, (tuple, list)) or len(bounds) != 2:
        number = Message(AsArgument(measure, bounds))
        rule = ": a limit is (" + number + ", None), (None, " + number + ') or ("==", ' + number + ")"
        raise ValueError(f"keep: {text_of(measure)} = " + amount(measure, bounds) + rule)
    if isinstance(bounds[0], str) and bounds[0] == EQUATION:
        bounds = bounds[1], bounds[1]
    said = "finite, or None for no limit"
    low, high = (None if end is None else value_of(measure, end, "keep", said) for end in bounds)
    return low, high


def value_of(measure: Measure, value: Any, caller: str, limit: str = "a finite number") -> float:
    """A value of a measure in SI units."""
    return read(Input(text_of(measure), unit_of(measure), "limit", limit=limit), value, caller)


def side_limits(key: Any, measure: Measure, bound: float, side: str) -> list[Limit]:
    """measure >= bound, or <= bound; if it is the smallest, or the largest, of several, each of them is."""
    sides, sign = sides_of(measure), 1.0 if side == LOWER else -1.0
    if sides.largest == (side == LOWER):
        return [Limit(key, measure, sign, bound, side)]
    return [Limit(key, part, sign * own, own * bound, side) for part, own in sides.parts]
