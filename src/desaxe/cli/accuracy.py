"""`desaxe doctor --accuracy`: values of this installation beside 200 frozen truths."""

from math import isfinite, ulp
from typing import Any, NamedTuple

from ..support.template import file_text

INPUTS = ("theta", "ec", "AB", "BC", "omega0", "alpha")
COPIES = 64  # of a point in an array: enough to compile instead of computing them one by one


class FrozenTruth(NamedTuple):
    """The true value of a quantity at a point, rounded, and the error that is promised there [ulp]."""

    name: str
    branch: int
    point: dict[str, Any]
    value: float
    promised: float

    def share(self, value: float) -> float:
        """The error of a value as a share of the promise; the truth itself is rounded by half an ulp."""
        if not isfinite(value):
            return float("inf")
        return max(0.0, abs(value - self.value) / ulp(self.value) - 0.5) / self.promised


def truths() -> list[FrozenTruth]:
    """The table, as `python -m benchmarks.accuracy.freeze` wrote it."""
    rows = (line.split() for line in file_text(__package__, "truths.txt").splitlines())
    return [
        FrozenTruth(
            name,
            int(branch),
            dict(zip(INPUTS, map(float, numbers[:-2]), strict=True)),
            float(numbers[-2]),
            float(numbers[-1]),
        )
        for name, branch, *numbers in rows
    ]


def worst_shares() -> dict[str, float]:
    """The largest error of single points and of arrays, as shares of the promise."""
    import numpy as np

    from ..evaluation.evaluate import evaluate

    rows, of_arrays = truths(), []
    of_points = [row.share(evaluate(row.name, branch=row.branch, **row.point)) for row in rows]
    for key in dict.fromkeys((row.name, row.branch) for row in rows):
        some = [row for row in rows if (row.name, row.branch) == key] * COPIES
        columns: dict[str, Any] = {name: np.array([row.point[name] for row in some]) for name in INPUTS}
        values = evaluate(key[0], branch=key[1], **columns).tolist()
        of_arrays += [row.share(value) for row, value in zip(some, values, strict=True)]
    return {"points": max(of_points), "arrays": max(of_arrays)}
