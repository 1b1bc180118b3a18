"""A quantity as a function of the inputs that vary: values, exact slopes, whether it is smooth."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from ...evaluation.evaluate import evaluate
from ...mechanism.status import ToleranceStatus
from ..measures import Measure, Measured, measured
from .uncertain import Array

KINK = 0.1  # of the first-order change: slopes that jump by more have no derivative
ROUNDING = 1e-11  # of a value


class SampledQuantity(NamedTuple):
    """A measure as a function of the varying inputs; of a quantity at a crank angle ("at", None, name)."""

    measure: Measure
    fixed: Mapping[str, Any]
    varying: tuple[str, ...]
    branch: int

    @property
    def at_point(self) -> str:
        """The name of a quantity at a crank angle; "" of a measure of the design."""
        return str(self.measure[2]) if isinstance(self.measure, tuple) and self.measure[1] is None else ""

    def values(self, columns: Mapping[str, Any]) -> Array:
        """The values over samples; NaN where undefined."""
        if not self.at_point:
            return np.asarray(self._measured(columns).value, float)
        result = evaluate(self.at_point, branch=self.branch, **self.fixed, **columns)
        return np.broadcast_to(result, len(next(iter(columns.values()))))

    def slopes(self, columns: Mapping[str, Any]) -> Array:
        """The exact first derivatives over samples, one column for each input that varies."""
        gradient = self._measured(columns).gradient
        size = len(next(iter(columns.values())))
        return np.stack([np.broadcast_to(gradient.get(p, 0.0), (size,)) for p in self.varying], -1)

    def _measured(self, columns: Mapping[str, Any]) -> Measured:
        return measured([self.measure], {**self.fixed, **columns}, self.branch)[self.measure]

    def beside(self, centre: Mapping[str, Any], steps: Array) -> "Beside":
        """Values and slopes up to two steps beside a point, along each input."""
        n = len(self.varying)
        moves = (np.eye(n)[:, None, :] * steps * np.arange(-2.0, 3.0)[:, None]).reshape(-1, n)
        columns = {p: centre[p] + moves[:, i] for i, p in enumerate(self.varying)}
        return Beside(steps, self.values(columns).reshape(n, 5), self.slopes(columns).reshape(n, 5, n))


class Beside(NamedTuple):
    """A function at -2, -1, 0, 1 and 2 steps along each of its inputs: values, and slopes by all of them."""

    steps: Array
    values: Array
    slopes: Array

    def status(self) -> ToleranceStatus:
        """The status of the function here: smooth, or the reason why it is not.

        Where it has slopes its value changes as they say, across a kink too; if not, it jumps.
        """
        if not (np.isfinite(self.values).all() and np.isfinite(self.slopes).all()):
            return ToleranceStatus.NO_DERIVATIVE
        along = np.einsum("iki->ik", self.slopes) * self.steps[:, None]
        missed = np.abs(np.diff(self.values) - 0.5 * (along[:, 1:] + along[:, :-1]))
        allowed = np.abs(np.diff(along)) + KINK * np.abs(along).max(axis=1, keepdims=True)
        rounding = ROUNDING * np.abs(self.values).max()
        if (missed > allowed + rounding).any():
            return ToleranceStatus.JUMP
        return ToleranceStatus.KINK if self._has_kink(rounding) else ToleranceStatus.OK

    def _has_kink(self, rounding: float) -> bool:
        """True if differences of the slopes over twice the steps are other quotients: half, across a kink."""
        near, far = (self.slopes[:, 2 + k] - self.slopes[:, 2 - k] for k in (1, 2))
        apart = np.abs(near - 0.5 * far) * self.steps
        return bool((apart > 2.0 * KINK * np.abs(self.slopes * self.steps).max() + rounding).any())
