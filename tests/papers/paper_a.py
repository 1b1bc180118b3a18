"""Paper A by hand: every equation and every line of the listing of Siswanto and Ibrahim.

`printed_*` is what the paper prints, `corrected_*` exists only where that is not right. Equations use the
crank's speed `omega` (rad/s) and angular acceleration `alpha` (rad/s2) at the crank angle `theta` (rad);
lengths are in metres. Each function takes its mathematics from `m`: the `math` module, or `mpmath.mp` for
more digits.

Frame of the paper's vectors (Eqs. 1 to 4, 8, 9, 12, 13): x like the package's X, y the opposite of the
package's Y, because the paper hangs the slider below the crank centre. V_C and a_C themselves are positive
away from the crank centre, as in the package, which is why they carry a minus inside Eqs. 9 and 13.
"""

import math
from collections.abc import Sequence
from types import ModuleType
from typing import Any

Vector = tuple[Any, Any]
Signs = Sequence[int]


def add(*vectors: Vector) -> Vector:
    """Sum of plane vectors: the right-hand sides of Eqs. 1, 3, 8 and 12."""
    return sum(v[0] for v in vectors), sum(v[1] for v in vectors)


# --- the crank, Eqs. 1 to 4 -----------------------------------------------------------------------


def printed_eq2(theta: Any, AB: Any, omega: Any, m: ModuleType = math) -> Vector:
    """Velocity of the crank pin B, m/s (Eq. 2)."""
    return AB * omega * m.cos(theta), AB * omega * m.sin(theta)


def printed_normal(AB: Any, omega: Any, alpha: Any) -> Any:
    """Size of the normal acceleration of B about A, m/s2, as the text above Eq. 3 gives it."""
    return AB * omega**2


def printed_tangential(AB: Any, omega: Any, alpha: Any) -> Any:
    """Size of the tangential acceleration of B about A, m/s2, as the text above Eq. 3 gives it."""
    return AB * omega**2


def corrected_tangential(AB: Any, omega: Any, alpha: Any) -> Any:
    """Size of the tangential acceleration of B about A, m/s2."""
    return AB * alpha


def crank_normal(theta: Any, AB: Any, omega: Any, m: ModuleType = math) -> Vector:
    """First vector of Eqs. 4 and 13, m/s2: towards A."""
    return -AB * omega**2 * m.sin(theta), AB * omega**2 * m.cos(theta)


def crank_tangential(theta: Any, AB: Any, alpha: Any, m: ModuleType = math) -> Vector:
    """Second vector of Eqs. 4 and 13, m/s2: across AB."""
    return AB * alpha * m.cos(theta), AB * alpha * m.sin(theta)


def printed_eq4(theta: Any, AB: Any, omega: Any, alpha: Any, m: ModuleType = math) -> Vector:
    """Acceleration of the crank pin B, m/s2 (Eq. 4)."""
    return add(crank_normal(theta, AB, omega, m), crank_tangential(theta, AB, alpha, m))


# --- the rod, Eqs. 5 to 18 ------------------------------------------------------------------------


def printed_eq6(theta: Any, ec: Any, AB: Any, BC: Any, m: ModuleType = math) -> Any:
    """Phi, the angle between rod and slider axis, rad (Eq. 6)."""
    return m.asin((ec + AB * m.sin(theta)) / BC)


def printed_eq7(theta: Any, ec: Any, AB: Any, BC: Any, m: ModuleType = math) -> Any:
    """Y, the slider's distance from A along its axis, m (Eq. 7)."""
    return AB * m.cos(theta) + BC * m.cos(printed_eq6(theta, ec, AB, BC, m))


def printed_eq9(phi: Any, BC: Any, omega_BC: Any, V_C: Any, m: ModuleType = math) -> Vector:
    """Right-hand side of Eq. 9, m/s; its left-hand side is Eq. 2."""
    return add((0, -V_C), (BC * omega_BC * m.cos(phi), -BC * omega_BC * m.sin(phi)))


def printed_eq10(theta: Any, ec: Any, AB: Any, BC: Any, omega: Any, m: ModuleType = math) -> Any:
    """omega_BC = d phi/dt, rad/s (Eq. 10)."""
    return AB * omega * m.cos(theta) / (BC * m.cos(printed_eq6(theta, ec, AB, BC, m)))


