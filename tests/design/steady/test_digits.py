"""Steady states and gradients against 50 digits: Fourier collocation on the raw loop closure, by mpmath.

Values at equal steps of the crank, of which the trigonometric polynomial obeys dE/dtheta = T - L at each. The
derivatives are differences of such solutions; nothing is taken from the derivation or from the panels.
"""

import mpmath as mp
import numpy as np
import pytest

import desaxe as dx
from tests.effort import cases

POINTS = 121  # odd
KEYS = ("period", "omega_mean", "fluctuation", "power_mean")
STEP = mp.mpf("1e-15")


def coefficients(p, theta):
    """Effective inertia and the work of all forces but the motor's, by dtheta."""
    s, c = mp.sin(theta), mp.cos(theta)
    u, du = p["AB"] * s + p["ec"], p["AB"] * c
    v = mp.sqrt(p["BC"] ** 2 - u**2)  # C is v beyond B
    dv = -u * du / v
    y_slope = -p["AB"] * s + dv
    share = p["r_rod"] / p["BC"]
    x_rod, y_rod = du * (1 - share), -p["AB"] * s + share * dv
    turn = (u * dv - v * du) / p["BC"] ** 2
    inertia = p["I_crank"] + p["J"] + p["m_slider"] * y_slope**2
    inertia += p["m_rod"] * (x_rod**2 + y_rod**2) + p["I_rod"] * turn**2
    force = p["still"] + p["wave"] * s + p["m_slider"] * p["g_Y"]
    return inertia, force * y_slope + p["m_rod"] * p["g_Y"] * y_rod


def kloss(p, omega):
    slip = 1 - p["gear"] * omega / p["synchronous_speed"]
    return (
        2
        * p["gear"]
        * p["breakdown_torque"]
        * slip
        * p["breakdown_slip"]
        / (slip**2 + p["breakdown_slip"] ** 2)
    )


def differences():
    """Return the matrix that differentiates a trigonometric polynomial at equal steps."""
    j = np.arange(POINTS)
    gap = j[:, None] - j
    row = [mp.mpf(0)] + [mp.mpf((-1) ** k) / (2 * mp.sin(mp.pi * k / POINTS)) for k in range(1, POINTS)]
    return [[row[abs(g)] * (1 if g > 0 else -1) for g in line] for line in gap.tolist()]


class Exact:
    """The periodic motion near a start, of parameters at 50 digits."""

    def __init__(self, p, slopes, E):
        angles = [2 * mp.pi * k / POINTS for k in range(POINTS)]
        self.p, self.course = p, [coefficients(p, theta) for theta in angles]
        rough = np.array([[float(x) for x in line] for line in slopes])
        for _ in range(40):
            omega = [mp.sqrt(2 * e / M) for e, (M, _) in zip(E, self.course, strict=True)]
            self.torque = [kloss(p, w) for w in omega]
            push = [t + work for t, (_, work) in zip(self.torque, self.course, strict=True)]
            left = [f - mp.fdot(line, E) for f, line in zip(push, slopes, strict=True)]
            steep = [mp.diff(lambda w: kloss(p, w), w) * w / (2 * e) for w, e in zip(omega, E, strict=True)]
            size = max(map(abs, left))
            step = np.linalg.solve(
                rough - np.diag([float(x) for x in steep]), [float(x / size) for x in left]
            )
            E = [e + size * x for e, x in zip(E, step.tolist(), strict=True)]
            if size < mp.mpf("1e-42"):
                break
        assert size < mp.mpf("1e-42")
        self.E, self.omega = E, omega

    def values(self):
        """The figures that have gradients."""
        turn = 2 * mp.pi
        period = mp.fsum(1 / w for w in self.omega) * turn / POINTS
        mean, work = turn / period, mp.fsum(self.torque) * turn / POINTS
        fast, slow = (self.extreme(sign) for sign in (1, -1))
        return dict(zip(KEYS, (period, mean, (fast - slow) / mean, work / period), strict=True))

    def extreme(self, sign):
        """The largest or smallest speed, by Newton's method on the trigonometric polynomial."""
        k = max(range(POINTS), key=lambda k: sign * self.omega[k])
        x = 2 * mp.pi * k / POINTS
        for _ in range(7):
            a, b = mp.diff(self.speed, x), mp.diff(self.speed, x, 2)
            x -= a / b
        return self.speed(x)

    def speed(self, theta):
        found = mp.mpf(0)
        for k, e in enumerate(self.E):
            gap = theta - 2 * mp.pi * k / POINTS
            half = mp.sin(gap / 2)
            found += e if half == 0 else e * mp.sin(POINTS * gap / 2) / (POINTS * half)
        return mp.sqrt(2 * found / coefficients(self.p, theta)[0])


