"""The constants of the panels of `picard`: Gauss nodes, weights, integrals, Legendre series."""

from functools import cache

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

Array = NDArray[np.float64]
NODES = 16


@cache
def table() -> Array:
    """A row for each node.

    Its place in [0, 1], its weight, its weights in the last two terms of a Legendre series (over twice the
    degree and one), the integrals of its Lagrange polynomial from 0 to every node, and their series.
    """
    x, weights = legendre.leggauss(NODES)
    polynomials = legendre.legvander(x, NODES)
    degrees = np.arange(NODES)
    terms = 0.5 * weights[:, None] * polynomials[:, :NODES]
    series = np.zeros((NODES, NODES + 1))
    for j, row in enumerate(terms * (2 * degrees + 1)):
        series[j] = 0.5 * legendre.legint(row, lbnd=-1)
    integrals = series @ polynomials.T
    return np.ascontiguousarray(
        np.hstack([0.5 * (x[:, None] + 1.0), 0.5 * weights[:, None], terms[:, -2:], integrals, series])
    )
