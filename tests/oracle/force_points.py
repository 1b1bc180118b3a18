"""Points with bodies, loads and motions of all kinds for the oracle of forces."""

import mpmath

from desaxe.oracle.force_truth import (
    PARAMETERS,
)

BODIES = {"m_crank": 1.5, "m_rod": 0.75, "m_slider": 2.25, "I_crank": 0.03125, "I_rod": 0.0625}
LOADS = {"F_X": 30.0, "F_Y": -45.0, "g_X": 1.25, "g_Y": -9.75}
CENTRES = {"r_crank": -0.03, "r_rod": 0.2}
POINTS = [
    {"theta": 1.047, "ec": 0.01, "AB": 0.125, "BC": 0.35, "omega0": 15.5, "alpha": 0.0, "mu": 0.1}
    | {**BODIES, **LOADS},
    {"theta": -2.5, "ec": -0.2, "AB": 0.125, "BC": 0.35, "omega0": -3.0, "alpha": -1.25, "mu": 0.2}
    | {**BODIES, **LOADS, **CENTRES, "branch": -1},
    {"theta": 0.3, "ec": 0.3, "AB": 0.5, "BC": 0.75, "omega0": 2.0, "alpha": -0.75, "mu": 0.0}
    | {**BODIES, **LOADS, **CENTRES},
    {"theta": 3.0, "ec": -0.125, "AB": 2.0, "BC": 1.0, "omega0": 0.5, "alpha": 4.0, "mu": 0.3}
    | {**BODIES, **LOADS, "r_crank": 0.7, "branch": -1},
]
PLAIN = {"theta": 2.0, "ec": 0.1, "AB": 0.125, "BC": 0.35}
AT_REST = PLAIN | BODIES | LOADS | CENTRES


def agree(left, right, digits=45):
    return abs(left - right) <= mpmath.mpf(10) ** -digits * (1 + abs(left))


def numbers(point):
    """All inputs of a point as numbers of mpmath, those that are not given too."""
    given = dict.fromkeys(PARAMETERS, 0) | {"branch": 1, "r_crank": None, "r_rod": None} | point
    return {p: None if value is None else mpmath.mpf(value) for p, value in given.items()}
