"""An optimisation over designs, in variables from 0 to 1: values and exact gradients.

Measures with a kink, such as one of |ec|, are the largest or the smallest of smooth ones.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...evaluation.reductions.own_measure import OwnMeasure
from ...mechanism.closed.limits import margins_of
from ...mechanism.names import LENGTHS
from ...support.deadline import Deadline
from ..measures import Measure, Measured, measured

Array = NDArray[np.float64]
LOWER, UPPER, EQUAL = "lower", "upper", "equal"


class Limit(NamedTuple):
    """sign * (measure - bound) >= 0, or = 0; `key` is what the caller calls it."""

    key: Any
    measure: Any
    sign: float
    bound: float
    side: str


class Space(NamedTuple):
    """The parameters that vary, between finite bounds, and those that are fixed."""

    names: tuple[str, ...]
    low: Array
    high: Array
    fixed: Mapping[str, Any]  # numbers, and loads that vary with the motion
    branch: int
    deadline: Deadline

    def designs(self, z: Array) -> dict[str, Any]:
        """Rows of variables as parameters by name."""
        x = self.low + np.atleast_2d(z) * (self.high - self.low)
        x = np.clip(x, self.low, self.high)
        return {**self.fixed, **{name: x[:, i] for i, name in enumerate(self.names)}}


class Evaluated(NamedTuple):
    """Values (designs, functions) and gradients (designs, functions, variables)."""

    value: Array
    slope: Array


class Functions:
    """Functions sign * (measure - bound) over a space of designs; the last result is cached."""

    def __init__(self, space: Space, rows: Sequence[tuple[Any, float, float]]) -> None:
        self.space = space
        self.rows = tuple(rows)
        self._last: tuple[bytes, Evaluated] | None = None

    def __call__(self, z: Array) -> Evaluated:
        """Values and gradients of all functions at rows of variables."""
        key = np.ascontiguousarray(z).tobytes()
        if self._last is None or self._last[0] != key:
            self._last = key, self._evaluated(np.atleast_2d(z))
        return self._last[1]

    def _evaluated(self, z: Array) -> Evaluated:
        space, count = self.space, len(z)
        space.deadline.check()
        designs = space.designs(z)
        proper = [row[0] for row in self.rows if isinstance(row[0], OwnMeasure) or not callable(row[0])]
        result = measured(proper, designs, space.branch) if proper else {}
        value = np.empty((count, len(self.rows)))
        slope = np.zeros((count, len(self.rows), len(space.names)))
        for number, (measure, sign, bound) in enumerate(self.rows):
            own = result[measure] if measure in result else measure(designs)
            value[:, number] = sign * (own.value - bound)
            for i, name in enumerate(space.names):
                if name in own.gradient:
                    width = space.high[i] - space.low[i]
                    slope[:, number, i] = sign * own.gradient[name] * width
        return Evaluated(value, slope)


Smooth = Measure | Callable[[Mapping[str, Any]], Measured]


class Sides(NamedTuple):
    """The measure is the largest (or else the smallest) of sign * smooth."""

    largest: bool
    parts: tuple[tuple[Smooth, float], ...]


def sides_of(measure: Measure) -> Sides:
    """The smooth parts of a measure; itself where it has no kink."""
    if isinstance(measure, tuple) and measure[0] == "absmax":
        return Sides(True, ((("max", measure[1]), 1.0), (("min", measure[1]), -1.0)))
    alone = Sides(True, ((measure, 1.0),))
    return _SIDES.get(measure, alone) if isinstance(measure, str) else alone


def _both(function: Callable[[Mapping[str, Any], float], Measured]) -> tuple[tuple[Smooth, float], ...]:
    return (lambda designs: function(designs, 1.0), 1.0), (lambda designs: function(designs, -1.0), 1.0)


def _margin(designs: Mapping[str, Any], side: float) -> Measured:
    """BC - AB - side ec."""
    ec, AB, BC = _lengths(designs)
    value = margins_of(side * ec, AB, BC)[0]
    one = np.ones_like(value)
    return Measured(value, {"ec": -side * one, "AB": -one, "BC": one})


def _lean(designs: Mapping[str, Any], side: float) -> Measured:
    """asin((AB + side ec)/BC)."""
    ec, AB, BC = _lengths(designs)
    reach = AB + side * ec
    with np.errstate(invalid="ignore", divide="ignore"):
        rise = np.sqrt(margins_of(side * ec, AB, BC)[0] * (BC + reach))
        return Measured(
            np.arctan2(reach, rise), {"ec": side / rise, "AB": 1.0 / rise, "BC": -reach / (BC * rise)}
        )


def _transmission(designs: Mapping[str, Any], side: float) -> Measured:
    """acos((AB + side ec)/BC)."""
    lean = _lean(designs, side)
    return Measured(np.pi / 2 - lean.value, {p: -slope for p, slope in lean.gradient.items()})


def _ratio(designs: Mapping[str, Any], side: float) -> Measured:
    """Advance over return angle, or return over advance."""
    result = measured(["advance_angle", "return_angle"], designs)
    over, under = (result[n] for n in (("advance_angle", "return_angle")[:: int(side)]))
    ratio = over.value / under.value
    slopes = {p: (over.gradient[p] - ratio * under.gradient[p]) / under.value for p in LENGTHS}
    return Measured(ratio, slopes)


def _lengths(designs: Mapping[str, Any]) -> tuple[Array, Array, Array]:
    ec, AB, BC = (np.asarray(designs[name], float) for name in LENGTHS)
    return ec, AB, BC


_SIDES = {
    "margin": Sides(False, _both(_margin)),
    "max_pressure_angle": Sides(True, _both(_lean)),
    "min_transmission_angle": Sides(False, _both(_transmission)),
    "time_ratio": Sides(True, _both(_ratio)),
}
