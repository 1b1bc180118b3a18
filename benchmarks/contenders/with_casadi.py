"""CasADi: a function of symbols, mapped over columns without copies (`map` and `buffer`)."""

from collections.abc import Sequence

import casadi
import numpy as np

from ..blocks import block_size, filled, peaks
from ..formulas import lambdified
from ..work import Array, Inputs, Work, swept
from . import Run

SPELLING = {"sin": casadi.sin, "cos": casadi.cos, "sqrt": casadi.sqrt}


def prepare(work: Work, inputs: Inputs, out: Sequence[Array] | None, threads: int) -> Run:
    """Points are mapped in one go; other shapes go block by block."""
    points = swept(inputs, theta_first=False) if work.kind == "peak" else inputs
    symbols = [casadi.SX.sym(name) for name in points.columns]
    plain = casadi.Function("plain", symbols, list(lambdified(work.names, points, [SPELLING])(*symbols)))
    one_axis = len(points.shape) == 1
    count = points.shape[0] if one_axis else block_size(points)
    mapped = plain.map(count, "thread", threads) if threads > 1 else plain.map(count)
    buffer, trigger = mapped.buffer()

    def answer(rows: Sequence[Array], result: Sequence[Array]) -> None:
        for number, row in enumerate(rows):
            buffer.set_arg(number, memoryview(row))
        for number, row in enumerate(result):
            buffer.set_res(number, memoryview(row))
        trigger()

    def values() -> Sequence[Array]:
        places = out or [np.empty(points.shape) for _ in work.names]
        if one_axis:
            answer(list(points.columns.values()), places)
            return places
        return filled(points, answer, places)

    if work.kind == "peak":
        return lambda: peaks(points, answer)
    return values
