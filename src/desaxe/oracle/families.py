"""Families of points where formulas lose their digits: each a generator of seeded points without end.

Every family is about one danger, and draws the rest at random: both branches, both ways of turning, crank
longer than rod where that is possible, with and without acceleration. ``points(family, count)`` draws.
"""

import math
import random
from collections.abc import Callable, Iterator
from itertools import islice

import mpmath

Rng = random.Random
Point = dict[str, float]
QUARTER = math.pi / 2


def motion(rng: Rng, theta: float, scale: float = 1.0) -> Point:
    """Steady, speeding up or slowing down, either way round; never stalled at theta."""
    speed = rng.uniform(0.5, 200.0) * rng.choice((-1, 1)) * scale
    kind = rng.randrange(4)
    if kind == 0:
        return {"omega0": speed, "alpha": 0.0}
    largest = speed * speed / (2 * max(abs(theta), 1.0))
    return {"omega0": speed, "alpha": largest * rng.uniform(0.05, 0.9) * rng.choice((-1, 1))}


def point(rng: Rng, theta: float, ec: float, AB: float, BC: float) -> Point:
    """A point with a random motion on a random branch."""
    sizes = {"theta": theta, "ec": ec, "AB": AB, "BC": BC}
    return sizes | motion(rng, theta) | {"branch": rng.choice((1, 1, -1))}


def sizes(rng: Rng) -> tuple[float, float, float]:
    """Eccentricity, crank and rod: a mechanism that turns fully, or one with a long crank."""
    BC = rng.uniform(0.2, 1.0)
    AB, room = BC * rng.uniform(0.1, 0.7), BC
    if rng.random() < 0.3:
        AB = BC * 10 ** rng.uniform(0.02, 1.5)
    else:
        room = BC - AB
    return room * rng.uniform(0.01, 0.9) * rng.choice((-1, 1)), AB, BC


def reaches(theta: float, ec: float, AB: float, BC: float) -> bool:
    """True if the mechanism can be assembled, with some slack for rounding."""
    return abs(ec + AB * math.sin(theta)) < BC * (1 - 1e-9)


def feasible_angle(rng: Rng, ec: float, AB: float, BC: float, turns: float = 1.5) -> float:
    """A random feasible angle within `turns` turns in either direction."""
    while not reaches(theta := rng.uniform(-turns, turns) * math.tau, ec, AB, BC):
        pass
    return theta


def generic(rng: Rng) -> Point:
    """Generic points of the mechanism."""
    ec, AB, BC = sizes(rng)
    return point(rng, feasible_angle(rng, ec, AB, BC), ec, AB, BC)


def log_uniform(rng: Rng, low: float, high: float) -> float:
    """A number whose logarithm is drawn evenly."""
    return float(10 ** rng.uniform(math.log10(low), math.log10(high)))


def exact_change_point(rng: Rng) -> tuple[float, float, float]:
    """Eccentricity (at least 0), crank and rod with BC = AB + ec exactly."""
    kind = rng.randrange(4)
    AB, ec = rng.randrange(1, 2**26) / 2**26, rng.randrange(1, 2**26) / 2**26
    if kind == 0:
        ec /= 2**26
    elif kind == 1:
        AB /= 2**26
    elif kind == 2:
        ec = 0.0
    return ec, AB, AB + ec


def side(rng: Rng) -> int:
    """-1 or 1."""
    return rng.choice((-1, 1))


def change_point(rng: Rng) -> Point:
    """Exactly a change-point mechanism, at 0.1 rad down to 1e-9 rad from the quarter that folds it."""
    sigma, (ec, AB, BC) = side(rng), exact_change_point(rng)
    distance = side(rng) * log_uniform(rng, 1e-9, 0.1)
    return point(rng, sigma * QUARTER + distance, sigma * ec, AB, BC)


def change_point_elsewhere(rng: Rng) -> Point:
    """Exactly a change-point mechanism, anywhere on its turn."""
    sigma, (ec, AB, BC) = side(rng), exact_change_point(rng)
    return point(rng, rng.uniform(-math.pi, math.pi), sigma * ec, AB, BC)


def near_change_point(rng: Rng) -> Point:
    """A margin of 2^-20 to 2^-50 of BC, either sign."""
    while True:
        sigma, (ec, AB, BC) = side(rng), exact_change_point(rng)
        BC *= 1 + side(rng) * 2.0 ** -rng.randint(20, 50)
        theta = sigma * QUARTER + side(rng) * log_uniform(rng, 1e-9, 0.1)
        if feasible(theta, sigma * ec, AB, BC):
            return point(rng, theta, sigma * ec, AB, BC)


