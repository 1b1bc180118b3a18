"""The extreme value of a sum over sliders, its angle and its exact gradient."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ..design.turn.turn import NoCycleError
from ..mechanism.status import PeakStatus
from ..support.panels import Array, Panels, resolved
from .cycle import ShaftTurn

SIGNS = {"max": (1.0,), "min": (-1.0,), "absmax": (1.0, -1.0)}
Values = Callable[[Sequence[str], Array, Any], dict[str, Array]]
JUMP = 1e-9  # of the largest value: a change at one angle that is a jump


def extreme_of(turn: ShaftTurn, name: str, kind: str) -> dict[str, Any]:
    """Value, angle, side of a jump, gradient and status of one crankshaft."""
    by = turn.slopes_of(name)
    missing = {"value": np.nan, "theta": np.nan, "side": 0, "gradient": dict.fromkeys(by, np.nan)}
    if turn.margin < 0.0:
        return {**missing, "status": int(PeakStatus.CANNOT_BE_ASSEMBLED)}
    try:
        panels = turn.panels([name])
    except NoCycleError as error:
        return {**missing, "status": error.status}
    tops = [panels.extreme(panels.values[name], sign) for sign in SIGNS[kind]]
    top, theta, inside = max(tops, key=lambda one: abs(one[0]))
    side, slopes = 0, {}
    nothing = abs(top) <= turn.floor(name)
    if nothing:  # the sliders cancel, at every angle
        top, theta, inside = 0.0, turn.ends[0], True
    if inside:
        slopes = {n: values[0] for n, values in turn.values([*by.values()], np.array([theta])).items()}
        gradient = {p: slopes[n] for p, n in by.items()}
        if nothing:
            gradient = {p: s if abs(s) > turn.floor(by[p]) else 0.0 for p, s in gradient.items()}
    else:
        side, gradient = _at_edge(turn, name, panels, float(theta), top, by)
    sign = np.sign(top) if kind == "absmax" else 1.0
    value = abs(top) if kind == "absmax" else top
    return {
        "value": float(value), "theta": float(theta), "side": side,
        "gradient": {p: float(sign * slope) + 0.0 for p, slope in gradient.items()}, "status": 0,
    }  # fmt: skip


def extremes_of(
    turn_of: Callable[[int], ShaftTurn], values: Values, edges: Array, floor: Array, name: str, kind: str
) -> dict[str, Any]:
    """Values, angles, sides, gradients and status of many crankshafts at once, as arrays.

    turn_of  the turn of one of them, for extremes between panels and angles without a value
    values   quantities at angles of the crankshafts `row`
    edges    a row for each, NaN in empty places
    floor    the magnitude of each that is rounding
    """
    panels = resolved(lambda theta, row: values([name], theta, row), edges)
    row, nodes = np.arange(len(edges)), panels.values[name]
    known = np.asarray(np.isfinite(nodes).all((1, 2)))
    nodes = np.where(known[:, None, None], nodes, 0.0)
    tops = [panels.extreme(nodes, sign) for sign in SIGNS[kind]]
    which = np.argmax([np.abs(one[0]) for one in tops], axis=0)
    top, theta, inside = (np.array(part)[which, row] for part in zip(*tops, strict=True))
    by = turn_of(0).slopes_of(name)
    slopes = values([*by.values()], theta, row)
    sign = np.sign(top) if kind == "absmax" else np.ones(top.shape)
    found: dict[str, Any] = {
        "value": np.abs(top) if kind == "absmax" else top.copy(), "theta": theta.copy(),
        "side": np.zeros(row.size, np.int8), "status": np.zeros(row.size, np.int8),
    }  # fmt: skip
    gradient = {p: sign * slopes[n] for p, n in by.items()}
    for k in np.flatnonzero(~(known & inside & (np.abs(top) > floor))).tolist():
        one = extreme_of(turn_of(k), name, kind)
        for key, column in found.items():
            column[k] = one[key]
        for p, column in gradient.items():
            column[k] = one["gradient"][p]
    status = found.pop("status")
    return {**found, "gradient": gradient, "status": status}


def _at_edge(
    turn: ShaftTurn, name: str, panels: Panels, theta: float, top: float, by: dict[str, str]
) -> tuple[int, dict[str, Array]]:
    """The side and the derivatives of a value between two panels, which moves with their edge."""
    edge = int(np.argmin(np.abs(panels.edges - theta)))
    ends = panels.ends(panels.values[name])
    last = len(ends) - 1
    sides = [(panel, end) for panel, end in ((edge - 1, 1), (edge, 0)) if 0 <= panel <= last]
    panel, end = min(sides, key=lambda one: abs(ends[one] - top))
    jumps = len(sides) == 2 and abs(np.subtract(*(ends[one] for one in sides))) > JUMP * abs(top)
    along = f"{name}_wrt_theta"
    here = resolved(
        lambda x, row: turn.values([*by.values(), along], x, row), panels.edges[panel : panel + 2]
    )
    slopes = {n: here.ends(v)[-1 if end else 0, end] for n, v in here.values.items()}
    moves = turn.moves([name], np.array([theta]))
    shifts = {p: moves[p][0] if p in moves else 0.0 for p in by}
    return (2 * (1 - end) - 1 if jumps else 0), {
        p: slopes[n] + slopes[along] * shifts[p] for p, n in by.items()
    }
