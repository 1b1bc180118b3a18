"""A solved panel of time: the motion inside of it as series.

The rates of q and v are polynomials through their values at the Gauss nodes; q and v are the integrals, and
the law says what the rates must be there. `loops.newton` solves for them.
"""

from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from .loops.compiled import NODES
from .loops.cuts import NO_CUT
from .loops.march import RESTING

Array = NDArray[np.float64]
_X, _ = legendre.leggauss(NODES)
PLACES = (_X + 1.0) / 2.0  # on [0, 1]
SERIES = np.linalg.inv(legendre.legvander(_X, NODES - 1))  # values at the nodes -> Legendre series
ONCE = legendre.legint(np.eye(NODES), lbnd=-1, axis=0) / 2.0  # series -> series of its integral
RUNNING = legendre.legvander(_X, NODES) @ ONCE @ SERIES
INTEGRAL = ONCE @ SERIES  # values at the nodes -> series of their integral
ENDS = legendre.legvander(np.array([-1.0, 1.0]), NODES - 1) @ SERIES  # values at the nodes -> at both ends
TABLE = np.vstack([PLACES[None], RUNNING, INTEGRAL, SERIES[-2:], ENDS, SERIES, RUNNING.T])  # of `newton`


def basis(x: Array, degree: int) -> Array:
    """Legendre polynomials up to a degree, a row each, at places from -1 to 1."""
    if x.size == 1:  # without the cost of arrays
        return np.array(_basis_at(float(x[0]), degree))[:, None]
    rows = np.empty((degree + 1, x.size))
    rows[0], rows[1] = 1.0, x
    for n in range(1, degree):
        np.multiply(x, rows[n], out=rows[n + 1])
        rows[n + 1] *= (2 * n + 1) / (n + 1)
        rows[n + 1] -= n / (n + 1) * rows[n - 1]
    return rows


def _basis_at(x: float, degree: int) -> list[float]:
    """Legendre polynomials up to a degree at one place from -1 to 1."""
    values = [1.0, x]
    for n in range(1, degree):
        values.append(x * values[n] * ((2 * n + 1) / (n + 1)) - n / (n + 1) * values[n - 1])
    return values


class Record(NamedTuple):
    """Panels one after the other, as `loops.march` records them, and q, v and W at the end."""

    heads: Array
    series: Array
    ends: Array
    laws: Array
    last: Array

    @property
    def y(self) -> Array:
        """q, v and W at the starts."""
        return self.heads[:, 3:6]

    @property
    def rests(self) -> NDArray[np.bool_]:
        """True for panels on which nothing moves."""
        return np.asarray(self.ends[:, 0] == RESTING)

    @property
    def stretches(self) -> NDArray[np.intp]:
        """The number of the stretch of each panel: one law holds on it."""
        new = (self.ends[:-1, 0] != NO_CUT) | self.rests[1:]
        return np.concatenate([[0], np.cumsum(new)])
