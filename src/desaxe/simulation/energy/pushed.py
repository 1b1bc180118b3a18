"""The derivatives of torque, load and limit angles of many designs by parameters, at fixed coordinates."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...loads.load import Load, OverTheta, OverY
from ...mechanism.closed.dead_centres import DEAD_CENTRES
from ...mechanism.closed.functions import closed_form
from ...mechanism.names import LENGTHS
from ...support.panels import ENDS, NODES
from .panels import STARTS, Designs

Array = NDArray[np.float64]
DEAD = 1e-6  # of the crank: dY/dtheta next to a dead centre, where a load that jumps does no work


class ArcSlopes(NamedTuple):
    """The slopes by a parameter of middle and half of the arc between limit angles; 0 where there is none."""

    middle: Array
    half: Array

    def angle(self, sine: Array) -> Array:
        """The slope of the crank angle at a fixed coordinate, whose sine is given."""
        return self.middle[:, None] + self.half[:, None] * sine


def arcs(designs: Designs, parameter: str) -> ArcSlopes:
    """The slopes of the arcs: at a limit ec + AB sin(theta) = BC or -BC."""
    if parameter not in LENGTHS or not designs.half.any():
        return ArcSlopes(np.zeros(len(designs.theta0)), np.zeros(len(designs.theta0)))
    ec, AB, _ = designs.lengths
    slopes = []
    for theta in (designs.middle - designs.half, designs.middle + designs.half):
        side, sine = np.copysign(1.0, ec + AB * np.sin(theta)), np.sin(theta)
        with np.errstate(divide="ignore", invalid="ignore"):
            moved: Array = {"ec": -np.ones_like(sine), "AB": -sine, "BC": side}[parameter]
            slope = moved / (AB * np.cos(theta))
        slopes.append(np.where(designs.half == 0.0, 0.0, slope))
    return ArcSlopes(0.5 * (slopes[0] + slopes[1]), 0.5 * (slopes[1] - slopes[0]))


class Pushed:
    """Torque and load of designs at angles, their slopes, and what they do at their jumps."""

    def __init__(self, designs: Designs, theta: Array, found: Mapping[str, Array], way: float) -> None:
        self.designs, self.found, self.force = designs, found, designs.force
        self.torque, self.torque_slope = np.zeros(theta.shape), np.zeros(theta.shape)
        self.load, self.load_slope = self.torque, self.torque
        if isinstance(designs.torque, OverTheta):
            self.torque, self.torque_slope = (np.asarray(v) for v in designs.torque.both(theta))
        if isinstance(self.force, OverTheta):
            self.load, self.load_slope = (np.asarray(v) for v in self.force.both(theta))
        elif isinstance(self.force, OverY):
            self.motion = dict(found)
            if self.force.centre:
                names = self.force.centre, *(f"{self.force.centre}_wrt_{p}" for p in LENGTHS)
                form = closed_form(DEAD_CENTRES, names, branch=float(designs.branch))
                zeros = form.arrays(*designs.lengths)
                self.motion |= {n: values[:, None] for n, values in zip(names, zeros, strict=True)}
            self.load, slope = self.force.both(self.force.along(self.motion), way * found["Y_wrt_theta"])
            self.slope = slope
            self.load_slope = slope * self.force.moved("theta", self.motion)

    def by_theta(self) -> Array:
        """The slope of the generalised torque by the crank angle."""
        found = self.found
        push = self.torque_slope - found["T_in_wrt_theta"]
        if isinstance(self.force, Load):
            push = push + self.load_slope * found["Y_wrt_theta"] + self.load * found["Y_wrt_theta_theta"]
        return np.asarray(push)

    def by(self, parameter: str) -> Any:
        """The slope of the generalised torque by a parameter at a fixed crank angle."""
        if parameter in STARTS:
            return 1.0 if parameter == "torque" else 0.0
        found, push = self.found, -self.found[f"T_in_wrt_{parameter}"]
        if isinstance(self.force, Load) and parameter in LENGTHS:
            push = push + self.load * found[f"Y_wrt_theta_{parameter}"]
            if isinstance(self.force, OverY):
                push += self.slope * self.force.moved(parameter, self.motion) * found["Y_wrt_theta"]
        return push

    def jumps(self, parameter: str, angle: Array) -> Array:
        """By how much the energy's slope jumps before each panel; angle: that of the crank angle."""
        found = self.found
        jumps = _before(self.torque)[0] * _before(angle)[1]
        if isinstance(self.force, OverTheta):
            jumps += _before(self.load)[0] * _before(found["Y_wrt_theta"] * angle)[1]
        elif isinstance(self.force, OverY):
            moved = np.zeros(angle.shape)
            if parameter in LENGTHS:
                moved = found[f"Y_wrt_{parameter}"] + found["Y_wrt_theta"] * angle
                if self.force.centre:
                    moved = moved - self.motion[f"{self.force.centre}_wrt_{parameter}"]
            step, _ = _before(self.load)
            _, speed = _before(found["Y_wrt_theta"])
            dead = np.abs(speed) < DEAD * self.designs.length("AB")[:, None]
            jumps += np.where(dead, 0.0, step * _before(moved)[1])
        return jumps


def _before(values: Array) -> tuple[Array, Array]:
    """The jump of values before each panel, and the value where it begins."""
    ends = values[:, 1:].reshape(len(values), -1, NODES) @ ENDS.T
    return ends[..., 0] - np.roll(ends[..., 1], 1, axis=1), ends[..., 0]
