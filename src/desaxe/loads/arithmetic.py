"""Arithmetic of loads: multiples, sums, loads shifted by an angle.

A result may be a load of another class than its parts: the operators stand above all classes of loads, and
are attached to them here.
"""

from bisect import bisect_left
from dataclasses import dataclass, replace
from math import inf, isfinite
from numbers import Real
from sys import float_info
from typing import Any, TypeVar, cast

from ..mechanism.inputs import INPUTS
from ..mechanism.read import read
from ..support.shown import shown
from .along_motion import OverColumn, OverSpeed, SumOfLoads
from .function import FunctionOverTheta
from .load import Load, OverTheta, OverY, TableOverTheta
from .table import Row, Table, polynomial

T = TypeVar("T", bound=Load)
MOST_PERIODS = 64  # of the shorter one of two in the period of their sum
ROUNDED = 1e-13  # of a knot: more than a shift by an angle rounds
SAME_KIND = ("linear", "step")  # pieces that stay of their kind on more knots


@dataclass(frozen=True)
class Combined:
    """A sum of multiples of loads over the crank angle, each of which lags, or its derivative."""

    parts: tuple[tuple[float, OverTheta, float], ...]  # factor, load, angle that it lags
    constant: float = 0.0
    slope: bool = False

    __name__ = "a sum"

    def __call__(self, theta: Any) -> Any:
        """The sum at crank angles [rad]."""
        terms = (factor * load.both(theta - lag)[self.slope] for factor, load, lag in self.parts)
        return sum(terms, self.constant)


def multiple(load: Load, factor: Any) -> Any:
    """A load times a number."""
    if isinstance(factor, bool) or not isinstance(factor, Real):
        return NotImplemented
    return _affine(load, _finite(factor, f"{shown(factor)} times a load: the factor"))


def total(one: Load, other: Any) -> Any:
    """The sum of two loads, or of a load and a number; over the same thing where it is of their kind."""
    if isinstance(other, Real) and not isinstance(other, bool):
        return _affine(one, 1.0, _in_si(one, other))
    if not isinstance(other, Load):
        return NotImplemented
    if one.unit is not None and other.unit is not None and one.unit != other.unit:
        raise TypeError(f"{one!r} + {other!r}: a load in {one.unit} and one in {other.unit} do not add up")
    merged = _merged(one, other)
    if merged is not None:
        return merged
    if isinstance(one, OverTheta) and isinstance(other, OverTheta):
        return _function(one, ((1.0, one, 0.0), (1.0, other, 0.0)))
    (terms, constant), (others, more) = _terms(one), _terms(other)
    return _like(one, SumOfLoads((*terms, *others), constant + more))


def _terms(load: Load) -> tuple[tuple[tuple[float, Load], ...], float]:
    """A load as multiples of loads, and a number."""
    return (load.terms, load.constant) if isinstance(load, SumOfLoads) else (((1.0, load),), 0.0)


def _affine(load: Load, factor: float, number: float = 0.0) -> Load:
    """A load times a number, plus a number."""
    if load.curves:
        return _with_tables(load, [table.affine(factor, number) for table in load.tables])
    if isinstance(load, OverTheta):
        return _function(load, ((factor, load, 0.0),), constant=number)
    terms, constant = _terms(load)
    return _like(load, SumOfLoads(tuple((factor * f, part) for f, part in terms), factor * constant + number))


def _with_tables(load: T, tables: list[Table], **changes: Any) -> T:
    """A load with other tables."""
    return _like(load, replace(load, **dict(zip(load.curves, tables, strict=False)), **changes))  # type: ignore[type-var]


def parts_of(load: Load) -> list[Load] | None:
    """Tables that add up to a load, made once; None of one that is none, as a function is."""
    known = load.__dict__
    if "_parts" not in known:
        known["_parts"] = as_tables(load)
    return cast("list[Load] | None", known["_parts"])


def as_tables(load: Load) -> list[Load] | None:
    """Tables that add up to a load; None of one that is none, as a function is."""
    if load.curves:
        return [load]
    if isinstance(load, OverColumn):
        over_speed = load.needs == ("V_C",)
        return [OverSpeed(load.table, "smooth") if over_speed else OverY(load.table, None, "linear")]
    if not isinstance(load, SumOfLoads):
        return None
    tables: list[Load] = []
    for factor, member in load.terms:
        parts = as_tables(member)
        if parts is None:
            return None
        tables += [_affine(part, factor) for part in parts]
    return [_affine(tables[0], 1.0, load.constant), *tables[1:]]


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
    if isinstance(load, TableOverTheta):
        return _with_tables(load, [_turned(load.table, lag)])
    return _function(load, ((1.0, load, lag),), lag)


