"""Quantities of many designs at rest, in plain loops: at the nodes of panels, or along their motions.

setup    a row per design: theta0, middle and half of the arc between limit angles (half 0 without), torque
limit    of angles whose sines are written out [rad]
theta    coordinates (see `coordinate`) that become angles; the first column is the start
out      a row per quantity, the second of which becomes the torque that is left to move the crank
"""

from __future__ import annotations

from math import atan2, cos, sin
from typing import TYPE_CHECKING

from numpy import empty

if TYPE_CHECKING:
    from typing import Any

    def fields_in_lanes(theta: Any, branch: float, p: Any, out: Any) -> None:
        """The quantities of panels at angles, in the lanes of a vector; p: the inputs of a design."""

    def course_in_lanes(theta: Any, branch: float, p: Any, out: Any) -> None:
        """The quantities of motions at angles, in the lanes of a vector."""


def to_nodes(edges: Any, node: Any, x: Any) -> None:
    """The coordinates of all nodes, behind that of the start."""
    for panel in range(len(edges) - 1):
        middle, half = 0.5 * (edges[panel] + edges[panel + 1]), 0.5 * (edges[panel + 1] - edges[panel])
        at = 1 + 16 * panel
        for k in range(16):
            x[at + k] = middle + half * node[k]


def to_angles(setup: Any, limit: float, theta: Any, slope: Any, reduced: Any) -> None:
    """The angles of coordinates, their slopes, and angles of the same sines that are not too large."""
    middle, half = setup[1], setup[2]
    for k in range(len(theta)):
        slope[k] = 1.0
        if k == 0:
            theta[k] = setup[0]
        elif half != 0.0:
            x = theta[k]
            theta[k], slope[k] = middle + half * sin(x), half * cos(x)
        reduced[k] = theta[k]
        if abs(theta[k]) > limit:
            reduced[k] = atan2(sin(theta[k]), cos(theta[k]))


def of_coordinate(slope: Any, out: Any) -> None:
    """The inertia and the torque of the coordinate, in place of those of the angle."""
    for k in range(out.shape[1]):
        out[0, k] *= slope[k] * slope[k]
        out[1, k] *= slope[k]


def at_angles(
    rows: Any, setup: Any, branch: float, limit: float, node: Any, edges: Any, theta: Any, slope: Any,
    out: Any,
) -> None:  # fmt: skip
    """Fill in all designs: at the nodes of panels between edges, or, without edges, at given places."""
    reduced = empty(theta.shape[1])
    for n in range(len(theta)):
        if edges.shape[1] > 0:
            to_nodes(edges[n], node, theta[n])
        to_angles(setup[n], limit, theta[n], slope[n], reduced)
        if edges.shape[1] > 0:
            fields_in_lanes(reduced, branch, rows[n], out[n])
        else:
            course_in_lanes(reduced, branch, rows[n], out[n])
        for k in range(theta.shape[1]):
            out[n, 1, k] = setup[n, 3] - out[n, 1, k]
        if edges.shape[1] > 0 and setup[n, 2] != 0.0:
            of_coordinate(slope[n], out[n])
