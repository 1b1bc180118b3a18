"""`over_theta` and `over_Y`: loads from tables, files and functions."""

import re
from collections.abc import Callable, Sequence
from itertools import pairwise
from math import inf, isfinite
from os import PathLike
from typing import Any
from warnings import warn

from ..mechanism.slips import LARGEST, UnitWarning
from ..mechanism.units import in_unit, registry
from ..support.files import as_path, read_bytes
from ..support.quantity_text import spelled
from ..support.shown import printable, shown
from .function import FunctionOverTheta
from .load import TURN, Load, LoadWarning, OverY, TableOverTheta
from .table import KINDS, held, periodic

CLOSED = 1e-6  # of a period: a last angle so near to its end repeats the first one
WIDE = 4.0  # times the usual distance between points
MOST_BYTES = 100_000_000  # of a file
LONGEST_PERIOD = 1e9
UNIT_OF_HEADING = re.compile(r"\[([^\]]*)\]")
FARTHEST = LARGEST["ec"]  # m: a position beyond is almost surely in another unit
EQUAL = 1e-9  # of the largest value: what differs by less is the same


class _OverTheta:
    """`over_theta(angles, values)`: a load over the crank angle, wherever F_X, F_Y or a torque is given.

        press = dx.over_theta(["0 deg", "90 deg", "180 deg", "270 deg"], [0, -400, -50, 0], kind="linear")
        dx.peak("T_in", F_Y=press, ec=0.01, AB=0.04, BC=0.064)

    angles  ascending crank angles [rad], or texts with units; within one period. The end of the period may
            repeat the first point
    values  the load [SI units of the input that it is given for], or texts with units
    kind    "cubic" (a periodic cubic spline), "linear", or "step" (each value holds to the right)
    period  after which it repeats [rad]; two turns for a four-stroke engine

    `over_theta(f, derivative=None, nodes=())` makes one of a function of theta (arrays in, arrays out, or
    numbers alone), which is called with the angle as it is. Names that need the slope of a load, such as
    T_in_wrt_theta, need its derivative. nodes: angles at which it has kinks or jumps, in each period.

    `over_theta.read("press.csv", theta="deg", value="N")` reads a table from the first two columns of a file.

    Derivatives by theta are total: they include the load's slope; at a kink it is that to the right. Raises
    ValueError or TypeError for a table that is no periodic function.
    """

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
        length = _period(period)
        if callable(angles):
            if derivative is None and callable(values):  # over_theta(f, derivative, nodes)
                derivative, values = values, None
            if not isinstance(kind, str):
                nodes = kind
            if values is not None:
                raise TypeError(f"{name}: values = {values!r} beside a function; give values or a function")
            if derivative is not None and not callable(derivative):
                raise TypeError(f"{name}: derivative = {derivative!r}: expected a function of theta")
            places, _ = _numbers(f"{name}: nodes", nodes, ("rad",))
            return FunctionOverTheta(angles, derivative, tuple(places), length)
        if derivative is not None or len(nodes):
            raise TypeError(f"{name}: derivative= and nodes= belong to a function; a table knows its own")
        if values is None:
            raise TypeError(f"{name}: values is missing (angles and values, or a function of theta)")
        x, _ = _numbers(f"{name}: angles", angles, ("rad",))
        y, unit = _numbers(f"{name}: values", values, ("N", "N*m"))
        return _table_over_theta(x, y, unit, kind, length)

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
        heading, rows = _rows(path, 2)
        theta = _column_unit(path, "theta", theta, heading[:1]) or "rad"
        value = _column_unit(path, "value", value, heading[1:2])
        x, _ = _in_units("theta", [row[0] for row in rows], theta, ("rad",))
        y, unit = _in_units("value", [row[1] for row in rows], value, ("N", "N*m"))
        try:
            return _table_over_theta(x, y, unit, kind, _period(period))
        except ValueError as error:
            raise ValueError(f"{printable(path)}: {error}") from None

    def __repr__(self) -> str:
        return "desaxe.over_theta(angles, values, kind='cubic', period=2 pi)"


class _OverY:
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
    """

    def __call__(self, positions: Any, outward: Any, inward: Any = None, kind: str = "linear") -> Load:
        """A load over the slider's position; see `help(desaxe.over_Y)`."""
        x, own = _numbers("over_Y: positions", positions, ("m",))
        if own is None and isinstance(positions, (list, tuple)) and max(map(abs, x), default=0.0) > FARTHEST:
            warn(
                f"over_Y: positions up to {max(x, key=abs):.6g} m, almost surely a slip: write "
                f'"{max(x, key=abs):.6g} mm"; plain numbers are metres, for a machine in other units too',
                UnitWarning,
                stacklevel=2,
            )
        forth, unit = _numbers("over_Y: outward", outward, ("N",))
        back = None
        if inward is not None:
            back, other = _numbers("over_Y: inward", inward, ("N",))
            unit = unit or other
        return _table_over_Y(x, forth, back, unit, kind)

    def read(
        self, path: str | PathLike[str], Y: str | None = None, value: str | None = None, kind: str = "linear"
    ) -> Load:
        """A load over the slider's position from a text file: position, outward and perhaps inward.

        Y, value are the units of the columns; the form of the file is that of `over_theta.read`.
        """
        heading, rows = _rows(path, 2)
        Y = _column_unit(path, "Y", Y, heading[:1]) or "m"
        value = _column_unit(path, "value", value, heading[1:3])
        x, _ = _in_units("Y", [row[0] for row in rows], Y, ("m",))
        forth, unit = _in_units("value", [row[1] for row in rows], value, ("N",))
        wide = all(len(row) > 2 for row in rows)
        back = _in_units("value", [row[2] for row in rows], value, ("N",))[0] if wide else None
        try:
            return _table_over_Y(x, forth, back, unit, kind)
        except ValueError as error:
            raise ValueError(f"{printable(path)}: {error}") from None

    def __repr__(self) -> str:
        return "desaxe.over_Y(positions, outward, inward=None)"


