"""The limits of the machine: storing a work's result; copying; the cost of a root, a division, a sine, a sum.

These run over a column that stays in the first cache, in loops that numba vectorises; sine and cosine are
the ones that desaxe writes into its loops.
"""

import math
from collections.abc import Sequence

import numba
import numpy as np

from desaxe.generated._helpers import sines

from ..work import DEGREE, TURNS, Array, Inputs, Work
from . import Run


def prepare(work: Work, inputs: Inputs, out: Sequence[Array] | None, threads: int) -> Run:
    """Fill the memory of a result, or repeat an operation over a column."""
    del threads
    if work.key == "copy":
        return _copied(inputs.columns["theta"])
    if work.kind == "limit":
        return _repeated(work.key, inputs.columns["theta"])
    shape = inputs.shape

    def fill() -> Sequence[Array]:
        places = out or [np.empty(shape) for _ in work.names]
        for place in places:
            place.fill(1.0)
        return places

    return fill


def _repeated(key: str, column: Array) -> Run:
    """TURNS times over the column."""
    kernels = {"sqrt": _roots, "divide": _quotients, "multiply_add": _polynomial}
    compiled = (
        sines if key == "sincos" else numba.njit(error_model="numpy", fastmath={"contract"})(kernels[key])
    )
    answers = [np.empty(column.size), np.empty(column.size)]

    def turns(x: Array, y: Array, z: Array, count: int) -> None:
        for _ in range(count):
            compiled(x, y, z)

    loop = numba.njit(turns)

    def run() -> Sequence[Array]:
        loop(column, *answers, TURNS)
        return answers

    return run


def _roots(x: Array, y: Array, _: Array) -> None:
    for i in range(x.size):
        y[i] = math.sqrt(x[i])


def _quotients(x: Array, y: Array, _: Array) -> None:
    for i in range(x.size):
        y[i] = 1.0 / x[i]


def _polynomial(x: Array, y: Array, _: Array) -> None:
    """DEGREE multiplications and additions at each point."""
    for i in range(x.size):
        here = x[i]
        total = here
        for _ in range(DEGREE):
            total = total * here + 0.5
        y[i] = total


def _copied(column: Array) -> Run:
    """A pass over memory: a double is read and a double is written."""
    target = np.zeros(column.size)

    def copy(x: Array, y: Array) -> None:
        for i in range(x.size):
            y[i] = 1.0 * x[i] + 0.0

    loop = numba.njit(copy)

    def run() -> Sequence[Array]:
        loop(column, target)
        return [target]

    return run
