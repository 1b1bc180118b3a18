"""A quantity as a function of the inputs that vary: values, exact slopes, whether it is smooth."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from ...evaluation.evaluate import evaluate
from ...mechanism.status import ToleranceStatus
from ..measures import Measure, Measured, measured
from .uncertain import Array

KINK = 0.1  # of the first-order change: slopes that jump by more have no derivative
FINE = 5  # values along each input next to the means
WITHIN = 65  # the same over its tolerance
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
        if self.at_point:
            result = evaluate(self.at_point, branch=self.branch, **self.fixed, **columns)
        else:
            result = np.asarray(self._measured(columns).value, float)
        return np.broadcast_to(result, len(next(iter(columns.values()))))

    def slopes(self, columns: Mapping[str, Any]) -> Array:
        """The exact first derivatives over samples, one column for each input that varies."""
        gradient = self._measured(columns).gradient
        size = len(next(iter(columns.values())))
        return np.stack([np.broadcast_to(gradient.get(p, 0.0), (size,)) for p in self.varying], -1)

    def _measured(self, columns: Mapping[str, Any]) -> Measured:
        return measured([self.measure], {**self.fixed, **columns}, self.branch)[self.measure]

    def along(self, centre: Mapping[str, Any], steps: Array, count: int) -> "Along":
        """Sample values and slopes at equal steps along each input, around a point."""
        n = len(self.varying)
        moves = (np.eye(n)[:, None, :] * steps * (np.arange(count) - count // 2)[:, None]).reshape(-1, n)
        columns = {p: centre[p] + moves[:, i] for i, p in enumerate(self.varying)}
        return Along(steps, self.values(columns).reshape(n, count), self.slopes(columns).reshape(n, count, n))

    def status(self, centre: Mapping[str, Any], fine: Array, reach: Array) -> ToleranceStatus:
        """The status at a point: smooth next to it and without a jump within reach, or the reason."""
        beside = self.along(centre, fine, FINE)
        if not beside.is_known:
            return ToleranceStatus.NO_DERIVATIVE
        wide = self.along(centre, 2.0 * reach / (WITHIN - 1), WITHIN)
        if beside.jumps or wide.jumps:
            return ToleranceStatus.JUMP
        return ToleranceStatus.KINK if beside.has_kink else ToleranceStatus.OK


class Along(NamedTuple):
    """A function at equal steps along each of its inputs: values, and slopes by all of them."""

    steps: Array
    values: Array
    slopes: Array

    @property
    def is_known(self) -> bool:
        """True where all values and slopes are finite."""
        return bool(np.isfinite(self.values).all() and np.isfinite(self.slopes).all())

    @property
    def jumps(self) -> bool:
        """True where a value changes as its slopes do not say; across a kink it does."""
        change = np.einsum("iki->ik", self.slopes) * self.steps[:, None]
        with np.errstate(invalid="ignore"):
            missed = np.abs(np.diff(self.values) - 0.5 * (change[:, 1:] + change[:, :-1]))
            allowed = np.abs(np.diff(change)) + KINK * np.nanmax(np.abs(change), axis=1, keepdims=True)
            return bool((missed > allowed + self._rounding).any())

    @property
    def _rounding(self) -> float:
        return float(ROUNDING * np.nanmax(np.abs(self.values)))

    @property
    def has_kink(self) -> bool:
        """True if differences of the slopes over twice the steps are other quotients: half, across a kink."""
        near, far = (self.slopes[:, 2 + k] - self.slopes[:, 2 - k] for k in (1, 2))
        apart = np.abs(near - 0.5 * far) * self.steps
        return bool((apart > 2.0 * KINK * np.abs(self.slopes * self.steps).max() + self._rounding).any())
