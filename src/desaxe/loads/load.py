"""Loads that vary with the motion: over the crank angle, or over the slider's position.

Such a load is a callable: over theta a function of the angle [rad], over Y one of the position [m] and the
way the slider goes. It stands wherever F_X or F_Y does, compares by its content, and can be pickled.
"""

from abc import ABC, abstractmethod
from bisect import bisect_left
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from hashlib import sha256
from math import ceil, floor, inf, nan
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from ..mechanism.closed import TURN
from ..mechanism.inputs import Input
from ..mechanism.quantity_units import si_unit
from ..mechanism.read import in_si
from ..support.computed import computed_once
from ..support.forks import IMPORTS
from .table import Arrays, Table, arrays_of, polynomial
from .words import told

if TYPE_CHECKING:
    from ..mechanism.quantity_units import UnitSystem
    from ..units.system import Conversion

MOST_RANGES = 16  # of angles, of which a table remembers the nodes
ARRAYS = ("_parts", "_arrays", "columns", "lists")  # that are computed once
POSITION = ("Y", "Y_wrt_theta", "Y_wrt_theta_theta")  # which piece holds: the position, and the way


class LoadWarning(UserWarning):
    """A load that may be a mistake, such as an array of designs that looks like a load over theta."""


class Load(ABC):
    """Base class of loads; `unit` is that of the values, None for plain SI numbers.

    plain   what of it was given as plain numbers, which a machine in other units could mean otherwise:
            "theta", "Y" and "value"
    """

    over = "theta"
    parameters: tuple[str, ...] = ("theta",)  # that the load depends on
    centre = ""  # the dead centre from which positions are measured: the name of its position
    unit: str | None = None
    __call__: Callable[..., Any]  # the load at angles, or at positions and ways
    if TYPE_CHECKING:  # from `arithmetic`

        def __add__(self, other: Any) -> "Load": ...
        def __sub__(self, other: Any) -> "Load": ...
        def __mul__(self, other: Any) -> "Load": ...

        __radd__ = __rsub__ = __add__
        __rmul__ = __mul__
    plain: tuple[str, ...] = ()
    numbers: Mapping[str, float] = MappingProxyType({})  # of a spring or damper: motions differ by them
    shown_in: "UnitSystem | None" = None  # of the machine that made it, in which it is called and shown

    @property
    def has_slope(self) -> bool:
        """True where the derivative of the load is known."""
        return True

    @property
    def variant(self) -> tuple[Any, ...]:
        """The key of the load in a request: its kind, not its content, which is an argument of kernels."""
        return type(self), self.centre, self.has_slope

    @property
    def identity(self) -> str:
        """A digest of all that the load is: that of a function is of its values over a period."""
        return sha256(self._content().encode()).hexdigest()

    @abstractmethod
    def _content(self) -> str:
        """The definition of the load as a text."""

    def arrays(self) -> Arrays:
        """The knots and coefficients of a table, as a written module holds them."""
        raise TypeError(f"{self!r} is no table")

    @computed_once
    def lists(self) -> Arrays:
        """The arrays of a table, made once."""
        return self.arrays()

    @computed_once
    def columns(self) -> tuple[Any, Any]:
        """The knots and the coefficients of a table, as arrays that kernels take."""
        with IMPORTS:
            import numpy as np

        knots, rows = self.lists
        return np.array(knots), np.array(rows)

    def __getstate__(self) -> dict[str, Any]:
        """The state without arrays, which are rebuilt when needed."""
        return {name: value for name, value in self.__dict__.items() if name not in ARRAYS}

    tables: tuple[Table, ...] = ()  # one, or one for each way of the slider; none of a function

    @abstractmethod
    def told(self, conversion: "Conversion | None" = None) -> str:
        """The load in a line; with a conversion in that unit."""

    __array_ufunc__ = None  # NumPy's numbers leave a product to the load, see `arithmetic`

    def __repr__(self) -> str:
        return self.told(None if self.shown_in is None else self.values_in(self.shown_in))

    def values_in(self, units: "UnitSystem") -> "Conversion":
        """The conversion of its values, forces or torques."""
        return units.of("T_in" if self.unit == "N*m" else "F_Y")

    def _in_its_units(self, value: Callable[[Any], Any], place: Any) -> Any:
        """A value in SI units by a place, in the units of the machine that made the load."""
        units, over = self.shown_in, "theta" if self.over == "theta" else "Y"
        result = value(in_si(Input(over, si_unit(over), ""), place, units))
        return result if units is None else self.values_in(units).shown(result)