def feasible(theta: float, ec: float, AB: float, BC: float) -> bool:
    """True if the mechanism can be assembled, in 60 digits."""
    with mpmath.workdps(60):
        return bool(abs(ec + mpmath.mpf(AB) * mpmath.sin(mpmath.mpf(theta))) < BC)


def eccentric_as_rod(rng: Rng) -> Point:
    """|ec| within an ulp of BC, so that only the crank makes it feasible, at angles from 1e-20."""
    BC, sigma = rng.uniform(0.2, 1.0), side(rng)
    AB = BC * 10 ** rng.uniform(-1.0, 1.0)
    while True:
        ec = rng.choice((math.nextafter(BC, 0), BC, math.nextafter(BC, 2)))
        theta = -sigma * log_uniform(rng, 1e-20, 0.1)
        if feasible(theta, sigma * ec, AB, BC):
            return point(rng, theta, sigma * ec, AB, BC)


def eccentric_as_crank(rng: Rng) -> Point:
    """ec within an ulp of +-AB, at the opposite quarter turn: the pin meets the slider axis."""
    AB, sigma = rng.uniform(0.2, 1.0), side(rng)
    ec = rng.choice((math.nextafter(AB, 0), AB, math.nextafter(AB, 2)))
    theta = -sigma * QUARTER + side(rng) * log_uniform(rng, 1e-12, 0.1) * rng.choice((0, 1, 1, 1))
    return point(rng, theta, sigma * ec, AB, AB * 10 ** rng.uniform(-2.0, 2.0))


def dead_centre(rng: Rng) -> Point:
    """Crank and rod in line, to the last double and the next ones."""
    ec, AB, BC = sizes(rng)
    stretched = side(rng)  # or folded
    while abs(ec) >= abs(AB + stretched * BC):
        ec, AB, BC = sizes(rng)
    with mpmath.workdps(40):
        upwards = mpmath.asin(-ec / (mpmath.mpf(AB) + stretched * mpmath.mpf(BC)))
        up = side(rng)  # the slider is at (AB +- BC) cos(theta), the pin at AB cos(theta)
        theta = float((upwards if up > 0 else mpmath.pi - upwards) + 2 * mpmath.pi * rng.randrange(-1, 2))
    branch = stretched * up
    for _ in range(rng.randrange(3)):
        theta = math.nextafter(theta, side(rng) * math.inf)
    return point(rng, theta, ec, AB, BC) | {"branch": branch}


def last_angle(rng: Rng) -> Point:
    """The last double at which a mechanism that cannot turn fully can be assembled, and before it."""
    while True:
        BC = rng.uniform(0.2, 1.0)
        AB = BC * 10 ** rng.uniform(-0.3, 2.0)
        ec, sigma = BC * rng.uniform(-1.5, 1.5), side(rng)
        if abs(sigma * BC - ec) < AB:
            break
    with mpmath.workdps(40):
        theta = float(mpmath.asin((sigma * mpmath.mpf(BC) - ec) / AB))
    inwards = -sigma
    theta += inwards * rng.choice((0.0, 0.0, log_uniform(rng, 1e-16, 1e-3)))
    while not feasible(theta, ec, AB, BC):
        inner = math.nextafter(theta, inwards * math.inf)
        if feasible(inner, ec, AB, BC):
            return point(rng, inner, ec, AB, BC)
        theta = inner
        if abs(ec + AB * math.sin(theta)) < 0.5 * BC:
            break
    return point(rng, theta, ec, AB, BC)


def far_angle(rng: Rng) -> Point:
    """100 to 10^8 rad."""
    ec, AB, BC = sizes(rng)
    while not reaches(theta := side(rng) * log_uniform(rng, 1e2, 1e8), ec, AB, BC):
        pass
    return point(rng, theta, ec, AB, BC)


def concentric(rng: Rng) -> Point:
    """ec = +-0, or negligibly small."""
    _, AB, BC = sizes(rng)
    ec = rng.choice((0.0, -0.0, side(rng) * 10.0 ** rng.uniform(-300, -10), side(rng) * 5e-324))
    if rng.random() < 0.2:
        AB = BC * rng.choice((1.0, 1 - 2.0**-30, 1 + 2.0**-30))
    theta = feasible_angle(rng, ec, AB, BC)
    if rng.random() < 0.2:
        theta = rng.randrange(-4, 5) * QUARTER
    if not feasible(theta, ec, AB, BC):
        theta = feasible_angle(rng, ec, AB, BC)
    return point(rng, theta, ec, AB, BC)


