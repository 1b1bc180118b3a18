"""The compiled loops of the energy form, and their constants."""

from functools import cache

import numpy as np

from ....compiler.llvm.loops import CompiledLoops
from ....support.panels import NODE, NODES, RUNNING, TO_COEFFICIENTS, WEIGHT, Array
from ....support.signals import finished
from . import follow

BLOCK = 8  # nodes among the turns of a block
MACLAURIN = (-1.0 / 24.0, 7.0 / 5760.0, -31.0 / 967680.0)  # by powers of the squared step
_MOTIONS = (
    *("f64[2]", "f64[2]", "f64[3]", "f64[2]", "f64[1]", "f64[1]", "f64[1]"),  # up to `most`
    *("f64[1]", "f64[1]", "f64[2]", "f64[2]", "f64[2]", "f64[2]"),  # the tables
    *("f64[2]", "f64[3]", "f64[2]", "f64[3]", "i64[2]"),  # buffers, pieces
    *("f64[2]", "f64[2]", "i8[1]", "i8[2]", "f64[2]"),
)


@cache
def motions() -> CompiledLoops:
    """The machine code of motions, compiled once a process."""
    return finished(lambda: CompiledLoops(follow.motions, _MOTIONS))


def _means() -> Array:
    """From values at the nodes to the mean of 2 s f(s) from 0 to xi = (1 + node)/2."""
    share, xi = 0.5 + 0.5 * NODE, 0.5 + 0.5 * NODE
    places = 2.0 * xi[:, None] * share - 1.0
    basis = np.polynomial.legendre.legvander(places, NODES - 1) @ TO_COEFFICIENTS
    return np.asarray(np.einsum("m,kmj->kj", WEIGHT * share, basis))


def _blocks() -> Array:
    """Nodes among the turns of a block and their weights (see `turns`), by Euler and Maclaurin's formula.

    The sum over a block is that of its midpoints, which is the integral but for slopes at both ends.
    """
    nodes, weights = np.polynomial.legendre.leggauss(BLOCK)
    bases = np.linalg.inv(np.polynomial.legendre.legvander(nodes, BLOCK - 1))
    rows = [nodes, 0.5 * weights]
    for power, share in enumerate(MACLAURIN, 1):
        slopes = np.polynomial.legendre.legder(bases, 2 * power - 1)
        ends = np.polynomial.legendre.legvander(np.array([-1.0, 1.0]), len(slopes) - 1) @ slopes
        rows.append(0.5 * share * 4.0**power * (ends[1] - ends[0]))
    return np.asarray(rows)


# By columns: see `follow`.
TABLES = tuple(
    np.ascontiguousarray(table)
    for table in (NODE, WEIGHT, TO_COEFFICIENTS.T, RUNNING.T, _means().T, _blocks())
)
