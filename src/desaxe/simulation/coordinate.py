"""The coordinate in which the motion of a design is smooth everywhere.

A crank that turns fully needs none but its angle. A mechanism that cannot turn fully has limit angles,
where S = 0: with a massive rod or slider the effective inertia grows like one over the distance, the crank
comes to rest there and would come back with the rod on its other branch. In q, with
theta = middle + half sin(q), that is a smooth passage through q = pi/2: dtheta/dq vanishes just as
1/sqrt(M_eff) does, and beyond it the branch is the other one.
"""

from collections.abc import Mapping
from math import asin, inf, isfinite, nextafter, pi, sqrt
from typing import Any, NamedTuple

import numpy as np

from ..mechanism.closed import TURN
from ..mechanism.closed.functions import closed_form
from ..mechanism.closed.limits import LIMITS, theta_intervals
from ..mechanism.names import LENGTHS

EDGE = 1e-13  # rad: a bounded motion goes on, for the integrator, with what holds just before the limit


class Coordinate(NamedTuple):
    """theta as a function of q. `half` is 0 where q is theta itself; `first`, `last`: the limit angles."""

    first: float
    last: float
    half: float

    @property
    def middle(self) -> float:
        """The angle halfway between the limits."""
        return 0.5 * (self.first + self.last)

    @property
    def bounded(self) -> bool:
        """True between limit angles."""
        return self.first > -inf

    def clamped(self, q: Any) -> Any:
        """A crank angle, beyond a limit one just before it."""
        return np.clip(q, self.first + EDGE, self.last - EDGE)

    def theta(self, q: Any) -> Any:
        """The crank angle at a coordinate, or at several."""
        if self.half:
            return self.middle + self.half * np.sin(q)
        return self.clamped(q) if self.bounded else q

    def q(self, theta: float) -> float:
        """The coordinate of a crank angle; measured from the nearer limit, so that no digit is lost."""
        if not self.half:
            return theta
        before = theta < self.middle
        gap = theta - self.first if before else self.last - theta
        quarter = pi / 2 - 2.0 * asin(sqrt(max(gap, 0.0) / (2.0 * self.half)))
        return -quarter if before else quarter

    @property
    def ends(self) -> tuple[float, float]:
        """The coordinates of the limit angles."""
        return (-pi / 2, pi / 2) if self.half else (self.first, self.last)


def coordinate_of(values: Mapping[str, float], theta0: float) -> Coordinate | None:
    """The coordinate of a design around a start; None where that is no angle, or a limit angle."""
    lengths = tuple(values[name] for name in LENGTHS)
    arc = arc_around(theta0, *lengths)
    if arc is None or not inside(arc, theta0):
        return None
    bent = isfinite(arc[0]) and grows(values) and theta_intervals(*lengths) != [(0.0, TURN)]
    return Coordinate(*arc, 0.5 * (arc[1] - arc[0]) if bent else 0.0)


def grows(values: Mapping[str, float]) -> bool:
    """True if the effective inertia is unbounded at a limit angle.

    There the mass that counts is m_slider BC^2 + m_rod r_rod^2 + I_rod, for the slider moves and the rod
    turns about the crank pin while the crank stands still.
    """
    swings = values["m_rod"] > 0.0 and values.get("r_rod", 1.0) != 0.0
    return values["m_slider"] > 0.0 or values["I_rod"] > 0.0 or swings


def arc_around(theta: float, ec: float, AB: float, BC: float) -> tuple[float, float] | None:
    """The limit angles on both sides of theta, infinite where the crank turns fully, None if it is outside.

    A change point is a limit too: the mechanism can leave it on either branch.
    """
    intervals = theta_intervals(ec, AB, BC)
    if intervals == [(0.0, TURN)]:
        intervals = _between_change_points(ec, AB, BC)
        if not intervals:
            return -inf, inf
    for first, last in intervals:
        turns = TURN * round((theta - 0.5 * (first + last)) / TURN)
        if first + turns <= theta <= last + turns:
            return first + turns, last + turns
    return None


def _between_change_points(ec: float, AB: float, BC: float) -> list[tuple[float, float]]:
    """The arcs between the quarters at which S vanishes; none where it turns fully."""
    upper, lower = (m == 0.0 for m in closed_form(LIMITS, ("upper", "lower")).point(ec, AB, BC))
    if upper and lower:
        return [(-pi / 2, pi / 2), (pi / 2, 1.5 * pi)]
    if upper or lower:
        start = pi / 2 if upper else -pi / 2
        return [(start, start + TURN)]
    return []


def inside(arc: tuple[float, float], theta: float) -> bool:
    """True if theta lies strictly between the limit angles, by more than rounding."""
    least = 4.0 * (nextafter(abs(theta), inf) - abs(theta))
    return theta - arc[0] > least and arc[1] - theta > least
