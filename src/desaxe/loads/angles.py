"""Crank angles at which the pieces of loads meet."""

from collections.abc import Iterable, Mapping, Sequence
from math import gcd
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..mechanism.closed import TURN
from ..mechanism.closed.angles import dead_centres, passages, repeated
from ..mechanism.closed.dead_centres import DEAD_CENTRES
from ..mechanism.closed.functions import closed_form
from ..mechanism.messages import amount
from ..mechanism.names import sensitivity
from .along_motion import members_of
from .function import naming
from .load import Load, OverTheta, OverY
from .stroke import OverStroke

Array = NDArray[np.float64]
MOST_TURNS = 60  # of a cycle


def crossings(load: OverY, places: Sequence[float], lengths: Sequence[Array], branch: int) -> Array:
    """Both crank angles [rad] at each of the positions of a load's table, or at each of its distances."""
    if not isinstance(load, OverStroke):
        return passages(places, lengths, branch)
    distance = np.array([place for place in places if place > 0.0])
    _, AB, BC = lengths
    way = -branch if load.centre == "Y_outer" else branch
    # Past the inner one a long crank takes the slider both ways.
    ways = (way, -way) if load.centre == "Y_inner" and (AB > BC).any() else (way,)
    centre = zero_of(load, lengths, branch)[:, None]
    return passages(np.concatenate([centre + side * distance for side in ways], axis=1), lengths, branch)


def meeting_and_bent(load: OverY, lengths: Sequence[Array], branch: int) -> tuple[Array, Array]:
    """The crank angles [rad] in a turn at which pieces of a load meet; those where it is not smooth."""
    every, bent = load.positions(smooth=True), load.positions(smooth=False)
    result = crossings(load, every, lengths, branch)
    if bent == every:
        return result, result
    known = [place in bent for place in every if place > 0.0 or not load.centre]
    return result, result[:, np.resize(known, result.shape[1])]


def zero_of(load: Load, lengths: Sequence[Array], branch: int) -> Array:
    """The position [m] of each design from which a load measures positions; NaN where there is none."""
    if not load.centre:
        return np.zeros_like(lengths[0])
    (result,) = closed_form(DEAD_CENTRES, (load.centre,), branch=float(branch)).arrays(*lengths)
    return np.broadcast_to(result, lengths[0].shape)


def shift(kept: Sequence[str], parameter: str, known: Mapping[str, Any]) -> Any:
    """By how much a parameter moves the angle at which a quantity, or the difference of two, stays the same.

    known   their derivatives with respect to the parameter, 0 where missing, and that of the first by theta
    """
    slope, *centre = (known.get(sensitivity(name, parameter), 0.0) for name in kept)
    return -(slope - sum(centre)) / known[sensitivity(kept[0], "theta")]


def turns_of(caller: str, loads: Mapping[str, Load], most: int) -> int:
    """After how many turns the loads repeat; ValueError for more than `most`."""
    turns = 1
    for name, load in ((name, part) for name, whole in loads.items() for part in members_of([whole])):
        if not isinstance(load, OverTheta):
            continue
        own = next((n for n in range(1, most + 1) if _repeats(load, n * TURN)), None)
        with naming(name):
            periodic = load.is_periodic
        if own is None or not periodic:
            period = amount("theta", load.period, ".6g", says_unit=True)
            reason = "its period is " + period
            if not periodic:
                remedy = ": over_theta(function, period=...) sets its period"
                reason = "this function does not after " + period + remedy
            longest = "a turn" if most == 1 else f"at most {most} turns"
            rule = f"{name}: {caller} is over {longest}, after which the load must repeat; "
            raise ValueError(rule + reason)
        turns = turns * own // gcd(turns, own)
    return turns


def cycle(loads: Mapping[str, Load]) -> float:
    """The angle [rad] after which crank and loads repeat together; the longest period where they do not."""
    longest = max(
        [TURN, *(load.period for load in members_of(loads.values()) if isinstance(load, OverTheta))]
    )
    try:
        turns = TURN * turns_of("a cycle", loads, MOST_TURNS)
    except ValueError:
        return longest
    return longest if longest > turns * (1.0 + 1e-9) else turns


def _repeats(load: OverTheta, angle: float) -> bool:
    """True where an angle is a whole number of periods of a load."""
    periods = angle / load.period
    return round(periods) > 0 and abs(periods - round(periods)) < 1e-9


def meeting_angles(
    loads: Iterable[Load], high: float, lengths: Sequence[Array], branch: int, low: float = 0.0
) -> Array:
    """For each design the angles from `low` to `high` at which pieces of loads meet, NaN in empty places.

    One row for all designs where no load is over the slider's position.
    """
    result = [np.empty((1, 0))]
    for load in members_of(loads):
        if isinstance(load, OverTheta):
            result.append(np.array([load.nodes(low, high, smooth=True)]))
        elif isinstance(load, OverY):
            own = crossings(load, load.positions(smooth=True), lengths, branch)
            angles = np.concatenate([own, dead_centres(lengths)], axis=-1)
            result.append(repeated(angles, low, high))
    size = max(part.shape[0] for part in result)
    return np.concatenate([np.broadcast_to(part, (size, part.shape[1])) for part in result], axis=1)
