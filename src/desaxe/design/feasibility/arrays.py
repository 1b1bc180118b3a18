"""`feasibility` for arrays of designs, in NumPy."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...mechanism.limit_angles import CHANGE_POINT_ULPS
from ..number_or_array import sum_of_three

Array = NDArray[np.float64]
KINDS = ("crank", "change point", "rocker", "none", "bad input")


def of_arrays(ec: Array, AB: Array, BC: Array) -> dict[str, Any]:
    """The results of `feasibility` in the broadcast shape."""
    ec, AB, BC = np.broadcast_arrays(ec, AB, BC)
    bad = ~(np.isfinite(ec) & np.isfinite(AB) & np.isfinite(BC) & (AB >= 0.0) & (BC > 0.0))
    ec, AB, BC = (np.where(bad, np.nan, a) for a in (ec, AB, BC))
    margin = sum_of_three(BC, -AB, -np.abs(ec))
    intervals = _intervals(ec, AB, BC)
    with np.errstate(invalid="ignore"):
        near = np.abs(margin) <= CHANGE_POINT_ULPS * np.spacing(BC)
        turns = margin >= 0.0
        grashof = sum_of_three(np.maximum(AB, BC), -np.minimum(AB, BC), -np.abs(ec)) >= 0.0
    some = np.isfinite(intervals[..., 0, 0])
    status = np.select([bad, margin == 0.0, turns], [4, 2, 0], 1).astype(np.int8)
    one = np.where(bad, np.nan, 1.0)
    return {
        "margin": margin,
        "gradient": {"ec": -np.sign(ec) * one, "AB": -one, "BC": one},
        "can_turn": turns,
        "theta_intervals": intervals,
        "kind": np.array(KINDS)[np.select([bad, near, turns, some], [4, 1, 0, 2], 3)],
        "grashof": grashof,
        "status": status,
    }


def _intervals(ec: Array, AB: Array, BC: Array) -> Array:
    """Two intervals (first, last) a design, NaN where absent; see `limit_angles.theta_intervals`."""
    upper, lower = sum_of_three(BC, -AB, -ec), sum_of_three(BC, -AB, ec)
    over, under = sum_of_three(BC, AB, -ec), sum_of_three(BC, AB, ec)
    with np.errstate(invalid="ignore", divide="ignore"):
        top, bottom = _gap(upper, over, AB), _gap(lower, under, AB)
        free = np.minimum(upper, lower) >= 0.0
        none = (AB == 0.0) | ~(np.minimum(over, under) >= 0.0)
    quarter, turn = np.pi / 2, 2.0 * np.pi
    ahead = np.stack([np.stack([quarter + top, 2.5 * np.pi - top], -1), np.full((*top.shape, 2), np.nan)], -2)
    wraps = bottom < quarter
    first = np.where(wraps, 1.5 * np.pi + bottom, bottom - quarter)
    behind = ahead.copy()
    behind[..., 0, :] = np.stack([first, np.where(wraps, 3.5 * np.pi - bottom, 1.5 * np.pi - bottom)], -1)
    both = np.stack(
        [
            np.stack([quarter + top, 1.5 * np.pi - bottom], -1),
            np.stack([1.5 * np.pi + bottom, 2.5 * np.pi - top], -1),
        ],
        -2,
    )
    whole = np.full((*top.shape, 2, 2), np.nan)
    whole[..., 0, :] = 0.0, turn
    cases = [free, none, bottom == 0.0, top == 0.0]
    found = [whole, np.full_like(whole, np.nan), ahead, behind]
    return np.select([case[..., None, None] for case in cases], found, both)


def _gap(margin: Array, rest: Array, AB: Array) -> Array:
    """Smallest angle between crank and quarter turn, of arrays; see `limit_angles._gap`."""
    narrow = 2.0 * np.arcsin(np.sqrt(np.maximum(-margin, 0.0) / (2.0 * AB)))
    wide = np.pi - 2.0 * np.arcsin(np.sqrt(rest / (2.0 * AB)))
    return np.where(-margin < AB, narrow, wide)
