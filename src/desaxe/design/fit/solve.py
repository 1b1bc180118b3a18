"""The search: SciPy's trust region from several starts, with the exact Jacobian, among feasible designs."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...mechanism.spoken import named
from ...support.extras import needed
from .model import FittedModel
from .unknowns import starts_of

Array = NDArray[np.float64]
STARTS = 17  # points whose cost is looked at
RUNS = 3  # of those, the best are followed
TOLERANCE = 1e-13
EVALUATIONS = 300


@np.errstate(all="ignore")  # squares beyond every double are no better than other bad fits
def solve(model: FittedModel, loss: str, seed: int, absolute: bool = False) -> Any:
    """SciPy's result at the best optimum. ValueError where no start is feasible.

    Where sigma is known and the given start leads to residuals of that size, no other start is tried.
    """
    options: dict[str, Any] = {
        "bounds": ([u.low for u in model.unknowns], [u.high for u in model.unknowns]),
        "x_scale": [u.scale for u in model.unknowns],
        "jac": model.jacobian,
        "loss": loss,
        "max_nfev": EVALUATIONS,
        **dict.fromkeys(("ftol", "xtol", "gtol"), TOLERANCE),
    }
    points = starts_of(model.unknowns, STARTS, seed)
    runs = []
    if np.isfinite(_cost(model.residuals(points[0]), loss)):
        runs += _run(model, points[0], options)
        if runs and (len(points) == 1 or (absolute and _is_good(runs[0].fun))):
            return _best(runs)
    costs = np.array([_cost(model.residuals(point), loss) for point in points[1:]])
    order = np.argsort(costs, kind="stable")[:RUNS]
    runs += [run for k in order if np.isfinite(costs[k]) for run in _run(model, points[1 + k], options)]
    if not runs:
        values = zip(model.names, points[0], strict=True)
        where = ", ".join(f"{named(name, value, 'g')}" for name, value in values)
        raise ValueError(f"fit: the mechanism cannot be assembled at every sample at the start: {where}")
    return _best(runs)


def _run(model: FittedModel, start: Array, options: dict[str, Any]) -> list[Any]:
    """SciPy's result from a start; none where it meets derivatives beyond every double."""
    with needed("fit", "design"):
        from scipy.optimize import least_squares
    try:
        return [least_squares(model.residuals, start, **options)]
    except (ValueError, np.linalg.LinAlgError):
        return []


def _best(runs: list[Any]) -> Any:
    best = min(runs, key=lambda run: run.cost)
    best.evaluations = sum(run.nfev for run in runs)
    return best


def _is_good(residuals: Array) -> bool:
    """True if most residuals are within their sigma; a few outliers do not count."""
    return bool(np.median(np.abs(residuals)) < 1.0)  # 0.67 is expected


def _cost(residuals: Array, loss: str) -> float:
    if not np.isfinite(residuals).all():
        return float("inf")
    squares = residuals * residuals
    return float(np.sum(np.log1p(squares) if loss != "linear" else squares))
