"""numba over the lambdified code: a function of one point, called in a nest of loops over the axes."""

import math
from collections.abc import Callable, Sequence
from typing import Any

import numba
import numpy as np

from ..formulas import lambdified
from ..work import Array, Inputs, Work, swept
from . import Run


def prepare(work: Work, inputs: Inputs, out: Sequence[Array] | None, threads: int) -> Run:
    """The outermost loop is shared by threads."""
    numba.set_num_threads(min(threads, numba.config.NUMBA_NUM_THREADS))  # no more than cores
    peak = work.kind == "peak"
    points = swept(inputs, theta_first=False) if peak else inputs
    point = numba.njit(error_model="numpy")(lambdified(work.names, points, "math"))
    text = _peak(points) if peak else _nest(work.names, points)
    loop = _compiled(text, {"point": point}, parallel=threads > 1)
    columns = points.columns.values()

    def values() -> Sequence[Array]:
        places = out or [np.empty(points.shape) for _ in work.names]
        loop(*columns, *places)
        return places

    def largest() -> Sequence[Array]:
        places = np.empty(points.shape[0]), np.empty(points.shape[0])
        loop(*columns, *places)
        return places

    return largest if peak else values


def _compiled(text: str, names: dict[str, Any], parallel: bool) -> Callable[..., None]:
    space: dict[str, Any] = {"prange": numba.prange, "math": math, **names}
    exec(text, space)
    made: Callable[..., None] = numba.njit(error_model="numpy", parallel=parallel)(space["loop"])
    return made


def _nest(names: Sequence[str], points: Inputs) -> str:
    """A loop for each axis, results stored at its end."""
    indices = [f"i{axis}" for axis in range(len(points.shape))]
    places = ", ".join(f"{name}[{', '.join(indices)}]" for name in names)
    return _loops(points, [*points.columns, *names], f"{places}, = point({_arguments(points)})")


def _peak(points: Inputs) -> str:
    """Designs, and the angles of each; nothing is stored but the best."""
    head = f"def loop({', '.join(points.columns)}, best, where):\n    for i0 in prange(best.size):\n"
    return head + (
        "        top, at = -1.0, 0.0\n"
        "        for i1 in range(theta.size):\n"
        f"            magnitude = abs(point({_arguments(points)})[0])\n"
        "            if magnitude > top:\n"
        "                top, at = magnitude, theta[i1]\n"
        "        best[i0], where[i0] = top, at\n"
    )


def _loops(points: Inputs, parameters: Sequence[str], body: str) -> str:
    text, first = f"def loop({', '.join(parameters)}):\n", {axis: n for n, axis in points.axis.items()}
    for axis in range(len(points.shape)):
        counter = "range" if axis else "prange"
        text += "    " * (axis + 1) + f"for i{axis} in {counter}({first[axis]}.size):\n"
    return text + "    " * (len(points.shape) + 1) + body + "\n"


def _arguments(points: Inputs) -> str:
    return ", ".join(f"{name}[i{points.axis[name]}]" for name in points.columns)
