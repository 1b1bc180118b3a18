"""Scenes under loads for compiled modules: every kind of table, points, and what may be wrong."""

import math

import numpy as np

import desaxe as dx

NAMES = ["T_in", "T_in_wrt_theta", "T_in_wrt_AB", "T_in_wrt_ec", "N_C", "Y", "status"]
INPUTS = ("theta", "ec", "AB", "omega0")
FIXED = {"BC": 0.064, "m_slider": 0.8}
PLACES = {"Y": [0.03, 0.05, 0.06, 0.09], "stroke": [0.0, 0.008, 0.012, 0.02]}
FORCES, BACK = [-900.0, -200.0, -50.0, -30.0], [-90.0, -40.0, -15.0, -3.0]
SHAPES = ("smooth", "kinked", "jumping")
# What a table is over, and whether the way inward has one of its own.
KINDS = ("theta", "Y", "Y both ways", "outer", "outer both ways", "inner", "inner both ways", "sum")


def load(kind, shape, scale=1.0, turns=1):
    """A load of a kind and shape; a table over theta may go over some turns."""
    if kind == "sum":
        tables = load("theta", shape, scale) - load("outer both ways", shape, scale)
        return tables + 2 * dx.damper(20.0 * scale, 3.0 * scale) + dx.spring(3e3 * scale, free=0.07) + scale
    over, own = kind.partition(" ")[0], " both" in kind
    form = "cubic" if shape == "smooth" else "linear"
    forces, back = [scale * f for f in FORCES], [scale * f for f in BACK] if own else None
    if over == "theta":
        angles = [0.5, 1.0, 1.0 if shape == "jumping" else 2.0, 4.0]
        return dx.over_theta([turns * a for a in angles], forces, form, turns * math.tau)
    places = list(PLACES["Y" if over == "Y" else "stroke"])
    if shape == "jumping":
        places[2] = places[1]
    if over == "Y":
        return dx.over_Y(places, forces, back, form)
    return dx.over_stroke(places, forces, back, form, dead_centre=over)


def scene(given, **more):
    """A scene under a load on the slider, some of whose inputs are open."""
    return {
        "outputs": NAMES,
        "mechanism": {"ec": [0.0, 0.01], "AB": [0.03, 0.04], "BC": 0.064},
        "motion": {"theta": [0.0, 1.0, 2.0], "omega0": [1.0, 2.0]},
        "masses": {"m_slider": 0.8},
        "loads": {"F_Y": given},
        **more,
    }


def columns(given, count):
    """Designs that turn fully or not, knots of tables over theta, a crank that stands still."""
    random = np.random.default_rng(31)
    theta, ec = random.uniform(-9.0, 9.0, count), random.uniform(-0.03, 0.03, count)
    if given.over == "theta":
        theta[:40] = random.choice(given.table.knots, 40) + given.period * random.integers(-2, 3, 40)
    theta[40:43] = np.nan, np.inf, 1e6
    ec[43] = np.nan
    rest = random.uniform(0.03, 0.05, count), random.choice([-3.0, 3.0, 0.0], count)
    return dict(zip(INPUTS, (theta, ec, *rest), strict=True))
