"""`evaluate(..., quality=True)` under loads that are tables.

Conditions are those of the whole: they count that an input moves the place at which a load is looked up; that
of a load is by a percent of it. The bound is that at the force of the instant, as if it were exact, and what
the force itself may be wrong by: what it changes within the error of its place, and the rounding of a cubic.
"""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...loads.load import Load, OverY, TableOverTheta, ahead
from ...loads.resolve import way_of
from ...loads.stroke import OverStroke
from ...loads.table import Table
from ...mechanism.messages import message_of
from ...mechanism.names import LENGTHS, sensitivity
from ...runtime.request import several
from ..arrays import numeric
from ..quality import ROUNDED_ONCE, Quality, conditions_of, digits_of, evaluate_quality
from ..values import values
from .loaded import evaluate_loaded
from .request import MOTION, plan_for

Array = NDArray[Any]
ROUNDINGS = 8.0  # of a cubic and its distance from a knot


def evaluate_loaded_quality(
    names: str | Sequence[str],
    given: Mapping[str, Any],
    branch: int,
    accuracy: Any,
    threads: int | None,
    out: Any,
) -> Any:
    """The qualities of one name under loads, or a dict of them; TypeError for a load that is a function."""
    for name, load in given.items():
        if callable(load) and not isinstance(load, (TableOverTheta, OverY)):
            raise TypeError(
                f"{name}: quality=True takes numbers and tables, whose errors it knows, not a function; give "
                f"its values at these angles, {name} = load(theta)"
            )
    if not isinstance(names, str):
        rest = (given, branch, accuracy, threads, out)
        return {name: evaluate_loaded_quality(name, *rest) for name in several(names)}
    numbers, plan = plan_for((names,), given)
    forces = {n: _force_and_error(load, numbers, branch, threads) for n, load in plan.loads.items()}
    held = {**dict.fromkeys(MOTION), **numbers, **{n: force for n, (force, _) in forces.items()}}
    found: Quality = evaluate_quality(names, held, branch, accuracy, threads, out)
    if not plan.loads:
        return found
    by_force = {n: sensitivity(names, n) for n in plan.loads}
    moving = {p for load in plan.loads.values() for p in load.parameters} & found.conditions.keys()
    totals = {p: sensitivity(names, p) for p in moving}
    try:
        slopes = evaluate_loaded([*totals.values()], given, branch, accuracy, threads)
    except ValueError as error:
        raise ValueError(f"quality of {names}: not available under a load; " + message_of(error)) from None
    partial = values([*by_force.values()], held, branch, threads=threads)
    bound = np.asarray(found.error_bound)
    for name, slope in by_force.items():
        bound = bound + np.abs(partial[slope]) * forces[name][1]
    bound = bound.reshape(np.shape(found.value))
    value = evaluate_loaded(names, given, branch, accuracy, threads)
    moved = {p: conditions_of(value, numbers[p], slopes[slope]) for p, slope in totals.items()}
    plain = float(bound) if np.ndim(value) == 0 else np.array(bound)
    return Quality(value, {**found.conditions, **moved}, plain, digits_of(value, bound, np.shape(value)))


def _force_and_error(
    load: Load, numbers: Mapping[str, Any], branch: int, threads: int | None
) -> tuple[Any, Array]:
    """A force from a table, a number at a point, and its error bound."""
    theta = np.asarray(numeric("theta", numbers["theta"], ("quality",)))
    if isinstance(load, TableOverTheta):
        room = 4.0 * ROUNDED_ONCE * (np.abs(theta) + load.period)
        here, *beside = (load.both(at)[0] for at in (theta, theta - room, theta + room))
        return here[()], _largest(here, beside) + ROUNDINGS * ROUNDED_ONCE * _size(load.table)
    assert isinstance(load, OverY)
    given = {**dict.fromkeys(MOTION), **{n: numbers[n] for n in LENGTHS}, "theta": theta}
    names = ["Y", *([load.centre] if isinstance(load, OverStroke) else [])]
    places = evaluate_quality(names, given, branch, "standard", threads, None)
    motion = values(list(load.motion()), given, branch, threads=threads)
    speeds = {n: numeric(n, numbers[n], ("quality",)) for n in ("omega0", "omega", "alpha") if n in numbers}
    x = np.asarray(load.along(motion))
    room = sum(np.asarray(one.error_bound) for one in places.values()) + 2.0 * ROUNDED_ONCE * np.abs(x)
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
