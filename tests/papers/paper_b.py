"""Paper B by hand: every equation of Obaseki and Alfred, in the paper's own letters.

`printed_*` is what the paper prints, `corrected_*` exists only where that is not right. A `Case` holds the
crank angle theta (rad), offset e, crank k, rod c (m) and crank speed omega (rad/s); `Masses` the paper's
masses (kg) and where they sit (m). The mathematics `m` is the `math` module, or `mpmath.mp` for more digits.

The paper's x is the package's Y and its y the package's X; theta turns the same way; alpha is phi, v_c is
omega_BC, a_c is alpha_BC. s = k + c - x grows towards the crank, so v_s = -V_C and a_s = -a_C. "Inertia
force" is a mass times its acceleration along +x and +y, as Eqs. 37 and 46 have it; the torque of Eqs. 48 and
53 is what the inertia does to the crank, the opposite of what the drive must apply.
"""

import math
from types import ModuleType
from typing import Any, NamedTuple

Vector = tuple[Any, Any]


class Case(NamedTuple):
    """A mechanism at one crank angle, in the paper's letters."""

    theta: Any
    e: Any
    k: Any
    c: Any
    omega: Any
    m: ModuleType = math

    @property
    def sin(self) -> Any:
        """The sine of theta."""
        return self.m.sin(self.theta)

    @property
    def cos(self) -> Any:
        """The cosine of theta."""
        return self.m.cos(self.theta)

    @property
    def side(self) -> Any:
        """e + k sin(theta), m."""
        return self.e + self.k * self.sin

    @property
    def square(self) -> Any:
        """The bracket c^2 - (e + k sin(theta))^2, m2: its roots are written out in each equation."""
        return self.c**2 - self.side**2

    def root(self, power: int) -> Any:
        """[c^2 - (e + k sin(theta))^2]^(power/2), m^power."""
        return self.m.sqrt(self.square) ** power


class Masses(NamedTuple):
    """Masses of crank, rod, slider, kg; k_1 from the crank's centre, c_2 from the pin to their centres, m."""

    m_k: Any
    m_c: Any
    m_s: Any
    k_1: Any
    c_2: Any


# --- the crank, Eqs. 1 to 3 -----------------------------------------------------------------------


def printed_eq2b_middle(omega: Any, dtheta_dt: Any) -> Any:
    """The middle of Eq. 2b as printed: omega dtheta/dt, which is rad2/s2 and no velocity."""
    return omega * dtheta_dt


# --- the slider's position, Eqs. 4 to 10 ----------------------------------------------------------


def printed_eq4(q: Case, alpha: Any) -> Any:
    """x = k cos(theta) + c cos(alpha), m (Eq. 4)."""
    return q.k * q.cos + q.c * q.m.cos(alpha)


def printed_eq5a(q: Case) -> Any:
    """h = k sin(theta), m (Eq. 5a)."""
    return q.k * q.sin


def printed_eq6(q: Case) -> Any:
    """sin(alpha) (Eq. 6)."""
    return q.e / q.c + q.k / q.c * q.sin


def printed_eq7(q: Case) -> Any:
    """cos(alpha) (Eq. 7)."""
    return 1 / q.c * q.root(1)


def printed_eq8(q: Case) -> Any:
    """x, m (Eq. 8)."""
    return q.k * q.cos + q.root(1)


def printed_eq10(q: Case) -> Any:
    """s as printed, m (Eq. 10): the sign of the root is wrong."""
    return (q.k + q.c) - q.k * q.cos + q.root(1)


def corrected_eq10(q: Case) -> Any:
    """s, m (Eq. 10 corrected)."""
    return (q.k + q.c) - q.k * q.cos - q.root(1)


# --- the slider's velocity and acceleration, Eqs. 11 to 20 ----------------------------------------


def printed_eq12(q: Case) -> Any:
    """ds/dtheta, m (Eq. 12)."""
    return q.k * q.sin + q.k * q.cos * q.side / q.root(1)


def printed_eq13(q: Case) -> Any:
    """v_s, m/s (Eq. 13)."""
    return q.omega * q.k * q.sin + q.omega * q.k * q.cos * q.side / q.root(1)


def printed_eq17(q: Case) -> Any:
    """dv_1/dtheta as printed, m/s (Eq. 17): the sign is wrong."""
    return -q.omega * q.k * q.cos


