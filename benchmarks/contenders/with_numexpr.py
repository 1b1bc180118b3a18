"""numexpr: one expression for each name, which it evaluates in blocks; it shares subexpressions itself."""

from collections.abc import Sequence

import numexpr
import numpy as np
from sympy.printing.numpy import NumPyPrinter

from ..formulas import forms
from ..work import Array, Inputs, Work, largest, swept
from . import Run


def prepare(work: Work, inputs: Inputs, out: Sequence[Array] | None, threads: int) -> Run:
    """Arrays broadcast."""
    numexpr.set_num_threads(threads)
    points = swept(inputs, theta_first=False) if work.kind == "peak" else inputs
    printer = NumPyPrinter({"fully_qualified_modules": False})
    texts = [printer.doprint(form) for form in forms(work.names, points)]
    columns = points.broadcast()

    def values() -> Sequence[Array]:
        places = out or [np.empty(points.shape) for _ in texts]
        for text, place in zip(texts, places, strict=True):
            numexpr.evaluate(text, local_dict=columns, global_dict={}, out=place)
        return places

    def peak() -> Sequence[Array]:
        return largest(values()[0], points)

    return peak if work.kind == "peak" else values
