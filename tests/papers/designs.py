"""Random designs and how a formula of the paper is compared, with the loop closure and with the package."""

import math
import random
from types import ModuleType
from typing import NamedTuple

from mpmath import mp, mpf

import desaxe as dx
from tests.papers import loop
from tests.papers import paper_a as A
from tests.papers.loop import Motion

CRANK, ROD, SPEED = 0.125, 0.35, 157.08  # m, m, rad/s: the worked numbers of Sec. III
EXACT = A.Worksheet(mpf(SPEED), mpf(0), mp)
CASE = Motion(math.pi / 3, 0.0, CRANK, ROD, SPEED)  # test cases 1 and 2
TURN = 2 * math.pi


class Point(NamedTuple):
    """The arguments of the paper's equations, in doubles or in more digits."""

    theta: float
    ec: float
    AB: float
    BC: float
    omega: float
    alpha: float
    omega0: float
    m: ModuleType

    @property
    def design(self):
        """The four arguments of the worksheet's functions."""
        return self.theta, self.ec, self.AB, self.BC

    @property
    def side(self):
        """X_B - X_C, the rod's reach across the slider axis, m."""
        return self.ec + self.AB * self.m.sin(self.theta)

    @property
    def pin_height(self):
        """Y_B, m."""
        return self.AB * self.m.cos(self.theta)

    @property
    def sheet(self):
        """The worksheet with this point's constants."""
        return A.Worksheet(self.omega0, self.alpha, self.m)


def random_motion(rng, number):
    """A design that turns fully at a random angle; ec and alpha take all four pairs of signs in turn."""
    AB = rng.uniform(0.02, 1.0)
    BC = AB * rng.uniform(1.3, 5.0)
    ec = (-1) ** number * rng.uniform(0.05, 0.9) * (BC - AB)
    theta = rng.choice([-1, 1]) * rng.uniform(0.2, 3.0)
    omega0 = rng.uniform(5.0, 200.0)
    alpha = (-1) ** (number // 2) * rng.uniform(0.1, 0.4) * omega0**2 / abs(theta)
    return Motion(theta, ec, AB, BC, omega0, alpha)


RNG = random.Random(20120223)
DESIGNS = [random_motion(RNG, number) for number in range(24)]


def exact_point(motion):
    """The point in 40 digits, its speed from the loop's own law of motion."""
    theta, ec, AB, BC, omega0, alpha = map(mpf, motion)
    return Point(theta, ec, AB, BC, loop.omega(motion), alpha, omega0, mp)


def float_point(motion):
    """The point in doubles."""
    return Point(*motion[:4], float(loop.omega(motion)), motion.alpha, motion.omega0, math)


def package(name, motion):
    """One quantity from the package."""
    return dx.evaluate(name, **motion._asdict())


def close(result, want, scale, digits):
    """Agreement to `digits` digits of the larger of the value and its scale."""
    return abs(result - want) <= mpf(10) ** -digits * (abs(want) + scale)


def scale_of(kind, motion):
    """The natural magnitude of a kind of quantity at a point, SI units."""
    length, rate = motion.AB + motion.BC, float(loop.omega(motion))
    rate2 = rate**2 + abs(motion.alpha)
    return {
        "angle": 1.0,
        "length": length,
        "rate": rate,
        "rate2": rate2,
        "velocity": length * rate,
        "acceleration": length * rate2,
    }[kind]


def agrees(formula, expected, kind, designs=DESIGNS):
    """A formula of the paper equals the loop to 30 digits, and in doubles the package to rounding.

    `formula(point)` is a number or a vector; `expected(q, point)` says what it should be, where `q(name)` is
    a quantity of the mechanism: first from the loop, then from the package.
    """
    for motion in designs:
        scale = scale_of(kind, motion)
        with mp.workdps(loop.DIGITS):
            true = vector(expected(lambda name, at=motion: loop.truth(name, at), exact_point(motion)))
            exact = vector(formula(exact_point(motion)))
        rounded = vector(formula(float_point(motion)))
        computed = vector(expected(lambda name, at=motion: package(name, at), float_point(motion)))
        assert len(true) == len(exact) == len(rounded) == len(computed)
        for t, e, r, c in zip(true, exact, rounded, computed, strict=True):
            assert close(e, t, scale, 30)
            assert close(r, t, scale, 12)
            assert close(c, t, scale, 12)
            assert close(r, c, scale, 12)


def differs(formula, name, designs=DESIGNS):
    """A formula of the paper is off by more than a thousandth in every design, from loop and package."""
    for motion in designs:
        true, computed = loop.truth(name, motion), package(name, motion)
        printed = formula(float_point(motion))
        assert abs(printed - true) > 1e-3 * abs(true)
        assert abs(printed - computed) > 1e-3 * abs(computed)


def vector(value):
    """A number as a vector of one."""
    return value if isinstance(value, tuple) else (value,)


def three_digits(value):
    """Rounded to the three significant digits the paper prints."""
    return float(f"{float(value):.3g}")
