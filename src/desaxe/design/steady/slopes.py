"""Derivatives of a periodic motion by every number that makes it.

At an angle the required torque G(theta, omega, alpha; p) + J alpha is the motor's T(theta, omega; p). With
z = omega^2, alpha = way z'/2, the change y = dz/dp at fixed x obeys the linear equation

    y' = 2 way (T_p - G_p - J_p alpha)/C - way (G_omega - T_omega)/(omega C) y,    C = G_alpha + J,

with y(period) = y(0). Where z' jumps at a place that moves with a length, y jumps by (z'_left - z'_right)
times what it moves by.
"""

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...loads.along_motion import OfMotion
from ...runtime.request import request
from ...support.computed import computed_once
from .designs import DesignRows
from .linear import Linear
from .orbit import Orbit

Array = NDArray[Any]
REFINED = 2  # times that a solution is corrected by what it leaves
EXACT = 1e-8  # of a solution: a correction after which another one is below rounding
JUMP = 1e-9  # of the largest z': less is none


def parameters(designs: DesignRows) -> tuple[str, ...]:
    """The inputs of the mechanism by which the torque has derivatives."""
    if designs.turn is not None:
        return tuple(designs.turn.moving_parameters)
    everything = {**designs.numbers, **designs.loads, "omega": 1.0, "alpha": 1.0}
    asked = request(("T_in",), everything, designs.branch, "standard")
    return tuple(n for n in asked.inputs if n not in ("theta", "omega", "alpha") and n in designs.numbers)


class OrbitSlopes:
    """The derivatives of omega^2 along orbits, by parameter: at the nodes and at the start."""

    def __init__(self, orbit: Orbit) -> None:
        self.orbit, self.designs = orbit, orbit.designs
        self.names = parameters(self.designs)
        self.z = orbit.rate.omega**2
        by_x = orbit.course.way * orbit.course.slope
        self.z_slope = 2.0 * (orbit.rate.f - 0.5 * by_x * self.z) / orbit.course.inertia  # from dE/dx
        self.alpha = 0.5 * orbit.course.way * self.z_slope
        wanted = ["T_in_wrt_omega", "T_in_wrt_alpha", *(f"T_in_wrt_{name}" for name in self.names)]
        with_numbers = {n: a for n, a in self.designs.loads.items() if isinstance(a, OfMotion) and a.numbers}
        wanted += [f"T_in_wrt_{name}" for name in with_numbers]
        found = self.designs.values(wanted, orbit.mesh.x, omega=orbit.rate.omega, alpha=self.alpha)
        row, way = self.designs.row(3), orbit.course.way
        _, by_speed = self.designs.source.both(orbit.course.theta, orbit.rate.omega, row)
        mass = found["T_in_wrt_alpha"] + self.designs.each(self.designs.J, 3)
        g = -way * (found["T_in_wrt_omega"] - by_speed) / (orbit.rate.omega * mass)
        self.linear = Linear(orbit.mesh, g)
        self.by_speed, self.by_motor = by_speed, self.designs.source.by(orbit.rate.omega, row)
        pushes = {**self.by_motor, **{name: -found[f"T_in_wrt_{name}"] for name in self.names}}
        pushes["flywheel_inertia"] = -self.alpha
        for force, load in with_numbers.items():
            there = partial(self.designs.values, x=orbit.mesh.x, omega=orbit.rate.omega, alpha=self.alpha)
            for name, slope in load.by_at(there, orbit.course.theta, orbit.rate.omega).items():
                pushes[f"{force}.{name}"] = -found[f"T_in_wrt_{force}"] * slope
        self.forcing = {name: 2.0 * way * push / mass for name, push in pushes.items()}

    def each(self) -> Iterator[tuple[str, Array]]:
        """The parameters, and dz/dp at the nodes."""
        for name, b in self.forcing.items():
            yield name, self._along(b, self.jumps.get(name))

    def _along(self, b: Array, jumps: Array | None) -> Array:
        """The periodic solution of y' = g y + b, with jumps at the ends of panels."""
        mesh, g = self.orbit.mesh, self.linear.g
        before = 0.0 if jumps is None else (np.cumsum(jumps, axis=-1) - jumps)[..., None]
        start, y = self.linear.solve(b, np.zeros(len(b)), jumps)
        slope = b + g * y
        for _ in range(REFINED):
            y = start[:, None, None] + mesh.running(slope) + before
            gap = mesh.integral(slope) + (0.0 if jumps is None else jumps.sum(-1))
            more, change = self.linear.solve(b + g * y - slope, gap)
            start, slope = start + more, b + g * (y + change)
            if (np.abs(change).max((1, 2)) <= EXACT * np.abs(y).max((1, 2))).all():
                break
        return np.asarray(start[:, None, None] + mesh.running(slope) + before)

    @computed_once
    def jumps(self) -> dict[str, Array]:
        """For each length, what y jumps by at the end of each panel, where a load over the slider jumps."""
        mesh = self.orbit.mesh
        ends = mesh.ends(self.z_slope)
        jump = ends[..., 1] - np.roll(ends[..., 0], -1, axis=1)
        jump = np.where(np.abs(jump) > JUMP * np.abs(ends).max((1, 2))[:, None], jump, 0.0)
        if not jump.any():
            return {}
        return {name: jump * shift for name, shift in self.shifts(mesh.edges[:, 1:]).items()}

    def shifts(self, x: Array) -> dict[str, Array]:
        """By how much each length moves places where a load over the slider jumps; 0 elsewhere."""
        way = self.orbit.course.way[..., 0]
        moves = self.designs.cycle.moves([], self.designs.theta(x))
        return {name: way * shift for name, shift in moves.items()}
