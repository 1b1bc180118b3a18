"""Crank angles of slider positions and of dead centres: the nodes of a load over Y."""

from collections.abc import Iterable, Mapping, Sequence
from math import gcd
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .load import TURN, Load, OverTheta, OverY, TableOverTheta

Array = NDArray[np.float64]


def passages(Y: Sequence[float], lengths: Sequence[Array], branch: int) -> Array:
    """Both crank angles [rad] at each position, NaN where there is none: shape (designs, 2 positions).

    lengths  ec, AB, BC, a value for each design

    The triangle A B C has the sides AB, BC and L = |AC|; tan(beta/2) of its angle at A keeps its digits where
    the triangle is flat.
    """
    ec, AB, BC = (np.asarray(side, float)[:, None] for side in lengths)
    position = np.asarray(Y, float)[None, :]
    with np.errstate(invalid="ignore", divide="ignore"):
        L = np.hypot(ec, position)
        above = (BC - (L - AB)) * (BC + (L - AB))
        below = ((L + AB) - BC) * ((L + AB) + BC)
        beta = 2.0 * np.arctan2(np.sqrt(above), np.sqrt(below))
        found = [np.arctan2(-ec, position) + side * beta for side in (-1.0, 1.0)]
        return np.concatenate(
            [np.where((position - AB * np.cos(t)) * branch >= 0.0, t, np.nan) for t in found], axis=1
        )


def dead_centres(lengths: Sequence[Array]) -> Array:
    """The angles [rad] of the dead centres of each design, on either branch; NaN where there is none."""
    ec, AB, BC = lengths
    with np.errstate(invalid="ignore", divide="ignore"):
        sines = np.stack([-ec / (AB + BC), ec / (BC - AB)], axis=-1)
        first = np.arcsin(sines)
    return np.concatenate([first, np.pi - first], axis=-1)


def repeated(angles: Array, low: float, high: float) -> Array:
    """Repeat angles of one turn over a range; NaN outside of it."""
    turns: Any = 2.0 * np.pi * np.arange(np.floor(low / (2.0 * np.pi)) - 1, np.ceil(high / (2.0 * np.pi)) + 2)
    every: Array = (angles[..., None] + turns).reshape(*angles.shape[:-1], -1)
    return np.where((every >= low) & (every <= high), every, np.nan)


def kinks_between(
    loads: Iterable[Load],
    low: float,
    high: float,
    lengths: Sequence[float],
    branch: int,
    smooth: bool = False,
) -> list[float]:
    """The kinks of one design's loads in a range of angles; with `smooth` also where smooth pieces meet.

    lengths  ec, AB, BC
    """
    found: list[float] = []
    sides = [np.array([length]) for length in lengths]
    for load in loads:
        if isinstance(load, OverTheta):
            found += load.nodes(low, high, smooth)
        elif isinstance(load, OverY):
            angles = np.append(passages(load.positions(smooth), sides, branch), dead_centres(sides))
            every = repeated(angles[None, :], low, high)
            found += every[np.isfinite(every)].tolist()
    return sorted(set(found))


def turns_of(caller: str, loads: Mapping[str, Load], most: int) -> int:
    """After how many turns the loads repeat; ValueError for more than `most`."""
    turns = 1
    for name, load in loads.items():
        if not isinstance(load, OverTheta):
            continue
        own = next((n for n in range(1, most + 1) if _repeats(load, n * TURN)), None)
        if own is None:
            raise ValueError(
                f"{name}: {caller} is over {'a turn' if most == 1 else f'at most {most} turns'}, after which "
                f"the load must repeat; its period is {load.period:.6g} rad"
            )
        turns = turns * own // gcd(turns, own)
    return turns


def _repeats(load: OverTheta, angle: float) -> bool:
    """True where a table repeats after an angle; a function is taken to."""
    periods = angle / load.period
    return not isinstance(load, TableOverTheta) or abs(periods - round(periods)) < 1e-9


def meeting_angles(loads: Iterable[Load], high: float, lengths: Sequence[Array], branch: int) -> Array:
    """For each design the angles from 0 to `high` at which pieces of loads meet, NaN in empty places.

    One row for all designs where no load is over the slider's position.
    """
    found = [np.empty((1, 0))]
    for load in loads:
        if isinstance(load, OverTheta):
            found.append(np.array([load.nodes(0.0, high, smooth=True)]))
        elif isinstance(load, OverY):
            angles = np.concatenate(
                [passages(load.positions(smooth=True), lengths, branch), dead_centres(lengths)], axis=-1
            )
            found.append(repeated(angles, 0.0, high))
    size = max(part.shape[0] for part in found)
    return np.concatenate([np.broadcast_to(part, (size, part.shape[1])) for part in found], axis=1)
