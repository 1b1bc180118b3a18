"""heyoka's `cfunc`: its own derivatives, its own vectors, rows of inputs to rows of outputs.

Sensitivities are heyoka's (`diff_tensors`), which it computes in about 0.6 of the time of SymPy's.
"""

from collections.abc import Sequence
from itertools import product
from typing import Any

import heyoka
import numpy as np

from desaxe.mechanism.names import parts

from ..blocks import filled, peaks
from ..formulas import forms
from ..work import Array, Inputs, Work, swept
from . import Run


def prepare(work: Work, inputs: Inputs, out: Sequence[Array] | None, threads: int, fast_math: bool) -> Run:
    """Points as the matrix that heyoka takes; other shapes go block by block."""
    heyoka.set_nthreads(threads)
    points = swept(inputs, theta_first=False) if work.kind == "peak" else inputs
    variables = [heyoka.expression(name) for name in points.columns]
    function = heyoka.cfunc(_expressions(work.names, points, variables), variables, fast_math=fast_math)

    def answer(rows: Array, result: Array) -> None:
        function(rows, outputs=result)

    if work.kind == "peak":
        return lambda: peaks(points, answer)
    if len(points.shape) > 1:
        return lambda: filled(points, answer, out or [np.empty(points.shape) for _ in work.names])
    matrix, answers = np.array(list(points.columns.values())), np.empty((len(work.names), *points.shape))

    def whole() -> Sequence[Array]:
        function(matrix, outputs=answers)
        return list(answers)

    return whole


def _expressions(names: Sequence[str], points: Inputs, variables: list[Any]) -> list[Any]:
    """The quantities from SymPy, their derivatives from heyoka."""
    quantities = list(dict.fromkeys(parts(name)[0] for name in names))
    values = [heyoka.from_sympy(form) for form in forms(quantities, points)]
    order = max(len(parts(name)[1]) for name in names)
    if not order:
        return values
    tensors = heyoka.diff_tensors(values, variables, diff_order=order)
    result = {}
    for number, quantity in enumerate(quantities):
        for wrt in (w for length in range(order + 1) for w in product(points.columns, repeat=length)):
            result[quantity, tuple(sorted(wrt))] = tensors[
                [number, *(list(wrt).count(name) for name in points.columns)]
            ]
    return [result[parts(name)[0], tuple(sorted(parts(name)[1]))] for name in names]
