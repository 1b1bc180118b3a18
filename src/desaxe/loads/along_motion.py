"""Loads over columns of the motion: functions, springs, dampers, tables over the speed, and sums of loads.

A load of this kind tells its value and its derivative with respect to each column that it needs. By the chain
rule the rest follows: dF/dp is the sum of dF/dcolumn dcolumn/dp.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from ..mechanism.quantity_units import SI, UnitSystem
from ..support.computed import computed_once
from ..support.shown import with_unit
from .function import called, name_of
from .load import Load, Partials, sign_of
from .table import Table

COLUMNS = ("theta", "omega", "Y", "s", "V_C")  # that functions take, besides t
SPEEDS = ("omega0", "omega", "alpha")  # inputs that say how fast the crank turns
# Central differences of order 8: (distance in steps, weight).
STENCIL = ((1, 4 / 5), (2, -1 / 5), (3, 4 / 105), (4, -1 / 280))
STEP = 2.0**-6  # of the scale of a column
SAMPLES = 97  # by which functions are told apart


class OfMotion(Load):
    """A load over columns of the motion: theta, omega, Y, s, V_C, the position of a dead centre."""

    over = "the motion"

    def total(self, slopes: Mapping[str, Any], parameter: str, motion: Mapping[str, Any]) -> Any:
        """The derivative with respect to a parameter, from those by the columns."""
        moved = {c: 1.0 if c == parameter else motion.get(f"{c}_wrt_{parameter}", 0.0) for c in slopes}
        return sum(slope * moved[column] for column, slope in slopes.items())

    def __call__(self, *columns: Any, way: Any = 1.0, **named: Any) -> Any:
        """The load at columns, by name or in the order of `needs`, in the units of the maker's machine."""
        passed = dict(zip(self.needs, columns, strict=False)) | named
        if len(columns) > len(self.needs) or not passed.keys() >= {*self.needs}:
            raise TypeError(f"{self!r} is called with {', '.join(self.needs)}")
        return self._in_its_units(
            lambda *si: self.partials({"way": way, **dict(zip(passed, si, strict=True))}).value, passed
        )


@dataclass(frozen=True, repr=False)
class FunctionOfMotion(OfMotion):
    """A user's function of columns of the motion.

    function    called with the arguments in their order
    derivatives with respect to each argument; None where they are not known
    centre      the dead centre from which an argument Y is measured, as a distance
    """

    function: Callable[..., Any]
    arguments: tuple[str, ...]
    derivatives: tuple[Callable[..., Any], ...] | None = None
    centre: str = ""

    @computed_once
    def over(self) -> str:
        """The names of the arguments."""
        return ", ".join(self.arguments)

    @computed_once
    def needs(self) -> tuple[str, ...]:
        """The columns of its arguments, and the dead centre."""
        return (*self.arguments, self.centre) if self.centre else self.arguments

    @computed_once
    def has_slope(self) -> bool:
        """True where the derivatives are known."""
        return self.derivatives is not None

    def partials(self, now: Mapping[str, Any]) -> Partials:
        """The function, and its derivatives where they are known."""
        columns, sign = {name: now[name] for name in self.arguments}, None
        if self.centre:
            away = now["Y"] - now[self.centre]
            columns["Y"], sign = abs(away), sign_of(away)
        value = called(self.function, columns, "the load")
        slopes = {
            name: called(derivative, columns, "the load's derivative")
            for name, derivative in zip(self.arguments, self.derivatives or (), strict=False)
        }
        if sign is not None and slopes:
            slopes["Y"] = slopes["Y"] * sign
            slopes[self.centre] = -slopes["Y"]
        return Partials(value, slopes)

    def differentiated(self, scales: Mapping[str, float]) -> "FunctionOfMotion":
        """The load with derivatives by differences; scales: of the columns."""
        if self.derivatives is not None:
            return self
        by = tuple(
            Difference(self.function, k, STEP * (scales.get(name) or 1.0))
            for k, name in enumerate(self.arguments)
        )
        return replace(self, derivatives=by)

    def _content(self) -> str:
        try:
            at = [0.37 + 0.013 * k for k in range(SAMPLES)]
            values = [self.function(*(x * (1.0 + n) for n in range(len(self.arguments)))) for x in at]
        except Exception:  # outside of its domain: the name is all that is known
            values = []
        return f"{name_of(self.function)} {self.arguments} {self.centre} {values}"

    def told(self, conversion: Any = None) -> str:
        """The function's name in a line."""
        over = f"the distance from {self.centre}" if self.centre else self.over
        return f"<load over {over}: the function {name_of(self.function)}>"


@dataclass(frozen=True)
class Difference:
    """The derivative of a function by one of its arguments, by differences."""

    function: Callable[..., Any]
    number: int
    step: float

    def __call__(self, *columns: Any) -> Any:
        """The derivative."""
        total, names = 0.0, [f"argument {k}" for k in range(len(columns))]
        for distance, weight in STENCIL:
            for side in (1.0, -1.0):
                moved = [x + (k == self.number) * side * distance * self.step for k, x in enumerate(columns)]
                values = called(self.function, dict(zip(names, moved, strict=True)), "the load")
                total = total + side * weight * values
        return total / self.step


class OverColumn(OfMotion):
    """A load by one table over one column, whose values are held, or whose lines go on, beyond its ends."""

    table: Table

    @computed_once
    def over(self) -> str:
        """The column."""
        return self.needs[0]

    @computed_once
    def speeds(self) -> tuple[float, ...]:
        """The speeds of a table in which pieces differ."""
        return self.table.knots if self.needs == ("V_C",) and len({*self.table.rows}) > 1 else ()

    def partials(self, now: Mapping[str, Any]) -> Partials:
        """The table at the column."""
        value, slope = self.table.both(now[self.over])
        return Partials(value, {self.over: slope})


