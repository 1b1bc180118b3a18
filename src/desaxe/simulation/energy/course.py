"""Speeds, accelerations and energies along motions, from coordinates and their rates.

at       rows per design: M_eff, the torque that moves the crank, M_eff_wrt_theta, Y and potential energy
loads    a row per design: torque and force, NaN where they are tables; half of the arc
numbers  of `follow`
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
LOST_DIGITS = 0.03  # of dtheta/dx at most: of angles so near to a limit angle
ROUNDED = 2e-17  # see `residual`
ANGLE = 2.2e-16  # of an angle and of a radian: how it is rounded


def accelerations(slope: Array, at: Array, omega: Array) -> Array:
    """The accelerations of the crank; its speeds take the places of the rates behind the start."""
    omega[:, 1:] *= slope[:, 1:]
    alpha = np.empty(omega.shape)
    alpha[:, 1:] = (at[:, 1, 1:] - 0.5 * at[:, 2, 1:] * omega[:, 1:] ** 2) / at[:, 0, 1:]
    return alpha


def account(
    theta: Array, slope: Array, at: Array, loads: Array, numbers: Array, omega: Array, alpha: Array
) -> Array:
    """Rows of end (free), largest energy residual, work, and the residual that rounding makes."""
    torque, force, half = (column[:, None] for column in loads.T)
    kinetic, Y, potential = 0.5 * at[:, 0] * omega**2, at[:, 3], at[:, 4]
    energy = kinetic + potential
    gained, tables = energy - energy[:, :1], np.isnan(torque + force)
    pushed = np.where(force == 0.0, 0.0, force * (Y - Y[:, :1]))
    work = np.where(tables, gained, torque * (theta - theta[:, :1]) + pushed)
    known = ~np.isnan(energy)
    # Next to a limit angle M_eff has lost the digits that would tell.
    exact = known & (np.abs(slope) >= LOST_DIGITS * half)
    exact[:, 0] = False
    end = numbers[:, 2] - kinetic[:, 0] + potential[:, -1] - potential[:, 0]
    work[:, -1] = np.where(tables[:, 0], end, work[:, -1])
    off = _largest(np.abs(work - gained), exact)
    bits = ANGLE * (1.0 + np.abs(theta)) * np.abs(at[:, 0, :] * alpha)
    bits = np.nan_to_num(bits) + np.nan_to_num(ANGLE * np.abs(force * Y))
    changes = np.abs(np.diff(work, axis=1))
    scale = np.maximum(_largest(kinetic, known), np.where(changes < np.inf, changes, 0.0).sum(axis=1))
    moves, scale = scale > 0.0, np.where(scale > 0.0, scale, 1.0)
    rounded = ROUNDED * numbers[:, 5] * (1.0 + _largest(np.abs(energy), known) / scale)
    rounded = np.where(moves, rounded + _largest(bits, exact) / scale, np.inf)
    return np.stack([work[:, -1], np.where(moves, off / scale, 0.0), work[:, -1], rounded], axis=1)


def _largest(values: Array, known: NDArray[np.bool_]) -> Array:
    """The largest of the known values of each row, no less than 0."""
    return np.asarray(np.max(np.where(known & ~np.isnan(values), values, 0.0), axis=1))
