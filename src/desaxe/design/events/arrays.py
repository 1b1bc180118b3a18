"""`events` for arrays of designs: closed forms in NumPy, velocities by bisection."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...evaluation.arrays import as_array, broadcast_shape
from ...evaluation.evaluate import evaluate
from ...mechanism.closed.dead_centres import DEAD_CENTRES
from ...mechanism.closed.functions import closed_form
from ...mechanism.names import LENGTHS
from ..feasibility.arrays import only_good
from .found import VELOCITIES, Found, stroke_ends

Array = NDArray[np.float64]
HALVINGS = 55  # of a turn: down to the last bits


def events_of_arrays(
    given: dict[str, Any], branch: int, with_speed: bool, with_velocities: bool = True
) -> dict[str, Any]:
    """The results of `events` in the broadcast shape of the inputs."""
    inputs = {n: as_array(n, value, tuple(given), ("events",)) for n, value in given.items()}
    shape = broadcast_shape(inputs)
    ec, AB, BC, omega = (np.broadcast_to(a, shape) for a in inputs.values())
    bad, lengths = only_good(ec, AB, BC)
    bad |= ~np.isfinite(omega)
    ec, AB, BC, omega = (np.where(bad, np.nan, a) for a in (*lengths, omega))
    turning = np.where(omega < 0.0, -1.0, 1.0)
    outputs = closed_form(DEAD_CENTRES, branch=float(branch)).arrays(ec, AB, BC, turning)
    found = Found(tuple(np.array(np.broadcast_to(output, shape)) for output in outputs))
    status = np.where(bad, 4, found.status).astype(np.int8)
    slow = np.where(bad, 0, branch * turning * np.sign(np.nan_to_num(ec))).astype(np.int8)
    result: dict[str, Any] = {**found.values, "slow_stroke": slow, **found.places}
    gradient = found.gradient
    turns = (status == 0) | (status == 2)
    for name, direction in VELOCITIES.items() if with_velocities else ():
        inputs_here = (ec, AB, BC, omega)
        value, theta, slopes = _velocities(found.values, direction * branch, branch, turns, inputs_here)
        result |= {name: value, f"theta_{name}": theta}
        gradient[name] = slopes if with_speed else {p: slopes[p] for p in LENGTHS}
    return {**result, "gradient": gradient, "status": status}


def _velocities(
    values: dict[str, Any], side: int, branch: int, turns: NDArray[np.bool_], inputs: tuple[Array, ...]
) -> tuple[Array, Array, dict[str, Array]]:
    """The largest |V_C| while the slider moves to this side of Y: values, crank angles, derivatives."""
    *lengths, omega = (a[turns] for a in inputs)
    here: dict[str, Any] = {**dict(zip(LENGTHS, lengths, strict=True)), "branch": branch}
    value, theta = np.full(turns.shape, np.nan), np.full(turns.shape, np.nan)
    slopes = {p: np.full(turns.shape, np.nan) for p in (*LENGTHS, "omega0")}
    if not omega.size:
        return value, theta, slopes
    forth, back = (stroke_ends(values, way, branch) for way in (side, -side))
    ahead = omega >= 0.0
    a, b = (
        np.where(ahead, np.broadcast_to(f, turns.shape)[turns], np.broadcast_to(g, turns.shape)[turns])
        for f, g in zip(forth, back, strict=True)
    )
    first = evaluate("a_C", theta=a, omega0=1.0, **here)
    last = evaluate("a_C", theta=b, omega0=1.0, **here)
    fastest = evaluate("V_C", theta=np.stack([a, b]), omega0=1.0, **here)
    end = np.where(np.abs(fastest[0]) >= np.abs(fastest[1]), a, b)  # no crank, or fastest at a change point
    for _ in range(HALVINGS):
        middle = 0.5 * (a + b)
        same = np.sign(evaluate("a_C", theta=middle, omega0=1.0, **here)) == np.sign(first)
        a, b = np.where(same, middle, a), np.where(same, b, middle)
    angle = np.where(np.sign(first) * np.sign(last) < 0.0, a, end)
    names = ["V_C", *(f"V_C_wrt_{p}" for p in slopes)]
    found = evaluate(names, theta=angle, omega0=omega, **here)
    value[turns], theta[turns] = side * found["V_C"], np.where(angle < -np.pi / 2, angle + 2 * np.pi, angle)
    for p, slope in slopes.items():
        slope[turns] = side * found[f"V_C_wrt_{p}"]
    return value, theta, slopes
