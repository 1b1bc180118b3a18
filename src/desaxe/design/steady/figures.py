"""Period, speeds, work and power of periodic motions, and their derivatives."""

from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from ..turn.panels import NODES, TO_COEFFICIENTS
from .mesh import Mesh
from .orbit import Orbit
from .slopes import Slopes

Array = NDArray[Any]
KEYS = ("period", "omega_mean", "fluctuation", "power_mean")  # that have derivatives
STEPS = 360  # of a turn
PEAKS = 4  # so many of the highest samples of a turn are refined


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
    fastest, at_fastest = extreme(mesh, speed, 1.0)
    slowest, at_slowest = extreme(mesh, speed, -1.0)
    multiplier = np.exp(np.minimum(orbit.linear.log_multiplier, 700.0))
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


def extreme(mesh: Mesh, values: Array, sign: float) -> tuple[Array, Array]:
    """The largest (sign 1) or smallest (-1) value of each row and its place."""
    sampled = sign * mesh.samples(values)
    row = np.arange(len(sampled))[:, None]
    wrapped = np.concatenate([sampled[:, -1:], sampled, sampled[:, :1]], axis=1)
    peak = (sampled >= wrapped[:, :-2]) & (sampled >= wrapped[:, 2:])
    best = np.argsort(np.where(peak, -sampled, np.inf), axis=1, kind="stable")[:, :PEAKS]
    series = sign * (values @ TO_COEFFICIENTS.T)
    top = np.full(len(sampled), -np.inf)
    place = np.zeros(len(sampled))
    for shift in (-1, 0, 1):  # the panel of a sample at an end may rise further in the next
        panel = np.clip(best // (NODES + 2) + shift, 0, series.shape[1] - 1)
        half, start = mesh.half[row, panel, 0], mesh.edges[row, panel]
        own = series[row, panel]
        x = np.clip((mesh.places[row, best] - start) / np.where(half > 0.0, half, 1.0) - 1.0, -1.0, 1.0)
        for near in (x, _climbed(own, x)):
            here = _series(own, near)
            k = np.argmax(here, axis=1)[:, None]
            value = np.take_along_axis(here, k, 1)[:, 0]
            better = value > top
            top = np.where(better, value, top)
            there = np.take_along_axis(start + half * (1.0 + near), k, 1)[:, 0]
            place = np.where(better, there, place)
    return sign * top, place


def _series(coefficients: Array, x: Array) -> Array:
    basis = legendre.legvander(x, coefficients.shape[-1] - 1)
    return np.asarray(np.einsum("nmk,nmk->nm", basis, coefficients))


def _climbed(coefficients: Array, x: Array) -> Array:
    """The places where the slope vanishes, by Newton's method within the panel."""
    first = np.moveaxis(legendre.legder(coefficients, axis=-1), -1, -1)
    second = legendre.legder(first, axis=-1)
    for _ in range(6):
        slope, bend = _series(first, x), _series(second, x)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = np.where(bend < 0.0, -slope / bend, 0.02 * np.sign(slope))
        x = np.clip(x + np.clip(np.nan_to_num(step), -0.2, 0.2), -1.0, 1.0)
    return x


def row_of(figures: Any, k: int) -> dict[str, Any]:
    """One row as plain numbers."""
    return {name: values[k].item() for name, values in figures.items()}
