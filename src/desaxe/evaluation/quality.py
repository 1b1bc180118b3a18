"""`evaluate(..., quality=True)`: values with condition numbers, error bound and valid digits.

A condition number |x/f df/dx| says how many times larger the relative error of f is than that of the
input x. The bound of the rounding error is the library's promise: 8 last bits, times 1 plus the sum
of the condition numbers, in which the margin BC - AB - |ec|, which is exact, is an input in place of
ec. With ec = +-(BC - AB - margin), the slopes by AB and BC get that by ec.
"""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..mechanism.catalogue import quantity
from ..mechanism.names import LENGTHS, parts, sensitivity
from ..runtime.request import BOUNDS, accuracy_of, check_common, request, several
from .arrays import as_array, broadcast_shape, refuse_other_labels
from .values import values

Array = NDArray[np.float64]

PROMISE = BOUNDS["standard"]
ROUNDED_ONCE = 2.0**-53
SMALLEST = 2.0**-1074
MOST_DIGITS = 17.0  # what it takes to write a double down


class Quality(NamedTuple):
    """A value or array of values with condition numbers, error bound and valid digits.

    value        as `evaluate` gives it
    conditions   input -> |input/value d value/d input|: the percent by which the value changes when
                 that input alone changes by one percent. 0 where the input is 0 or has no effect;
                 inf where the value is 0 and the input moves it, NaN where the value is NaN
    error_bound  the rounding error is at most this, in the unit of the value, for the inputs as they
                 are (exact doubles); inf where no bound is known, NaN where the value is
    digits       how many decimal digits of the value that leaves, 0 to 17
    """

    value: Any
    conditions: dict[str, Any]
    error_bound: Any
    digits: Any


def evaluate_quality(
    names: str | Sequence[str],
    given: Mapping[str, Any],
    branch: int,
    accuracy: Any,
    threads: int | None,
    out: Any,
) -> Any:
    """The qualities of one name, or a dict of them."""
    check_common(given, branch, threads)
    if out is not None:
        raise TypeError("out= is for plain values, not with quality=True")
    if accuracy_of(accuracy) != "standard":
        raise ValueError(f"accuracy = {accuracy!r}: quality=True knows the errors of 'standard' alone")
    rest = {"branch": branch, "threads": threads}
    if isinstance(names, str):
        return _quality(names, given, rest)
    return {name: _quality(name, given, rest) for name in several(names)}


def _quality(name: str, given: Mapping[str, Any], rest: Mapping[str, Any]) -> Quality:
    needs = request((name,), given, rest["branch"], "standard").inputs
    refuse_other_labels({p: given.get(p) for p in needs})
    slopes = _slope_names(name, needs, given.get("omega") is not None)
    gap = ["margin"] if name != "margin" and set(LENGTHS) <= set(needs) else []
    found = values([name, *slopes.values(), *gap], dict(given), **rest)
    arrays = {p: as_array(p, given.get(p), needs, (name,)) for p in needs}
    by = {p: np.asarray(found[slope]) for p, slope in slopes.items()}
    if name == "margin":
        by = {"ec": -np.copysign(1.0, arrays["ec"]), "AB": np.array(-1.0), "BC": np.array(1.0)}
    f, shape = np.asarray(found[name]), broadcast_shape(arrays)
    with np.errstate(all="ignore"):
        steps = {p: _step(arrays[p], slope) for p, slope in by.items()}
        conditions = {p: np.where(step == 0.0, 0.0, step / np.abs(f)) for p, step in steps.items()}
        if gap:
            steps |= _steps_with_margin(arrays, by, np.asarray(found["margin"]))
        bound = np.abs(f) * ROUNDED_ONCE if name == "margin" else _bound(f, steps)
    plain = {p: _shaped(np.where(np.isnan(f), np.nan, c), shape) for p, c in conditions.items()}
    return Quality(found[name], plain, _shaped(bound, shape), digits_of(f, bound, shape))


def _slope_names(name: str, needs: Sequence[str], state: bool) -> dict[str, str]:
    """Input -> the derivative of a name by it; ValueError where that is not derived."""
    if name == "margin":  # its derivatives are 1 and -1
        return {}
    if name == "status":
        raise ValueError("quality of status: it is not a real number")
    found = {p: sensitivity(name, p) for p in needs}
    try:
        for slope in found.values():
            quantity(slope, state)
    except ValueError:
        base = parts(name)[0]
        raise ValueError(
            f"quality of {name}: not available, as its own derivatives are not derived; that of {base} is"
        ) from None
    return found


def digits_of(f: Any, bound: Any, shape: tuple[int, ...]) -> Any:
    """Return the decimal digits that an error bound leaves of a value, a float for one point."""
    with np.errstate(all="ignore"):
        lost = np.where(bound == 0.0, 0.0, bound / np.abs(f))
        return _shaped(np.clip(-np.log10(lost), 0.0, MOST_DIGITS), shape)


def conditions_of(f: Any, x: Any, slope: Any) -> Any:
    """|x/f df/dx|, a float for one point."""
    with np.errstate(all="ignore"):
        step = _step(np.asarray(x, float), np.asarray(slope))
        found = np.where(step == 0.0, 0.0, step / np.abs(f))
    return _shaped(np.where(np.isnan(f), np.nan, found), np.shape(f))


def _step(x: Array, slope: Array) -> Array:
    """|x df/dx|; a relative change of 0 moves nothing."""
    return np.where((x == 0.0) | (slope == 0.0), 0.0, np.abs(x * slope))


def _steps_with_margin(
    inputs: Mapping[str, Array], by: Mapping[str, Array], margin: Array
) -> dict[str, Array]:
    """Error steps of the lengths and of the margin, which stands in the place of ec.

    Next to a change point the slopes by ec and a length cancel: their own errors are counted too.
    """
    side = np.copysign(1.0, inputs["ec"]) * by["ec"]
    steps = {"ec": _step(margin, side)}
    for length, sign in (("AB", -1.0), ("BC", 1.0)):
        slope = np.abs(by[length] + sign * side)
        steps[length] = _step(inputs[length], slope + PROMISE * (np.abs(by[length]) + np.abs(side)))
    return steps


def _bound(f: Array, steps: Mapping[str, Array]) -> Array:
    """The error bound in the unit of the value; inf where a derivative is not finite."""
    total = np.abs(f) + sum(steps.values(), np.array(0.0))
    bound = np.where(np.isfinite(total), PROMISE * total + SMALLEST * (total > 0.0), np.inf)
    return np.where(np.isnan(f), np.nan, bound)


def _shaped(array: Array, shape: tuple[int, ...]) -> Any:
    """A copy in the broadcast shape; a float for one point."""
    return np.broadcast_to(array, shape).copy() if shape else float(array)
