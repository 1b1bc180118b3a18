"""An optimisation over designs, in variables from 0 to 1: values and exact gradients."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...evaluation.reductions.own_measure import OwnMeasure
from ...support.deadline import Deadline
from ..measures import measured

Array = NDArray[np.float64]
LOWER, UPPER, EQUAL = "lower", "upper", "equal"


class Limit(NamedTuple):
    """sign * (measure - bound) >= 0, or = 0; `key` is what the caller calls it."""

    key: Any
    measure: Any
    sign: float
    bound: float
    side: str


class SmoothTerm(NamedTuple):
    """One of the smooth functions, sign * measure, whose maximum is minimised."""

    measure: Any  # a measure, or a function of designs
    sign: float


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
        found = measured(proper, designs, space.branch) if proper else {}
        value = np.empty((count, len(self.rows)))
        slope = np.zeros((count, len(self.rows), len(space.names)))
        for number, (measure, sign, bound) in enumerate(self.rows):
            own = found[measure] if measure in found else measure(designs)
            value[:, number] = sign * (own.value - bound)
            for i, name in enumerate(space.names):
                if name in own.gradient:
                    width = space.high[i] - space.low[i]
                    slope[:, number, i] = sign * own.gradient[name] * width
        return Evaluated(value, slope)
