"""Greatest values of curves over the crank angle, refined to the working precision."""

import math
from collections.abc import Callable
from typing import Any

from mpmath import mp, mpf

TURN = 2 * math.pi
Curve = Callable[[Any], Any]  # of an angle in doubles or in more digits


def greatest(curve: Curve, low: Any = 0, high: Any = TURN, steps: int = 720) -> tuple[mpf, mpf]:
    """The greatest value of a smooth curve between two angles (rad), its ends included, and where.

    Sought in doubles on a grid and by golden section there; then the root of the slope, in all digits.
    """
    low_, high_ = float(low), float(high)
    step, closed = (high_ - low_) / steps, high_ - low_ > TURN - 1e-9
    near = max(range(steps + 1), key=lambda n: float(curve(low_ + n * step)))
    left, right = (low_ + (near + way) * step for way in (-1, 1))
    at = golden(
        lambda angle: float(curve(angle)),
        *((left, right) if closed else (max(left, low_), min(right, high_))),
    )
    ends = [] if closed else [mpf(end) for end in (low, high) if abs(at - float(end)) < 1e-4 * step]
    start = mpf(at), mpf(at) + step / 1000
    at = ends[0] if ends else mp.findroot(lambda t: mp.diff(curve, t), start, verify=False)
    assert curve(at) > curve(mpf(low_ + near * step)) * (1 - mpf("1e-12")), "no peak found"
    return curve(at), at


def golden(curve: Callable[[float], float], low: float, high: float, width: float = 1e-7) -> float:
    """The angle of the greatest value between two angles by golden section."""
    ratio = (math.sqrt(5) - 1) / 2
    while high - low > width * (1 + abs(low)):
        left, right = high - ratio * (high - low), low + ratio * (high - low)
        low, high = (left, high) if curve(left) < curve(right) else (low, right)
    return (low + high) / 2
