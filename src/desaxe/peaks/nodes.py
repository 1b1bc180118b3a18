"""The nodes of a search: crank angles shared by the designs of one class.

The rod's height is S = sqrt(BC^2 - u^2): over complex theta it branches at pi/2 +- i d with
cosh(d) = (BC - ec)/AB, and at -pi/2 +- i d' with cosh(d') = (BC + ec)/AB. Next to a quarter whose
margin is small d is small, about the root of 2 m/AB, and everything that comes from S changes within
it. In t with theta = quarter + d sinh(t) the branch points are pi/2 away whatever d is, so equal steps
of t resolve every design alike: a peak as narrow as the root of the margin too, for a number of nodes
that grows as log(1/d). Designs are put in classes by d, in factors of 2.
"""

from functools import lru_cache
from math import acosh, asinh, ceil, floor, pi, sinh

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

STEP = 0.34  # of t
FAR = 1.2  # rad: as if no branch point were farther away
CLASSES = 52  # the last one is for margins of 4^-51 crank lengths and less, 0 among them

FINEST = CLASSES - 1
KEPT_APART = np.array([5, 14, FINEST], np.int16)  # few classes share operations; a finer one loses no digit


def classes(ec: Array, AB: Array, BC: Array) -> NDArray[np.int16]:
    """One integer a design that combines the classes of its two branch points."""
    with np.errstate(all="ignore"):
        near = (BC - AB) / AB
        offset = ec / AB
        return 64 * _class(near - offset) + _class(near + offset)


def _class(margin: Array) -> NDArray[np.int16]:
    """The least k that is kept apart with margin >= 4^-k; any for NaN."""
    exponent = (margin.view(np.int64) >> 52).astype(np.int16)  # margin in [2^(e-1023), 2^(e-1022)), or e < 0
    finest = np.minimum(np.maximum((1024 - exponent) >> 1, 0), FINEST)
    result: NDArray[np.int16] = KEPT_APART[np.searchsorted(KEPT_APART, finest)]
    return result


@lru_cache(maxsize=1024)
def shared_nodes(number: int, low: float, high: float) -> Array:
    """The nodes of a class within the range, ends included."""
    right, left = divmod(number, 64)
    angles = [low, high]
    for half in range(floor(low / pi) - 1, ceil(high / pi) + 1):
        quarter = pi * (0.5 + half)
        for distance in graded(left if half % 2 else right):
            angles += [quarter - distance, quarter + distance]
    inside = [angle for angle in angles if low <= angle <= high]
    return np.array(sorted(set(inside)))


@lru_cache(maxsize=64)
def graded(number: int) -> tuple[float, ...]:
    """Distances from a quarter up to pi/2, for a class."""
    d = acosh(1.0 + 4.0**-number) if number < 20 else 2.0**0.5 * 2.0**-number
    far = (FAR * FAR - d * d) ** 0.5 if d < FAR else 0.0  # beyond, steps of theta are equal
    count = ceil(asinh(far / d) / STEP)
    near = [d * sinh(asinh(far / d) * j / count) for j in range(count)]
    others = ceil((0.5 * pi - far) / (STEP * FAR))
    return (*near, *(far + (0.5 * pi - far) * j / others for j in range(others + 1)))
