"""Loads made of columns of numbers: each is checked to be a table."""

from collections.abc import Callable, Sequence
from functools import partial
from itertools import chain, pairwise
from math import isfinite
from typing import Any
from warnings import warn

from ..mechanism.messages import amount
from ..mechanism.quantity_units import SI, UnitSystem
from ..support.shown import shown
from .along_motion import OverSpeed
from .columns import Column
from .load import Load, LoadWarning, OverY, TableOverTheta
from .stroke import DEAD_CENTRES, OverStroke
from .table import KINDS, Table, held, periodic

CLOSED = 1e-6  # of a period: a last angle so near to its end repeats the first one
WIDE = 4.0  # times the usual distance between points
SMOOTH = ("linear", "smooth")  # kinds of a table over a speed, which has no jumps
EQUAL = 1e-9  # of the largest value: what differs by less is the same


def table_over_theta(
    angles: Column, values: Column, kind: str, turn: Column, units: UnitSystem | None = None
) -> Load:
    """A load over the crank angle; ValueError where the columns are no periodic table.

    units  of a warning
    """
    name = "over_theta"
    x, y, period = angles.values, values.values, turn.values[0]
    _check(name, "angles", x, [y], kind)
    _require_order(name, "angles", "ascend", x, kind)
    span = x[-1] - x[0]
    if span > (1.0 + CLOSED) * period:
        hint = f' (degrees are texts: "{x[-1]:g} deg")' if angles.plain else ""
        wide, turn_text = (amount("theta", angle, "g", says_unit=True) for angle in (span, period))
        remedy = f"; give a longer period= or one period of the table{hint}"
        raise ValueError(f"{name}: the angles go over " + wide + ", the period is " + turn_text + remedy)
    if span >= (1.0 - CLOSED) * period:
        if abs(y[-1] - y[0]) > EQUAL * max(map(abs, y)):
            raise ValueError(
                f"{name}: at the end of the period the value is {y[-1]!r}, but {y[0]!r} at its beginning: "
                "the load must repeat; leave the end point out, or give the period= after which it does"
            )
        x, y = x[:-1], y[:-1]
        if len(x) == 1:  # both ends of a period alone: the same everywhere
            x, y = [x[0], x[0] + 0.5 * period], 2 * y
    _warn_of_gap(x, kind, period, units)
    plain = ("theta",) * (angles.plain or turn.plain) + (values.kind,) * values.plain
    table = _finite(name, x, y, partial(periodic, x, y, kind, period))
    return TableOverTheta(table, kind, values.unit, plain)


def _finite(name: str, x: Sequence[float], y: Sequence[float], make: Callable[[], Table]) -> Table:
    """A table; ValueError where slopes between its points are too steep for doubles."""
    try:
        table = make()
    except ArithmeticError:
        table = None
    if table is None or not all(map(isfinite, chain.from_iterable(table.rows))):
        spans = [span for span in pairwise(zip(x, y, strict=True)) if span[0][0] < span[1][0]]
        _, a, b = max((abs((right - left) / (b - a)), a, b) for (a, left), (b, right) in spans)
        raise ValueError(
            f"{name}: {a!r} and {b!r} are too close for the values there: slopes must be below 1.8e308"
        )
    return table


