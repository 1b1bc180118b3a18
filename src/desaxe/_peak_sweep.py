"""Where `peak` looks: the crank angles of a sweep, for designs of any kind.

The sweep is graded towards the quarters, the limit angles and, with friction, the dead centres, down
to the distance of two doubles.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._evaluate import evaluate
from ._feasibility import theta_intervals

Array = NDArray[np.float64]

UNIFORM = 240  # nodes per turn
GRADED = 2.0 ** -np.arange(1.0, 46.0)  # distances from a quarter or a limit angle, down to 3e-14


class Designs(NamedTuple):
    """Flat arrays of the inputs of every design, what is fixed for all, and the range of theta."""

    columns: dict[str, Array]
    branch: int
    accuracy: str
    theta: tuple[float, float]
    parameters: tuple[str, ...]

    @property
    def rubs(self) -> bool:
        """Whether friction has a say."""
        return "mu" in self.parameters

    def at(self, rows: NDArray[np.intp], theta: Array) -> dict[str, Any]:
        """The inputs of the designs `rows`, one angle each."""
        inputs = {name: column[rows] for name, column in self.columns.items()}
        return {"theta": theta, "branch": self.branch, "accuracy": self.accuracy, **inputs}


def values_at(
    names: tuple[str, ...], designs: Designs, rows: NDArray[np.intp], theta: Array
) -> dict[str, Any]:
    """The values of names by their name, for the designs `rows` at one angle each."""
    found: dict[str, Any] = evaluate(list(names), **designs.at(rows, theta))
    return found


def sweep(designs: Designs) -> tuple[Array, list[tuple[int, float]]]:
    """Crank angles to sweep for each design, ascending, and its limit angles inside the range."""
    low, high = designs.theta
    turns = max(1.0, (high - low) / (2.0 * np.pi))
    marks = [low, high]
    marks += [
        np.pi * (0.5 + k) for k in range(int(np.floor(low / np.pi)) - 1, int(np.ceil(high / np.pi)) + 1)
    ]
    common = np.concatenate([np.linspace(low, high, int(UNIFORM * turns) + 1), *map(_around, marks)])
    limits = _limit_angles(designs)
    ends = [(row, angle) for row, angles in enumerate(limits) for angle in angles]
    if designs.rubs:
        limits = [[*some, *more] for some, more in zip(limits, _dead_centres(designs), strict=True)]
    width = max((len(angles) for angles in limits), default=0)
    own = np.full((len(limits), width * (2 * GRADED.size + 1)), low)
    for row, angles in enumerate(limits):
        near = np.concatenate([_around(angle) for angle in angles]) if angles else np.empty(0)
        own[row, : near.size] = near
    both = np.concatenate([np.broadcast_to(common, (len(limits), common.size)), own], axis=1)
    return np.sort(np.clip(both, low, high), axis=1), ends


def _around(angle: float) -> Array:
    return np.concatenate([angle - GRADED, [angle], angle + GRADED])


def _limit_angles(designs: Designs) -> list[list[float]]:
    """For each design the angles in the range at which it stops being feasible, or stalls."""
    low, high = designs.theta
    columns = designs.columns
    count = next(iter(columns.values())).size
    margins = np.zeros(count)
    lengths = [columns[n] for n in ("ec", "AB", "BC") if n in columns]
    if len(lengths) == 3:
        ec, AB, BC = lengths
        margins = BC - AB - np.abs(ec)
    found: list[list[float]] = [[] for _ in range(count)]
    for row in np.flatnonzero(margins < 0.0):
        for interval in theta_intervals(*(float(c[row]) for c in lengths)):
            for end in interval:
                first = end + 2.0 * np.pi * np.ceil((low - end) / (2.0 * np.pi))
                found[row] += list(np.arange(first, high + 1e-12, 2.0 * np.pi))
    if "alpha" in columns and "omega0" in columns:
        for row in np.flatnonzero(columns["alpha"] != 0.0):
            stop = float(-(columns["omega0"][row] ** 2) / (2.0 * columns["alpha"][row]))
            found[row] += [stop] if low < stop < high else []
    return found


def _dead_centres(designs: Designs) -> list[list[float]]:
    """For each design the angles in the range at which crank and rod are in line, on either branch."""
    low, high = designs.theta
    ec, AB, BC = (designs.columns[n] for n in ("ec", "AB", "BC"))
    with np.errstate(all="ignore"):
        sines = np.stack([-ec / (AB + BC), ec / (BC - AB)])
        angles = np.concatenate([np.arcsin(sines), np.pi - np.arcsin(sines)])
    turns = 2.0 * np.pi * np.arange(np.floor(low / (2.0 * np.pi)) - 1, np.ceil(high / (2.0 * np.pi)) + 1)
    every = (angles[:, None, :] + turns[None, :, None]).reshape(-1, ec.size)
    return [[float(a) for a in column if low <= a <= high] for column in every.T]
