"""Points where formulas lose their digits, and whether a language keeps the promise of `standard` there.

One scene leaves all motion and lengths open; each language answers the same points of all families, on both
branches, and is held to the loop closure in ball arithmetic.
"""

import math
from functools import cache

import mpmath
import numpy as np

from desaxe.oracle.families import FAMILIES, points
from desaxe.oracle.truth import conditions, truth, ulp_error

NAMES = ("Y", "V_C", "a_C", "omega_BC", "a_C_wrt_ec", "V_C_wrt_BC")
INPUTS = ("theta", "ec", "AB", "BC", "omega0", "alpha")
EACH = 12  # points of a family
LARGEST = 1.7976931348623157e308
NOTHING_LEFT = 2.0**53  # ulp


def scene(branch=1, outputs=NAMES, **more):
    """All inputs open."""
    return {
        "outputs": list(outputs),
        "mechanism": {"ec": [0, 0.1], "AB": [0.125, 0.13], "BC": [0.35, 0.4], "branch": branch},
        "motion": {"theta": [0, 1], "omega0": [150, 157.08], "alpha": [0, 3]},
        **more,
    }


@cache
def rows(branch, largest=math.inf):
    """The points of all families on a branch."""
    drawn = [row for family in FAMILIES for row in points(family, EACH, seed=11)]
    return [row for row in drawn if row["branch"] == branch and abs(row["theta"]) <= largest]


def columns(branch, largest=math.inf):
    """The rows as arrays, in the order of the arguments."""
    return [np.array([row[name] for row in rows(branch, largest)]) for name in INPUTS]


@cache
def _exact(branch, index, name):
    row = rows(branch)[index]
    return truth(name, **row), conditions(name, **row)


def _errors(result, branch, largest):
    """(index of the point, name, value, exact, ulp, bound) of each value that is promised anything."""
    places = [index for index, row in enumerate(rows(branch)) if abs(row["theta"]) <= largest]
    for place, index in enumerate(places):
        for name in result:
            exact, condition = _exact(branch, index, name)
            value, bound = float(result[name][place]), 8.0 * (1 + condition)
            if not (mpmath.isnan(exact) or bound >= NOTHING_LEFT or abs(exact) > LARGEST / 2):
                yield index, name, value, exact, ulp_error(value, exact), bound


def broken(result, branch, largest=math.inf):
    """The points and names at which values break the promise of `standard`."""
    return [
        (name, value, mpmath.nstr(exact, 17), rows(branch)[index])
        for index, name, value, exact, error, bound in _errors(result, branch, largest)
        if error > bound
    ]


def shares(result, branch, largest=math.inf):
    """(family, error as a share of what is promised) of each value."""
    families = [family for family in FAMILIES for row in points(family, EACH, 11) if row["branch"] == branch]
    for index, _, _, _, error, bound in _errors(result, branch, largest):
        yield families[index], error / bound
