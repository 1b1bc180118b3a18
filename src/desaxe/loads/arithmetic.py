"""Arithmetic of loads: multiples, sums, loads shifted by an angle.

A result may be a load of another class than its parts: the operators stand above all classes of loads, and
are attached to them here.
"""

from bisect import bisect_left
from collections.abc import Callable
from dataclasses import dataclass, replace
from math import inf, isfinite
from numbers import Real
from sys import float_info
from typing import Any, TypeVar, cast

from ..mechanism.inputs import INPUTS
from ..mechanism.read import read
from ..support.shown import shown
from .along_motion import Damper, OfMotion, OverSpeed, Spring, SumOfLoads
from .function import FunctionOverTheta
from .load import Load, OverTheta, OverY, TableOverTheta
from .table import Row, Table, polynomial

T = TypeVar("T", bound=Load)
MOST_PERIODS = 64  # of the shorter one of two in the period of their sum
ROUNDED = 1e-13  # of a knot: more than a shift by an angle rounds
SAME_KIND = ("linear", "step")  # pieces that stay of their kind on more knots


@dataclass(frozen=True)
class Combined:
    """A sum of multiples of functions of the crank angle, each of an angle of its own."""

    parts: tuple[tuple[float, Callable[[Any], Any], float], ...]  # factor, function, angle that it lags
    constant: float = 0.0

    __name__ = "a sum"

    def __call__(self, theta: Any) -> Any:
        """The sum at crank angles [rad]."""
        return sum((factor * function(theta - lag) for factor, function, lag in self.parts), self.constant)


def multiple(load: Load, factor: Any) -> Any:
    """A load times a number."""
    if isinstance(factor, bool) or not isinstance(factor, Real):
        return NotImplemented
    factor = _finite(factor, f"{shown(factor)} times a load: the factor")
    if isinstance(load, TableOverTheta):
        return _like(load, replace(load, table=_scaled(load.table, factor)))
    if isinstance(load, OverY):
        inward = None if load.inward is None else _scaled(load.inward, factor)
        return _like(load, replace(load, outward=_scaled(load.outward, factor), inward=inward))
    if isinstance(load, OverTheta):
        return _function(load, ((factor, load, 0.0),))
    terms, constant = _terms(load)
    return _like(load, SumOfLoads(tuple((factor * f, part) for f, part in terms), factor * constant))


def total(one: Load, other: Any) -> Any:
    """The sum of two loads, or of a load and a number; over the same thing where it is of their kind."""
    if isinstance(other, Real) and not isinstance(other, bool):
        return _raised(one, _in_si(one, other))
    if not isinstance(other, Load):
        return NotImplemented
    if one.unit is not None and other.unit is not None and one.unit != other.unit:
        raise TypeError(f"{one!r} + {other!r}: a load in {one.unit} and one in {other.unit} do not add up")
    if isinstance(one, TableOverTheta) and isinstance(other, TableOverTheta) and one.unit == other.unit:
        table = _sum(one.table, other.table, one.kind if one.kind == other.kind else "")
        if table is not None:
            return _like(one, replace(one, table=table))
    if isinstance(one, OverTheta) and isinstance(other, OverTheta):
        return _function(one, ((1.0, one, 0.0), (1.0, other, 0.0)))
    if type(one) is type(other) and isinstance(one, OverY) and isinstance(other, OverY):
        both = _sum_over_Y(one, other)
        if both is not None:
            return both
    (terms, constant), (others, more) = _terms(one), _terms(other)
    return _like(one, SumOfLoads((*terms, *others), constant + more))


def _terms(load: Load) -> tuple[tuple[tuple[float, Load], ...], float]:
    """A load as multiples of loads, and a number."""
    return (load.terms, load.constant) if isinstance(load, SumOfLoads) else (((1.0, load),), 0.0)


def parts_of(load: OfMotion) -> list[Load] | None:
    """Tables that add up to a load, made once; None of one that is none, as a function is."""
    known = load.__dict__
    if "_parts" not in known:
        known["_parts"] = as_tables(load)
    return cast("list[Load] | None", known["_parts"])


