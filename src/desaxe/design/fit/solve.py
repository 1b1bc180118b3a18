"""The search: SciPy's trust region from several starts, with the exact Jacobian, among feasible designs.

Biases and scales enter linearly, and are solved for at every trial of the others (variable projection). With
the best linear unknowns c(z) the residuals depend on the nonlinear unknowns z alone. Their derivatives lose
what the linear ones can take up: J_z - A (A'WA)^-1 A'W J_z, with the columns A of the linear unknowns and the
weights W = rho' of a robust loss. That is Kaufman's form, whose gradient is exact.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...mechanism.messages import listed, named
from ...support.extras import needed
from .model import FittedModel
from .spread import weights_of
from .unknowns import starts_of

Array = NDArray[np.float64]

ROUNDS = 100  # of reweighting, for a robust loss
CONVEX = 20  # of these first with soft_l1, whose minimum is the only one
SETTLED = 1e-12  # of the size of the residuals


class ProjectedModel:
    """The residuals of a model as a function of its nonlinear unknowns."""

    def __init__(self, model: FittedModel, loss: str) -> None:
        self.model, self.loss = model, loss
        self.linear = np.array([unknown.linear for unknown in model.unknowns])
        self.start = np.array([unknown.start for unknown in model.unknowns])

    def full(self, z: Array) -> Array:
        """All unknowns: the nonlinear ones, and the best linear ones for them."""
        x = self.start.copy()
        x[~self.linear] = z
        if not self.linear.any():
            return x
        rest = self.model.residuals(x)
        if np.isfinite(rest).all():
            x[self.linear] += _best(self.model.jacobian(x)[:, self.linear], rest, self.loss)
        return x

    def residuals(self, z: Array) -> Array:
        """The residuals with the best linear unknowns."""
        return self.model.residuals(self.full(z))

    def jacobian(self, z: Array) -> Array:
        """The derivatives of `residuals` by the nonlinear unknowns."""
        x = self.full(z)
        whole = self.model.jacobian(x)
        columns, slopes = whole[:, self.linear], whole[:, ~self.linear]
        if not self.linear.any():
            return slopes
        root = np.sqrt(weights_of(self.model.residuals(x), self.loss))[:, None]
        return np.asarray(slopes - columns @ np.linalg.lstsq(root * columns, root * slopes)[0])


def _best(columns: Array, residuals: Array, loss: str) -> Array:
    """The change of the linear unknowns that makes the loss least; the smallest where several do."""
    sizes = np.linalg.norm(columns, axis=0)
    scaled = columns / np.where(sizes > 0.0, sizes, 1.0)
    change = _least_squares(scaled, residuals, np.ones_like(residuals))
    for step in range(ROUNDS if loss != "linear" else 0):
        rest = residuals + scaled @ change
        weights = weights_of(rest, "soft_l1" if step < CONVEX else loss)
        before, change = change, _least_squares(scaled, residuals, weights)
        if step >= CONVEX and np.abs(change - before).max() <= SETTLED * np.linalg.norm(rest):
            break
    return np.asarray(change / np.where(sizes > 0.0, sizes, 1.0))


def _least_squares(columns: Array, residuals: Array, weights: Array) -> Any:
    root = np.sqrt(weights)
    return np.linalg.lstsq(root[:, None] * columns, -root * residuals)[0]


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