def _like(load: Load, new: T) -> T:
    """The new load in the units of the machine that made the other."""
    object.__setattr__(new, "shown_in", load.shown_in)
    return new


def _function(load: Any, parts: Any, lag: float = 0.0, constant: float = 0.0) -> FunctionOverTheta:
    """A combination of loads over theta as one function, with the nodes of all of them."""
    loads = [part for _, part, _ in parts]
    period = _common([part.period for part in loads])
    nodes = {(node + lag) % period for part in loads for node in part.nodes(0.0, period, False)}
    slope = Combined(parts, 0.0, True) if all(part.has_slope for part in loads) else None
    return _like(load, FunctionOverTheta(Combined(parts, constant), slope, tuple(sorted(nodes)), period))


def _common(periods: list[float]) -> float:
    """The least angle in which each period fits a whole number of times."""
    longest = max(periods)
    for turns in range(1, MOST_PERIODS + 1):
        if all(abs(turns * longest / period - round(turns * longest / period)) < 1e-9 for period in periods):
            return turns * longest
    raise ValueError(
        f"loads with the periods {' and '.join(f'{p:.6g}' for p in periods)} rad never repeat together"
    )


def _merged(one: Load, other: Load) -> Load | None:
    """The sum of two loads of one class by tables over the same thing; None where it is of no kind."""
    if type(one) is not type(other) or not one.curves or one.centre != other.centre:
        return None
    kind = one.kind if one.kind == other.kind else ""
    count = max(len(one.tables), len(other.tables))
    sums = [
        _sum(a, b, kind) for a, b in zip(*((load.tables * 2)[:count] for load in (one, other)), strict=True)
    ]
    tables = [table for table in sums if table is not None]
    plain = tuple(dict.fromkeys((*one.plain, *other.plain)))
    more = {"unit": one.unit or other.unit, "plain": plain}
    return _with_tables(one, tables, **more) if len(tables) == count else None


def _sum(one: Table, other: Table, kind: str) -> Table | None:
    """The sum of two tables of one kind; None where it is of no kind."""
    if kind in ("", "smooth"):  # whose slopes between points are no sums
        return None
    period = None if one.period is None or other.period is None else _common([one.period, other.period])
    if period is not None:
        one, other = (
            replace(_turned(table, 0.0, round(period / (table.period or period))), period=period)
            for table in (one, other)
        )
    both = one, _snapped(other, one.knots)
    # A periodic spline is the only one through its points, on more knots, too.
    if both[0].knots != both[1].knots and kind not in SAME_KIND and (kind != "cubic" or period is None):
        return None
    every = [table.knots for table in both]
    knots = sorted(x for x in {*every[0], *every[1]} for _ in range(max(k.count(x) for k in every)))
    rows = [
        _added([_piece(table, a, a == b) for table in both])
        for a, b in zip(knots, [*knots[1:], inf], strict=True)
    ]
    first = _added([table.rows[0] for table in both]) if period is None else rows[-1]
    return Table(tuple(knots), (first, *rows), period)


def _turned(table: Table, lag: float, times: int = 1) -> Table:
    """A periodic table that lags by an angle, over some of its periods, with knots from 0 on."""
    period = table.period or inf
    knots = [(knot + lag) % period for knot in table.knots]
    first = knots.index(min(knots))
    knots, rows = [*knots[first:], *knots[:first]], (*table.rows[1:][first:], *table.rows[1:][:first])
    every = tuple(knot + turn * period if turn else knot for turn in range(times) for knot in knots)
    return Table(every, (rows[-1], *(rows * times)), times * period)


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


def _difference(one: Load, other: Any) -> Any:
    """A load without another, or without a number."""
    return total(one, -other) if isinstance(other, (Load, Real)) else NotImplemented


Load.__add__ = Load.__radd__ = total
Load.__mul__ = Load.__rmul__ = multiple
Load.__sub__ = _difference
Load.__neg__ = lambda load: multiple(load, -1.0)
Load.__rsub__ = lambda load, other: total(-load, other)
OverTheta.shifted = shifted
