"""The derivatives of histories, ends and work of many designs, from those of their coordinates."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..result import FAILED, LIMIT
from .by_parameters import Sensitivities
from .panels import STARTS, AtPlaces, Designs
from .pushed import arcs

Array = NDArray[np.float64]


class MotionAlong(NamedTuple):
    """Coordinates, their rates and the motion at instants; `at` has the start besides."""

    x: Array
    rate: Array
    omega: Array
    alpha: Array
    status: NDArray[np.int8]
    at: AtPlaces


class Histories(NamedTuple):
    """The derivatives of histories, of the end and of the work: designs, parameters, instants."""

    theta: Array
    omega: Array
    t_last: Array
    work: Array


def histories_of(designs: Designs, own: Sensitivities, motion: MotionAlong) -> Histories:
    """The derivatives of motions."""
    theta, rate, tau = (own.out[:, :, k] for k in range(3))
    omega, x, speed = rate, motion.x, motion.rate
    if designs.half.any():
        place, theta, omega = theta, np.empty(theta.shape), np.empty(theta.shape)
        half = designs.half[:, None]
        sine, cosine = np.sin(x), np.cos(x)
        slope = np.where(half == 0.0, 1.0, half * cosine)
        for k, p in enumerate(designs.wrt):
            arc = arcs(designs, p)
            theta[:, k] = arc.angle(sine) + slope * place[:, k]
            moved = place[:, k] + speed * tau[:, k]
            steeper = arc.half[:, None] * cosine - half * sine * moved
            omega[:, k] = steeper * speed + slope * rate[:, k]
    omega = omega - motion.alpha[:, None] * tau
    limit, failed = motion.status == LIMIT, motion.status == FAILED
    t_last = np.where(limit[:, None], own.ends[..., 0], 0.0)
    work = _energies(designs, motion, theta[..., -1], omega[..., -1])
    far = np.where(x[:, -1:] > 0.0, own.ends[..., 4], own.ends[..., 3])
    work = np.where(limit[:, None], own.ends[..., 1] + far, work) - own.ends[..., 2]
    t_last[failed] = work[failed] = np.nan
    return Histories(theta, omega, t_last, work)


def _energies(designs: Designs, motion: MotionAlong, theta_p: Array, omega_p: Array) -> Array:
    """The derivatives of kinetic and potential energy at the last instant."""
    found = {name: values[:, -1] for name, values in motion.at.known.items()}
    omega, rows = motion.omega[:, -1], []
    for k, p in enumerate(designs.wrt):
        of_M, of_V = (
            found["M_eff_wrt_theta"] * theta_p[:, k],
            found["potential_energy_wrt_theta"] * theta_p[:, k],
        )
        if p not in STARTS:
            of_M, of_V = of_M + found[f"M_eff_wrt_{p}"], of_V + found[f"potential_energy_wrt_{p}"]
        rows.append(found["M_eff"] * omega * omega_p[:, k] + 0.5 * omega * omega * of_M + of_V)
    return np.stack(rows, axis=1)
