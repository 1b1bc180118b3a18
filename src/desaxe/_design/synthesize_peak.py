"""Designs of a wanted stroke, time ratio and largest acceleration: every crossing along the family."""

from math import pi, sqrt
from typing import TYPE_CHECKING, Any

import numpy as np

from .._peak import peak
from .roots import root

if TYPE_CHECKING:
    from .synthesize import Answer, Family

PLACES = 401
NEAREST = 1e-9  # to the ends of the family, at which the acceleration grows without bound


def of_peak(family: "Family", wanted: float, omega0: float) -> "Answer":
    """Every design at which the largest |a_C| is as wanted; the least that there is."""
    from .synthesize import Answer

    if omega0 == 0.0:
        raise ValueError("omega0 = 0: a crank at rest has no acceleration to wish for")

    def height(x: Any) -> Any:
        rows = [family.design(float(at)) for at in np.atleast_1d(x)]
        lengths: dict[str, Any] = {name: np.array([row[name] for row in rows]) for name in ("ec", "AB", "BC")}
        return peak("a_C", omega0=omega0, **lengths)["value"]

    def at(x: float) -> float:
        return float(height(x)[0])

    low = family.t**2
    # Graded towards both ends; without an offset the rod may be as long as one likes.
    share = 0.5 * (1.0 - np.cos(np.linspace(0.0, pi, PLACES)[1:-1]))
    x = low + (1.0 - low) * np.clip(share, NEAREST, 1.0 - NEAREST)
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
    return Answer([family.design(place) for place in found], least, np.inf)


def _lowest(function: Any, a: float, b: float) -> float:
    """Where it is least between a and b, by golden sections."""
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
