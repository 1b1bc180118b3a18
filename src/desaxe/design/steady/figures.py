"""Period, speeds, work and power of periodic motions, and their derivatives."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...support.panels import WEIGHT
from .orbit import Orbit
from .slopes import NEAR, Slopes

Array = NDArray[Any]
KEYS = ("period", "omega_mean", "fluctuation", "power_mean")  # that have derivatives
STEPS = 360  # of a turn


class Figures(NamedTuple):
    """The results of orbits, a row each."""

    values: dict[str, Array]
    gradient: dict[str, dict[str, Array]]


def figures_of(orbit: Orbit, slopes: Slopes | None) -> Figures:
    """The results of orbits; without slopes no derivatives."""
    mesh, designs, omega = orbit.mesh, orbit.designs, orbit.rate.omega
    way, speed = designs.way, np.abs(omega)
    period = mesh.integral(1.0 / speed)
    work = way * mesh.integral(orbit.rate.torque)
    mean = designs.period / period
    fastest, at_fastest, _ = mesh.extreme(speed, 1.0)
    slowest, at_slowest, _ = mesh.extreme(speed, -1.0)
    multiplier = np.exp(np.minimum(orbit.log_multiplier, 700.0))
    values = {
        "period": period, "omega_mean": way * mean, "fluctuation": (fastest - slowest) / mean,
        "power_mean": work / period, "work": work, "multiplier": multiplier, "stable": multiplier < 1.0,
    }  # fmt: skip
    gradient: dict[str, dict[str, Array]] = {key: {} for key in KEYS}
    if slopes is not None:
        by_period, by_work = _by_totals(orbit, slopes)
        by_mean = -mean / period * by_period
        high, low = _by_extremes(orbit, slopes, np.stack([at_fastest, at_slowest], axis=1))
        rows = {
            "period": by_period,
            "omega_mean": way * by_mean,
            "fluctuation": (high - low) / mean - (fastest - slowest) / mean**2 * by_mean,
            "power_mean": (by_work - work / period * by_period) / period,
        }
        gradient = {key: dict(zip(slopes.forcing, row, strict=True)) for key, row in rows.items()}
    return Figures(values, gradient)


def _by_totals(orbit: Orbit, slopes: Slopes) -> tuple[Array, Array]:
    """The derivatives of period and work by each parameter, in rows."""
    mesh, speed = orbit.mesh, np.abs(orbit.rate.omega)
    share = mesh.half * WEIGHT  # of each node in an integral
    through = slopes.by_speed * orbit.rate.omega / speed**2  # 2 times the torque's slope by omega^2
    weights = np.stack([-0.5 * share / speed**3, 0.5 * share * through])
    by_period, by_work = np.einsum("wnpk,jnpk->wjn", weights, slopes.y)
    for k, name in enumerate(slopes.forcing):
        if name in slopes.by_motor:
            by_work[k] += mesh.integral(slopes.by_motor[name])
    return by_period, orbit.designs.way * by_work


def _by_extremes(orbit: Orbit, slopes: Slopes, places: Array) -> tuple[Array, Array]:
    """The derivatives of the speeds at extremes by each parameter; one at a jump moves with it."""
    mesh = orbit.mesh
    gap = np.abs(mesh.edges[:, None, :] - places[..., None])
    edge = np.take_along_axis(mesh.edges, gap.argmin(-1), 1)
    places = np.where(gap.min(-1) < NEAR, np.where(edge == mesh.edges[:, -1:], 0.0, edge), places)
    y = mesh.at(places, slopes.y)
    for name, shift in slopes.shifts(places).items():
        y[list(slopes.forcing).index(name)] += mesh.at(places, slopes.z_slope) * shift
    found = 0.5 * y / mesh.at(places, np.abs(orbit.rate.omega))
    return found[..., 0], found[..., 1]


def course_at_steps(orbit: Orbit) -> dict[str, Array]:
    """theta, omega and the motor's torque at equal steps over the period."""
    designs = orbit.designs
    x = np.tile(np.linspace(0.0, designs.period, STEPS * designs.turns + 1), (designs.size, 1))
    omega = orbit.mesh.at(x, orbit.rate.omega)
    theta = designs.theta(x)
    torque, _ = designs.source.both(theta, omega, designs.row(2))
    return {"theta": theta, "omega": omega, "T_motor": np.broadcast_to(torque, theta.shape).copy()}
