"""SymPy's `lambdify` with common subexpressions shared, over NumPy arrays that broadcast."""

from collections.abc import Sequence

import numpy as np

from ..formulas import lambdified
from ..work import Array, Inputs, Work, largest, swept
from . import Run


def prepare(work: Work, inputs: Inputs, out: Sequence[Array] | None, threads: int) -> Run:
    """NumPy allocates its results and uses one core."""
    del out, threads
    points = swept(inputs, theta_first=False) if work.kind == "peak" else inputs
    function = lambdified(work.names, points, "numpy")
    columns = points.broadcast().values()

    def values() -> Sequence[Array]:
        with np.errstate(all="ignore"):
            answers: Sequence[Array] = function(*columns)
        return answers

    def peak() -> Sequence[Array]:
        return largest(values()[0], points)

    return peak if work.kind == "peak" else values
