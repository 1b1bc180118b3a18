"""Roots of a function of one variable: one in plain Python, many at once in NumPy."""

from collections.abc import Callable
from math import copysign, ulp
from typing import Any

from .lazy import np

STEPS = 200


def root(function: Callable[[float], float], a: float, b: float) -> float:
    """The sign change of a function between a and b, to a few ulp (Chandrupatla's method).

    An end at which it is 0 is the root. The caller sees to it that the signs differ.
    """
    fa, fb = function(a), function(b)
    if fa == 0.0 or fb == 0.0:
        return a if fa == 0.0 else b
    c, fc, fraction = a, fa, 0.5
    for _ in range(STEPS):
        x = a + fraction * (b - a)
        fx = function(x)
        if copysign(1.0, fx) == copysign(1.0, fa):
            c, fc = a, fa
        else:
            c, b, fc, fb = b, a, fb, fa
        a, fa = x, fx
        best = a if abs(fa) < abs(fb) else b
        least = 2.0 * ulp(best)
        if abs(b - a) <= least or fa == 0.0:
            break
        fraction = min(max(_fraction(a, b, c, fa, fb, fc), least / abs(b - a)), 1.0 - least / abs(b - a))
    return a if abs(fa) < abs(fb) else b


def _fraction(a: float, b: float, c: float, fa: float, fb: float, fc: float) -> float:
    """The next step as a fraction: by inverse quadratic interpolation if that is safe, else 1/2."""
    xi, phi = (a - b) / (c - b), (fa - fb) / (fc - fb)
    if not (phi * phi < xi and (1.0 - phi) * (1.0 - phi) < 1.0 - xi):
        return 0.5
    return fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)


def roots(function: Callable[[Any], Any], a: Any, b: Any, fa: Any, fb: Any) -> Any:
    """The sign change of a function between each a and b, to a few ulp, as `root` has it.

    fa, fb   the function there; where their signs are the same, any number is returned
    """
    c, fc = a, fa
    fraction: Any = 0.5
    with np.errstate(all="ignore"):
        for _ in range(STEPS):
            x = a + fraction * (b - a)
            fx = function(x)
            same = np.signbit(fx) == np.signbit(fa)
            c, b, fc, fb = (
                np.where(same, a, b),
                np.where(same, b, a),
                np.where(same, fa, fb),
                np.where(same, fb, fa),
            )
            a, fa = x, fx
            best = np.where(np.abs(fa) < np.abs(fb), a, b)
            least = 2.0 * np.spacing(np.abs(best)) / np.abs(b - a)
            open_ = (least < 1.0) & (fa != 0.0) & (fb != 0.0)
            if not open_.any():
                break
            xi, phi = (a - b) / (c - b), (fa - fb) / (fc - fb)
            curved = fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
            safe = (phi * phi < xi) & ((1.0 - phi) * (1.0 - phi) < 1.0 - xi)
            fraction = np.where(open_, np.clip(np.where(safe, curved, 0.5), least, 1.0 - least), 0.0)
    return best


def sign_changes(function: Callable[[Any, Any], Any], nodes: Any) -> Any:
    """The first double after each sign change of a function between nodes, in rows with NaN in empty places.

    function  of flat arrays: rows of the nodes, and a place in each
    nodes     a row for each function, ascending
    """
    count, width = nodes.shape
    values = function(np.repeat(np.arange(count), width), nodes.reshape(-1)).reshape(nodes.shape)
    row, k = np.nonzero(np.diff(values > 0.0, axis=1) & np.isfinite(values[:, 1:] + values[:, :-1]))
    low, high, rising = nodes[row, k], nodes[row, k + 1], values[row, k + 1] > 0.0
    for _ in range(STEPS):
        middle = 0.5 * (low + high)
        if not ((low < middle) & (middle < high)).any():
            break
        after = (function(row, middle) > 0.0) == rising
        low, high = np.where(after, low, middle), np.where(after, middle, high)
    changes = np.full((count, np.bincount(row, minlength=1).max()), np.nan)
    changes[row, np.arange(row.size) - np.searchsorted(row, row)] = high
    return changes
