"""Designs with a required stroke, time ratio and peak acceleration: every crossing along the family."""

from math import isclose, log10, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...mechanism.closed.limits import margin_of
from ...peaks.peak import peak
from ...support.deadline import Deadline
from ...support.roots import root
from .family import Family, Fitting

Array = NDArray[np.float64]
PER_DECADE = 15  # places
NEAREST = 1e-12  # to the ends of the family, at which the acceleration grows without bound
TURNS = 1e-9  # of the rod: lengths in doubles do not resolve a smaller margin


def of_peak(family: Family, wanted: float, omega0: float, deadline: Deadline) -> Fitting:
    """Every design of the family with the required peak |a_C|, and the smallest feasible peak."""
    if omega0 == 0.0:
        raise ValueError("omega0 = 0: a crank at rest has no acceleration to wish for")

    def height(x: Any) -> Any:
        deadline.check()
        rows = [family.design(float(at)) for at in np.atleast_1d(x)]
        lengths: dict[str, Any] = {name: np.array([row[name] for row in rows]) for name in ("ec", "AB", "BC")}
        margin = margin_of(**lengths)
        value = peak("a_C", omega0=omega0, **lengths)["value"]
        return np.where(margin > TURNS * lengths["BC"], value, np.inf)

    def at(x: float) -> float:
        return float(height(x)[0])

    x = _places(family.t**2)
    excess = height(x) - wanted
    found = [
        root(lambda place: at(place) - wanted, float(x[k]), float(x[k + 1]))
        for k in np.flatnonzero(np.sign(excess[:-1]) * np.sign(excess[1:]) < 0)
    ]
    k = int(np.argmin(excess))
    a, b = float(x[max(k - 1, 0)]), float(x[min(k + 1, len(x) - 1)])
    bottom = _lowest(at, a, b)
    least = at(bottom)
    if not family.beta:  # the least is that of an endless rod
        least = family.stroke / 2.0 * omega0**2
    elif not found and wanted >= least:  # both crossings are next to the bottom
        found = [root(lambda place: at(place) - wanted, *ends) for ends in ((a, bottom), (bottom, b))]
    found = [place for place in found if isclose(at(place), wanted, rel_tol=1e-6)]  # no jump to infinity
    return Fitting([family.design(place) for place in found], least, np.inf)


def _places(low: float) -> Array:
    """Ratios of crank and rod from `low` to 1, as dense towards either end as the acceleration is steep.

    Without an offset, low = 0: the rod may be as long as one likes.
    """
    middle = 0.5 * (1.0 - low)
    near = NEAREST * low or NEAREST
    up, down = (
        np.geomspace(first, middle, max(int(PER_DECADE * log10(middle / first)), 10))
        for first in (near, min(NEAREST, 0.1 * middle))
    )
    return np.concatenate([low + up[:-1], 1.0 - down[::-1]])


def _lowest(function: Any, a: float, b: float) -> float:
    """The minimiser of a function between a and b, by golden section."""
    golden = (sqrt(5.0) - 1.0) / 2.0
    c, d = b - golden * (b - a), a + golden * (b - a)
    fc, fd = function(c), function(d)
    for _ in range(45):
        if fc < fd:
            b, d, fd = d, c, fc
            c = b - golden * (b - a)
            fc = function(c)
        else:
            a, c, fc = c, d, fd
            d = a + golden * (b - a)
            fd = function(d)
    return c if fc < fd else d
