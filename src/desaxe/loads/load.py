"""Loads that vary with the motion: over the crank angle, or over the slider's position.

Such a load is a callable: over theta a function of the angle [rad], over Y one of the position [m] and the
way the slider goes. It stands wherever F_X or F_Y does, compares by its content, and can be pickled.
"""

import sys
from abc import ABC, abstractmethod
from bisect import bisect_left
from collections.abc import Callable, Iterable, Mapping
from copy import copy
from dataclasses import dataclass, field, fields
from hashlib import sha256
from math import ceil, floor, nan
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

from ..mechanism.catalogue import has
from ..mechanism.closed import TURN
from ..mechanism.inputs import Input
from ..mechanism.names import LENGTHS
from ..mechanism.quantity_units import si_unit
from ..mechanism.read import in_si
from ..support.computed import computed_once
from ..support.lazy import np
from ..support.recent import Recent
from .table import Arrays, Table, arrays_of, polynomial
from .words import told

if TYPE_CHECKING:
    from ..mechanism.quantity_units import UnitSystem
    from ..units.system import Conversion

MOST_RANGES = 16  # of angles, of which a table remembers the nodes
POSITION = ("Y", "Y_wrt_theta", "Y_wrt_theta_theta")  # which piece holds: the position, and the way
MOVING = ("omega", "V_C")  # columns that depend on the speed of the crank
BY: dict[str, tuple[str, ...]] = {  # the parameters that a column depends on, without those of a position
    "theta": ("theta",),
    "omega": ("theta", "omega0", "alpha", "omega"),
    "V_C": ("theta", *LENGTHS, "omega0", "alpha", "omega"),
}


class LoadWarning(UserWarning):
    """A load that may be a mistake, such as an array of designs that looks like a load over theta."""


def outside() -> int:
    """The stack level of the first frame outside of the package, for a warning of the caller."""
    frame, level = sys._getframe(1), 1
    while frame.f_back is not None and frame.f_globals.get("__name__", "").startswith("desaxe."):
        frame, level = frame.f_back, level + 1
    return level


class Partials(NamedTuple):
    """The value of a load and its derivatives with respect to the columns of the motion."""

    value: Any
    slopes: dict[str, Any]