def drawn(seed):
    """A machine and its motor, as plain numbers."""
    rng = np.random.default_rng(seed)
    AB = rng.uniform(0.03, 0.06)
    BC = AB * rng.uniform(3.5, 5.0)
    top = rng.uniform(8, 30)
    gear = rng.uniform(1, 10)
    machine = {
        "ec": rng.uniform(-0.2, 0.2) * AB, "AB": AB, "BC": BC, "m_rod": rng.uniform(0.5, 3),
        "m_slider": rng.uniform(1, 8), "I_crank": rng.uniform(0.2, 2), "I_rod": rng.uniform(0, 0.02),
        "r_rod": rng.uniform(0.2, 0.8) * BC, "g_Y": -9.81,
    }  # fmt: skip
    motor = {
        "breakdown_torque": rng.uniform(5, 20) / gear, "breakdown_slip": rng.uniform(0.2, 0.5),
        "synchronous_speed": top * gear, "gear": gear,
    }  # fmt: skip
    torque = motor["breakdown_torque"] * gear
    load = {"still": rng.uniform(-100, 100), "wave": rng.uniform(0.1, 1.2) * torque / AB}
    return machine, motor, load, 10 ** rng.uniform(0, 2.5)


@pytest.mark.sampled
def test_values_and_gradients_to_fifty_digits():
    with mp.workdps(50):
        slopes = differences()
        for seed in range(cases(1, 2, 300)):
            machine, motor, load, J = drawn(seed)
            force = dx.over_theta(lambda x, a=load["still"], b=load["wave"]: a + b * np.sin(x))
            found = dx.steady(torque=dx.kloss(**motor), flywheel_inertia=J, F_Y=force, **machine)
            assert found["status"] == 0
            exactly = {name: mp.mpf(value) for name, value in {**machine, **motor, **load, "J": J}.items()}
            step = (len(found["theta"]) - 1) / POINTS
            theta = np.arange(POINTS) * step
            omega = np.interp(theta, np.arange(len(found["omega"])), found["omega"])
            angles = [2 * mp.pi * k / POINTS for k in range(POINTS)]
            inertia = [coefficients(exactly, angle)[0] for angle in angles]
            start = [M * mp.mpf(w) ** 2 / 2 for M, w in zip(inertia, omega.tolist(), strict=True)]
            truth = Exact(exactly, slopes, start)
            for key, value in truth.values().items():
                assert found[key] == pytest.approx(float(value), rel=1e-11), (seed, key)
            names = np.random.default_rng(seed).permutation([*machine, *motor, "J"])[:2].tolist()
            for name in names:
                sides = []
                for sign in (1, -1):
                    moved = {**exactly, name: exactly[name] + sign * STEP}
                    sides.append(Exact(moved, slopes, truth.E).values())
                for key in KEYS:
                    slope = float((sides[0][key] - sides[1][key]) / (2 * STEP))
                    own = found["gradient"][key]["flywheel_inertia" if name == "J" else name]
                    size = abs(found[key] / float(exactly[name] or 1))
                    assert abs(own - slope) < 1e-9 * (abs(slope) + 1e-3 * size), (seed, key, name)
