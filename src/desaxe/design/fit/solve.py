"""The search: SciPy's trust region from several starts, with the exact Jacobian, among feasible designs.

Biases and scales enter linearly: at each start they are the best ones for the others, and a step of Gauss and
Newton has them exactly.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...mechanism.messages import listed, named
from ...support.extras import needed
from .model import FittedModel
from .unknowns import starts_of

Array = NDArray[np.float64]

STARTS = 17  # points whose cost is looked at
RUNS = 3  # of those, the best are followed
TOLERANCE = 1e-15
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
    points = starts_of(model.unknowns, STARTS, seed) if before is None else before.x[None]
    points = np.array([_with_linear(model, point) for point in points])
    costs = np.array([_cost(model.residuals(point), loss) for point in points])
    runs = _run(model, loss, points[0]) if np.isfinite(costs[0]) else []
    if not (runs and (len(points) == 1 or (absolute and _is_good(runs[0].residuals)))):
        order = 1 + np.argsort(costs[1:], kind="stable")[:RUNS]
        runs += [run for k in order if np.isfinite(costs[k]) for run in _run(model, loss, points[k])]
    if not runs:
        values = zip(model.unknowns, points[0], strict=True)
        where = listed([named(unknown.name, value, "g") for unknown, value in values if not unknown.linear])
        raise ValueError("fit: the mechanism cannot be assembled at every sample at the start: " + where)
    evaluations = sum(run.evaluations for run in (*runs, *([before] if before else [])))
    return min(runs, key=lambda run: run.cost)._replace(evaluations=evaluations)


def _with_linear(model: FittedModel, x: Array) -> Array:
    """The unknowns with the linear ones that fit best beside the others, the smallest where several do."""
    linear, rest = [unknown.linear for unknown in model.unknowns], model.residuals(x)
    if any(linear) and np.isfinite(rest).all():
        columns = model.jacobian(x)[:, linear]
        sizes = np.linalg.norm(columns, axis=0)
        sizes[sizes == 0.0] = 1.0
        x = x.copy()
        x[linear] -= np.linalg.lstsq(columns / sizes, rest)[0] / sizes
    return x


def _run(model: FittedModel, loss: str, start: Array) -> list[FitSolution]:
    """The optimum from a start; none where the search meets derivatives beyond every double.

    A loss with many minima is searched from the optimum of soft_l1.
    """
    with needed("fit", "design"):
        from scipy.optimize import least_squares
    unknowns, evaluations = model.unknowns, 0
    options: dict[str, Any] = {
        "bounds": ([u.low for u in unknowns], [u.high for u in unknowns]),
        "x_scale": [u.scale for u in unknowns],
        "max_nfev": EVALUATIONS,
        **dict.fromkeys(("ftol", "xtol", "gtol"), TOLERANCE),
    }
    for stage in ("soft_l1", loss) if loss in REDESCENDING else (loss,):
        try:
            run = least_squares(model.residuals, start, model.jacobian, loss=stage, **options)
        except (ValueError, np.linalg.LinAlgError):
            return []
        start, evaluations = run.x, evaluations + run.nfev
    return [FitSolution(run.x, run.fun, run.cost, evaluations)]


def _is_good(residuals: Array) -> bool:
    """True if most residuals are within their sigma; a few outliers do not count."""
    return bool(np.median(np.abs(residuals)) < 1.0)  # 0.67 is expected


def _cost(residuals: Array, loss: str) -> float:
    if not np.isfinite(residuals).all():
        return float("inf")
    squares = residuals * residuals
    return float(np.sum(np.log1p(squares) if loss != "linear" else squares))
