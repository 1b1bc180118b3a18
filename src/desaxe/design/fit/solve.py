"""The search: SciPy's trust region from several starts, with the exact Jacobian, among feasible designs."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...mechanism.messages import listed, named
from ...support.extras import needed
from .model import FittedModel
from .projection import ProjectedModel
from .unknowns import starts_of

Array = NDArray[np.float64]
STARTS = 17  # points whose cost is looked at
RUNS = 3  # of those, the best are followed
TOLERANCE = 1e-13
EVALUATIONS = 300
REDESCENDING = ("cauchy", "arctan")


class FitSolution(NamedTuple):
    """All unknowns at an optimum, the residuals there, its cost, and how often the model was evaluated."""

    x: Array
    residuals: Array
    cost: float
    evaluations: int


@np.errstate(all="ignore")  # squares beyond every double are no better than other bad fits
def solve(
    model: FittedModel, loss: str, seed: int, absolute: bool = False, before: FitSolution | None = None
) -> FitSolution:
    """The best optimum. ValueError where no start is feasible.

    Where sigma is known and the first start leads to residuals of that size, no other start is tried; nor is
    one after a solution with another sigma or loss.
    """
    unknowns = [unknown for unknown in model.unknowns if not unknown.linear]
    projected = ProjectedModel(model, loss)
    points = starts_of(unknowns, STARTS, seed) if before is None else before.x[None, ~projected.linear]
    runs = []
    if np.isfinite(_cost(projected.residuals(points[0]), loss)):
        runs += _run(model, loss, points[0])
    if not (runs and (len(points) == 1 or (absolute and _is_good(runs[0].residuals)))):
        costs = np.array([_cost(projected.residuals(point), loss) for point in points[1:]])
        order = np.argsort(costs, kind="stable")[:RUNS]
        runs += [run for k in order if np.isfinite(costs[k]) for run in _run(model, loss, points[1 + k])]
    if not runs:
        values = zip(unknowns, points[0], strict=True)
        where = listed([named(unknown.name, value, "g") for unknown, value in values])
        raise ValueError("fit: the mechanism cannot be assembled at every sample at the start: " + where)
    evaluations = sum(run.evaluations for run in (*runs, *([before] if before else [])))
    return min(runs, key=lambda run: run.cost)._replace(evaluations=evaluations)


def _run(model: FittedModel, loss: str, start: Array) -> list[FitSolution]:
    """The optimum from a start; none where the search meets derivatives beyond every double.

    A loss with many minima is searched from the optimum of soft_l1.
    """
    with needed("fit", "design"):
        from scipy.optimize import least_squares
    unknowns, evaluations = [unknown for unknown in model.unknowns if not unknown.linear], 0
    options: dict[str, Any] = {
        "bounds": ([u.low for u in unknowns], [u.high for u in unknowns]),
        "x_scale": [u.scale for u in unknowns],
        "max_nfev": EVALUATIONS,
        **dict.fromkeys(("ftol", "xtol", "gtol"), TOLERANCE),
    }
    for stage in ("soft_l1", loss) if loss in REDESCENDING else (loss,):
        projected = ProjectedModel(model, stage)
        try:
            run = least_squares(projected.residuals, start, projected.jacobian, loss=stage, **options)
        except (ValueError, np.linalg.LinAlgError):
            return []
        start, evaluations = run.x, evaluations + run.nfev
    return [FitSolution(projected.full(run.x), run.fun, run.cost, evaluations)]


def _is_good(residuals: Array) -> bool:
    """True if most residuals are within their sigma; a few outliers do not count."""
    return bool(np.median(np.abs(residuals)) < 1.0)  # 0.67 is expected


def _cost(residuals: Array, loss: str) -> float:
    if not np.isfinite(residuals).all():
        return float("inf")
    squares = residuals * residuals
    return float(np.sum(np.log1p(squares) if loss != "linear" else squares))
