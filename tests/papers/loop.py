"""The loop closure itself, differentiated in time at high precision: the papers' independent truth.

Nothing here is a solved velocity or acceleration formula. The crank angle moves under a constant angular
acceleration, theta(t) = theta + omega t + alpha t^2/2; the crank pin B follows the crank; the slider C lies
on its line where the rod reaches it; the rod angle is the direction from C to B. Rates are numerical
derivatives of these positions, taken by mpmath at twice the working precision.

Frame: origin at the crank centre A, Y along the slider axis, X to the side, theta from +Y towards +X. The
slider line is X = -ec. Lengths in metre, angles in radian, time in second.
"""

from collections.abc import Callable
from typing import NamedTuple

from mpmath import mp, mpf

DIGITS = 40
STEP_DIGITS = 20
NOW = mpf(0)

Vector = tuple[mpf, mpf]


class Motion(NamedTuple):
    """A mechanism at one crank angle: metres, radians, rad/s at theta = 0, rad/s2."""

    theta: float
    ec: float
    AB: float
    BC: float
    omega0: float
    alpha: float = 0.0


def omega(motion: Motion) -> mpf:
    """Crank speed at theta, rad/s: the energy-like integral of a constant angular acceleration."""
    with mp.workdps(2 * DIGITS):
        squared = mpf(motion.omega0) ** 2 + 2 * mpf(motion.alpha) * mpf(motion.theta)
        return mp.sign(motion.omega0) * mp.sqrt(squared)


def crank_angle(motion: Motion, t: mpf) -> mpf:
    """Theta a time t later, rad."""
    return mpf(motion.theta) + omega(motion) * t + mpf(motion.alpha) * t * t / 2


def pin(motion: Motion, t: mpf = NOW) -> Vector:
    """Crank pin B = (X, Y), m."""
    angle = crank_angle(motion, t)
    return mpf(motion.AB) * mp.sin(angle), mpf(motion.AB) * mp.cos(angle)


def slider(motion: Motion, t: mpf = NOW) -> Vector:
    """Slider C = (X, Y), m: on the line X = -ec, one rod length from B, on its far side."""
    x, y = pin(motion, t)
    side = x + mpf(motion.ec)
    return -mpf(motion.ec), y + mp.sqrt(mpf(motion.BC) ** 2 - side**2)


def rod_angle(motion: Motion, t: mpf = NOW) -> mpf:
    """Angle phi of the rod, rad: of the direction from C to B, against the slider axis."""
    (x_B, y_B), (x_C, y_C) = pin(motion, t), slider(motion, t)
    return mp.atan2(x_B - x_C, y_C - y_B)


def rate(position: Callable[[mpf], mpf], order: int) -> mpf:
    """Time derivative of a position at t = 0."""
    with mp.workdps(2 * DIGITS):
        return mp.diff(position, 0, order)


def truth(name: str, motion: Motion) -> mpf:
    """One quantity of the mechanism by its name in the package."""
    with mp.workdps(2 * DIGITS):
        return QUANTITIES[name](motion)


def partial(name: str, parameter: str, motion: Motion) -> mpf:
    """The derivative of a quantity with respect to one parameter, the others held."""
    with mp.workdps(2 * DIGITS):
        start = mpf(getattr(motion, parameter))
        h = mpf(10) ** -STEP_DIGITS
        ahead = truth(name, motion._replace(**{parameter: start + h}))
        behind = truth(name, motion._replace(**{parameter: start - h}))
        return (ahead - behind) / (2 * h)


QUANTITIES: dict[str, Callable[[Motion], mpf]] = {
    "omega": omega,
    "phi": rod_angle,
    "delta": lambda motion: mp.pi / 2 - rod_angle(motion),
    "Y": lambda motion: slider(motion)[1],
    "V_B_X": lambda motion: rate(lambda t: pin(motion, t)[0], 1),
    "V_B_Y": lambda motion: rate(lambda t: pin(motion, t)[1], 1),
    "a_B_X": lambda motion: rate(lambda t: pin(motion, t)[0], 2),
    "a_B_Y": lambda motion: rate(lambda t: pin(motion, t)[1], 2),
    "omega_BC": lambda motion: rate(lambda t: rod_angle(motion, t), 1),
    "alpha_BC": lambda motion: rate(lambda t: rod_angle(motion, t), 2),
    "V_C": lambda motion: rate(lambda t: slider(motion, t)[1], 1),
    "a_C": lambda motion: rate(lambda t: slider(motion, t)[1], 2),
}
