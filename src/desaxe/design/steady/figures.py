"""Period, speeds, work and power of periodic motions, and their derivatives."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...support.panels import WEIGHT
from ..turn.cycle import NEAR
from .orbit import Orbit
from .slopes import OrbitSlopes

Array = NDArray[Any]
KEYS = ("period", "omega_mean", "fluctuation", "power_mean")  # that have derivatives
STEPS = 360  # of a turn


class Figures(NamedTuple):
    """The results of orbits, a row each."""

    values: dict[str, Array]
    gradient: dict[str, dict[str, Array]]


def figures_of(orbit: Orbit, slopes: OrbitSlopes) -> Figures:
    """The results of orbits."""
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
    speeds = _Speeds(orbit, slopes, np.stack([at_fastest, at_slowest], axis=1))
    share = mesh.half * WEIGHT  # of each node in an integral
    through = slopes.by_speed * omega / speed**2  # twice the torque's slope by omega^2
    in_period, in_work = -0.5 * share / speed**3, 0.5 * share * through
    for name, y in slopes.each():
        by_period, by_work = (np.einsum("npk,npk->n", weights, y) for weights in (in_period, in_work))
        if name in slopes.by_motor:
            by_work += mesh.integral(slopes.by_motor[name])
        by_mean = -mean / period * by_period
        high, low = speeds.by(name, y).T
        rows = {
            "period": by_period,
            "omega_mean": way * by_mean,
            "fluctuation": (high - low) / mean - (fastest - slowest) / mean**2 * by_mean,
            "power_mean": (way * by_work - work / period * by_period) / period,
        }
        for key, row in rows.items():
            gradient[key][name] = row
    return Figures(values, gradient)


class _Speeds:
    """The derivatives of speeds at places: fixed ones, or where a load jumps, which move with it."""

    def __init__(self, orbit: Orbit, slopes: OrbitSlopes, places: Array) -> None:
        mesh = orbit.mesh
        gap = np.abs(mesh.edges[:, None, :] - places[..., None])
        edge = np.take_along_axis(mesh.edges, gap.argmin(-1), 1)
        edge = np.where(edge == mesh.edges[:, -1:], 0.0, edge)  # where the panel behind it begins
        places = np.where(gap.min(-1) < NEAR, edge, places)
        self.at = mesh.reader(places)
        self.twice, self.steep = 2.0 * self.at(np.abs(orbit.rate.omega)), self.at(slopes.z_slope)
        self.shifts = slopes.shifts(places)

    def by(self, name: str, y: Array) -> Array:
        """The derivatives by a parameter."""
        return np.asarray((self.at(y) + self.steep * self.shifts.get(name, 0.0)) / self.twice)


def course_at_steps(orbit: Orbit) -> dict[str, Array]:
    """theta, omega and the motor's torque at equal steps over the period."""
    designs = orbit.designs
    x = np.tile(np.linspace(0.0, designs.period, STEPS * designs.turns + 1), (designs.size, 1))
    omega = orbit.mesh.at(x, orbit.rate.omega)
    theta = designs.theta(x)
    torque, _ = designs.source.both(theta, omega, designs.row(2))
    return {"theta": theta, "omega": omega, "T_motor": np.broadcast_to(torque, theta.shape).copy()}