class OverTheta(Load):
    """A load over the crank angle."""

    @property
    @abstractmethod
    def period(self) -> float:
        """The angle after which the load repeats [rad]."""

    @property
    def is_periodic(self) -> bool:
        """True where the load repeats after its period, as every table does."""
        return True

    def __call__(self, theta: Any) -> Any:
        """The load at crank angles, in the units of the machine that made it, else in SI units."""
        return self._in_its_units(self.value, _plain(theta))

    def value(self, theta: Any) -> Any:
        """The load at crank angles [rad], in SI units."""
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


@dataclass(frozen=True, repr=False)
class TableOverTheta(OverTheta):
    """A table over the crank angle, which repeats after its period."""

    table: Table
    kind: str
    unit: str | None = None
    plain: tuple[str, ...] = field(default=(), compare=False)

    @property
    def period(self) -> float:
        """The angle after which the load repeats [rad]."""
        return self.table.period or TURN

    def arrays(self) -> Arrays:
        """The knots and coefficients of the table."""
        return arrays_of(self.table)

    @property
    def tables(self) -> tuple[Table, ...]:  # type: ignore[override]
        """The table."""
        return (self.table,)

    @computed_once
    def largest(self) -> float:
        """The largest magnitude at a knot."""
        return max(map(abs, self.table.values))

    def both(self, theta: Any) -> tuple[Any, Any]:
        """The load and its derivative."""
        return self.table.both(theta)

    def nodes(self, low: float, high: float, smooth: bool) -> list[float]:
        """The angles at which pieces meet, each rounded up into the piece to its right."""
        known, range_ = self._nodes, (low, high, smooth)
        if range_ not in known:
            if len(known) >= MOST_RANGES:
                known.clear()
            known[range_] = self._nodes_in(*range_)
        return list(known[range_])

    @computed_once
    def _nodes(self) -> dict[tuple[float, float, bool], list[float]]:
        """The nodes of ranges: each takes some 30 us, and searches of designs ask for the same."""
        return {}

    def _nodes_in(self, low: float, high: float, smooth: bool) -> list[float]:
        angles = self.table.knots if smooth else self.table.kinks
        found = [self.table.first_right(angle) for angle in self._repeated(angles, low, high)]
        return sorted({angle for angle in found if low <= angle <= high})

    def _content(self) -> str:
        return f"{self.table!r}"

    def told(self, conversion: "Conversion | None" = None) -> str:
        """The table in a line; with a conversion in that unit."""
        return told("theta", self.tables, self.kind, self.unit, conversion)


