"""The motion of a machine from its free bodies alone: Newton's law of crank, rod and slider, solved as it is.

Nothing of desaxe is used. Unknown are the crank's acceleration and the forces at B, C and the guide.
"""

import itertools
import re
from math import cos, pi, sin, sqrt

import numpy as np
from scipy.integrate import solve_ivp

NAMES = "ec AB BC m_crank m_rod m_slider I_crank I_rod g_X g_Y F_X F_Y mu J"
ZERO = dict.fromkeys(re.findall(r"\w+", NAMES), 0.0)


class FreeBodies:
    """A machine: numbers, and loads that are functions of (theta, Y, the sign of the slider's way)."""

    def __init__(self, branch=1, way=1.0, **values):
        self.p = {**ZERO, "r_crank": values["AB"] / 2, "r_rod": values["BC"] / 2, **values}
        self.branch, self.way = branch, way

    def alpha(self, theta, square, torque):
        """The crank's acceleration at omega^2 = square; with friction by both signs of the guide's force."""
        result = []
        for pressed in (1.0, -1.0) if self.p["mu"] else (0.0,):
            alpha, normal = self._solve(theta, square, torque, pressed)
            if not pressed or normal * pressed >= 0.0:
                result.append(alpha)
        assert result
        return result[0]

    def _solve(self, theta, square, torque, pressed):
        p, branch = self.p, self.branch
        s, c = sin(theta), cos(theta)
        sp = (p["ec"] + p["AB"] * s) / p["BC"]
        cp = sqrt(1.0 - sp * sp)
        turn = p["AB"] * c / (p["BC"] * cp)  # dphi/dtheta
        bend = (-p["AB"] * s + p["BC"] * sp * turn**2) / (p["BC"] * cp)
        along, across = np.array([-sp, branch * cp]), np.array([-cp, -branch * sp])  # of the rod, by phi
        B, B1, B2 = (p["AB"] * np.array(v) for v in ([s, c], [c, -s], [-s, -c]))
        u1, u2 = across * turn, across * bend - along * turn**2
        G1, G2 = B1 + p["r_rod"] * u1, B2 + p["r_rod"] * u2
        C1, C2 = B1 + p["BC"] * u1, B2 + p["BC"] * u2
        Y = p["AB"] * c + branch * p["BC"] * cp
        gravity = np.array([p["g_X"], p["g_Y"]])
        goes = np.sign(C1[1] * self.way)
        F = [f(theta, Y, goes) if callable(f := p[n]) else f for n in ("F_X", "F_Y")]
        rod_turn, rod_bend = -branch * turn, -branch * bend  # of the rod, in the sense of theta

        def moment(at, force):
            return at[1] * force[0] - at[0] * force[1]

        # unknown: alpha, B_X, B_Y (crank on rod), C_X, C_Y (rod on slider), N
        A, b = np.zeros((6, 6)), np.zeros(6)
        inertia = p["I_crank"] + p["m_crank"] * p["r_crank"] ** 2 + p["J"]
        A[0] = [inertia, B[1], -B[0], 0, 0, 0]
        b[0] = torque + moment(p["r_crank"] * np.array([s, c]), p["m_crank"] * gravity)
        for k in (0, 1):
            A[1 + k, 0], A[1 + k, 1 + k], A[1 + k, 3 + k] = p["m_rod"] * G1[k], -1.0, 1.0
            b[1 + k] = p["m_rod"] * (gravity[k] - G2[k] * square)
            A[4 + k, 0], A[4 + k, 3 + k] = p["m_slider"] * C1[k], -1.0
            b[4 + k] = p["m_slider"] * (gravity[k] - C2[k] * square) + F[k]
        A[4, 5], A[5, 5] = -1.0, p["mu"] * goes * pressed
        to_B, to_C = -p["r_rod"] * along, (p["BC"] - p["r_rod"]) * along
        A[3] = [p["I_rod"] * rod_turn, -to_B[1], to_B[0], to_C[1], -to_C[0], 0]
        b[3] = -p["I_rod"] * rod_bend * square
        alpha, *_, normal = np.linalg.solve(A, b)
        return alpha, normal

    def period(self, motor, omega_start, edges, at=()):
        """omega^2 at the end, the time and the work of the motor, from the first edge to the last.

        motor   torque of (theta, omega); edges: angles between which everything is smooth
        at      angles at which omega is wanted
        """

        def rate(theta, y):
            omega = self.way * sqrt(y[0])
            torque = motor(theta, omega)
            return [2.0 * self.alpha(theta, y[0], torque), 1.0 / omega, torque]

        y, expected = np.array([omega_start**2, 0.0, 0.0]), []
        for a, b in itertools.pairwise(edges):
            places = [t for t in at if min(a, b) <= t <= max(a, b)]
            result = solve_ivp(
                rate, (a, b), y, method="DOP853", rtol=2.3e-14, atol=1e-16, t_eval=[*places, b], max_step=0.3
            )
            y = result.y[:, -1]
            expected += np.sqrt(result.y[0, : len(places)]).tolist()
        return y[0], abs(y[1]), y[2], self.way * np.array(expected)


def turn(count, way=1.0):
    """The even edges of some turns."""
    return np.linspace(0.0, way * 2.0 * pi * count, 16 * count + 1)
