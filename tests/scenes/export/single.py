"""Points and truth for C in single precision: inputs are rounded to float, truth is that of the rounded."""

import math
import random
from functools import cache

import mpmath
import numpy as np

from desaxe.oracle import families
from desaxe.oracle.families import FAMILIES, QUARTER, log_uniform, point, side
from desaxe.oracle.truth import conditions, truth
from tests.scenes.export.stress import INPUTS, NAMES

REACH = 100.0  # rad
SIZES = 1e-25, 1e25  # of results: beyond, what stands between input and result may leave the format
NOTHING_LEFT = 2.0**24  # ulp
LIMIT = 8.0  # ulp times 1 + condition; promised are 64


def rounded(row):
    """A point as the compiled code reads it."""
    return {name: value if name == "branch" else float(np.float32(value)) for name, value in row.items()}


def near_change_point(rng):
    """Margins of 2^-4 to 2^-23 of the rod, or none, in 24 bits; 0.1 to 1e-5 rad from the fold."""
    sigma, AB, ec = side(rng), rng.randrange(1, 2**11) / 2**11, rng.randrange(0, 2**11) / 2**11
    BC = (AB + ec) * (1 + rng.choice((0, 1, 1, -1)) * 2.0 ** -rng.randint(4, 23))
    theta = sigma * QUARTER + side(rng) * log_uniform(rng, 1e-5, 0.1) + 2 * math.pi * rng.randrange(-3, 4)
    return point(rng, theta, sigma * ec, AB, BC)


def quarter_turn(rng):
    """The floats next to whole quarter turns up to 100 rad."""
    theta = np.float32(rng.randrange(-63, 64) * QUARTER)
    for _ in range(rng.randrange(3)):
        theta = np.nextafter(theta, np.float32(side(rng) * 1e3))
    ec, AB, BC = families.sizes(rng)
    return point(rng, float(theta), ec, AB, BC)


def draw(family, count, seed):
    """`count` points of a family in single precision, |theta| <= 100."""
    rng = random.Random(f"{family} {seed}")
    make = {"near_change_point": near_change_point, "quarter_turn": quarter_turn}.get(family) or FAMILIES[
        family
    ]
    found = []
    while len(found) < count:
        row = rounded(make(rng))
        fits = all(x == 0.0 or 1e-12 < abs(x) < 1e12 for name, x in row.items() if name != "branch")
        if fits and abs(row["theta"]) <= REACH:
            found.append(row)
    return found


DRAWN = *(name for name in FAMILIES if name not in ("units", "far_angle", "tiny_angle")), "quarter_turn"


@cache
def rows(branch, each, seed=24):
    """Points of all families on a branch."""
    return [row for family in DRAWN for row in draw(family, each, seed) if row["branch"] == branch]


def columns(branch, each):
    """The rows as arrays, in the order of the arguments."""
    return [np.array([row[name] for row in rows(branch, each)], np.float32) for name in INPUTS]


def errors(found, branch, each, names=NAMES):
    """(name, value, exact, error in float ulp over 1 + condition, point) of each value that is promised."""
    for index, row in enumerate(rows(branch, each)):
        for name in names:
            exact = truth(name, **row)
            if mpmath.isnan(exact) or not (exact == 0 or SIZES[0] < abs(exact) < SIZES[1]):
                continue
            condition = conditions(name, **row)
            if LIMIT * (1 + condition) < NOTHING_LEFT:
                value = float(found[name][index])
                yield name, value, exact, ulps(value, exact) / (1 + condition), row


def ulps(value, exact):
    """The distance of a value from the truth in float ulp of the truth."""
    if not math.isfinite(value):
        return math.inf
    _, power = mpmath.frexp(exact)
    return float(abs(mpmath.mpf(value) - exact) / mpmath.ldexp(1, max(int(power) - 24, -149)))