def corrected_eq17(q: Case) -> Any:
    """dv_1/dtheta, m/s (Eq. 17 corrected)."""
    return q.omega * q.k * q.cos


def eq18(q: Case, sign: int, first: int, second: int) -> Any:
    """Eq. 18 with the sign and the powers of the root of choice."""
    top = q.omega * q.k * (q.k * q.m.cos(2 * q.theta) - q.e * q.sin)
    return sign * (top / q.root(first) + q.omega * q.k**2 * q.cos**2 * q.side**2 / q.root(second))


def printed_eq18(q: Case) -> Any:
    """dv_2/dtheta as printed (Eq. 18): wrong signs, and the exponents 3/2 and 5/2 belong one lower."""
    return eq18(q, -1, 3, 5)


def corrected_eq18(q: Case) -> Any:
    """dv_2/dtheta, m/s (Eq. 18 corrected)."""
    return eq18(q, 1, 1, 3)


def printed_eq19(q: Case, dv1: Any, dv2: Any) -> Any:
    """a_s = omega dv_1/dtheta + omega dv_2/dtheta, m/s2 (Eq. 19)."""
    return q.omega * dv1 + q.omega * dv2


def a_s_terms(q: Case, first: int, second: int) -> tuple[Any, Any, Any]:
    """The three terms of Eq. 20 without their signs, with the powers of the root of choice."""
    return (
        q.omega**2 * q.k * q.cos,
        q.omega**2 * q.k * (q.k * q.m.cos(2 * q.theta) - q.e * q.sin) / q.root(first),
        (q.omega * q.k * q.cos * q.side) ** 2 / q.root(second),
    )


def printed_eq20(q: Case) -> Any:
    """a_s as printed (Eq. 20): all signs and both exponents are wrong."""
    one, two, three = a_s_terms(q, 3, 5)
    return -one - two - three


def corrected_eq20(q: Case) -> Any:
    """a_s, m/s2 (Eq. 20 corrected)."""
    return sum(a_s_terms(q, 1, 3))


# --- the rod, Eqs. 21 to 30 -----------------------------------------------------------------------


def printed_eq21(q: Case) -> Vector:
    """Gamma and delta (Eq. 21)."""
    return q.e / q.c, q.k / q.c


def printed_eq22(q: Case) -> Any:
    """Alpha, rad (Eq. 22)."""
    gamma, delta = printed_eq21(q)
    return q.m.asin(gamma + delta * q.sin)


def printed_eq24(q: Case) -> Any:
    """cos(alpha) dalpha/dtheta (Eq. 24)."""
    return printed_eq21(q)[1] * q.cos


def printed_eq27(q: Case) -> Any:
    """v_c, rad/s (Eq. 27)."""
    return q.omega * q.k * q.cos / q.m.sqrt(q.square)


def eq29(q: Case, sign: int) -> Any:
    """Eq. 29 with the sign of its second fraction of choice."""
    first = -q.omega * q.k * q.sin / q.root(1)
    return first + sign * q.omega * q.k**2 * q.cos**2 * q.side / q.root(3)


def printed_eq29(q: Case) -> Any:
    """dv_c/dtheta as printed, rad/s (Eq. 29): the second sign is wrong."""
    return eq29(q, -1)


def corrected_eq29(q: Case) -> Any:
    """dv_c/dtheta, rad/s (Eq. 29 corrected)."""
    return eq29(q, 1)


def printed_eq30(q: Case) -> Any:
    """a_c as printed, rad/s2 (Eq. 30): the second sign is wrong, as in Eq. 29."""
    first = -(q.omega**2) * q.k * q.sin / q.root(1)
    return first - q.omega**2 * q.k**2 * q.cos**2 * q.side / q.root(3)


def corrected_eq30(q: Case) -> Any:
    """a_c, rad/s2 (Eq. 30 corrected)."""
    first = -(q.omega**2) * q.k * q.sin / q.root(1)
    return first + q.omega**2 * q.k**2 * q.cos**2 * q.side / q.root(3)


# --- equivalent masses, Eqs. 31 to 36 -------------------------------------------------------------


def printed_eq32(q: Case, w: Masses) -> Any:
    """m_2c = m_c c_3/c, kg (Eq. 32)."""
    return w.m_c * (q.c - w.c_2) / q.c