def _warn_of_gap(x: list[float], kind: str, period: float, units: UnitSystem | None) -> None:
    """Warn of a spline with a gap of most of a turn between two points."""
    gaps = sorted(b - a for a, b in zip(x, [*x[1:], x[0] + period], strict=True))
    if kind == "cubic" and gaps[-1] > max(period / 4.0, WIDE * gaps[len(gaps) // 2]):
        rule = " without a point, which a cubic spline bridges with a wide swing; "
        remedy = 'give points there too, or kind="linear" or "step"'
        gap = "over_theta: a gap of " + amount("theta", gaps[-1], ".3g", says_unit=True)
        warn(
            (gap + rule + remedy).in_units(units or SI),
            LoadWarning,
            stacklevel=6,
        )


def table_over_Y(positions: Column, ways: Sequence[Column], kind: str) -> Load:
    """A load over the slider's position; ValueError where the columns are no table."""
    outward, inward = _both_ways("over_Y", "positions", positions, ways, kind)
    return OverY(outward, inward, kind, *_given("Y", positions, ways))


def table_over_stroke(distances: Column, ways: Sequence[Column], kind: str, dead_centre: Any) -> Load:
    """A load over the distance from a dead centre; ValueError where the columns are no table."""
    dead_centre = dead_centre_of(dead_centre)
    wrong = next((x for x in distances.values if x < 0.0), None)
    if wrong is not None:
        distance = amount("Y", wrong, "g", says_unit=True)
        raise ValueError("over_stroke: the distance " + distance + " is below 0: distances have no sign")
    outward, inward = _both_ways("over_stroke", "distances", distances, ways, kind)
    return OverStroke(outward, inward, kind, *_given("Y", distances, ways), dead_centre)


def dead_centre_of(name: Any) -> str:
    """The name of a dead centre, checked."""
    if name is None:
        both = " or ".join(f'dead_centre="{which}"' for which in DEAD_CENTRES)
        raise TypeError(f"over_stroke: dead_centre is missing: {both}, from which distances are measured")
    if not isinstance(name, str) or name not in DEAD_CENTRES:
        raise ValueError(f"over_stroke: dead_centre = {shown(name)}: it is one of {', '.join(DEAD_CENTRES)}")
    return name


def table_over_V(speeds: Column, forces: Column, kind: str) -> Load:
    """A load over the slider's speed; ValueError where the columns are no table."""
    table = ascending_table("over_V", "V_C", ("speeds", "forces"), (speeds, forces), kind)
    return OverSpeed(table, kind, forces.unit, ("V_C",) * speeds.plain + ("value",) * forces.plain)


def ascending_table(
    name: str, quantity: str, columns: tuple[str, str], both: tuple[Column, Column], kind: str
) -> Table:
    """A table over ascending speeds; ValueError where the columns are none.

    quantity, columns  what a message calls a speed, and both columns
    """
    (x, y), (xs, ys) = both, columns
    if not isinstance(kind, str) or kind not in SMOOTH:
        raise ValueError(f"{name}: kind = {shown(kind)}: it is one of {', '.join(SMOOTH)}")
    if len(x.values) != len(y.values):
        raise ValueError(f"{name}: {len(x.values)} {xs} and {len(y.values)} {ys}; expected as many of both")
    if len(x.values) < 2:
        raise ValueError(f"{name}: {len(x.values)} of the {xs}; expected at least two points")
    for before, after in pairwise(x.values):
        if not before < after:
            one, other = (amount(quantity, value, "g") for value in (before, after))
            raise ValueError(f"{name}: the {xs} must ascend, but " + other + " follows " + one)
    table = held(x.values, y.values, kind)
    if not all(map(isfinite, chain.from_iterable(table.rows))):
        raise ValueError(f"{name}: two {xs} are too close for the {ys} there")
    return table


def _given(place: str, x: Column, ways: Sequence[Column]) -> tuple[str | None, tuple[str, ...]]:
    """The unit of the values, and what was given as plain numbers."""
    unit = next((way.unit for way in ways if way.unit is not None), None)
    return unit, (place,) * x.plain + (ways[0].kind,) * any(way.plain for way in ways)


def _both_ways(
    name: str, places: str, x: Column, ways: Sequence[Column], kind: str
) -> tuple[Table, Table | None]:
    """The tables outward and inward, over ascending places."""
    at, columns = x.values, [way.values for way in ways]
    _check(name, places, at, columns, kind)
    if at[0] > at[-1]:
        at, columns = at[::-1], [column[::-1] for column in columns]
    _require_order(name, places, "ascend or descend", at, kind)
    tables = [_finite(name, at, column, partial(held, at, column, kind)) for column in columns]
    return tables[0], tables[1] if len(tables) > 1 else None


def _check(name: str, places: str, x: list[float], columns: Sequence[list[float]], kind: str) -> None:
    if not isinstance(kind, str) or kind not in KINDS:
        raise ValueError(f"{name}: kind = {shown(kind)}: it is one of {', '.join(KINDS)}")
    for column in columns:
        if len(column) != len(x):
            raise ValueError(f"{name}: {len(x)} {places} and {len(column)} values; expected as many of both")
    if len(x) < 2:
        raise ValueError(
            f"{name}: the number of {places} is {len(x)}, expected at least two points; a load that is the "
            "same everywhere is a number, F_Y=-600"
        )


def _require_order(name: str, places: str, order: str, x: Sequence[float], kind: str) -> None:
    """ValueError for places out of order; one given twice is a jump of a linear table."""

    def follows(b: float, a: float) -> str:
        one, other = (amount("theta" if places == "angles" else "Y", place, "g") for place in (b, a))
        return f"{name}: the {places} must {order}, but " + one + " follows " + other

    found = next(((a, b) for a, b in pairwise(x) if not a <= b), None)
    if found is not None:
        raise ValueError(follows(found[1], found[0]))
    twice = next((a for a, b in pairwise(x) if a == b), None)
    if twice is None:
        return
    if kind != "linear":
        only = 'a jump, which only kind="linear" has'
        raise ValueError(f"{follows(twice, twice)}: {only}")
    if any(a == c for a, c in zip(x, x[2:], strict=False)):
        raise ValueError(f"{name}: one of the {places} is given three times; twice is a jump")
