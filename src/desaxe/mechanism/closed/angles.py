"""Crank angles of slider positions, of dead centres and of limits, for arrays of designs."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..status import InverseStatus
from . import TURN
from .dead_centres import DEAD_CENTRES
from .functions import closed_form
from .inverse import INVERSE
from .limits import ANGLES, LIMITS

Array = NDArray[np.float64]
A_BIT = 2.0**-30  # turns: more than the rounded number of turns is off
ALL_TURN = 2.0**-12  # of BC: designs with more of it to spare have no limit angles


def passages(Y: Sequence[float] | Array, lengths: Sequence[Array], branch: int) -> Array:
    """Both crank angles [rad] at each position, NaN where there is none: shape (designs, 2 positions).

    Y        positions, the same for all designs or a row for each
    lengths  ec, AB, BC, a value for each design
    """
    sides = (np.asarray(side, float)[:, None] for side in lengths)
    angles = closed_form(INVERSE, branch=float(branch)).arrays(np.atleast_2d(np.asarray(Y, float)), *sides)
    first, last, status = np.broadcast_arrays(*angles)
    return np.concatenate([first, np.where(status == InverseStatus.DEAD_CENTRE, first, last)], axis=1)


def dead_centres(lengths: Sequence[Array]) -> Array:
    """The angles [rad] of the dead centres of each design, on either branch; NaN where there is none."""
    outer, inner = closed_form(DEAD_CENTRES, ("outer_turn", "inner_turn")).arrays(*lengths)
    first = np.stack([outer, -inner], axis=-1)
    return np.concatenate([first, np.pi - first], axis=-1)


def limit_angles(lengths: Sequence[Array]) -> Array:
    """The angles [rad] between which designs can be assembled, NaN in empty places; none if all turn."""
    ec, AB, BC = lengths
    if (BC - AB - np.abs(ec) > ALL_TURN * BC).all():
        return np.empty((ec.size, 0))
    return np.stack(np.broadcast_arrays(*closed_form(LIMITS, ANGLES).arrays(ec, AB, BC)), axis=-1)


def repeated(angles: Array, low: float, high: float) -> Array:
    """Repeat angles of one turn over a range; NaN outside of it."""
    turns, count = np.ceil((low - angles) / TURN - A_BIT), int(np.floor((high - low) / TURN + A_BIT)) + 1
    if count > 1 and not (angles + TURN * (turns + (count - 1.0)) <= high).any():
        count -= 1
    every = angles[..., None] + TURN * (turns[..., None] + np.arange(float(count)))
    every = every.reshape(*angles.shape[:-1], angles.shape[-1] * count)
    return np.where((every >= low) & (every <= high), every, np.nan)
