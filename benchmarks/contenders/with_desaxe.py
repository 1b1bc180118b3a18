"""desaxe, through `evaluate`, `function`, `grid` and `peak`, at each accuracy."""

from collections.abc import Sequence

import numpy as np

import desaxe as dx

from ..work import Array, Inputs, Work
from . import Run


def prepare(work: Work, inputs: Inputs, out: Sequence[Array] | None, threads: int, accuracy: str) -> Run:
    """The call that a user writes; without `out` a grid is an xarray.Dataset with its status."""
    names = list(work.names)
    places = dict(zip(names, out, strict=True)) if out else None

    def values() -> Sequence[Array]:
        result = dx.evaluate(
            names, **inputs.broadcast(), **inputs.scalars, accuracy=accuracy, threads=threads, out=places
        )
        return [result[name] for name in names]

    def prepared() -> Run:
        columns = inputs.columns
        call = dx.function(names, inputs=tuple(columns), accuracy=accuracy, **inputs.scalars)
        return lambda: call(*columns.values(), out=out)

    def grid() -> Sequence[Array]:
        result = dx.grid(
            names, **inputs.columns, **inputs.scalars, accuracy=accuracy, threads=threads, out=places
        )
        return [np.asarray(result[name]) for name in names]

    def peak() -> Sequence[Array]:
        result = dx.peak(names[0], **inputs.columns, **inputs.scalars, accuracy=accuracy)
        return [result["value"], result["theta"]]

    if work.kind == "prepared":
        return prepared()
    return {"values": values, "grid": grid, "peak": peak}[work.kind]
