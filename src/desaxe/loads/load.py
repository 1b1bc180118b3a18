"""Loads that vary with the motion: over the crank angle, or over the slider's position.

Such a load is a callable: over theta a function of the angle [rad], over Y one of the position [m] and the
way the slider goes. It stands wherever F_X or F_Y does, compares by its content, and can be pickled.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from hashlib import sha256
from math import ceil, floor, inf, isfinite, nextafter, pi
from typing import Any

from ..support.forks import IMPORTS
from .table import Table

TURN = 2.0 * pi
SAMPLES = 1024  # of a function, by which it is distinguished from others


class LoadWarning(UserWarning):
    """A load that may be a mistake, such as an array of designs that looks like a load over theta."""


class Load(ABC):
    """Base class of loads; `unit` is that of the values, None for plain SI numbers."""

    over = "theta"
    parameters: tuple[str, ...] = ("theta",)  # that the load depends on
    unit: str | None = None

    @property
    def has_slope(self) -> bool:
        """True where the derivative of the load is known."""
        return True

    @property
    def identity(self) -> str:
        """A digest of all that the load is: that of a function is of its values over a period."""
        return sha256(self._content().encode()).hexdigest()

    @abstractmethod
    def _content(self) -> str:
        """The definition of the load as a text."""


class OverTheta(Load):
    """A load over the crank angle."""

    @property
    @abstractmethod
    def period(self) -> float:
        """The angle after which the load, or the nodes of a function, repeat [rad]."""

    def __call__(self, theta: Any) -> Any:
        """The load at crank angles [rad]: a number or an array."""
        return self.both(_plain(theta))[0]

    @abstractmethod
    def both(self, theta: Any) -> tuple[Any, Any]:
        """The load and its derivative, None where that is not known."""

    @abstractmethod
    def nodes(self, low: float, high: float, smooth: bool) -> list[float]:
        """The angles in a range at which the load is not smooth; with `smooth`, where its pieces meet too."""

    def _repeated(self, angles: tuple[float, ...], low: float, high: float) -> list[float]:
        """Angles of one period in all periods that a range touches."""
        period = self.period
        shifts = [
            range(ceil((low - angle) / period) - 1, floor((high - angle) / period) + 2) for angle in angles
        ]
        return [
            angle + k * period if k else angle
            for angle, turns in zip(angles, shifts, strict=True)
            for k in turns
        ]


@dataclass(frozen=True)
class TableOverTheta(OverTheta):
    """A table over the crank angle, which repeats after its period."""

    table: Table
    kind: str
    unit: str | None = None

    @property
    def period(self) -> float:
        """The angle after which the load repeats [rad]."""
        return self.table.period or TURN

    def both(self, theta: Any) -> tuple[Any, Any]:
        """The load and its derivative."""
        return self.table.both(theta)

    def nodes(self, low: float, high: float, smooth: bool) -> list[float]:
        """The angles at which pieces meet, each rounded up into the piece to its right."""
        angles = self.table.knots if smooth else self.table.kinks
        found = [self._first_right(angle) for angle in self._repeated(angles, low, high)]
        return sorted(angle for angle in found if low <= angle <= high)

    def _first_right(self, angle: float) -> float:
        """The smallest double that belongs to the piece right of an angle: whole periods are rounded."""
        here = self.table.piece(self.table.reduced(angle + 1e-9))
        while self.table.piece(self.table.reduced(angle)) != here:
            angle = nextafter(angle, inf)
        while self.table.piece(self.table.reduced(before := nextafter(angle, -inf))) == here:
            angle = before
        return angle

    def _content(self) -> str:
        return f"{self.table!r}"

    def __repr__(self) -> str:
        return f"<load over theta: {_described(self.table, self.kind, self.unit)}>"


@dataclass(frozen=True)
class FunctionOverTheta(OverTheta):
    """A user's function of the crank angle, which is called with the angle as it is."""

    function: Callable[[Any], Any]
    derivative: Callable[[Any], Any] | None = None
    angles: tuple[float, ...] = ()  # nodes
    every: float = TURN  # the angle after which the nodes repeat

    @property
    def period(self) -> float:
        """The angle after which the nodes repeat [rad]."""
        return self.every

    @property
    def has_slope(self) -> bool:
        """True where the derivative was given."""
        return self.derivative is not None

    def both(self, theta: Any) -> tuple[Any, Any]:
        """The load and, where it is known, its derivative."""
        slope = None if self.derivative is None else called(self.derivative, theta, "the load's derivative")
        return called(self.function, theta, "the load"), slope

    def nodes(self, low: float, high: float, smooth: bool) -> list[float]:
        """The nodes in a range."""
        return sorted(a for a in self._repeated(self.angles, low, high) if low <= a <= high)

    def _content(self) -> str:
        angles = [self.every * k / SAMPLES for k in range(SAMPLES)]
        return f"{[self(angle) for angle in angles]} {self.angles} {self.every}"

    def __repr__(self) -> str:
        name = getattr(self.function, "__name__", type(self.function).__name__)
        return f"<load over theta: the function {name}>"


