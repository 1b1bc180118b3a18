"""Inertia and torque of many designs at the nodes of panels, over the coordinate of their motion."""

from collections.abc import Mapping
from math import pi
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...evaluation.evaluate import evaluate
from ...runtime.compiled_only import compiled_only
from ...support.panels import nodes_of, padded

Array = NDArray[np.float64]
LOST = 2.0**-53  # of an angle: its rounding, in the last terms of a series
FIRST = 12  # panels of a turn, or between two limit angles, before any is halved
# All from one kernel: few compilations.
QUANTITIES = ("M_eff", "T_in", "M_eff_wrt_theta", "Y", "potential_energy")


class Designs(NamedTuple):
    """Designs without friction: inputs of the mechanism, numbers or arrays (designs,), and their starts.

    middle, half   of the arc between limit angles; half is 0 where the crank turns fully, middle NaN where no
                   inertia grows there
    """

    inputs: Mapping[str, Any]
    branch: int
    torque: Array
    force: Array
    theta0: Array
    omega_start: Array
    middle: Array
    half: Array

    def some(self, rows: Any) -> "Designs":
        """The designs of some rows."""
        inputs = {name: v if isinstance(v, float) else v[rows] for name, v in self.inputs.items()}
        torque, force, theta0, omega_start, middle, half = (column[rows] for column in self[2:])
        return Designs(inputs, self.branch, torque, force, theta0, omega_start, middle, half)

    def length(self, name: str) -> Array:
        """A length of each design."""
        return np.broadcast_to(self.inputs[name], self.theta0.shape)

    def values(self, theta: Array) -> dict[str, Array]:
        """The quantities of the designs at rest, each at angles of its own, which are two or more.

        Always by the same kernel: no digit hangs on the other designs.
        """
        inputs = {name: v if isinstance(v, float) else v[:, None] for name, v in self.inputs.items()}
        if len(theta) == 1:  # of one row alone its inputs would be numbers of another kernel
            inputs = {n: v if isinstance(v, float) else np.repeat(v, 2, axis=0) for n, v in inputs.items()}
            theta = np.repeat(theta, 2, axis=0)
        state: dict[str, Any] = {"theta": theta, "omega": 0.0, "alpha": 0.0, **inputs}
        with compiled_only():
            found = evaluate(list(QUANTITIES), branch=self.branch, threads=1, **state)
        return {name: values[: len(self.theta0)] for name, values in found.items()}

    def place(self, x: Array) -> tuple[Array, Any]:
        """Crank angles and their derivatives by the coordinate (see `coordinate`)."""
        if not self.half.any():
            return x, 1.0
        half, middle = self.half[:, None], self.middle[:, None]
        turns = half == 0.0
        return np.where(turns, x, middle + half * np.sin(x)), np.where(turns, 1.0, half * np.cos(x))

    def coordinates(self) -> Array:
        """The coordinates of the starts, measured from the nearer limit, so that no digit is lost."""
        before = self.theta0 < self.middle
        gap = np.where(before, self.theta0 - self.middle, self.middle - self.theta0) + self.half
        with np.errstate(invalid="ignore", divide="ignore"):
            quarter = 0.5 * pi - 2.0 * np.arcsin(np.sqrt(np.maximum(gap, 0.0) / (2.0 * self.half)))
        return np.where(self.half == 0.0, self.theta0, np.where(before, -quarter, quarter))


class Fields(NamedTuple):
    """Edges of panels, inertia and torque of the coordinate at their nodes, and both at the start.

    rough   how exactly they are known: next to a limit angle a rounded angle has lost digits
    """

    edges: Array
    rough: Array
    inertia: Array
    push: Array
    first_inertia: Array
    first_push: Array


def fields_of(designs: Designs, edges: Array) -> Fields:
    """The fields of designs on panels."""
    shape = (*edges[:, 1:].shape, -1)
    x = nodes_of(edges[:, :-1], edges[:, 1:])
    theta, slope = designs.place(x.reshape(len(edges), -1))
    found = designs.values(np.concatenate([designs.theta0[:, None], theta], axis=1))
    inertia, push = found["M_eff"], designs.torque[:, None] - found["T_in"]
    own = inertia[:, 1:] * slope * slope, push[:, 1:] * slope
    half = designs.half[:, None]
    nearest = np.maximum(1.0 - np.abs(np.sin(x[:, :, [0, -1]])).max(axis=2), 2.0**-53) * half
    with np.errstate(divide="ignore", invalid="ignore"):
        lost = LOST * (np.abs(designs.middle[:, None]) + half) / nearest
    rough = np.where(half == 0.0, 0.0, lost)
    values = [np.ascontiguousarray(part.reshape(shape)) for part in own]
    return Fields(edges, rough, values[0], values[1], inertia[:, 0], push[:, 0])


def first_edges(designs: Designs) -> Array:
    """Edges of panels over a turn from the start, or over the arc, with one more edge at the start."""
    start = designs.coordinates()[:, None]
    steps = np.arange(FIRST + 1) / FIRST
    edges = np.where(designs.half[:, None] == 0.0, start + 2.0 * pi * steps, pi * steps - 0.5 * pi)
    return np.sort(np.concatenate([start, edges], axis=1), axis=1)


def halved(edges: Array, bad: NDArray[np.int8]) -> Array:
    """Edges with the middles of bad panels among them; panels of no width fill the rows."""
    row, panel = np.nonzero(bad)
    middles = 0.5 * (edges[row, panel] + edges[row, panel + 1])
    return np.sort(np.concatenate([edges, padded(row, middles, len(edges), edges[:, 0])], axis=1), axis=1)
