"""Variable projection: biases and scales enter linearly, and are solved for at every trial of the others.

With the best linear unknowns c(z) the residuals depend on the nonlinear unknowns z alone. Their derivatives
lose what the linear ones can take up: J_z - A (A'WA)^-1 A'W J_z, with the columns A of the linear unknowns
and the weights W = rho' of a robust loss. That is Kaufman's form, whose gradient is exact.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .model import FittedModel
from .spread import weights_of

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