def folded_over(rng: Rng) -> Point:
    """Rod and crank of nearly equal length, ec nearly 0: folded back, Y nearly vanishes."""
    AB = rng.randrange(1, 2**20) / 2**20
    ec = rng.choice(
        (AB * log_uniform(rng, 1e-12, 1e-1), math.ldexp(rng.randrange(1, 2**20), -rng.randrange(20, 50)))
    )
    ec = float(math.floor(math.ldexp(ec, 50))) / 2.0**50
    BC = (AB + ec) * (1 + rng.choice((0.0, 0.0, 1.0, -1.0)) * 2.0 ** -rng.uniform(4, 50))
    sigma = side(rng)
    while True:
        theta = sigma * QUARTER + side(rng) * rng.choice((rng.uniform(0, 3), log_uniform(rng, 1e-8, 0.1)))
        if feasible(theta, sigma * ec, AB, BC):
            break
        BC = AB + ec
    return point(rng, theta, sigma * ec, AB, BC)


def long_rod(rng: Rng) -> Point:
    """Rods of 1e4 to 1e12 cranks."""
    AB = rng.uniform(0.1, 1.0)
    BC = AB * log_uniform(rng, 1e4, 1e12)
    ec = rng.choice((0.0, AB, BC)) * rng.uniform(-0.9, 0.9)
    return point(rng, rng.uniform(-7, 7), ec, AB, BC)


def tiny_crank(rng: Rng) -> Point:
    """Cranks of 1e-9 m and of 1e-9 of the rod, with any eccentricity that the rod allows."""
    AB = log_uniform(rng, 1e-10, 1e-8)
    BC = rng.choice((rng.uniform(0.2, 1.0), AB * rng.uniform(1.5, 10)))
    ec = rng.choice((AB * rng.uniform(-2, 2), BC * rng.uniform(-0.99, 0.99)))
    theta = rng.uniform(-7, 7)
    return point(rng, theta, ec if reaches(theta, ec, AB, BC) else 0.0, AB, BC)


def tiny_angle(rng: Rng) -> Point:
    """Angles from 1e-300 on."""
    ec, AB, BC = sizes(rng)
    theta = side(rng) * 10.0 ** -rng.choice((rng.uniform(5, 20), rng.uniform(20, 300)))
    return point(rng, theta, rng.choice((ec, ec, 0.0)), AB, BC)


def nearly_stalled(rng: Rng) -> Point:
    """omega0^2 + 2 alpha theta is nearly or exactly 0."""
    at = generic(rng)
    while at["theta"] == 0:
        at = generic(rng)
    most = -(at["omega0"] ** 2) / (2 * at["theta"])
    if rng.random() < 0.3:  # the last double before it stalls, or the first after
        at["alpha"] = rng.choice((most, math.nextafter(most, 0), math.nextafter(most, 2 * most)))
    else:
        at["alpha"] = most * (1 - rng.choice((1, 1, 1, -1)) * log_uniform(rng, 1e-16, 1e-2))
    return at


def units(rng: Rng) -> Point:
    """Another family's point, in units of length from 2^-180 to 2^180, of time from 2^-90 to 2^90."""
    family = rng.choice([f for f in PLAIN if f is not units])
    at = family(rng)
    length, rate = rng.randint(-180, 180), rng.randint(-90, 90)
    kind = rng.randrange(4)
    length, rate = (length, 0) if kind == 0 else (0, rate) if kind == 1 else (length, rate)
    return rescaled(at, length, rate)


def rescaled(at: Point, length: int, rate: int) -> Point:
    """The mechanism in units of 2^-length metres and 2^-rate radians a second."""
    powers = dict.fromkeys(("ec", "AB", "BC"), length) | {"omega0": rate, "alpha": 2 * rate}
    return {name: math.ldexp(value, powers[name]) if name in powers else value for name, value in at.items()}


PLAIN: tuple[Callable[[Rng], Point], ...] = (
    generic, change_point, change_point_elsewhere, near_change_point, eccentric_as_rod, eccentric_as_crank,
    dead_centre, last_angle, far_angle, concentric, folded_over, long_rod, tiny_crank, tiny_angle,
    nearly_stalled,
)  # fmt: skip
FAMILIES = {family.__name__: family for family in (*PLAIN, units)}


def points(family: str, count: int, seed: int = 0) -> Iterator[Point]:
    """`count` seeded points of a family."""
    rng = random.Random(f"{family} {seed}")
    return islice(iter(lambda: FAMILIES[family](rng), None), count)
