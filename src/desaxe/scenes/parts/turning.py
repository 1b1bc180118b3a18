"""The designs of a scene that turn fully, and the angles that the others cannot reach."""

from collections.abc import Mapping
from math import pi, prod
from typing import Any, NamedTuple

import numpy as np

from ...design.feasibility.feasibility import feasibility
from ...evaluation.evaluate import evaluate
from ..reading.values import Value
from ..setting import columns_of

MOST_DESIGNS = 10_000_000  # that are looked at for feasibility; a sweep has the margin of all
MOST_SHOWN = 100  # designs that cannot turn fully, looked at one by one


class Infeasible(NamedTuple):
    """A design that cannot turn fully, and the ranges of crank angles [rad] that it cannot reach."""

    design: dict[str, float]
    gaps: tuple[tuple[float, float], ...]


class FeasibilityResult(NamedTuple):
    """The number of designs that turn fully, and the first ones that do not.

    `limit` is the largest |ec| with which the crank turns fully [m], where AB and BC are numbers.
    """

    designs: int
    turning: int
    infeasible: tuple[Infeasible, ...]
    limit: float | None


def feasibility_of(inputs: Mapping[str, Value]) -> FeasibilityResult | None:
    """The feasibility of the scene's designs; None without all lengths, or for too many designs."""
    lengths = {name: value for name, value in inputs.items() if name in ("ec", "AB", "BC")}
    count = prod(len(value) for value in lengths.values() if isinstance(value, tuple))
    if len(lengths) < 3 or count > MOST_DESIGNS:
        return None
    columns: dict[str, Any] = columns_of(lengths)
    margins: Any = evaluate("margin", **columns)
    rows = np.flatnonzero(margins < 0.0)
    designs = [{name: float(column[row]) for name, column in columns.items()} for row in rows[:MOST_SHOWN]]
    result = tuple(Infeasible(one, _gaps(feasibility(**one)["theta_intervals"])) for one in designs)
    AB, BC = inputs["AB"], inputs["BC"]
    limit = (
        None
        if isinstance(AB, tuple) or isinstance(BC, tuple)
        else feasibility(ec=0.0, AB=AB, BC=BC)["margin"]
    )
    return FeasibilityResult(margins.size, margins.size - rows.size, result, limit)


def _gaps(intervals: list[tuple[float, float]]) -> tuple[tuple[float, float], ...]:
    """The gaps of a turn between these intervals, starting at angles from 0 to 2 pi."""
    if not intervals:
        return ((0.0, 2.0 * pi),)
    starts = [start for start, _ in intervals[1:]] + [intervals[0][0] + 2.0 * pi]
    gaps = [(stop, start) for (_, stop), start in zip(intervals, starts, strict=True)]
    return tuple(sorted((a - 2.0 * pi, b - 2.0 * pi) if a >= 2.0 * pi else (a, b) for a, b in gaps))
