"""`evaluate(..., quality=True)`: values with condition numbers, error bound and valid digits.

A condition number |x/f df/dx| says how many times larger the relative error of f is than that of the
input x. The bound of the rounding error is the library's promise: 8 last bits, times 1 plus the sum
of the condition numbers, in which the margin BC - AB - |ec|, which is exact, is an input in place of
ec. With ec = +-(BC - AB - margin), the slopes by AB and BC get that by ec.
"""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..loads.along_motion import SPEEDS
from ..loads.load import Load, OverY, TableOverTheta, ahead
from ..loads.resolve import way_of
from ..loads.stroke import OverStroke
from ..loads.table import Table
from ..mechanism.catalogue import quantity
from ..mechanism.messages import message_of
from ..mechanism.names import LENGTHS, parts, sensitivity
from ..runtime.request import BOUNDS, accuracy_of, check_common, request, several
from .arrays import as_array, broadcast_shape
from .labelled import refuse_other_labels
from .under_loads import MOTION, plan_for
from .values import values

Array = NDArray[np.float64]

PROMISE = BOUNDS["standard"]
ROUNDED_ONCE = 2.0**-53
SMALLEST = 2.0**-1074
ROUNDINGS = 8.0  # of a cubic and its distance from a knot
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
    inputs: Mapping[str, Any],
    branch: int,
    accuracy: Any,
    threads: int | None,
    out: Any,
) -> Any:
    """The qualities of one name, or a dict of them."""
    check_common(inputs, branch, threads)
    if out is not None:
        raise TypeError("out= is for plain values, not with quality=True")
    if accuracy_of(accuracy) != "standard":
        raise ValueError(f"accuracy = {accuracy!r}: quality=True knows the errors of 'standard' alone")
    varying = {name: load for name, load in inputs.items() if callable(load)}
    for name, load in varying.items():
        if not isinstance(load, (TableOverTheta, OverY)):
            raise TypeError(
                f"{name}: quality=True takes numbers and tables, whose errors it knows, not a function; give "
                f"its values at these angles, {name} = load(theta)"
            )
    of = _under_loads if varying else _quality
    if isinstance(names, str):
        return of(names, inputs, branch, threads)
    return {name: of(name, inputs, branch, threads) for name in several(names)}


def _quality(name: str, given: Mapping[str, Any], branch: int, threads: int | None) -> Quality:
    needs = request((name,), given, branch, "standard").inputs
    refuse_other_labels({p: given.get(p) for p in needs})
    slopes = _slope_names(name, needs, given.get("omega") is not None)
    gap = ["margin"] if name != "margin" and set(LENGTHS) <= set(needs) else []
    result = values([name, *slopes.values(), *gap], dict(given), branch, threads=threads)
    arrays = {p: as_array(p, given.get(p), needs, (name,)) for p in needs}
    by = {p: np.asarray(result[slope]) for p, slope in slopes.items()}
    if name == "margin":
        by = {"ec": -np.copysign(1.0, arrays["ec"]), "AB": np.array(-1.0), "BC": np.array(1.0)}
    f, shape = np.asarray(result[name]), broadcast_shape(arrays)
    with np.errstate(all="ignore"):
        steps = {p: _step(arrays[p], slope) for p, slope in by.items()}
        conditions = {p: _condition(f, step, shape) for p, step in steps.items()}
        if gap:
            steps |= _steps_with_margin(arrays, by, np.asarray(result["margin"]))
        bound = np.abs(f) * ROUNDED_ONCE if name == "margin" else _bound(f, steps)
    return Quality(result[name], conditions, _shaped(bound, shape), _digits(f, bound, shape))


def _slope_names(name: str, needs: Sequence[str], state: bool) -> dict[str, str]:
    """Input -> the derivative of a name by it; ValueError where that is not derived."""
    if name == "margin":  # its derivatives are 1 and -1
        return {}
    if name == "status":
        raise ValueError("quality of status: it is not a real number")
    result = {p: sensitivity(name, p) for p in needs}
    try:
        for slope in result.values():
            quantity(slope, state)
    except ValueError:
        base = parts(name)[0]
        raise ValueError(
            f"quality of {name}: not available, as its own derivatives are not derived; that of {base} is"
        ) from None
    return result


def _digits(f: Any, bound: Any, shape: tuple[int, ...]) -> Any:
    """Return the decimal digits that an error bound leaves of a value, a float for one point."""
    with np.errstate(all="ignore"):
        lost = np.where(bound == 0.0, 0.0, bound / np.abs(f))
        return _shaped(np.clip(-np.log10(lost), 0.0, MOST_DIGITS), shape)


