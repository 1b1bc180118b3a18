"""The pieces of the motion of one design, and when it passes angles and stands still."""

from typing import NamedTuple

import numpy as np
from numpy.polynomial.legendre import legval, legvander
from numpy.typing import NDArray

from ...mechanism.closed import TURN
from ...support.panels import NODES
from ..result import FAILED
from .many import FollowedMotions, follow_many
from .panels import Designs

Array = NDArray[np.float64]
Rows = NDArray[np.intp]
COLUMNS = 27  # of a piece, with the part of its panel: see `follow`
ROOM, MORE_ROOM, FULL = (
    512,
    8,
    12,
)  # pieces, at first those of a brief motion; status: no room
START, DURATION, C0, C1, C2, KIND, WAY, SERIES, SPAN, OVER = 0, 1, 2, 3, 4, 5, 7, slice(8, 24), 25, 26
_SHARES = 1.0 / (2.0 * np.arange(1, NODES) + 1.0)


class Places(NamedTuple):
    """Places of a motion: pieces, instants, angles and speeds."""

    row: Rows
    t: Array
    theta: Array
    omega: Array


class Path(NamedTuple):
    """A motion in pieces, rows of `kept` of `follow`, and how it ends: status and instant."""

    designs: Designs
    pieces: Array
    status: int
    t: float

    @property
    def bounds(self) -> Array:
        """The angle at the start and at the end of each piece."""
        end = self._x(np.arange(len(self.pieces)), self._ends())
        theta, _ = self.designs.place(end[None])
        return np.concatenate([self.designs.theta0, theta[0]])

    def passages(self, angle: float, every: bool, bounds: Array) -> Places:
        """All passages of an angle, or of it and all that are whole turns away; not the start of a piece."""
        begin, end = bounds[:-1], bounds[1:]
        low, high = np.minimum(begin, end), np.maximum(begin, end)
        # A piece is shorter than half a turn.
        theta = angle + TURN * np.round((0.5 * (low + high) - angle) / TURN) * every
        row = np.flatnonzero((low <= theta) & (theta <= high) & (theta != begin))
        swing = np.cumsum(np.diff(self.pieces[:, WAY], prepend=0.0) != 0.0)[row]
        # The ends of pieces are rounded: within a swing an angle is passed once.
        row = row[(np.diff(theta[row], prepend=np.nan) != 0.0) | (np.diff(swing, prepend=0) != 0)]
        return self._at(row, self._u(row, self.designs.coordinates(theta[None, row])[0]), theta[row])

    def standstills(self) -> Places:
        """All standstills at which the crank turns round."""
        row = np.flatnonzero((self.pieces[:, KIND] == 2.0) & (self.pieces[:, OVER] == 0.0))
        at = np.ones(row.size)
        theta, _ = self.designs.place(self._x(row, at)[None])
        return self._at(row, at, theta[0])

    def at_end(self) -> tuple[float, float]:
        """The coordinate at the end of the last piece, and its rate."""
        if not len(self.pieces):
            start = self.designs
            x = start.coordinates(start.theta0)
            return x.item(), (start.omega_start / start.place(x[None])[1]).item()
        row, u = np.array([len(self.pieces) - 1]), self._ends()[-1:]
        return self._x(row, u).item(), self._rate(row, u).item()

    def _ends(self) -> Array:
        """u where each piece is left: before its end if the crank would rest there, beyond the panel."""
        leaves = (self.pieces[:, KIND] == 2.0) & (self.pieces[:, OVER] != 0.0)
        share = np.where(leaves, self.pieces[:, OVER] / self.pieces[:, SPAN], 0.0)
        return np.asarray(1.0 - 2.0 * np.sqrt(share))

    def _x(self, row: Rows, u: Array) -> Array:
        own = self.pieces[row]
        return np.asarray(own[:, C0] + u * (own[:, C1] + u * own[:, C2]))

    def _u(self, row: Rows, x: Array) -> Array:
        """The inverse of `_x`: at one end of a piece with a standstill both have the same sign of it."""
        own = self.pieces[row]
        side = np.where(own[:, KIND] == 1.0, -1.0, 1.0)
        away = x - (own[:, C0] + side * own[:, C1] + own[:, C2])
        with np.errstate(divide="ignore", invalid="ignore"):
            bent = side * (1.0 - np.sqrt(np.maximum(away / own[:, C2], 0.0)))
            u = np.where(own[:, KIND] == 0.0, (x - own[:, C0]) / own[:, C1], bent)
        return np.clip(u, -1.0, 1.0)

    def _rate(self, row: Rows, u: Array) -> Array:
        """The rate of the coordinate."""
        own = self.pieces[row]
        return np.asarray((own[:, C1] + 2.0 * u * own[:, C2]) / legval(u, own[:, SERIES].T, tensor=False))

    def _at(self, row: Rows, u: Array, theta: Array) -> Places:
        """The places of pieces at coordinates of theirs."""
        basis = legvander(u, NODES)
        gone = np.concatenate([u[:, None] + 1.0, (basis[:, 2:] - basis[:, :-2]) * _SHARES], axis=1)
        t = self.pieces[row, START] + (gone * self.pieces[row, SERIES]).sum(axis=1)
        _, slope = self.designs.place(self._x(row, u)[None])
        return Places(row, t, theta, self._rate(row, u) * np.ravel(slope))


def path_of(designs: Designs, times: Array, rtol: float, most: Array) -> tuple[Path, FollowedMotions]:
    """The motion up to the last instant, or to what comes before it; most: as for `follow_many`."""
    room, largest = ROOM, int(most[0]) + 1
    while True:
        kept = np.empty((min(room, largest), COLUMNS))
        found = follow_many(designs, times, rtol, most, kept)
        if found.status[0] != FULL:
            break
        if not most[0]:  # stopped before there was more room
            kept = kept[: np.flatnonzero(kept[:, KIND] == 0.0)[-1] + 1]
            return Path(designs, kept, FAILED, float(kept[-1, START] + kept[-1, DURATION])), found
        room *= MORE_ROOM
    pieces = kept[: int(np.isfinite(kept[:, START]).sum())]
    return Path(designs, pieces, int(found.status[0]), float(found.numbers[0, 0])), found