@dataclass(frozen=True)
class OverY(Load):
    """A load over the slider's position, one table for each way it goes."""

    outward: Table  # where Y increases with time
    inward: Table | None
    kind: str
    unit: str | None = None

    over = "Y"
    parameters = ("theta", "ec", "AB", "BC")

    def __call__(self, Y: Any, way: Any = 1.0) -> Any:
        """The load at positions [m] of a slider that goes outward, or inward where `way` is negative."""
        return self.both(_plain(Y), _plain(way))[0]

    def both(self, Y: Any, way: Any) -> tuple[Any, Any]:
        """The load and its derivative by Y."""
        if self.inward is None:
            return self.outward.both(Y)
        if isinstance(Y, float) and isinstance(way, float):
            return (self.inward if way < 0.0 else self.outward).both(Y)
        with IMPORTS:
            import numpy as np

        inward = np.less(way, 0.0)
        pairs = zip(self.inward.both(np.asarray(Y)), self.outward.both(np.asarray(Y)), strict=True)
        value, slope = (np.where(inward, back, forth) for back, forth in pairs)
        return value, slope

    @property
    def jumps(self) -> list[float]:
        """The positions at which the load jumps."""
        tables = [table for table in (self.outward, self.inward) if table is not None]
        return sorted({x for table in tables for x in table.jumps})

    def positions(self, smooth: bool) -> list[float]:
        """The positions at which the load is not smooth; with `smooth`, at which its pieces meet too."""
        tables = [table for table in (self.outward, self.inward) if table is not None]
        return sorted({x for table in tables for x in (table.knots if smooth else table.kinks)})

    def _content(self) -> str:
        return f"{self.outward!r} {self.inward!r}"

    def __repr__(self) -> str:
        ways = "" if self.inward is None else ", another one inward"
        return f"<load over Y: {_described(self.outward, self.kind, self.unit)}{ways}>"


def _plain(x: Any) -> Any:
    """A float for a number, an array for anything else."""
    return float(x) if isinstance(x, (int, float)) else x


def _described(table: Table, kind: str, unit: str | None) -> str:
    values = table.values
    told = f"{len(table.knots)} points, {kind}, {min(values):g} to {max(values):g}"
    return f"{told} {unit}" if unit else told


def called(function: Callable[[Any], Any], theta: Any, what: str) -> Any:
    """Call a user's function with a number or an array; angle by angle if it takes no arrays."""
    if isinstance(theta, float):
        return _one(function, theta, what)
    with IMPORTS:
        import numpy as np

    theta = np.asarray(theta, float)
    try:
        found = np.asarray(function(theta))
    except Exception:  # math.sin, or a condition: it takes numbers only; what it says of a number counts
        found = np.array([_one(function, x, what) for x in theta.reshape(-1).tolist()]).reshape(theta.shape)
    if found.dtype.kind not in "fiub" or found.shape not in ((), theta.shape):
        raise ValueError(
            f"{what}: a function of {theta.size} angles gave the shape {found.shape} of {found.dtype}; "
            f"expected numbers of the shape {theta.shape}"
        )
    found = np.broadcast_to(found.astype(float), theta.shape)
    bad = np.isfinite(theta) & ~np.isfinite(found)
    if bad.any():
        raise ValueError(
            f"{what}: the function gave {found[bad].flat[0]} at theta = {theta[bad].flat[0]:g}: it must be "
            "finite"
        )
    return found


def _one(function: Callable[[Any], Any], theta: float, what: str) -> float:
    try:
        found = function(theta)
    except Exception as error:
        kind = type(error).__name__
        raise ValueError(f"{what}: the function failed at theta = {theta:g}: {kind}: {error}") from error
    try:
        number = float(found)
    except (TypeError, ValueError):
        raise TypeError(
            f"{what}: the function gave {found!r} at theta = {theta:g}: expected a number"
        ) from None
    if isfinite(theta) and not isfinite(number):
        raise ValueError(f"{what}: the function gave {number} at theta = {theta:g}: it must be finite")
    return number