@dataclass(frozen=True, repr=False)
class OverSpeed(OverColumn):
    """A table over the slider's speed, held beyond its ends."""

    table: Table
    kind: str
    unit: str | None = None
    plain: tuple[str, ...] = field(default=(), compare=False)

    call = "over_V"
    needs = ("V_C",)
    curves = ("table",)


@dataclass(frozen=True, repr=False)
class SumOfLoads(OfMotion):
    """Multiples of loads of any kind, and a number."""

    terms: tuple[tuple[float, Load], ...]
    constant: float = 0.0

    @computed_once
    def needs(self) -> tuple[str, ...]:
        """The columns of all members."""
        return tuple(dict.fromkeys(column for _, load in self.terms for column in load.needs))

    @property
    def variant(self) -> tuple[Any, ...]:
        """The key of the load in a request: its members have a table each, or are functions."""
        return (*super().variant, *(load.variant for load in self.members))

    @property
    def members(self) -> tuple[Load, ...]:
        """The loads that are summed."""
        return tuple(load for _, load in self.terms)

    @computed_once
    def unit(self) -> str | None:
        """The unit of those that have one."""
        return next((load.unit for load in self.members if load.unit is not None), None)

    @computed_once
    def plain(self) -> tuple[str, ...]:
        """The kinds of plain numbers of all members."""
        return tuple(dict.fromkeys(place for load in self.members for place in load.plain))

    @computed_once
    def has_slope(self) -> bool:
        """True where the derivatives of all are known."""
        return all(load.has_slope for load in self.members)

    @computed_once
    def has_ways(self) -> bool:
        """True with a load over the slider's position."""
        return any(load.has_ways for load in self.members)

    @computed_once
    def speeds(self) -> tuple[float, ...]:
        """The speeds of the members."""
        return tuple(sorted({v for m in self.members for v in m.speeds}))

    @computed_once
    def _named(self) -> dict[str, tuple[int, str]]:
        """The names of numbers, each with its member and its name there."""
        result: dict[str, tuple[int, str]] = {}
        for k, load in enumerate(self.members):
            for name in load.numbers:
                same = sum(n == name or n.startswith(f"{name}_") for n in result)
                result[f"{name}_{same + 1}" if same else name] = k, name
        return result

    @computed_once
    def numbers(self) -> Mapping[str, float]:
        """The numbers of all members; a second spring has stiffness_2."""
        return {name: self.members[k].numbers[own] for name, (k, own) in self._named.items()}

    def partials(self, now: Mapping[str, Any]) -> Partials:
        """The sums."""
        value: Any = self.constant
        slopes: dict[str, Any] = {}
        for factor, load in self.terms:
            part = load.partials(now)
            value = value + factor * part.value
            for column, slope in part.slopes.items():
                slopes[column] = slopes.get(column, 0.0) + factor * slope
        return Partials(value, slopes)

    def by(self, now: Mapping[str, Any]) -> dict[str, Any]:
        """The derivatives with respect to the numbers of all members."""
        parts = [load.by(now) for load in self.members]
        return {name: self.terms[k][0] * parts[k][own] for name, (k, own) in self._named.items()}

    def _content(self) -> str:
        return f"{self.constant!r} {[(factor, load.identity) for factor, load in self.terms]}"

    def told(self, conversion: Any = None) -> str:
        """All members in a line."""
        parts = [("" if f == 1.0 else f"{f:g} ") + load.told(conversion)[1:-1] for f, load in self.terms]
        own = conversion or self.values_in(SI)
        constant = [with_unit(f"{own.shown(self.constant):g}", own.unit)] if self.constant else []
        return f"<{' + '.join([*parts, *constant])}>"

    def in_units(self, units: UnitSystem) -> Load:
        """The sum, and all members, as they are shown in these units."""
        return super(
            SumOfLoads, replace(self, terms=tuple((f, one.in_units(units)) for f, one in self.terms))
        ).in_units(units)


def members_of(loads: Iterable[Load]) -> list[Load]:
    """The loads, and in place of a sum its members."""
    return [
        part
        for load in loads
        for part in (members_of(load.members) if isinstance(load, SumOfLoads) else [load])
    ]


def speeds_of(loads: Iterable[Load]) -> list[float]:
    """The slider's speeds at which loads have kinks."""
    return sorted({v for load in loads for v in load.speeds})


def with_derivatives(loads: Mapping[str, Load], inputs: Mapping[str, Any]) -> dict[str, Load]:
    """The loads, with the derivatives of functions of the motion by differences where they are not known.

    inputs  numbers or arrays, which say how large the columns are
    """

    def largest(name: str) -> float:
        return max(map(abs, _flat(inputs.get(name, 0.0))), default=0.0)

    reach, speed = largest("AB"), largest("omega") or largest("omega0")
    scales = {"theta": 1.0, "omega": speed, "Y": reach, "s": reach, "V_C": reach * speed}
    return {name: _differentiated(load, scales) for name, load in loads.items()}


def _differentiated(load: Load, scales: Mapping[str, float]) -> Load:
    if isinstance(load, FunctionOfMotion):
        return load.differentiated(scales)
    if isinstance(load, SumOfLoads):
        return replace(load, terms=tuple((f, _differentiated(m, scales)) for f, m in load.terms))
    return load


def _flat(value: Any) -> list[float]:
    return value.reshape(-1).tolist() if hasattr(value, "reshape") else [float(value or 0.0)]
