"""Period, speeds, work and power of periodic motions, and their derivatives with respect to every number.

At an angle the required torque G(theta, omega, alpha; p) + J alpha is the motor's T(theta, omega; p). With
z = omega^2, alpha = way z'/2, the change y = dz/dp at fixed x obeys the linear equation

    y' = 2 way (T_p - G_p - J_p alpha)/C - way (G_omega - T_omega)/(omega C) y,    C = G_alpha + J,

with y(period) = y(0). Where z' jumps at a place that moves with a length, y jumps by (z'_left - z'_right)
times what it moves by.
"""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...loads.along_motion import OfMotion
from ...runtime.request import request
from ...support.panels import WEIGHT
from ..turn.cycle import NEAR
from .designs import DesignRows, rate
from .orbit import Linear, Orbit, energy

Array = NDArray[Any]
KEYS = ("period", "omega_mean", "fluctuation", "power_mean")  # that have derivatives
STEPS = 360  # of a turn
REFINED = 2  # times that a solution is corrected by what it leaves
EXACT = 1e-8  # of a solution: a correction after which another one is below rounding
ABOVE = 1.0 + 1e-6  # of an energy
JUMP = 1e-9  # of the largest z': less is none


def figures_of(orbit: Orbit) -> tuple[dict[Any, Array], Array]:
    """The results of motions, derivatives under (key, parameter); the panels too wide for derivatives."""
    mesh, designs, omega = orbit.mesh, orbit.designs, orbit.rate.omega
    way, speed = designs.way, np.abs(omega)
    period, work = mesh.integral(1.0 / speed), way * mesh.integral(orbit.rate.torque)
    mean = designs.period / period
    (fastest, at_fastest, _), (slowest, at_slowest, _) = (mesh.extreme(speed, side) for side in (1.0, -1.0))
    multiplier = np.exp(np.minimum(orbit.log_multiplier, 700.0))
    rows: dict[Any, Array] = {
        "E0": orbit.E0, "jams": orbit.jams, "period": period, "omega_mean": way * mean,
        "fluctuation": (fastest - slowest) / mean, "power_mean": work / period, "work": work,
        "multiplier": multiplier, "stable": (multiplier < 1.0) & _is_held_above(orbit), **_course(orbit),
    }  # fmt: skip
    _, by_speed = designs.torque(orbit.course["theta"], omega)
    by_motor = designs.source.by(omega, {n: designs.each(v, 3) for n, v in designs.motor.items()})
    by_x = 0.5 * designs.each(way, 3) * orbit.course["slope"]
    z_slope = 2.0 * (orbit.rate.f - by_x * omega**2) / orbit.course["inertia"]  # from dE/dx
    g, forcing = _equation(orbit, 0.5 * designs.each(way, 3) * z_slope, by_speed, by_motor)
    jumps = _jumps(orbit, z_slope)
    linear, speeds = Linear(mesh, g), _speeds(orbit, z_slope, np.stack([at_fastest, at_slowest], axis=1))
    share = mesh.half * WEIGHT  # of each node in an integral
    through = by_speed * omega / speed**2  # twice the torque's slope by omega^2
    in_period, in_work = -0.5 * share / speed**3, 0.5 * share * through
    for name, b in forcing.items():
        y = _along(linear, b, jumps.get(name))
        by_period, by_work = (np.einsum("npk,npk->n", weights, y) for weights in (in_period, in_work))
        by_work += mesh.integral(by_motor[name]) if name in by_motor else 0.0
        by_mean = -mean / period * by_period
        high, low = speeds(name, y).T
        rows |= {
            ("period", name): by_period,
            ("omega_mean", name): way * by_mean,
            ("fluctuation", name): (high - low) / mean - (fastest - slowest) / mean**2 * by_mean,
            ("power_mean", name): (way * by_work - work / period * by_period) / period,
        }
    return rows, orbit.unresolved(tuple(forcing.values()))


def _is_held_above(orbit: Orbit) -> Array:
    """True where a little more energy falls, too: else it is the edge of a band of motions, all periodic."""
    E = energy(orbit.mesh, orbit.E0, orbit.F) * ABOVE
    return np.asarray(orbit.mesh.integral(np.nan_to_num(rate(orbit.designs, orbit.course, E).g)) < 0.0)


def _course(orbit: Orbit) -> dict[str, Array]:
    """theta, omega and the motor's torque at equal steps over the period."""
    designs = orbit.designs
    x = np.tile(np.linspace(0.0, designs.period, STEPS * designs.turns + 1), (designs.size, 1))
    theta, omega = designs.theta(x), orbit.mesh.at(x, orbit.rate.omega)
    torque = np.broadcast_to(designs.torque(theta, omega)[0], theta.shape).copy()
    return {"theta": theta, "omega": omega, "T_motor": torque}