def printed_eq33(q: Case, w: Masses) -> Any:
    """m_3c = m_c c_2/c, kg (Eq. 33)."""
    return w.m_c * w.c_2 / q.c


def printed_eq34(q: Case, w: Masses) -> Any:
    """m_3, kg (Eq. 34)."""
    return printed_eq33(q, w) + w.m_s


def printed_eq35(q: Case, w: Masses) -> Any:
    """m_2k = m_k k_1/k, kg (Eq. 35)."""
    return w.m_k * w.k_1 / q.k


def printed_eq36(q: Case, w: Masses) -> Any:
    """m_2, kg (Eq. 36)."""
    return printed_eq32(q, w) + printed_eq35(q, w)


# --- forces and torques, Eqs. 37 to 48: of the equivalent masses m_2 and m_3 ----------------------


def printed_eq37a(q: Case, m_2: Any) -> Any:
    """F_k, N (Eq. 37a)."""
    return m_2 * q.omega**2 * q.k


def printed_eq37b(q: Case, m_2: Any) -> Vector:
    """F_k along x and y, N (Eq. 37b)."""
    return -(m_2 * q.omega**2 * q.k * q.cos), -(m_2 * q.omega**2 * q.k * q.sin)


def printed_eq38(q: Case, m_2: Any) -> Any:
    """R_x as printed, N (Eq. 38): without what comes through the rod."""
    return -m_2 * q.omega**2 * q.k * q.cos


def corrected_eq38(q: Case, m_2: Any, m_3: Any) -> Any:
    """R_x, the frame's force on the crank, N (Eq. 38 corrected)."""
    return -m_2 * q.omega**2 * q.k * q.cos - m_3 * corrected_eq20(q)


def printed_eq39(q: Case, m_2: Any) -> Any:
    """R_y as printed, N (Eq. 39): without what comes through the rod."""
    return -m_2 * q.omega**2 * q.k * q.sin


def corrected_eq39(q: Case, m_2: Any, m_3: Any) -> Any:
    """R_y, the frame's force on the crank, N (Eq. 39 corrected)."""
    return -m_2 * q.omega**2 * q.k * q.sin + m_3 * corrected_eq20(q) * q.side / q.root(1)


def printed_eq40(q: Case, m_2: Any) -> Any:
    """F_t as printed, N (Eq. 40): F_k is radial and has no part along the crank's circle."""
    return printed_eq37a(q, m_2) * q.m.tan(printed_eq22(q) + q.theta)


def corrected_eq40(q: Case, F_c: Any) -> Any:
    """F_t = F_c sin(alpha + theta), N (Eq. 40 corrected): of the rod on the crank."""
    return F_c * q.m.sin(printed_eq22(q) + q.theta)


def printed_eq41(q: Case, m_2: Any) -> Any:
    """F_c as printed, N (Eq. 41): the rod does not carry the rotating mass."""
    return printed_eq37a(q, m_2) / q.m.cos(printed_eq22(q) + q.theta)


def corrected_eq41(q: Case, m_3: Any) -> Any:
    """F_c = F_Is/cos(alpha), N (Eq. 41 corrected): positive when the rod pushes the slider outwards."""
    return corrected_eq42a(q, m_3) / q.m.cos(printed_eq22(q))


def printed_eq42a(m_3: Any, a_s: Any) -> Any:
    """F_Is = -m_3 a_s along x, N (Eq. 42a)."""
    return -m_3 * a_s


def corrected_eq42a(q: Case, m_3: Any) -> Any:
    """Eq. 42a, which is right, with the corrected a_s of Eq. 20, N."""
    return printed_eq42a(m_3, corrected_eq20(q))


def printed_eq42b(q: Case, m_3: Any) -> Any:
    """F_Is as printed (Eq. 42b): two signs are wrong and an e is missing before sin(theta)."""
    second = q.omega**2 * q.k * (q.k - 2 * q.k * q.sin**2 - q.sin) / q.root(1)
    return m_3 * (q.omega**2 * q.k * q.cos + second - (q.omega * q.k * q.cos * q.side) ** 2 / q.root(3))


def corrected_eq42b(q: Case, m_3: Any) -> Any:
    """F_Is, N (Eq. 42b corrected)."""
    second = q.omega**2 * q.k * (q.k - 2 * q.k * q.sin**2 - q.e * q.sin) / q.root(1)
    return -m_3 * (q.omega**2 * q.k * q.cos + second + (q.omega * q.k * q.cos * q.side) ** 2 / q.root(3))


