"""Paper A's V_C and a_C over a turn of the crank: greatest values, gaps."""

import math

import numpy as np
from mpmath import mp, mpf

import desaxe as dx
from tests.papers import loop
from tests.papers import paper_a as A
from tests.papers.designs import CRANK, ROD, SPEED, TURN, close
from tests.papers.digits import remembered
from tests.papers.extremes import greatest
from tests.papers.loop import Motion

MEASURES = {"max": lambda x: x, "min": lambda x: -x, "abs": abs}
SHEETS = {kind: A.Worksheet(kind(SPEED), kind(0), m) for kind, m in ((float, math), (mpf, mp))}


def formula(name, theta, ec, AB, BC):
    """V_C or a_C by the corrected listing, in doubles or in the digits of the angle."""
    kind = mpf if isinstance(theta, mpf) else float
    return getattr(SHEETS[kind], f"corrected_{name}")(theta, kind(ec), kind(AB), kind(BC))


@remembered
def peak(name, ec, BC="0.35", AB="0.125", kind="abs", steps=720):
    """Largest measure of V_C or a_C over a turn and its angle (rad); designs in decimals.

    At the angle found the loop closure agrees, and nowhere is the package's curve higher.
    """
    measure = MEASURES[kind]
    value, theta = greatest(lambda angle: measure(formula(name, angle, ec, AB, BC)), steps=steps)
    motion = Motion(theta, mpf(ec), mpf(AB), mpf(BC), mpf(SPEED))
    assert close(value, measure(loop.truth(name, motion)), 0, 25)
    grid = np.linspace(0.0, TURN, 1441)
    curve = dx.evaluate(name, **{key: float(x) for key, x in motion._asdict().items()} | {"theta": grid})
    assert max(measure(x) for x in curve.tolist()) <= value * (1 + mpf("1e-9"))
    return value, theta % (2 * mp.pi)


def percent(after, before):
    """The growth from one value to another, %."""
    return 100 * (after / before - 1)


def curves(names, ec, theta, BC=ROD):
    """Curves of the package over theta, NaN where the mechanism cannot be assembled."""
    result = dx.evaluate(list(names), theta=np.asarray(theta), ec=ec, AB=CRANK, BC=BC, omega0=SPEED)
    return [result[name] for name in names]


def turns_fully(ec, BC=ROD, steps=48):
    """True if V_C exists on the whole turn, the two extreme angles included; checked by the raw loop."""
    angles = [TURN * n / steps for n in range(steps)]
    reached = [bool(mp.im(loop.slider(Motion(theta, ec, CRANK, BC, SPEED))[1]) == 0) for theta in angles]
    assert np.isfinite(curves(["V_C"], ec, angles, BC)[0]).tolist() == reached
    return all(reached)
