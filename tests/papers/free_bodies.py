"""Forces of the slider-crank by the package's names, from its three free bodies (`newton_euler_c`).

No formula for a force or a torque enters. Frame of `loop`; a moment is y F_X - x F_Y and positive like theta.
SI units. There is no friction.
"""

from typing import NamedTuple

from mpmath import mp, mpf

from tests.papers import loop
from tests.papers import newton_euler_c as ne
from tests.papers.loop import Motion, Vector
from tests.papers.paper_c import PACKAGE

UNKNOWNS = ("F_A_X", "F_A_Y", "F_B_X", "F_B_Y", "F_C_X", "F_C_Y", "N_C", "T_in")


class Bodies(NamedTuple):
    """Masses (kg), moments of inertia about each body's own centre of mass (kg m2), loads (N, m/s2).

    r_crank is the way from A towards B, r_rod that from B towards C, to the centre of mass; None: the middle.
    """

    m_crank: float = 0.0
    m_rod: float = 0.0
    m_slider: float = 0.0
    I_crank: float = 0.0
    I_rod: float = 0.0
    r_crank: float | None = None
    r_rod: float | None = None
    F_X: float = 0.0
    F_Y: float = 0.0
    g_X: float = 0.0
    g_Y: float = 0.0


def along(start: Vector, end: Vector, length: float, distance: float | None) -> Vector:
    """The point at a distance from `start` towards `end`, the middle if none is given."""
    part = mpf(1) / 2 if distance is None else mpf(distance) / mpf(length)
    return tuple(a + part * (b - a) for a, b in zip(start, end, strict=True))


def crank_centre(motion: Motion, bodies: Bodies, t: mpf = loop.NOW) -> Vector:
    """Centre of mass of the crank, m."""
    return along((mpf(0), mpf(0)), loop.pin(motion, t), motion.AB, bodies.r_crank)


def rod_centre(motion: Motion, bodies: Bodies, t: mpf = loop.NOW) -> Vector:
    """Centre of mass of the rod, m."""
    return along(loop.pin(motion, t), loop.slider(motion, t), motion.BC, bodies.r_rod)


def solve(motion: Motion, bodies: Bodies) -> dict[str, mpf]:
    """The eight unknowns by name."""
    with mp.workdps(2 * loop.DIGITS):
        given = motion._asdict() | bodies._asdict() | {"omega": loop.omega(motion)}
        for centre, length in (("r_crank", motion.AB), ("r_rod", motion.BC)):
            if given[centre] is None:
                given[centre] = mpf(length) / 2
        result = ne.solve(ne.State(**{name: given[name] for name in ne.State._fields if name in given}))
        return {name: PACKAGE[name][1] * result[PACKAGE[name][0]] for name in UNKNOWNS}


def turn_of_rod(motion: Motion, t: mpf = loop.NOW) -> mpf:
    """Direction of the rod from B to C, measured like theta, rad."""
    (x_B, y_B), (x_C, y_C) = loop.pin(motion, t), loop.slider(motion, t)
    return mp.atan2(x_C - x_B, y_C - y_B)


def second_rate(point) -> Vector:
    """Acceleration of a moving point, m/s2."""
    return tuple(loop.rate(lambda t, axis=axis: point(t)[axis], 2) for axis in (0, 1))
