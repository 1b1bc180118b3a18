"""The extreme values of a sum over sliders, their angles and exact gradients."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ..support.panels import Array, Panels, resolved
from .cycle import ShaftTurn

SIGNS = {"max": (1.0,), "min": (-1.0,), "absmax": (1.0, -1.0)}
Values = Callable[[Sequence[str], Array, Any], dict[str, Array]]
Floor = Callable[[str, Array], Array]
JUMP = 1e-9  # of the largest value: a change at one angle that is a jump
BESIDE = 1e-13  # of 1 + theta: on one side of an edge, for derivatives


def extremes_of(
    turn_of: Callable[[int], ShaftTurn], values: Values, edges: Array, floor: Floor, name: str, kind: str
) -> dict[str, Any]:
    """Values, angles, sides of a jump, gradients and status of crankshafts, as arrays.

    turn_of  the turn of one of them, for extremes between panels and sums that cancel
    values   quantities at angles of the crankshafts `row`
    edges    a row for each, NaN in empty places
    floor    the magnitude that is rounding in a sum of each over angles, the last axis
    """
    panels = resolved(lambda theta, row: values([name], theta, row), edges)
    row, nodes = np.arange(len(edges)), panels.values[name]
    known = np.asarray(np.isfinite(nodes).all((1, 2)))
    nodes = np.where(known[:, None, None], nodes, 0.0)
    tops = [panels.extreme(nodes, sign) for sign in SIGNS[kind]]
    which = np.argmax([np.abs(one[0]) for one in tops], axis=0)
    top, theta, inside = (np.array(part)[which, row] for part in zip(*tops, strict=True))
    nothing = known & (np.abs(top) <= floor(name, turn_of(0).samples))  # the sliders cancel, at every angle
    top, theta = (np.where(nothing, least, part) for part, least in ((top, 0.0), (theta, panels.edges[:, 0])))
    by = turn_of(0).slopes_of(name)
    slopes = {n: np.array(slope) for n, slope in values([*by.values()], theta, row).items()}
    side, status = np.zeros(row.size, np.int8), np.zeros(row.size, np.int8)
    for k in np.flatnonzero(~known | nothing | ~inside).tolist():
        if not known[k]:
            top[k] = theta[k] = np.nan
            status[k] = values(["status"], panels.x[k].ravel(), k)["status"].max()
            own = dict.fromkeys(slopes, np.nan)
        elif nothing[k]:
            own = {n: s[k] if abs(s[k]) > turn_of(k).floor(n) else 0.0 for n, s in slopes.items()}
        else:
            shaft = Panels(panels.edges[k], {name: nodes[k]})
            side[k], own = _at_edge(turn_of(k), name, shaft, theta[k], top[k], by)
        for n, slope in own.items():
            slopes[n][k] = slope
    there = np.nan_to_num(theta)[:, None]
    slopes = {n: np.where(np.abs(slope) <= floor(n, there), 0.0, slope) for n, slope in slopes.items()}
    sign = np.sign(top) if kind == "absmax" else 1.0
    gradient = {p: sign * slopes[n] + 0.0 for p, n in by.items()}
    value = np.abs(top) if kind == "absmax" else top
    return {"value": value, "theta": theta, "side": side, "gradient": gradient, "status": status}


def _at_edge(
    turn: ShaftTurn, name: str, panels: Panels, theta: float, top: float, by: dict[str, str]
) -> tuple[int, dict[str, Any]]:
    """The side and the derivatives of a value between two panels, which moves with their edge."""
    edge = int(np.argmin(np.abs(panels.edges - theta)))
    ends = panels.ends(panels.values[name])
    last = len(ends) - 1
    sides = [(panel, end) for panel, end in ((edge - 1, 1), (edge, 0)) if 0 <= panel <= last]
    panel, end = min(sides, key=lambda one: abs(ends[one] - top))
    jumps = len(sides) == 2 and abs(np.subtract(*(ends[one] for one in sides))) > JUMP * abs(top)
    along = f"{name}_wrt_theta"
    inside = min(BESIDE * (1.0 + abs(theta)), 0.5 * float(np.diff(panels.edges)[panel]))
    beside = np.array([theta + (1 - 2 * end) * inside])
    slopes = {n: v[0] for n, v in turn.values([*by.values(), along], beside).items()}
    moves = turn.moves([name], np.array([theta]))
    own = {n: slopes[n] + slopes[along] * moves[p][0] if p in moves else slopes[n] for p, n in by.items()}
    return (2 * (1 - end) - 1 if jumps else 0), own