class Load(ABC):
    """Base class of loads: a function of columns of the motion, theta, omega, Y, s, V_C, a dead centre's Y.

    needs   the columns
    unit    of the values, None for plain SI numbers
    plain   what of it was given as plain numbers, which a machine in other units could mean otherwise:
            "theta", "Y" and "value"
    curves  the fields that are its tables
    numbers of a spring or damper, by which a motion has derivatives
    """

    over = "theta"
    needs: tuple[str, ...] = ("theta",)
    centre = ""  # the dead centre from which positions are measured: the name of its position
    unit: str | None = None
    kind: str
    curves: ClassVar[tuple[str, ...]] = ()
    plain: tuple[str, ...] = ()
    numbers: Mapping[str, float] = MappingProxyType({})
    has_ways = False  # whether the direction of the slider matters, `way` of the columns
    has_slope = True  # whether the derivative of the load is known
    speeds: tuple[float, ...] = ()  # of the slider, at which the load has a kink
    shown_in: "UnitSystem | None" = None  # of the machine that made it, in which it is called and shown
    __call__: Callable[..., Any]  # the load at its columns
    # Of `arithmetic`, which knows all classes of loads.
    __add__: ClassVar[Callable[..., Any]]
    __radd__: ClassVar[Callable[..., Any]]
    __sub__: ClassVar[Callable[..., Any]]
    __rsub__: ClassVar[Callable[..., Any]]
    __mul__: ClassVar[Callable[..., Any]]
    __rmul__: ClassVar[Callable[..., Any]]
    __neg__: ClassVar[Callable[..., Any]]
    __array_ufunc__ = None  # NumPy's numbers leave a product to the load

    @property
    def parameters(self) -> tuple[str, ...]:
        """The parameters that the columns depend on."""
        return tuple(dict.fromkeys(p for c in self.needs for p in BY.get(c, ("theta", *LENGTHS))))

    @property
    def follows_speed(self) -> bool:
        """True where the load depends on how fast the crank turns."""
        return not set(MOVING).isdisjoint(self.needs)

    @property
    def variant(self) -> tuple[Any, ...]:
        """The key of the load in a request: its kind, not its content, which is an argument of kernels."""
        return type(self), self.needs, self.has_slope, self.has_ways, len(self.tables)

    @property
    def identity(self) -> str:
        """A digest of all that the load is: that of a function is of its values over a period."""
        return sha256(self._content().encode()).hexdigest()

    def _content(self) -> str:
        """The definition of the load as a text."""
        compared = (one.name for one in fields(self) if one.compare)  # type: ignore[arg-type]
        return f"{type(self).__name__} {[getattr(self, name) for name in compared]}"

    @abstractmethod
    def partials(self, now: Mapping[str, Any]) -> Partials:
        """The value and the derivatives at columns of the motion; `way` is the slider's direction."""

    def by(self, now: Mapping[str, Any]) -> dict[str, Any]:
        """The derivatives of the load by its numbers."""
        return {}

    def by_at(
        self, values: Callable[[list[str]], Mapping[str, Any]], theta: Any, omega: Any
    ) -> dict[str, Any]:
        """The derivatives with respect to its numbers along a motion; values: of names there, by name."""
        motion = values([name for name in self.motion((), True) if name != "omega"])
        way = motion.get("V_C", motion.get("Y_wrt_theta"))
        return self.by({**motion, "theta": theta, "omega": omega, "way": way})

    def motion(self, parameters: Iterable[str] = (), state: bool = False) -> tuple[str, ...]:
        """The names of the motion from which the load and these derivatives follow.

        state  whether omega is an input
        """
        names, parameters = list(POSITION) if self.has_ways else [], tuple(parameters)
        for column in self.needs:
            if column == "theta":
                continue
            by = () if column == "omega" and state else parameters
            names += [column, *(n for p in by if has(n := f"{column}_wrt_{p}", state))]
        return tuple(dict.fromkeys(names))

    @property
    def tables(self) -> tuple[Table, ...]:
        """One, or one for each way of the slider; none of a function."""
        every = (getattr(self, name) for name in self.curves)
        return tuple(table for table in every if table is not None)

    def arrays(self) -> Arrays:
        """The knots and coefficients of its tables, as a written module holds them."""
        return arrays_of(*self.tables)

    @computed_once
    def lists(self) -> Arrays:
        """The arrays of a table, made once."""
        return self.arrays()

    @computed_once
    def columns(self) -> tuple[Any, Any]:
        """The knots and the coefficients of a table, as arrays that kernels take."""
        knots, rows = self.lists
        return np.array(knots), np.array(rows)

    @computed_once
    def largest(self) -> float:
        """The largest magnitude at a knot."""
        return max((abs(row[0]) for table in self.tables for row in table.rows), default=0.0)

    def __getstate__(self) -> dict[str, Any]:
        """The state without what is computed, which is rebuilt when needed."""
        kept = {*(one.name for one in fields(self)), "shown_in"}  # type: ignore[arg-type]
        return {name: value for name, value in self.__dict__.items() if name in kept}

    @property
    def place(self) -> str:
        """The column that the load is over, in words."""
        return self.over

    def in_units(self, units: "UnitSystem") -> "Load":
        """The load as it is called and shown in these units."""
        new = copy(self)
        object.__setattr__(new, "shown_in", units)
        return new

    def told(self, conversion: "Conversion | None" = None) -> str:
        """The load in a line; with a conversion in that unit."""
        return told(self, conversion)

    def __repr__(self) -> str:
        return self.told(None if self.shown_in is None else self.values_in(self.shown_in))

    def values_in(self, units: "UnitSystem") -> "Conversion":
        """The conversion of its values, forces or torques."""
        return units.of("T_in" if self.unit == "N*m" else "F_Y")

    def _in_its_units(self, value: Callable[..., Any], columns: Mapping[str, Any]) -> Any:
        """A value in SI units by columns, in the units of the machine that made the load."""
        units = self.shown_in
        si = (in_si(Input(name, si_unit(name), ""), _plain(x), units) for name, x in columns.items())
        result = value(*si)
        return result if units is None else self.values_in(units).shown(result)


class OverTheta(Load):
    """A load over the crank angle."""

    shifted: ClassVar[Callable[..., Any]]  # of `arithmetic`

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
        return self._in_its_units(self.value, {"theta": theta})

    def partials(self, now: Mapping[str, Any]) -> Partials:
        """The value and, where it is known, the derivative with respect to theta."""
        value, slope = self.both(now["theta"])
        return Partials(value, {} if slope is None else {"theta": slope})

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
        return [
            angle + k * period if k else angle
            for angle in angles
            for k in range(ceil((low - angle) / period) - 1, floor((high - angle) / period) + 2)
        ]


