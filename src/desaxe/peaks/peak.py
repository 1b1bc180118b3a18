"""`peak`: the refined extremum of a quantity over the crank angle, with its exact gradient.

All designs of a call are searched at once (`search`). By the envelope theorem the gradient of the
extreme value is the partial derivative at the extreme angle. Friction makes kinks and jumps, where it has
none, and arcs in which no forces balance, towards which they grow without bound (`special`).
"""

from collections.abc import Mapping
from functools import partial
from typing import Any
from warnings import warn

import numpy as np
from numpy.typing import NDArray

from ..evaluation.arrays import as_array, broadcast_shape
from ..evaluation.labelled import loads_of
from ..loads.load import LoadWarning
from ..loads.resolve import VARIABLE
from ..mechanism.closed import TURN
from ..mechanism.inputs import INPUTS
from ..mechanism.keywords import check_inputs
from ..mechanism.messages import named
from ..mechanism.quantity_units import units_of_extreme
from ..mechanism.status import PeakStatus
from ..runtime.request import as_number, check_common, check_sliders, is_steady
from ..support.answer import Answer
from ..support.shown import shown as shown_value
from .designs import KINDS, peaks_of_designs, search_of, sought_of
from .nodes import Array

MOST_TURNS = 1000  # of a range of crank angles
ONE_TURN = (0.0, TURN)
MANY = 60  # values of a load: more are no designs that anybody compares
INPUTS_OF_PEAK = (*INPUTS, "branch", "kind", "accuracy", "threads", "sliders")


def peak(
    name: str,
    *,
    ec: Any = None,
    AB: Any = None,
    BC: Any = None,
    omega0: Any = None,
    alpha: Any = 0.0,
    omega: Any = None,
    branch: int = 1,
    kind: str = "absmax",
    theta: tuple[float, float] = ONE_TURN,
    accuracy: str | float = "standard",
    threads: int | None = None,
    sliders: Any = None,
    **loads: Any,
) -> dict[str, Any]:
    """The extreme value of a quantity over the crank angle; designs broadcast like NumPy.

    kind    "absmax" (the largest magnitude), "max" or "min"
    theta   range of crank angles [rad], ends included; default: one turn, or the cycle of the loads
    threads the number of threads; default: as many as speed it up. The result does not depend on it
    others  as in `evaluate`, masses and loads among them. F_X and F_Y may vary with the motion; at a jump
            both one-sided limits count, at an end of the range that from within and the value itself.
            `gradient` by such a force is that by a constant added to it
    sliders filled in by a `Crankshaft`

    Returns a dict, floats for one design and arrays for many:

    value     the extreme value; a magnitude for "absmax"; inf if it grows without bound at a
              limit angle of a mechanism that cannot turn fully
    theta     the crank angle at which it is reached; next to a jump the nearest double on that side
    side      of a load's jump (int8): -1 where the value is the limit from smaller theta, 1 from larger
              theta, 0 where nothing jumps
    gradient  dict parameter -> exact derivative of the value (ec, AB, BC, omega0 or omega, alpha, as
              far as the quantity depends on them), at a kink or jump with its own motion, 0 where the
              smallest magnitude is 0; NaN where the
              value is not finite or is reached at a limit angle, or where friction turns round or
              begins to jam; by the lengths at a change point at which a rate jumps
    status    0 ok, 1 cannot be assembled anywhere in the range, 2 reached at a limit angle or change
              point, or at an angle at which the friction turns round, 3 stalled in all of the range,
              4 bad input; 5 friction jams at some of the angles (no forces balance), 6 two sets of
              forces balance at some: the value is that of all others, inf where it grows without
              bound towards those at which friction jams

    If two angles share the extreme value, as by symmetry at ec = 0, one of them is returned, with the
    one-sided derivative there.

    Warns (LoadWarning) of a long array for F_X or F_Y and no other array: those are designs, not angles.
    Raises ValueError for an unknown quantity or kind.

    See docs/choose.md: which call for which question.
    """
    if not isinstance(name, str):
        raise TypeError(f"peak: expected one name, such as 'a_C', got {shown_value(name)}")
    if not isinstance(kind, str) or kind not in KINDS:
        raise ValueError(f"kind = {shown_value(kind)}: it is one of {', '.join(KINDS)}")
    inputs = {"ec": ec, "AB": AB, "BC": BC, "omega0": omega0, "alpha": alpha, "omega": omega, **loads}
    ends = None if theta is ONE_TURN else _range(theta, name)
    if sliders is not None:
        check_sliders(sliders)
        inputs["alpha"] = None if is_steady(alpha) else alpha
        whole: dict[str, Any] = sliders.peak(
            name, kind, ends, {n: v for n, v in inputs.items() if v is not None}
        )
        return whole
    check_inputs("peak", loads, INPUTS_OF_PEAK)
    check_common(inputs, branch, threads)
    _, varying = loads_of(inputs)
    sought = sought_of(name, kind, inputs, varying, branch, accuracy, ends)._replace(threads=threads)
    plan = sought.plan
    if ends is None:
        _range(sought.ends, name)  # the cycle of loads may have too many turns
    if "omega0" in plan.needs and omega0 is None:
        inputs["omega0"] = 0.0 if "omega0" not in plan.parameters else None  # which only the status uses
    arrays = {n: as_array(n, inputs.get(n), plan.needs, (name,)) for n in sought.numbers}
    _warn_of_columns(arrays)
    shape = broadcast_shape(arrays)
    columns = {n: _flat(a, shape) for n, a in arrays.items()}
    search = search_of(plan, arrays, sought.ends)
    result = peaks_of_designs(sought, search, columns)
    return Answer(_shaped(result, shape), partial(units_of_extreme, name), PeakStatus)


