"""`feasibility` for arrays of designs, in NumPy."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...mechanism.closed.functions import closed_form
from ...mechanism.closed.limits import CHANGE_POINT_ULPS, LIMITS
from ...mechanism.inputs import LEAST

Array = NDArray[np.float64]
KINDS = ("crank", "change point", "rocker", "none", "bad input")


def only_good(ec: Array, AB: Array, BC: Array) -> tuple[NDArray[np.bool_], list[Array]]:
    """Mask of the designs with a bad length; the lengths in their broadcast shape, NaN for those."""
    ec, AB, BC = np.broadcast_arrays(ec, AB, BC)
    good = np.isfinite(ec) & np.isfinite(AB) & np.isfinite(BC) & (LEAST["AB"] <= AB) & (LEAST["BC"] <= BC)
    return ~good, [np.where(good, length, np.nan) for length in (ec, AB, BC)]


def of_arrays(ec: Array, AB: Array, BC: Array) -> dict[str, Any]:
    """The results of `feasibility` in the broadcast shape."""
    bad, (ec, AB, BC) = only_good(ec, AB, BC)
    *angles, status, margin, link_margin = closed_form(LIMITS).arrays(ec, AB, BC)
    intervals = np.stack(np.broadcast_arrays(*angles), axis=-1).reshape(*bad.shape, 2, 2)
    near = np.abs(margin) <= CHANGE_POINT_ULPS * np.spacing(BC)
    turns, some = margin >= 0.0, np.isfinite(angles[0])
    one = np.where(bad, np.nan, 1.0)
    return {
        "margin": margin,
        "gradient": {"ec": -np.sign(ec) * one, "AB": -one, "BC": one},
        "can_turn": turns,
        "theta_intervals": intervals,
        "kind": np.array(KINDS)[np.select([bad, near, turns, some], [4, 1, 0, 2], 3)],
        "grashof": link_margin >= 0.0,
        "status": np.where(bad, 4, status).astype(np.int8),
    }
