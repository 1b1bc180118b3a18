"""Paper B's Tables 1 and 2 over a turn of the crank: curves, their greatest values by stroke, torques.

Designs are in decimals as printed, in doubles or in the digits of the angle; offsets are in mm.
"""

import math

from mpmath import mp, mpf

from tests.papers import paper_b as B
from tests.papers.digits import remembered
from tests.papers.extremes import greatest
from tests.papers.loop import Motion

SPEED = 251  # rad/s
CENTRES = "0.35", "1.05"  # kg: m_2 and m_3 of Table 1 with every centre of mass in the middle
OFFSETS = (0, 10, 20)  # mm


def case_1(theta, e=20, c=64):
    """Table 1 in the paper's letters; offset and rod in mm."""
    m, one = (mp, mpf(1)) if isinstance(theta, mpf) else (math, 1.0)
    return B.Case(theta, one * e / 1000, one * 40 / 1000, one * c / 1000, one * SPEED, m)


def case_2(theta, speed="20.994"):
    """Table 2 in the paper's letters."""
    m, kind = (mp, mpf) if isinstance(theta, mpf) else (math, float)
    return B.Case(theta, kind(0), kind("0.0381"), kind("0.1524"), kind(speed), m)


def motion_of(q):
    """A case as a motion of the raw loop."""
    return Motion(q.theta, q.e, q.k, q.c, q.omega)


def in_millimetres(q):
    """A case with its lengths in the unit of the tables."""
    return q._replace(e=1000 * q.e, k=1000 * q.k, c=1000 * q.c)


def dead_centres(e=20, c=64):
    """Outer and inner dead centre of Table 1, rad."""
    q = case_1(mpf(0), e, c)
    return B.dead_centres(q.e, q.k, q.c, mp)


def degrees(*angles):
    """Angles in degrees."""
    return [mp.degrees(angle) for angle in angles]


def stroke(e=20, c=64):
    """The stroke of Table 1, mm."""
    q = case_1(mpf(0), e, c)
    return 1000 * B.corrected_eq49(q.e, q.k, q.c, mp)


def peaks(curve, e=20, c=64, steps=360):
    """Greatest size of a function of a case of Table 1 in the return and in the advance stroke."""
    outer, inner = dead_centres(e, c)
    ends = (outer, inner), (inner, outer + 2 * mp.pi)
    return tuple(greatest(lambda t: abs(curve(case_1(t, e, c))), *pair, steps)[0] for pair in ends)


def places(curve, e=20, steps=720):
    """The greatest size of a function of a case of Table 1 over a turn, and its crank angle, deg."""
    value, theta = greatest(lambda t: abs(curve(case_1(t, e))), steps=steps)
    return value, mp.degrees(theta) % 360


# --- torques on the crank, by the readings of Eq. 48 that were tried ----------------------------------


def as_printed(q, m_2=CENTRES[0], m_3=CENTRES[1]):
    """Eqs. 48, 46b and 20 as printed."""
    return B.printed_eq48(q, B.printed_eq46b(q, *like(q, m_2, m_3), B.printed_eq20(q)))


def with_right_acceleration(q):
    """Eqs. 48 and 46b as printed with the corrected Eq. 20."""
    return B.printed_eq48(q, B.printed_eq46b(q, *like(q, *CENTRES), B.corrected_eq20(q)))


def with_slider_force(q):
    """Eq. 48 with the rotating mass of Eq. 46b and the slider's force of Eq. 42b as printed."""
    m_2, m_3 = like(q, *CENTRES)
    return B.printed_eq48(q, B.printed_eq38(q, m_2) + B.printed_eq42b(q, m_3))


def right(q, m_3=CENTRES[1]):
    """Eq. 48 corrected, everything right: the inertia torque of the paper's two masses."""
    return B.corrected_eq48(q, B.corrected_eq42a(q, *like(q, m_3)))


def of_rod(q, m_3, excess):
    """The inertia torque with a rod that two masses make heavier to turn by `excess` (kg m2)."""
    m_3, excess = like(q, m_3, excess)
    return right(q, m_3) + excess * B.corrected_eq30(q) * B.printed_eq27(q) / q.omega


def uniform(q):
    """The inertia torque with the uniform rod of Table 1; two masses have three times its inertia."""
    (mass,) = like(q, "0.5")
    return of_rod(q, CENTRES[1], mass * q.c**2 / 6)


def slider_alone(q):
    """Eq. 48 corrected with the slider's mass alone."""
    return right(q, "0.8")


def nearest(q):
    """Masses of crank and slider without the rod's, Eq. 17's sign as printed, the rest of Eq. 20 right."""
    one, two, three = B.a_s_terms(q, 1, 3)
    force = B.printed_eq46b(q, *like(q, "0.2", "0.8"), -one + two + three)
    return B.corrected_eq48(q, force)


def like(q, *masses):
    """Masses, in decimals, in the number type of a case."""
    return tuple(map(mpf if q.m is mp else float, masses))


@remembered
def torques(reading):
    """Peaks of a reading in the return and the advance stroke, N m, by offset in mm."""
    return {e: peaks(reading, e) for e in OFFSETS}


@remembered
def mean(e=20):
    """The mean torque of inertia over a turn, N m, by the trapezoidal rule for a smooth periodic curve."""
    return mp.fsum(right(case_1(2 * mp.pi * n / 360, e)) for n in range(360)) / 360
