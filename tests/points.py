"""Seeded points: mechanisms of several kinds, in motions of several kinds."""

import math
import random


def lengths(rng, kind):
    """Rod, crank and eccentricity: a mechanism that turns fully, or one that cannot."""
    BC = rng.uniform(0.2, 1.0)
    AB, room = BC * rng.uniform(0.1, 0.7), BC
    if kind == "long crank":
        AB = BC * rng.uniform(1.1, 3.0)
    elif kind == "very long crank":
        AB = BC * 10 ** rng.uniform(0.5, 3.0)
    else:
        room = BC - AB
    ec = 0.0 if kind == "concentric" else room * rng.uniform(0.05, 0.8) * rng.choice([-1, 1])
    return {"ec": ec, "AB": AB, "BC": BC}


def angle(rng, ec, AB, BC):
    """A feasible angle of either sign, not close to the end of its arc."""
    while True:
        theta = rng.uniform(-3 * math.pi, 3 * math.pi)
        if abs(ec + AB * math.sin(theta)) < 0.95 * BC:
            return theta


def motion(rng, kind, theta):
    """Law or state; the law never stalls at theta."""
    speed = rng.uniform(1.0, 200.0) * (-1 if kind == "backwards" else rng.choice([-1, 1]))
    alpha = rng.uniform(0.1, 0.9) * speed * speed / (2 * abs(theta))
    speedup, either = math.copysign(alpha, theta), alpha * rng.choice([-1, 1])
    kinds = {
        "state": {"omega": speed, "alpha": either},
        "state at rest": {"omega": 0.0, "alpha": 0.0},
        "state that starts": {"omega": 0.0, "alpha": either},
        "at rest": {"omega0": 0.0, "alpha": 0.0},
        "speeding up": {"omega0": speed, "alpha": speedup},
        "slowing down": {"omega0": speed, "alpha": -speedup},
        "steady": {"omega0": speed, "alpha": 0.0},
        "from rest": {"omega0": 0.0, "alpha": speedup},
    }
    return kinds.get(kind, {"omega0": speed, "alpha": either})


def draw(kind, count):
    """Seeded points of one kind."""
    rng = random.Random(f"values: {kind}")
    for _ in range(count):
        sizes = lengths(rng, kind)
        theta = angle(rng, **sizes)
        branch = -1 if kind == "branch -1" else rng.choice([-1, 1]) if "crank" in kind else 1
        yield {"theta": theta, **sizes, **motion(rng, kind, theta), "branch": branch}
