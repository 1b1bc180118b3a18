"""One panel of time: the rates at its Gauss nodes by Newton's method, and the motion inside of it as series.

The rates of q and v are polynomials through their values at the nodes; q and v are the integrals, and the law
says what the rates must be there. The matrix of Newton's method is made at the first guess, and again only
where the iteration is slow.
"""

from math import inf, isfinite
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from .law import Here, Law, Rates

Array = NDArray[np.float64]
NODES = 16
_X, _ = legendre.leggauss(NODES)
PLACES = (_X + 1.0) / 2.0  # on [0, 1]
SERIES = np.linalg.inv(legendre.legvander(_X, NODES - 1))  # values at the nodes -> Legendre series
ONCE = legendre.legint(np.eye(NODES), lbnd=-1, axis=0) / 2.0  # series -> series of its integral
RUNNING = legendre.legvander(_X, NODES) @ ONCE @ SERIES
WHOLE = (ONCE @ SERIES).sum(axis=0)  # Legendre polynomials are 1 at the end
INTEGRAL = ONCE @ SERIES  # values at the nodes -> series of their integral
ENDS = legendre.legvander(np.array([-1.0, 1.0]), NODES - 1)
ITERATIONS = 14
SLOW = 0.1  # of the step before: then the matrix is made anew
BLUR = 4e-16  # over cos(q)^2: the rounding of the rates next to a limit angle
ROUNDING = 4e-15  # of the size of a coordinate
TAIL = 30.0  # tolerances: the last terms of the rates, over the panel; its inside is far more exact
AHEAD = 1.3  # of a panel: so far its series guess the next one, from there on straight lines


def basis(x: Array, degree: int) -> Array:
    """Legendre polynomials up to a degree, a row each, at places from -1 to 1."""
    rows = np.empty((degree + 1, x.size))
    rows[0], rows[1] = 1.0, x
    for n in range(1, degree):
        np.multiply(x, rows[n], out=rows[n + 1])
        rows[n + 1] *= (2 * n + 1) / (n + 1)
        rows[n + 1] -= n / (n + 1) * rows[n - 1]
    return rows


class Panel(NamedTuple):
    """A solved panel: its law, start and length, and the series of q, v and W behind the start."""

    law: Law
    start: float
    h: float
    y: Array  # q, v, W at the start
    series: Array  # 3, NODES + 1: of what is added to them
    stop: float
    error: float = 0.0  # of the inside, in tolerances
    rates: Rates | None = None  # at the nodes

    def state(self, t: Any) -> Array:
        """q, v and W at an instant, or a column for each of several."""
        s = (np.asarray(t) - self.start) / self.h if self.h else np.zeros(np.shape(t))
        s = np.atleast_1d(s)
        moved = (self.series @ basis(2.0 * s - 1.0, NODES)) * (s != 0.0)  # at the start nothing is rounded
        found: Array = moved + self.y[:, None]
        return found if np.ndim(t) else found[:, 0]

    def end(self) -> Array:
        """q, v and W at the end of the whole panel."""
        whole: Array = self.y + self.series.sum(axis=1)
        return whole


class Scales(NamedTuple):
    """The tolerance, relative to a radian and to the largest speed in v so far."""

    rtol: float
    v: float


def resting(law: Law, start: float, stop: float, y: Array) -> Panel:
    """A panel in which nothing moves."""
    return Panel(law, start, stop - start, y, np.zeros((3, NODES + 1)), stop)


def _inverse(law: Law, here: Here, h: float, state: Array) -> Array | None:
    """The inverse of Newton's matrix; None where there is none."""
    matrix = np.empty((2, NODES, 2, NODES))
    for k, slopes in enumerate(law.jacobian(here, state[:NODES])):
        np.multiply(RUNNING, -h * slopes, out=matrix[k // 2, :, k % 2])
    square = matrix.reshape(2 * NODES, 2 * NODES)
    square.flat[:: 2 * NODES + 1] += 1.0
    try:
        inverse: NDArray[Any] = np.linalg.inv(square)
    except np.linalg.LinAlgError:
        return None
    return inverse if isfinite(inverse.sum()) else None


def solve(law: Law, t: float, h: float, y: Array, guess: Array, scales: Scales) -> Panel | None:
    """The panel of a length from a state; None where the iteration does not converge.

    guess   q and v at the nodes
    """
    nodes, state, start = t + h * PLACES, guess, np.repeat(y[:2], NODES)
    aim, before, inverse = max(0.02 * scales.rtol, ROUNDING), inf, None
    radian = max(1.0, abs(float(y[0])))
    for _ in range(ITERATIONS):
        here = law.here(nodes, state[:NODES], state[NODES:])
        rates = here.rates
        miss: NDArray[Any] = start - state
        miss[:NODES] += h * (RUNNING @ rates.q)
        miss[NODES:] += h * (RUNNING @ rates.v)
        if inverse is None:
            inverse = _inverse(law, here, h, state)
            if inverse is None:
                return None
        change = inverse @ miss
        top = max(scales.v, float(np.abs(state[NODES:]).max()))
        sizes = np.abs(change)
        size = max(float(sizes[:NODES].max()) / radian, float(sizes[NODES:].max()) / top if top else 0.0)
        if not size < inf:
            return None
        if size <= aim or (size <= 100.0 * aim and size > 0.5 * before):
            half = law.model.coordinate.half
            noise = BLUR * float(np.max((half / here.slope) ** 2)) if half else 0.0
            return _solved(law, t, h, y, rates, max(scales.rtol, noise), top)
        state = state + change
        if size > SLOW * before:
            if size > 2.0 * before and size > 1.0:
                return None
            inverse = None
        before = size
    return None


def _solved(law: Law, t: float, h: float, y: Array, rates: Rates, rtol: float, top: float) -> Panel | None:
    values = np.stack([rates.q, rates.v, rates.work])
    if not isfinite(values.sum()):
        return None
    tails = np.abs(values @ SERIES[-2:].T).max(axis=1) * h
    error = max(float(tails[0]), float(tails[1]) / top if top else 0.0) / (TAIL * rtol)
    return Panel(law, t, h, y, h * (values @ INTEGRAL.T), t + h, error, rates)


def ahead_of(panel: Panel, start: float, h: float) -> Array:
    """q and v at the nodes of the next panel, by the series of the one before, held to a share beyond it."""
    last = panel.start + AHEAD * panel.h
    t = start + h * PLACES
    state = panel.state(np.concatenate([np.minimum(t, last), [last, last - 1e-3 * panel.h]]))[:2]
    slopes = (state[:, -2] - state[:, -1]) / (1e-3 * panel.h)
    ahead: Array = (state[:, :NODES] + slopes[:, None] * np.maximum(t - last, 0.0)).reshape(-1)
    return ahead


def first_guess(law: Law, t: float, h: float, y: Array) -> Array:
    """q and v at the nodes if the rates stay what they are at the start."""
    q, bend = law.motion(t, float(y[0]), float(y[1]))
    v = float(law.rates(np.array([t]), y[:1], y[1:2]).v[0])
    places = h * PLACES
    curved = 0.5 * bend * places * places if q == 0.0 else 0.0
    return np.concatenate([y[0] + q * places + curved, y[1] + v * places])
