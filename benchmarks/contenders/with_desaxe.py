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
        found = dx.evaluate(
            names, **inputs.broadcast(), **inputs.scalars, accuracy=accuracy, threads=threads, out=places
        )
        return [found[name] for name in names]

    def prepared() -> Run:
        columns = inputs.columns
        call = dx.function(names, inputs=tuple(columns), accuracy=accuracy, **inputs.scalars)
        return lambda: call(*columns.values(), out=out)

    def grid() -> Sequence[Array]:
        found = dx.grid(
            names, **inputs.columns, **inputs.scalars, accuracy=accuracy, threads=threads, out=places
        )
        return [np.asarray(found[name]) for name in names]

    def peak() -> Sequence[Array]:
        found = dx.peak(names[0], **inputs.columns, **inputs.scalars, accuracy=accuracy)
        return [found["value"], found["theta"]]

    if work.kind == "prepared":
        return prepared()
    return {"values": values, "grid": grid, "peak": peak}[work.kind]