def V_C_of_signs(
    signs: Signs, theta: Any, ec: Any, AB: Any, BC: Any, omega: Any, m: ModuleType = math
) -> Any:
    """V_C, m/s, with a sign of choice before its crank and its rod term: Eq. 11 is (-1, -1)."""
    crank = AB * omega * m.sin(theta)
    rod = BC * printed_eq10(theta, ec, AB, BC, omega, m) * m.sin(printed_eq6(theta, ec, AB, BC, m))
    return signs[0] * crank + signs[1] * rod


def printed_eq11(theta: Any, ec: Any, AB: Any, BC: Any, omega: Any, m: ModuleType = math) -> Any:
    """V_C = dY/dt, m/s (Eq. 11)."""
    return V_C_of_signs((-1, -1), theta, ec, AB, BC, omega, m)


def printed_eq15(theta: Any, AB: Any, omega: Any, m: ModuleType = math) -> Any:
    """alpha_BC1, m/s2 (Eq. 15)."""
    return -AB * omega**2 * m.sin(theta)


def printed_eq16(theta: Any, AB: Any, alpha: Any, m: ModuleType = math) -> Any:
    """alpha_BC2, m/s2 (Eq. 16)."""
    return AB * alpha * m.cos(theta)


def printed_eq17(theta: Any, ec: Any, AB: Any, BC: Any, omega: Any, m: ModuleType = math) -> Any:
    """alpha_BC3, m/s2 (Eq. 17)."""
    omega_BC = printed_eq10(theta, ec, AB, BC, omega, m)
    return -BC * omega_BC**2 * m.sin(printed_eq6(theta, ec, AB, BC, m))


def printed_eq18(theta: Any, ec: Any, AB: Any, BC: Any, m: ModuleType = math) -> Any:
    """alpha_BC4, m (Eq. 18)."""
    return BC * m.cos(printed_eq6(theta, ec, AB, BC, m))


def alpha_BC_of_signs(
    signs: Signs, theta: Any, ec: Any, AB: Any, BC: Any, omega: Any, alpha: Any, m: ModuleType = math
) -> Any:
    """alpha_BC, rad/s2, with signs of choice before alpha_BC1 to alpha_BC3: Eq. 14 is (1, 1, -1)."""
    parts = (
        printed_eq15(theta, AB, omega, m),
        printed_eq16(theta, AB, alpha, m),
        printed_eq17(theta, ec, AB, BC, omega, m),
    )
    return sum(s * part for s, part in zip(signs, parts, strict=True)) / printed_eq18(theta, ec, AB, BC, m)


def printed_eq14(theta: Any, ec: Any, AB: Any, BC: Any, omega: Any, alpha: Any, m: ModuleType = math) -> Any:
    """alpha_BC = d2 phi/dt2, rad/s2 (Eq. 14)."""
    return alpha_BC_of_signs((1, 1, -1), theta, ec, AB, BC, omega, alpha, m)


# --- the slider's acceleration, Eqs. 19 to 23 -----------------------------------------------------


def printed_eq20(theta: Any, AB: Any, omega: Any, m: ModuleType = math) -> Any:
    """a_C1, m/s2 (Eq. 20)."""
    return -AB * omega**2 * m.cos(theta)


def printed_eq21(theta: Any, AB: Any, alpha: Any, m: ModuleType = math) -> Any:
    """a_C2, m/s2 (Eq. 21)."""
    return -AB * alpha * m.sin(theta)


def printed_eq22(theta: Any, ec: Any, AB: Any, BC: Any, omega: Any, alpha: Any, m: ModuleType = math) -> Any:
    """a_C3, m/s2 (Eq. 22)."""
    alpha_BC = printed_eq14(theta, ec, AB, BC, omega, alpha, m)
    return -BC * alpha_BC * m.sin(printed_eq6(theta, ec, AB, BC, m))