@dataclass(frozen=True, repr=False)
class TableOverTheta(OverTheta):
    """A table over the crank angle, which repeats after its period."""

    table: Table
    kind: str
    unit: str | None = None
    plain: tuple[str, ...] = field(default=(), compare=False)

    curves = ("table",)

    @property
    def period(self) -> float:
        """The angle after which the load repeats [rad]."""
        return self.table.period or TURN

    def both(self, theta: Any) -> tuple[Any, Any]:
        """The load and its derivative."""
        return self.table.both(theta)

    def nodes(self, low: float, high: float, smooth: bool) -> list[float]:
        """The angles at which pieces meet, each rounded up into the piece to its right."""
        nodes = self._nodes.get((low, high, smooth))
        if nodes is None:
            angles = self._repeated(self.table.knots if smooth else self.table.kinks, low, high)
            nodes = sorted({x for x in map(self.table.first_right, angles) if low <= x <= high})
            self._nodes[low, high, smooth] = nodes
        return list(nodes)

    @computed_once
    def _nodes(self) -> Recent[tuple[float, float, bool], list[float]]:
        """The nodes of ranges: each takes some 30 us, and searches of designs ask for the same."""
        return Recent(MOST_RANGES)


@dataclass(frozen=True, repr=False)
class OverY(Load):
    """A load over the slider's position, one table for each way it goes, both over the same positions."""

    outward: Table  # where Y increases with time
    inward: Table | None
    kind: str
    unit: str | None = None
    plain: tuple[str, ...] = field(default=(), compare=False)

    over = "Y"
    curves = ("outward", "inward")
    has_ways = True
    rises = 1.0  # the way of the slider in which the table is gone through upwards

    @computed_once
    def needs(self) -> tuple[str, ...]:
        """The position, and that of the dead centre: their difference stays at a position of the table."""
        return ("Y", self.centre) if self.centre else ("Y",)

    def arrays(self) -> Arrays:
        """The knots and coefficients of the tables, those inward last."""
        return arrays_of(self.outward, self.outward if self.inward is None else self.inward)

    def along(self, motion: Mapping[str, Any]) -> Any:
        """The position or distance that the table is over, from the motion."""
        return motion["Y"]

    def __call__(self, Y: Any, way: Any = 1.0) -> Any:
        """The load at positions of a slider that goes outward, or inward where `way` is negative.

        That of a machine takes and gives the machine's units, any other SI units.
        """
        return self._in_its_units(lambda si: self.value(si, way), {"Y": Y})

    def value(self, Y: Any, way: Any = 1.0) -> Any:
        """The load at positions [m] on the way of a slider, in SI units."""
        return self.both(_plain(Y), _plain(way))[0]

    def partials(self, now: Mapping[str, Any]) -> Partials:
        """The value and the derivative by Y."""
        value, slope = self.both(self.along(now), now["way"])
        return Partials(value, {"Y": slope})

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
            result = bisect_left(self.outward.knots, Y) if back else self.outward.piece(Y)
            return result + len(self.outward.rows) if self.inward is not None and way < 0.0 else result
        knots = self._arrays[0]
        result = np.searchsorted(knots, Y, side="right")
        if self.outward.jumps_at_points:
            left = np.searchsorted(knots, Y, side="left")
            result = np.where(np.multiply(way, self.rises) < 0.0, left, result)
        if self.inward is None:
            return result
        return result + np.where(np.less(way, 0.0), len(self.outward.rows), 0)

    def held(self, Y: Any, piece: Any) -> tuple[Any, Any]:
        """The load and its derivative by Y on a piece, beyond its ends too; NaN at a non-finite position."""
        if isinstance(piece, int):
            way, number = divmod(piece, len(self.outward.rows))
            table = self.tables[way]
            lost = isinstance(Y, float) and Y - Y != 0.0
            return (nan, nan) if lost else polynomial(table.rows[number], Y - table.origin(number))
        _, origins, rows = self._arrays
        with np.errstate(invalid="ignore"):
            distance = np.where(np.isfinite(Y), Y - origins[piece], np.nan)
            value, slope = polynomial(rows.take(piece, axis=1), distance)
        return value, slope

    @computed_once
    def _arrays(self) -> tuple[Any, Any, Any]:
        """The knots of one way, and the origin and the coefficients of every piece."""
        knots = np.array(self.outward.knots)
        rows = [row for table in self.tables for row in table.rows]
        return knots, np.tile(np.append(knots[:1], knots), len(self.tables)), np.array(rows).T

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


def ahead(motion: Mapping[str, Any], way: Any) -> Any:
    """Negative where the slider goes inward; at a dead centre where it will.

    motion   Y and its derivatives with respect to theta
    way      negative where the crank turns backwards
    """
    _, slope, bend = (motion[name] for name in POSITION)
    forward = np.where(np.equal(slope, 0.0), bend, slope)
    return np.where(np.less(way, 0.0), -forward, forward)


def _plain(x: Any) -> Any:
    """A float for a number, an array for anything else."""
    return float(x) if isinstance(x, (int, float)) else x


def sign_of(x: Any) -> Any:
    """1, or -1 below 0, of a number or an array."""
    if isinstance(x, float):
        return 1.0 if x >= 0.0 else -1.0
    return np.where(x >= 0.0, 1.0, -1.0)