def _parameters(designs: DesignRows) -> tuple[str, ...]:
    """The inputs of the mechanism by which the torque has derivatives."""
    if designs.turn is not None:
        return tuple(designs.turn.moving_parameters)
    everything = {**designs.numbers, **designs.loads, "omega": 1.0, "alpha": 1.0}
    asked = request(("T_in",), everything, designs.branch, "standard")
    return tuple(n for n in asked.inputs if n not in ("theta", "omega", "alpha") and n in designs.numbers)


def _equation(
    orbit: Orbit, alpha: Array, by_speed: Array, by_motor: Mapping[str, Array]
) -> tuple[Array, dict[str, Array]]:
    """g and b by parameter of the equation y' = g y + b."""
    designs, omega, way = orbit.designs, orbit.rate.omega, orbit.designs.each(orbit.designs.way, 3)
    with_numbers = {n: a for n, a in designs.loads.items() if isinstance(a, OfMotion) and a.numbers}
    names = _parameters(designs)
    slopes = {p: f"T_in_wrt_{p}" for p in ("omega", "alpha", *names, *with_numbers)}
    there = partial(designs.values, x=orbit.mesh.x, omega=omega, alpha=alpha)
    by = there([*slopes.values()])
    mass = by[slopes["alpha"]] + designs.each(designs.J, 3)
    pushes = {**by_motor, **{p: -by[slopes[p]] for p in names}, "flywheel_inertia": -alpha}
    for force, load in with_numbers.items():
        for number, slope in load.by_at(there, orbit.course["theta"], omega).items():
            pushes[f"{force}.{number}"] = -by[slopes[force]] * slope
    g = -way * (by[slopes["omega"]] - by_speed) / (omega * mass)
    return g, {p: 2.0 * way * push / mass for p, push in pushes.items()}


def _along(linear: Linear, b: Array, jumps: Array | None) -> Array:
    """The periodic solution of y' = g y + b, with jumps at the ends of panels."""
    mesh, g = linear.mesh, linear.g
    before = 0.0 if jumps is None else (np.cumsum(jumps, axis=-1) - jumps)[..., None]
    start, y = linear.solve(b, np.zeros(len(b)), jumps)
    slope = b + g * y
    for _ in range(REFINED):
        y = start[:, None, None] + mesh.running(slope) + before
        gap = mesh.integral(slope) + (0.0 if jumps is None else jumps.sum(-1))
        more, change = linear.solve(b + g * y - slope, gap)
        start, slope = start + more, b + g * (y + change)
        if (np.abs(change).max((1, 2)) <= EXACT * np.abs(y).max((1, 2))).all():
            break
    return np.asarray(start[:, None, None] + mesh.running(slope) + before)


def _jumps(orbit: Orbit, z_slope: Array) -> dict[str, Array]:
    """For each length, what y jumps by at the end of each panel, where a load over the slider jumps."""
    ends = orbit.mesh.ends(z_slope)
    jump = ends[..., 1] - np.roll(ends[..., 0], -1, axis=1)
    jump = np.where(np.abs(jump) > JUMP * np.abs(ends).max((1, 2))[:, None], jump, 0.0)
    shifts = _shifts(orbit.designs, orbit.edges[:, 1:]) if jump.any() else {}
    return {name: jump * shift for name, shift in shifts.items()}


def _shifts(designs: DesignRows, x: Array) -> dict[str, Array]:
    """By how much each length moves places where a load over the slider jumps; 0 elsewhere."""
    moves = designs.cycle.moves([], designs.theta(x))
    return {name: designs.way[:, None] * shift for name, shift in moves.items()}


def _speeds(orbit: Orbit, z_slope: Array, places: Array) -> Callable[[str, Array], Array]:
    """The derivatives of speeds at places: fixed ones, or where a load jumps, which move with it."""
    edges, mesh = orbit.edges, orbit.mesh
    gap = np.abs(edges[:, None, :] - places[..., None])
    edge = np.take_along_axis(edges, gap.argmin(-1), 1)
    edge = np.where(edge == edges[:, -1:], 0.0, edge)  # where the panel behind it begins
    places = np.where(gap.min(-1) < NEAR, edge, places)
    at, shifts = mesh.reader(places), _shifts(orbit.designs, places)
    twice, steep = 2.0 * at(np.abs(orbit.rate.omega)), at(z_slope)
    return lambda name, y: np.asarray((at(y) + steep * shifts.get(name, 0.0)) / twice)