@dataclass(frozen=True, repr=False)
class OverY(Load):
    """A load over the slider's position, one table for each way it goes, both over the same positions."""

    outward: Table  # where Y increases with time
    inward: Table | None
    kind: str
    unit: str | None = None
    plain: tuple[str, ...] = field(default=(), compare=False)

    over = "Y"
    parameters = ("theta", "ec", "AB", "BC")
    place = "Y"  # that it is over, in words
    rises = 1.0  # the way of the slider in which the table is gone through upwards

    @property
    def variant(self) -> tuple[Any, ...]:
        """The key of the load in a request."""
        return (*super().variant, self.inward is None)

    @property
    def kept(self) -> tuple[str, ...]:
        """The quantities whose difference keeps its value where the slider is at a position of the table."""
        return ("Y", self.centre) if self.centre else ("Y",)

    def arrays(self) -> Arrays:
        """The knots and coefficients of the tables, those inward last."""
        return arrays_of(self.outward, self.outward if self.inward is None else self.inward)

    @property
    def tables(self) -> tuple[Table, ...]:  # type: ignore[override]
        """The table outward and, where there is one, inward."""
        return (self.outward,) if self.inward is None else (self.outward, self.inward)

    def motion(self, parameters: Iterable[str] = ()) -> tuple[str, ...]:
        """The names of the motion from which the load and its derivatives by these parameters follow."""
        return (*POSITION, *(f"Y_wrt_{p}" for p in parameters))

    def along(self, motion: Mapping[str, Any]) -> Any:
        """The position or distance that the table is over, from the motion."""
        return motion["Y"]

    def __call__(self, Y: Any, way: Any = 1.0) -> Any:
        """The load at positions of a slider that goes outward, or inward where `way` is negative.

        That of a machine takes and gives the machine's units, any other SI units.
        """
        return self._in_its_units(lambda si: self.value(si, way), _plain(Y))

    def value(self, Y: Any, way: Any = 1.0) -> Any:
        """The load at positions [m] on the way of a slider, in SI units."""
        return self.both(_plain(Y), _plain(way))[0]

    def both(self, Y: Any, way: Any) -> tuple[Any, Any]:
        """The load and its derivative by Y."""
        if isinstance(Y, float) and isinstance(way, float) and not self.outward.jumps_at_points:
            return (self.inward if self.inward is not None and way < 0.0 else self.outward).both(Y)
        return self.held(Y, self.piece(Y, way))

    def piece(self, Y: Any, way: Any) -> Any:
        """The number of the piece that holds: those of the way inward follow those outward.

        At a position given twice that is the one ahead.
        """
        if isinstance(Y, float) and isinstance(way, float):
            back = self.outward.jumps_at_points and way * self.rises < 0.0
            found = bisect_left(self.outward.knots, Y) if back else self.outward.piece(Y)
            return found + len(self.outward.rows) if self.inward is not None and way < 0.0 else found
        with IMPORTS:
            import numpy as np

        knots = self._arrays[0][1:-1]
        found = np.searchsorted(knots, Y, side="right")
        if self.outward.jumps_at_points:
            left = np.searchsorted(knots, Y, side="left")
            found = np.where(np.multiply(way, self.rises) < 0.0, left, found)
        if self.inward is None:
            return found
        return found + np.where(np.less(way, 0.0), len(self.outward.rows), 0)

    def held(self, Y: Any, piece: Any) -> tuple[Any, Any]:
        """The load and its derivative by Y on a piece, beyond its ends too; NaN at a non-finite position."""
        if isinstance(piece, int):
            table, number = self.outward, piece
            if self.inward is not None and piece >= len(table.rows):
                table, number = self.inward, piece - len(table.rows)
            if isinstance(Y, float) and Y - Y != 0.0:
                return nan, nan
            return polynomial(table.rows[number], Y - table.origin(number))
        with IMPORTS:
            import numpy as np

        _, origins, rows = self._arrays
        with np.errstate(invalid="ignore"):
            distance = np.where(np.isfinite(Y), Y - origins[piece], np.nan)
            value, slope = polynomial(rows.take(piece, axis=1), distance)
        return value, slope

    @computed_once
    def _arrays(self) -> tuple[Any, Any, Any]:
        """The ends of the pieces of one way, and the origin and the coefficients of every piece."""
        with IMPORTS:
            import numpy as np

        edges = np.array([-inf, *self.outward.knots, inf])
        origins = np.concatenate([edges[1:2], edges[1:-1]])
        rows = [row for table in self.tables for row in table.rows]
        return edges, np.tile(origins, len(self.tables)), np.array(rows).T

    @computed_once
    def largest(self) -> float:
        """The largest magnitude at a knot."""
        return max(abs(row[0]) for table in self.tables for row in table.rows)

    @computed_once
    def turns(self) -> bool:
        """True where another table holds for the way inward: at a dead centre the load may jump."""
        return self.inward is not None and self.inward != self.outward

    @computed_once
    def jumping(self) -> bool:
        """True where the load jumps anywhere."""
        return self.turns or bool(self.jumps)

    @property
    def jumps(self) -> list[float]:
        """The positions at which the load jumps."""
        return sorted({x for table in self.tables for x in table.jumps})

    def positions(self, smooth: bool) -> list[float]:
        """The positions at which the load is not smooth; with `smooth`, at which its pieces meet too."""
        return sorted({x for table in self.tables for x in (table.knots if smooth else table.kinks)})

    def _content(self) -> str:
        return f"{self.outward!r} {self.inward!r}"

    def told(self, conversion: "Conversion | None" = None) -> str:
        """The table in a line; with a conversion in that unit."""
        return told(self.place, self.tables, self.kind, self.unit, conversion)


def ahead(motion: Mapping[str, Any], way: Any) -> Any:
    """Negative where the slider goes inward; at a dead centre where it will.

    motion   Y and its derivatives by theta
    way      negative where the crank turns backwards
    """
    with IMPORTS:
        import numpy as np

    _, slope, bend = (motion[name] for name in POSITION)
    forward = np.where(np.equal(slope, 0.0), bend, slope)
    return np.where(np.less(way, 0.0), -forward, forward)


def _plain(x: Any) -> Any:
    """A float for a number, an array for anything else."""
    return float(x) if isinstance(x, (int, float)) else x
