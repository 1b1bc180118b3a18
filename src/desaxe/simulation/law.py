"""The equations of motion, as first-order rates of (q, v, W).

With the effective moment of inertia M and the generalised torque Q of all that acts (paper C, section 3, by
Lagrange's equation), d(M omega^2/2)/dt = Q omega. In v = sqrt(M) omega that reads

    dtheta/dt = v / sqrt(M),    dv/dt = Q / sqrt(M),    dW/dt = (Q - gravity's part) omega

v^2/2 is the kinetic energy itself, M's derivative is not needed, and nothing grows without bound where M
does. q is the coordinate of `coordinate`; W is the work [J] of torque, load and friction.

Guide friction changes the acceleration, on which its force depends. T = M alpha + h + c |N|, c = mu |Y'|
sign(omega), where the normal force is N = n0 + n1 alpha + k |N| and k = branch tan(phi) mu sigma (paper C,
link 4). alpha eliminated,

    N = N_free + K |N|,    N_free = n0 + n1 alpha_free,    K = k - c n1 / M,

with alpha_free the acceleration without friction: one solution, which has the sign of N_free, where
-1 <= K sign(N_free) < 1; none above (the friction jams) and two below.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .model import Actuation, Model, Still

Array = NDArray[np.float64]
JAMS_AT = 1.0 - 1e-6  # of K sign(N): a million times the force without friction counts as none
NOISE = 1e-12  # of the terms of N_free: below it, its sign is rounding


class State(NamedTuple):
    """The state of the crank from (q, v): angle [rad] and speed [rad/s]."""

    theta: Any
    omega: Any


class Contact(NamedTuple):
    """The guide at an instant, for one way of turning; or at several."""

    inertia: Any
    alpha_free: Any
    normal_free: Any
    noise: Any
    arm: Any  # c [m]
    wedge: Any  # K
    by_omega: Any  # of the normal force
    by_alpha: Any

    @property
    def pressed(self) -> Any:
        """The sign of the normal force."""
        return np.copysign(1.0, self.normal_free)

    def torque(self, pressed: Any) -> Any:
        """c |N| [N m] of the solution on one side of the guide."""
        return self.arm * pressed * self.normal_free / (1.0 - pressed * self.wedge)

    @property
    def alpha(self) -> Any:
        """The acceleration with friction [rad/s^2]."""
        return self.alpha_free - self.torque(self.pressed) / self.inertia

    @property
    def solutions(self) -> Any:
        """The number of force balances."""
        share = self.wedge * self.pressed
        return np.where(share >= JAMS_AT, 0, np.where(share < -1.0, 2, 1))


class Guide(NamedTuple):
    """The guide where it rubs: normal force without friction and K, on the side that is held; rounding."""

    normal: Array
    wedge: Array
    noise: Array


class Rates(NamedTuple):
    """The rates of q, v and W at instants, the speed, and the guide where it rubs."""

    q: Array
    v: Array
    work: Array
    omega: Array
    guide: Guide | None


class Here(NamedTuple):
    """Torque, forces and inertia at instants."""

    t: Any
    theta: Any
    slope: Any  # of theta, by q
    still: Still
    root: Any  # of M_eff
    omega: Any
    torque: Any
    force: Any
    push: Any
    guide: Contact | None
    pressed: float

    @property
    def rates(self) -> Rates:
        """The rates of the state."""
        speed, rate = self.omega / self.slope, (self.push - self.still.weight) / self.root
        guide, pressed = self.guide, self.pressed
        held = guide and Guide(pressed * guide.normal_free, pressed * guide.wedge, guide.noise)
        return Rates(speed, rate, self.push * self.omega, self.omega, held)


class Law:
    """The motion between two cuts: smooth pieces of the loads; with friction three signs held.

    direction   in which the crank turns; side: the sign of Y'; pressed: that of the normal force
    """

    rests = False

    def __init__(
        self, model: Model, drive: Actuation, direction: float = 0.0, side: float = 0.0, pressed: float = 0.0
    ) -> None:
        self.model, self.drive = model, drive
        self.direction, self.side, self.pressed = direction, side, pressed
        self.rubs = model.mu != 0.0

    def place(self, q: Any) -> tuple[Any, Any]:
        """theta and dtheta/dq, NaN beyond a limit angle at which the inertia grows."""
        arc = self.model.coordinate
        if arc.half:
            slope = arc.half * np.cos(q)
            return arc.middle + arc.half * np.sin(q), np.where(np.abs(q) < 0.5 * np.pi, slope, np.nan)
        return (arc.clamped(q) if arc.bounded else q), 1.0

    def here(self, t: Any, q: Any, v: Any) -> "Here":
        """Torque, forces and inertia at instants."""
        theta, slope = self.place(q)
        still = self.model.still(theta)
        root = np.sqrt(still.inertia)
        omega = v / root
        torque, force = self.drive.torque.at(t, theta, omega), self.drive.F_Y.at(t, theta, omega)
        push, guide = torque + force * still.travel, None
        if self.rubs:
            guide = self.guide(t, theta, omega, still, push)
            push = push - guide.torque(self.pressed)
        return Here(t, theta, slope, still, root, omega, torque, force, push, guide, self.pressed)

    def rates(self, t: Any, q: Any, v: Any) -> Rates:
        """The rates at instants."""
        return self.here(t, q, v).rates

    def jacobian(self, here: "Here", q: Any) -> tuple[Any, Any, Any, Any]:
        """The derivatives of the rates of q and v by q and v, good enough for an iteration.

        Those of friction are of its torque by alpha and omega alone.
        """
        t, theta, slope, still, root, omega, *_ = here
        torque = self.drive.torque.slopes(t, theta, omega, here.torque)
        force = self.drive.F_Y.slopes(t, theta, omega, here.force)
        by_theta = torque.theta + force.theta * still.travel + force.value * still.bend - still.weight_slope
        by_omega = torque.omega + force.omega * still.travel
        if here.guide is not None:
            guide = here.guide
            share = guide.arm * self.pressed / (1.0 - self.pressed * guide.wedge)
            free = (by_omega - still.inertia_slope * omega) * guide.by_alpha / guide.inertia
            by_theta = by_theta * (1.0 - share * guide.by_alpha / guide.inertia)
            by_omega = by_omega - share * (guide.by_omega + free)
        steeper = 0.5 * still.inertia_slope / still.inertia  # of log(sqrt(M))
        q_by_q = -omega * steeper
        if self.model.coordinate.half:
            q_by_q = q_by_q + omega / slope * np.tan(q)
        gain = by_theta - by_omega * omega * steeper - (here.push - still.weight) * steeper
        return q_by_q, 1.0 / (root * slope), gain / root * slope, by_omega / still.inertia

    def guide(self, t: Any, theta: Any, omega: Any, still: Still, push: Any) -> Contact:
        """The contact at the guide, for the way of turning and the sign of Y' that are held."""
        model, drive = self.model, self.drive
        forces = (np.asarray(curve.at(t, theta, omega)) for curve in (drive.F_X, drive.F_Y))
        alpha_free = (push - still.weight - 0.5 * still.inertia_slope * omega * omega) / still.inertia
        normal, by_alpha, by_omega, lean = model.contact(theta, omega, *forces)
        arm = model.mu * self.side * self.direction * still.travel
        wedge = lean * model.mu * self.side * self.direction - arm * by_alpha / still.inertia
        noise = NOISE * (abs(normal) + abs(by_alpha * alpha_free))
        free = normal + by_alpha * alpha_free
        return Contact(still.inertia, alpha_free, free, noise, arm, wedge, by_omega, by_alpha)

    def contact(self, t: Any, theta: Any, omega: Any) -> Contact:
        """The contact at the guide at an instant, or at several."""
        still = self.model.still(theta)
        drive = self.drive
        push = drive.torque.at(t, theta, omega) + drive.F_Y.at(t, theta, omega) * still.travel
        return self.guide(t, theta, omega, still, push)

    def alpha(self, t: Any, theta: Any, omega: Any) -> Any:
        """The crank's acceleration [rad/s^2]: M alpha + M' omega^2/2 = Q."""
        still = self.model.still(theta)
        drive = self.drive
        push = drive.torque.at(t, theta, omega) + drive.F_Y.at(t, theta, omega) * still.travel
        if self.rubs:
            push = push - self.guide(t, theta, omega, still, push).torque(self.pressed)
        return (push - still.weight - 0.5 * still.inertia_slope * omega * omega) / still.inertia

    def with_drive(self, drive: Actuation) -> "Law":
        """The law under other pieces of the loads."""
        return Law(self.model, drive, self.direction, self.side, self.pressed)


class Resting(Law):
    """The crank stands still, held by friction."""

    rests = True

    def alpha(self, t: Any, theta: Any, omega: Any) -> Any:
        """Nothing moves."""
        return 0.0 * theta


def state_of(model: Model, q: Any, v: Any) -> State:
    """The crank's angle and speed."""
    arc = model.coordinate
    theta = arc.theta(q)
    inertia = model.inertia(theta)
    with np.errstate(invalid="ignore", divide="ignore"):
        omega = np.where(inertia > 0.0, v / np.sqrt(inertia), 0.0)
    return State(theta, omega) if np.ndim(q) else State(float(theta), float(omega))
