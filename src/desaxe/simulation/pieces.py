"""The pieces of loads for compiled loops: rows of where they start, and their numbers for both ways.

The numbers are those of `loops.state.piece`. Over the slider's position pieces lie between the crank angles
at which they meet.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..loads.angles import crossings, zero_of
from ..loads.load import OverY, TableOverTheta
from ..loads.motors import OverOmega
from ..mechanism.closed import TURN
from ..mechanism.closed.angles import dead_centres
from .loops.state import OVER_OMEGA, OVER_THETA, OVER_Y, SLOTS

Array = NDArray[np.float64]


class Sheet(NamedTuple):
    """Pieces: rows of angle or speed, and both lists of numbers; for each design, or one for all.

    period   0: they are over the speed
    """

    period: float
    rows: Array


def table_sheet(load: TableOverTheta | OverOmega) -> Sheet:
    """The pieces of a table over angle or speed."""
    table, over_angle = load.table, isinstance(load, TableOverTheta)
    starts = table.knots if over_angle else (-np.inf, *table.knots)
    rows = table.rows[1:] if over_angle else table.rows
    kind, first = (OVER_THETA, 1) if over_angle else (OVER_OMEGA, 0)
    numbers = [(kind, table.origin(k), *row, 0.0) for k, row in enumerate(rows, first)]
    return _sheet(load.period if isinstance(load, TableOverTheta) else 0.0, np.array([starts]), numbers, numbers)


def meeting_angles(load: OverY, lengths: Sequence[Array], branch: int) -> Array:
    """The angles at a table's positions, and the dead centres where another table holds behind them."""
    angles = crossings(load, load.positions(smooth=True), lengths, branch)
    if load.inward is not None:
        angles = np.concatenate([angles, dead_centres(lengths)], axis=1)
    return angles


def sheet_over_Y(
    load: OverY, lengths: Sequence[Array], branch: int, arc: Array, slider: Callable[[Array], Any]
) -> Sheet:
    """The pieces of a table over the slider's position.

    arc      of each design: both limit angles, or infinite
    slider   Y and Y_wrt_theta at angles of each design
    """
    angles = meeting_angles(load, lengths, branch)
    least = np.nanmin(np.column_stack([angles, np.full(len(angles), TURN)]), axis=1)
    bounded = np.isfinite(arc[:, :1])
    start = np.where(bounded, arc[:, :1], least[:, None])
    edges = np.hstack([start + (angles - start) % TURN, np.where(bounded, arc[:, 1:], start)])
    edges = np.sort(np.hstack([start, np.where(np.isnan(edges), start, edges)]), axis=1)
    middle = 0.5 * (edges + np.hstack([edges[:, 1:], start + TURN]))
    Y, slope = slider(middle)
    zero = zero_of(load, lengths, branch)[:, None]
    side = np.copysign(1.0, Y - zero) if load.centre else np.ones(Y.shape)
    known = np.array([(table.origin(k), *row) for table in load.tables for k, row in enumerate(table.rows)])
    ways = []
    for way in (1.0, -1.0):
        rows = known[np.asarray(load.piece(load.along({"Y": Y, load.centre: zero}), slope * way))]
        origin = (side * zero + rows[..., 0])[..., None]
        kind = np.full(origin.shape, OVER_Y)
        ways.append(np.concatenate([kind, origin, rows[..., 1:], side[..., None]], axis=-1))
    return _sheet(TURN, edges, *ways)


def _sheet(period: float, starts: Array, forth: Any, back: Any) -> Sheet:
    rows = np.empty((*starts.shape, 1 + 2 * SLOTS))
    rows[..., 0], rows[..., 1 : 1 + SLOTS], rows[..., 1 + SLOTS :] = starts, forth, back
    return Sheet(period, rows)