def printed_eq23(theta: Any, ec: Any, AB: Any, BC: Any, omega: Any, m: ModuleType = math) -> Any:
    """a_C4, m/s2 (Eq. 23)."""
    omega_BC = printed_eq10(theta, ec, AB, BC, omega, m)
    return -BC * omega_BC**2 * m.cos(printed_eq6(theta, ec, AB, BC, m))


def a_C_parts(
    theta: Any, ec: Any, AB: Any, BC: Any, omega: Any, alpha: Any, m: ModuleType = math
) -> tuple[Any, Any, Any, Any]:
    """The four terms a_C1 to a_C4, m/s2 (Eqs. 20 to 23)."""
    return (
        printed_eq20(theta, AB, omega, m),
        printed_eq21(theta, AB, alpha, m),
        printed_eq22(theta, ec, AB, BC, omega, alpha, m),
        printed_eq23(theta, ec, AB, BC, omega, m),
    )


def a_C_of_signs(
    signs: Signs, theta: Any, ec: Any, AB: Any, BC: Any, omega: Any, alpha: Any, m: ModuleType = math
) -> Any:
    """a_C, m/s2, with signs of choice before a_C1 to a_C4: Eq. 19 is (1, 1, -1, -1)."""
    parts = a_C_parts(theta, ec, AB, BC, omega, alpha, m)
    return sum(s * part for s, part in zip(signs, parts, strict=True))


def printed_eq19(theta: Any, ec: Any, AB: Any, BC: Any, omega: Any, alpha: Any, m: ModuleType = math) -> Any:
    """a_C as printed, m/s2 (Eq. 19): two signs are wrong."""
    return a_C_of_signs((1, 1, -1, -1), theta, ec, AB, BC, omega, alpha, m)


def corrected_eq19(
    theta: Any, ec: Any, AB: Any, BC: Any, omega: Any, alpha: Any, m: ModuleType = math
) -> Any:
    """a_C = a_C1 + a_C2 + a_C3 + a_C4 = d2Y/dt2, m/s2 (Eq. 19 corrected)."""
    return a_C_of_signs((1, 1, 1, 1), theta, ec, AB, BC, omega, alpha, m)


# --- the worksheet: omega0 and alpha are its constants (Eqs. 24, 25, listing) ---------------------


class Worksheet:
    """The listing's functions: `omega0` (rad/s) and `alpha` (rad/s2) are set once, above it (Fig. 7).

    Lines that are not right have a `corrected_` twin. Arguments are in the paper's order.
    """

    def __init__(self, omega0: Any, alpha: Any, m: ModuleType = math) -> None:
        """Set the two constants and the mathematics."""
        self.omega0, self.alpha, self.m = omega0, alpha, m

    def omega(self, theta: Any) -> Any:
        """Crank speed, rad/s."""
        return self.m.sqrt(self.omega0**2 + 2 * self.alpha * theta)

    def V_B(self, theta: Any, AB: Any) -> Vector:
        """Velocity of the crank pin, m/s, in the paper's frame."""
        return printed_eq2(theta, AB, self.omega(theta), self.m)

    def omega_BC(self, *design: Any) -> Any:
        """Rod rate, rad/s."""
        return printed_eq10(*design, self.omega(design[0]), self.m)

    def V_C(self, *design: Any) -> Any:
        """Slider velocity as printed, m/s: the sign of the whole line is wrong."""
        return V_C_of_signs((1, 1), *design, self.omega(design[0]), self.m)

    def corrected_V_C(self, *design: Any) -> Any:
        """Slider velocity, m/s, with the signs of Eq. 11; Eq. 24."""
        return V_C_of_signs((-1, -1), *design, self.omega(design[0]), self.m)

    def alpha_BC(self, *design: Any) -> Any:
        """Rod angular acceleration, rad/s2."""
        return printed_eq14(*design, self.omega(design[0]), self.alpha, self.m)

    def a_C(self, *design: Any) -> Any:
        """Slider acceleration as printed, m/s2: two signs are wrong, as in Eq. 19."""
        return printed_eq19(*design, self.omega(design[0]), self.alpha, self.m)

    def corrected_a_C(self, *design: Any) -> Any:
        """Slider acceleration, m/s2; Eq. 25."""
        return corrected_eq19(*design, self.omega(design[0]), self.alpha, self.m)
