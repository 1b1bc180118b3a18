"""`over_theta` and `over_Y`: loads from tables, files and functions."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import chain, pairwise
from math import isfinite
from os import PathLike
from typing import Any
from warnings import warn

from ..mechanism.slips import LARGEST, UnitWarning
from ..mechanism.unit_system import Conversion, UnitSystem
from ..support.shown import printable, shown
from .columns import Column, column_of, column_of_file, rows_of, unit_of_column
from .function import FunctionOverTheta
from .load import TURN, Load, LoadWarning, OverY, TableOverTheta
from .table import KINDS, Table, held, periodic

CLOSED = 1e-6  # of a period: a last angle so near to its end repeats the first one
WIDE = 4.0  # times the usual distance between points
LONGEST_PERIOD = 1e9
FARTHEST = LARGEST["ec"]  # m: a position beyond is almost surely in another unit
EQUAL = 1e-9  # of the largest value: what differs by less is the same


class MakeOverTheta:
    """`over_theta(angles, values)`: a load over the crank angle, wherever F_X, F_Y or a torque is given.

        press = dx.over_theta(["0 deg", "90 deg", "180 deg", "270 deg"], [0, -400, -50, 0], kind="linear")
        dx.peak("T_in", F_Y=press, ec=0.01, AB=0.04, BC=0.064)

    angles  ascending crank angles [rad], or texts with units; within one period. The end of the period may
            repeat the first point
    values  the load [SI units of the input that it is given for], or texts with units
    kind    "cubic" (a periodic cubic spline), "linear", or "step" (each value holds to the right)
    period  after which it repeats [rad]; two turns for a four-stroke engine

    `machine.over_theta` is the same in the units of a machine: its plain angles, forces and periods, and the
    angle and the force of a function.

    `over_theta(f, derivative=None, nodes=())` makes one of a function of theta (arrays in, arrays out, or
    numbers alone), which is called with the angle as it is. Names that need the slope of a load, such as
    T_in_wrt_theta, need its derivative. nodes: angles at which it has kinks or jumps, in each period.

    `over_theta.read("press.csv", theta="deg", value="N")` reads a table from the first two columns of a file.

    Derivatives by theta are total: they include the load's slope; at a kink it is that to the right. Raises
    ValueError or TypeError for a table that is no periodic function.
    """

    def __init__(self, units: UnitSystem | None = None) -> None:
        self.units = units  # of plain numbers: those of a machine, else SI

    def __call__(
        self,
        angles: Any,
        values: Any = None,
        kind: Any = "cubic",
        period: Any = TURN,
        *,
        derivative: Callable[[Any], Any] | None = None,
        nodes: Any = (),
    ) -> Load:
        """A load over the crank angle; see `help(desaxe.over_theta)`."""
        name = "over_theta"
        turn = self._period(period)
        if callable(angles):
            if derivative is None and callable(values):  # over_theta(f, derivative, nodes)
                derivative, values = values, None
            if not isinstance(kind, str):
                nodes = kind
            if values is not None:
                raise TypeError(f"{name}: values = {values!r} beside a function; give values or a function")
            if derivative is not None and not callable(derivative):
                raise TypeError(f"{name}: derivative = {derivative!r}: expected a function of theta")
            places = column_of(f"{name}: nodes", nodes, ("rad",), _unit(self.units, "theta")).values
            if self.units:
                angles, derivative = _in_units_of(self.units, angles, derivative)
            return FunctionOverTheta(angles, derivative, tuple(places), turn.values[0])
        if derivative is not None or len(nodes):
            raise TypeError(f"{name}: derivative= and nodes= belong to a function; a table knows its own")
        if values is None:
            raise TypeError(f"{name}: values is missing (angles and values, or a function of theta)")
        x = column_of(f"{name}: angles", angles, ("rad",), _unit(self.units, "theta"))
        y = column_of(f"{name}: values", values, ("N", "N*m"), _force(self.units))
        return _table_over_theta(x, y, kind, turn)

    def read(
        self,
        path: str | PathLike[str],
        theta: str | None = None,
        value: str | None = None,
        kind: str = "cubic",
        period: Any = TURN,
    ) -> Load:
        """A load over the crank angle from the first two columns of a text file.

        theta, value   units of the columns, such as "deg" and "N"; without, those of the heading, such as
                       "theta [deg], F_Y [kN]", else SI units
        kind, period   as in `over_theta`

        Columns are parted by commas, semicolons, tabs or blanks; a first line without numbers is a heading,
        and lines that begin with # are left out. Raises ValueError, which names the line.
        """
        heading, rows = rows_of(path, 2)
        theta = unit_of_column(path, "theta", theta, heading[:1])
        value = unit_of_column(path, "value", value, heading[1:2])
        x = column_of_file("theta", rows, 0, theta, ("rad",), _unit(self.units, "theta"))
        y = column_of_file("value", rows, 1, value, ("N", "N*m"), _force(self.units))
        try:
            return _table_over_theta(x, y, kind, self._period(period))
        except ValueError as error:
            raise ValueError(f"{printable(path)}: {error}") from None

    def _period(self, period: Any) -> "Column":
        if isinstance(period, float) and period == TURN:  # a turn, in any unit
            return Column([TURN])
        found = column_of("over_theta: period", [period], ("rad",), _unit(self.units, "theta"))
        if not 0.0 < found.values[0] <= LONGEST_PERIOD:
            limit = f"expected an angle above 0 and at most {LONGEST_PERIOD:g} rad"
            raise ValueError(f"over_theta: period = {shown(period)}: {limit}")
        return found

    def __repr__(self) -> str:
        units = f" in {self.units!r}" if self.units else ""
        return f"desaxe.over_theta(angles, values, kind='cubic', period=2 pi){units}"


class MakeOverY:
    """`over_Y(positions, outward, inward=None)`: a load over the slider's position, for F_X and F_Y.

    A press or a compressor is given by its stroke: the load follows the slider, so that sensitivities by
    theta and by every length include dF/dY dY/dp.

        gas = dx.over_Y(["30 mm", "50 mm", "100 mm"], outward=[-900, -200, -50], inward=[-900, -400, -150])

    positions  of the slider along Y [m], ascending or descending, or texts with units
    outward    the load where Y increases with time, at each position
    inward     where it decreases; as outward without
    kind       "linear", "step" (a value holds towards larger Y), or "cubic" (a spline, extra `simulate`)

    Beyond the positions the values at the ends hold. Where the crank stands still it counts as turning
    forwards, or the way that a given alpha starts it. `over_Y.read("indicator.csv", Y="mm", value="N")`
    reads the columns position, outward and, where there is one, inward.

    `machine.over_Y` is the same in the units of a machine: its plain positions and forces.
    """

    def __init__(self, units: UnitSystem | None = None) -> None:
        self.units = units  # of plain numbers: those of a machine, else SI

    def __call__(self, positions: Any, outward: Any, inward: Any = None, kind: str = "linear") -> Load:
        """A load over the slider's position; see `help(desaxe.over_Y)`."""
        x = column_of("over_Y: positions", positions, ("m",), _unit(self.units, "Y"))
        farthest = max(x.values, key=abs, default=0.0)
        if x.plain and isinstance(positions, (list, tuple)) and abs(farthest) > FARTHEST:
            warn(
                f"over_Y: positions up to {farthest:.6g} m, almost surely a slip: write "
                f'"{farthest:.6g} mm"; plain numbers are metres',
                UnitWarning,
                stacklevel=2,
            )
        ways = [("outward", outward), *([] if inward is None else [("inward", inward)])]
        columns = [column_of(f"over_Y: {way}", values, ("N",), _force(self.units)) for way, values in ways]
        return _table_over_Y(x, columns, kind)

    def read(
        self, path: str | PathLike[str], Y: str | None = None, value: str | None = None, kind: str = "linear"
    ) -> Load:
        """A load over the slider's position from a text file: position, outward and perhaps inward.

        Y, value are the units of the columns; the form of the file is that of `over_theta.read`.
        """
        heading, rows = rows_of(path, 2)
        Y = unit_of_column(path, "Y", Y, heading[:1])
        value = unit_of_column(path, "value", value, heading[1:3])
        x = column_of_file("Y", rows, 0, Y, ("m",), _unit(self.units, "Y"))
        ways = (1, 2) if all(len(row) > 2 for row in rows) else (1,)
        columns = [column_of_file("value", rows, way, value, ("N",), _force(self.units)) for way in ways]
        try:
            return _table_over_Y(x, columns, kind)
        except ValueError as error:
            raise ValueError(f"{printable(path)}: {error}") from None

    def __repr__(self) -> str:
        units = f" in {self.units!r}" if self.units else ""
        return f"desaxe.over_Y(positions, outward, inward=None){units}"