over_theta = _OverTheta()
over_Y = _OverY()


def _table_over_theta(x: list[float], y: list[float], unit: str | None, kind: str, period: float) -> Load:
    name = "over_theta"
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
    return TableOverTheta(periodic(x, y, kind, period), kind, unit)


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


def _table_over_Y(
    x: list[float], forth: list[float], back: list[float] | None, unit: str | None, kind: str
) -> Load:
    columns = [forth] if back is None else [forth, back]
    _check("over_Y", "positions", x, columns, kind)
    if x[0] > x[-1]:
        x, columns = x[::-1], [column[::-1] for column in columns]
    if not all(a < b for a, b in pairwise(x)):
        raise ValueError(f"over_Y: the positions must ascend or descend, {_falls(x)}")
    tables = [held(x, column, kind) for column in columns]
    return OverY(tables[0], tables[1] if back is not None else None, kind, unit)


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


def _period(period: Any) -> float:
    found, _ = _numbers("over_theta: period", [period], ("rad",))
    if not 0.0 < found[0] <= LONGEST_PERIOD:
        limit = f"expected an angle above 0 and at most {LONGEST_PERIOD:g} rad"
        raise ValueError(f"over_theta: period = {shown(period)}: {limit}")
    return found[0]


# ---- numbers, with or without units ---------------------------------------------------------------


def _numbers(what: str, given: Any, units: tuple[str, ...]) -> tuple[list[float], str | None]:
    """Finite numbers and their unit, one of `units`; None for plain numbers."""
    said = given.attrs.get("units") if hasattr(given, "dims") else None
    if said in units:
        return _finite(what, given.values.tolist()), said
    if said is not None:
        given = registry().Quantity(given.values, said)
    if hasattr(given, "magnitude"):
        unit, found = _first_that_fits(what, given, units)
        return _finite(what, found.tolist()), unit
    if isinstance(given, str) or not hasattr(given, "__iter__"):
        raise TypeError(f"{what} = {shown(given)}: expected a list or array of numbers")
    if getattr(given, "ndim", 1) != 1:
        raise ValueError(f"{what}: expected a 1-d array, got the shape {given.shape}")
    own: str | None = None
    found = []
    for value in given.tolist() if hasattr(given, "tolist") else given:
        number = value
        if hasattr(value, "magnitude") or (isinstance(value, str) and not _is_plain(value)):
            own, number = _first_that_fits(what, value, units)
        found.append(number)
    return _finite(what, found), own


def _is_plain(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _first_that_fits(what: str, value: Any, units: tuple[str, ...]) -> tuple[str, Any]:
    """The first compatible unit, and the magnitude of a quantity in it."""
    for unit in units[:-1]:
        try:
            return unit, in_unit(what, value, unit)
        except ValueError:
            continue
    return units[-1], in_unit(what, value, units[-1])


def _finite(what: str, values: list[Any]) -> list[float]:
    found = []
    for value in values:
        try:
            number = float(value)
        except OverflowError:
            number = inf
        except (TypeError, ValueError):
            raise TypeError(f"{what}: {shown(value)} is not a number") from None
        if isinstance(value, bool) or not isfinite(number):
            raise ValueError(f"{what}: {shown(value)}; every one must be a finite number")
        found.append(number)
    return found


# ---- files ------------------------------------------------------------------------------------------


def _column_unit(
    path: str | PathLike[str], name: str, given: str | None, heading: Sequence[str]
) -> str | None:
    """The unit of a column: as given, else in brackets in its heading; ValueError if they differ."""
    for cell in heading:
        found = UNIT_OF_HEADING.search(cell)
        unit = spelled(found[1].strip()) if found else given
        if given is not None and unit is not None and unit != spelled(given):
            raise ValueError(f"{printable(path)}: {name} = {given!r}, but its heading is {cell!r}")
        given = unit
    return given


def _rows(path: str | PathLike[str], least: int) -> tuple[list[str], list[list[str]]]:
    """The cells of the heading, and those of the lines that have numbers.

    ValueError names the line that has none.
    """
    try:
        text = read_bytes(as_path("path", path), MOST_BYTES).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise ValueError(f"{printable(path)}: not a text in UTF-8") from None
    except ValueError as error:
        raise ValueError(f"{shown(path)}: {error}") from None
    rows: list[list[str]] = []
    heading: list[str] = []
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        mark = next((mark for mark in (";", "\t", ",") if mark in line), None)
        cells = [cell.strip() for cell in line.split(mark)]
        if len(cells) >= least and all(map(_is_plain, cells[:least])):
            rows.append([cell for cell in cells if cell])
        elif rows or heading:
            raise ValueError(
                f"{printable(path)}, line {number}: expected {least} or more numbers, such as 90, -400"
            )
        else:
            heading = cells
    if not rows:
        raise ValueError(f"{printable(path)}: no line has {least} numbers")
    return heading, rows


def _in_units(
    what: str, cells: list[str], unit: str | None, units: tuple[str, ...]
) -> tuple[list[float], str | None]:
    """A column in SI units."""
    if unit is None or unit in units:
        return _finite(what, cells), unit
    found, own = _numbers(what, [f"{float(cell)!r} {unit}" for cell in cells], units)
    return found, own
