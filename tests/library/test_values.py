"""Every quantity and sensitivity at generic points, against the truth."""

import math
import random

import pytest

import desaxe as dx
from tests.truth import LAW, STATE, all_names, conditions, relative_error, truth_all


def lengths(rng, kind):
    """Rod, crank and eccentricity: a mechanism that turns fully, or one that cannot."""
    BC = rng.uniform(0.2, 1.0)
    AB = BC * (rng.uniform(1.1, 3.0) if kind == "long crank" else rng.uniform(0.1, 0.7))
    reach = 0.8 * BC if kind == "long crank" else 0.8 * (BC - AB)
    ec = 0.0 if kind == "concentric" else reach * rng.uniform(0.1, 1.0) * rng.choice([-1, 1])
    return {"ec": ec, "AB": AB, "BC": BC}


def motion(rng, kind, theta):
    """Law or state; the law never stalls at theta."""
    speed = rng.uniform(1.0, 200.0) * (-1 if kind == "backwards" else rng.choice([-1, 1]))
    gain = speed * speed / (2 * abs(theta))
    alpha = rng.uniform(0.1, 0.9) * gain
    match kind:
        case "state":
            return {"omega": speed, "alpha": rng.choice([-1, 1]) * alpha}
        case "at rest":
            return {"omega0": 0.0, "alpha": 0.0}
        case "state at rest":
            return {"omega": 0.0, "alpha": 0.0}
        case "speeding up":
            return {"omega0": speed, "alpha": math.copysign(alpha, theta)}
        case "slowing down":
            return {"omega0": speed, "alpha": -math.copysign(alpha, theta)}
        case "steady":
            return {"omega0": speed, "alpha": 0.0}
    return {"omega0": speed, "alpha": rng.choice([-1, 1]) * alpha}


def angle(rng, ec, AB, BC):
    """A feasible angle of either sign, not close to the end of its arc."""
    while True:
        theta = rng.uniform(-3 * math.pi, 3 * math.pi)
        if abs(ec + AB * math.sin(theta)) < 0.95 * BC:
            return theta


def draw(kind, count):
    """Seeded points of one kind."""
    rng = random.Random(f"values: {kind}")
    for _ in range(count):
        sizes = lengths(rng, kind)
        theta = angle(rng, **sizes)
        branch = rng.choice([-1, 1]) if kind in ("long crank", "state") else -1 if kind == "branch -1" else 1
        yield {"theta": theta, **sizes, **motion(rng, kind, theta), "branch": branch}


def names_for(point):
    return all_names(STATE if "omega" in point else LAW)


def misses(values, point):
    """What is further from the truth than 1e-13, or than its condition allows where that is above 50."""
    exact = truth_all(values, **point)
    errors = {name: relative_error(value, exact[name]) for name, value in values.items()}
    suspects = {name: error for name, error in errors.items() if not error <= 1e-13}
    bounds = {name: 2e-15 * conditions(name, **point) for name in suspects}
    return {
        name: (error, bounds[name]) for name, error in suspects.items() if not error <= bounds[name] < 1e-8
    }


@pytest.mark.parametrize("kind", ["generic", "branch -1", "long crank", "backwards", "concentric", "steady"])
def test_hundred_points(kind):
    for point in draw(kind, 100):
        assert not misses(dx.evaluate(names_for(point), **point), point), point


KINDS = ("speeding up", "slowing down", "at rest", "state", "state at rest")


@pytest.mark.parametrize("kind", KINDS)
def test_motions(kind):
    for point in draw(kind, 25):
        assert not misses(dx.evaluate(names_for(point), **point), point), point
