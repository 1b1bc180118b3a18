"""Forces of the slider-crank from its three free bodies: an independent reference at high precision.

Newton's and Euler's equations of crank, rod and slider are written down as they stand and solved as eight
linear equations for the eight unknowns: three pin forces of two components, the guide's force and the torque
that drives the crank. No formula for a force or a torque enters. Accelerations are time derivatives of the
raw loop's positions. There is no friction.

Frame of `loop`; a moment is y F_X - x F_Y and positive like theta. SI units.
"""

from typing import NamedTuple

from mpmath import mp, mpf

from tests.papers import loop
from tests.papers.loop import Motion, Vector

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


def turn_of_rod(motion: Motion, t: mpf = loop.NOW) -> mpf:
    """Direction of the rod from B to C, measured like theta, rad."""
    (x_B, y_B), (x_C, y_C) = loop.pin(motion, t), loop.slider(motion, t)
    return mp.atan2(x_C - x_B, y_C - y_B)


def second_rate(point) -> Vector:
    """Acceleration of a moving point, m/s2."""
    return tuple(loop.rate(lambda t, axis=axis: point(t)[axis], 2) for axis in (0, 1))


def solve(motion: Motion, bodies: Bodies) -> dict[str, mpf]:
    """The eight unknowns by name."""
    with mp.workdps(2 * loop.DIGITS):
        bodies = Bodies(*(value if value is None else mpf(value) for value in bodies))
        rows = [*crank_rows(motion, bodies), *rod_rows(motion, bodies), *slider_rows(motion, bodies)]
        matrix = mp.matrix([[mpf(row.get(name, 0)) for name in UNKNOWNS] for row, _ in rows])
        found = mp.lu_solve(matrix, mp.matrix([right for _, right in rows]))
        return dict(zip(UNKNOWNS, found, strict=True))


def crank_rows(motion: Motion, bodies: Bodies) -> list:
    """F_A - F_B + m g = m a, and moments about the crank's centre of mass."""
    x, y = crank_centre(motion, bodies)
    x_B, y_B = loop.pin(motion)
    a_X, a_Y = second_rate(lambda t: crank_centre(motion, bodies, t))
    turning = loop.rate(lambda t: loop.crank_angle(motion, t), 2)
    m = bodies.m_crank
    arms = {"F_A_X": -y, "F_A_Y": x, "F_B_X": -(y_B - y), "F_B_Y": x_B - x, "T_in": 1}
    return [
        ({"F_A_X": 1, "F_B_X": -1}, m * (a_X - bodies.g_X)),
        ({"F_A_Y": 1, "F_B_Y": -1}, m * (a_Y - bodies.g_Y)),
        (arms, bodies.I_crank * turning),
    ]


def rod_rows(motion: Motion, bodies: Bodies) -> list:
    """F_B - F_C + m g = m a, and moments about the rod's centre of mass."""
    x, y = rod_centre(motion, bodies)
    (x_B, y_B), (x_C, y_C) = loop.pin(motion), loop.slider(motion)
    a_X, a_Y = second_rate(lambda t: rod_centre(motion, bodies, t))
    turning = loop.rate(lambda t: turn_of_rod(motion, t), 2)
    m = bodies.m_rod
    arms = {"F_B_X": y_B - y, "F_B_Y": -(x_B - x), "F_C_X": -(y_C - y), "F_C_Y": x_C - x}
    return [
        ({"F_B_X": 1, "F_C_X": -1}, m * (a_X - bodies.g_X)),
        ({"F_B_Y": 1, "F_C_Y": -1}, m * (a_Y - bodies.g_Y)),
        (arms, bodies.I_rod * turning),
    ]


def slider_rows(motion: Motion, bodies: Bodies) -> list:
    """F_C + N + load + m g = m a along X, where the slider does not move, and along Y."""
    a_X, a_Y = second_rate(lambda t: loop.slider(motion, t))
    m = bodies.m_slider
    return [
        ({"F_C_X": 1, "N_C": 1}, m * (a_X - bodies.g_X) - bodies.F_X),
        ({"F_C_Y": 1}, m * (a_Y - bodies.g_Y) - bodies.F_Y),
    ]


def drive_power(motion: Motion, bodies: Bodies) -> mpf:
    """The power of the drive, W: growth of kinetic energy, less the work of gravity and load."""
    with mp.workdps(2 * loop.DIGITS):
        bodies = Bodies(*(value if value is None else mpf(value) for value in bodies))
        growth = loop.rate(lambda t: kinetic_energy(motion, bodies, t), 1)
        return growth - loop.rate(lambda t: work_of_loads(motion, bodies, t), 1)


def kinetic_energy(motion: Motion, bodies: Bodies, t: mpf) -> mpf:
    """Kinetic energy at a time t, J."""
    places = [
        (bodies.m_crank, lambda u: crank_centre(motion, bodies, u)),
        (bodies.m_rod, lambda u: rod_centre(motion, bodies, u)),
        (bodies.m_slider, lambda u: loop.slider(motion, u)),
    ]
    turns = [
        (bodies.I_crank, lambda u: loop.crank_angle(motion, u)),
        (bodies.I_rod, lambda u: turn_of_rod(motion, u)),
    ]
    moving = sum(
        m * mp.diff(lambda u, p=p, axis=axis: p(u)[axis], t) ** 2 for m, p in places for axis in (0, 1)
    )
    turning = sum(inertia * mp.diff(angle, t) ** 2 for inertia, angle in turns)
    return (moving + turning) / 2


def work_of_loads(motion: Motion, bodies: Bodies, t: mpf) -> mpf:
    """Gravity and load times the places of their bodies, J."""
    (x_1, y_1), (x_2, y_2) = crank_centre(motion, bodies, t), rod_centre(motion, bodies, t)
    x_3, y_3 = loop.slider(motion, t)
    across = bodies.m_crank * x_1 + bodies.m_rod * x_2 + bodies.m_slider * x_3
    up = bodies.m_crank * y_1 + bodies.m_rod * y_2 + bodies.m_slider * y_3
    return bodies.g_X * across + bodies.g_Y * up + bodies.F_X * x_3 + bodies.F_Y * y_3
