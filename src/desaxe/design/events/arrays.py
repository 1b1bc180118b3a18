"""`events` for arrays of designs: closed forms in NumPy, velocities by bisection."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...evaluation.arrays import as_array, broadcast_shape
from ...evaluation.evaluate import evaluate
from ...mechanism.names import LENGTHS
from ..number_or_array import arrays, sum_of_three
from .closed_form import VELOCITIES, Known, closed_form, placed, stroke_ends

Array = NDArray[np.float64]
HALVINGS = 55  # of a turn: down to the last bits


def events_of_arrays(
    given: dict[str, Any], branch: int, with_speed: bool, with_velocities: bool = True
) -> dict[str, Any]:
    """The results of `events` in the broadcast shape of the inputs."""
    inputs = {n: as_array(n, value, tuple(given), ("events",)) for n, value in given.items()}
    shape = broadcast_shape(inputs)
    ec, AB, BC, omega = (np.broadcast_to(a, shape) for a in inputs.values())
    bad = ~(
        np.isfinite(ec) & np.isfinite(AB) & np.isfinite(BC) & np.isfinite(omega) & (AB >= 0.0) & (BC > 0.0)
    )
    ec, AB, BC, omega = (np.where(bad, np.nan, a) for a in (ec, AB, BC, omega))
    turn = branch * np.where(omega < 0.0, -1, 1)
    with np.errstate(all="ignore"):
        known = placed(closed_form(ec, AB, BC, arrays()), branch, 1)
        advance, back = known["advance_angle"], known["return_angle"]
        known["advance_angle"] = _turned(turn, advance, back)
        known["return_angle"] = _turned(turn, back, advance)
        margin = sum_of_three(BC, -AB, -np.abs(ec))
    status = np.select([bad, margin < 0.0, margin == 0.0], [4, 1, 2], 0).astype(np.int8)
    result: dict[str, Any] = {name: np.asarray(value) for name, (value, _, _) in known.items()}
    result["slow_stroke"] = np.where(bad, 0, turn * np.sign(np.nan_to_num(ec))).astype(np.int8)
    result |= _rod_places(ec, AB, bad | (margin < 0.0))
    gradient = {n: dict(zip(LENGTHS, slopes, strict=True)) for n, (_, slopes, _) in known.items()}
    turns = (status == 0) | (status == 2)
    for name, direction in VELOCITIES.items() if with_velocities else ():
        value, theta, slopes = _velocities(known, direction * branch, branch, turns, (ec, AB, BC, omega))
        result |= {name: value, f"theta_{name}": theta}
        gradient[name] = slopes if with_speed else {p: slopes[p] for p in LENGTHS}
    return {**result, "gradient": gradient, "status": status}


def _turned(turn: NDArray[np.int_], ahead: Known, behind: Known) -> Known:
    """`ahead` where the crank turns forwards, `behind` where it turns backwards."""
    slopes = (np.where(turn > 0, a, b) for a, b in zip(ahead.slopes, behind.slopes, strict=True))
    return Known(np.where(turn > 0, ahead.value, behind.value), tuple(slopes))


def _rod_places(ec: Array, AB: Array, stuck: NDArray[np.bool_]) -> dict[str, Array]:
    """Crank angles of the largest and the smallest inclination of the rod."""
    steep = np.where(ec < 0.0, -np.pi / 2, np.pi / 2)
    with np.errstate(invalid="ignore"):
        flat = np.where(np.abs(ec) <= AB, -np.arctan2(ec, np.sqrt(AB - ec) * np.sqrt(AB + ec)), -steep)
    return {
        "theta_max_pressure_angle": np.where(stuck, np.nan, steep),
        "theta_min_pressure_angle": np.where(stuck, np.nan, flat),
    }


def _velocities(
    known: dict[str, Known], side: int, branch: int, turns: NDArray[np.bool_], inputs: tuple[Array, ...]
) -> tuple[Array, Array, dict[str, Array]]:
    """The largest |V_C| while the slider moves to this side of Y: values, crank angles, derivatives."""
    *lengths, omega = (a[turns] for a in inputs)
    here: dict[str, Any] = {**dict(zip(LENGTHS, lengths, strict=True)), "branch": branch}
    value, theta = np.full(turns.shape, np.nan), np.full(turns.shape, np.nan)
    slopes = {p: np.full(turns.shape, np.nan) for p in (*LENGTHS, "omega0")}
    if not omega.size:
        return value, theta, slopes
    forth, back = (stroke_ends(known, way, branch) for way in (side, -side))
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
