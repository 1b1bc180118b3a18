"""Uncertainty of a fit: covariance, and the directions of the unknowns that the data do not determine.

Columns of the Jacobian are scaled by the unknowns' sizes, so that its singular values are the reciprocals of
relative uncertainties. A direction is left open where its singular value is 0 to rounding.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
OPEN = 1e-9  # of the largest singular value
SMALL = 1e-4  # weights below this are left out of a direction


class Uncertainty(NamedTuple):
    """The covariance of the unknowns, and each open direction as name -> relative weight."""

    covariance: Array
    unidentified: list[dict[str, float]]


def spread_of(jacobian: Array, sizes: Array, names: Sequence[str], variance: float) -> Uncertainty:
    """The spread of estimates whose residuals have this variance; infinite along open directions."""
    few = len(jacobian) < len(names)  # samples: then open directions are among the further rows
    _, singular, rows = np.linalg.svd(jacobian * sizes, full_matrices=few)
    singular = np.concatenate([singular, np.zeros(len(names) - singular.size)])
    is_open = singular <= OPEN * max(singular[0], np.finfo(float).tiny)
    known = rows[~is_open]
    covariance = (known.T / singular[~is_open] ** 2) @ known * variance * np.outer(sizes, sizes)
    loose = np.zeros(len(names), bool)
    directions = []
    for row in _sparse(rows[is_open]):
        top = row[np.argmax(np.abs(row))]
        weights = {name: float(w / top) for name, w in zip(names, row, strict=True) if abs(w / top) > SMALL}
        loose |= np.abs(row / top) > SMALL
        directions.append(weights)
    covariance[loose, :] = covariance[:, loose] = np.nan
    covariance[loose, loose] = np.inf
    return Uncertainty(covariance, directions)


def _sparse(rows: Array) -> Array:
    """A basis of the same space in which each direction involves few unknowns (row echelon form)."""
    rows, done = rows.copy(), 0
    for column in range(rows.shape[1] if len(rows) > 1 else 0):
        if done == len(rows):
            break
        pivot = done + int(np.argmax(np.abs(rows[done:, column])))
        if abs(rows[pivot, column]) < 1e-8:
            continue
        rows[[done, pivot]] = rows[[pivot, done]]
        rows[done] /= rows[done, column]
        others = np.arange(len(rows)) != done
        rows[others] -= np.outer(rows[others, column], rows[done])
        done += 1
    return rows


def inflation(residuals: Array, loss: str) -> float:
    """Inflation of the covariance by a robust loss: mean(psi^2)/mean(psi')^2 (Huber's M-estimates)."""
    if loss == "linear":
        return 1.0
    z = residuals * residuals
    first, second = _RHO[loss](z)
    psi, slope = residuals * first, first + 2.0 * z * second
    return float(np.mean(psi * psi) / np.mean(slope) ** 2)


def weights_of(residuals: Array, loss: str) -> Array:
    """The weight rho' that a loss gives the square of each residual."""
    return np.ones_like(residuals) if loss == "linear" else np.asarray(_RHO[loss](residuals * residuals)[0])


def offset_of(jacobian: Array, residuals: Array, least: float) -> float:
    """The scaled gradient, Bates and Watts' relative offset: the next Gauss-Newton step in standard errors.

    These are from the residuals beside the tangent plane, or from `least` where they are smaller.
    """
    sizes = np.linalg.norm(jacobian, axis=0)
    left, singular, _ = np.linalg.svd(jacobian[:, sizes > 0.0] / sizes[sizes > 0.0], full_matrices=False)
    plane = left[:, singular > OPEN * singular.max(initial=0.0)]
    along = plane.T @ residuals
    beside = np.linalg.norm(residuals - plane @ along) / np.sqrt(max(residuals.size - along.size, 1))
    return float(np.linalg.norm(along) / np.sqrt(max(along.size, 1)) / max(beside, least))


def _huber(z: Array) -> tuple[Array, Array]:
    outside = z > 1.0
    root = np.sqrt(np.where(outside, z, 1.0))
    return np.where(outside, 1.0 / root, 1.0), np.where(outside, -0.5 / root**3, 0.0)


# rho'(z) and rho''(z) of SciPy's losses.
_RHO: dict[str, Any] = {
    "soft_l1": lambda z: ((1.0 + z) ** -0.5, -0.5 * (1.0 + z) ** -1.5),
    "huber": _huber,
    "cauchy": lambda z: (1.0 / (1.0 + z), -1.0 / (1.0 + z) ** 2),
    "arctan": lambda z: (1.0 / (1.0 + z * z), -2.0 * z / (1.0 + z * z) ** 2),
}
LOSSES = ("linear", *_RHO)
