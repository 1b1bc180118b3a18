"""The constants of the panels of `picard`: Gauss nodes, weights, integrals, Legendre series."""

from functools import cache

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

Array = NDArray[np.float64]
NODES = 16
LINE, WIDTH = 8, 40  # numbers of a line of the cache, and of a row


@cache
def table() -> Array:
    """A row for each node; behind them, rows that differ in the integrals of energies from rest.

    The integrals of its Lagrange polynomial from 0 to every node, their series, its place in [0, 1], its
    weight, its weights in the last two terms of a Legendre series (over twice the degree and one). From rest
    what is integrated is s times a smooth function, and 0 at s = 0 with it. Rows start where lines of the
    processor's cache do.
    """
    x, weights = legendre.leggauss(NODES)
    terms = 0.5 * weights[:, None] * legendre.legvander(x, NODES - 1)
    polynomials = terms * (2 * np.arange(NODES) + 1)
    series = np.array([0.5 * legendre.legint(row, lbnd=-1) for row in polynomials])
    by_s = [legendre.legint(legendre.legmul(row, [1.0, 1.0]), lbnd=-1) for row in polynomials]
    from_rest = 0.5 * np.array([legendre.legval(x, row) for row in by_s]) / (x[:, None] + 1.0)
    others = [series, 0.5 * (x[:, None] + 1.0), 0.5 * weights[:, None], terms[:, -2:]]
    integrals = legendre.legval(x, series.T), from_rest
    rows = np.vstack([np.hstack([one, *others]) for one in integrals])
    room = np.zeros(rows.shape[0] * WIDTH + LINE)
    start = -(room.ctypes.data // room.itemsize) % LINE
    table = room[start : start + rows.shape[0] * WIDTH].reshape(-1, WIDTH)
    table[:, : rows.shape[1]] = rows
    return table
