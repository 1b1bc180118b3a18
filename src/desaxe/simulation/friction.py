"""Friction at the guide: its force depends on the acceleration that it changes.

T = M alpha + h + c |N|, c = mu |Y'| sign(omega), where the normal force is N = n0 + n1 alpha + k |N| and
k = branch tan(phi) mu sigma (paper C, link 4). alpha eliminated,

    N = N_free + K |N|,    N_free = n0 + n1 alpha_free,    K = k - c n1 / M,

with alpha_free the acceleration without friction: one solution, which has the sign of N_free, where
-1 <= K sign(N_free) < 1; none above (the friction jams) and two below.
"""

from collections.abc import Callable
from itertools import pairwise
from math import copysign
from typing import NamedTuple

from .equations import Smooth
from .model import Model

JAMS_AT = 1.0 - 1e-6  # of K sign(N): a million times the force without friction counts as none
NOISE = 1e-12  # of the terms of N_free: below it, its sign is rounding
WAITS = 2000  # instants at which a crank held by friction is asked whether the torque can move it


class Contact(NamedTuple):
    """The guide at an instant, for one way of turning."""

    inertia: float
    alpha_free: float
    normal_free: float
    noise: float
    arm: float  # c [m]
    wedge: float  # K

    @property
    def pressed(self) -> float:
        """The sign of the normal force."""
        return copysign(1.0, self.normal_free)

    def torque(self, pressed: float) -> float:
        """c |N| [N m] of the solution on one side of the guide."""
        return self.arm * pressed * self.normal_free / (1.0 - pressed * self.wedge)

    @property
    def alpha(self) -> float:
        """The acceleration with friction [rad/s^2]."""
        return self.alpha_free - self.torque(self.pressed) / self.inertia

    @property
    def solutions(self) -> int:
        """The number of force balances."""
        share = self.wedge * self.pressed
        return 0 if share >= JAMS_AT else 2 if share < -1.0 else 1


def contact(
    model: Model, t: float, theta: float, branch: float, omega: float, way: float, side: float
) -> Contact:
    """The guide while the crank turns `way` with Y' of sign `side`."""
    inertia, slope, weight, travel = model.moving(theta, branch)
    drive = model.drive
    F_X, F_Y = drive.F_X(t, theta, omega), drive.F_Y(t, theta, omega)
    push = drive.torque(t, theta, omega) + F_Y * travel - weight
    alpha_free = (push - 0.5 * slope * omega * omega) / inertia
    still, by_alpha, lean = model.contact(theta, branch, omega, F_X, F_Y)
    arm = model.mu * side * travel * way
    wedge = lean * model.mu * side * way - arm * by_alpha / inertia
    noise = NOISE * (abs(still) + abs(by_alpha * alpha_free))
    return Contact(inertia, alpha_free, still + by_alpha * alpha_free, noise, arm, wedge)


def side_ahead(model: Model, theta: float, branch: float, way: float) -> float:
    """The sign of Y' where the crank is, or just ahead of it at a dead centre."""
    travel = model.still(theta, branch)[2]
    if abs(travel) <= 1e-9 * model.values["AB"]:
        travel = model.still(theta + 1e-6 * way, branch)[2]
    return copysign(1.0, travel)


class Rubbing(Smooth):
    """The motion with friction, between two kinks: the three signs in it are held."""

    def __init__(self, model: Model, way: float, side: float, pressed: float) -> None:
        super().__init__(model)
        self.way, self.side, self.pressed = way, side, pressed

    def at(self, t: float, theta: float, branch: float, omega: float) -> Contact:
        """The guide at an instant."""
        return contact(self.model, t, theta, branch, omega, self.way, self.side)

    def resistance(self, t: float, theta: float, branch: float, omega: float) -> float:
        """The torque [N m] that friction takes."""
        return self.at(t, theta, branch, omega).torque(self.pressed)


def ways_to_start(model: Model, t: float, theta: float, branch: float) -> list[tuple[float, Contact]]:
    """The directions in which the crank can start from rest, each with the contact at the guide."""
    found = []
    for way in (1.0, -1.0):
        hold(model, theta, way)
        here = contact(model, t, theta, branch, 0.0, way, side_ahead(model, theta, branch, way))
        if here.solutions == 1 and here.alpha * way > 0.0:
            found.append((way, here))
    if found:
        hold(model, theta, found[0][0])
    return found


def hold(model: Model, theta: float, way: float) -> None:
    """Hold each load to its piece ahead, for this way of turning."""
    for held in model.drive.held:
        held.hold(theta, way)


def breaks_away(model: Model, theta: float, branch: float, start: float, t_end: float) -> float | None:
    """The instant at which a time-dependent torque or load moves a crank at rest; None if it never does.

    Asked at many instants: a push that is over sooner than that is not noticed.
    """

    def moves_in(way: float, t: float) -> bool:
        hold(model, theta, way)
        here = contact(model, t, theta, branch, 0.0, way, side_ahead(model, theta, branch, way))
        return here.solutions == 1 and way * here.alpha > 0.0

    def moves(t: float) -> bool:
        return moves_in(1.0, t) or moves_in(-1.0, t)

    instants = [start + (t_end - start) * k / WAITS for k in range(WAITS)] + [t_end]
    for before, after in pairwise(instants):
        if moves(after):
            return _first(moves, before, after)
    return None


def _first(moves: Callable[[float], bool], a: float, b: float) -> float:
    """The first instant in a bracket at which a condition is true, by bisection to the last digit."""
    while a < (middle := 0.5 * (a + b)) < b:
        a, b = (a, middle) if moves(middle) else (middle, b)
    return b