over_theta = MakeOverTheta()
over_Y = MakeOverY()


@dataclass(frozen=True)
class Converted:
    """A function of the crank angle in other units, called with radians, as one in SI units."""

    function: Callable[[Any], Any]
    angle: Conversion
    value: Conversion

    @property
    def __name__(self) -> str:
        """The name of the function."""
        return getattr(self.function, "__name__", type(self.function).__name__)

    def __call__(self, theta: Any) -> Any:
        """The value in SI units."""
        return self.value.to_si(self.function(self.angle.shown(theta)))


def _in_units_of(units: UnitSystem, function: Any, derivative: Any) -> tuple[Any, Any]:
    """A function and its derivative in a machine's units, as ones in SI units."""
    angle, force = units.of("theta"), _force(units) or Conversion("N")
    slope = None if derivative is None else Converted(derivative, angle, force.per([angle]))
    return Converted(function, angle, force), slope


def _unit(units: UnitSystem | None, name: str) -> Conversion | None:
    """The unit of plain numbers of a name; None where none is given."""
    return None if units is None else units.of(name)


def _force(units: UnitSystem | None) -> Conversion | None:
    """The unit of plain forces; ValueError where F_X and F_Y have different ones."""
    one, other = _unit(units, "F_X"), _unit(units, "F_Y")
    if one is not None and other is not None and one != other:
        raise ValueError(
            f"a load in a machine whose F_X is in {one.unit} and F_Y in {other.unit}: give texts with units"
        )
    return one