def _range(theta: Any, name: str) -> tuple[float, float]:
    """The ends of the range of crank angles."""
    try:
        first, last = theta
    except (TypeError, ValueError):
        raise ValueError(named("theta", theta) + ": expected a range (lower end, upper end)") from None
    low, high = (as_number("theta", end, ("theta",), (name,)) for end in (first, last))
    if low is None or high is None or low > high:
        raise ValueError(named("theta", (first, last)) + ": two angles, the lower one first")
    if high - low > MOST_TURNS * TURN:
        turns = (high - low) / TURN
        raise ValueError(
            named("theta", (low, high), "g") + f": {turns:.3g} turns are too many, at most {MOST_TURNS}"
        )
    return low, high


def _warn_of_columns(inputs: Mapping[str, Any]) -> None:
    """A long array of loads and no other array are hardly designs: more likely a load over theta."""
    arrays = {n: shape for n, value in inputs.items() if (shape := np.shape(value))}
    for name, shape in arrays.items():
        if name in VARIABLE and len(arrays) == 1 and len(shape) == 1 and shape[0] > MANY:
            warn(
                f"{name}: peak takes an array for so many designs, here {shape[0]} that differ in {name} "
                f"alone; for a load over the crank angle give {name}=desaxe.over_theta(angles, values)",
                LoadWarning,
                stacklevel=3,
            )


def _flat(array: Array, shape: tuple[int, ...]) -> Array:
    """A value for each design."""
    return np.broadcast_to(array, shape).reshape(-1) if shape else array.reshape(1)


def _shaped(result: dict[str, Any], shape: tuple[int, ...]) -> dict[str, Any]:
    """The results in the shape of the designs; plain numbers for one design."""

    def shaped(array: NDArray[Any]) -> Any:
        return array.reshape(shape) if shape else array[0].item()

    gradient = {name: shaped(slope) for name, slope in result.pop("gradient").items()}
    parts = {name: shaped(array) for name, array in result.items()}
    first = {name: parts.pop(name) for name in ("value", "theta", "side")}
    return {**first, "gradient": gradient, "status": parts["status"]}
