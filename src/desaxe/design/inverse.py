"""`inverse`: the crank angles that put the slider at a position (the slider-driven problem)."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..evaluation.arrays import as_array, broadcast_shape, number_or_array
from ..evaluation.evaluate import evaluate
from ..evaluation.labelled import refuse_other_labels
from ..mechanism.closed import TURN
from ..mechanism.closed.dead_centres import DEAD_CENTRES
from ..mechanism.closed.functions import closed_form
from ..mechanism.closed.inverse import INVERSE
from ..mechanism.inputs import INPUTS, Input
from ..mechanism.names import LENGTHS
from ..mechanism.quantity_units import units_by_name
from ..mechanism.status import InverseStatus
from ..runtime.request import check_common, with_known_inputs
from ..support.answer import Answer

Array = NDArray[np.float64]
DEAD_CENTRE = InverseStatus.DEAD_CENTRE
NEAR = 1e-4  # of the crank: distances from the dead centre at which the turn from it is known by a parabola
STEPS = 5  # of Newton's method
LARGEST = 0.1  # rad: of a step

# What only this question takes; the lengths are those of every other.
SLIDER_INPUTS = {
    row.name: row
    for row in (
        Input("Y", "m", "slider position along the slider axis"),
        Input("s", "m", "slider's distance from its outer dead centre", 0.0, "a finite length >= 0"),
        Input("V_C", "m/s", "velocity of the slider"),
        Input("a_C", "m/s^2", "acceleration of the slider"),
    )
}


@with_known_inputs
def inverse(
    *,
    Y: Any = None,
    ec: Any,
    AB: Any,
    BC: Any,
    branch: int = 1,
    s: Any = None,
    V_C: Any = None,
    a_C: Any = None,
) -> dict[str, Any]:
    """The crank angles that put the slider at Y, or s from its outer dead centre, and the crank's motion.

    Y            slider position [m]; arrays of everything broadcast like NumPy
    s            in place of Y: distance from the outer dead centre [m], exact next to it, too
    ec, AB, BC   lengths [m], as in `evaluate`
    branch       +1 or -1: only angles at which the mechanism is on this branch
    V_C, a_C     the slider's velocity [m/s] and acceleration [m/s^2], if known

    Returns a dict; the last axis of each array has the two solutions, NaN where there is none:

    theta    crank angles [rad] in (-pi, pi], ascending
    omega    crank speed [rad/s], given V_C
    alpha    crank acceleration [rad/s^2], given V_C and a_C
    status   0 two solutions or one, 1 the slider cannot be there on this branch, 2 dead centre: the
             crank's rates are not determined by the slider's, 4 bad input

    A closed form, `mechanism/closed/inverse.py`. Raises as `evaluate` does.

    See docs/choose.md: which call for which question.
    """
    check_common({}, branch)
    if a_C is not None and V_C is None:
        raise TypeError("inverse: V_C is missing (alpha needs V_C and a_C)")
    if Y is not None and s is not None:
        raise TypeError("inverse: Y and s both say where the slider is; give one of them")
    at = "Y" if s is None else "s"
    inputs = {at: Y if s is None else s, "ec": ec, "AB": AB, "BC": BC, "V_C": V_C, "a_C": a_C}
    refuse_other_labels(inputs)
    arrays = {
        name: _input(name, value)
        for name, value in inputs.items()
        if value is not None or name in (*INPUTS, at)
    }
    shape = broadcast_shape(arrays)
    position, *lengths = (np.broadcast_to(arrays[n], shape) for n in (at, *LENGTHS))
    if s is None:
        theta, status = _angles(position, lengths, branch, shape)
    else:
        theta, status = _angles_at_distance(position, lengths, branch, shape)
    result: dict[str, Any] = {"theta": theta}
    if V_C is not None:
        slope, bend = _values(theta, lengths, branch, ("Y_wrt_theta", "Y_wrt_theta_theta"))
        slope[status == DEAD_CENTRE] = np.nan  # there the crank's rates are not determined
        with np.errstate(all="ignore"):  # omega = V_C/Y', alpha = (a_C - omega^2 Y'')/Y', by theta
            result["omega"] = np.broadcast_to(arrays["V_C"], shape)[..., None] / slope
            if a_C is not None:
                acceleration = np.broadcast_to(arrays["a_C"], shape)[..., None]
                result["alpha"] = (acceleration - result["omega"] ** 2 * bend) / slope
    result["status"] = _status(status, arrays, shape)
    return Answer(result, units_by_name, InverseStatus)


def _input(name: str, value: Any) -> Array:
    if value is None:
        raise TypeError(f"inverse: {name} is missing (needed: Y or s, ec, AB, BC)")
    if name in INPUTS:
        return as_array(name, value, ("Y", "ec", "AB", "BC"), ("inverse",))
    return number_or_array(SLIDER_INPUTS[name], value)


def _angles(
    position: Array, lengths: list[Array], branch: int, shape: tuple[int, ...]
) -> tuple[Array, NDArray[np.int8]]:
    """Both crank angles, ascending, NaN where there is none; and the status, but for bad inputs."""
    ec, AB, BC = lengths
    crank = np.where((AB >= 0.0) & (BC > 0.0), AB, np.nan)
    form = closed_form(INVERSE, branch=float(branch))
    inputs = position, ec, crank, BC
    first, second, status = form.arrays(*inputs) if shape else form.point(*map(float, inputs))
    theta = np.stack([np.broadcast_to(angle, shape) for angle in (first, second)], axis=-1)
    return theta, np.broadcast_to(np.asarray(status, np.int8), shape)


def _angles_at_distance(
    distance: Array, lengths: list[Array], branch: int, shape: tuple[int, ...]
) -> tuple[Array, NDArray[np.int8]]:
    """Both crank angles at a distance from the outer dead centre; Newton mends what Y rounds away."""
    form = closed_form(DEAD_CENTRES, ("Y_outer", "theta_outer"), branch=float(branch))
    outer, centre = (np.broadcast_to(part, shape) for part in form.arrays(*lengths))
    theta, status = _angles(outer - branch * distance, lengths, branch, shape)
    at_centre: dict[str, Any] = dict(zip(LENGTHS, lengths, strict=True))
    with np.errstate(all="ignore"):
        bend = evaluate("Y_wrt_theta_theta", theta=np.nan_to_num(centre), branch=branch, **at_centre)
        turn = np.sqrt(2.0 * distance / np.abs(bend))[..., None] * np.array([-1.0, 1.0])
        near = (distance < NEAR * lengths[1])[..., None] & np.isfinite(turn)
        theta = np.where(near, centre[..., None] + turn, theta)
        for _ in range(STEPS):
            there, slope = _values(theta, lengths, branch, ("s", "s_wrt_theta"))
            step = (there - distance[..., None]) / slope
            theta = np.where(np.isfinite(step) & (np.abs(step) < LARGEST), theta - step, theta)
    close = near[..., 0] & (status != 4)  # where the rounding of Y decides nothing
    at_outer = close & (distance == 0.0)
    theta = np.where(at_outer[..., None], np.stack([centre, np.full(shape, np.nan)], axis=-1), theta)
    status = np.where(at_outer, np.int8(DEAD_CENTRE), np.where(close, np.int8(0), status))
    return np.sort(theta - TURN * np.ceil(theta / TURN - 0.5), axis=-1), status


def _values(theta: Array, lengths: list[Array], branch: int, names: tuple[str, str]) -> list[Array]:
    """Quantities at both angles of each design, NaN where there is none."""
    sides: dict[str, Any] = {
        n: np.broadcast_to(v[..., None], theta.shape) for n, v in zip(LENGTHS, lengths, strict=True)
    }
    here = evaluate(names, theta=np.nan_to_num(theta), branch=branch, **sides)
    return [np.where(np.isfinite(theta), here[name], np.nan) for name in names]


def _status(status: NDArray[np.int8], arrays: dict[str, Array], shape: tuple[int, ...]) -> Any:
    bad = np.zeros(shape, bool)
    for name, array in arrays.items():
        least = INPUTS[name].least if name in INPUTS else None
        good = np.isfinite(array) if least is None else np.isfinite(array) & (array >= least)
        bad |= ~np.broadcast_to(good, shape)
    result = np.where(bad, np.int8(4), status)
    return result if shape else int(result)
