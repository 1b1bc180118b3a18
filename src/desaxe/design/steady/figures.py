"""Period, speeds, work and power of periodic motions, and their derivatives."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .orbit import Orbit
from .slopes import Slopes

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
    for k, name in enumerate(() if slopes is None else slopes.forcing):
        assert slopes is not None
        by_speed = 0.5 * slopes.y[k] / speed  # of |omega|
        by_period = -mesh.integral(by_speed / speed**2)
        by_mean = -mean / period * by_period
        by_torque = slopes.by_motor.get(name, 0.0) + slopes.by_speed * way[:, None, None] * by_speed
        by_work = way * mesh.integral(by_torque)
        places = np.stack([at_fastest, at_slowest], axis=1)
        high, low = mesh.at(places, by_speed).T
        rows = {
            "period": by_period,
            "omega_mean": way * by_mean,
            "fluctuation": (high - low) / mean - (fastest - slowest) / mean**2 * by_mean,
            "power_mean": (by_work - work / period * by_period) / period,
        }
        for key, row in rows.items():
            gradient[key][name] = row
    return Figures(values, gradient)


def course_at_steps(orbit: Orbit) -> dict[str, Array]:
    """theta, omega and the motor's torque at equal steps over the period."""
    designs = orbit.designs
    x = np.tile(np.linspace(0.0, designs.period, STEPS * designs.turns + 1), (designs.size, 1))
    omega = orbit.mesh.at(x, orbit.rate.omega)
    theta = designs.theta(x)
    torque, _ = designs.source.both(theta, omega, designs.row(2))
    return {"theta": theta, "omega": omega, "T_motor": np.broadcast_to(torque, theta.shape).copy()}