def printed_eq45(F_Is: Any, F_c: Any, alpha: Any, m: ModuleType) -> Any:
    """F_s = F_Is + F_c cos(alpha), N (Eq. 45)."""
    return F_Is + F_c * m.cos(alpha)


def printed_eq46a(q: Case, m_2: Any, m_3: Any, a_s: Any) -> Vector:
    """F_I along x and y, N (Eq. 46a)."""
    return -(m_2 * q.omega**2 * q.k * q.cos + m_3 * a_s), -(m_2 * q.omega**2 * q.k * q.sin)


def printed_eq46b(q: Case, m_2: Any, m_3: Any, a_s: Any) -> Any:
    """F_i along x, N (Eq. 46b)."""
    return -(m_2 * q.omega**2 * q.k * q.cos + m_3 * a_s)


def printed_eq47(q: Case, m_2: Any) -> Any:
    """T_k = R_x k as printed, N m (Eq. 47): a radial force has no moment about the centre."""
    return -q.k * m_2 * q.omega**2 * q.k * q.cos


def printed_eq48(q: Case, F_i: Any) -> Any:
    """T = k F_i tan(alpha) as printed, N m (Eq. 48)."""
    return q.k * F_i * q.m.tan(printed_eq22(q))


def corrected_eq48(q: Case, F_Is: Any) -> Any:
    """T = k F_Is sin(alpha + theta)/cos(alpha), N m (Eq. 48 corrected)."""
    alpha = printed_eq22(q)
    return q.k * F_Is * q.m.sin(alpha + q.theta) / q.m.cos(alpha)


def drive_torque(q: Case, m_3: Any) -> Any:
    """The torque that keeps the crank's speed in the paper's model, N m: the opposite of Eq. 48 corrected."""
    return -corrected_eq48(q, corrected_eq42a(q, m_3))


# --- design and comparison, Eqs. 49 to 53 ---------------------------------------------------------


def printed_eq49(k: Any) -> Any:
    """Stroke, m, as printed (Eq. 49): only for e = 0."""
    return 2 * k


def corrected_eq49(e: Any, k: Any, c: Any, m: ModuleType = math) -> Any:
    """Stroke, m (Eq. 49 corrected)."""
    return m.sqrt((c + k) ** 2 - e**2) - m.sqrt((c - k) ** 2 - e**2)


def printed_eq50(e: Any) -> Any:
    """Rod length, m, as printed (Eq. 50)."""
    return 32 * e / 10


def printed_eq51(advance: Any, back: Any) -> Any:
    """Q, of times or of crank angles (Eq. 51)."""
    return advance / back


def printed_eq52(q: Case) -> Any:
    """a_is, m/s2 (Eq. 52): d2x/dt2 to first order in k/c, for e = 0."""
    return -q.k * q.omega**2 * (q.cos + q.k / q.c * q.m.cos(2 * q.theta))


def reversed_eq52(q: Case) -> Any:
    """The first-order a_s = d2s/dt2, m/s2: Eq. 52 reversed."""
    return q.k * q.omega**2 * (q.cos + q.k / q.c * q.m.cos(2 * q.theta))


def printed_eq53(q: Case, m_3: Any) -> Any:
    """T_i, N m (Eq. 53): the inertia torque to first order in k/c, for e = 0."""
    one = q.k * q.sin / (4 * q.c)
    two = q.m.sin(2 * q.theta) / 2
    three = 3 * q.k * q.m.sin(3 * q.theta) / (4 * q.c)
    return m_3 * q.k**2 * q.omega**2 * (one - two - three)


# --- closed forms that the paper's numbers are measured against -----------------------------------


def dead_centres(e: Any, k: Any, c: Any, m: ModuleType = math) -> Vector:
    """Crank angles, rad, where the slider is farthest (crank and rod in line) and nearest (folded)."""
    return -m.asin(e / (c + k)), m.pi - m.asin(e / (c - k))


def time_ratio(e: Any, k: Any, c: Any, m: ModuleType = math) -> Any:
    """Crank angle of the outward stroke over that of the inward stroke."""
    outer, inner = dead_centres(e, k, c, m)
    return printed_eq51(2 * m.pi - (inner - outer), inner - outer)
