"""DOP853 for one motion, in NumPy: steps that their error estimate accepts, and the state inside of each.

Step control, error norm and dense output are those of E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary
Differential Equations I, section II, as `dop853` has them for many designs, but for two guards against a
step whose estimate is small by accident: a second estimate (`_error`), and no step is longer than either of
the last two suggests; in a long motion a step has a smaller share of the tolerance (`share_of`).
`python -m benchmarks.steps` measures what they are worth.
"""

from collections.abc import Callable
from math import inf, nextafter, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .loops.dop853 import share_of
from .loops.tableau import E3, E5, EXTENDED, STAGES, A, B, C, D

Array = NDArray[np.float64]
Rate = Callable[[float, Any], Any]
SHARE = 0.1  # of the squared error of order 3
GROWS = np.array([0.0, 1.0, 1.0])  # an angle counts absolutely, however many turns; speed and work do not


class Dop853:
    """The integrator at the end of its last step: `t`, `y` and `status` ("running", "finished", "failed").

    rate         function (t, y) -> dy/dt
    rtol, atol   tolerances of each component
    size         of the motion: a radian, the root of its energy, its energy
    first_step   length of the first step; None: from the sizes of the state, its rate and its change
    """

    def __init__(
        self,
        rate: Rate,
        t: float,
        y: Array,
        t_bound: float,
        rtol: Array,
        atol: Array,
        size: Array,
        max_step: float,
        first_step: float | None,
    ) -> None:
        self.rate, self.t, self.y, self.t_bound = rate, t, y, t_bound
        self.rtol, self.atol, self.size, self.max_step = rtol, atol, size, max_step
        self.wished = inf  # the length that the step before suggested
        self.status = "running"
        self.before, self.start = y, t  # of the last step
        self.K = np.empty((EXTENDED, y.size))
        self.f = np.array(rate(t, y))
        self.h = self._first() if first_step is None else first_step

    def _norm(self, change: Array) -> float:
        scaled = change / (self.atol + np.abs(self.y) * self.rtol)
        return sqrt(float(scaled @ scaled) / scaled.size)

    def _first(self) -> float:
        """The length of the first step."""
        interval = self.t_bound - self.t
        if interval == 0.0:
            return 0.0
        d0, d1 = self._norm(self.y), self._norm(self.f)
        h = min(1e-6 if d0 < 1e-5 or d1 < 1e-5 else 0.01 * d0 / d1, interval)
        d2 = self._norm(np.array(self.rate(self.t + h, self.y + h * self.f)) - self.f) / h
        then = max(1e-6, h * 1e-3) if d1 <= 1e-15 and d2 <= 1e-15 else (0.01 / max(d1, d2)) ** 0.125
        return min(100.0 * h, then, interval, self.max_step)

    def step(self) -> str | None:
        """One step; why there is none, where the rate is no number however short the step."""
        if self.t == self.t_bound:
            self.before, self.start, self.status = self.y, self.t, "finished"
            return None
        least = 10.0 * (nextafter(self.t, inf) - self.t)
        h = min(max(self.h, least), self.max_step)
        rejected = False
        while h >= least:
            t = min(self.t + h, self.t_bound)
            h = t - self.t
            y = self._trial(h)
            turned = abs(y[0] - self.y[0]) / self.size[0]
            error = self._error(h, y) * share_of(turned / h * self.t_bound)
            if error < 1.0:
                growth = min(10.0, 0.9 * error**-0.125) if error > 0.0 else 10.0
                wish = h * (min(1.0, growth) if rejected else growth)
                self.h, self.wished = min(wish, self.wished), wish
                self.before, self.start = self.y, self.t
                self.t, self.y, self.f = t, y, self.K[STAGES].copy()
                self.status = "running" if t < self.t_bound else "finished"
                return None
            h *= max(0.2, 0.9 * error**-0.125)  # 0.2 for NaN
            rejected = True
        self.status = "failed"
        return "Required step size is less than spacing between numbers."

    def _stages(self, start: float, y: Array, h: float, first: int, last: int) -> None:
        K = self.K
        for s in range(first, last):
            K[s] = self.rate(start + C[s] * h, y + (K[:s].T @ A[s, :s]) * h)

    def _trial(self, h: float) -> Array:
        """The state after a step of this length; its stages are in K."""
        self.K[0] = self.f
        self._stages(self.t, self.y, h, 1, STAGES)
        y: Array = self.y + h * (self.K[:STAGES].T @ B)
        self.K[STAGES] = self.rate(self.t + h, y)
        return y

    def _error(self, h: float, y: Array) -> float:
        """The error of a step relative to the tolerance.

        Hairer's estimate is fifth^2/third: where the error of order 5 passes through 0, it says nothing. The
        relative error of order 3, squared, goes with h^8 too and passes through 0 elsewhere; q, v and W
        hang together, so the tightest tolerance counts. The share .1 was chosen on 10,000 designs. Where the
        crank would turn by more than 100 rad to the end, errors of many steps add up: `share_of`.
        """
        largest = np.maximum(np.abs(self.y), np.abs(y))
        scale = self.atol + largest * self.rtol
        K = self.K[: STAGES + 1].T
        rate = K @ E3
        fifth, third = (float(part @ part) for part in (K @ E5 / scale, rate / scale))
        if fifth == 0.0 and third == 0.0:
            return 0.0
        whole = self.size + largest * GROWS
        cubic = h * rate / whole
        guard = SHARE * float(cubic @ cubic) / float((scale / whole).min())
        return max(h * fifth / sqrt((fifth + 0.01 * third) * y.size), guard)

    def dense_output(self) -> "Inside":
        """The state inside of the last step, from three more stages."""
        h, K = self.t - self.start, self.K
        self._stages(self.start, self.before, h, STAGES + 1, EXTENDED)
        change = self.y - self.before
        lines = [change, h * K[0] - change, 2.0 * change - h * (self.f + K[0])]
        return Inside(self.start, h, self.before, np.vstack([*lines, h * (D @ K)]))


class Inside:
    """The polynomial of a step: the state at an instant, or a column for each of several."""

    def __init__(self, start: float, h: float, y: Array, lines: Array) -> None:
        self.start, self.h, self.y, self.lines = start, h, y, lines

    def __call__(self, t: Any) -> Array:
        """The state at t."""
        x = (np.asarray(t)[..., None] - self.start) / self.h
        total = np.zeros(np.broadcast_shapes(x.shape, self.y.shape))
        for k, line in enumerate(self.lines[::-1]):
            total = (total + line) * (x if k % 2 == 0 else 1.0 - x)
        state: Array = (total + self.y).T
        return state