def as_tables(load: Load) -> list[Load] | None:
    """Tables that add up to a load; None of one that is none, as a function is."""
    if isinstance(load, Spring):
        row = 0.0, -load.stiffness, 0.0, 0.0
        return [OverY(Table((load.free,), (row, row)), None, "linear")]
    if isinstance(load, Damper):
        rows = tuple((0.0, -load.linear, side * load.quadratic, 0.0) for side in (1.0, -1.0))
        return [OverSpeed(Table((0.0,), rows), "smooth")]
    if not isinstance(load, SumOfLoads):
        return [load] if isinstance(load, (TableOverTheta, OverY, OverSpeed)) else None
    tables: list[Load] = []
    for factor, member in load.terms:
        parts = as_tables(member)
        if parts is None:
            return None
        tables += [_times(part, factor) for part in parts]
    return [_raised_table(tables[0], load.constant), *tables[1:]]


def _times(load: Load, factor: float) -> Load:
    """A table times a number."""
    return (
        replace(load, table=_scaled(load.table, factor))
        if isinstance(load, OverSpeed)
        else multiple(load, factor)
    )


def _raised_table(load: Load, number: float) -> Load:
    """A table and a number."""
    if not isinstance(load, OverSpeed):
        return _raised(load, number)
    rows = tuple((row[0] + number, *row[1:]) for row in load.table.rows)
    return replace(load, table=replace(load.table, rows=rows))


def _raised(load: Load, number: float) -> Load:
    """A load and a number."""

    def raised(table: Table) -> Table:
        return replace(table, rows=tuple((row[0] + number, *row[1:]) for row in table.rows))

    if isinstance(load, TableOverTheta):
        return _like(load, replace(load, table=raised(load.table)))
    if isinstance(load, OverY):
        inward = None if load.inward is None else raised(load.inward)
        return _like(load, replace(load, outward=raised(load.outward), inward=inward))
    if isinstance(load, OverTheta):
        return _function(load, ((1.0, load, 0.0),), constant=number)
    terms, constant = _terms(load)
    return _like(load, SumOfLoads(terms, constant + number))


def _in_si(load: Load, number: Any) -> float:
    """A number that is added to a load, in SI units from those of its machine."""
    number, units = _finite(number, f"a load + {shown(number)}: the number"), load.shown_in
    return number if units is None else float(load.values_in(units).to_si(number))


def _finite(value: Any, what: str) -> float:
    """A number as a float; ValueError for one that is not finite."""
    number = float(value) if abs(value) <= float_info.max else inf
    if not isfinite(number):
        raise ValueError(f"{what} must be finite")
    return number


def shifted(load: OverTheta, angle: Any) -> OverTheta:
    """The load that lags by an angle: what it was at theta it is at theta + angle."""
    lag = read(INPUTS["theta"], angle, "shifted", "an angle", load.shown_in)
    if not isinstance(load, TableOverTheta):
        return _function(load, ((1.0, load, lag),), lag)
    table, period = load.table, load.period
    knots = [(knot + lag) % period for knot in table.knots]
    first = knots.index(min(knots))
    pieces = table.rows[1:]
    rows = (*pieces[first:], *pieces[:first])
    moved = Table((*knots[first:], *knots[:first]), (rows[-1], *rows), table.period)
    return _like(load, replace(load, table=moved))


def _like(load: Load, new: T) -> T:
    """The new load in the units of the machine that made the other."""
    object.__setattr__(new, "shown_in", load.shown_in)
    return new


def _function(load: Any, parts: Any, lag: float = 0.0, constant: float = 0.0) -> FunctionOverTheta:
    """A combination of loads over theta as one function, with the nodes of all of them."""
    loads = [part for _, part, _ in parts]
    period = _common([part.period for part in loads])
    nodes = {(node + lag) % period for part in loads for node in part.nodes(0.0, period, False)}
    values = Combined(tuple((factor, part.value, at) for factor, part, at in parts), constant)
    slopes = None
    if all(part.has_slope for part in loads):
        slopes = Combined(tuple((factor, Slope(part), at) for factor, part, at in parts))
    return _like(load, FunctionOverTheta(values, slopes, tuple(sorted(nodes)), period))


@dataclass(frozen=True)
class Slope:
    """The derivative of a load over theta as a function."""

    load: Any

    def __call__(self, theta: Any) -> Any:
        """The derivative at crank angles [rad]."""
        return self.load.both(theta)[1]


def _common(periods: list[float]) -> float:
    """The least angle in which each period fits a whole number of times."""
    longest = max(periods)
    for turns in range(1, MOST_PERIODS + 1):
        if all(abs(turns * longest / period - round(turns * longest / period)) < 1e-9 for period in periods):
            return turns * longest
    raise ValueError(
        f"loads with the periods {' and '.join(f'{p:.6g}' for p in periods)} rad never repeat together"
    )


