"""Loads made of columns of numbers: each is checked to be a table."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
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
from .load import Load, LoadWarning, OverY, TableOverTheta, outside
from .stroke import DEAD_CENTRES, OverStroke
from .table import KINDS, Table, held, periodic

CLOSED = 1e-6  # of a period: a last angle so near to its end repeats the first one
WIDE = 4.0  # times the usual distance between points
SMOOTH = ("linear", "smooth")  # kinds of a table over a speed, which has no jumps
EQUAL = 1e-9  # of the largest value: what differs by less is the same


@dataclass
class TablePoints:
    """The points of a table, and what a message calls them.

    quantity  that the places x are
    columns   the values, of one way or of two
    """

    name: str
    places: str
    quantity: str
    kind: str
    x: list[float]
    columns: list[list[float]]

    def check(self, kinds: Sequence[str] = KINDS, order: str = "ascend", jumps: bool = True) -> None:
        """ValueError for points that are no table of a kind."""
        if not isinstance(self.kind, str) or self.kind not in kinds:
            raise ValueError(f"{self.name}: kind = {shown(self.kind)}: it is one of {', '.join(kinds)}")
        count = len(self.x)
        other = next((len(column) for column in self.columns if len(column) != count), None)
        if other is not None:
            raise ValueError(
                f"{self.name}: {count} {self.places} and {other} values; expected as many of both"
            )
        if count < 2:
            raise ValueError(
                f"{self.name}: the number of {self.places} is {count}, expected at least two points; a load "
                "that is the same everywhere is a number, F_Y=-600"
            )
        self._check_order(order, jumps and self.kind == "linear")

    def _check_order(self, order: str, jumps: bool) -> None:
        """ValueError for places out of order; one given twice is a jump of a linear table."""
        for before, after in pairwise(self.x):
            if before < after or (before == after and jumps):
                continue
            one, other = (amount(self.quantity, place, "g") for place in (after, before))
            only = (
                ': a jump, which only kind="linear" has'
                if before == after and self.quantity in ("theta", "Y")
                else ""
            )
            raise ValueError(
                f"{self.name}: the {self.places} must {order}, but " + one + " follows " + other + only
            )
        if any(a == c for a, c in zip(self.x, self.x[2:], strict=False)):
            raise ValueError(f"{self.name}: one of the {self.places} is given three times; twice is a jump")

    def held(self) -> list[Table]:
        """A table of each column, which is held beyond its ends."""
        return [self.finite(partial(held, self.x, y, self.kind)) for y in self.columns]

    def finite(self, make: Callable[[], Table]) -> Table:
        """A table; ValueError where slopes between its points are too steep for doubles."""
        try:
            table = make()
        except ArithmeticError:
            table = None
        if table is None or not all(map(isfinite, chain.from_iterable(table.rows))):
            every = (span for y in self.columns for span in pairwise(zip(self.x, y, strict=True)))
            spans = [(a, b) for a, b in every if a[0] < b[0]]
            _, x, beyond = max((abs((b[1] - a[1]) / (b[0] - a[0])), a[0], b[0]) for a, b in spans)
            raise ValueError(
                f"{self.name}: {x!r} and {beyond!r} are too close for the values there: slopes must be below "
                "1.8e308"
            )
        return table


def table_over_theta(
    angles: Column, values: Column, kind: str, turn: Column, units: UnitSystem | None = None
) -> Load:
    """A load over the crank angle; ValueError where the columns are no periodic table.

    units  of a warning
    """
    x, y, period = angles.values, values.values, turn.values[0]
    points = TablePoints("over_theta", "angles", "theta", kind, x, [y])
    points.check()
    span = x[-1] - x[0]
    if span > (1.0 + CLOSED) * period:
        hint = f' (degrees are texts: "{x[-1]:g} deg")' if angles.plain else ""
        wide, turn_text = (amount("theta", angle, "g", says_unit=True) for angle in (span, period))
        remedy = f"; give a longer period= or one period of the table{hint}"
        raise ValueError("over_theta: the angles go over " + wide + ", the period is " + turn_text + remedy)
    if span >= (1.0 - CLOSED) * period:
        if abs(y[-1] - y[0]) > EQUAL * max(map(abs, y)):
            raise ValueError(
                f"over_theta: at the end of the period the value is {y[-1]!r}, but {y[0]!r} at its "
                "beginning: the load must repeat; leave the end point out, or give the period= after which "
                "it does"
            )
        x, y = x[:-1], y[:-1]
        if len(x) == 1:  # both ends of a period alone: the same everywhere
            x, y = [x[0], x[0] + 0.5 * period], 2 * y
    _warn_of_gap(x, kind, period, units)
    unit, plain = _written("theta", angles._replace(plain=angles.plain or turn.plain), values)
    table = points.finite(lambda: periodic(x, y, kind, period))
    return TableOverTheta(table, kind, unit, plain)


def _warn_of_gap(x: list[float], kind: str, period: float, units: UnitSystem | None) -> None:
    """Warn of a spline with a gap of most of a turn between two points."""
    gaps = sorted(b - a for a, b in zip(x, [*x[1:], x[0] + period], strict=True))
    if kind == "cubic" and gaps[-1] > max(period / 4.0, WIDE * gaps[len(gaps) // 2]):
        rule = " without a point, which a cubic spline bridges with a wide swing; "
        remedy = 'give points there too, or kind="linear" or "step"'
        gap = "over_theta: a gap of " + amount("theta", gaps[-1], ".3g", says_unit=True)
        warn((gap + rule + remedy).in_units(units or SI), LoadWarning, stacklevel=outside())


def table_over_Y(positions: Column, *ways: Column, kind: str) -> Load:
    """A load over the slider's position; ValueError where the columns are no table."""
    outward, inward = _both_ways("over_Y", "positions", positions, ways, kind)
    return OverY(outward, inward, kind, *_written("Y", positions, *ways))