def _table_over_theta(angles: Column, values: Column, kind: str, turn: Column) -> Load:
    name = "over_theta"
    x, y, period = angles.values, values.values, turn.values[0]
    _check(name, "angles", x, [y], kind)
    if not all(a < b for a, b in pairwise(x)):
        raise ValueError(f"{name}: the angles must ascend, {_falls(x)}")
    span = x[-1] - x[0]
    if span > (1.0 + CLOSED) * period:
        raise ValueError(
            f"{name}: the angles go over {span:g} rad, the period is {period:g} rad; give a longer period= "
            f'or one period of the table (degrees are texts: "{x[-1]:g} deg")'
        )
    if span >= (1.0 - CLOSED) * period:
        if abs(y[-1] - y[0]) > EQUAL * max(map(abs, y)):
            raise ValueError(
                f"{name}: at the end of the period the value is {y[-1]!r}, but {y[0]!r} at its beginning: "
                "the load must repeat; leave the end point out, or give the period= after which it does"
            )
        x, y = x[:-1], y[:-1]
    _warn_of_gap(x, kind, period)
    plain = ("theta",) * (angles.plain or turn.plain) + ("value",) * values.plain
    table = _finite(name, x, y, partial(periodic, x, y, kind, period))
    return TableOverTheta(table, kind, values.unit, plain)


def _finite(name: str, x: Sequence[float], y: Sequence[float], make: Callable[[], Table]) -> Table:
    """A table; ValueError where slopes between its points are too steep for doubles."""
    try:
        table = make()
    except ArithmeticError:
        table = None
    if table is None or not all(map(isfinite, chain.from_iterable(table.rows))):
        spans = pairwise(zip(x, y, strict=True))
        _, a, b = max((abs((right - left) / (b - a)), a, b) for (a, left), (b, right) in spans)
        raise ValueError(
            f"{name}: {a!r} and {b!r} are too close for the values there: slopes must be below 1.8e308"
        )
    return table


def _warn_of_gap(x: list[float], kind: str, period: float) -> None:
    """Warn of a spline with a gap of most of a turn between two points."""
    gaps = sorted(b - a for a, b in zip(x, [*x[1:], x[0] + period], strict=True))
    if kind == "cubic" and gaps[-1] > max(period / 4.0, WIDE * gaps[len(gaps) // 2]):
        warn(
            f"over_theta: a gap of {gaps[-1]:.3g} rad without a point, which a cubic spline bridges with a "
            'wide swing; give points there too, or kind="linear" or "step"',
            LoadWarning,
            stacklevel=4,
        )


def _table_over_Y(positions: Column, ways: Sequence[Column], kind: str) -> Load:
    x, columns = positions.values, [way.values for way in ways]
    _check("over_Y", "positions", x, columns, kind)
    if x[0] > x[-1]:
        x, columns = x[::-1], [column[::-1] for column in columns]
    if not all(a < b for a, b in pairwise(x)):
        raise ValueError(f"over_Y: the positions must ascend or descend, {_falls(x)}")
    tables = [_finite("over_Y", x, column, partial(held, x, column, kind)) for column in columns]
    outward, inward, *_ = *tables, None
    unit = next((way.unit for way in ways if way.unit is not None), None)
    plain = ("Y",) * positions.plain + ("value",) * any(way.plain for way in ways)
    return OverY(outward, inward, kind, unit, plain)


def _check(name: str, places: str, x: list[float], columns: Sequence[list[float]], kind: str) -> None:
    if not isinstance(kind, str) or kind not in KINDS:
        raise ValueError(f"{name}: kind = {shown(kind)}: it is one of {', '.join(KINDS)}")
    for column in columns:
        if len(column) != len(x):
            raise ValueError(f"{name}: {len(x)} {places} and {len(column)} values; expected as many of both")
    if len(x) < 2:
        raise ValueError(f"{name}: {len(x)} of the {places}; expected at least two points")


def _falls(x: Sequence[float]) -> str:
    a, b = next((a, b) for a, b in pairwise(x) if not a < b)
    return f"but {b:g} follows {a:g}"
