"""The equations of motion, as first-order rates of (q, v, W).

With the effective moment of inertia M and the generalised torque Q of all that acts (paper C, section 3, by
Lagrange's equation), d(M omega^2/2)/dt = Q omega. In v = sqrt(M) omega that reads

    dtheta/dt = v / sqrt(M),    dv/dt = Q / sqrt(M),    dW/dt = (Q - gravity's part) omega

v^2/2 is the kinetic energy itself, M's derivative is not needed, and nothing grows without bound where M
does. q is the coordinate of `chart`; W is the work [J] of torque, load and friction.
"""

from math import copysign, inf, nan, sqrt
from typing import Any, NamedTuple, Protocol

from .model import Model

Row = tuple[float, float, float]


class Law(Protocol):
    """The rates of the state, and the crank's acceleration."""

    def rate(self, t: float, y: Any) -> Row:
        """d(q, v, W)/dt."""

    def alpha(self, t: float, theta: float, omega: float) -> float:
        """The crank's angular acceleration [rad/s^2]."""


class State(NamedTuple):
    """The state of the crank from (q, v): angle [rad], speed [rad/s], branch."""

    theta: float
    omega: float
    branch: float


def state_of(model: Model, q: float, v: float) -> State:
    """The crank's angle and speed."""
    theta, slope, side = model.coordinate.place(q)
    branch = side * model.sign
    inertia = model.still(theta, branch)[0]
    omega = copysign(1.0, slope) * v / sqrt(inertia) if inertia > 0.0 else 0.0
    return State(theta, omega, branch)


class Smooth:
    """The motion without friction."""

    def __init__(self, model: Model) -> None:
        self.model = model

    def rate(self, t: float, y: Any) -> Row:
        """The rates of q, v and W."""
        q, v, _ = y.tolist()
        model = self.model
        theta, slope, side = model.coordinate.place(q)
        inertia, weight, travel = model.still(theta, side * model.sign)
        if not 0.0 < inertia < inf or not slope:
            return nan, nan, nan  # no step ends here: the integrator tries a smaller one
        root = sqrt(inertia)
        omega = side * v / root
        drive = model.drive
        push = drive.torque(t, theta, omega) + drive.F_Y(t, theta, omega) * travel
        push -= self.resistance(t, theta, side * model.sign, omega)
        return v / (root * abs(slope)), side * (push - weight) / root, push * omega

    def resistance(self, t: float, theta: float, branch: float, omega: float) -> float:
        """The torque [N m] that friction takes, positive like theta."""
        return 0.0

    def alpha(self, t: float, theta: float, omega: float) -> float:
        """The crank's acceleration [rad/s^2]: M alpha + M' omega^2/2 = Q."""
        inertia, slope, weight, travel = self.model.moving(theta, self.model.sign)
        drive = self.model.drive
        push = drive.torque(t, theta, omega) + drive.F_Y(t, theta, omega) * travel
        push -= weight + self.resistance(t, theta, self.model.sign, omega)
        return (push - 0.5 * slope * omega * omega) / inertia if inertia else nan


class Resting:
    """The crank stands still, held by friction."""

    def rate(self, t: float, y: Any) -> Row:
        """Nothing moves."""
        return 0.0, 0.0, 0.0

    def alpha(self, t: float, theta: float, omega: float) -> float:
        """Nothing moves."""
        return 0.0