def table_over_stroke(distances: Column, *ways: Column, kind: str, dead_centre: Any) -> Load:
    """A load over the distance from a dead centre; ValueError where the columns are no table."""
    dead_centre = dead_centre_of(dead_centre)
    wrong = next((x for x in distances.values if x < 0.0), None)
    if wrong is not None:
        distance = amount("Y", wrong, "g", says_unit=True)
        raise ValueError("over_stroke: the distance " + distance + " is below 0: distances have no sign")
    outward, inward = _both_ways("over_stroke", "distances", distances, ways, kind)
    return OverStroke(outward, inward, kind, *_written("Y", distances, *ways), dead_centre)


def dead_centre_of(name: Any) -> str:
    """The name of a dead centre, checked."""
    if name is None:
        both = " or ".join(f'dead_centre="{which}"' for which in DEAD_CENTRES)
        raise TypeError(f"over_stroke: dead_centre is missing: {both}, from which distances are measured")
    if not isinstance(name, str) or name not in DEAD_CENTRES:
        raise ValueError(f"over_stroke: dead_centre = {shown(name)}: it is one of {', '.join(DEAD_CENTRES)}")
    return name


def table_over_V(speeds: Column, forces: Column, *, kind: str) -> Load:
    """A load over the slider's speed; ValueError where the columns are no table."""
    table = ascending_table("over_V", "V_C", speeds, forces, kind)
    return OverSpeed(table, kind, *_written("V_C", speeds, forces))


def ascending_table(name: str, quantity: str, speeds: Column, values: Column, kind: str) -> Table:
    """A table over ascending speeds; ValueError where the columns are none."""
    points = TablePoints(name, "speeds", quantity, kind, speeds.values, [values.values])
    points.check(SMOOTH, jumps=False)
    return points.held()[0]


def _written(place: str, x: Column, *ways: Column) -> tuple[str | None, tuple[str, ...]]:
    """The unit of the values, and what was given as plain numbers."""
    unit = next((way.unit for way in ways if way.unit is not None), None)
    return unit, (place,) * x.plain + (ways[0].kind,) * any(way.plain for way in ways)


def _both_ways(
    name: str, places: str, x: Column, ways: Sequence[Column], kind: str
) -> tuple[Table, Table | None]:
    """The tables outward and inward, over ascending places."""
    descends = x.values and x.values[0] > x.values[-1]
    at, *columns = (column.values[:: -1 if descends else 1] for column in (x, *ways))
    points = TablePoints(name, places, "Y", kind, at, columns)
    points.check(order="ascend or descend")
    outward, *inward = points.held()
    return outward, inward[0] if inward else None