def _scaled(table: Table, factor: float) -> Table:
    """A table times a number."""
    rows = ((factor * a, factor * b, factor * c, factor * d) for a, b, c, d in table.rows)
    return Table(table.knots, tuple(rows), table.period)


def _sum_over_Y(one: OverY, other: OverY) -> OverY | None:
    """The sum of two tables over position, or over distance from one dead centre; None where it is none."""
    if one.centre != other.centre:
        return None
    ways = [(one.outward, other.outward)]
    if one.inward is not None or other.inward is not None:
        ways.append((one.inward or one.outward, other.inward or other.outward))
    sums = [_sum(a, b, one.kind if one.kind == other.kind else "") for a, b in ways]
    tables = [table for table in sums if table is not None]
    if len(tables) < len(ways):
        return None
    inward = tables[1] if len(tables) > 1 else None
    return _like(one, replace(one, outward=tables[0], inward=inward))


def _sum(one: Table, other: Table, kind: str) -> Table | None:
    """The sum of two tables of one kind; None where it is of no kind."""
    period = None if one.period is None or other.period is None else _common([one.period, other.period])
    first = _over(one, period)
    both = [first, _snapped(_over(other, period), first.knots)]
    # A periodic spline is the only one through its points, on more knots, too.
    stays = kind in SAME_KIND or (kind == "cubic" and period is not None)
    if not kind or (both[0].knots != both[1].knots and not stays):
        return None
    every = [table.knots for table in both]
    knots = sorted(x for x in {*every[0], *every[1]} for _ in range(max(k.count(x) for k in every)))
    ends = [*knots[1:], *([] if period is None else [knots[0] + period])]
    rows = [_added([_piece(table, a, a == b) for table in both]) for a, b in zip(knots, ends, strict=False)]
    if period is not None:
        return Table(tuple(knots), (rows[-1], *rows), period)
    return Table(tuple(knots), (_added([t.rows[0] for t in both]), *rows, _added([t.rows[-1] for t in both])))


def _over(table: Table, period: float | None) -> Table:
    """A periodic table over a multiple of its period, with knots from 0 on."""
    if period is None or table.period is None:
        return table
    knots = [knot % table.period for knot in table.knots]
    first = knots.index(min(knots))
    base, pieces = (*knots[first:], *knots[:first]), (*table.rows[1:][first:], *table.rows[1:][:first])
    turns = round(period / table.period)
    every = tuple(knot + turn * table.period for turn in range(turns) for knot in base)
    return Table(every, (pieces[-1], *(pieces * turns)), period)


def _snapped(table: Table, knots: tuple[float, ...]) -> Table:
    """A table whose knots are those given where they differ by rounding."""

    def nearest(x: float) -> float:
        k = bisect_left(knots, x)
        best = min(knots[max(k - 1, 0) : k + 1], key=lambda knot: abs(knot - x))
        return best if abs(best - x) <= ROUNDED * (1.0 + abs(x)) else x

    return replace(table, knots=tuple(map(nearest, table.knots)))


def _piece(table: Table, x: float, before: bool) -> Row:
    """The cubic of a table from x on; that of no width, at a jump, is the value before it."""
    if before:
        index = bisect_left(table.knots, x)
        return polynomial(table.rows[index], x - table.origin(index))[0], 0.0, 0.0, 0.0
    at = table.reduced(x)
    index = table.piece(at)
    c0, c1, c2, c3 = table.rows[index]
    s = at - table.origin(index)
    return c0 + s * (c1 + s * (c2 + s * c3)), c1 + s * (2.0 * c2 + 3.0 * s * c3), c2 + 3.0 * s * c3, c3


def _added(rows: list[Row]) -> Row:
    """The sum of two cubics."""
    a, b = rows
    return a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]


def attach_operators() -> None:
    """Give loads `2 * load`, `-load`, `one + other`, `one - other`, `load.shifted(angle)`."""
    operators: dict[str, Callable[..., Any]] = {
        "__mul__": multiple,
        "__rmul__": multiple,
        "__add__": total,
        "__radd__": total,
        "__neg__": lambda load: multiple(load, -1.0),
        "__sub__": lambda one, other: (
            total(one, multiple(other, -1.0) if isinstance(other, Load) else -other)
            if isinstance(other, (Load, Real))
            else NotImplemented
        ),
        "__rsub__": lambda one, other: total(multiple(one, -1.0), other),
    }
    for name, operator in operators.items():
        setattr(Load, name, operator)
    OverTheta.shifted = shifted  # type: ignore[attr-defined]