def _condition(f: Any, step: Array, shape: tuple[int, ...]) -> Any:
    """|x/f df/dx| from |x df/dx|, a float for one point."""
    return _shaped(np.where(np.isnan(f), np.nan, np.where(step == 0.0, 0.0, step / np.abs(f))), shape)


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


# ---- under loads ------------------------------------------------------------------------------------


def _under_loads(name: str, inputs: Mapping[str, Any], branch: int, threads: int | None) -> Quality:
    """The quality of a name under loads that are tables.

    Conditions are those of the whole: they count that an input moves the place at which a load is looked up;
    that of a load is by a percent of it. The bound is that at the force of the instant, as if it were exact,
    and what the force itself may be wrong by: what it changes within the error of its place, and the rounding
    of a cubic.
    """
    numbers, plan = plan_for((name,), inputs)
    forces = {n: _force_and_error(load, numbers, branch, threads) for n, load in plan.loads.items()}
    held = {**dict.fromkeys(MOTION), **numbers, **{n: force for n, (force, _) in forces.items()}}
    result = _quality(name, held, branch, threads)
    if not plan.loads:
        return result
    by_force = {n: sensitivity(name, n) for n in plan.loads}
    moving = {p for load in plan.loads.values() for p in load.parameters} & result.conditions.keys()
    totals = {p: sensitivity(name, p) for p in moving}
    try:
        slopes = values([*totals.values()], inputs, branch, threads=threads)
    except ValueError as error:
        raise ValueError(f"quality of {name}: not available under a load; " + message_of(error)) from None
    partial = values([*by_force.values()], held, branch, threads=threads)
    bound = np.asarray(result.error_bound)
    for force, slope in by_force.items():
        bound = bound + np.abs(partial[slope]) * forces[force][1]
    bound = bound.reshape(np.shape(result.value))
    value = values(name, inputs, branch, threads=threads)
    shape = np.shape(value)
    with np.errstate(all="ignore"):
        steps = {p: _step(as_array(p, numbers[p], (p,), (name,)), slopes[of]) for p, of in totals.items()}
        moved = {p: _condition(value, step, shape) for p, step in steps.items()}
    return Quality(value, {**result.conditions, **moved}, _shaped(bound, shape), _digits(value, bound, shape))


def _force_and_error(
    load: Load, numbers: Mapping[str, Any], branch: int, threads: int | None
) -> tuple[Any, Array]:
    """A force from a table, a number at a point, and its error bound."""
    theta = as_array("theta", numbers["theta"], ("theta",), ("quality",))
    if isinstance(load, TableOverTheta):
        room = 4.0 * ROUNDED_ONCE * (np.abs(theta) + load.period)
        here, *beside = (load.both(at)[0] for at in (theta, theta - room, theta + room))
        return here[()], _largest(here, beside) + ROUNDINGS * ROUNDED_ONCE * _size(load.table)
    assert isinstance(load, OverY)
    inputs = {**dict.fromkeys(MOTION), **{n: numbers[n] for n in LENGTHS}, "theta": theta}
    names = ["Y", *([load.centre] if isinstance(load, OverStroke) else [])]
    errors = [np.asarray(_quality(name, inputs, branch, threads).error_bound) for name in names]
    motion = values(list(load.motion()), inputs, branch, threads=threads)
    speeds = {n: as_array(n, numbers[n], (n,), ("quality",)) for n in SPEEDS if n in numbers}
    x = np.asarray(load.along(motion))
    room = sum(errors) + 2.0 * ROUNDED_ONCE * np.abs(x)
    way = ahead(motion, way_of(speeds))
    piece = load.piece(x, way)
    here = load.held(x, piece)[0]
    ends = [np.asarray(x + side * room) for side in (-1.0, 1.0)]
    # Where it jumps nowhere the piece is that of the exact position, which may be the next one.
    beside = [(load.held(end, piece) if load.jumping else load.both(end, way))[0] for end in ends]
    ways = [load.outward] if load.inward is None else [load.outward, load.inward]
    error = _largest(here, beside) + ROUNDINGS * ROUNDED_ONCE * max(map(_size, ways))
    return np.nan_to_num(here)[()], error


def _largest(here: Array, beside: Sequence[Array]) -> Array:
    return np.asarray(np.maximum.reduce([np.abs(other - here) for other in beside]))


def _size(table: Table) -> float:
    """The largest sum of the magnitudes of a cubic's terms on its piece."""
    ends = [*table.knots, table.knots[0] + table.period if table.period else table.knots[-1]]
    widths = [0.0, *(b - a for a, b in pairwise(ends))]
    return max(
        sum(abs(c) * width**k for k, c in enumerate(row))
        for row, width in zip(table.rows, widths, strict=True)
    )
